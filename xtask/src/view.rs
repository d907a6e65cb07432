//! Interactive views of the page: panels side by side with linked cameras.

use fairing_mesh::TriMesh;
use serde::{Deserialize, Serialize};

/// Panels shown side by side, with one camera, and perhaps a slider that moves
/// the vertices of all of them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct View {
    /// Unique within the experiment.
    pub id: String,
    /// The caption.
    pub caption: String,
    /// What a person who cannot see it should be told.
    pub alt: String,
    /// The figure (by id) that stands in where there is no WebGL.
    pub fallback: String,
    /// The slider, if there is one.
    pub slider: Option<Slider>,
    /// The panels, left to right.
    pub panels: Vec<Panel>,
}

/// A slider with fixed stops.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Slider {
    /// What it changes: `k`, `λ`, `iterations`.
    pub name: String,
    /// The stops, as they are labelled.
    pub stops: Vec<String>,
}

/// One mesh of a view. Single precision: a picture needs no more.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Panel {
    /// The title.
    pub title: String,
    /// Positions at each stop of the slider; one entry if it does not move.
    pub positions: Vec<Vec<[f32; 3]>>,
    /// The faces.
    pub faces: Vec<[u32; 3]>,
    /// The fields to choose from; the first is shown.
    pub fields: Vec<Field>,
}

/// Values to colour vertices by.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Field {
    /// The name, as on the colour bar.
    pub name: String,
    /// The unit, as on the colour bar.
    pub unit: String,
    /// Whether zero is the middle of the colours.
    pub signed: bool,
    /// Values at each stop of the slider; one entry if they do not change.
    pub values: Vec<Vec<f32>>,
}

impl Panel {
    /// A mesh that does not move, without fields.
    pub fn still(title: &str, mesh: &TriMesh) -> Self {
        Self {
            title: title.into(),
            positions: vec![single(mesh.positions())],
            faces: mesh.faces().to_vec(),
            fields: vec![],
        }
    }

    /// One set of positions for each stop of the slider, over the faces of
    /// `mesh`.
    pub fn moving<'a>(
        title: &str,
        mesh: &TriMesh,
        stops: impl IntoIterator<Item = &'a [[f64; 3]]>,
    ) -> Self {
        let positions = stops.into_iter().map(single).collect();
        Self { positions, ..Self::still(title, mesh) }
    }

    /// The same panel with a field that does not change with the slider.
    #[must_use]
    pub fn with_field(mut self, name: &str, unit: &str, signed: bool, values: &[f64]) -> Self {
        let values = vec![values.iter().map(|&x| x as f32).collect()];
        self.fields.push(Field { name: name.into(), unit: unit.into(), signed, values });
        self
    }
}

fn single(positions: &[[f64; 3]]) -> Vec<[f32; 3]> {
    positions.iter().map(|p| p.map(|x| x as f32)).collect()
}
