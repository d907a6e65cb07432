//! Flows at a size whose powers are floats.

use std::ops::ControlFlow;

use fairing_mesh::TriMesh;
use fairing_operators::{OperatorError, check_faces};
use fairing_parameters::OptionError;

use crate::engine::constraints::Constraints;
use crate::engine::diffusion::{Diffusion, Operator, Time};
use crate::engine::error::{FlowError, FlowFailure};
use crate::engine::outcome::Smoothed;
use crate::engine::step::{Observer, Step};

/// Options of a flow, in mesh units where they have one.
pub(crate) trait InMeshUnits: Sized {
    /// What they are for a mesh divided by `unit`.
    fn divided_by(&self, unit: f64) -> Result<Self, FlowFailure>;

    /// Whether steps are times in squared mesh units, not numbers.
    fn is_timed(&self) -> bool {
        false
    }

    /// The operator of cotangent weights, if it has some.
    fn operator_mut(&mut self) -> Option<&mut Operator> {
        None
    }
}

/// [`InMeshUnits`] for options with a `diffusion` and `constraints`.
macro_rules! diffuses_in_mesh_units {
    ($options:ty) => {
        impl $crate::engine::unit_scale::InMeshUnits for $options {
            fn divided_by(&self, unit: f64) -> Result<Self, $crate::FlowFailure> {
                Ok(Self {
                    diffusion: self.diffusion.divided_by(unit)?,
                    constraints: self.constraints.divided_by(unit)?,
                    ..*self
                })
            }

            fn is_timed(&self) -> bool {
                self.diffusion.is_timed()
            }

            fn operator_mut(&mut self) -> Option<&mut $crate::Operator> {
                self.diffusion.operator_mut()
            }
        }
    };
}

pub(crate) use diffuses_in_mesh_units;

/// [`with_operator_at_unit_scale`], with the operator that [`Operator::Auto`] is on the input.
pub(crate) fn at_unit_scale<O: InMeshUnits + Clone>(
    mesh: &TriMesh,
    options: &O,
    observer: Option<&mut Observer<'_>>,
    flow: impl Fn(&TriMesh, &O, Option<&mut Observer<'_>>) -> Result<Smoothed, FlowError>,
) -> Result<Smoothed, FlowError> {
    let mut options = options.clone();
    let mut too_thin = None;
    if let Some(operator) = options.operator_mut() {
        (*operator, too_thin) =
            operator.on(mesh).map_err(|error| FlowFailure::from(error).before(mesh))?;
    }
    let mut smoothed = with_operator_at_unit_scale(mesh, &options, observer, flow)?;
    smoothed.report.too_thin = too_thin;
    Ok(smoothed)
}

/// Runs a flow on the mesh [at unit scale](TriMesh::at_unit_scale) and scales back what it returns and what an observer
/// sees. Scales are powers of two and round nothing; a vertex that does not move keeps its position to the last bit.
fn with_operator_at_unit_scale<O: InMeshUnits>(
    mesh: &TriMesh,
    options: &O,
    observer: Option<&mut Observer<'_>>,
    flow: impl Fn(&TriMesh, &O, Option<&mut Observer<'_>>) -> Result<Smoothed, FlowError>,
) -> Result<Smoothed, FlowError> {
    let unit = mesh.scale_unit();
    if unit == 1.0 {
        return flow(mesh, options, observer);
    }
    let options = options.divided_by(unit).map_err(|failure| failure.before(mesh))?;
    let scaled = Scaled { mesh, at_unit: &mesh.divided_by(unit), unit, timed: options.is_timed() };
    match observer {
        Some(observe) => {
            scaled.observed(observe, |watch| flow(scaled.at_unit, &options, Some(watch)))
        }
        None => {
            let result = scaled.back(flow(scaled.at_unit, &options, None));
            let overflown = |error: &FlowError| {
                error.iteration == 0 && matches!(error.failure, FlowFailure::NonFinite { .. })
            };
            // What left the range of numbers only in mesh units did so in some step: that one is looked for.
            match result {
                Err(error) if overflown(&error) => scaled
                    .observed(&mut |_| ControlFlow::Continue(()), |watch| {
                        flow(scaled.at_unit, &options, Some(watch))
                    }),
                result => result,
            }
        }
    }
}

/// A mesh and the same divided by a power of two.
struct Scaled<'a> {
    mesh: &'a TriMesh,
    at_unit: &'a TriMesh,
    unit: f64,
    /// Whether steps are times.
    timed: bool,
}

impl Scaled<'_> {
    /// A step in mesh units.
    fn step(&self, step: f64) -> f64 {
        if self.timed { step * self.unit * self.unit } else { step }
    }

    /// Positions in mesh units.
    fn positions(&self, x: &[[f64; 3]]) -> Vec<[f64; 3]> {
        let moved = self.at_unit.positions().iter().zip(x);
        let given = self.mesh.positions().iter().zip(moved);
        let back = |(&p, (old, new)): (&_, (&_, &[f64; 3]))| match old == new {
            true => p,
            false => new.map(|x| x * self.unit),
        };
        given.map(back).collect()
    }

    /// What a flow at unit scale returns, in mesh units.
    fn back(&self, result: Result<Smoothed, FlowError>) -> Result<Smoothed, FlowError> {
        let restore = |mesh: &TriMesh| {
            let restored = self.mesh.with_positions(self.positions(mesh.positions()));
            restored.map_err(|error| FlowFailure::from(error).before(self.mesh))
        };
        match result {
            Ok(Smoothed { mesh, mut report }) => {
                report.stable_limit = report.stable_limit.map(|limit| self.step(limit));
                Ok(Smoothed { mesh: restore(&mesh)?, report })
            }
            Err(error) => {
                let last_good = restore(&error.last_good)?;
                let failure = match error.failure {
                    FlowFailure::Unstable { step, limit } => {
                        FlowFailure::Unstable { step: self.step(step), limit: self.step(limit) }
                    }
                    failure => times(failure, self.unit, &last_good),
                };
                Err(FlowError { failure, last_good: Box::new(last_good), ..error })
            }
        }
    }

    /// Runs a flow at unit scale whose observer sees every step in mesh units, and ends it where they are no numbers.
    fn observed(
        &self,
        observe: &mut Observer<'_>,
        flow: impl FnOnce(&mut Observer<'_>) -> Result<Smoothed, FlowError>,
    ) -> Result<Smoothed, FlowError> {
        let mut overflown = None;
        let result = flow(&mut |step: &Step<'_>| {
            let before = self.positions(step.before);
            let failure = match self.mesh.with_positions(self.positions(step.positions())) {
                Ok(mesh) => {
                    return observe(&Step {
                        step_size: self.step(step.step_size),
                        before: &before,
                        mesh: &mesh,
                        unit: self.unit,
                        ..*step
                    });
                }
                Err(error) => FlowFailure::from(error),
            };
            overflown = Some(match self.mesh.with_positions(before) {
                Ok(last_good) => {
                    let last_good = Box::new(last_good);
                    FlowError { failure, iteration: step.iteration, last_good }
                }
                Err(_) => failure.before(self.mesh),
            });
            ControlFlow::Break(())
        });
        overflown.map_or_else(|| self.back(result), Err)
    }
}

/// A failure at a mesh that was divided by `unit`, in its own units.
pub(crate) fn times(failure: FlowFailure, unit: f64, last_good: &TriMesh) -> FlowFailure {
    let area = |x: f64| x * unit * unit;
    match failure {
        FlowFailure::NonFinite { vertex, position } => {
            FlowFailure::NonFinite { vertex, position: position.map(|x| x * unit) }
        }
        FlowFailure::Collapsed { vertex, area: left, before } => {
            FlowFailure::Collapsed { vertex, area: area(left), before: area(before) }
        }
        FlowFailure::NonPositiveMass { vertex, mass } => {
            FlowFailure::NonPositiveMass { vertex, mass: area(mass) }
        }
        // In units of the mesh that is asked again.
        FlowFailure::Operator(OperatorError::DegenerateFace { .. }) => {
            check_faces(last_good).map_or_else(FlowFailure::Operator, |()| failure)
        }
        other => other,
    }
}

/// The value of an option at unit scale, if that is a number.
fn scaled(
    option: &'static str,
    value: f64,
    scaled: f64,
    expected: &'static str,
) -> Result<f64, FlowFailure> {
    // What is no number before is refused by the flow.
    match scaled.is_finite() || !value.is_finite() {
        true => Ok(scaled),
        false => Err(OptionError::new(option, value, expected).into()),
    }
}

impl InMeshUnits for Time {
    fn divided_by(&self, unit: f64) -> Result<Self, FlowFailure> {
        Ok(match *self {
            Self::SquaredEdges(lambda) => Self::SquaredEdges(lambda),
            Self::SquaredUnits(t) => {
                let expected = "finite in units of the squared extent of the mesh";
                Self::SquaredUnits(scaled("time", t, t / unit / unit, expected)?)
            }
        })
    }
}

impl InMeshUnits for Diffusion {
    fn divided_by(&self, unit: f64) -> Result<Self, FlowFailure> {
        Ok(match *self {
            Self::Uniform { lambda } => Self::Uniform { lambda },
            Self::Cotangent { time, operator } => {
                Self::Cotangent { time: time.divided_by(unit)?, operator }
            }
        })
    }

    fn is_timed(&self) -> bool {
        matches!(self, Self::Cotangent { .. })
    }
}

impl InMeshUnits for Constraints {
    fn divided_by(&self, unit: f64) -> Result<Self, FlowFailure> {
        let mut constraints = self.clone();
        for x in constraints.soft.iter_mut().flat_map(|soft| &mut soft.target) {
            let expected = "finite in units of the extent of the mesh";
            *x = scaled("target of a soft constraint", *x, *x / unit, expected)?;
        }
        Ok(constraints)
    }
}
