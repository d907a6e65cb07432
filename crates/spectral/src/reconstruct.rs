//! A mesh from its smoothest modes, or from few, rounded coefficients.

use fairing_mesh::TriMesh;
use fairing_parameters::Range;
use ndarray::{Array2, Axis, Slice};

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

/// Coefficients of the positions of a mesh, rounded to multiples of a step.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Compressed {
    /// The step, in squared mesh units like the coefficients.
    pub step: f64,
    /// The multiples, `k × 3`.
    pub levels: Array2<i64>,
    /// M-weighted RMS error in mesh units, of truncation and rounding together: exact, since modes
    /// are orthonormal and rounding errors are measured.
    pub error: f64,
    /// The cluster of eigenvalues that the number of coefficients splits, if any: levels and error
    /// then depend on the basis of an eigenspace.
    pub split: Option<Split>,
}

/// Keeps the first k coefficients, rounded so that rounding alone costs an M-weighted RMS of
/// `precision`, in mesh units.
///
/// # Errors
///
/// [`SpectralError::TooManyModes`], [`SpectralError::Rows`], [`SpectralError::Option`].
///
/// Source: [karni2000], in the inner product of the mass.
///
/// [karni2000]: https://doi.org/10.1145/344779.344924
pub fn compress(
    mesh: &TriMesh,
    spectrum: &Spectrum,
    k: usize,
    precision: f64,
) -> Result<Compressed, SpectralError> {
    spectrum.check_modes(k)?;
    Range::POSITIVE.check("precision", precision)?;
    let positions = mesh.positions_view();
    let truncation = spectrum.truncation_errors(positions)?[k];
    let area = spectrum.area();
    // A rounded coefficient has an RMS error of step/√12; 3k of them share the area.
    let step = precision * (12.0 * area / (3 * k.max(1)) as f64).sqrt();
    let coefficients = spectrum.transform(positions)?;
    let kept = coefficients.slice_axis(Axis(0), Slice::from(..k));
    let levels = kept.mapv(|c| (c / step).round() as i64);
    let rounding: f64 = kept.iter().zip(&levels).map(|(c, l)| (c - *l as f64 * step).powi(2)).sum();
    let error = (truncation * truncation + rounding / area).sqrt();
    Ok(Compressed { step, levels, error, split: spectrum.split(k) })
}

impl Compressed {
    /// Restores the positions, `n × 3`, from the modes used for compression.
    ///
    /// # Errors
    ///
    /// [`SpectralError::TooManyModes`] for a spectrum with fewer modes.
    pub fn positions(&self, spectrum: &Spectrum) -> Result<Array2<f64>, SpectralError> {
        spectrum.inverse(self.levels.mapv(|l| l as f64 * self.step).view())
    }

    /// Bits that an ideal entropy coder needs for the levels: their Shannon entropy.
    pub fn bits(&self) -> f64 {
        let mut counts = std::collections::BTreeMap::new();
        for level in &self.levels {
            *counts.entry(*level).or_insert(0usize) += 1;
        }
        let total = self.levels.len() as f64;
        counts.values().map(|&c| -(c as f64) * libm::log2(c as f64 / total)).sum()
    }
}
