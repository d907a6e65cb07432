//! Errors of denoisers.

use fairing_mesh::BuildError;
use fairing_parameters::ParameterError;
use fairing_sparse::{CgOptions, CgSolution};

/// The reason for which a mesh cannot be denoised.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DenoiseError {
    /// An option is outside the range where the method is defined.
    #[error(transparent)]
    Option(#[from] ParameterError),
    /// A linear system was not solved to its tolerance.
    #[error(
        "the linear system of step {step} kept a relative residual of {residual:e} after {iterations} iterations"
    )]
    NotSolved {
        /// The outer step, from 0.
        step: usize,
        /// Iterations of the solver.
        iterations: usize,
        /// ‖b − A x‖ / ‖b‖.
        residual: f64,
    },
    /// The trained numbers of the automatic denoiser do not have their checksum.
    #[error(
        "the trained numbers of the automatic denoiser were damaged when the program was built"
    )]
    Model,
    /// Most vertices lie where another one does: the faces do not share their corners
    /// ([`TriMesh::is_unwelded`](fairing_mesh::TriMesh::is_unwelded)).
    #[error(
        "{seams} of {vertices} vertices coincide with another vertex: the faces do not share \
         their corners, so that no face has neighbours; weld the mesh first"
    )]
    Unwelded {
        /// Boundary vertices that coincide with another one.
        seams: usize,
        /// All vertices.
        vertices: usize,
    },
    /// The positions reached do not make a mesh.
    #[error(transparent)]
    Build(#[from] BuildError),
}

/// Returns the solution of the linear system of outer step `step`; an error if its residual exceeds
/// ten times the tolerance.
pub(crate) fn solved(
    solution: CgSolution,
    options: &CgOptions,
    step: usize,
) -> Result<Vec<[f64; 3]>, DenoiseError> {
    let CgSolution { x, iterations, residual, .. } = solution;
    if residual <= 10.0 * options.tolerance {
        return Ok(x);
    }
    Err(DenoiseError::NotSolved { step, iterations, residual })
}
