//! Windowed sinc smoothing.

use std::f64::consts::{FRAC_1_SQRT_2, PI};

use fairing_mesh::TriMesh;
use fairing_parameters::{Options, ParameterError, Range};
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
    /// `0.5 + 0.5 cos`: ripples below a hundredth that fade, a wide transition.
    Hanning,
    /// `0.54 + 0.46 cos`: a narrower transition, ripples below a hundredth.
    Hamming,
    /// `0.42 + 0.5 cos + 0.08 cos 2`: ripples below a thousandth, a wider transition.
    Blackman,
    /// `0.355768 + 0.487396 cos + 0.144232 cos 2 + 0.012604 cos 3`: the least ripple, the widest
    /// transition; the default of VTK.
    #[default]
    Nuttall,
}

fairing_parameters::choices!(Window, "window",
    Hanning: "hanning", "Ripples below a hundredth that fade, a wide transition";
    Hamming: "hamming", "A narrower transition, ripples below a hundredth";
    Blackman: "blackman", "Ripples below a thousandth, a wider transition";
    Nuttall: "nuttall", "The least ripple, the widest transition; the default of VTK";
);
#[cfg(feature = "serde")]
fairing_parameters::serde_by_name!(Window);

impl Window {
    /// The factor of term `k` of a series that ends with term `degree`.
    fn weight(self, k: usize, degree: usize) -> f64 {
        let cosines: &[f64] = match self {
            Self::Hanning => &[0.5, 0.5],
            Self::Hamming => &[0.54, 0.46],
            Self::Blackman => &[0.42, 0.5, 0.08],
            Self::Nuttall => &[0.355768, 0.487396, 0.144232, 0.012604],
        };
        let angle = PI * k as f64 / (degree + 1) as f64;
        (0..).zip(cosines).map(|(i, a)| a * libm::cos(f64::from(i) * angle)).sum()
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
        /// The degree of the filter: a higher one cuts more sharply.
        pub degree: usize = 20;
        /// The window that tapers the series.
        pub window: Window = Window::Nuttall;
        /// Constraints of the vertices.
        pub constraints: Constraints = Constraints::NONE;
    }
    "windowed-sinc": "a sharper low-pass filter than taubin; preserves the size of finely meshed shapes best",
        ["taubin1996"],
        without [SOFT];
}

/// Smooths by one low-pass filter with uniform weights: the Chebyshev series of a step function,
/// tapered by a window.
///
/// With k = 1 − cos θ on the spectrum of `−L`, the ideal filter is 1 for θ below a cut-off θ꜀ and
/// has the coefficients `θ꜀/π` and `2 sin(jθ꜀)/(jπ)`. They are multiplied by the window and scaled
/// so that constants are preserved exactly. The cut-off is the smallest for which the gain at the
/// pass band is at least 0.999: modes within the band keep their amplitude, up to a thousandth and
/// the ripple of the window, for any band and degree. A lower degree widens the transition beyond
/// the band, so it removes less.
///
/// # Errors
///
/// [`FlowError`] if an option is out of range or a constraint is not linear, and if the degree is
/// too low for the pass band: the gain would exceed ½ on the whole spectrum. The error names the
/// lowest degree that suffices.
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
    let Some(coefficients) = coefficients(pass_band, degree, window) else {
        return Err(run.refuse(too_low(pass_band, degree, window).into()));
    };
    let series = ChebyshevSeries::new(2.0, coefficients);
    run.report.approach = Approach::Series { degree };
    run.report.iterations = 1;
    let x = series.apply(&laplacian, run.arrangement.mesh().positions());
    run.finish(x)
}

/// The least gain at the pass band.
const KEPT: f64 = 1.0 - 1e-3;

/// The coefficients of `Tⱼ(1 + μ)` for the smallest cut-off that keeps the pass band; `None` if the
/// roughest mode would then keep half its amplitude, so that the cut-off is outside the spectrum.
fn coefficients(pass_band: f64, degree: usize, window: Window) -> Option<Vec<f64>> {
    // arccos(1 − pass band), accurate also for bands with 1 − pass band = 1 in floating point.
    let edge = 2.0 * libm::asin(FRAC_1_SQRT_2 * pass_band.sqrt());
    let weights: Vec<f64> = (0..=degree).map(|j| window.weight(j, degree)).collect();
    let keeps = |cutoff: f64| gain(&with_cutoff(cutoff, &weights), edge) >= KEPT;
    // The gain rises within the main lobe of the window, which is wider than sixteen such steps.
    let step = PI / (8 * (degree + 1)) as f64;
    let steps = ((PI - edge) / step) as u32;
    let first = (0..=steps).map(|i| edge + f64::from(i) * step).find(|&cutoff| keeps(cutoff))?;
    let (mut low, mut high) = ((first - step).max(edge), first);
    for _ in 0..50 {
        let middle = 0.5 * (low + high);
        if keeps(middle) { high = middle } else { low = middle }
    }
    let coefficients = with_cutoff(high, &weights);
    (gain(&coefficients, PI) < 0.5).then_some(coefficients)
}

/// The weighted coefficients of a step function; their sum, the value at μ = 0, is one.
fn with_cutoff(cutoff: f64, weights: &[f64]) -> Vec<f64> {
    let ideal = |j: usize| match j {
        0 => cutoff / PI,
        j => 2.0 * libm::sin(j as f64 * cutoff) / (j as f64 * PI),
    };
    let mut c: Vec<f64> = (0..).zip(weights).map(|(j, weight)| ideal(j) * weight).collect();
    let sum: f64 = c.iter().sum();
    c.iter_mut().for_each(|c| *c /= sum);
    c
}

/// The factor of the mode with the eigenvalue `cos θ − 1`.
fn gain(coefficients: &[f64], angle: f64) -> f64 {
    (0..).zip(coefficients).map(|(j, c)| c * libm::cos(f64::from(j) * angle)).sum()
}

/// The highest degree that an error proposes.
const HIGHEST: usize = 1 << 12;

/// The error for a degree that is too low for the pass band, with the lowest that is not.
fn too_low(pass_band: f64, degree: usize, window: Window) -> ParameterError {
    let suffices = |degree: usize| coefficients(pass_band, degree, window).is_some();
    let (mut low, mut high) = (degree, degree.max(1));
    while high < HIGHEST && !suffices(high) {
        (low, high) = (high, 2 * high);
    }
    while high - low > 1 && high < HIGHEST {
        let middle = low.midpoint(high);
        if suffices(middle) { high = middle } else { low = middle }
    }
    let bound = if high < HIGHEST { format!("at least {high}") } else { format!("over {low}") };
    let expected = format!("{bound} for pass-band {pass_band} with window {}", window.name());
    ParameterError::range("degree", degree as f64, expected)
}

#[cfg(test)]
mod tests {
    use super::*;

    const WINDOWS: [Window; 4] =
        [Window::Hanning, Window::Hamming, Window::Blackman, Window::Nuttall];

    /// For the narrowest bands the filter tends to that of the window alone.
    #[test]
    fn narrow_bands_have_a_limit() {
        let limit = coefficients(1e-12, 20, Window::Hamming).unwrap();
        for pass_band in [1e-17, 1e-300, f64::from_bits(1)] {
            let c = coefficients(pass_band, 20, Window::Hamming).unwrap();
            for (c, limit) in c.iter().zip(&limit) {
                // The band of 1e-12 differs by its twentieth of a degree, squared.
                assert!((c - limit).abs() < 1e-9, "{pass_band:e}: {c} {limit}");
            }
        }
    }

    /// Ripples of the windows: textbook side lobes of −44, −53, −74 and −93 dB, of which a cut-off
    /// sums up a few.
    #[test]
    fn pass_bands_pass_and_rough_modes_do_not() {
        for (window, ripple) in WINDOWS.into_iter().zip([1.3e-2, 8e-3, 5e-4, 5e-5]) {
            for pass_band in [1e-3, 0.01, 0.05, 0.1, 0.3, 1.0] {
                for degree in [10, 20, 50] {
                    let c = coefficients(pass_band, degree, window).unwrap();
                    let gain = |k: f64| gain(&c, (1.0 - k).acos());
                    assert!((gain(0.0) - 1.0).abs() < 1e-12);
                    let least = KEPT - ripple;
                    for k in (0..=100).map(|i| pass_band * f64::from(i) / 100.0) {
                        let kept = least - 1e-9..1.0 + 2.0 * ripple;
                        assert!(kept.contains(&gain(k)), "{window:?} {degree} at {k}: {}", gain(k));
                    }
                    // No mode grows by more than the ripple.
                    for k in (0..=200).map(|i| f64::from(i) / 100.0) {
                        let bounds = -2.0 * ripple..1.0 + 2.0 * ripple;
                        assert!(
                            bounds.contains(&gain(k)),
                            "{window:?} {degree} at {k}: {}",
                            gain(k)
                        );
                    }
                }
            }
        }
    }

    /// A degree too low is refused, with the lowest that is accepted.
    #[test]
    fn degrees_too_low_are_refused_with_one_that_suffices() {
        for window in WINDOWS {
            for (pass_band, degree) in [(0.1, 0), (1.0, 1), (1.5, 3), (1.99, 20)] {
                assert!(coefficients(pass_band, degree, window).is_none());
                let error = too_low(pass_band, degree, window).to_string();
                let number = error.split("at least ").nth(1).unwrap().split(' ').next().unwrap();
                let proposed: usize = number.parse().unwrap();
                assert!(coefficients(pass_band, proposed, window).is_some(), "{error}");
                assert!(coefficients(pass_band, proposed - 1, window).is_none(), "{error}");
            }
        }
    }
}
