//! Choice between the cotangent and the robust Laplacian.

use std::fmt;

use fairing_mesh::TriMesh;
use fairing_sparse::SparseMatrix;

use crate::corners::check_faces;
use crate::error::OperatorError;
use crate::kind::{LaplacianKind, MassKind};
use crate::stiffness::cotan_stiffness;

/// Weights below zero by more than this fraction of the diagonal are negative;
/// less is rounding.
const ROUNDING: f64 = 1e-10;

/// Reason for the kind of a [`Laplacian`](super::Laplacian).
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum Reason {
    /// The kind was requested.
    Asked,
    /// [`LaplacianKind::Auto`] found cotangents in every face.
    Sound,
    /// [`LaplacianKind::Auto`] with a mass that only cotangents have.
    Mass,
    /// [`LaplacianKind::NonNegative`] found no weight below zero.
    NonNegative,
    /// A face is too thin for its cotangents.
    ThinFace {
        /// The first such face.
        face: u32,
        /// Its area, in squared mesh units.
        area: f64,
        /// Its longest edge, in mesh units.
        edge: f64,
    },
    /// [`LaplacianKind::NonNegative`] found an edge that is not Delaunay.
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
            Self::Sound => write!(f, "no face is too thin for cotangents"),
            Self::Mass => write!(f, "only the cotangent Laplacian has this mass"),
            Self::NonNegative => write!(f, "no edge has a negative weight"),
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

/// The kind that `kind` stands for on a mesh, and the reason.
///
/// The only place that decides between cotangents and the robust Laplacian, for
/// matrices, curvature, flows and distances: [`LaplacianKind::Auto`] and
/// [`LaplacianKind::NonNegative`] are one of the two,
/// [`LaplacianKind::Polygon`] is [`LaplacianKind::Cotangent`] on triangles, and
/// the others are themselves.
///
/// # Errors
///
/// [`OperatorError::TooLarge`] for [`LaplacianKind::NonNegative`], as
/// [`cotan_stiffness`].
///
/// # Examples
///
/// ```
/// use fairing_operators::{LaplacianKind, MassKind, Reason, choose};
/// use fairing_shapes as shapes;
///
/// let sphere = shapes::icosphere(2);
/// let found = choose(&sphere, LaplacianKind::Auto, MassKind::Barycentric)?;
/// assert_eq!(found, (LaplacianKind::Cotangent, Reason::Sound));
/// # Ok::<(), fairing_operators::OperatorError>(())
/// ```
pub fn choose(
    mesh: &TriMesh,
    kind: LaplacianKind,
    mass: MassKind,
) -> Result<(LaplacianKind, Reason), OperatorError> {
    let Choice { kind, reason, .. } = resolve(mesh, kind, mass, || cotan_stiffness(mesh))?;
    Ok((kind, reason))
}

/// Result of [`choose`], with the cotangent stiffness where the choice needed it.
pub(super) struct Choice {
    pub(super) kind: LaplacianKind,
    pub(super) reason: Reason,
    pub(super) stiffness: Option<SparseMatrix>,
}

/// [`choose`], with the function that assembles the cotangent stiffness of the mesh.
pub(super) fn resolve(
    mesh: &TriMesh,
    kind: LaplacianKind,
    mass: MassKind,
    cotangents: impl FnOnce() -> Result<SparseMatrix, OperatorError>,
) -> Result<Choice, OperatorError> {
    let taken = |kind, reason| Choice { kind, reason, stiffness: None };
    let (cotangent, robust) = (LaplacianKind::Cotangent, LaplacianKind::Robust);
    let found = match kind {
        LaplacianKind::Auto if mass != MassKind::Barycentric => Ok(taken(cotangent, Reason::Mass)),
        LaplacianKind::Auto => check_faces(mesh).map(|()| taken(cotangent, Reason::Sound)),
        LaplacianKind::NonNegative => {
            cotangents().map(|stiffness| match negative_weight(&stiffness) {
                Some(reason) => taken(robust, reason),
                None => {
                    Choice { stiffness: Some(stiffness), ..taken(cotangent, Reason::NonNegative) }
                }
            })
        }
        LaplacianKind::Polygon => Ok(taken(cotangent, Reason::Asked)),
        LaplacianKind::Uniform | LaplacianKind::Cotangent | LaplacianKind::Robust => {
            Ok(taken(kind, Reason::Asked))
        }
    };
    match found {
        Err(OperatorError::DegenerateFace { face, area, edge }) => {
            Ok(taken(robust, Reason::ThinFace { face, area, edge }))
        }
        found => found,
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
