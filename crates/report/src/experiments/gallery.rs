//! Pictures of meshes in a grid: a column for each look, a row for each
//! viewpoint.

use anyhow::Result;
use fairing_figure::{
    Background, Camera, ColorBar, Colors, Field, Figure, Limits, Occlusion, Panel, RenderOptions,
    Scale, ScaleOptions, Shading, Up, Viewpoint, Wireframe, render,
};
use fairing_mesh::TriMesh;
use fairing_operators::curvature::ScalarCurvature;

use crate::experiment::outcome::Picture;

/// A mesh and its colours.
pub(super) struct Look<'a> {
    /// The heading of its column.
    pub(super) title: &'a str,
    /// The mesh.
    pub(super) mesh: &'a TriMesh,
    /// The colours; plain clay without.
    pub(super) coloring: Option<Coloring<'a>>,
}

/// A field and its mapping to colours.
pub(super) struct Coloring<'a> {
    /// The values.
    pub(super) field: &'a ScalarCurvature,
    /// Vertices that set the range.
    pub(super) range: Range,
    /// The recipe.
    pub(super) options: ScaleOptions,
    /// The title of the colour bar.
    pub(super) quantity: &'a str,
    /// Its unit.
    pub(super) unit: &'a str,
}

/// Vertices that set the range of the colours.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Range {
    /// All vertices, as in the assignment.
    All,
    /// Inner vertices; the others are coloured like the nearest value in range.
    Inside,
}

/// A grid of pictures.
pub(super) struct Gallery<'a> {
    /// The columns.
    pub(super) looks: Vec<Look<'a>>,
    /// The rows.
    pub(super) viewpoints: &'a [Viewpoint],
    /// The axis that points upward.
    pub(super) up: Up,
    /// Width over height of each picture.
    pub(super) aspect: f64,
    /// True for darker hollows: half of the work of a picture, which quick runs leave out.
    pub(super) occlusion: bool,
}

/// The two viewpoints of the figures.
pub(super) const VIEWPOINTS: [Viewpoint; 2] = [
    Viewpoint::Angles { azimuth: 25.0, elevation: 35.0 },
    Viewpoint::Angles { azimuth: -60.0, elevation: 65.0 },
];

/// Ranges narrower than this are rounding: the field is zero.
pub(super) const FLAT: f64 = 1e-6;

/// The widest a figure gets, in CSS pixels.
pub(super) const WIDTH: f64 = 900.0;

/// The widest a picture gets, in CSS pixels.
const COLUMN: f64 = 330.0;

/// Pixels of the file for each CSS pixel.
pub(super) const ZOOM: f64 = 1.6;

impl Gallery<'_> {
    /// Draws the grid; all meshes share their cameras.
    pub(super) fn draw(&self, id: &str, caption: &str, alt: &str) -> Result<Picture> {
        let width = (WIDTH / self.looks.len() as f64).min(COLUMN);
        let options = RenderOptions {
            width: (ZOOM * width) as u32,
            height: (ZOOM * width / self.aspect) as u32,
            shading: Shading::Creased { degrees: 45.0 },
            wireframe: Some(Wireframe { opacity: 0.3, ..Wireframe::default() }),
            background: Background::WHITE,
            ..RenderOptions::default()
        };
        let meshes: Vec<&TriMesh> = self.looks.iter().map(|l| l.mesh).collect();
        let baked = self.occlusion.then(|| baked(&meshes));
        let mut figure = Figure {
            columns: self.looks.len(),
            column_titles: self.looks.iter().map(|l| l.title.to_string()).collect(),
            ..Figure::default()
        };
        let mut painted = vec![];
        for look in &self.looks {
            painted.push(match &look.coloring {
                None => None,
                Some(coloring) => {
                    let (colors, bar) = coloring.paint()?;
                    // Looks on one scale share its bar.
                    let same = |b: &ColorBar| b.scale == bar.scale && b.quantity == bar.quantity;
                    // A range as narrow as rounding has no meaning.
                    let is_flat = bar.scale.high() - bar.scale.low() < 1.01 * FLAT;
                    if !is_flat && !figure.bars.iter().any(same) {
                        figure.bars.push(bar);
                    }
                    Some(colors)
                }
            });
        }
        for &viewpoint in self.viewpoints {
            let camera = Camera::fit(&meshes, viewpoint, self.up, options.aspect())?;
            for (i, (look, colors)) in self.looks.iter().zip(&painted).enumerate() {
                let occlusion = baked.as_ref().map(|(distinct, which)| &distinct[which[i]]);
                let colors = colors.as_deref().map_or(Colors::CLAY, Colors::PerVertex);
                let image = render(look.mesh, colors, occlusion, &camera, &options)?;
                figure.panels.push(Panel::image(image, width));
            }
        }
        picture(&figure, id, caption, alt)
    }
}

/// The occlusion of each distinct mesh, and the index of that of each mesh.
fn baked(meshes: &[&TriMesh]) -> (Vec<Occlusion>, Vec<usize>) {
    let (mut distinct, mut which): (Vec<&TriMesh>, Vec<usize>) = (vec![], vec![]);
    for &mesh in meshes {
        let known = distinct.iter().position(|&other| std::ptr::eq(other, mesh));
        which.push(known.unwrap_or(distinct.len()));
        if known.is_none() {
            distinct.push(mesh);
        }
    }
    (distinct.into_iter().map(Occlusion::bake).collect(), which)
}

impl Coloring<'_> {
    fn paint(&self) -> Result<(Vec<[u8; 3]>, ColorBar)> {
        let mut field = drawn(self.field)?;
        if self.range == Range::Inside {
            field = field.range_without(&self.field.boundary)?;
        }
        let scale = Scale::new(&[&field], &self.options)?;
        let colors = scale.colors(&field);
        let bar = ColorBar { scale, quantity: self.quantity.into(), unit: self.unit.into() };
        Ok((colors, bar))
    }
}

/// The values that have a colour.
fn drawn(curvature: &ScalarCurvature) -> Result<Field<'_>> {
    let undefined: Vec<bool> = curvature.status.iter().map(|s| !s.is_defined()).collect();
    Ok(Field::new(&curvature.values).undefined_where(&undefined)?)
}

/// The range of the values inside of all these fields.
pub(super) fn common_limits(fields: &[&ScalarCurvature], options: &ScaleOptions) -> Result<Limits> {
    let inside =
        fields.iter().map(|field| anyhow::Ok(drawn(field)?.range_without(&field.boundary)?));
    let inside: Vec<Field<'_>> = inside.collect::<Result<_>>()?;
    let scale = Scale::new(&inside.iter().collect::<Vec<_>>(), options)?;
    Ok(Limits::Fixed { low: scale.low(), high: scale.high() })
}

/// Signed errors of several estimates on one mesh, in one range.
pub(super) fn errors(
    id: &str,
    caption: &str,
    alt: &str,
    mesh: &TriMesh,
    estimates: &[(&str, ScalarCurvature)],
    occlusion: bool,
) -> Result<Picture> {
    let fields: Vec<Field<'_>> = estimates.iter().map(|(_, e)| drawn(e)).collect::<Result<_>>()?;
    let scale = Scale::new(&fields.iter().collect::<Vec<_>>(), &ScaleOptions::SIGNED)?;
    let limits = Limits::Fixed { low: scale.low(), high: scale.high() };
    let looks = estimates.iter().map(|(title, field)| {
        let options = ScaleOptions { limits, ..ScaleOptions::SIGNED };
        let (quantity, unit) = ("error of H", "1/mesh units");
        let coloring = Coloring { field, range: Range::All, options, quantity, unit };
        Look { title, mesh, coloring: Some(coloring) }
    });
    let looks = looks.collect();
    Gallery { looks, viewpoints: &VIEWPOINTS[..1], up: Up::Z, aspect: 1.6, occlusion }
        .draw(id, caption, alt)
}

/// A figure as a picture.
pub(super) fn picture(figure: &Figure, id: &str, caption: &str, alt: &str) -> Result<Picture> {
    Ok(Picture {
        id: id.into(),
        caption: caption.into(),
        alt: alt.into(),
        image: figure.draw().to_image(ZOOM)?,
        svg: None,
        links: vec![],
    })
}

/// A figure of plots: as SVG too, since it is made of lines.
pub(super) fn plotted(figure: &Figure, id: &str, caption: &str, alt: &str) -> Result<Picture> {
    Ok(Picture { svg: Some(figure.to_svg()?), ..picture(figure, id, caption, alt)? })
}
