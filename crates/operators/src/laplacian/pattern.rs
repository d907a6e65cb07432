//! Cotangents and areas on a fixed pattern.
//!
//! Flows that rebuild their operator in each step change positions, never faces, so the places of
//! the entries of a row, and the corners that add to them, stay the same. A step then costs one
//! pass over the faces and one over the corners, a tenth of the cost of finding the pattern.

use std::sync::atomic::{AtomicBool, Ordering};

use fairing_mesh::TriMesh;
use fairing_sparse::{GraphLaplacian, GraphNumbers};
use fairing_watch::parallel;
use glam::DVec3;

use super::mass::{give_isolated, positive_lumped_mass};
use crate::corners::{FaceCorners, degenerate};
use crate::error::OperatorError;
use crate::kind::LumpedArea;

/// The number of corners above which a row finds its columns by bisection.
const MANY_CORNERS: usize = 64;

/// Rows or faces per task.
const ROWS: usize = 4096;

/// The excess of two sides of a widened face over the third, as a fraction of
/// the longest; robust operators use the same fraction of the mean edge length.
const SLACK: f64 = 1e-5;

/// The mass of a vertex whose faces are all points, as a fraction of the mean
/// mass: it moves with its neighbours.
const MIN_MASS: f64 = 1e-12;

/// The treatment of faces that are too thin for their cotangents in a
/// [`CotangentPattern`] ([`MIN_HEIGHT_RATIO`](crate::MIN_HEIGHT_RATIO)).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum ThinFaces {
    /// Return an error.
    Refuse,
    /// Compute their cotangents and areas from longer sides: each is lengthened
    /// by 10⁻⁵ of the longest, or by less if that suffices for any two to exceed
    /// the third by this amount.
    Widen,
    /// The same for all faces with two sides that do not exceed the third by
    /// this amount.
    WidenNearly,
}

/// Half the cotangents of the corners of a face, and a third of its area.
type FaceTerms = [f64; 4];

/// The pattern of the cotangent weights of a mesh, without the diagonal, to be
/// filled at any positions of the same faces.
///
/// The weights are those of [`cotan_stiffness`](crate::cotan_stiffness) with
/// the other sign, `½ (cot α + cot β)`, the masses positive as by
/// [`Laplacian::positive_mass`](super::Laplacian::positive_mass). Columns of a
/// row come in the order in which its faces name them.
#[derive(Debug, Clone)]
pub struct CotangentPattern {
    area: LumpedArea,
    offsets: Vec<u32>,
    columns: Vec<u32>,
    /// For each corner in the order of the incidence, the places within the row of
    /// the next and of the previous corner of its face; none for fixed vertices.
    places: Vec<[u32; 2]>,
    /// Terms of the last assembly; the next one reuses their memory.
    terms: Vec<FaceTerms>,
}

/// A chunk of rows.
struct Rows {
    lengths: Vec<u32>,
    columns: Vec<u32>,
    places: Vec<[u32; 2]>,
}

impl CotangentPattern {
    /// Finds the pattern, for masses of the given areas. Vertices for which `fixed` is true have
    /// empty rows.
    ///
    /// # Errors
    ///
    /// [`OperatorError::Length`] if the number of flags is not that of the vertices.
    pub fn new(mesh: &TriMesh, area: LumpedArea, fixed: &[bool]) -> Result<Self, OperatorError> {
        let (found, expected) = (fixed.len(), mesh.vertex_count());
        if found != expected {
            return Err(OperatorError::Length { found, expected });
        }
        let n = mesh.vertex_count();
        // Computed here, not by whichever thread comes first.
        mesh.incidence();
        let chunks: Vec<Rows> = parallel::map(n.div_ceil(ROWS), 1, |c| rows(mesh, c * ROWS, fixed));
        let mut offsets = Vec::with_capacity(n + 1);
        let mut columns = Vec::with_capacity(chunks.iter().map(|c| c.columns.len()).sum());
        let mut places = Vec::with_capacity(3 * mesh.face_count());
        let mut end = 0;
        offsets.push(0);
        for chunk in chunks {
            columns.extend_from_slice(&chunk.columns);
            places.extend_from_slice(&chunk.places);
            offsets.extend(chunk.lengths.iter().map(|length| {
                end += length;
                end
            }));
        }
        Ok(Self { area, offsets, columns, places, terms: Vec::new() })
    }

    /// A Laplacian on the pattern, all of whose numbers are zero until they
    /// are [filled](Self::fill) in. The rows of fixed vertices are empty.
    pub fn laplacian(&self) -> GraphLaplacian {
        GraphLaplacian::on_pattern(self.offsets.clone(), self.columns.clone())
    }

    /// Overwrites all numbers of a Laplacian [on this pattern](Self::laplacian)
    /// by those at the positions of `mesh`, which has the faces that the
    /// pattern was made of. Returns the faces that were widened, ascending.
    ///
    /// # Errors
    ///
    /// [`OperatorError::DegenerateFace`] for the first face that is too thin,
    /// if such faces are refused; [`OperatorError::Mass`] for the first vertex
    /// with faces whose mass is not positive;
    /// [`OperatorError::Connectivity`] for a mesh of another number of vertices
    /// or faces; [`OperatorError::Length`] for a Laplacian on another pattern.
    /// After an error the numbers are unspecified.
    pub fn fill(
        &mut self,
        mesh: &TriMesh,
        thin: ThinFaces,
        laplacian: &mut GraphLaplacian,
    ) -> Result<Vec<u32>, OperatorError> {
        laplacian.fill(|numbers| self.fill_numbers(mesh, thin, numbers))
    }

    fn fill_numbers(
        &mut self,
        mesh: &TriMesh,
        thin: ThinFaces,
        numbers: GraphNumbers<'_>,
    ) -> Result<Vec<u32>, OperatorError> {
        let GraphNumbers { weights, diagonal, mass, .. } = numbers;
        let n = self.offsets.len() - 1;
        if mesh.vertex_count() != n || 3 * mesh.face_count() != self.places.len() {
            return Err(OperatorError::Connectivity { vertex: 0 });
        }
        for (found, expected) in
            [(weights.len(), self.columns.len()), (diagonal.len(), n), (mass.len(), n)]
        {
            if found != expected {
                return Err(OperatorError::Length { found, expected });
            }
        }
        let faces = face_terms(mesh, thin, &mut self.terms)?;
        match self.area {
            LumpedArea::Barycentric => self.fill_areas(mesh, &faces, mass)?,
            area => mass.copy_from_slice(&positive_lumped_mass(mesh, area)?),
        }
        self.fill_rows(mesh, weights, diagonal);
        Ok(faces)
    }

    /// A third of the faces around each vertex.
    fn fill_areas(
        &self,
        mesh: &TriMesh,
        widened: &[u32],
        mass: &mut [f64],
    ) -> Result<(), OperatorError> {
        let (ends, corners) = (mesh.incidence().offsets(), mesh.incidence().all_corners());
        parallel::for_chunks(mass, ROWS, |start, mass| {
            for (v, mass) in (start..).zip(mass) {
                let around = &corners[ends[v] as usize..ends[v + 1] as usize];
                *mass = around.iter().map(|&c| self.terms[c as usize / 3][3]).sum();
            }
        });
        if !widened.is_empty() {
            raise(mesh, widened, mass);
        }
        if mass.iter().all(|&m| m > 0.0) { Ok(()) } else { give_isolated(mesh, mass) }
    }

    fn fill_rows(&self, mesh: &TriMesh, weights: &mut [f64], diagonal: &mut [f64]) {
        let (ends, all_corners) = (mesh.incidence().offsets(), mesh.incidence().all_corners());
        let rows = self.by_chunk(weights);
        parallel::for_each(
            rows.into_iter().zip(diagonal.chunks_mut(ROWS)).enumerate(),
            |(chunk, (weights, diagonal))| {
                let first = self.offsets[chunk * ROWS];
                for (k, diagonal) in diagonal.iter_mut().enumerate() {
                    let v = chunk * ROWS + k;
                    let range = self.offsets[v] - first..self.offsets[v + 1] - first;
                    let row = &mut weights[range.start as usize..range.end as usize];
                    row.fill(0.0);
                    let mut sum = 0.0;
                    for c in ends[v] as usize..ends[v + 1] as usize {
                        let corner = all_corners[c] as usize;
                        let (half, own) = (&self.terms[corner / 3], corner % 3);
                        // The edge to the next corner lies opposite the previous one.
                        let (next, previous) = (half[(own + 2) % 3], half[(own + 1) % 3]);
                        sum += next + previous;
                        if !row.is_empty() {
                            let [n, p] = self.places[c];
                            row[n as usize] += next;
                            row[p as usize] += previous;
                        }
                    }
                    *diagonal = sum;
                }
            },
        );
    }

    /// Cuts the entries at the borders of chunks of rows.
    fn by_chunk<'a>(&self, mut entries: &'a mut [f64]) -> Vec<&'a mut [f64]> {
        let n = self.offsets.len() - 1;
        (0..n.div_ceil(ROWS))
            .map(|chunk| {
                let end = n.min((chunk + 1) * ROWS);
                let length = (self.offsets[end] - self.offsets[chunk * ROWS]) as usize;
                let (rows, rest) = std::mem::take(&mut entries).split_at_mut(length);
                entries = rest;
                rows
            })
            .collect()
    }
}

/// The rows from `first` on, as many as a chunk has.
fn rows(mesh: &TriMesh, first: usize, fixed: &[bool]) -> Rows {
    let (faces, incidence) = (mesh.faces().as_flattened(), mesh.incidence());
    let end = mesh.vertex_count().min(first + ROWS);
    let mut rows = Rows {
        lengths: Vec::with_capacity(end - first),
        columns: Vec::with_capacity(7 * (end - first)),
        places: Vec::with_capacity(6 * (end - first)),
    };
    for v in first..end {
        let corners = incidence.corners(v as u32);
        let begin = rows.columns.len();
        let ends = corners.iter().map(|&c| {
            let (face, own) = (c - c % 3, c % 3);
            [(own + 1) % 3, (own + 2) % 3].map(|k| faces[(face + k) as usize])
        });
        if fixed[v] {
            rows.places.extend(corners.iter().map(|_| [0; 2]));
        } else if corners.len() > MANY_CORNERS {
            let mut all: Vec<u32> = ends.clone().flatten().collect();
            all.sort_unstable();
            all.dedup();
            // Every end is among them.
            rows.places.extend(ends.map(|e| e.map(|j| all.partition_point(|&i| i < j) as u32)));
            rows.columns.extend(all);
        } else {
            for pair in ends {
                let place =
                    pair.map(|j| match rows.columns[begin..].iter().position(|&i| i == j) {
                        Some(place) => place as u32,
                        None => {
                            rows.columns.push(j);
                            (rows.columns.len() - 1 - begin) as u32
                        }
                    });
                rows.places.push(place);
            }
        }
        rows.lengths.push((rows.columns.len() - begin) as u32);
    }
    rows
}

/// Half the cotangents and a third of the area of every face. Returns the faces that are widened.
fn face_terms(
    mesh: &TriMesh,
    faces: ThinFaces,
    terms: &mut Vec<FaceTerms>,
) -> Result<Vec<u32>, OperatorError> {
    let x = mesh.positions();
    let thin = AtomicBool::new(false);
    let of_face = |face: &[u32; 3]| {
        let corners = FaceCorners::new(face.map(|v| x[v as usize]));
        if corners.is_degenerate() {
            thin.store(true, Ordering::Relaxed);
        }
        let ([a, b, c], third) = (corners.half_cotangents(), corners.third());
        [a, b, c, third]
    };
    terms.resize(mesh.face_count(), [0.0; 4]);
    parallel::for_rows(terms, |f, terms| *terms = of_face(&mesh.faces()[f]));
    let mut widened = Vec::new();
    if faces != ThinFaces::WidenNearly && !thin.into_inner() {
        return Ok(widened);
    }
    for (f, terms) in terms.iter_mut().enumerate() {
        let triangle = mesh.triangle(f);
        let corners = FaceCorners::new(triangle);
        let [a, b, c] = triangle.map(DVec3::from);
        let lengths = [(c - b).length(), (a - c).length(), (b - a).length()];
        let thin = match faces {
            ThinFaces::WidenNearly => lacking(lengths) > 0.0,
            _ => corners.is_degenerate(),
        };
        if thin && faces == ThinFaces::Refuse {
            return Err(degenerate(f, &corners));
        }
        if thin {
            *terms = widen(lengths);
            widened.push(f as u32);
        }
    }
    Ok(widened)
}

/// The length that every side lacks for two to exceed the third by [`SLACK`] of the longest.
fn lacking([a, b, c]: [f64; 3]) -> f64 {
    let slack = SLACK * a.max(b).max(c);
    (slack - (a + b - c).min(b + c - a).min(c + a - b)).max(0.0)
}

/// The terms of the triangle whose sides are lengthened by what they lack; for a
/// point, those of an equilateral triangle without area. Side k lies opposite
/// corner k.
fn widen(sides: [f64; 3]) -> FaceTerms {
    let [a, b, c] = sides.map(|side| side + lacking(sides));
    let longest = a.max(b).max(c);
    if longest == 0.0 || !longest.is_finite() {
        let half = 0.5 / 3.0f64.sqrt();
        return [half, half, half, 0.0];
    }
    // In units of the longest side, so that no square underflows.
    let [a, b, c] = [a, b, c].map(|side| side / longest);
    let product = (a + b + c) * (b + c - a) * (c + a - b) * (a + b - c);
    let area = 0.25 * product.max(0.0).sqrt();
    let half = |own: f64, p: f64, q: f64| (p * p + q * q - own * own) / (8.0 * area);
    [half(a, b, c), half(b, c, a), half(c, a, b), area * longest * longest / 3.0]
}

/// Raises the masses of the corners of widened faces to [`MIN_MASS`] of the mean.
fn raise(mesh: &TriMesh, faces: &[u32], mass: &mut [f64]) {
    let least = MIN_MASS * mass.iter().sum::<f64>() / mass.len() as f64;
    for &v in faces.iter().flat_map(|&f| &mesh.faces()[f as usize]) {
        let m = &mut mass[v as usize];
        *m = m.max(least);
    }
}

#[cfg(test)]
mod tests {
    use fairing_shapes as shapes;

    use super::*;
    use crate::cotan_stiffness;

    /// A vertex whose faces are all points moves with its neighbours: its mass is a
    /// trillionth of the mean.
    #[test]
    fn masses_of_points_are_raised_to_the_least() {
        let mesh = shapes::icosphere(0);
        let mut mass = vec![1.0; 12];
        let [a, b, _] = mesh.faces()[0];
        mass[a as usize] = 0.0;
        raise(&mesh, &[0], &mut mass);
        assert_eq!(mass[a as usize], 1e-12 * 11.0 / 12.0);
        assert_eq!(mass[b as usize], 1.0);
    }

    /// Rows are those of `cotan_stiffness`: on a closed mesh of several chunks, with a
    /// border, three faces at an edge, a fan around a hub, and an isolated vertex.
    #[test]
    fn a_pattern_gives_the_cotangent_operator() {
        let hub: Vec<[f64; 3]> = (0..200)
            .map(|i| {
                let angle = f64::from(i) * std::f64::consts::TAU / 200.0;
                [angle.cos(), angle.sin(), 0.1 * (3.0 * angle).sin()]
            })
            .chain([[0.0, 0.0, 0.5], [9.0, 9.0, 9.0]])
            .collect();
        let fan = (0..200).map(|i| [200, i, (i + 1) % 200]).collect();
        let pages =
            vec![[0.0; 3], [0.0, 0.0, 1.0], [1.0, 0.0, 0.3], [-1.0, 0.4, 0.6], [0.2, 1.0, 0.5]];
        let meshes = [
            shapes::bumpy_sphere(5, 0.2, 5.0),
            shapes::plane(9, 7, shapes::Diagonals::Alternating),
            TriMesh::new(pages, vec![[0, 1, 2], [0, 1, 3], [1, 0, 4]]).unwrap(),
            TriMesh::new(hub, fan).unwrap(),
        ];
        for mesh in &meshes {
            let n = mesh.vertex_count();
            let fixed: Vec<bool> = (0..n).map(|v| v % 7 == 3).collect();
            for area in [LumpedArea::Barycentric, LumpedArea::Mixed] {
                let mut pattern = CotangentPattern::new(mesh, area, &fixed).unwrap();
                let stiffness = cotan_stiffness(mesh).unwrap();
                let expected = positive_lumped_mass(mesh, area).unwrap();
                // Filled twice: nothing is left of the first time.
                let mut filled = pattern.laplacian();
                for thin in [ThinFaces::Refuse, ThinFaces::Widen] {
                    assert!(pattern.fill(mesh, thin, &mut filled).unwrap().is_empty());
                }
                for v in 0..n {
                    // A sum of some ten terms, in another order.
                    let size = 1e-13 * stiffness.get(v, v).unwrap().max(1.0);
                    let entries = if fixed[v] { 1 } else { stiffness.outer_view(v).unwrap().nnz() };
                    assert_eq!(filled.neighbors(v).len() + 1, entries);
                    for (j, found) in filled.stiffness_row(v) {
                        let s = stiffness.get(v, j as usize).unwrap();
                        assert!((found - s).abs() < size, "{area:?}, vertex {v}");
                    }
                    let own = stiffness.get(v, v).unwrap();
                    assert!((filled.diagonal()[v] - own).abs() < size);
                    assert!((filled.mass()[v] / expected[v] - 1.0).abs() < 1e-13);
                }
            }
        }
    }

    #[test]
    fn a_thin_face_is_the_error_of_the_operator() {
        let line = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [2.0, 0.0, 0.0]];
        let mesh = TriMesh::new(line, vec![[0, 1, 2], [0, 1, 3]]).unwrap();
        let mut pattern =
            CotangentPattern::new(&mesh, LumpedArea::Barycentric, &[false; 4]).unwrap();
        let mut fill = |thin| {
            let mut laplacian = pattern.laplacian();
            pattern.fill(&mesh, thin, &mut laplacian)
        };
        assert_eq!(fill(ThinFaces::Refuse), Err(cotan_stiffness(&mesh).unwrap_err()));
        assert_eq!(fill(ThinFaces::Widen), Ok(vec![1]));
    }

    /// A needle, a cap and a point become triangles of bounded cotangents and positive
    /// area; a good face is left alone.
    #[test]
    fn degenerate_faces_have_terms() {
        for sides in [[1.0, 1.0, 1e-14], [1.0, 0.5, 0.5], [3.0, 4.0, 7.0], [2e-200, 1e-200, 1e-200]]
        {
            let [a, b, c, third] = widen(sides);
            let longest = sides.iter().copied().fold(0.0, f64::max);
            // The height of a cap with this slack is √(slack/2) of its base, the base of a
            // needle the slack.
            assert!([a, b, c].iter().all(|x| x.abs() < 1.0 / SLACK), "{sides:?}: {a} {b} {c}");
            assert!(third > 1e-7 * longest * longest || longest < 1e-100, "{sides:?}: {third}");
            // cot A cot B + cot B cot C + cot C cot A = 1.
            let sum = 4.0 * (a * b + b * c + c * a);
            assert!((sum - 1.0).abs() < 1e-4, "{sides:?}: {sum}");
        }
        // Lengthened by a hundred-thousandth and no more:
        // 16 area² = (a+b+c)(b+c−a)(c+a−b)(a+b−c).
        let [.., third] = widen([1.0, 0.5, 0.5]);
        let expected = (2.0f64 * 1e-5).sqrt() / 4.0 / 3.0;
        assert!((third / expected - 1.0).abs() < 1e-3, "{third} {expected}");
        let [half, _, _, area] = widen([0.0; 3]);
        assert!((half - 0.5 / 3f64.sqrt()).abs() < 1e-15 && area == 0.0);
        let [a, b, c, third] = widen([3.0, 4.0, 5.0]);
        let expected = [0.5 * 4.0 / 3.0, 0.5 * 0.75, 0.0, 2.0];
        for (x, y) in [a, b, c, third].into_iter().zip(expected) {
            assert!((x - y).abs() < 1e-14, "{x} is not {y}");
        }
    }
}
