//! The Laplacian of a flow and the length of its steps.

use fairing_mesh::TriMesh;
use fairing_operators::{LaplacianKind, LumpedArea, Reason, choose};
use fairing_parameters::{Choice, Field, Kind, Parameter, ParameterError, Range, Value, Values};

use crate::engine::error::FlowFailure;

/// The Laplacian of a flow and the length of a step.
///
/// The unit of a step depends on the weights: for uniform weights λ is a dimensionless fraction of
/// the way to the mean of the neighbours; for cotangent weights a step is a diffusion time, an
/// area.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum Diffusion {
    /// `L = D⁻¹A − I`: equal weights. Defined on every mesh, including non-manifold and degenerate
    /// ones; also moves vertices within the surface, towards even spacing.
    Uniform {
        /// λ, dimensionless.
        lambda: f64,
    },
    /// `L = −M⁻¹S` with cotangent weights: the Laplace–Beltrami operator, which moves vertices
    /// along the normal.
    Cotangent {
        /// The time of one step.
        time: Time,
        /// The kind of `S`, any except uniform. [`LaplacianKind::Auto`] takes the robust Laplacian
        /// if a face of the input is too thin for cotangents;
        /// [`Report::too_thin`](crate::Report::too_thin) then names this face.
        kind: LaplacianKind,
        /// The vertex areas `M`, which must be positive: those of [`LumpedArea::Voronoi`] may not
        /// be, and the robust Laplacian supports barycentric areas only.
        area: LumpedArea,
    },
}

/// The kind chosen for `mesh`, cotangent or robust, and the first face too thin for cotangents if
/// that decided.
pub(crate) fn chosen(
    mesh: &TriMesh,
    kind: LaplacianKind,
    area: LumpedArea,
) -> Result<(LaplacianKind, Option<u32>), FlowFailure> {
    match choose(mesh, kind, area.into())? {
        (LaplacianKind::Uniform, _) => Err(FlowFailure::Unsupported {
            reason: "cotangent diffusion cannot use the uniform Laplacian: use Diffusion::Uniform",
        }),
        (kind, Reason::ThinFace { face, .. }) => Ok((kind, Some(face))),
        (kind, _) => Ok((kind, None)),
    }
}

pub(crate) const WEIGHTS: &str = "weights";
pub(crate) const LAMBDA: &str = "lambda";
pub(crate) const TIME: &str = "time";
pub(crate) const AREA: &str = "area";
pub(crate) const OPERATOR: &str = "operator";

/// The weights of the Laplacian.
pub(crate) fn weights(default: &str) -> Parameter {
    const CHOICES: &[Choice] = &[
        Choice::new("uniform", "Equal weights"),
        Choice::new("cotangent", "The Laplace–Beltrami operator"),
    ];
    let about = "The weights of the Laplacian";
    Parameter {
        default: Some(default.into()),
        ..Parameter::new(WEIGHTS, Kind::Choice(CHOICES), about)
    }
}

/// Refuses parameters of cotangent weights, which uniform weights would ignore.
pub(crate) fn refuse_with_uniform(
    values: &Values,
    parameters: &[&'static str],
) -> Result<(), ParameterError> {
    match parameters.iter().find(|parameter| values.get(parameter).is_some()) {
        None => Ok(()),
        Some(parameter) => {
            let expected = "left out with weights uniform: it is a parameter of cotangents";
            Err(values.refuse(parameter, expected))
        }
    }
}

/// Refuses areas that the robust Laplacian does not support.
pub(crate) fn check_areas(
    kind: LaplacianKind,
    area: LumpedArea,
    values: &Values,
) -> Result<(), ParameterError> {
    if kind == LaplacianKind::Robust && area != LumpedArea::Barycentric {
        let expected = "barycentric with operator robust, which supports no other areas";
        return Err(values.refuse(AREA, expected));
    }
    Ok(())
}

/// A time implies cotangent weights. Other weights keep the number of the default step.
impl Field for Diffusion {
    fn parameters(&self, _: Parameter) -> Vec<Parameter> {
        let (name, step, kind, area) = match *self {
            Self::Uniform { lambda } => {
                ("uniform", Some(lambda), LaplacianKind::Auto, LumpedArea::Barycentric)
            }
            Self::Cotangent { time: Time::SquaredEdges(lambda), kind, area } => {
                ("cotangent", Some(lambda), kind, area)
            }
            Self::Cotangent { kind, area, .. } => ("cotangent", None, kind, area),
        };
        let about = "The step λ: dimensionless for uniform weights, in squared mean edge lengths for cotangent";
        let lambda = Parameter {
            range: Range::NOT_NEGATIVE,
            default: step.map(Value::Number),
            excludes: &[TIME],
            ..Parameter::new(LAMBDA, Kind::Number, about)
        };
        let time = Parameter {
            unit: "squared units of the file",
            range: Range::NOT_NEGATIVE,
            ..Parameter::new(TIME, Kind::Number, "The step for cotangents, as a diffusion time")
        };
        let choice = |name, about| Parameter::new(name, Kind::Number, about);
        let areas = area.parameters(choice(AREA, "The areas of vertices for cotangents"));
        let about = "The kind of cotangent Laplacian; auto means cotangent for areas other than \
                     barycentric";
        let kinds = kind.parameters(choice(OPERATOR, about));
        [vec![weights(name), lambda, time], areas, kinds].concat()
    }

    fn read(&mut self, _: &'static str, values: &Values) -> Result<(), ParameterError> {
        let (lambda, time) = (values.number(LAMBDA), values.number(TIME));
        let by_cotangents = match values.text(WEIGHTS) {
            Some(weights) => weights == "cotangent",
            None => time.is_some() || matches!(self, Self::Cotangent { .. }),
        };
        if !by_cotangents {
            refuse_with_uniform(values, &[TIME, OPERATOR, AREA])?;
            *self = Self::uniform(lambda.unwrap_or(self.value()));
            return Ok(());
        }
        let kind = values.choice(OPERATOR).unwrap_or(LaplacianKind::Auto);
        let area = values.choice(AREA).unwrap_or(LumpedArea::Barycentric);
        check_areas(kind, area, values)?;
        let time = match time {
            Some(time) => Time::SquaredUnits(time),
            None => Time::SquaredEdges(lambda.unwrap_or(self.value())),
        };
        *self = Self::Cotangent { time, kind, area };
        Ok(())
    }

    fn check(&self, _: &'static str, _: Range) -> Result<(), ParameterError> {
        Range::NOT_NEGATIVE.check("step", self.value())
    }
}

/// A diffusion time.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum Time {
    /// A time in squared mesh units.
    SquaredUnits(f64),
    /// A time in h², the square of the mean edge length of the input: equal numbers have equal
    /// effects relative to the resolution at every scale. h counts an edge once for each of its
    /// faces.
    SquaredEdges(f64),
}

impl Time {
    /// The time in squared mesh units for the mean edge length `h`.
    pub(crate) fn in_squared_units(self, h: f64) -> f64 {
        match self {
            Self::SquaredUnits(t) => t,
            Self::SquaredEdges(lambda) => lambda * h * h,
        }
    }

    /// The number without its unit.
    pub(crate) fn value(self) -> f64 {
        match self {
            Self::SquaredUnits(t) | Self::SquaredEdges(t) => t,
        }
    }
}

impl Diffusion {
    /// Uniform weights with the dimensionless step `lambda`.
    pub const fn uniform(lambda: f64) -> Self {
        Self::Uniform { lambda }
    }

    /// Cotangent weights ([`LaplacianKind::Auto`]) and barycentric areas, with steps of `lambda`
    /// h².
    pub const fn cotangent(lambda: f64) -> Self {
        let (kind, area) = (LaplacianKind::Auto, LumpedArea::Barycentric);
        Self::Cotangent { time: Time::SquaredEdges(lambda), kind, area }
    }

    /// The same steps with another Laplacian; uniform weights are unchanged.
    #[must_use]
    pub fn with_kind(self, kind: LaplacianKind) -> Self {
        match self {
            Self::Uniform { .. } => self,
            Self::Cotangent { time, area, .. } => Self::Cotangent { time, kind, area },
        }
    }

    /// The diffusion with the kind chosen for `mesh`, and the first face too thin for cotangents if
    /// that decided.
    pub(crate) fn chosen(self, mesh: &TriMesh) -> Result<(Self, Option<u32>), FlowFailure> {
        match self {
            Self::Uniform { .. } => Ok((self, None)),
            Self::Cotangent { kind, area, .. } => {
                let (kind, too_thin) = chosen(mesh, kind, area)?;
                Ok((self.with_kind(kind), too_thin))
            }
        }
    }

    /// The step without its unit.
    pub(crate) fn value(self) -> f64 {
        match self {
            Self::Uniform { lambda } => lambda,
            Self::Cotangent { time, .. } => time.value(),
        }
    }

    /// The step as the factor of `L`.
    pub(crate) fn factor(self, mesh: &TriMesh) -> f64 {
        match self {
            Self::Uniform { lambda } => lambda,
            Self::Cotangent { time, .. } => time.in_squared_units(mesh.mean_edge_length()),
        }
    }
}
