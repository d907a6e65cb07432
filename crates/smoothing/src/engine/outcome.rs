//! Results of flows.

use std::fmt;

use fairing_mesh::TriMesh;
use fairing_spectral::Split;

/// A smoothed mesh and the report of its flow.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct Smoothed {
    /// The mesh, with vertices and faces in the input's order.
    pub mesh: TriMesh,
    /// The report of the flow.
    pub report: Report,
}

/// Report of a flow.
#[derive(Debug, Clone, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Report {
    /// The number of steps taken.
    pub iterations: usize,
    /// True if the flow ended before its last step: by its observer, or because the mesh had shrunk
    /// to a point.
    pub stopped: bool,
    /// For explicit methods, the largest step for which no mode grows: proven for uniform weights,
    /// measured for cotangent weights; in the unit of the factor of `L` (squared mesh units for
    /// cotangents). `None` for uniform λ ≤ 1, which is stable on every mesh.
    pub stable_limit: Option<f64>,
    /// True if steps beyond the stable limit were taken.
    pub unstable: bool,
    /// The first face of the input too thin for cotangents, if
    /// [`LaplacianKind::Auto`](fairing_operators::LaplacianKind::Auto) took the robust Laplacian
    /// because of it.
    pub too_thin: Option<u32>,
    /// The number of faces that became degenerate during a flow with an updated operator, and whose
    /// sides were lengthened. A face counts once.
    pub degenerate_faces: usize,
    /// The method that computed the steps.
    pub approach: Approach,
    /// The largest relative residual of all linear systems solved.
    pub worst_residual: Option<f64>,
    /// For a projection on modes, the cluster of eigenvalues split by the number of modes, if any,
    /// with the nearest numbers that split none. The result then depends on the arbitrary basis of
    /// an eigenspace and may differ between processors.
    pub split: Option<Split>,
}

/// Methods that compute the steps of a flow. All give the same result within their tolerances.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum Approach {
    /// Steps one after another, by products with the Laplacian.
    #[default]
    Stepping,
    /// All steps at once, by one or more Chebyshev series in the Laplacian.
    Series {
        /// The total degree: the number of products with the Laplacian.
        degree: usize,
    },
    /// A filter evaluated as a Chebyshev series in the resolvent `(I − τL)⁻¹`, factored once.
    Resolvent {
        /// The degree: the number of linear systems solved.
        degree: usize,
    },
    /// A projection on modes.
    Modes {
        /// The number of modes.
        count: usize,
    },
    /// Steps one after another, by conjugate gradients.
    ConjugateGradients {
        /// The number of iterations of all steps.
        iterations: usize,
    },
    /// Steps one after another, by sparse Cholesky factorisation.
    Cholesky {
        /// The number of numeric factorisations.
        factorisations: usize,
    },
}

impl fmt::Display for Approach {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Stepping => write!(f, "steps"),
            Self::Series { degree } => write!(f, "series of degree {degree}"),
            Self::Resolvent { degree } => write!(f, "series of degree {degree} in the resolvent"),
            Self::ConjugateGradients { iterations } => {
                write!(f, "conjugate gradients, {iterations} iterations")
            }
            Self::Modes { count } => write!(f, "{count} modes"),
            Self::Cholesky { factorisations } => write!(f, "Cholesky, {factorisations} factors"),
        }
    }
}
