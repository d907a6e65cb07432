//! Corrected curvature measures with interpolated normals.
//!
//! Positions x and unit normals u at the corners of a triangle are both
//! interpolated; the measures of the corrected normal current are then exact
//! polynomials. With ū the mean of the normals:
//!
//! ```text
//! μ⁰      = ½ ū · (x₁ − x₀) × (x₂ − x₀)                                  area
//! μ¹      = ½ ū · [(u₂ − u₁) × x₀ + (u₀ − u₂) × x₁ + (u₁ − u₀) × x₂]      2H
//! μ²      = ½ u₀ · u₁ × u₂                                               K
//! μ(X, Y) = ½ ū · X × [(Y·(u₁ − u₀)) (x₂ − x₀) − (Y·(u₂ − u₀)) (x₁ − x₀)] II
//! ```
//!
//! Summed over the faces at a vertex, or over the part of the mesh in a ball,
//! and divided by μ⁰ they are pointwise: H = ½ μ¹/μ⁰, K = μ²/μ⁰, and the
//! symmetric part of μ(X, Y)/μ⁰ in the tangent plane has the principal
//! curvatures. Signs are positive on a sphere. Source: [lachaud2020].
//!
//! [lachaud2020]: https://doi.org/10.1111/cgf.14067

use fairing_mesh::TriMesh;
use fairing_parameters::{Options, Range};
use fairing_watch::parallel;
use glam::DVec3;

use super::ball::BallExplorer;
use super::field::{AtVertex, CurvatureField};
use super::neighborhood::Length;
use super::oriented::on_oriented;
use super::status::Undefined;
use crate::error::OperatorError;
use crate::normals::{NormalWeight, weighted_vertex_normals};
use crate::tangent::{Symmetric2, tangent_frame};

/// Integrated measures of a part of a surface; measures of disjoint parts add up.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
pub struct CorrectedMeasures {
    /// μ⁰: the area, seen along the normals, in squared mesh units.
    pub area: f64,
    /// μ¹: 2H integrated, in mesh units.
    pub mean: f64,
    /// μ²: K integrated, dimensionless.
    pub gaussian: f64,
    /// μ(eᵢ, eⱼ) for the axes: the second form integrated, in mesh units.
    pub tensor: [[f64; 3]; 3],
}

impl CorrectedMeasures {
    /// The measures of a triangle with a unit normal at each corner.
    #[inline]
    pub fn from_triangle(x: [[f64; 3]; 3], u: [[f64; 3]; 3]) -> Self {
        let (x, u) = (x.map(DVec3::from), u.map(DVec3::from));
        let mean_normal = (u[0] + u[1] + u[2]) * (1.0 / 3.0);
        // About the first corner: the measures do not see translations.
        let (p, q) = (x[1] - x[0], x[2] - x[0]);
        let (du, dv) = (u[1] - u[0], u[2] - u[0]);
        let bend = du.cross(q) - dv.cross(p);
        // X · (w × ū) with w = (Y·du) q − (Y·dv) p.
        let (across_p, across_q) = (p.cross(mean_normal), q.cross(mean_normal));
        let tensor = std::array::from_fn(|i| {
            std::array::from_fn(|j| 0.5 * (du[j] * across_q[i] - dv[j] * across_p[i]))
        });
        Self {
            area: 0.5 * mean_normal.dot(p.cross(q)),
            mean: 0.5 * mean_normal.dot(bend),
            gaussian: 0.5 * u[0].dot(u[1].cross(u[2])),
            tensor,
        }
    }

    /// The sum of two parts, the second times a weight.
    #[inline]
    pub fn plus(mut self, other: &Self, weight: f64) -> Self {
        self.area += weight * other.area;
        self.mean += weight * other.mean;
        self.gaussian += weight * other.gaussian;
        for i in 0..3 {
            for j in 0..3 {
                self.tensor[i][j] += weight * other.tensor[i][j];
            }
        }
        self
    }

    /// H, in 1 / mesh units; `None` where the area is not positive.
    pub fn mean_curvature(&self) -> Option<f64> {
        (self.area > 0.0).then(|| 0.5 * self.mean / self.area)
    }

    /// K, in 1 / squared mesh units; `None` where the area is not positive.
    pub fn gaussian_curvature(&self) -> Option<f64> {
        (self.area > 0.0).then(|| self.gaussian / self.area)
    }

    /// κ₁ ≥ κ₂ in the plane across the unit normal and their directions;
    /// `None` where the area is not positive.
    pub fn principal(&self, normal: [f64; 3]) -> Option<([f64; 2], [[f64; 3]; 2])> {
        let at = self.at(normal.into())?;
        Some((at.values, at.directions))
    }

    fn at(&self, normal: DVec3) -> Option<AtVertex> {
        let (mean, gaussian) = (self.mean_curvature()?, self.gaussian_curvature()?);
        let frame = tangent_frame(normal);
        let form = |x: DVec3, y: DVec3| {
            x.dot(self.tensor.map(|row| DVec3::from(row).dot(y)).into()) / self.area
        };
        let [x, y] = frame;
        let form = Symmetric2 { a: form(x, x), b: 0.5 * (form(x, y) + form(y, x)), c: form(y, y) };
        Some(AtVertex { mean, gaussian, ..AtVertex::from_form(form, frame, normal) })
    }
}

fairing_parameters::options! {
    /// Options of [`corrected_curvature`].
    ///
    /// Without a radius the measures are summed over the faces at the vertex.
    #[derive(Debug, Clone, Copy, PartialEq)]
    #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
    #[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
    pub struct CorrectedOptions {
        /// The weights of face normals in the normals of vertices.
        pub normals: NormalWeight = NormalWeight::Sphere;
        /// The radius of the ball about each vertex.
        pub radius: Option<Length> = None, in Range::POSITIVE, unit "mean edge lengths";
    }
    "corrected": "principal curvatures of smooth shapes from one ring", ["lachaud2020"],
        with Self::DEFAULT,
        if |corrected| corrected.radius.is_none();
    "corrected-ball": "the best of fixed size under noise; averages over a ball of a chosen radius", ["lachaud2020"],
        with Self { radius: Some(Length::MeanEdges(2.0)), ..Self::DEFAULT },
        if |corrected| corrected.radius.is_some();
}

/// Curvature by corrected measures at each vertex; H and K have measures of
/// their own, so that κ₁ κ₂ = K holds only in the limit.
///
/// A face in a ball counts by the fraction of its area inside. Faces whose
/// corners have no normal are left out. Undefined at isolated vertices and
/// where the area seen along the normals is not positive, as on sharp folds.
///
/// # Errors
///
/// [`OperatorError::Option`] for a radius that is not positive.
#[doc(alias = "interpolated_corrected_curvatures")]
pub fn corrected_curvature(
    mesh: &TriMesh,
    options: CorrectedOptions,
) -> Result<CurvatureField, OperatorError> {
    options.check()?;
    on_oriented(mesh, |mesh| estimate(mesh, options))
}

fn estimate(mesh: &TriMesh, options: CorrectedOptions) -> Result<CurvatureField, OperatorError> {
    let radii = options.radius.map(|radius| BallExplorer::radii(mesh, radius)).transpose()?;
    let normals = weighted_vertex_normals(mesh, options.normals);
    let topology = mesh.topology();
    let of_face = |f: usize| {
        let u = mesh.faces()[f].map(|v| normals[v as usize]);
        if u.contains(&[0.0; 3]) {
            return CorrectedMeasures::default();
        }
        CorrectedMeasures::from_triangle(mesh.triangle(f), u)
    };
    let measures: Vec<CorrectedMeasures> = parallel::map(mesh.face_count(), 4096, of_face);
    let at_vertex = |explorer: &mut BallExplorer, v: u32| {
        let corners = mesh.incidence().corners(v);
        if corners.is_empty() {
            return Err(Undefined::Isolated);
        }
        let normal = DVec3::from(normals[v as usize]).try_normalize().ok_or(Undefined::NoArea)?;
        let mut sum = CorrectedMeasures::default();
        match &radii {
            None => {
                for &c in corners {
                    sum = sum.plus(&measures[c as usize / 3], 1.0);
                }
            }
            Some(radii) => explorer.visit(mesh, topology, v, radii[v as usize], |part| {
                if part.fraction > 0.0 {
                    sum = sum.plus(&measures[part.face as usize], part.fraction);
                }
            }),
        }
        sum.at(normal).ok_or(Undefined::NoArea)
    };
    Ok(CurvatureField::at_each_vertex(mesh, at_vertex))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A ball within the faces at the tip of an uneven tent holds a sector of
    /// each: ½ r² θ, whatever the size of the face.
    #[test]
    fn a_small_ball_holds_sectors() {
        let mut positions = vec![[0.0, 0.0, 0.5]];
        for (k, length) in [1.0, 2.0, 0.8, 1.5, 3.0].into_iter().enumerate() {
            let (s, c) = (k as f64 * 0.4 * std::f64::consts::PI).sin_cos();
            positions.push([length * c, length * s, 0.1 * k as f64]);
        }
        let faces: Vec<[u32; 3]> = (0..5).map(|k| [0, k + 1, (k + 1) % 5 + 1]).collect();
        let tent = TriMesh::new(positions, faces).unwrap();
        let radius = 0.2;
        let options = CorrectedOptions {
            radius: Some(Length::MeshUnits(radius)),
            ..CorrectedOptions::default()
        };
        let field = corrected_curvature(&tent, options).unwrap();
        let normals = weighted_vertex_normals(&tent, options.normals);
        let mut sum = CorrectedMeasures::default();
        for f in 0..5 {
            let [a, b, c] = tent.triangle(f).map(DVec3::from);
            let (p, q) = (b - a, c - a);
            let angle = p.cross(q).length().atan2(p.dot(q));
            let normals = tent.faces()[f].map(|v| normals[v as usize]);
            let measures = CorrectedMeasures::from_triangle(tent.triangle(f), normals);
            sum = sum.plus(&measures, 0.5 * radius * radius * angle / tent.face_area(f));
        }
        let expected = (sum.mean_curvature().unwrap(), sum.gaussian_curvature().unwrap());
        assert!((field.mean[0] - expected.0).abs() < 1e-13, "{} {expected:?}", field.mean[0]);
        assert!((field.gaussian[0] - expected.1).abs() < 1e-13);
    }
}
