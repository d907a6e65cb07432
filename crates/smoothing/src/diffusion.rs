//! What diffuses, and how far in one step.

use fairing_operators::LumpedArea;

/// The Laplacian of a flow with the length of a step in its unit.
///
/// The unit belongs to the weights: with uniform weights λ is a dimensionless fraction of the way to the mean of
/// the neighbours; with cotangents a step is a diffusion time, an area.
#[derive(Debug, Clone, Copy, PartialEq)]
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
        /// The areas `M`. They must be positive, which [`LumpedArea::Voronoi`] does not promise.
        area: LumpedArea,
    },
}

/// A diffusion time.
#[derive(Debug, Clone, Copy, PartialEq)]
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

    /// Cotangent weights over barycentric areas, with steps of `lambda` h².
    pub fn cotangent(lambda: f64) -> Self {
        Self::Cotangent { time: Time::SquaredEdges(lambda), area: LumpedArea::Barycentric }
    }

    /// The number of the step, in whatever unit.
    pub(crate) fn value(self) -> f64 {
        match self {
            Self::Uniform { lambda } => lambda,
            Self::Cotangent { time, .. } => time.value(),
        }
    }

    /// The step as the factor of `L`.
    pub(crate) fn factor(self, mesh: &fairing_mesh::TriMesh) -> f64 {
        match self {
            Self::Uniform { lambda } => lambda,
            Self::Cotangent { time, .. } => time.in_squared_units(mesh.mean_edge_length()),
        }
    }
}
