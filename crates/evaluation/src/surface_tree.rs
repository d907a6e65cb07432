//! A bounding-volume tree over the faces of a mesh, for exact distances.
//!
//! The faces are put in the order of a Hilbert curve and packed four to a
//! node, level by level, so that a level is an array and a child's place is
//! four times its parent's: a packed R-tree [kamel1993]. Boxes are in single
//! precision, four tested at once, and only ever exclude faces, with a margin
//! for all of that rounding; distances to faces are computed from the
//! positions of the mesh in double precision and do not depend on the tree.
//!
//! The general tree of the crate `obvhs`, designed for rays, takes five times as long to build, and
//! longer for queries.
//!
//! [kamel1993]: https://doi.org/10.1145/170088.170403

use std::ops::Range;

use fairing_mesh::{TriMesh, hilbert};
use fairing_watch::parallel;
use glam::{DVec3, Vec4};
use rayon::prelude::*;

use crate::error::EvaluationError;
use crate::hub::{by_hub, seen};
use crate::triangle::{closest_point, squared_distance};

/// Half the spacing of single-precision numbers around 1.
const ROUNDOFF: f32 = f32::EPSILON / 2.0;

/// Points in a row that share hints; fixed, so that ties are decided the same
/// way whatever the number of threads.
const CHUNK: usize = 256;

/// Hubs whose faces are found by direction, each of which every search looks at.
const MAX_FANS: usize = 16;

/// The point of a surface closest to a given point.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Closest {
    /// The distance, in mesh units.
    pub distance: f64,
    /// A face that contains the closest point; one of several depends on the
    /// order of the queries.
    pub face: u32,
    /// The closest point.
    pub point: [f64; 3],
}

/// A hierarchy of boxes around the faces of a mesh, for closest-point queries.
#[doc(alias("aabb_tree", "bvh"))]
#[derive(Debug)]
pub struct SurfaceTree {
    /// Levels from the faces up to the root: quad `i` of level 0 holds the boxes of
    /// triangles `4i` to `4i + 3`, quad `i` of a higher level those of quads `4i` to
    /// `4i + 3` of the level below.
    levels: Vec<Vec<Quad>>,
    /// Corners along the curve.
    triangles: Vec<[DVec3; 3]>,
    /// The face of each triangle.
    faces: Vec<u32>,
    frame: Frame,
    /// The faces of hubs, which follow those of the levels.
    fans: Vec<Fan>,
}

/// The faces around a hub, by the directions in which it sees them.
#[derive(Debug)]
struct Fan {
    hub: DVec3,
    /// The slots of the faces, in the levels of their tree.
    slots: Range<usize>,
    /// Levels as of the tree, with boxes around directions, in units of [`Frame::HALF`].
    levels: Vec<Vec<Quad>>,
    /// The box of the faces, four times.
    around: Quad,
}

/// Four boxes, by coordinate.
#[derive(Debug, Clone, Copy)]
struct Quad {
    low: [Vec4; 3],
    high: [Vec4; 3],
}

impl Quad {
    /// Four empty boxes.
    const EMPTY: Self = Self { low: [Vec4::INFINITY; 3], high: [Vec4::NEG_INFINITY; 3] };

    fn set(&mut self, i: usize, low: [f32; 3], high: [f32; 3]) {
        for k in 0..3 {
            self.low[k][i] = low[k];
            self.high[k][i] = high[k];
        }
    }

    /// The box around the four, four times.
    fn around(&self) -> Self {
        Self {
            low: self.low.map(|v| Vec4::splat(v.min_element())),
            high: self.high.map(|v| Vec4::splat(v.max_element())),
        }
    }

    /// A lower bound of the squares of the distances to the boxes.
    #[inline]
    fn below(&self, query: &Query) -> [f32; 4] {
        let outside = |k: usize| {
            let q = query.place[k];
            ((self.low[k] - q).max(q - self.high[k]) - query.margin).max(Vec4::ZERO)
        };
        let [x, y, z] = [outside(0), outside(1), outside(2)];
        (x * x + y * y + z * z).to_array()
    }
}

/// A point in units of the tree, each coordinate four times.
struct Query {
    place: [Vec4; 3],
    /// A bound on the rounding of the point, of a box and of their difference
    /// along an axis.
    margin: Vec4,
}

/// Mesh units to units of the tree, where the mesh fills [−1, 1].
#[derive(Debug, Clone, Copy)]
pub(crate) struct Frame {
    centre: DVec3,
    scale: f64,
}

impl Frame {
    /// Half of the coordinates themselves.
    pub(crate) const HALF: Self = Self { centre: DVec3::ZERO, scale: 0.5 };

    pub(crate) fn new(mesh: &TriMesh) -> Option<Self> {
        let [lo, hi] = mesh.bounding_box()?.map(DVec3::from);
        let extent = (0.5 * hi - 0.5 * lo).max_element();
        let centre = 0.5 * lo + 0.5 * hi;
        // Coinciding vertices, or so close that the inverse overflows.
        let inverse = 1.0 / extent;
        Some(Self { centre, scale: if inverse.is_finite() { inverse } else { 1.0 } })
    }

    #[inline]
    fn query(self, p: DVec3) -> Query {
        let q = self.to_tree(p);
        let size = q.iter().fold(1.0f32, |s, x| s + x.abs());
        Query { place: q.map(Vec4::splat), margin: Vec4::splat(4.0 * ROUNDOFF * size) }
    }

    /// Rounded to single precision: off by at most [`ROUNDOFF`] × its size.
    #[inline]
    fn to_tree(self, p: DVec3) -> [f32; 3] {
        (self.scale * (p - self.centre)).as_vec3().to_array()
    }
}

/// An entry of the search: the bound of its box, its level and its place.
type Pending = (f32, u32, u32);

impl SurfaceTree {
    /// Builds the tree; F log F for F faces. The boxes of long faces around one vertex overlap
    /// there: those of up to `MAX_FANS` vertices are found by direction.
    ///
    /// # Errors
    ///
    /// [`EvaluationError::NoFaces`].
    pub fn new(mesh: &TriMesh) -> Result<Self, EvaluationError> {
        let frame = match Frame::new(mesh) {
            Some(frame) if mesh.face_count() > 0 => frame,
            _ => return Err(EvaluationError::NoFaces { which: "mesh" }),
        };
        let (mut others, mut hubs) = by_hub(mesh);
        hubs.sort_by_key(|(_, faces)| std::cmp::Reverse(faces.len()));
        others.extend(hubs.drain(hubs.len().min(MAX_FANS)..).flat_map(|(_, faces)| faces));
        let triangle = |f: u32| mesh.triangle(f as usize).map(DVec3::from);
        let mut tree = Self::of(others, triangle, frame);
        for (hub, faces) in hubs {
            let plain = Self::of(faces.clone(), triangle, frame);
            let directions = Self::of(faces, |f| seen(mesh, hub, f), Frame::HALF);
            let around = plain.levels.last().map_or(Quad::EMPTY, |level| level[0].around());
            let first = tree.faces.len();
            tree.triangles.extend(directions.faces.iter().map(|&f| triangle(f)));
            tree.faces.extend(directions.faces);
            tree.fans.push(Fan {
                hub: mesh.positions()[hub as usize].into(),
                slots: first..tree.faces.len(),
                levels: directions.levels,
                around,
            });
        }
        Ok(tree)
    }

    /// The tree of the given faces, which may be none.
    pub(crate) fn of(
        faces: Vec<u32>,
        triangle: impl Fn(u32) -> [DVec3; 3] + Sync,
        frame: Frame,
    ) -> Self {
        let mut order: Vec<(u64, u32)> = faces
            .into_par_iter()
            .with_min_len(4096)
            .map(|f| {
                let [a, b, c] = triangle(f);
                let middle = a * (1.0 / 3.0) + (b + c) * (1.0 / 3.0);
                (hilbert(frame.to_tree(middle)), f)
            })
            .collect();
        order.par_sort_unstable();
        let faces: Vec<u32> = parallel::map(order.len(), 4096, |i| {
            let o = &order[i];
            o.1
        });
        let triangles: Vec<[DVec3; 3]> = parallel::map(faces.len(), 4096, |i| {
            let f = faces[i];
            triangle(f)
        });

        let mut levels: Vec<Vec<Quad>> = vec![
            triangles
                .par_chunks(4)
                .with_min_len(1024)
                .map(|four| {
                    let mut quad = Quad::EMPTY;
                    for (i, triangle) in four.iter().enumerate() {
                        let [a, b, c] = triangle.map(|p| frame.to_tree(p));
                        let low = [0, 1, 2].map(|k| a[k].min(b[k]).min(c[k]));
                        let high = [0, 1, 2].map(|k| a[k].max(b[k]).max(c[k]));
                        quad.set(i, low, high);
                    }
                    quad
                })
                .collect(),
        ];
        while let Some(below) = levels.last().filter(|level| level.len() > 1) {
            let above = below
                .chunks(4)
                .map(|four| {
                    let mut quad = Quad::EMPTY;
                    for (i, child) in four.iter().enumerate() {
                        let low = child.low.map(|v| v.min_element());
                        let high = child.high.map(|v| v.max_element());
                        quad.set(i, low, high);
                    }
                    quad
                })
                .collect();
            levels.push(above);
        }
        Self { levels, triangles, faces, frame, fans: vec![] }
    }

    /// The closest point of the surface.
    #[doc(alias("closest_point", "point_mesh_squared_distance"))]
    pub fn closest(&self, p: [f64; 3]) -> Closest {
        let p = DVec3::from(p);
        let (slot, d2) = self.search(p, 0, &mut vec![]);
        self.answer(p, slot, d2)
    }

    /// The closest points of the surface to many points, in parallel.
    pub fn closest_to_all(&self, points: &[[f64; 3]]) -> Vec<Closest> {
        let mut all = vec![Closest { distance: 0.0, face: 0, point: [0.0; 3] }; points.len()];
        for (i, slot, d2) in self.search_all(points) {
            all[i as usize] = self.answer(points[i as usize].into(), slot, d2);
        }
        all
    }

    /// The distances of many points from the surface, in parallel.
    pub fn distances(&self, points: &[[f64; 3]]) -> Vec<f64> {
        let mut all = vec![0.0; points.len()];
        for (i, _, d2) in self.search_all(points) {
            all[i as usize] = d2.sqrt();
        }
        all
    }

    fn answer(&self, p: DVec3, slot: u32, d2: f64) -> Closest {
        let point = closest_point(p, self.triangles[slot as usize]).to_array();
        Closest { distance: d2.sqrt(), face: self.faces[slot as usize], point }
    }

    /// For each point its number, the closest triangle and the square of its
    /// distance. Points are visited along the curve, so that the answer for
    /// one is a good hint for the next and both need the same parts of the
    /// tree.
    fn search_all(&self, points: &[[f64; 3]]) -> Vec<(u32, u32, f64)> {
        let mut order: Vec<(u64, u32)> = parallel::map(points.len(), 4096, |i| {
            let p = points[i];
            (hilbert(self.frame.to_tree(p.into())), i as u32)
        });
        order.par_sort_unstable();
        order
            .par_chunks(CHUNK)
            .flat_map_iter(|chunk| {
                let (mut slot, mut stack) = (0, vec![]);
                chunk
                    .iter()
                    .map(|&(_, i)| {
                        let d2;
                        let p = points[i as usize].into();
                        (slot, d2) = self.search(p, slot, &mut stack);
                        (i, slot, d2)
                    })
                    .collect::<Vec<_>>()
            })
            .collect()
    }

    /// The number of pairs of faces, one of either tree, for which `counts`
    /// holds, among those whose boxes overlap; each pair is asked once. The trees
    /// have the same frame, and may be the same.
    pub(crate) fn count_overlapping_pairs(
        &self,
        other: &Self,
        counts: impl Fn(u32, u32) -> bool + Sync,
    ) -> usize {
        // Twice the rounding of a coordinate of at most 1.
        let margin = Vec4::splat(2.0 * ROUNDOFF);
        let watch = fairing_watch::current();
        watch.stage("intersections", 0);
        if other.triangles.is_empty() {
            return 0;
        }
        let same = std::ptr::eq(self, other);
        (0..self.triangles.len())
            .into_par_iter()
            .with_min_len(256)
            .map_init(Vec::new, |stack: &mut Vec<(u32, u32)>, slot| {
                watch.check();
                let quad = &self.levels[0][slot / 4];
                let low = quad.low.map(|v| Vec4::splat(v[slot % 4]) - margin);
                let high = quad.high.map(|v| Vec4::splat(v[slot % 4]) + margin);
                let mut count = 0;
                stack.clear();
                stack.push((other.levels.len() as u32 - 1, 0));
                while let Some((level, i)) = stack.pop() {
                    let four = &other.levels[level as usize][i as usize];
                    let apart = (0..3).fold(glam::BVec4A::FALSE, |apart, k| {
                        apart | four.low[k].cmpgt(high[k]) | four.high[k].cmplt(low[k])
                    });
                    for k in (0..4).filter(|&k| !apart.test(k as usize)) {
                        let child = 4 * i + k;
                        // Of one tree later slots only: the pair is asked from its first.
                        if level > 0 {
                            stack.push((level - 1, child));
                        } else if (!same || child as usize > slot)
                            && counts(self.faces[slot], other.faces[child as usize])
                        {
                            count += 1;
                        }
                    }
                }
                count
            })
            .sum()
    }

    /// The closest triangle, beginning with a hint, and the square of its
    /// distance.
    fn search(&self, p: DVec3, hint: u32, stack: &mut Vec<Pending>) -> (u32, f64) {
        let query = self.frame.query(p);
        // The square of the distance in units of the tree, rounded up by more
        // than a bound is rounded.
        let unit = self.frame.scale * self.frame.scale * (1.0 + 1e-6);
        let above = |d2: f64| (d2 * unit) as f32 + f32::MIN_POSITIVE;
        let mut best = (hint, squared_distance(p, self.triangles[hint as usize]));
        let main = 0..self.fans.first().map_or(self.faces.len(), |fan| fan.slots.start);
        self.descend(
            p,
            (&self.levels[..], main),
            &mut best,
            stack,
            |quad| quad.below(&query),
            above,
        );
        for fan in &self.fans {
            if fan.around.below(&query)[0] > above(best.1) {
                continue;
            }
            // None is farther than the hub.
            let first = fan.slots.start;
            let d2 = squared_distance(p, self.triangles[first]);
            if d2 < best.1 {
                best = (first as u32, d2);
            }
            let Some(direction) = (p - fan.hub).try_normalize() else { continue };
            let query = Frame::HALF.query(direction);
            // The sine of the angle between two directions is the distance over that of the hub:
            // for chords c between them sin² = c² − c⁴/4. Beyond a right angle the hub is closest.
            let sines = |quad: &Quad| {
                quad.below(&query).map(|quarter| match 4.0 * quarter {
                    square if square < 2.0 => square - 0.25 * square * square,
                    _ => f32::INFINITY,
                })
            };
            let unit = (1.0 + 1e-6) / fan.hub.distance_squared(p);
            let above = |d2: f64| (d2 * unit) as f32 + f32::MIN_POSITIVE;
            let levels = (&fan.levels[..], fan.slots.clone());
            self.descend(p, levels, &mut best, stack, sines, above);
        }
        best
    }

    /// Looks for a closer triangle in the levels over some slots. `below` gives lower bounds for
    /// four boxes, and `above` the upper one of a squared distance, in the same unit.
    #[inline]
    fn descend(
        &self,
        p: DVec3,
        (levels, slots): (&[Vec<Quad>], Range<usize>),
        best: &mut (u32, f64),
        stack: &mut Vec<Pending>,
        below: impl Fn(&Quad) -> [f32; 4],
        above: impl Fn(f64) -> f32,
    ) {
        if slots.is_empty() {
            return;
        }
        let mut bound = above(best.1);
        stack.clear();
        stack.push((0.0, levels.len() as u32 - 1, 0));
        while let Some((d, level, i)) = stack.pop() {
            if d > bound {
                continue;
            }
            let below = below(&levels[level as usize][i as usize]);
            if level == 0 {
                let first = slots.start + 4 * i as usize;
                let four = &self.triangles[first..(first + 4).min(slots.end)];
                for (k, &triangle) in four.iter().enumerate() {
                    if below[k] <= bound {
                        let d2 = squared_distance(p, triangle);
                        if d2 < best.1 {
                            *best = ((first + k) as u32, d2);
                            bound = above(d2);
                        }
                    }
                }
                continue;
            }
            // The nearest goes onto the stack last.
            let start = stack.len();
            let count = levels[level as usize - 1].len() as u32;
            for k in 0..4 {
                let child = 4 * i + k;
                if below[k as usize] <= bound && child < count {
                    let entry = (below[k as usize], level - 1, child);
                    let place = stack[start..].partition_point(|e| e.0 > entry.0);
                    stack.insert(start + place, entry);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use fairing_shapes as shapes;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    use super::*;

    /// A closed cone with two hubs, one of them a little off the plane of the base.
    fn cone(n: u32) -> TriMesh {
        let rim = |i: u32| {
            let angle = std::f64::consts::TAU * f64::from(i) / f64::from(n);
            [angle.cos(), angle.sin(), 0.0]
        };
        let positions = [[0.1, 0.2, 1.0], [0.0, 0.0, 0.05]].into_iter().chain((0..n).map(rim));
        let next = |i: u32| 2 + (i + 1) % n;
        let faces = (0..n).flat_map(|i| [[0, 2 + i, next(i)], [1, next(i), 2 + i]]);
        TriMesh::new(positions.collect(), faces.collect()).unwrap()
    }

    /// The tree against all faces one by one, exactly: near, far, and on a
    /// mesh far from the origin and very small or large.
    #[test]
    fn nothing_closer_is_missed() {
        let shapes = [
            shapes::bumpy_sphere(3, 0.1, 5.0),
            shapes::cad_block(0.3),
            shapes::plane(7, 5, shapes::Diagonals::Alternating),
            shapes::plane(1, 1, shapes::Diagonals::Regular),
            cone(1500),
        ];
        let mut rng = ChaCha8Rng::seed_from_u64(2);
        for shape in shapes {
            for (size, shift) in [(1.0, 0.0), (1e-12, 0.0), (1e9, 0.0), (1.0, 4.6e6)] {
                let moved = |p: [f64; 3]| p.map(|x| size * x + shift);
                let positions = shape.positions().iter().map(|&p| moved(p)).collect();
                let mesh = shape.with_positions(positions).unwrap();
                let tree = SurfaceTree::new(&mesh).unwrap();
                let points: Vec<[f64; 3]> = (0..300)
                    .map(|i| {
                        let reach = [0.5, 2.0, 100.0][i % 3];
                        moved(std::array::from_fn(|_| rng.random_range(-reach..reach)))
                    })
                    .collect();
                let all = tree.closest_to_all(&points);
                let distances = tree.distances(&points);
                for (i, &p) in points.iter().enumerate() {
                    let least = (0..mesh.face_count())
                        .map(|f| squared_distance(p.into(), mesh.triangle(f).map(DVec3::from)))
                        .fold(f64::INFINITY, f64::min);
                    assert_eq!(all[i].distance, least.sqrt());
                    assert_eq!(distances[i], least.sqrt());
                    assert_eq!(tree.closest(p).distance, least.sqrt());
                    let face = mesh.triangle(all[i].face as usize).map(DVec3::from);
                    assert_eq!(squared_distance(p.into(), face), least);
                    assert_eq!(all[i].point, closest_point(p.into(), face).to_array());
                }
            }
        }
    }

    #[test]
    fn coinciding_vertices() {
        let mesh = TriMesh::new(vec![[3.0; 3]; 3], vec![[0, 1, 2]]).unwrap();
        let tree = SurfaceTree::new(&mesh).unwrap();
        assert_eq!(tree.closest([3.0, 3.0, 5.0]).distance, 2.0);
    }

    #[test]
    fn no_faces() {
        let mesh = TriMesh::new(vec![[0.0; 3]], vec![]).unwrap();
        let error = SurfaceTree::new(&mesh).unwrap_err();
        assert_eq!(error, EvaluationError::NoFaces { which: "mesh" });
    }
}
