//! Growth of the noise level with the scale at which it is measured.

use std::ops::RangeInclusive;

use fairing_mesh::TriMesh;
use glam::DVec3;
use rayon::prelude::*;

use fairing_operators::{NormalEquations, PrincipalAxes, tangent_frame};

use super::faces::Marks;

/// The median of |x| over the standard deviation, for Gaussian x.
pub(crate) const GAUSSIAN_MEDIAN: f64 = 0.674_489_75;

/// The vertices of a stencil: more are beyond a hub, and the stencil is left out.
const MAX_RING: usize = 4096;

/// The least number of stencils for a level.
const MIN_COUNT: usize = 32;

/// The least growth of the level of correlated noise, from neighbours to stencils of one edge, and
/// to those of two. Independent noise stays below one of them.
const MIN_GROWTH: f64 = 1.25;

/// The largest growth of the level of correlated noise, from neighbours to stencils of one edge,
/// from those to stencils of two, and from those to stencils of four. A surface without noise
/// exceeds one of them.
const LARGEST_GROWTH: [f64; 3] = [4.0, 1.9, 2.0];

/// The growth from four edges to eight of noise that is correlated over eight.
const FURTHER: RangeInclusive<f64> = 1.2..=2.0;

/// The largest median stretch of faces, the squared longest side over twice the area: 1.2 for
/// equilateral faces, 2 for halves of squares. Scales are counted in edges, which have no one
/// length on meshes that are stretched more.
const LARGEST_STRETCH: f64 = 2.8;

/// The distance over which noise at some of the vertices is correlated, in edges, and its level at
/// this scale in mesh units; `None` for independent noise, and for surfaces without noise. `near`
/// is the level from neighbours.
pub(crate) fn correlated_over(
    mesh: &TriMesh,
    near: f64,
    inside: impl Fn(u32) -> bool + Sync,
) -> Option<(f64, f64)> {
    if stretch(mesh, &inside)? > LARGEST_STRETCH {
        return None;
    }
    let level = |scale| level_at(mesh, scale, &inside);
    let one = level(1)?;
    if !(MIN_GROWTH..=LARGEST_GROWTH[0]).contains(&(one / near)) {
        return None;
    }
    let two = level(2)?;
    if two < MIN_GROWTH * near || two > LARGEST_GROWTH[1] * one {
        return None;
    }
    let four = level(4).filter(|&four| four <= LARGEST_GROWTH[2] * two)?;
    let eight = level(8).filter(|eight| FURTHER.contains(&(eight / four)));
    Some(eight.map_or((4.0, four), |eight| (8.0, eight)))
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

/// The noise level that stencils of a scale find at some of the vertices, in mesh units; `None`
/// with fewer than 32 of them.
///
/// A stencil of scale s compares a vertex with the quadric through the vertices s and 2 s edges
/// away, as a height field over the plane of the area vector of all faces within 2 s edges. The
/// level is the median of the residuals, each over the standard deviation that it has under
/// independent noise of level 1, scaled to that of a Gaussian. Independent noise has the same
/// level at all scales.
fn level_at(mesh: &TriMesh, scale: u32, inside: impl Fn(u32) -> bool + Sync) -> Option<f64> {
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
    let mut residuals: Vec<f64> = (0..mesh.vertex_count() as u32)
        .into_par_iter()
        .map_init(|| Stencil::new(mesh.vertex_count()), |s, v| inside(v).then(|| residual(s, v))?)
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

/// The middle of ascending values; the mean of both where there are two.
pub(crate) fn median(sorted: &[f64]) -> Option<f64> {
    let n = sorted.len();
    Some(0.5 * sorted.get(n.checked_sub(1)? / 2)? + 0.5 * sorted[n / 2])
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
