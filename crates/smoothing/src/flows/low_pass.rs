//! Spectral low-pass filters.

use fairing_mesh::TriMesh;
use fairing_operators::{Laplacian, MassKind};
use fairing_parameters::{Algorithm, OptionError, Parameter, ParameterError, Values};
use fairing_spectral::{Reconstruction, SpectrumOptions, reconstruct, spectrum};

use crate::engine::assemble::cotangent;
use crate::engine::constraints::{BOUNDARY, Constraints, PIN};
use crate::engine::diffusion::{AREA, OPERATOR, Operator, TIME, Time};
use crate::engine::error::{FlowError, FlowFailure};
use crate::engine::flow::{Flow, FlowFn};
use crate::engine::outcome::{Approach, Report, Smoothed};
use crate::engine::resolvent::Resolvent;
use crate::engine::response::Response;
use crate::engine::run::{Frame, Run};
use crate::engine::series::expand;
use crate::engine::unit_scale::{InMeshUnits, at_unit_scale};

/// What a filter does to the mode of eigenvalue ω of `S φ = ω M φ`.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum Transfer {
    /// `exp(−ωt)`: exact diffusion for the time t, the limit of infinitely many small steps.
    Heat(Time),
    /// `1/(1 + (ω/ω₀)^order)`: flat up to ω₀, where it is ½, then falling with this order.
    Butterworth {
        /// ω₀, in one over squared mesh units. Features of size w (half a wavelength) have ω ≈ (π/w)².
        cutoff: f64,
        /// How steeply it falls; 1 to 16.
        order: u32,
    },
    /// 1 for the k smallest eigenvalues, 0 beyond: the ideal low-pass, a projection on the k smoothest modes, which
    /// are computed. Where k splits a cluster of equal or nearly equal eigenvalues, which of their modes are kept is
    /// arbitrary, and [`Report::split`] says so. Supports neither constraints nor Voronoi areas.
    Modes(usize),
}

/// Options of [`low_pass`].
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct LowPass {
    /// What happens to each mode.
    pub transfer: Transfer,
    /// How the Laplacian is made.
    pub operator: Operator,
    /// Free and pinned vertices.
    pub constraints: Constraints,
}

impl LowPass {
    /// A filter over barycentric areas, without fixed vertices.
    pub fn new(transfer: Transfer) -> Self {
        Self { transfer, operator: Operator::default(), constraints: Constraints::default() }
    }
}

/// Smooths by one filter of the spectrum of the cotangent Laplacian, `x' = g(M⁻¹S) x`, without computing the
/// spectrum unless the filter is [`Transfer::Modes`].
///
/// In terms of the modes, `x' = Σ g(ωᵢ) φᵢ (φᵢᵀ M x)`; what is computed is the Chebyshev series of g up to an error of
/// 2.1e-10, whose degree grows with the square root of how many times the cut-off is below the roughest mode. Where it
/// would exceed two thousand products, the series is one in the resolvent `(I − τL)⁻¹` instead, of degree 25 for heat
/// and 30 to 250 for Butterworth filters, with one factorisation. The centroid of each component, weighted by area,
/// stays where it is.
///
/// # Errors
///
/// [`FlowError`] for options out of range, constraints that are not linear, faces too thin for cotangents, and systems
/// that cannot be factored.
///
/// # Examples
///
/// ```
/// use fairing_shapes as shapes;
/// use fairing_smoothing::{LowPass, Time, Transfer, low_pass};
///
/// // Coordinates of the unit sphere are modes of ω = 2: diffusion for a time t scales it by exp(−2t).
/// let sphere = shapes::icosphere(4);
/// let smoothed = low_pass(&sphere, &LowPass::new(Transfer::Heat(Time::SquaredUnits(0.1))))?;
/// let radius = smoothed.mesh.positions()[0].iter().map(|x| x * x).sum::<f64>().sqrt();
/// assert!((radius - (-0.2f64).exp()).abs() < 1e-3);
/// # Ok::<(), fairing_smoothing::FlowError>(())
/// ```
///
/// Source: \[vallet2008\].
pub fn low_pass(mesh: &TriMesh, options: &LowPass) -> Result<Smoothed, FlowError> {
    at_unit_scale(mesh, options, None, |mesh, options, _| filter(mesh, options))
}

impl Flow for LowPass {
    const ALGORITHMS: &'static [Algorithm] = &[Algorithm::new(
        "low-pass",
        "heat or Butterworth filter of the cotangent spectrum, in physical units",
        &["vallet2008"],
        &[
            TIME.about("The diffusion time"),
            Parameter::number("cutoff", "", "Where a Butterworth filter halves: a wavelength")
                .unit("units of the file")
                .excludes(&["time"]),
            Parameter::count("order", "2", "How steeply a Butterworth filter falls"),
            Parameter::count(
                "modes",
                "",
                "How many of the smoothest modes are kept, and nothing else",
            )
            .excludes(&["time", "cutoff"]),
            AREA,
            OPERATOR,
            BOUNDARY,
            PIN,
        ],
    )];

    const RUN: FlowFn<Self> = |mesh, options, _| low_pass(mesh, options);

    fn with(values: &Values<'_>, positions: &[[f64; 3]]) -> Result<Self, ParameterError> {
        let mut steepness = 2;
        values.read("order", &mut steepness)?;
        if values.text("order").is_some() && values.text("cutoff").is_none() {
            let expected = "left out without cutoff: it is how steeply a Butterworth filter falls";
            return Err(values.refuse("order", expected));
        }
        let transfer = match (values.get("modes")?, values.get::<f64>("cutoff")?) {
            (Some(modes), _) => Transfer::Modes(modes),
            (None, Some(wavelength)) => {
                if !(wavelength > 0.0 && wavelength.is_finite()) {
                    return Err(values.refuse("cutoff", "positive and finite"));
                }
                let cutoff = (2.0 * std::f64::consts::PI / wavelength).powi(2);
                // Beyond every mesh, with room for the powers of a filter.
                let cutoff = cutoff.clamp(1e-150, 1e150);
                Transfer::Butterworth { cutoff, order: steepness }
            }
            (None, None) => Transfer::Heat(match values.get(TIME.name)? {
                Some(time) => Time::SquaredUnits(time),
                None => Time::SquaredEdges(5.0),
            }),
        };
        let operator = Operator::from_values(values)?;
        Ok(Self { transfer, operator, constraints: Constraints::from_values(values, positions)? })
    }
}

impl InMeshUnits for LowPass {
    fn divided_by(&self, unit: f64) -> Result<Self, FlowFailure> {
        let transfer = match self.transfer {
            Transfer::Heat(time) => Transfer::Heat(time.divided_by(unit)?),
            Transfer::Butterworth { cutoff, order } => {
                let at_unit = cutoff * unit * unit;
                // Beyond every eigenvalue of a mesh of unit scale, all but the constants is cut off, or nothing.
                let at_unit = match cutoff > 0.0 && cutoff.is_finite() {
                    true => at_unit.clamp(1e-150, 1e150),
                    false => cutoff,
                };
                Transfer::Butterworth { cutoff: at_unit, order }
            }
            Transfer::Modes(k) => Transfer::Modes(k),
        };
        Ok(Self { transfer, constraints: self.constraints.divided_by(unit)?, ..*self })
    }

    fn operator_mut(&mut self) -> Option<&mut Operator> {
        Some(&mut self.operator)
    }
}

fn filter(mesh: &TriMesh, options: &LowPass) -> Result<Smoothed, FlowError> {
    check(options).map_err(|failure| failure.before(mesh))?;
    if let Transfer::Modes(k) = options.transfer {
        return smoothest(mesh, k, options).map_err(|failure| failure.before(mesh));
    }
    let mut run = Run::new(mesh, &Frame::new(&options.constraints, 1), None)?;
    if !run.is_linear() {
        let reason = "a low-pass filter supports free and pinned vertices only";
        return Err(run.refuse(FlowFailure::Unsupported { reason }));
    }
    let laplacian = cotangent(run.arrangement.mesh(), options.operator, &run.freedom.fixed)
        .map_err(|failure| run.refuse(failure))?;
    let response = match options.transfer {
        Transfer::Butterworth { cutoff, order } => Response::Butterworth { cutoff, order },
        Transfer::Heat(time) => {
            Response::Heat { time: time.in_squared_units(mesh.mean_edge_length()) }
        }
        Transfer::Modes(_) => Response::Heat { time: 0.0 },
    };
    run.report.iterations = 1;
    let x = run.arrangement.mesh().positions();
    if let Some(series) = expand(laplacian.spectral_bound(), response) {
        run.report.approach = Approach::Series { degree: series.degree() };
        let x = series.apply(&laplacian, x);
        return run.finish(x);
    }
    let Some(resolvent) = Resolvent::expand(response) else {
        let reason = "the filter is neither a heat filter nor one of Butterworth";
        return Err(run.refuse(FlowFailure::Unsupported { reason }));
    };
    match resolvent.apply(&laplacian, &run.freedom, x) {
        Ok((x, residual)) => {
            run.report.approach = Approach::Resolvent { degree: resolvent.degree() };
            run.report.worst_residual = Some(residual);
            run.finish(x)
        }
        Err(failure) => Err(run.refuse(failure)),
    }
}

/// The mesh from its `k` smoothest modes.
fn smoothest(mesh: &TriMesh, k: usize, options: &LowPass) -> Result<Smoothed, FlowFailure> {
    let (kind, mass) = options.operator.kinds();
    if mass == MassKind::Voronoi {
        let reason = "modes are orthonormal over barycentric or mixed areas, none negative";
        return Err(FlowFailure::Unsupported { reason });
    }
    if !options.constraints.is_free() {
        let reason = "a projection on modes knows no constraints";
        return Err(FlowFailure::Unsupported { reason });
    }
    let laplacian = Laplacian::new(mesh, kind, mass)?;
    let Reconstruction { mesh, split, .. } = spectrum(&laplacian, k, &SpectrumOptions::default())
        .and_then(|modes| reconstruct(mesh, &modes, k))
        .map_err(|error| FlowFailure::Modes(Box::new(error)))?;
    let approach = Approach::Modes { count: k };
    Ok(Smoothed { mesh, report: Report { iterations: 1, approach, split, ..Report::default() } })
}

fn check(options: &LowPass) -> Result<(), FlowFailure> {
    match options.transfer {
        Transfer::Heat(time) => OptionError::require_not_negative("time", time.value())?,
        Transfer::Butterworth { cutoff, order } => {
            OptionError::require_positive("cut-off", cutoff)?;
            let between = (1..=16).contains(&order);
            OptionError::require(between, "order", f64::from(order), "between 1 and 16")?;
        }
        // The spectrum says how many there are.
        Transfer::Modes(_) => {}
    }
    Ok(())
}
