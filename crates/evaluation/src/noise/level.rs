//! Levels of noise.

use fairing_mesh::TriMesh;

/// The noise level σ, in the unit of the variant's name.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum NoiseLevel {
    /// In mesh units.
    Model(f64),
    /// In mean edge lengths h, an edge counted once for each of its faces.
    EdgeLengths(f64),
    /// In diagonals of the bounding box.
    Diagonals(f64),
}

impl NoiseLevel {
    /// The level on this mesh, in mesh units.
    pub fn in_mesh_units(self, mesh: &TriMesh) -> f64 {
        match self {
            Self::Model(sigma) => sigma,
            Self::EdgeLengths(share) => share * mesh.mean_edge_length(),
            Self::Diagonals(share) => share * mesh.diagonal(),
        }
    }
}
