//! Windowed sinc smoothing.

use std::f64::consts::{FRAC_1_SQRT_2, PI};

use fairing_mesh::TriMesh;
use fairing_parameters::{Options, Range};
use fairing_sparse::ChebyshevSeries;

use crate::engine::assemble::uniform;
use crate::engine::constraints::{Constraints, SOFT};
use crate::engine::error::{FlowError, FlowFailure};
use crate::engine::outcome::{Approach, Smoothed};
use crate::engine::run::{Run, RunSettings};

/// Windows that taper the Chebyshev series of the ideal filter, from 1 at its first term to nearly
/// 0 at its last.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Window {
    /// `0.5 + 0.5 cos`: almost no ripple, a wide transition.
    Hanning,
    /// `0.54 + 0.46 cos`: a narrower transition, ripples below a hundredth; the window of VTK.
    #[default]
    Hamming,
    /// `0.42 + 0.5 cos + 0.08 cos 2`: the least ripple, the widest transition.
    Blackman,
}

fairing_parameters::choices!(Window, "window",
    Hanning: "hanning", "Almost no ripple, a wide transition";
    Hamming: "hamming", "A narrower transition, ripples below a hundredth";
    Blackman: "blackman", "The least ripple, the widest transition";
);
#[cfg(feature = "serde")]
fairing_parameters::serde_by_name!(Window);

impl Window {
    /// The factor of term `k` of a series that ends with term `degree`.
    fn weight(self, k: usize, degree: usize) -> f64 {
        let angle = PI * k as f64 / (degree + 1) as f64;
        match self {
            Self::Hanning => 0.5 + 0.5 * libm::cos(angle),
            Self::Hamming => 0.54 + 0.46 * libm::cos(angle),
            Self::Blackman => 0.42 + 0.5 * libm::cos(angle) + 0.08 * libm::cos(2.0 * angle),
        }
    }
}

fairing_parameters::options! {
    /// Options of [`windowed_sinc`].
    #[derive(Debug, Clone, PartialEq)]
    #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
    #[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
    pub struct WindowedSinc {
        /// The pass band: modes with a smaller −eigenvalue are preserved (0 to 2).
        pub pass_band: f64 = 0.1, in Range::above(0.0).below(2.0);
        /// The degree of the filter.
        pub degree: usize = 20;
        /// The window that tapers the series.
        pub window: Window = Window::Hamming;
        /// Constraints of the vertices.
        pub constraints: Constraints = Constraints::NONE;
    }
    "windowed-sinc": "a sharper low-pass filter than taubin; preserves the size of finely meshed shapes best",
        ["taubin1996"],
        without [SOFT];
}

/// Smooths by one low-pass filter with uniform weights: the Chebyshev series of the step function
/// at the pass band, tapered by a window.
///
/// With k = 1 − cos θ on the spectrum of `−L`, the ideal filter is 1 for θ below
/// `θ₀ = arccos(1 − pass band)` and has the coefficients `θ₀/π` and `2 sin(jθ₀)/(jπ)`. They are
/// multiplied by the window and scaled so that constants are preserved exactly. No mode grows by
/// more than the ripple of the window, and low modes hardly change: less shrinkage than λ|μ
/// smoothing for the same number of products.
///
/// # Errors
///
/// [`FlowError`] if an option is out of range or a constraint is not linear.
///
/// # Examples
///
/// ```
/// use fairing_shapes as shapes;
/// use fairing_smoothing::{WindowedSinc, windowed_sinc};
///
/// let smoothed = windowed_sinc(&shapes::icosphere(4), &WindowedSinc::default())?;
/// let radius = smoothed.mesh.positions()[0].iter().map(|x| x * x).sum::<f64>().sqrt();
/// assert!((radius - 1.0).abs() < 0.01);
/// # Ok::<(), fairing_smoothing::FlowError>(())
/// ```
///
/// Source: \[taubin1996\].
#[doc(alias = "vtkWindowedSincPolyDataFilter")]
pub fn windowed_sinc(mesh: &TriMesh, options: &WindowedSinc) -> Result<Smoothed, FlowError> {
    let WindowedSinc { pass_band, degree, window, .. } = *options;
    options.check().map_err(|error| FlowFailure::from(error).before(mesh))?;
    let settings = RunSettings::new(&options.constraints, 1);
    let mut run = Run::new(mesh, &settings, None)?;
    if !run.is_linear() {
        let reason = "a windowed sinc filter supports free and pinned vertices only";
        return Err(run.refuse(FlowFailure::Unsupported { reason }));
    }
    let laplacian = uniform(run.arrangement.mesh(), &run.freedom.fixed);
    let series = ChebyshevSeries::new(2.0, coefficients(pass_band, degree, window));
    run.report.approach = Approach::Series { degree };
    run.report.iterations = 1;
    let x = series.apply(&laplacian, run.arrangement.mesh().positions());
    run.finish(x)
}

/// The windowed coefficients of `Tⱼ(1 + μ)`; their sum, the value at μ = 0, is one.
fn coefficients(pass_band: f64, degree: usize, window: Window) -> Vec<f64> {
    // arccos(1 − pass band), accurate also for bands with 1 − pass band = 1 in floating point.
    let edge = 2.0 * libm::asin(FRAC_1_SQRT_2 * pass_band.sqrt());
    let mut c: Vec<f64> = (0..=degree)
        .map(|j| {
            let ideal = match j {
                0 => edge / PI,
                j => 2.0 * libm::sin(j as f64 * edge) / (j as f64 * PI),
            };
            ideal * window.weight(j, degree)
        })
        .collect();
    let sum: f64 = c.iter().sum();
    for c in &mut c {
        *c /= sum;
    }
    c
}

#[cfg(test)]
mod tests {
    use super::*;

    fn response(c: &[f64], k: f64) -> f64 {
        let angle = (1.0 - k).acos();
        c.iter().enumerate().map(|(j, c)| c * (j as f64 * angle).cos()).sum()
    }

    /// For the narrowest bands the filter tends to that of the window alone.
    #[test]
    fn narrow_bands_have_a_limit() {
        let limit = coefficients(1e-12, 20, Window::Hamming);
        for pass_band in [1e-17, 1e-300, f64::from_bits(1)] {
            let c = coefficients(pass_band, 20, Window::Hamming);
            for (c, limit) in c.iter().zip(&limit) {
                // The band of 1e-12 differs by its twentieth of a degree, squared.
                assert!((c - limit).abs() < 1e-9, "{pass_band:e}: {c} {limit}");
            }
        }
    }

    #[test]
    fn constants_pass_and_rough_modes_do_not() {
        // Ripples of the windows: textbook side lobes of −44, −53 and −74 dB.
        for (window, ripple) in
            [(Window::Hanning, 7e-3), (Window::Hamming, 4e-3), (Window::Blackman, 1e-3)]
        {
            let c = coefficients(0.3, 60, window);
            assert!((response(&c, 0.0) - 1.0).abs() < 1e-12);
            for i in 0..=100 {
                let k = 0.6 + 1.4 * f64::from(i) / 100.0;
                assert!(response(&c, k).abs() < ripple, "{window:?} at {k}: {}", response(&c, k));
            }
            for i in 0..=100 {
                let k = 0.1 * f64::from(i) / 100.0;
                assert!((response(&c, k) - 1.0).abs() < 2.0 * ripple, "{window:?} at {k}");
            }
        }
    }
}
