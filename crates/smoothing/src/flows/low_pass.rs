//! Spectral low-pass filters.

use std::ops::{Bound, ControlFlow};

use fairing_mesh::TriMesh;
use fairing_operators::{Laplacian, LaplacianKind, LumpedArea};
use fairing_parameters::{Field, Kind, Options, Parameter, ParameterError, Range, Value, Values};
use fairing_spectral::{Reconstruction, SpectrumOptions, reconstruct, spectrum};

use crate::engine::constraints::{Constraints, SOFT};
use crate::engine::diffusion::{Diffusion, TIME, Time, check_areas, chosen};
use crate::engine::error::{FlowError, FlowFailure};
use crate::engine::outcome::{Approach, Report, Smoothed};
use crate::engine::resolvent::Resolvent;
use crate::engine::response::Response;
use crate::engine::run::{Run, RunSettings};
use crate::engine::series::at_once;

/// The transfer function of a filter: the factor of the mode of eigenvalue ω of `S φ = ω M φ`.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum Transfer {
    /// `exp(−ωt)`: exact diffusion over the time t, the limit of infinitely many small steps.
    Heat(Time),
    /// `1/(1 + (ω/ω₀)^order)`: flat up to ω₀, ½ at ω₀, decaying with this order beyond.
    Butterworth {
        /// ω₀, in one over squared mesh units. Features of size w (half a wavelength) have ω ≈
        /// (π/w)².
        cutoff: f64,
        /// The order of decay, 1 to 16.
        order: u32,
    },
    /// 1 for the k smallest eigenvalues, 0 beyond: the ideal low-pass filter, a projection on the k
    /// smoothest modes, which are computed. If k splits a cluster of nearly equal eigenvalues, the
    /// choice among their modes is arbitrary, and [`Report::split`] says so. Supports neither
    /// constraints nor Voronoi areas.
    Modes(usize),
}

const CUTOFF: &str = "cutoff";
const ORDER: &str = "order";
const MODES: &str = "modes";
const ORDERS: Range = Range::new(Bound::Included(1.0), Bound::Included(16.0));

impl Field for Transfer {
    fn parameters(&self, _: Parameter) -> Vec<Parameter> {
        vec![
            Parameter {
                unit: "squared units of the file",
                range: Range::NOT_NEGATIVE,
                ..Parameter::new(TIME, Kind::Number, "The diffusion time")
            },
            Parameter {
                unit: "units of the file",
                range: Range::POSITIVE,
                excludes: &[TIME],
                ..Parameter::new(
                    CUTOFF,
                    Kind::Number,
                    "The wavelength that a Butterworth filter halves",
                )
            },
            Parameter {
                range: ORDERS,
                default: Some(Value::Count(BUTTERWORTH_ORDER as usize)),
                ..Parameter::new(ORDER, Kind::Count, "The steepness of a Butterworth filter")
            },
            Parameter {
                excludes: &[TIME, CUTOFF],
                ..Parameter::new(MODES, Kind::Count, "The number of smoothest modes to project on")
            },
        ]
    }

    fn read(&mut self, _: &'static str, values: &Values) -> Result<(), ParameterError> {
        if values.get(ORDER).is_some() && values.get(CUTOFF).is_none() {
            let expected = "left out without cutoff: it is the steepness of a Butterworth filter";
            return Err(values.refuse(ORDER, expected));
        }
        if let Some(time) = values.number(TIME) {
            *self = Self::Heat(Time::SquaredUnits(time));
        }
        if let Some(wavelength) = values.number(CUTOFF) {
            let cutoff = (2.0 * std::f64::consts::PI / wavelength).powi(2);
            let order = values.count(ORDER).map_or(BUTTERWORTH_ORDER, |order| order as u32);
            // Outside the spectrum of every mesh, yet powers neither overflow nor underflow.
            *self = Self::Butterworth { cutoff: cutoff.clamp(1e-150, 1e150), order };
        }
        if let Some(modes) = values.count(MODES) {
            *self = Self::Modes(modes);
        }
        Ok(())
    }

    fn check(&self, _: &'static str, _: Range) -> Result<(), ParameterError> {
        match *self {
            Self::Heat(time) => Range::NOT_NEGATIVE.check(TIME, time.value()),
            Self::Butterworth { cutoff, order } => {
                Range::POSITIVE.check(CUTOFF, cutoff)?;
                ORDERS.check(ORDER, f64::from(order))
            }
            // The spectrum checks the number of modes.
            Self::Modes(_) => Ok(()),
        }
    }
}

/// The default order of a Butterworth filter.
const BUTTERWORTH_ORDER: u32 = 2;

fairing_parameters::options! {
    /// Options of [`low_pass`].
    #[derive(Debug, Clone, PartialEq)]
    #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
    #[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
    pub struct LowPass {
        /// The factor of each mode.
        pub transfer: Transfer = Transfer::Heat(Time::SquaredEdges(5.0));
        /// The areas of vertices for cotangents.
        pub area: LumpedArea = LumpedArea::Barycentric;
        /// The kind of cotangent Laplacian; auto means cotangent for areas other than barycentric.
        pub kind: LaplacianKind = LaplacianKind::Auto, name "operator";
        /// Constraints of the vertices.
        pub constraints: Constraints = Constraints::NONE;
    }
    "low-pass": "filters the cotangent spectrum in units of the file; strong noise on smooth shapes (--modes)",
        ["vallet2008"],
        without [SOFT];
    then |options, values| check_areas(options.kind, options.area, values);
}

impl LowPass {
    /// A filter with barycentric areas, without constraints.
    pub fn new(transfer: Transfer) -> Self {
        Self { transfer, ..Self::DEFAULT }
    }
}

/// Smooths by a filter of the spectrum of the cotangent Laplacian, `x' = g(M⁻¹S) x`. The spectrum
/// is computed only for [`Transfer::Modes`].
///
/// In terms of the modes, `x' = Σ g(ωᵢ) φᵢ (φᵢᵀ M x)`. The sum is evaluated by a Chebyshev series
/// of g with an error of at most 2.1e-10, whose degree grows with the square root of the ratio of
/// the largest eigenvalue to the cut-off. If the series would exceed two thousand products, a
/// series in the resolvent `(I − τL)⁻¹` is used instead, of degree 25 for heat and 30 to 250 for
/// Butterworth filters, with one factorisation. The area-weighted centroid of each component is
/// preserved.
///
/// # Errors
///
/// [`FlowError`] if an option is out of range, if a constraint is not linear, if a face is too thin
/// for cotangents, or if a system cannot be factored.
///
/// # Examples
///
/// ```
/// use fairing_shapes as shapes;
/// use fairing_smoothing::{LowPass, Time, Transfer, low_pass};
///
/// // On the unit sphere coordinates are modes of ω = 2: heat flow scales them by exp(−2t).
/// let sphere = shapes::icosphere(4);
/// let heat = LowPass::new(Transfer::Heat(Time::SquaredUnits(0.1)));
/// let smoothed = low_pass(&sphere, &heat)?;
/// let radius = smoothed.mesh.positions()[0].iter().map(|x| x * x).sum::<f64>().sqrt();
/// assert!((radius - (-0.2f64).exp()).abs() < 1e-3);
/// # Ok::<(), fairing_smoothing::FlowError>(())
/// ```
///
/// Source: [vallet2008].
///
/// [vallet2008]: https://doi.org/10.1111/j.1467-8659.2008.01122.x
pub fn low_pass(mesh: &TriMesh, options: &LowPass) -> Result<Smoothed, FlowError> {
    options.check().map_err(|error| FlowFailure::from(error).before(mesh))?;
    if let Transfer::Modes(k) = options.transfer {
        return smoothest(mesh, k, options).map_err(|failure| failure.before(mesh));
    }
    let mut run = Run::new(mesh, &RunSettings::new(&options.constraints, 1), None)?;
    // A filter takes no step.
    let (time, kind, area) = (Time::SquaredUnits(0.0), options.kind, options.area);
    let laplacian = run.laplacian(Diffusion::Cotangent { time, kind, area })?;
    let response = match options.transfer {
        Transfer::Butterworth { cutoff, order } => Response::Butterworth { cutoff, order },
        Transfer::Heat(time) => {
            Response::Heat { time: time.in_squared_units(mesh.mean_edge_length()) }
        }
        Transfer::Modes(_) => Response::Heat { time: 0.0 },
    };
    let resolvent = Resolvent::expand(response);
    let systems = resolvent.as_ref().map(Resolvent::systems);
    let bound = || laplacian.spectral_bound();
    let mut run = match at_once(run, &laplacian, response, systems, bound) {
        ControlFlow::Break(smoothed) => return smoothed,
        ControlFlow::Continue(run) => run,
    };
    let Some(resolvent) = resolvent.filter(|_| run.is_linear()) else {
        let reason = "a low-pass filter supports free and pinned vertices only";
        return Err(run.refuse(FlowFailure::Unsupported { reason }));
    };
    let (x, residual) = resolvent
        .apply(laplacian, run.arrangement.mesh())
        .map_err(|failure| run.refuse(failure))?;
    run.report.iterations = 1;
    run.report.approach = Approach::Resolvent { degree: resolvent.degree() };
    run.report.worst_residual = Some(residual);
    run.finish(x)
}

/// Reconstructs the mesh from its `k` smoothest modes.
fn smoothest(mesh: &TriMesh, k: usize, options: &LowPass) -> Result<Smoothed, FlowFailure> {
    if options.area == LumpedArea::Voronoi {
        let reason = "modes need positive areas, barycentric or mixed";
        return Err(FlowFailure::Unsupported { reason });
    }
    if !options.constraints.is_free() {
        let reason = "a projection on modes supports no constraints";
        return Err(FlowFailure::Unsupported { reason });
    }
    let (kind, too_thin) = chosen(mesh, options.kind, options.area)?;
    let laplacian = Laplacian::new(mesh, kind, options.area.into())?;
    let Reconstruction { mesh, split, .. } = spectrum(&laplacian, k, &SpectrumOptions::default())
        .and_then(|modes| reconstruct(mesh, &modes, k))
        .map_err(|error| FlowFailure::Modes(Box::new(error)))?;
    let approach = Approach::Modes { count: k };
    Ok(Smoothed {
        mesh,
        report: Report { iterations: 1, approach, split, too_thin, ..Report::default() },
    })
}
