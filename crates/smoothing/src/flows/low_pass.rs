//! Spectral low-pass filters.

use fairing_mesh::TriMesh;
use fairing_operators::{Laplacian, LaplacianKind, LumpedArea};
use fairing_parameters::old::{Algorithm, Parameter, Values};
use fairing_parameters::{OptionError, ParameterError};
use fairing_spectral::{Reconstruction, SpectrumOptions, reconstruct, spectrum};

use crate::engine::assemble::cotangent;
use crate::engine::constraints::{BOUNDARY, Constraints, PIN};
use crate::engine::diffusion::{AREA, OPERATOR, TIME, Time, chosen, operator_from_values};
use crate::engine::error::{FlowError, FlowFailure};
use crate::engine::flow::{Flow, FlowFn};
use crate::engine::linear::advance;
use crate::engine::outcome::{Approach, Report, Smoothed};
use crate::engine::response::Response;
use crate::engine::run::{Run, RunSettings};

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
    /// The Laplacian of cotangents; every kind but uniform.
    pub kind: LaplacianKind,
    /// The areas of the vertices.
    pub area: LumpedArea,
    /// Free and pinned vertices.
    pub constraints: Constraints,
}

impl LowPass {
    /// A filter over barycentric areas, without fixed vertices.
    pub fn new(transfer: Transfer) -> Self {
        Self {
            transfer,
            kind: LaplacianKind::Auto,
            area: LumpedArea::Barycentric,
            constraints: Constraints::default(),
        }
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
    check(options).map_err(|failure| failure.before(mesh))?;
    if let Transfer::Modes(k) = options.transfer {
        return smoothest(mesh, k, options).map_err(|failure| failure.before(mesh));
    }
    let mut run = Run::new(mesh, &RunSettings::new(&options.constraints, 1), None)?;
    let (kind, too_thin) =
        chosen(mesh, options.kind, options.area).map_err(|failure| run.refuse(failure))?;
    run.report.too_thin = too_thin;
    let laplacian = cotangent(run.arrangement.mesh(), kind, options.area, &run.freedom.fixed)
        .map_err(|failure| run.refuse(failure))?;
    let response = match options.transfer {
        Transfer::Butterworth { cutoff, order } => Response::Butterworth { cutoff, order },
        Transfer::Heat(time) => {
            Response::Heat { time: time.in_squared_units(mesh.mean_edge_length()) }
        }
        Transfer::Modes(_) => Response::Heat { time: 0.0 },
    };
    advance(run, &laplacian, laplacian.spectral_bound(), response, 0.0)
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
        let (kind, area) = operator_from_values(values)?;
        let constraints = Constraints::from_values(values, positions)?;
        Ok(Self { transfer, kind, area, constraints })
    }
}

/// The mesh from its `k` smoothest modes.
fn smoothest(mesh: &TriMesh, k: usize, options: &LowPass) -> Result<Smoothed, FlowFailure> {
    if options.area == LumpedArea::Voronoi {
        let reason = "modes are orthonormal over barycentric or mixed areas, none negative";
        return Err(FlowFailure::Unsupported { reason });
    }
    if !options.constraints.is_free() {
        let reason = "a projection on modes knows no constraints";
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
