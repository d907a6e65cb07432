//! Adding noise to a mesh.

use fairing_evaluation::{NoiseKind, NoiseLevel};
use fairing_mesh::Tolerance;

/// The unit of a level of noise or of a tolerance.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Unit {
    /// Mean edge lengths.
    Edge,
    /// Units of the file.
    Model,
    /// Diagonals of the bounding box.
    Diagonal,
}

fairing_parameters::choices!(Unit, "unit of noise",
    Edge: "edge", "mean edge lengths";
    Model: "model", "units of the file";
    Diagonal: "diagonal", "diagonals of the bounding box";
);

impl Unit {
    /// A level of noise in this unit.
    pub fn level(self, sigma: f64) -> NoiseLevel {
        match self {
            Self::Edge => NoiseLevel::EdgeLengths(sigma),
            Self::Model => NoiseLevel::Model(sigma),
            Self::Diagonal => NoiseLevel::Diagonals(sigma),
        }
    }

    /// A tolerance in this unit.
    pub fn tolerance(self, length: f64) -> Tolerance {
        match self {
            Self::Edge => Tolerance::EdgeLengths(length),
            Self::Model => Tolerance::Model(length),
            Self::Diagonal => Tolerance::Diagonals(length),
        }
    }
}

/// The kind of noise with the parameters that are given: the fraction of vertices, the correlation
/// length in mean edge lengths, and the position of the camera.
///
/// # Errors
///
/// The name of the first parameter that the kind does not have.
pub fn noise_kind(
    kind: NoiseKind,
    fraction: Option<f64>,
    length: Option<f64>,
    camera: Option<[f64; 3]>,
) -> Result<NoiseKind, &'static str> {
    let kind = fraction.map_or(Some(kind), |x| kind.with_fraction(x)).ok_or("fraction")?;
    let kind = length.map_or(Some(kind), |x| kind.with_length(x)).ok_or("length")?;
    camera.map_or(Some(kind), |x| kind.with_camera(x)).ok_or("camera")
}
