//! What diffuses, and how far in one step.

use fairing_mesh::TriMesh;
use fairing_operators::{LaplacianKind, LumpedArea, Reason, choose};
use fairing_parameters::old::{Parameter, Values};
use fairing_parameters::{Choice, ParameterError};

use crate::engine::error::FlowFailure;

/// The Laplacian of a flow with the length of a step in its unit.
///
/// The unit belongs to the weights: with uniform weights λ is a dimensionless fraction of the way to the mean of
/// the neighbours; with cotangents a step is a diffusion time, an area.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum Diffusion {
    /// `L = D⁻¹A − I`: every neighbour counts the same. Defined on every mesh, broken ones included; moves
    /// vertices within the surface as well, towards even spacing.
    Uniform {
        /// λ, dimensionless.
        lambda: f64,
    },
    /// `L = −M⁻¹S` with cotangent weights: the Laplace–Beltrami operator, which moves vertices along the normal.
    Cotangent {
        /// The time of one step.
        time: Time,
        /// How `S` is made; every kind but uniform. [`LaplacianKind::Auto`] takes the robust Laplacian where a face
        /// of the input is too thin for cotangents, which [`Report::too_thin`](crate::Report::too_thin) then names.
        kind: LaplacianKind,
        /// The areas `M`, which must be positive: [`LumpedArea::Voronoi`] does not promise that, and the robust
        /// Laplacian has barycentric ones only.
        area: LumpedArea,
    },
}

/// The Laplacian that `kind` stands for on `mesh`, cotangent or robust, and the first face too thin for
/// cotangents if that decided.
pub(crate) fn chosen(
    mesh: &TriMesh,
    kind: LaplacianKind,
    area: LumpedArea,
) -> Result<(LaplacianKind, Option<u32>), FlowFailure> {
    match choose(mesh, kind, area.into())? {
        (LaplacianKind::Uniform, _) => Err(FlowFailure::Unsupported {
            reason: "a diffusion by cotangents has no uniform weights: take those of the graph",
        }),
        (kind, Reason::ThinFace { face, .. }) => Ok((kind, Some(face))),
        (kind, _) => Ok((kind, None)),
    }
}

/// The area of vertices.
pub(crate) const AREA: Parameter = Parameter::choice(
    "area",
    LumpedArea::CHOICES,
    "barycentric",
    "The areas of vertices for cotangents",
);

/// The operator.
pub(crate) const OPERATOR: Parameter = Parameter::choice(
    "operator",
    &[
        Choice::new("auto", "Cotangents, or robust where a face of the input is too thin for them"),
        Choice::new("cotangent", "The cotangents of the faces"),
        Choice::new("robust", "Those of the intrinsic Delaunay triangulation, which any mesh has"),
    ],
    "auto",
    "How cotangents are made; auto with another area than barycentric means cotangent",
);

/// The weights.
pub(crate) const WEIGHTS: Parameter = Parameter::choice(
    "weights",
    &[
        Choice::new("uniform", "Every neighbour counts the same"),
        Choice::new("cotangent", "The Laplace–Beltrami operator"),
    ],
    "uniform",
    "The weights of the Laplacian",
);

/// The step in the unit of the weights.
pub(crate) const LAMBDA: Parameter = Parameter::number(
    "lambda",
    "",
    "The step: dimensionless, or in squared mean edge lengths for cotangents",
)
.excludes(&["time"]);

/// The step as a time.
pub(crate) const TIME: Parameter =
    Parameter::number("time", "", "The step of cotangents").unit("squared units of the file");

/// The Laplacian and the areas of [`OPERATOR`] and [`AREA`].
pub(crate) fn operator_from_values(
    values: &Values<'_>,
) -> Result<(LaplacianKind, LumpedArea), ParameterError> {
    let area = values.get(AREA.name)?.unwrap_or(LumpedArea::Barycentric);
    let kind = match values.text(OPERATOR.name) {
        Some("robust") => LaplacianKind::Robust,
        Some("cotangent") => LaplacianKind::Cotangent,
        _ => LaplacianKind::Auto,
    };
    if kind == LaplacianKind::Robust && area != LumpedArea::Barycentric {
        let expected = "barycentric with operator robust, which has no other areas";
        return Err(values.refuse(AREA.name, expected));
    }
    Ok((kind, area))
}

/// Refuses parameters of cotangents, which uniform weights would ignore.
pub(crate) fn refuse_with_uniform(
    values: &Values<'_>,
    parameters: &[Parameter],
) -> Result<(), ParameterError> {
    match parameters.iter().find(|parameter| values.text(parameter.name).is_some()) {
        None => Ok(()),
        Some(parameter) => {
            let expected = "left out with weights uniform: it is a parameter of cotangents";
            Err(values.refuse(parameter.name, expected))
        }
    }
}

impl Diffusion {
    /// From [`WEIGHTS`] and the parameters of [`cotangents`](Self::cotangents): a time means cotangents. Without
    /// either, the step is that of the weights.
    pub(crate) fn from_values(
        values: &Values<'_>,
        uniform: f64,
        cotangent: f64,
    ) -> Result<Self, ParameterError> {
        let timed = values.text(TIME.name).is_some();
        match values.text(WEIGHTS.name) {
            Some("cotangent") => Self::cotangents(values, cotangent),
            None if timed => Self::cotangents(values, cotangent),
            _ => {
                refuse_with_uniform(values, &[TIME, OPERATOR, AREA])?;
                Ok(Self::uniform(values.get(LAMBDA.name)?.unwrap_or(uniform)))
            }
        }
    }

    /// From [`LAMBDA`], [`TIME`], [`OPERATOR`] and [`AREA`].
    pub(crate) fn cotangents(values: &Values<'_>, lambda: f64) -> Result<Self, ParameterError> {
        let time = match values.get(TIME.name)? {
            Some(time) => Time::SquaredUnits(time),
            None => Time::SquaredEdges(values.get(LAMBDA.name)?.unwrap_or(lambda)),
        };
        let (kind, area) = operator_from_values(values)?;
        Ok(Self::Cotangent { time, kind, area })
    }
}

/// A diffusion time.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum Time {
    /// In squared mesh units.
    SquaredUnits(f64),
    /// In h², the square of the mean edge length of the input: the same number does the same, relative to the
    /// resolution, at every scale. h counts an edge once for each of its faces.
    SquaredEdges(f64),
}

impl Time {
    /// The time in squared mesh units for the mean edge length `h`.
    pub fn in_squared_units(self, h: f64) -> f64 {
        match self {
            Self::SquaredUnits(t) => t,
            Self::SquaredEdges(lambda) => lambda * h * h,
        }
    }

    /// The number, in whatever unit.
    pub(crate) fn value(self) -> f64 {
        match self {
            Self::SquaredUnits(t) | Self::SquaredEdges(t) => t,
        }
    }
}

impl Diffusion {
    /// Uniform weights with the dimensionless step `lambda`.
    pub fn uniform(lambda: f64) -> Self {
        Self::Uniform { lambda }
    }

    /// Cotangent weights ([`LaplacianKind::Auto`]) over barycentric areas, with steps of `lambda` h².
    pub fn cotangent(lambda: f64) -> Self {
        let (kind, area) = (LaplacianKind::Auto, LumpedArea::Barycentric);
        Self::Cotangent { time: Time::SquaredEdges(lambda), kind, area }
    }

    /// The same steps with another Laplacian; nothing changes for uniform weights.
    #[must_use]
    pub fn with_kind(self, kind: LaplacianKind) -> Self {
        match self {
            Self::Uniform { .. } => self,
            Self::Cotangent { time, area, .. } => Self::Cotangent { time, kind, area },
        }
    }

    /// The diffusion with the Laplacian that its kind stands for on `mesh`, and the first face too thin for
    /// cotangents if that decided.
    pub(crate) fn chosen(self, mesh: &TriMesh) -> Result<(Self, Option<u32>), FlowFailure> {
        match self {
            Self::Uniform { .. } => Ok((self, None)),
            Self::Cotangent { kind, area, .. } => {
                let (kind, too_thin) = chosen(mesh, kind, area)?;
                Ok((self.with_kind(kind), too_thin))
            }
        }
    }

    /// The number of the step, in whatever unit.
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
