//! Interactive views of the page: panels side by side with linked cameras.

mod file;

use fairing_mesh::TriMesh;
use serde::Serialize;

/// Panels shown side by side, with one camera, and perhaps sliders that move
/// the vertices of all of them.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct View {
    /// Unique within the experiment.
    pub id: String,
    /// The caption.
    pub caption: String,
    /// The name of its mesh, for the list of meshes; none if empty.
    pub mesh: String,
    /// The description for readers who cannot see the view.
    pub alt: String,
    /// The figure (by id) that stands in where there is no WebGL.
    pub fallback: String,
    /// True if the third axis points up; otherwise the second does, as in the figure.
    pub z_up: bool,
    /// The sliders, top to bottom. What a panel shows is given for each
    /// combination of their stops, those of the last slider running fastest.
    pub sliders: Vec<Slider>,
    /// The stop at which each slider begins; the first if empty.
    pub start: Vec<usize>,
    /// The panels, left to right.
    pub panels: Vec<Panel>,
    /// The field that gives the initial colours, possibly one that the page computes; by default
    /// the first field of the view.
    pub color: Option<String>,
    /// The panel from which displacement counts, if the page is to offer it.
    pub from: Option<usize>,
    /// True positions of the vertices of all panels: the page computes how far
    /// a panel is off them.
    pub truth: Option<Vec<[f64; 3]>>,
}

/// A slider with fixed stops.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Slider {
    /// The parameter of the slider: `k`, `λ`, `iterations`.
    pub name: String,
    /// The stops, as they are labelled.
    pub stops: Vec<String>,
}

/// One mesh of a view.
#[derive(Debug, Clone, PartialEq)]
pub struct Panel {
    /// The title.
    pub title: String,
    /// Positions at each combination of stops; one entry if it does not move.
    pub positions: Vec<Vec<[f64; 3]>>,
    /// The faces.
    pub faces: Vec<[u32; 3]>,
    /// The fields to choose from; the first is shown.
    pub fields: Vec<Field>,
    /// True if the page smooths the first positions at any λ and number of steps; of at most one
    /// panel of a view.
    pub live: bool,
    /// Modes for sums over a variable number of them; the panel then shows the sums instead of the
    /// positions.
    pub modes: Option<Modes>,
    /// Facts measured for this panel.
    pub facts: Vec<Fact>,
}

/// Modes, ascending in their eigenvalues.
#[derive(Debug, Clone, PartialEq)]
pub struct Modes {
    /// The eigenvalues.
    pub values: Vec<f64>,
    /// The coefficients of the positions in each mode, by coordinate.
    pub coefficients: Vec<[f64; 3]>,
    /// The modes at the vertices.
    pub vectors: Vec<Vec<f64>>,
}

/// A measured fact about a panel.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Fact {
    /// The name.
    pub name: String,
    /// The unit; may be empty.
    pub unit: String,
    /// The value at each combination of stops; one entry if it does not change.
    pub values: Vec<Option<f64>>,
}

/// Values to colour vertices by.
#[derive(Debug, Clone, PartialEq)]
pub struct Field {
    /// The name, as on the colour bar.
    pub name: String,
    /// The unit, as on the colour bar.
    pub unit: String,
    /// True if zero is the middle of the colours.
    pub signed: bool,
    /// Values at each combination of stops; one entry if they do not change.
    pub values: Vec<Vec<f64>>,
    /// The vertices without a value, ascending; their entries in the values are ignored.
    pub undefined: Vec<u32>,
    /// The exact values, where the surface has some: the page shows errors, too.
    pub exact: Option<Vec<f64>>,
}

impl Slider {
    /// A slider with these stops.
    pub fn new<T: ToString>(name: &str, stops: impl IntoIterator<Item = T>) -> Self {
        Self { name: name.into(), stops: stops.into_iter().map(|s| s.to_string()).collect() }
    }
}

impl Panel {
    /// A mesh that does not move, without fields.
    pub fn still(title: &str, mesh: &TriMesh) -> Self {
        Self {
            title: title.into(),
            positions: vec![mesh.positions().to_vec()],
            faces: mesh.faces().to_vec(),
            fields: vec![],
            live: false,
            modes: None,
            facts: vec![],
        }
    }

    /// One set of positions for each combination of stops, over the faces of
    /// `mesh`.
    pub fn moving<'a>(
        title: &str,
        mesh: &TriMesh,
        stops: impl IntoIterator<Item = &'a [[f64; 3]]>,
    ) -> Self {
        let positions = stops.into_iter().map(<[_]>::to_vec).collect();
        Self { positions, ..Self::still(title, mesh) }
    }

    /// The same panel with a field that does not change with the sliders.
    #[must_use]
    pub fn with_field(self, name: &str, unit: &str, signed: bool, values: &[f64]) -> Self {
        self.with_moving_field(name, unit, signed, [values])
    }

    /// The same panel with a field that has values of its own at each
    /// combination of stops.
    #[must_use]
    pub fn with_moving_field<'a>(
        mut self,
        name: &str,
        unit: &str,
        signed: bool,
        stops: impl IntoIterator<Item = &'a [f64]>,
    ) -> Self {
        let values = stops.into_iter().map(<[_]>::to_vec).collect();
        let (name, unit) = (name.into(), unit.into());
        self.fields.push(Field { name, unit, signed, values, undefined: vec![], exact: None });
        self
    }

    /// The same panel with exact values for the last field.
    #[must_use]
    pub fn exactly(mut self, values: Vec<f64>) -> Self {
        if let Some(field) = self.fields.last_mut() {
            field.exact = Some(values);
        }
        self
    }

    /// The same panel with something that was measured at each combination of stops.
    #[must_use]
    pub fn with_fact(mut self, name: &str, unit: &str, values: Vec<Option<f64>>) -> Self {
        self.facts.push(Fact { name: name.into(), unit: unit.into(), values });
        self
    }

    /// The same panel without the values of the last field at these vertices.
    #[must_use]
    pub fn undefined_at(mut self, vertices: impl IntoIterator<Item = u32>) -> Self {
        if let Some(field) = self.fields.last_mut() {
            field.undefined = vertices.into_iter().collect();
            field.undefined.sort_unstable();
        }
        self
    }

    /// The same panel, whose first positions the page smooths with uniform weights, explicitly and
    /// implicitly.
    #[must_use]
    pub fn with_live_smoothing(self) -> Self {
        Self { live: true, ..self }
    }

    /// The same panel, which shows as many of these modes as the reader likes.
    #[must_use]
    pub fn with_modes(self, modes: Modes) -> Self {
        Self { modes: Some(modes), ..self }
    }
}
