//! Growth of the noise level with the scale at which it is measured.

use std::ops::RangeInclusive;

use fairing_mesh::TriMesh;
use glam::DVec3;
use rayon::prelude::*;

use fairing_operators::{NormalEquations, PrincipalAxes, tangent_frame};
use fairing_sparse::median;

use super::faces::Marks;

/// The median of |x| over the standard deviation, for Gaussian x.
pub(crate) const GAUSSIAN_MEDIAN: f64 = 0.674_489_75;

/// The vertices of a stencil: more are beyond a hub, and the stencil is left out.
const MAX_RING: usize = 4096;

/// The least number of stencils for a level.
const MIN_COUNT: usize = 32;

/// The number of vertices that levels are measured at.
const SAMPLES: f64 = 2048.0;

/// The largest growth of the level from one edge to two and from two to four. Noise of depth
/// cameras grows by at most 5.3 on the scans of the development set.
const LARGEST_GROWTH: f64 = 6.0;

/// The least level at four edges, in mean edge lengths.
const MIN_LEVEL: f64 = 0.1;

/// The growth from four edges to eight of noise that is correlated over eight.
const FURTHER: RangeInclusive<f64> = 1.2..=2.0;

/// The largest median stretch of faces, the squared longest side over twice the area: 1.2 for
/// equilateral faces, 2 for halves of squares. Scales are counted in edges, which have no one
/// length on meshes that are stretched more.
const LARGEST_STRETCH: f64 = 2.8;

/// The numbers that tell the noise of depth cameras from independent noise and from shape.
const NUMBERS: usize = 7;

/// The terms of the second degree in these numbers.
pub const TERMS: usize = (NUMBERS + 1) * (NUMBERS + 2) / 2;

/// The weights of the [terms](Growth::terms): `cargo xtask benchmark correlation --fit`.
const WEIGHTS: [f64; TERMS] = [
    1.5496, 4.1304, 3.9553, 4.1857, 3.7209, -2.2168, -5.3048, -1.8082, -0.2256, -2.2567, -0.2775,
    -0.5428, -0.9993, 8.2648, -2.8483, -4.1756, 0.5115, 0.4266, 2.3969, 0.2602, -3.0743, -2.6694,
    1.4378, -2.1494, -0.5398, 0.9071, -1.7974, -3.2502, -1.6665, -1.3289, 3.015, -4.3699, -0.0424,
    -2.5311, -0.8889, 0.3325,
];

/// The least sum of the weighted terms, in log-odds. Of seven values from 0 to 2 the largest with
/// the least loss on the development set, each family left out of the fit in turn.
const LEAST_SCORE: f64 = 1.25;

/// The growth of the noise level with the scale.
#[derive(Debug, Clone, Copy)]
pub struct Growth {
    /// log₂ of the levels at one edge over that of neighbours, at two over one, at four over two,
    /// and at eight over four; log₂ of the tail ratio; the low ratio; the correlation across edges.
    numbers: [f64; NUMBERS],
    /// The levels at four and at eight edges, in mesh units.
    wide: [f64; 2],
    /// The level at four edges, in mean edge lengths.
    relative: f64,
    /// The surface has a border, as that which a camera sees from one side.
    is_open: bool,
}

impl Growth {
    /// Measures the noise at some of the vertices. Its level between neighbours is `near`; `shape`
    /// is the tail ratio of the residuals, their low ratio, and their correlation across edges.
    /// `None` where there are too few vertices, where faces are stretched, and where the level
    /// grows as that of a smooth surface.
    pub fn new(
        mesh: &TriMesh,
        near: f64,
        shape: [f64; 3],
        inside: impl Fn(u32) -> bool + Sync,
    ) -> Option<Self> {
        if stretch(mesh, &inside)? > LARGEST_STRETCH {
            return None;
        }
        let on_border = mesh.topology().boundary_vertices();
        let is_open = (0..mesh.vertex_count()).any(|v| on_border[v] && inside(v as u32));
        let chosen = chosen(mesh, inside);
        let level = |scale| level_at(mesh, scale, &chosen).filter(|&level| level > 0.0);
        let (one, two) = (level(1)?, level(2)?);
        if two > LARGEST_GROWTH * one {
            return None;
        }
        let four = level(4).filter(|&four| four <= LARGEST_GROWTH * two)?;
        let eight = level(8)?;
        let [tail, low, correlation] = shape;
        let growth = [one / near, two / one, four / two, eight / four, tail];
        let [a, b, c, d, tail] = growth.map(|ratio| libm::log2(ratio).clamp(-6.0, 6.0));
        let numbers = [a, b, c, d, tail, low, correlation];
        let relative = four / mesh.mean_edge_length();
        Some(Self { numbers, wide: [four, eight], relative, is_open })
    }

    /// 1, the numbers, and their products.
    pub fn terms(&self) -> [f64; TERMS] {
        let mut all = [0.0; TERMS];
        let mut next = 0;
        for i in 0..=NUMBERS {
            for j in i..=NUMBERS {
                let number = |k: usize| if k == 0 { 1.0 } else { self.numbers[k - 1] };
                all[next] = number(i) * number(j);
                next += 1;
            }
        }
        all
    }

    /// Returns `true` if the noise is that of a depth camera. No closed surface is its view.
    pub fn is_correlated(&self) -> bool {
        let score: f64 = self.terms().iter().zip(WEIGHTS).map(|(term, weight)| term * weight).sum();
        self.is_open && score > LEAST_SCORE && self.relative > MIN_LEVEL
    }

    /// The distance over which correlated noise is correlated, in edges, and its level at this
    /// scale in mesh units.
    pub(crate) fn length_and_level(&self) -> (f64, f64) {
        let [four, eight] = self.wide;
        if FURTHER.contains(&(eight / four)) { (8.0, eight) } else { (4.0, four) }
    }
}

/// The noise level at a scale, in mesh units; `None` with fewer than 32 stencils.
pub(crate) fn level_at_scale(mesh: &TriMesh, scale: u32) -> Option<f64> {
    level_at(mesh, scale, &chosen(mesh, |_| true))
}

/// About as many as [`SAMPLES`] of the vertices that are `inside`; all if there are fewer.
fn chosen(mesh: &TriMesh, inside: impl Fn(u32) -> bool) -> Vec<u32> {
    let all: Vec<u32> = (0..mesh.vertex_count() as u32).filter(|&v| inside(v)).collect();
    let limit = SAMPLES / all.len() as f64 * f64::from(u32::MAX);
    all.into_iter().filter(|&v| f64::from(hash(v)) <= limit).collect()
}

/// A number without order: a regular choice of vertices may follow the rows of an image.
fn hash(v: u32) -> u32 {
    let x = (v ^ (v >> 16)).wrapping_mul(0x7feb_352d);
    let x = (x ^ (x >> 15)).wrapping_mul(0x846c_a68b);
    x ^ (x >> 16)
}

/// The median stretch of the faces at some of the vertices.
fn stretch(mesh: &TriMesh, inside: impl Fn(u32) -> bool) -> Option<f64> {
    let faces = (0..mesh.face_count()).filter(|&f| inside(mesh.faces()[f][0]));
    let mut all: Vec<f64> = faces
        .map(|f| {
            let [a, b, c] = mesh.triangle(f).map(DVec3::from);
            let longest =
                a.distance_squared(b).max(b.distance_squared(c)).max(c.distance_squared(a));
            longest / (2.0 * mesh.face_area(f)).max(f64::MIN_POSITIVE)
        })
        .collect();
    all.sort_unstable_by(f64::total_cmp);
    median(&all)
}

/// The noise level that stencils of a scale find at the chosen vertices, in mesh units; `None`
/// with fewer than 32 of them.
///
/// A stencil of scale s compares a vertex with the quadric through the vertices s and 2 s edges
/// away, as a height field over the plane of the area vector of all faces within 2 s edges. The
/// level is the median of the residuals, each over the standard deviation that it has under
/// independent noise of level 1, scaled to that of a Gaussian. Independent noise has the same
/// level at all scales.
fn level_at(mesh: &TriMesh, scale: u32, chosen: &[u32]) -> Option<f64> {
    let incidence = mesh.incidence();
    let mut areas = vec![DVec3::ZERO; mesh.vertex_count()];
    for (f, face) in mesh.faces().iter().enumerate() {
        let area = DVec3::from(mesh.area_vector(f));
        face.iter().for_each(|&v| areas[v as usize] += area);
    }
    let residual = |stencil: &mut Stencil, v: u32| {
        let at = |w: u32| DVec3::from(mesh.positions()[w as usize]);
        let Stencil { marks, queue, points } = stencil;
        marks.clear();
        queue.clear();
        points.clear();
        marks.insert(v);
        queue.push(v);
        let (mut begin, mut normal, mut near) = (0, areas[v as usize], 0..0);
        for hop in 1..=2 * scale {
            let end = queue.len();
            for i in begin..end {
                for &corner in incidence.corners(queue[i]) {
                    for w in mesh.faces()[corner as usize / 3] {
                        if marks.insert(w) {
                            queue.push(w);
                            normal += areas[w as usize];
                        }
                    }
                }
                if queue.len() > MAX_RING {
                    return None;
                }
            }
            begin = end;
            if hop == scale {
                near = end..queue.len();
            }
        }
        let normal = normal.try_normalize()?;
        let [e1, e2] = tangent_frame(normal);
        let chosen = queue[near].iter().chain(&queue[begin..]);
        points.extend(chosen.map(|&w| {
            let d = at(w) - at(v);
            [d.dot(e1), d.dot(e2), d.dot(normal)]
        }));
        let square = |p: &[f64; 3]| DVec3::from(*p).length_squared();
        let reach = points.iter().map(square).fold(0.0, f64::max).sqrt();
        if points.len() < 9 || reach <= 0.0 {
            return None;
        }
        points.iter_mut().for_each(|p| *p = p.map(|x| x / reach));
        quadric_residual(points).map(|r| (r * reach).abs()).filter(|r| r.is_finite())
    };
    let mut residuals: Vec<f64> = chosen
        .par_iter()
        .map_init(|| Stencil::new(mesh.vertex_count()), |stencil, &v| residual(stencil, v))
        .flatten()
        .collect();
    residuals.sort_unstable_by(f64::total_cmp);
    if residuals.len() < MIN_COUNT { None } else { median(&residuals).map(|m| m / GAUSSIAN_MEDIAN) }
}

/// The vertices around one, in order of distance, and their offsets; reused for the next.
struct Stencil {
    marks: Marks,
    queue: Vec<u32>,
    points: Vec<[f64; 3]>,
}

impl Stencil {
    fn new(vertices: usize) -> Self {
        Self { marks: Marks::new(vertices), queue: vec![], points: vec![] }
    }
}

/// The standardised residual at the origin from a quadric through the points.
pub(crate) fn quadric_residual(points: &[[f64; 3]]) -> Option<f64> {
    let axes = PrincipalAxes::new(points.iter().map(|p| [p[0], p[1]]))?;
    residual(points, |p| {
        let [x, y] = axes.coordinates(p);
        [1.0, x, y, x * x, x * y, y * y]
    })
}

/// The standardised residual at the origin from a combination of functions through the points.
pub(crate) fn residual<const N: usize>(
    points: &[[f64; 3]],
    basis: impl Fn([f64; 2]) -> [f64; N],
) -> Option<f64> {
    let mut equations = NormalEquations::<N>::default();
    for &[x, y, z] in points {
        equations.add(&basis([x, y]), z, 1.0);
    }
    let factor = equations.factor()?;
    let leverage = factor.variance(&basis([0.0; 2]));
    Some(-factor.solve(equations.rhs())[0] / (1.0 + leverage).sqrt())
}

#[cfg(test)]
mod tests {
    use fairing_shapes as shapes;
    use rand::{RngExt as _, SeedableRng as _};
    use rand_chacha::ChaCha8Rng;

    use super::*;

    /// A plane of `n` by `n` squares with the heights that `noise` returns.
    fn plane(n: u32, mut noise: impl FnMut() -> f64) -> TriMesh {
        let flat = shapes::plane(n, n, shapes::Diagonals::Regular);
        let lifted = flat.positions().iter().map(|&[x, y, _]| [x, y, noise()]).collect();
        flat.with_positions(lifted).unwrap()
    }

    /// Independent noise has the same level at all scales, also from a part of the vertices.
    #[test]
    fn independent_noise_does_not_grow() {
        let mut rng = ChaCha8Rng::seed_from_u64(7);
        let mut sum = || (0..12).map(|_| rng.random::<f64>() - 0.5).sum::<f64>();
        let mesh = plane(90, || 1e-3 * sum());
        assert!((1500..2500).contains(&chosen(&mesh, |_| true).len()));
        assert_eq!(chosen(&mesh, |v| v % 9 == 0).len(), (91usize * 91).div_ceil(9));
        for scale in [1, 2, 4, 8] {
            let level = level_at_scale(&mesh, scale).unwrap();
            assert!((level - 1e-3).abs() < 1e-4, "{scale}: {level}");
        }
        let growth = Growth::new(&mesh, 1e-3, [1.0, 1.0, -0.27], |_| true).unwrap();
        assert!(growth.numbers[..4].iter().all(|x| x.abs() < 0.15), "{:?}", growth.numbers);
        assert!(!growth.is_correlated());
    }

    /// The level of a plane is zero, that of a smooth surface grows; neither is tested further.
    #[test]
    fn shape_is_not_tested() {
        assert!(Growth::new(&plane(40, || 0.0), 1.0, [1.0; 3], |_| true).is_none());
        let ball = shapes::icosphere(4);
        let near = level_at_scale(&ball, 1).unwrap();
        assert!(Growth::new(&ball, near, [1.0; 3], |_| true).is_none());
        assert!(Growth::new(&shapes::icosphere(0), 1.0, [1.0; 3], |_| true).is_none());
    }

    #[test]
    fn terms_are_products() {
        let numbers = [2.0, 3.0, 5.0, 7.0, 11.0, 13.0, 17.0];
        let terms = Growth { numbers, wide: [1.0; 2], relative: 1.0, is_open: true }.terms();
        assert_eq!(terms[..9], [1.0, 2.0, 3.0, 5.0, 7.0, 11.0, 13.0, 17.0, 4.0]);
        assert_eq!(terms[TERMS - 3..], [13.0 * 13.0, 13.0 * 17.0, 17.0 * 17.0]);
    }
}
