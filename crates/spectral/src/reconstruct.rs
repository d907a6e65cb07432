//! A mesh from its smoothest modes.

use fairing_mesh::TriMesh;
use ndarray::{Axis, Slice};

use crate::cluster::Split;
use crate::error::SpectralError;
use crate::spectrum::Spectrum;

/// Result of [`reconstruct`].
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct Reconstruction {
    /// The mesh.
    pub mesh: TriMesh,
    /// The cluster of eigenvalues that the number of modes splits, if any: the mesh then depends on
    /// the basis of an eigenspace, which is arbitrary and differs between processors.
    /// [`Spectrum::gap_below`] and [`Spectrum::gap_above`] give numbers that split none.
    pub split: Option<Split>,
}

/// Projects the positions of a mesh onto the first k modes: X_k = Φ Φᵀ M X.
///
/// Vertices without faces are in no mode and keep their positions. Use Neumann modes: Dirichlet
/// modes pull the boundary to the origin.
///
/// # Errors
///
/// [`SpectralError::Rows`] for a spectrum of another mesh, [`SpectralError::TooManyModes`],
/// [`SpectralError::Positions`] if the sums overflow.
///
/// Source: [vallet2008].
///
/// [vallet2008]: https://doi.org/10.1111/j.1467-8659.2008.01122.x
pub fn reconstruct(
    mesh: &TriMesh,
    spectrum: &Spectrum,
    k: usize,
) -> Result<Reconstruction, SpectralError> {
    spectrum.check_modes(k)?;
    let positions = mesh.positions_view();
    let coefficients = spectrum.transform(positions)?;
    let projected = spectrum.inverse(coefficients.slice_axis(Axis(0), Slice::from(..k)))?;
    let mass = spectrum.mass.as_mass().diagonal();
    let moved: Vec<[f64; 3]> = mesh
        .positions()
        .iter()
        .zip(projected.rows())
        .zip(mass)
        .map(|((old, new), m)| if m > 0.0 { [new[0], new[1], new[2]] } else { *old })
        .collect();
    let mesh = mesh.with_positions(moved)?;
    Ok(Reconstruction { mesh, split: spectrum.split(k) })
}

/// The error of [`reconstruct`] for k = 0 … all modes, from the coefficients alone: the M-weighted
/// RMS of the displacement, in mesh units.
///
/// # Errors
///
/// [`SpectralError::Rows`] for a spectrum of another mesh.
pub fn reconstruction_errors(
    mesh: &TriMesh,
    spectrum: &Spectrum,
) -> Result<Vec<f64>, SpectralError> {
    spectrum.truncation_errors(mesh.positions_view())
}
