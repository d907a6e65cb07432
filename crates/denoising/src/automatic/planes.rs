//! Faces that lie in one plane get one normal.

use fairing_mesh::TriMesh;
use glam::DVec3;
use rayon::prelude::*;

use super::fits::{LocalFit, moments, tangents};
use crate::disjoint::root;
use crate::faces::{Hinges, Marks};

/// Faces whose normals differ by more are not joined: 20°.
const MAX_ANGLE: f64 = 0.35;

/// A plane has at least this many vertices.
const MIN_WEIGHT: f64 = 12.0;

/// The fraction of a region's border with other regions that must be creases.
const MIN_CREASED: f64 = 0.95;

/// The fraction of a region's border with other regions that must be with large ones.
const MIN_LARGE: f64 = 0.5;

/// The fraction of the turn from one plane to the next that one hinge makes.
const MIN_TURN: f64 = 0.25;

/// The same fraction for the component of the turn in the direction from one plane to the next, to
/// which errors of normals do not add; strips are then twice as deep. Telling a shallow crease from
/// a curved surface takes many faces.
const MIN_DIRECTED_TURN: f64 = 0.5;

/// The largest fraction of the variation of normals that may be linear in position.
const TURNING: f64 = 0.7;

/// The rounding error of a mean square of distances, over the square of half the diagonal of a
/// part.
const ROUNDING: f64 = 1e-14;

/// The largest number of faces in the test of a region for curvature.
const MAX_TESTED: usize = 4096;

/// The share of the surface in planes from which the noise is measured.
const LARGE_SHARE: f64 = 0.25;

/// The depth of the strips on both sides of a border that is tested for a crease, in hinges.
const DEPTH: usize = 6;

/// Positions, their weights and their variance: the data from which planes are found.
pub(super) struct Evidence<'a> {
    hinges: &'a Hinges,
    faces: &'a [[u32; 3]],
    /// The noisy positions relative to the middle of their connected part, in mean edge lengths:
    /// distant parts and isolated vertices cost no digits.
    points: Vec<DVec3>,
    /// The weight of the position of each face.
    trust: &'a [f64],
    /// The variance of positions across the surface, weighted by trust, in squared mean edge
    /// lengths.
    variance: f64,
    /// The rounding error of mean squares at each vertex, in squared mean edge lengths.
    rounding: Vec<f64>,
}

impl<'a> Evidence<'a> {
    /// `variance` is in squared mesh units.
    pub(super) fn new(
        mesh: &'a TriMesh,
        hinges: &'a Hinges,
        trust: &'a [f64],
        variance: f64,
    ) -> Self {
        let inverse = 1.0 / mesh.mean_edge_length().max(f64::MIN_POSITIVE);
        let parts = mesh.topology().components();
        let mut boxes = vec![[DVec3::INFINITY, DVec3::NEG_INFINITY]; parts.count()];
        for (p, v) in mesh.positions().iter().zip(0..) {
            if let Some(part) = parts.label(v) {
                let [low, high] = &mut boxes[part as usize];
                let p = DVec3::from(*p);
                (*low, *high) = (low.min(p), high.max(p));
            }
        }
        let (points, rounding) = (mesh.positions().iter().zip(0..))
            .map(|(&p, v)| match parts.label(v) {
                Some(part) => {
                    let [low, high] = boxes[part as usize].map(|x| 0.5 * inverse * x);
                    let half = high - low;
                    (inverse * DVec3::from(p) - (low + high), ROUNDING * half.dot(half))
                }
                None => (DVec3::ZERO, 0.0),
            })
            .unzip();
        let variance = variance * inverse * inverse;
        Self { hinges, faces: mesh.faces(), points, trust, variance, rounding }
    }

    /// The least measurable variance of positions at face `f`.
    fn blur(&self, f: usize) -> f64 {
        self.variance + self.rounding[self.faces[f][0] as usize]
    }

    fn corners(&self, f: usize) -> [DVec3; 3] {
        self.faces[f].map(|v| self.points[v as usize])
    }
}

/// Gives the faces of each plane the normal of a plane fitted to all their noisy vertices.
///
/// Regions grow over hinges in the order of the similarity of normals. Two regions
/// become one if the sum of squared distances from one plane exceeds that from two by less than
/// 3 ln(vertices) variances: the description of both by one plane is shorter (Schwarz's
/// criterion). On a curved surface this gives facets. So a region is a plane only
///
/// - if it ends at creases: where one quadric explains the positions on both sides of a border
///   as well as the two planes do, there is none;
/// - if a quadric does not explain its own positions better than the plane;
/// - if its present normals do not turn steadily from one side to the other.
///
/// The normal of a plane is replaced if that of the fit is known better than the present
/// normals agree with each other.
///
/// Returns the mean square distance of the corners from their planes, in squared mean edge lengths,
/// if a quarter of the surface lies in planes: a level of the noise at all scales.
pub(super) fn flatten(evidence: &Evidence<'_>, normals: &mut [DVec3]) -> Option<f64> {
    let regions = Regions::grow(evidence, normals);
    let planes = regions.planes(evidence, normals);
    for (f, normal) in normals.iter_mut().enumerate() {
        if let Some(plane) = &planes[regions.index[f] as usize] {
            *normal = plane.normal;
        }
    }
    let all: f64 = regions.sums.iter().map(|sums| sums.weight).sum();
    let flat =
        planes.iter().zip(&regions.sums).filter_map(|(plane, sums)| Some((plane.as_ref()?, sums)));
    let (squares, weight) = flat.fold((0.0, 0.0), |(squares, weight), (plane, sums)| {
        (squares + plane.squares, weight + sums.weight)
    });
    (weight > 0.0 && weight >= LARGE_SHARE * all).then(|| squares / weight)
}

/// Sums over the corners of the faces of a region. A corner counts a sixth, so that a vertex
/// inside counts once.
#[derive(Clone, Copy)]
struct Sums {
    weight: f64,
    point: DVec3,
    second: [f64; 6],
    normal: DVec3,
}

impl Sums {
    fn new(evidence: &Evidence<'_>, f: usize, normal: DVec3) -> Self {
        let w = evidence.trust[f] / 6.0;
        let corners = evidence.corners(f);
        let mut sums = Self { weight: 3.0 * w, point: DVec3::ZERO, second: [0.0; 6], normal };
        for p in corners {
            sums.point += w * p;
            let products =
                [p[0] * p[0], p[0] * p[1], p[0] * p[2], p[1] * p[1], p[1] * p[2], p[2] * p[2]];
            sums.second.iter_mut().zip(products).for_each(|(s, p)| *s += w * p);
        }
        sums
    }

    fn plus(&self, other: &Self) -> Self {
        let mut second = self.second;
        second.iter_mut().zip(other.second).for_each(|(s, t)| *s += t);
        Self {
            weight: self.weight + other.weight,
            point: self.point + other.point,
            second,
            normal: self.normal + other.normal,
        }
    }

    fn centre(&self) -> DVec3 {
        self.point * (1.0 / self.weight.max(f64::MIN_POSITIVE))
    }

    /// The root mean square distance of the corners from their centre.
    fn size(&self) -> f64 {
        let [xx, _, _, yy, _, zz] = self.second;
        let centre = self.centre();
        let square = (xx + yy + zz) / self.weight - centre.dot(centre);
        square.max(f64::MIN_POSITIVE).sqrt()
    }

    fn plane(&self) -> Plane {
        let up = self.normal.normalize_or_zero();
        let [x, y] = tangents(up);
        let [xx, xy, xz, yy, yz, zz] = self.second;
        let rows = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]].map(DVec3::from);
        let mean = self.centre();
        // The covariance of two directions, times the weight.
        let covariance = |a: DVec3, b: DVec3| {
            a.dot(rows.map(|r| r.dot(b)).into()) - self.weight * mean.dot(a) * mean.dot(b)
        };
        let (a, b, c) = (covariance(x, x), covariance(x, y), covariance(y, y));
        let (p, q, all) = (covariance(x, up), covariance(y, up), covariance(up, up));
        let ridge = 1e-12 * (a + c) + f64::MIN_POSITIVE;
        let (a, c) = (a.max(0.0) + ridge, c.max(0.0) + ridge);
        let determinant = (a * c - b * b).max(1e-12 * a * c);
        let slopes = [(c * p - b * q) / determinant, (a * q - b * p) / determinant];
        let normal = up - (slopes[0] * x + slopes[1] * y);
        Plane {
            normal: normal.normalize_or_zero(),
            squares: (all - slopes[0] * p - slopes[1] * q).max(0.0),
            spread: (a + c) / determinant,
        }
    }
}

/// The plane through the corners of a region that is closest in squares.
struct Plane {
    normal: DVec3,
    /// The sum of squared distances.
    squares: f64,
    /// The variance of both slopes together, over that of the positions.
    spread: f64,
}

/// The factor of the variance below which more squares are no evidence.
fn doubt(weight: f64) -> f64 {
    3.0 * libm::log(1.0 + weight)
}

/// The fraction of the turn between two planes that happens at the hinges between them.
struct Turn {
    /// The fraction with the errors of normals.
    most: f64,
    /// The fraction in the direction of the whole turn.
    least: f64,
}

struct Regions {
    /// The region of each face.
    index: Vec<u32>,
    sums: Vec<Sums>,
    /// The normal of the plane of each.
    normals: Vec<DVec3>,
    faces: Vec<Vec<u32>>,
}

impl Regions {
    fn grow(evidence: &Evidence<'_>, normals: &[DVec3]) -> Self {
        let count = normals.len();
        let mut sums: Vec<Sums> = (0..count).map(|f| Sums::new(evidence, f, normals[f])).collect();
        let mut squares = vec![0.0f64; count];
        let mut parent: Vec<u32> = (0..count as u32).collect();
        let mut order: Vec<(f64, u32)> = (evidence.hinges.all.iter().zip(0u32..))
            .map(|(hinge, h)| {
                let [f, g] = hinge.faces.map(|f| normals[f as usize]);
                (if f == DVec3::ZERO || g == DVec3::ZERO { 2.0 } else { f.distance(g) }, h)
            })
            .filter(|(apart, _)| *apart < MAX_ANGLE)
            .collect();
        order.par_sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        for (_, h) in order {
            let [a, b] = evidence.hinges.all[h as usize].faces.map(|f| root(&mut parent, f));
            if a == b {
                continue;
            }
            let (i, j) = (a as usize, b as usize);
            let both = sums[i].plus(&sums[j]);
            let together = both.plane().squares;
            let more = together - squares[i] - squares[j];
            if more < doubt(both.weight) * evidence.blur(i) {
                let (low, high) = (a.min(b), a.max(b));
                parent[high as usize] = low;
                sums[low as usize] = both;
                squares[low as usize] = together;
            }
        }
        let mut index = vec![u32::MAX; count];
        let (mut kept, mut faces): (Vec<Sums>, Vec<Vec<u32>>) = (vec![], vec![]);
        for f in 0..count as u32 {
            let r = root(&mut parent, f) as usize;
            // The root of a region is its first face.
            if index[r] == u32::MAX {
                index[r] = kept.len() as u32;
                kept.push(sums[r]);
                faces.push(vec![]);
            }
            index[f as usize] = index[r];
            faces[index[r] as usize].push(f);
        }
        let normals = kept.iter().map(|s| s.plane().normal).collect();
        Self { index, sums: kept, normals, faces }
    }

    /// The plane of each region that is one.
    fn planes(&self, evidence: &Evidence<'_>, normals: &[DVec3]) -> Vec<Option<Plane>> {
        let large = |r: usize| self.sums[r].weight >= MIN_WEIGHT;
        // The hinges between each two large regions.
        let mut pairs: Vec<([u32; 2], u32)> = (evidence.hinges.all.iter().zip(0u32..))
            .map(|(hinge, h)| (hinge.faces.map(|f| self.index[f as usize]), h))
            .filter(|([a, b], _)| a != b)
            .map(|([a, b], h)| ([a.min(b), a.max(b)], h))
            .collect();
        let mut leaving = vec![0.0f64; self.sums.len()];
        for r in pairs.iter().flat_map(|(pair, _)| pair) {
            leaving[*r as usize] += 1.0;
        }
        pairs.retain(|(pair, _)| pair.iter().all(|&r| large(r as usize)));
        pairs.sort_unstable();
        let mut borders = vec![[0.0f64; 2]; self.sums.len()];
        let mut marks = Marks::new(self.index.len());
        for run in pairs.chunk_by(|a, b| a.0 == b.0) {
            let hinges = run.iter().map(|(_, h)| *h);
            let turn = self.turn(evidence, normals, run[0].0, hinges.clone());
            let mut tell = |depth| {
                let strip = self.strip(evidence, run[0].0, hinges.clone(), depth, &mut marks);
                self.is_crease(evidence, &strip)
            };
            let kind = usize::from(
                (turn.most > MIN_TURN && tell(DEPTH))
                    || (turn.least > MIN_DIRECTED_TURN && tell(2 * DEPTH)),
            );
            for r in run[0].0 {
                borders[r as usize][kind] += run.len() as f64;
            }
        }
        (0..self.sums.len())
            .map(|r| {
                let [smooth, creased] = borders[r];
                let known = smooth + creased;
                if !large(r) || creased < MIN_CREASED * known || known < MIN_LARGE * leaving[r] {
                    return None;
                }
                let stride = self.faces[r].len().div_ceil(MAX_TESTED);
                let faces = self.faces[r].iter().copied().step_by(stride);
                let [flat, curved] = squares(evidence, &self.sums[r], faces)?;
                if flat - curved > doubt(self.sums[r].weight) * evidence.variance {
                    return None;
                }
                if self.turning(evidence, normals, r)? > TURNING {
                    return None;
                }
                let plane = self.sums[r].plane();
                let scatter = self.faces[r]
                    .iter()
                    .map(|&f| normals[f as usize].distance(plane.normal).powi(2));
                let scatter = scatter.sum::<f64>() / self.faces[r].len() as f64;
                (plane.spread * evidence.variance < scatter).then_some(plane)
            })
            .collect()
    }

    /// The fraction of the variation of the present normals over a region that is linear in
    /// position: close to one on a curved surface, small where only errors are left.
    fn turning(&self, evidence: &Evidence<'_>, normals: &[DVec3], r: usize) -> Option<f64> {
        let sums = &self.sums[r];
        let axes = tangents(sums.normal.normalize_or_zero());
        let (centre, inverse) = (sums.centre(), 1.0 / sums.size());
        let (mut left, mut all) = (0.0, 0.0);
        for along in axes {
            let mut fit = LocalFit::EMPTY;
            let [mut first, mut second] = [0.0; 2];
            for &f in &self.faces[r] {
                let [a, b, c] = evidence.corners(f as usize);
                let p = inverse * ((a + b + c) * (1.0 / 3.0) - centre);
                let z = normals[f as usize].dot(along);
                fit.add(&moments([p.dot(axes[0]), p.dot(axes[1]), z]), 1.0);
                (first, second) = (first + z, second + z * z);
            }
            left += fit.squares::<3>()?;
            all += second - first * first / self.faces[r].len() as f64;
        }
        Some(1.0 - left / all.max(f64::MIN_POSITIVE))
    }

    /// The faces of two regions up to `depth` hinges from the hinges between them.
    fn strip(
        &self,
        evidence: &Evidence<'_>,
        regions: [u32; 2],
        between: impl Iterator<Item = u32>,
        depth: usize,
        marks: &mut Marks,
    ) -> Vec<u32> {
        marks.clear();
        let faces = between.flat_map(|h| evidence.hinges.all[h as usize].faces);
        let mut strip: Vec<u32> = faces.filter(|&f| marks.insert(f)).collect();
        let mut begin = 0;
        for _ in 0..depth {
            let end = strip.len();
            for i in begin..end {
                for g in evidence.hinges.across(strip[i] as usize) {
                    if regions.contains(&self.index[g]) && marks.insert(g as u32) {
                        strip.push(g as u32);
                    }
                }
            }
            begin = end;
        }
        strip
    }

    /// The fraction of the turn from one region to another that happens at the hinges between them,
    /// rather than step by step on both sides.
    fn turn(
        &self,
        evidence: &Evidence<'_>,
        normals: &[DVec3],
        regions: [u32; 2],
        between: impl Iterator<Item = u32>,
    ) -> Turn {
        let [a, b] = regions.map(|r| self.normals[r as usize]);
        let apart = b - a;
        let (mut sum, mut all, mut count) = (0.0, 0.0, 0.0);
        for h in between {
            let [f, g] = evidence.hinges.all[h as usize].faces;
            let (f, g) = if self.index[f as usize] == regions[0] { (f, g) } else { (g, f) };
            let turn = normals[g as usize] - normals[f as usize];
            (sum, all, count) = (sum + turn.dot(apart), all + turn.length(), count + 1.0);
        }
        let whole = (count * apart.length()).max(f64::MIN_POSITIVE);
        Turn { most: all / whole, least: sum / (apart.length() * whole).max(f64::MIN_POSITIVE) }
    }

    /// Returns `true` if the planes of two regions explain the positions on both sides of their
    /// border better than one quadric.
    fn is_crease(&self, evidence: &Evidence<'_>, strip: &[u32]) -> bool {
        let sums = strip.iter().map(|&f| {
            Sums::new(evidence, f as usize, self.sums[self.index[f as usize] as usize].normal)
        });
        let Some(sums) = sums.reduce(|a, b| a.plus(&b)) else { return false };
        let Some([_, curved]) = squares(evidence, &sums, strip.iter().copied()) else {
            return false;
        };
        let flat: f64 = strip
            .iter()
            .map(|&f| {
                let region = self.index[f as usize] as usize;
                let (n, centre) = (self.normals[region], self.sums[region].centre());
                let corners = evidence.corners(f as usize);
                let sum: f64 = corners.iter().map(|&p| n.dot(p - centre).powi(2)).sum();
                evidence.trust[f as usize] / 6.0 * sum
            })
            .sum();
        curved - flat > doubt(sums.weight) * evidence.variance
    }
}

/// The sums of squared distances of the corners of faces from one plane and from one quadric.
fn squares(
    evidence: &Evidence<'_>,
    sums: &Sums,
    faces: impl Iterator<Item = u32>,
) -> Option<[f64; 2]> {
    let up = sums.normal.normalize_or_zero();
    let [x, y] = tangents(up);
    let centre = sums.centre();
    let inverse = 1.0 / sums.size();
    let mut fit = LocalFit::EMPTY;
    for f in faces {
        let w = evidence.trust[f as usize] / 6.0;
        for p in evidence.corners(f as usize) {
            let p = inverse * (p - centre);
            fit.add(&moments([x, y, up].map(|axis| p.dot(axis))), w);
        }
    }
    let unit = 1.0 / (inverse * inverse);
    Some([fit.squares::<3>()? * unit, fit.squares::<6>()? * unit])
}

#[cfg(test)]
mod tests {
    use fairing_shapes as shapes;

    use super::*;
    use crate::faces::FaceShapes;

    /// The normals of a noisy mesh, averaged over rings, after [`flatten`]; also those before.
    fn flattened(truth: &TriMesh, sigma: f64) -> [Vec<DVec3>; 2] {
        let noisy = shapes::jittered(truth, sigma, 5, |p| p);
        let hinges = Hinges::new(&noisy);
        let rings = crate::faces::FaceLists::rings(&noisy);
        let raw = FaceShapes::new(&noisy);
        let mut before = raw.normals.clone();
        for _ in 0..3 {
            before = (0..before.len())
                .map(|f| {
                    let near = rings.row(f).iter().map(|&g| before[g as usize]);
                    let alike = near.filter(|n| n.distance(before[f]) < 0.8);
                    alike.fold(before[f], |sum, n| sum + n).normalize_or_zero()
                })
                .collect();
        }
        let mut after = before.clone();
        let moved = truth.positions().iter().zip(noisy.positions());
        let squares: f64 = moved.map(|(&a, &b)| DVec3::from(a).distance_squared(b.into())).sum();
        let variance = squares / (3.0 * truth.vertex_count() as f64);
        let trust = vec![1.0; before.len()];
        let evidence = Evidence::new(&noisy, &hinges, &trust, variance);
        flatten(&evidence, &mut after);
        [before, after]
    }

    /// The mean distance from the normals of the true faces.
    fn error(truth: &TriMesh, normals: &[DVec3]) -> f64 {
        let wanted = FaceShapes::new(truth).normals;
        let sum: f64 = wanted.iter().zip(normals).map(|(&a, &b)| a.distance(b)).sum();
        sum / wanted.len() as f64
    }

    /// The sides of a cube come out flat; of normals inside of a side hardly an error is left.
    #[test]
    fn sides_of_a_cube_are_planes() {
        let truth = shapes::cube(20, shapes::Diagonals::Alternating);
        let [before, after] = flattened(&truth, 0.1);
        let (first, last) = (error(&truth, &before), error(&truth, &after));
        assert!(last < 0.3 * first, "{first} {last}");
    }

    /// A vertex without faces, far away, changes nothing.
    #[test]
    fn an_isolated_vertex_costs_no_digits() {
        let truth = shapes::cube(10, shapes::Diagonals::Alternating);
        let with = |far: f64| {
            let mut positions = truth.positions().to_vec();
            positions.push([far; 3]);
            TriMesh::new(positions, truth.faces().to_vec()).unwrap()
        };
        let [near, far] = [1.0, 1e9].map(|far| flattened(&with(far), 0.1));
        assert!(near == far);
    }

    /// A roof of two planes that meet at 6° is distinguished from a curved surface, under noise of
    /// a quarter of the heights of faces.
    #[test]
    fn shallow_creases_are_found_from_afar() {
        let flat = shapes::plane(40, 40, shapes::Diagonals::Alternating);
        let middle = 0.5 * flat.positions().iter().fold(0.0, |most: f64, p| most.max(p[0]));
        let tilt = libm::tan(3.0f64.to_radians());
        let roof = flat.positions().iter().map(|&[x, y, _]| [x, y, -tilt * (x - middle).abs()]);
        let truth = flat.with_positions(roof.collect()).unwrap();
        let noisy = shapes::jittered(&truth, 0.25, 5, |p| p);
        let errors = shapes::jittered(&truth, 0.03, 7, |p| p);
        let (wanted, mut normals) =
            (FaceShapes::new(&truth).normals, FaceShapes::new(&errors).normals);
        let far = |normals: &[DVec3]| -> f64 {
            wanted.iter().zip(normals).map(|(&a, &b)| a.distance(b)).sum()
        };
        let first = far(&normals);
        let moved = truth.positions().iter().zip(noisy.positions());
        let squares: f64 = moved.map(|(&a, &b)| DVec3::from(a).distance_squared(b.into())).sum();
        let variance = squares / (3.0 * truth.vertex_count() as f64);
        let trust = vec![1.0; normals.len()];
        flatten(&Evidence::new(&noisy, &Hinges::new(&noisy), &trust, variance), &mut normals);
        let last = far(&normals);
        assert!(last < 0.3 * first, "{first} {last}");
    }

    /// A sphere and a torus have no planes: at any noise few normals change, and the errors do not
    /// grow.
    #[test]
    fn curved_surfaces_have_no_planes() {
        for truth in [shapes::icosphere(4), shapes::torus(1.0, 0.4, 80, 40)] {
            for sigma in [0.02, 0.1, 0.3] {
                let [before, after] = flattened(&truth, sigma);
                let changed = before.iter().zip(&after).filter(|(a, b)| a != b).count();
                assert!(changed * 20 <= before.len(), "{sigma}: {changed} of {}", before.len());
                let [first, last] = [before, after].map(|normals| error(&truth, &normals));
                assert!(last <= 1.01 * first, "{sigma}: {first} {last}");
            }
        }
    }
}
