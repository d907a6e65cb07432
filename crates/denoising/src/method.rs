//! What a denoiser says of itself.

use fairing_mesh::TriMesh;
use fairing_parameters::{Algorithm, ParameterError, Values};

use super::DenoiseError;

/// What the options of a denoiser say for programs.
pub(crate) trait Method: Default {
    /// The denoiser by name.
    const ALGORITHM: &'static Algorithm;

    /// Takes the values that are given.
    fn read(&mut self, values: &Values<'_>) -> Result<(), ParameterError>;

    /// Denoises.
    fn run(&self, mesh: &TriMesh) -> Result<TriMesh, DenoiseError>;
}
