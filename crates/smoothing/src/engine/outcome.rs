//! What a flow returns.

use fairing_mesh::TriMesh;
use fairing_spectral::Split;

/// A smoothed mesh and how it came about.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct Smoothed {
    /// The mesh, vertices and faces in the order of the input.
    pub mesh: TriMesh,
    /// How it came about.
    pub report: Report,
}

/// How a flow went.
#[derive(Debug, Clone, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Report {
    /// Steps taken.
    pub iterations: usize,
    /// Whether the flow ended before its last step: an observer ended it, or the mesh had become a point.
    pub stopped: bool,
    /// For explicit methods, the largest step for which no mode grows: proven for uniform weights, measured for
    /// cotangents; in the unit of the factor of `L` (squared mesh units for cotangents). `None` for uniform λ ≤ 1,
    /// which is stable on every mesh, so that no limit was looked for.
    pub stable_limit: Option<f64>,
    /// Whether steps beyond the stable limit were taken.
    pub unstable: bool,
    /// The first face of the input that is too thin for cotangents, for which
    /// [`LaplacianKind::Auto`](fairing_operators::LaplacianKind::Auto) took the robust Laplacian.
    pub too_thin: Option<u32>,
    /// The faces that became degenerate on the way, whose sides were lengthened: for flows that assemble their operator
    /// again in each step. A face counts once.
    pub degenerate_faces: usize,
    /// How the steps were computed.
    pub approach: Approach,
    /// The largest relative residual of all linear systems solved.
    pub worst_residual: Option<f64>,
    /// For a projection on modes, the cluster of eigenvalues that their number splits, if any: the mesh then depends on
    /// the basis of an eigenspace, which is arbitrary, and differs between processors. It names the nearest numbers of
    /// modes that split none.
    pub split: Option<Split>,
}

/// How the steps of a flow were computed. All give the same result within their tolerances.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum Approach {
    /// One after another, by products with the Laplacian alone.
    #[default]
    Stepping,
    /// All at once, by a Chebyshev series of this degree, or several one after another of this degree in all.
    Series {
        /// The number of products with the Laplacian.
        degree: usize,
    },
    /// All at once, by a Chebyshev series of this degree in the resolvent `(I − τL)⁻¹`, factored once.
    Resolvent {
        /// The number of linear systems solved.
        degree: usize,
    },
    /// At once, by projection on modes.
    Modes {
        /// The number of modes.
        count: usize,
    },
    /// One after another, by conjugate gradients.
    ConjugateGradients {
        /// Iterations over all steps.
        iterations: usize,
    },
    /// One after another, by sparse Cholesky factorisation.
    Cholesky {
        /// The number of numeric factorisations.
        factorisations: usize,
    },
}
