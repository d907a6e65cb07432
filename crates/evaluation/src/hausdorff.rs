//! The Hausdorff distance between surfaces, within a tolerance.

use fairing_mesh::TriMesh;
use fairing_parameters::Range;
use fairing_watch::parallel;
use glam::DVec3;

use crate::distance::tree;
use crate::error::EvaluationError;
use crate::surface_tree::SurfaceTree;
use crate::triangle::squared_distance;

/// The smallest tolerance, relative to the largest coordinate: midpoints are off
/// by half a rounding of each coordinate, distances by a few.
const FINEST: f64 = 8.0 * f64::EPSILON;

/// The number of parts of all faces beyond which the tolerance grows: seconds of
/// work.
const MAX_PARTS: usize = 1 << 20;

/// The number of parts allowed for every face: with a million faces, a side is a
/// few tolerances of 1e-4 diagonals.
const MIN_PARTS: usize = 256;

/// An interval that holds a Hausdorff distance, in mesh units.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Hausdorff {
    /// A lower bound: the distance of a point of one surface from the other.
    pub lower: f64,
    /// An upper bound.
    pub upper: f64,
}

/// The Hausdorff distance of two surfaces over all their points, not only
/// their vertices,
///
/// ```text
/// max( max_{x ∈ A} d(x, B), max_{y ∈ B} d(y, A) )
/// ```
///
/// to within `tolerance` (mesh units): `upper − lower ≤ tolerance`. Tolerances below the rounding
/// of the coordinates, 1.8e-15 times the largest of either mesh, are raised to this rounding. If
/// the surfaces run at a constant distance, the number of parts grows with the digits of the
/// tolerance; beyond a million parts the interval is wider instead, and still contains the
/// distance.
///
/// The distance to a triangle is convex, so over a face it is largest at a corner. The least of
/// these maxima, over the triangles closest to the corners and to the middle, bounds the distance
/// of the face from above; so does the distance of its middle plus the distance from there to the
/// corners. Faces whose bound exceeds the distance already found are cut into four until it does
/// not. Source: \[guthe2005\].
///
/// # Errors
///
/// [`EvaluationError::NoFaces`], [`EvaluationError::Option`] unless the
/// tolerance is positive and finite.
pub fn hausdorff(a: &TriMesh, b: &TriMesh, tolerance: f64) -> Result<Hausdorff, EvaluationError> {
    Range::POSITIVE.check("tolerance", tolerance)?;
    let (own, other) = (tree(a, "mesh")?, tree(b, "reference")?);
    Ok(between(a, &own, b, &other, tolerance))
}

/// [`hausdorff`] with given trees.
pub(crate) fn between(
    a: &TriMesh,
    own: &SurfaceTree,
    b: &TriMesh,
    other: &SurfaceTree,
    tolerance: f64,
) -> Hausdorff {
    let coordinates = a.positions().iter().chain(b.positions()).flatten();
    let largest = coordinates.fold(0.0, |most: f64, x| most.max(x.abs()));
    let tolerance = tolerance.max(FINEST * largest);
    let forward = one_sided(a, b, other, 0.0, tolerance);
    // The other side only matters where it goes beyond this one.
    let backward = one_sided(b, a, own, forward.lower, tolerance);
    Hausdorff { lower: forward.lower.max(backward.lower), upper: forward.upper.max(backward.upper) }
}

/// A face or a part of one, with a triangle close to each of its corners and
/// the distances of the corners.
#[derive(Clone, Copy)]
struct Part {
    corners: [DVec3; 3],
    distances: [f64; 3],
    near: [u32; 3],
}

fn one_sided(
    mesh: &TriMesh,
    other: &TriMesh,
    surface: &SurfaceTree,
    floor: f64,
    tolerance: f64,
) -> Hausdorff {
    let closest = surface.closest_to_all(mesh.positions());
    let reached =
        mesh.faces().iter().flatten().map(|&v| closest[v as usize].distance).fold(floor, f64::max);
    let parts = MAX_PARTS / mesh.face_count() + MIN_PARTS;
    let watch = fairing_watch::current();
    watch.stage("Hausdorff distance", mesh.face_count() as u64);
    let bounds: Vec<[f64; 2]> = parallel::map(mesh.face_count(), 256, |f| {
        watch.advance(1);
        let ids = mesh.faces()[f];
        let part = Part {
            corners: mesh.triangle(f).map(DVec3::from),
            distances: ids.map(|v| closest[v as usize].distance),
            near: ids.map(|v| closest[v as usize].face),
        };
        refine(part, other, surface, reached, tolerance, parts)
    });
    let [lower, upper] = bounds.iter().fold([reached; 2], |[l, u], b| [l.max(b[0]), u.max(b[1])]);
    Hausdorff { lower, upper }
}

/// The distance found and the bound of a face, neither below `reached`, within
/// the tolerance or as many times 64 of it as the number of parts demands.
fn refine(
    part: Part,
    other: &TriMesh,
    surface: &SurfaceTree,
    reached: f64,
    mut tolerance: f64,
    parts: usize,
) -> [f64; 2] {
    let mut lower = reached;
    loop {
        if let Some(upper) = cut(part, other, surface, &mut lower, tolerance, parts) {
            return [lower, upper.max(lower)];
        }
        tolerance *= 64.0;
    }
}

/// The bound of a face within the tolerance of the distance found, which is
/// raised on the way; `None` if that takes more parts.
///
/// A part with sides up to √3 × the tolerance is never cut: its bound is at most
/// the distance of a corner, which `lower` is not below, plus the tolerance.
/// Halving leaves sides of two roundings of a coordinate, a fraction of the
/// least tolerance.
fn cut(
    part: Part,
    other: &TriMesh,
    surface: &SurfaceTree,
    lower: &mut f64,
    tolerance: f64,
    most: usize,
) -> Option<f64> {
    let mut upper = *lower;
    let (mut parts, mut count) = (vec![part], 0);
    while let Some(part) = parts.pop() {
        let mut bound = bound(&part, other);
        if bound > *lower + tolerance {
            let [a, b, c] = part.corners;
            let centre = (a + (b + c)) * (1.0 / 3.0);
            let found = surface.closest(centre.to_array());
            *lower = lower.max(found.distance);
            let reach = part.corners.map(|p| p.distance(centre)).into_iter().fold(0.0, f64::max);
            let over_face = farthest_corner(&part, other.triangle(found.face as usize));
            bound = bound.min(over_face).min(found.distance + reach);
        }
        if bound <= *lower + tolerance {
            upper = upper.max(bound);
            continue;
        }
        count += 1;
        if count > most {
            return None;
        }
        let [a, b, c] = part.corners;
        let middles = [(b, c), (c, a), (a, b)].map(|(p, q)| 0.5 * (p + q));
        let found = middles.map(|p| surface.closest(p.to_array()));
        for f in found {
            *lower = lower.max(f.distance);
        }
        let (d, n) = (found.map(|f| f.distance), found.map(|f| f.face));
        for k in 0..3 {
            let (i, j) = ((k + 1) % 3, (k + 2) % 3);
            parts.push(Part {
                corners: [part.corners[k], middles[j], middles[i]],
                distances: [part.distances[k], d[j], d[i]],
                near: [part.near[k], n[j], n[i]],
            });
        }
        parts.push(Part { corners: middles, distances: d, near: n });
    }
    Some(upper)
}

/// An upper bound of the distance of the part from the other surface.
fn bound(part: &Part, other: &TriMesh) -> f64 {
    // No point of a triangle is farther from all corners than the longest side
    // over √3, which the middle of an equilateral one is.
    let reach = longest_side(part.corners) / 3f64.sqrt();
    let lipschitz = part.distances.iter().copied().fold(0.0, f64::max) + reach;
    part.near
        .iter()
        .map(|&face| farthest_corner(part, other.triangle(face as usize)))
        .fold(lipschitz, f64::min)
}

/// The largest distance of a corner from a triangle: by convexity, of all
/// points of the part.
fn farthest_corner(part: &Part, triangle: [[f64; 3]; 3]) -> f64 {
    let triangle = triangle.map(DVec3::from);
    part.corners.iter().map(|&p| squared_distance(p, triangle)).fold(0.0, f64::max).sqrt()
}

fn longest_side([a, b, c]: [DVec3; 3]) -> f64 {
    a.distance(b).max(b.distance(c)).max(c.distance(a))
}

#[cfg(test)]
mod tests {
    use fairing_shapes as shapes;

    use super::*;

    /// Triangles whose corners are a few roundings apart, and a tolerance far
    /// below: the interval is as narrow as coordinates are exact.
    #[test]
    fn roundings_are_not_cut() {
        let ulp = f64::EPSILON;
        let positions: Vec<[f64; 3]> =
            (0..30u32).map(|i| [7, 3, 5].map(|k| 1.0 + ulp * f64::from(i * k % 11))).collect();
        let faces = (0..28).map(|i| [i, i + 1, i + 2]).collect();
        let soup = TriMesh::new(positions, faces).unwrap();
        let sphere = shapes::icosphere(2);
        for (a, b) in [(&soup, &soup), (&sphere, &sphere)] {
            for tolerance in [1e-17, f64::MIN_POSITIVE] {
                let found = hausdorff(a, b, tolerance).unwrap();
                assert!(found.lower <= found.upper, "{found:?}");
                assert!(found.upper - found.lower <= 8.1 * ulp * (1.0 + 10.0 * ulp), "{found:?}");
            }
        }
    }

    /// The middle faces of the finer sphere are parallel to those of the coarser
    /// one: around them the distance is constant along lines, on which only the
    /// number of parts sets a limit.
    #[test]
    fn constant_distances_end() {
        let (a, b) = (shapes::icosphere(1), shapes::icosphere(2));
        let surface = SurfaceTree::new(&b).unwrap();
        for f in 0..a.face_count() {
            let corners = a.triangle(f);
            let closest = corners.map(|p| surface.closest(p));
            let distances = closest.map(|c| c.distance);
            let corners = corners.map(DVec3::from);
            let part = Part { corners, distances, near: closest.map(|c| c.face) };
            let rough = refine(part, &b, &surface, 0.0, 1e-3, usize::MAX);
            let fine = refine(part, &b, &surface, 0.0, 1e-15, 3000);
            assert!(fine[0] >= rough[0] - 1e-15 && fine[0] <= rough[1]);
            assert!(fine[1] >= rough[0] && fine[1] - fine[0] < 1e-3, "{fine:?} {rough:?}");
        }
    }
}
