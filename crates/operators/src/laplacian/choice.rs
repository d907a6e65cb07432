//! The one place that says which Laplacian a mesh gets.

use std::fmt;

use fairing_sparse::SparseMatrix;

use super::kind::MassKind;
use crate::error::OperatorError;

/// Weights below zero by more than this share of the diagonal are negative;
/// less is rounding.
const ROUNDING: f64 = 1e-10;

/// Why a [`Laplacian`](super::Laplacian) is of its kind.
///
/// Auto is [`LaplacianKind::Auto`](super::LaplacianKind::Auto).
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum Reason {
    /// It was requested.
    Asked,
    /// Auto found no weight that is negative.
    Sound,
    /// Auto with a mass that only cotangents have.
    Mass,
    /// Auto found a face too thin for its cotangents.
    ThinFace {
        /// The first such face.
        face: u32,
        /// Its area, in squared mesh units.
        area: f64,
        /// Its longest edge, in mesh units.
        edge: f64,
    },
    /// Auto found an edge that is not Delaunay.
    NegativeWeight {
        /// The ends of the first such edge.
        edge: [u32; 2],
        /// Its weight ½ (cot α + cot β).
        weight: f64,
    },
}

impl fmt::Display for Reason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Asked => write!(f, "asked for"),
            Self::Sound => write!(f, "no edge has a negative weight"),
            Self::Mass => write!(f, "only the cotangent Laplacian has this mass"),
            Self::ThinFace { face, area, edge } => {
                write!(
                    f,
                    "face {face} is too thin for cotangents: area {area:e}, longest edge {edge:e}"
                )
            }
            Self::NegativeWeight { edge: [a, b], weight } => {
                write!(f, "edge ({a}, {b}) has the negative weight {weight:e}")
            }
        }
    }
}

/// What [`LaplacianKind::Auto`](super::LaplacianKind::Auto) takes, and why, given the cotangent stiffness: that
/// stiffness, or `None` for the robust Laplacian.
pub(super) fn choose(
    stiffness: Result<SparseMatrix, OperatorError>,
    mass: MassKind,
) -> Result<(Reason, Option<SparseMatrix>), OperatorError> {
    if mass != MassKind::Barycentric {
        return Ok((Reason::Mass, Some(stiffness?)));
    }
    match stiffness {
        Ok(stiffness) => Ok(match negative_weight(&stiffness) {
            Some(reason) => (reason, None),
            None => (Reason::Sound, Some(stiffness)),
        }),
        Err(OperatorError::DegenerateFace { face, area, edge }) => {
            Ok((Reason::ThinFace { face, area, edge }, None))
        }
        Err(error) => Err(error),
    }
}

/// The first edge with a weight below zero.
fn negative_weight(stiffness: &SparseMatrix) -> Option<Reason> {
    stiffness.outer_iterator().enumerate().find_map(|(i, row)| {
        let limit = ROUNDING * row.get(i).copied().unwrap_or(0.0).abs();
        let bad = row.iter().find(|&(j, &s)| j != i && s > limit);
        bad.map(|(j, &s)| Reason::NegativeWeight { edge: [i as u32, j as u32], weight: -s })
    })
}
