//! First and second fundamental form of a surface with two derivatives, and the curvatures in them.

use glam::DVec3;

use crate::tangent::Symmetric2;

/// The smallest sine of the angle between ∂p/∂u and ∂p/∂v, or ratio of their
/// lengths, at which the unit normal is more than rounding.
const SINGULAR: f64 = 1e-12;

/// The fundamental forms of a surface at a point.
///
/// ```text
/// I  = E du² + 2F du dv + G dv²,    E = pᵤ·pᵤ,  F = pᵤ·pᵥ,  G = pᵥ·pᵥ
/// II = L du² + 2M du dv + N dv²,    L = pᵤᵤ·m,  M = pᵤᵥ·m,  N = pᵥᵥ·m
/// ```
///
/// with m the unit normal pointing **inward**, so that curvature is positive
/// where the surface bends like a sphere. Source: \[docarmo1976\].
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct FundamentalForms {
    /// `[E, F, G]`, in squared mesh units.
    pub first: [f64; 3],
    /// `[L, M, N]`, in mesh units.
    pub second: [f64; 3],
    /// The unit normal, outward.
    pub normal: [f64; 3],
    /// ∂p/∂u
    pub du: [f64; 3],
    /// ∂p/∂v
    pub dv: [f64; 3],
}

/// Principal curvatures and their directions at a point of a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct PrincipalDirections {
    /// κ₁ ≥ κ₂, in 1 / mesh units.
    pub values: [f64; 2],
    /// Unit tangents in space, in the order of the values; with the outward
    /// normal they form a right-handed frame. Arbitrary at an umbilic.
    pub directions: [[f64; 3]; 2],
    /// The same as `(du, dv)`, of unit length in the first form.
    pub parameters: [[f64; 2]; 2],
}

impl FundamentalForms {
    /// The forms of a jet; `None` where the chart is singular.
    pub fn from_jet(jet: SurfaceJet, side: ChartNormal) -> Option<Self> {
        let [du, dv, duu, duv, dvv] = [jet.du, jet.dv, jet.duu, jet.duv, jet.dvv].map(DVec3::from);
        let across = du.cross(dv);
        let area = across.length();
        let first = [du.dot(du), du.dot(dv), dv.dot(dv)];
        if area.is_nan() || area <= SINGULAR * (first[0] + first[2]) {
            return None;
        }
        let normal = match side {
            ChartNormal::Outward => across * (1.0 / area),
            ChartNormal::Inward => across * (-1.0 / area),
        };
        let second = [duu, duv, dvv].map(|d| -d.dot(normal));
        Some(Self { first, second, normal: normal.to_array(), du: jet.du, dv: jet.dv })
    }

    /// The normal curvature `II / I` in the direction `du pᵤ + dv pᵥ`, in
    /// 1 / mesh units; the length of `(du, dv)` does not matter. `None` for the
    /// zero direction.
    pub fn normal_curvature(&self, [du, dv]: [f64; 2]) -> Option<f64> {
        let form = |[a, b, c]: [f64; 3]| a * du * du + 2.0 * b * du * dv + c * dv * dv;
        let length = form(self.first);
        (length > 0.0).then(|| form(self.second) / length)
    }

    /// `K = (LN − M²) / (EG − F²)`, in 1 / squared mesh units.
    pub fn gaussian_curvature(&self) -> f64 {
        let ([e, f, g], [l, m, n]) = (self.first, self.second);
        (l * n - m * m) / (e * g - f * f)
    }

    /// `H = (EN − 2FM + GL) / (2 (EG − F²))`, in 1 / mesh units.
    pub fn mean_curvature(&self) -> f64 {
        let ([e, f, g], [l, m, n]) = (self.first, self.second);
        (e * n - 2.0 * f * m + g * l) / (2.0 * (e * g - f * f))
    }

    /// Principal curvatures and directions: the extremes of the normal
    /// curvature.
    pub fn principal(&self) -> PrincipalDirections {
        let ([e, f, g], [l, m, n]) = (self.first, self.second);
        // In the orthonormal frame pᵤ/√E and its quarter turn
        // (pᵥ − (F/E) pᵤ) √E/W, with W = √(EG − F²), II is symmetric.
        let (root, slope) = (e.sqrt(), f / e);
        let w = (e * g - f * f).sqrt();
        let form = Symmetric2 {
            a: l / e,
            b: (m - slope * l) / w,
            c: (n - 2.0 * slope * m + slope * slope * l) * e / (w * w),
        };
        let (values, [x, y]) = form.eigen();
        let in_chart = |[x, y]: [f64; 2]| [x / root - y * slope * root / w, y * root / w];
        let [du, dv, normal] = [self.du, self.dv, self.normal].map(DVec3::from);
        let chart_turn = du.cross(dv).dot(normal).signum();
        // The quarter turn that is positive about the outward normal.
        let second = [-y * chart_turn, x * chart_turn];
        let parameters = [in_chart([x, y]), in_chart(second)];
        let directions = parameters.map(|[u, v]| (u * du + v * dv).to_array());
        PrincipalDirections { values, directions, parameters }
    }
}

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
