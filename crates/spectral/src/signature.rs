//! Signatures of points and of shapes.

use fairing_parameters::{ParameterError, Range};
use ndarray::{Array1, Array2};

use crate::error::SpectralError;
use crate::spectrum::Spectrum;

/// Eigenvalues below this fraction of the largest count as zero.
const ZERO: f64 = 1e-10;

/// Heat kernel signature: k_t(x, x) = Σ e^(−ωᵢ t) φᵢ(x)², `n × times`, in 1/(mesh units)².
///
/// The heat at x at time t, of a unit of heat placed there at time 0; times in squared mesh units.
/// Small times need many modes: each mode beyond ω_k contributes at most the fraction e^(−ω_k t).
///
/// # Errors
///
/// [`SpectralError::Option`] for a time that is not positive.
///
/// Source: [sun2009].
///
/// [sun2009]: https://doi.org/10.1111/j.1467-8659.2009.01515.x
#[doc(alias = "hks")]
pub fn heat_kernel_signature(
    spectrum: &Spectrum,
    times: &[f64],
) -> Result<Array2<f64>, SpectralError> {
    for &time in times {
        Range::POSITIVE.check("time", time)?;
    }
    let squares = spectrum.modes.mapv(|x| x * x);
    let weights = Array2::from_shape_fn((spectrum.len(), times.len()), |(i, t)| {
        libm::exp(-spectrum.values[i] * times[t])
    });
    Ok(squares.dot(&weights))
}

/// `count` logarithmically spaced times in the range that the modes resolve, from 4 ln 10 / ω_k to
/// 4 ln 10 / ω₁, with ω₁ the first nonzero eigenvalue. Empty if there is none. Source: [sun2009].
///
/// [sun2009]: https://doi.org/10.1111/j.1467-8659.2009.01515.x
pub fn heat_kernel_times(spectrum: &Spectrum, count: usize) -> Vec<f64> {
    let Some((first, last)) = range(spectrum) else { return vec![] };
    let (from, to) =
        (libm::log(4.0 * libm::log(10.0) / last), libm::log(4.0 * libm::log(10.0) / first));
    spread(from, to, count).map(libm::exp).collect()
}

/// Wave kernel signature, `n × energies`: Σ φᵢ(x)² exp(−(e − ln ωᵢ)² / 2σ²) /
/// Σ exp(−(e − ln ωᵢ)² / 2σ²), over the ω above zero.
///
/// The probability density, by area, of finding at x a quantum particle of log-normal energy around
/// e, with the deviation σ in ln ω: those of [`wave_kernel_energies`] are those of the source. In
/// 1/(mesh units)²; zero for an energy so far from every ln ω that all weights underflow.
///
/// # Errors
///
/// [`SpectralError::Option`] for an energy that is not finite, or a σ that is not positive.
///
/// # Examples
///
/// ```
/// use fairing_operators::{Laplacian, LaplacianKind, MassKind};
/// use fairing_shapes as shapes;
/// use fairing_spectral::{
///     SpectrumOptions, spectrum, wave_kernel_energies, wave_kernel_signature,
/// };
///
/// let sphere = shapes::icosphere(3);
/// let laplacian = Laplacian::new(&sphere, LaplacianKind::Auto, MassKind::Barycentric)?;
/// let spectrum = spectrum(&laplacian, 30, &SpectrumOptions::default())?;
/// let (energies, sigma) = wave_kernel_energies(&spectrum, 10)?;
/// let signature = wave_kernel_signature(&spectrum, &energies, sigma)?;
/// // Each column is a density: its integral is 1.
/// let mass = spectrum.mass.lumped();
/// let integral = mass.iter().zip(signature.column(3)).map(|(m, s)| m * s);
/// assert!((integral.sum::<f64>() - 1.0).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// Source: [aubry2011].
///
/// [aubry2011]: https://doi.org/10.1109/ICCVW.2011.6130444
#[doc(alias = "wks")]
pub fn wave_kernel_signature(
    spectrum: &Spectrum,
    energies: &[f64],
    sigma: f64,
) -> Result<Array2<f64>, SpectralError> {
    Range::POSITIVE.check("sigma", sigma)?;
    for &energy in energies {
        ParameterError::require(energy.is_finite(), "energy", energy, "finite")?;
    }
    let last = spectrum.values.last().copied().unwrap_or(0.0);
    let positive: Vec<usize> =
        (0..spectrum.len()).filter(|&i| spectrum.values[i] > ZERO * last).collect();
    let mut weights = Array2::zeros((spectrum.len(), energies.len()));
    for (j, energy) in energies.iter().enumerate() {
        for &i in &positive {
            let d = (energy - libm::log(spectrum.values[i])) / sigma;
            weights[[i, j]] = libm::exp(-0.5 * d * d);
        }
        let total: f64 = weights.column(j).sum();
        if total > 0.0 {
            weights.column_mut(j).mapv_inplace(|w| w / total);
        }
    }
    Ok(spectrum.modes.mapv(|x| x * x).dot(&weights))
}

/// `count` energies for [`wave_kernel_signature`], evenly spaced in ln ω, and σ: seven steps. The
/// ends stay 2σ inside the range of ln ω.
///
/// # Errors
///
/// [`SpectralError::Option`] for fewer than two energies or fewer than two different ω above zero.
///
/// Source: [aubry2011].
///
/// [aubry2011]: https://doi.org/10.1109/ICCVW.2011.6130444
pub fn wave_kernel_energies(
    spectrum: &Spectrum,
    count: usize,
) -> Result<(Vec<f64>, f64), SpectralError> {
    ParameterError::require(count >= 2, "number of energies", count as f64, "at least 2")?;
    let Some((first, last)) = range(spectrum).filter(|(a, b)| a < b) else {
        let expected = "enough for two ω above zero";
        return Err(
            ParameterError::range("number of modes", spectrum.len() as f64, expected).into()
        );
    };
    let (low, high) = (libm::log(first), libm::log(last));
    // From low + 2σ to high − 2σ in count − 1 steps of length d, with σ = 7d.
    let step = (high - low) / (count as f64 - 1.0 + 28.0);
    let sigma = 7.0 * step;
    Ok((spread(low + 2.0 * sigma, high - 2.0 * sigma, count).collect(), sigma))
}

/// Global point signature: φᵢ(x) / √ωᵢ for the modes with ω above zero, `n × modes`, dimensionless.
///
/// Distances between rows do not change with the pose; signs, and bases of multiple eigenvalues,
/// are as arbitrary as those of the modes. Source: [rustamov2007].
///
/// [rustamov2007]: https://dl.acm.org/doi/10.5555/1281991.1282022
#[doc(alias = "gps")]
pub fn global_point_signature(spectrum: &Spectrum) -> Array2<f64> {
    let largest = spectrum.values.last().copied().unwrap_or(0.0);
    let zeros = spectrum.values.iter().take_while(|l| **l <= ZERO * largest).count();
    let mut signature = Array2::zeros((spectrum.vertex_count(), spectrum.len() - zeros));
    for (mut column, i) in signature.columns_mut().into_iter().zip(zeros..) {
        column.assign(&spectrum.modes.column(i));
        column /= spectrum.values[i].sqrt();
    }
    signature
}

/// ShapeDNA: the eigenvalues times the area, invariant under scaling; zeros included.
/// Source: [reuter2006].
///
/// [reuter2006]: https://doi.org/10.1016/j.cad.2005.10.011
#[doc(alias("compute_shapedna", "shapedna"))]
pub fn shape_dna(spectrum: &Spectrum) -> Array1<f64> {
    Array1::from(spectrum.values.clone()) * spectrum.area()
}

/// Smallest ω above zero and largest.
fn range(spectrum: &Spectrum) -> Option<(f64, f64)> {
    let last = *spectrum.values.last()?;
    let first = spectrum.values.iter().copied().find(|l| *l > ZERO * last)?;
    (last > 0.0).then_some((first, last))
}

fn spread(from: f64, to: f64, count: usize) -> impl Iterator<Item = f64> {
    let steps = count.saturating_sub(1).max(1) as f64;
    (0..count).map(move |i| from + (to - from) * i as f64 / steps)
}
