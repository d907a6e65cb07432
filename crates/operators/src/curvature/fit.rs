//! Local coordinates and the curvature of a height field, shared by the polynomial
//! fits.

use std::sync::atomic::{AtomicUsize, Ordering};

use fairing_mesh::{Topology, TriMesh};
use glam::DVec3;

use super::field::{AtVertex, CurvatureField};
use super::neighborhood::{Explorer, Neighborhood, Reach};
use super::oriented::on_oriented;
use super::status::Undefined;
use crate::error::OperatorError;
use crate::normal_equations::NormalEquations;
use crate::normals::{NormalWeight, smoothed_normals, weighted_vertex_normals};
use crate::surface::{ChartNormal, FundamentalForms, SurfaceJet};
use crate::tangent::{Symmetric2, tangent_frame};

/// A neighbourhood as a height field: the vertex in the origin, its normal
/// upwards, lengths in units of `scale`.
///
/// The axes are the principal ones of the neighbours in the tangent plane, each
/// in a unit of its own, so that what a fit can determine depends neither on an
/// arbitrary frame nor on how long the faces are one way and short the other.
pub(crate) struct HeightField<'a> {
    /// The neighbours, without the vertex itself.
    points: &'a [[f64; 3]],
    frame: [DVec3; 2],
    normal: DVec3,
    scale: f64,
    /// The units of the two axes over `scale`.
    units: [f64; 2],
    /// True if the neighbourhood is far from flat.
    is_bent: bool,
}

/// The least ratio of the units of the axes. Heights are rounded to ε of the
/// long axis a, and second derivatives along the short one b divide that by b²:
/// at this ratio they keep four digits of the curvature 1/a.
const MIN_UNIT: f64 = 1e-6;

impl<'a> HeightField<'a> {
    /// The neighbours of the first of `vertices`, written to `points`; `None`
    /// where they lie on a line, up to rounding, or in one place.
    fn new(
        mesh: &TriMesh,
        vertices: &[u32],
        normal: DVec3,
        points: &'a mut Vec<[f64; 3]>,
        is_bent: bool,
    ) -> Option<Self> {
        let positions = mesh.positions();
        let at = |w: u32| DVec3::from(positions[w as usize]);
        let centre = at(vertices[0]);
        let [e1, e2] = tangent_frame(normal);
        points.clear();
        let mut sum = 0.0;
        for &w in &vertices[1..] {
            let d = at(w) - centre;
            sum += d.length();
            points.push([d.dot(e1), d.dot(e2), d.dot(normal)]);
        }
        let scale = sum / points.len() as f64;
        if scale.is_nan() || scale <= 0.0 {
            return None;
        }
        let unit = 1.0 / scale;
        let axes = PrincipalAxes::new(points.iter().map(|p| [p[0] * unit, p[1] * unit]))?;
        let [c, s] = axes.direction;
        let [a, b] = axes.units.map(|u| unit / u);
        for [x, y, z] in points.iter_mut() {
            [*x, *y, *z] = [(c * *x + s * *y) * a, (c * *y - s * *x) * b, *z * unit];
        }
        let frame = [c * e1 + s * e2, c * e2 - s * e1];
        Some(Self { points, frame, normal, scale, units: axes.units, is_bent })
    }

    /// `[x, y, z]` of the neighbours, without the vertex itself; x and y each
    /// in the unit of its axis.
    #[inline]
    pub(crate) fn neighbors(&self) -> impl Iterator<Item = [f64; 3]> + '_ {
        self.points.iter().copied()
    }

    /// The square of the distance of a neighbour, in units of their mean.
    #[inline]
    pub(crate) fn squared_distance(&self, [x, y, z]: [f64; 3]) -> f64 {
        let [a, b] = self.units;
        (a * x).powi(2) + (b * y).powi(2) + z * z
    }

    /// The factors of z² that are added to x² and y², in the units of the axes.
    pub(crate) fn bends(&self) -> [f64; 2] {
        self.units.map(|u| if self.is_bent { 0.5 / (u * u) } else { 0.0 })
    }

    /// The curvature of the polynomial that fits the vertex and its neighbours, each with its
    /// weight, in the given monomials, of which the first six are `1, x, y, x², xy, y²`.
    ///
    /// Where the neighbourhood is bent, `x² + z²/2` and `y² + z²/2` stand for the squares: on
    /// spheres the fit is exact then, and on cylinders its error is halved. As a level set F = 0 of
    /// such a polynomial less z, the derivatives of a height field are `zₓ = −Fₓ/F_z` and
    /// `zₓₓ = −(Fₓₓ + F_zz zₓ²)/F_z`. Quartics are close to z² themselves: beside them the
    /// equations would hardly determine the squares.
    #[inline]
    pub(crate) fn fit<const N: usize>(
        &self,
        monomials: impl Fn(f64, f64) -> [f64; N],
        weight: impl Fn([f64; 3]) -> f64,
    ) -> Option<AtVertex> {
        let bends = if N < QUARTIC { self.bends() } else { [0.0; 2] };
        let mut equations = NormalEquations::<N>::default();
        equations.add(&monomials(0.0, 0.0), 0.0, 1.0);
        for point in self.neighbors() {
            let [x, y, z] = point;
            let mut row = monomials(x, y);
            row[3] += bends[0] * z * z;
            row[5] += bends[1] * z * z;
            equations.add(&row, z, weight(point));
        }
        let c = equations.solve()?;
        let bend = 2.0 * (bends[0] * c[3] + bends[1] * c[5]);
        let slope = 1.0 - bend * c[0];
        if slope <= 0.0 {
            return None;
        }
        let [zx, zy] = [c[1] / slope, c[2] / slope];
        let second = |own: f64, square: f64| (own + bend * square) / slope;
        self.curvature(
            [zx, zy],
            [second(2.0 * c[3], zx * zx), second(c[4], zx * zy), second(2.0 * c[5], zy * zy)],
        )
    }

    /// The curvature at the origin of a height field with this gradient and
    /// these second derivatives xx, xy, yy there, in local units.
    pub(crate) fn curvature(&self, [zx, zy]: [f64; 2], second: [f64; 3]) -> Option<AtVertex> {
        let [a, b] = self.units;
        let jet = SurfaceJet {
            point: [0.0; 3],
            du: [1.0, 0.0, zx / a],
            dv: [0.0, 1.0, zy / b],
            duu: [0.0, 0.0, second[0] / (a * a)],
            duv: [0.0, 0.0, second[1] / (a * b)],
            dvv: [0.0, 0.0, second[2] / (b * b)],
        };
        let principal = FundamentalForms::from_jet(jet, ChartNormal::Outward)?.principal();
        let in_space =
            |[x, y, z]: [f64; 3]| x * self.frame[0] + y * self.frame[1] + z * self.normal;
        let values = principal.values.map(|k| k / self.scale);
        // Steep fits leave digits of the length.
        let [first, second] = principal.directions.map(|d| in_space(d).try_normalize());
        Some(AtVertex::new(values, [first?, second?]))
    }
}

/// The least cosine between the normals of a neighbourhood that is a height field: 60°.
const MIN_COSINE: f64 = 0.5;

/// The least cosine of one that is nearly flat, where z² is negligible beside x² + y²: 30°.
const FLAT_COSINE: f64 = 0.866;

/// The monomials up to degree four.
const QUARTIC: usize = 15;

/// The neighbours that determine a quadric.
const OF_QUADRIC: usize = 5;

/// The rings from which a ball that turns too far is narrowed.
const RINGS_OF_BALLS: u32 = 3;

/// The axes along which points of a plane spread most and least, and how far.
#[derive(Debug, Clone, Copy)]
pub struct PrincipalAxes {
    /// The first axis; the second is its quarter turn.
    pub direction: [f64; 2],
    /// √2 times the root mean square along each, which is one for points on a
    /// unit circle.
    pub units: [f64; 2],
}

impl PrincipalAxes {
    /// About the origin. `None` where the second unit is below a millionth of
    /// the first: the points are on a line as far as second derivatives can
    /// tell.
    #[inline]
    pub fn new(points: impl ExactSizeIterator<Item = [f64; 2]> + Clone) -> Option<Self> {
        let count = points.len() as f64;
        let mut moments = Symmetric2::default();
        for [x, y] in points.clone() {
            moments.a += x * x;
            moments.b += x * y;
            moments.c += y * y;
        }
        let (_, direction) = moments.eigen();
        let turned = Self { direction, units: [1.0; 2] };
        // Summed along the axes: the moments do not show a short one.
        let squares = points
            .map(|p| turned.coordinates(p))
            .fold([0.0; 2], |[a, b], [x, y]| [a + x * x, b + y * y]);
        let units = squares.map(|s| (2.0 * s / count).sqrt());
        (units[1] > MIN_UNIT * units[0]).then_some(Self { direction, units })
    }

    /// The coordinates of a point along the axes, each in its unit.
    #[inline]
    pub fn coordinates(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let ([c, s], [a, b]) = (self.direction, self.units);
        [(c * x + s * y) / a, (c * y - s * x) / b]
    }
}

/// `1, x, y, x², xy, y²`.
#[inline]
pub(crate) fn quadratic(x: f64, y: f64) -> [f64; 6] {
    [1.0, x, y, x * x, x * y, y * y]
}

/// Fits every vertex on its own.
///
/// A neighbourhood with fewer than `at_least` others is widened; where the connected part has no
/// more, the vertex has too few neighbours. One whose normals, averaged twice, turn by more than
/// 60° from that of the vertex is no height field: fewer rings are taken there, and where these do
/// not determine the fit, a quadric. Where the fit finds no solution the neighbours do not
/// determine one.
pub(crate) fn fit_each<F>(
    mesh: &TriMesh,
    neighborhood: Neighborhood,
    at_least: usize,
    fit: F,
) -> Result<CurvatureField, OperatorError>
where
    F: Fn(&HeightField<'_>) -> Option<AtVertex> + Sync,
{
    on_oriented(mesh, |mesh| fit_oriented(mesh, neighborhood, at_least, fit))
}

fn fit_oriented<F>(
    mesh: &TriMesh,
    neighborhood: Neighborhood,
    at_least: usize,
    fit: F,
) -> Result<CurvatureField, OperatorError>
where
    F: Fn(&HeightField<'_>) -> Option<AtVertex> + Sync,
{
    let reach = neighborhood.reach(mesh)?;
    let topology: &Topology = mesh.topology();
    let normals = weighted_vertex_normals(mesh, NormalWeight::Area);
    let smooth = smoothed_normals(mesh, &normals);
    let turns = |found: &[u32], least: f64| {
        let centre = smooth[found[0] as usize];
        found.iter().any(|&w| smooth[w as usize].dot(centre) < least)
    };
    let narrowed = AtomicUsize::new(0);
    let at_vertex = |(explorer, points): &mut (Explorer, Vec<[f64; 3]>), v: u32| {
        if topology.neighbors(v).is_empty() {
            return Err(Undefined::Isolated);
        }
        let normal = DVec3::from(normals[v as usize]);
        if normal == DVec3::ZERO {
            return Err(Undefined::NoArea);
        }
        explorer.explore(mesh, topology, v, &reach, at_least);
        if explorer.found.len() <= at_least.min(OF_QUADRIC) {
            return Err(Undefined::TooFewNeighbors);
        }
        let too_wide = turns(&explorer.found, MIN_COSINE);
        if too_wide {
            let rings = if let Reach::Rings(count) = reach { count } else { RINGS_OF_BALLS };
            for fewer in (1..rings.max(2)).rev() {
                explorer.explore(mesh, topology, v, &Reach::Rings(fewer), OF_QUADRIC);
                if !turns(&explorer.found, MIN_COSINE) {
                    break;
                }
            }
        }
        let is_lower = explorer.found.len() <= at_least;
        if is_lower && !too_wide {
            return Err(Undefined::TooFewNeighbors);
        }
        if too_wide {
            narrowed.fetch_add(1, Ordering::Relaxed);
        }
        let is_bent = turns(&explorer.found, FLAT_COSINE);
        let field = HeightField::new(mesh, &explorer.found, normal, points, is_bent);
        let field = field.ok_or(Undefined::IllConditioned)?;
        let found = if is_lower { None } else { fit(&field) };
        let found = found.or_else(|| if too_wide { field.fit(quadratic, |_| 1.0) } else { None });
        found.ok_or(Undefined::IllConditioned)
    };
    let mut field = CurvatureField::at_each_vertex(mesh, at_vertex);
    field.narrowed = narrowed.into_inner();
    Ok(field)
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use fairing_shapes::{Diagonals, plane};

    /// The graph of a height over [−½, ½]², and its vertex in the middle.
    pub(crate) fn dome(height: impl Fn(f64, f64) -> f64) -> (TriMesh, usize) {
        let flat = plane(10, 10, Diagonals::Regular);
        let lift = |p: &[f64; 3]| {
            let [x, y] = [p[0] - 0.5, p[1] - 0.5];
            [x, y, height(x, y)]
        };
        let positions = flat.positions().iter().map(lift).collect();
        (flat.with_positions(positions).unwrap(), 60)
    }

    /// A slope is not curved, and the curvature of a cylinder does not depend
    /// on where the frame has its axes.
    #[test]
    fn gradients_are_taken_into_account() {
        let (mesh, v) = dome(|x, y| 0.3 * x - 0.7 * y);
        let flat = fit_each(&mesh, Neighborhood::Rings(1), 5, |f| f.curvature([0.0; 2], [0.0; 3]));
        assert_eq!(flat.unwrap().kappa1[v], 0.0);
        // z = ½ x² at x = 1 has the curvature 1 / (1 + 1)^(3/2), downwards.
        let scaled = fit_each(&mesh, Neighborhood::Rings(1), 5, |f| {
            // In the unit of the axis.
            let unit = f.units[0];
            f.curvature([unit, 0.0], [f.scale * unit * unit, 0.0, 0.0])
        });
        let scaled = scaled.unwrap();
        assert!((scaled.kappa2[v] + 8f64.sqrt().recip()).abs() < 1e-14, "{}", scaled.kappa2[v]);
        assert_eq!(scaled.kappa1[v], 0.0);
    }
}
