//! Results of an experiment.

use fairing_figure::Image;
use fairing_mesh::TriMesh;

use crate::model::results::PlotLink;
use crate::model::table::Table;
use crate::model::view::View;

/// Everything that an experiment produced, in the order in which the report
/// shows it. The runner writes the files.
#[derive(Debug, Clone, Default)]
pub struct Outcome {
    /// Tables; claims are judged from these alone.
    pub tables: Vec<Table>,
    /// Figures.
    pub figures: Vec<Picture>,
    /// Interactive views of the page.
    pub views: Vec<View>,
    /// Meshes to keep, with their fields.
    pub meshes: Vec<MeshOutput>,
    /// Further files to keep.
    pub attachments: Vec<Attachment>,
    /// Remarks for the reader, a sentence or two each. A number in them is
    /// formatted from a result, never typed.
    pub notes: Vec<String>,
}

/// A finished figure.
#[derive(Debug, Clone)]
pub struct Picture {
    /// Unique within the experiment; the file's name.
    pub id: String,
    /// The caption, as full sentences.
    pub caption: String,
    /// A description for readers who cannot see it.
    pub alt: String,
    /// The picture.
    pub image: Image,
    /// The picture as SVG, where a vector form helps (plots).
    pub svg: Option<String>,
    /// Views that show the meshes behind the points of a plot.
    pub links: Vec<PlotLink>,
}

impl Picture {
    /// The same picture, of whose plot titled `plot` the series `series` is shown by a view as a
    /// slider over the horizontal axis moves; an empty title or name is any.
    #[must_use]
    pub fn linked(mut self, plot: &str, series: &str, view: &str, slider: &str) -> Self {
        let [plot, series, view, slider] = [plot, series, view, slider].map(String::from);
        self.links.push(PlotLink { plot, series, view, slider });
        self
    }
}

/// A mesh to be written as PLY with fields for each vertex.
#[derive(Debug, Clone)]
pub struct MeshOutput {
    /// Unique within the experiment; the file's name.
    pub id: String,
    /// The caption.
    pub caption: String,
    /// The mesh.
    pub mesh: TriMesh,
    /// Scalar fields, one value a vertex; the name becomes a PLY property.
    pub fields: Vec<(String, Vec<f64>)>,
}

/// A file to keep beside the tables.
#[derive(Debug, Clone)]
pub struct Attachment {
    /// Its name, unique within the experiment.
    pub name: String,
    /// The description.
    pub about: String,
    /// The content.
    pub content: Content,
}

/// The content of a file.
#[derive(Debug, Clone)]
pub enum Content {
    /// Text as it is.
    Text(String),
    /// A mesh in the format of the name's extension.
    Mesh(TriMesh),
}
