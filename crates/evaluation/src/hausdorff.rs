//! The Hausdorff distance between surfaces, to a bound.

use fairing_mesh::vec3::{add, distance, scale};
use fairing_mesh::{OptionError, TriMesh};
use rayon::prelude::*;

use crate::distance::{at_unit_scale, tree};
use crate::triangle::squared_distance;
use crate::{EvaluationError, SurfaceTree};

/// An interval that holds a Hausdorff distance, in mesh units.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Hausdorff {
    /// The distance is at least this: that of a point of one surface from the
    /// other.
    pub lower: f64,
    /// The distance is at most this.
    pub upper: f64,
}

/// The Hausdorff distance of two surfaces over all their points, not only
/// their vertices,
///
/// ```text
/// max( max_{x ∈ A} d(x, B), max_{y ∈ B} d(y, A) )
/// ```
///
/// to within `tolerance` (mesh units): `upper − lower ≤ tolerance`, up to
/// rounding.
///
/// Distance to one triangle is convex, so that over a face it is largest at a
/// corner; the least of these maxima over the triangles closest to the corners
/// and to the middle bounds the distance of the face from above, and so does
/// the distance of its middle plus the reach from there. Faces whose bound
/// passes what is reached already are cut into four until it does not. Source:
/// \[guthe2005\].
///
/// # Errors
///
/// [`EvaluationError::NoFaces`], [`EvaluationError::Option`] unless the
/// tolerance is positive and finite.
pub fn hausdorff(a: &TriMesh, b: &TriMesh, tolerance: f64) -> Result<Hausdorff, EvaluationError> {
    OptionError::require_positive("tolerance", tolerance)?;
    let (a, b, unit) = at_unit_scale(a, b);
    let (own, other) = (tree(&a, "mesh")?, tree(&b, "reference")?);
    // A tolerance beyond the range of floats is as good as its border.
    let tolerance = (tolerance / unit).clamp(f64::MIN_POSITIVE, f64::MAX);
    Ok(between(&a, &own, &b, &other, tolerance).times(unit))
}

impl Hausdorff {
    pub(crate) fn times(self, unit: f64) -> Self {
        Self { lower: self.lower * unit, upper: self.upper * unit }
    }
}

/// [`hausdorff`] with trees that are there already.
pub(crate) fn between(
    a: &TriMesh,
    own: &SurfaceTree,
    b: &TriMesh,
    other: &SurfaceTree,
    tolerance: f64,
) -> Hausdorff {
    let forward = one_sided(a, b, other, 0.0, tolerance);
    // The other side only matters where it goes beyond this one.
    let backward = one_sided(b, a, own, forward.lower, tolerance);
    Hausdorff { lower: forward.lower.max(backward.lower), upper: forward.upper.max(backward.upper) }
}

/// A face or a part of one, with a triangle close to each of its corners and
/// the distances of the corners.
#[derive(Clone, Copy)]
struct Part {
    corners: [[f64; 3]; 3],
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
    let watch = fairing_watch::current();
    watch.stage("Hausdorff distance", mesh.face_count() as u64);
    let bounds: Vec<[f64; 2]> = (0..mesh.face_count())
        .into_par_iter()
        .with_min_len(256)
        .map(|f| {
            watch.advance(1);
            let ids = mesh.faces()[f];
            let part = Part {
                corners: mesh.triangle(f),
                distances: ids.map(|v| closest[v as usize].distance),
                near: ids.map(|v| closest[v as usize].face),
            };
            refine(part, other, surface, reached, tolerance)
        })
        .collect();
    let [lower, upper] = bounds.iter().fold([reached; 2], |[l, u], b| [l.max(b[0]), u.max(b[1])]);
    Hausdorff { lower, upper }
}

/// The distance found and the bound of a face, neither below `reached`.
fn refine(
    part: Part,
    other: &TriMesh,
    surface: &SurfaceTree,
    reached: f64,
    tolerance: f64,
) -> [f64; 2] {
    let (mut lower, mut upper) = (reached, reached);
    let mut parts = vec![part];
    while let Some(part) = parts.pop() {
        let mut bound = bound(&part, other);
        if bound > lower + tolerance {
            let [a, b, c] = part.corners;
            let centre = scale(add(a, add(b, c)), 1.0 / 3.0);
            let found = surface.closest(centre);
            lower = lower.max(found.distance);
            let reach = part.corners.map(|p| distance(p, centre)).into_iter().fold(0.0, f64::max);
            let over_face = farthest_corner(&part, other.triangle(found.face as usize));
            bound = bound.min(over_face).min(found.distance + reach);
        }
        if bound <= lower + tolerance {
            upper = upper.max(bound);
            continue;
        }
        let [a, b, c] = part.corners;
        let middles = [(b, c), (c, a), (a, b)].map(|(p, q)| scale(add(p, q), 0.5));
        let found = middles.map(|p| surface.closest(p));
        for f in found {
            lower = lower.max(f.distance);
        }
        // Rounding leaves nothing to cut.
        if longest_side(part.corners) <= 1e-3 * tolerance {
            upper = upper.max(bound);
            continue;
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
    [lower, upper.max(lower)]
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
    part.corners.iter().map(|&p| squared_distance(p, triangle)).fold(0.0, f64::max).sqrt()
}

fn longest_side([a, b, c]: [[f64; 3]; 3]) -> f64 {
    distance(a, b).max(distance(b, c)).max(distance(c, a))
}
