//! A point of a surface with its derivatives.

/// A point of a parametric surface with its derivatives to second order, in
/// mesh units per unit of the parameters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SurfaceJet {
    /// p
    pub point: [f64; 3],
    /// ∂p/∂u
    pub du: [f64; 3],
    /// ∂p/∂v
    pub dv: [f64; 3],
    /// ∂²p/∂u²
    pub duu: [f64; 3],
    /// ∂²p/∂u∂v
    pub duv: [f64; 3],
    /// ∂²p/∂v²
    pub dvv: [f64; 3],
}

/// The side of the surface that `∂p/∂u × ∂p/∂v` points to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum ChartNormal {
    /// Outward; also for surfaces without an inside, where this side is called
    /// the outer one.
    Outward,
    /// Inward.
    Inward,
}
