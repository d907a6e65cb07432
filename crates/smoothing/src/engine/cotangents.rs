//! Cotangent weights on a pattern that is found once.
//!
//! Flows that take their operator anew in each step change positions, never faces: where the entries of a row are,
//! and which corner adds to which of them, stays the same. A step then costs one pass over the faces and one over
//! the corners, a tenth of finding the pattern again.

use std::sync::atomic::{AtomicBool, Ordering};

use fairing_mesh::TriMesh;
use fairing_mesh::vec3::{cross, dot, norm, sub};
use fairing_operators::{LumpedArea, MIN_HEIGHT_RATIO, cotan_stiffness};
use rayon::prelude::*;

use crate::engine::assemble::positive_mass;
use crate::engine::error::FlowFailure;
use crate::engine::laplacian::{Laplacian, ROWS};

/// Rows with more corners look for their columns by bisection.
const MANY_CORNERS: usize = 64;

/// Where the corners of a mesh add to the rows of their vertices.
pub(crate) struct Cotangents {
    area: LumpedArea,
    offsets: Vec<u32>,
    columns: Vec<u32>,
    /// For each corner in the order of the incidence, the places within the row of the next and of the previous
    /// corner of its face; none for held vertices.
    places: Vec<[u32; 2]>,
    held: Vec<bool>,
    /// Those of the last assembly, whose memory the next one uses.
    terms: Vec<FaceTerms>,
}

/// Half the cotangents of the corners of a face, and a third of its area.
type FaceTerms = [f64; 4];

/// Which faces are taken as degenerate: their terms are those of a triangle of sides longer than theirs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Degenerate {
    /// None: a face too thin for cotangents is an error.
    Refused,
    /// Those too thin for cotangents.
    Thin,
    /// Those of which two sides are longer than the third by less than [`SLACK`] of the longest.
    Slack,
}

/// How much longer than the third side two sides of a degenerate face are made, as a share of the longest; the same
/// as robust operators take of the mean edge length.
const SLACK: f64 = 1e-5;

/// The mass of a vertex whose faces are all points, as a share of the mean mass: it moves with its neighbours.
const LEAST_MASS: f64 = 1e-12;

/// A chunk of rows.
struct Rows {
    lengths: Vec<u32>,
    columns: Vec<u32>,
    places: Vec<[u32; 2]>,
}

impl Cotangents {
    /// Finds the pattern. Vertices for which `held` is true have empty rows.
    pub(crate) fn of(mesh: &TriMesh, area: LumpedArea, held: &[bool]) -> Self {
        let n = mesh.vertex_count();
        // Computed here, not by whichever thread comes first.
        mesh.incidence();
        let chunks: Vec<Rows> =
            (0..n.div_ceil(ROWS)).into_par_iter().map(|c| rows(mesh, c * ROWS, held)).collect();
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
        Self { area, offsets, columns, places, held: held.to_vec(), terms: Vec::new() }
    }

    /// The Laplacian at the positions of `mesh`, whose faces are those of the pattern.
    pub(crate) fn assemble(&mut self, mesh: &TriMesh) -> Result<Laplacian, FlowFailure> {
        let mut laplacian = Laplacian::empty(self.offsets.clone(), self.columns.clone());
        self.assemble_into(mesh, &mut laplacian, Degenerate::Refused)?;
        Ok(laplacian)
    }

    /// Replaces the numbers of a Laplacian on this pattern. Returns the faces that are taken as degenerate.
    pub(crate) fn assemble_into(
        &mut self,
        mesh: &TriMesh,
        laplacian: &mut Laplacian,
        degenerate: Degenerate,
    ) -> Result<Vec<u32>, FlowFailure> {
        let faces = face_terms(mesh, degenerate, &mut self.terms)?;
        let (incidence, terms) = (mesh.incidence(), &self.terms[..]);
        let (ends, all_corners) = (incidence.offsets(), incidence.all_corners());
        let corners = |v: usize| ends[v] as usize..ends[v + 1] as usize;
        let numbers = laplacian.numbers_mut();
        match self.area {
            LumpedArea::Barycentric => {
                numbers.mass.par_chunks_mut(ROWS).enumerate().for_each(|(chunk, mass)| {
                    for (k, mass) in mass.iter_mut().enumerate() {
                        let around = &all_corners[corners(chunk * ROWS + k)];
                        *mass = around.iter().map(|&c| terms[c as usize / 3][3]).sum();
                        if around.is_empty() {
                            *mass = 1.0;
                        }
                    }
                });
                if !faces.is_empty() {
                    raise(mesh, &faces, numbers.mass);
                }
                if let Some(v) = numbers.mass.iter().position(|m| *m <= 0.0 || m.is_nan()) {
                    return Err(FlowFailure::NonPositiveMass {
                        vertex: v as u32,
                        mass: numbers.mass[v],
                    });
                }
            }
            area => numbers.mass.copy_from_slice(&positive_mass(mesh, area)?),
        }
        let mass = &*numbers.mass;
        let rows = self.by_chunk(numbers.weights);
        rows.into_par_iter().zip(numbers.diagonal.par_chunks_mut(ROWS)).enumerate().for_each(
            |(chunk, (weights, diagonal))| {
                let first = self.offsets[chunk * ROWS];
                for (k, diagonal) in diagonal.iter_mut().enumerate() {
                    let v = chunk * ROWS + k;
                    let range = self.offsets[v] - first..self.offsets[v + 1] - first;
                    let row = &mut weights[range.start as usize..range.end as usize];
                    row.fill(0.0);
                    let mut sum = 0.0;
                    for c in corners(v) {
                        let corner = all_corners[c] as usize;
                        let (half, own) = (&terms[corner / 3], corner % 3);
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
                    for w in row {
                        *w /= mass[v];
                    }
                }
            },
        );
        Ok(faces)
    }

    /// Cuts the entries at the borders of chunks of rows.
    fn by_chunk<'a>(&self, mut entries: &'a mut [f64]) -> Vec<&'a mut [f64]> {
        let n = self.held.len();
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
fn rows(mesh: &TriMesh, first: usize, held: &[bool]) -> Rows {
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
        if held[v] {
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

/// Half the cotangents and a third of the area of every face, and the faces that are taken as degenerate.
fn face_terms(
    mesh: &TriMesh,
    degenerate: Degenerate,
    terms: &mut Vec<FaceTerms>,
) -> Result<Vec<u32>, FlowFailure> {
    let x = mesh.positions();
    let thin = AtomicBool::new(false);
    mesh.faces()
        .par_iter()
        .with_min_len(ROWS)
        .map(|face| {
            let [a, b, c] = face.map(|v| x[v as usize]);
            let (ab, bc, ca) = (sub(b, a), sub(c, b), sub(a, c));
            let twice_area = norm(cross(ab, ca));
            let longest = dot(ab, ab).max(dot(bc, bc)).max(dot(ca, ca));
            if is_thin(twice_area, longest) {
                thin.store(true, Ordering::Relaxed);
            }
            let s = -0.5 / twice_area;
            [s * dot(ab, ca), s * dot(bc, ab), s * dot(ca, bc), 0.5 * twice_area / 3.0]
        })
        .collect_into_vec(terms);
    let thin = thin.into_inner();
    let mut faces = Vec::new();
    match degenerate {
        Degenerate::Refused if thin => {
            // The operators say which face, and hold the same measure.
            cotan_stiffness(mesh)?;
        }
        Degenerate::Refused => {}
        Degenerate::Thin if !thin => {}
        Degenerate::Thin | Degenerate::Slack => {
            for (f, (face, terms)) in mesh.faces().iter().zip(terms).enumerate() {
                let [a, b, c] = face.map(|v| x[v as usize]);
                let sides = [sub(c, b), sub(a, c), sub(b, a)];
                let longest = sides.iter().map(|&s| dot(s, s)).fold(0.0, f64::max);
                let lengths = sides.map(norm);
                let wanted = match degenerate {
                    Degenerate::Slack => lacking(lengths) > 0.0,
                    _ => is_thin(norm(cross(sides[0], sides[1])), longest),
                };
                if wanted {
                    *terms = mollified(lengths);
                    faces.push(f as u32);
                }
            }
        }
    }
    Ok(faces)
}

/// Whether a face is too thin for cotangents; true if its area is not a number.
fn is_thin(twice_area: f64, squared_longest: f64) -> bool {
    !(twice_area >= MIN_HEIGHT_RATIO * squared_longest && twice_area > 0.0)
}

/// What every side lacks so that two are longer than the third by [`SLACK`] of the longest.
fn lacking([a, b, c]: [f64; 3]) -> f64 {
    let slack = SLACK * a.max(b).max(c);
    (slack - (a + b - c).min(b + c - a).min(c + a - b)).max(0.0)
}

/// The terms of the triangle whose sides are longer by what they lack; those of an equilateral triangle without area
/// for a point. Side k lies opposite corner k.
fn mollified(sides: [f64; 3]) -> FaceTerms {
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

/// Raises the masses of the corners of degenerate faces to [`LEAST_MASS`] of the mean.
fn raise(mesh: &TriMesh, faces: &[u32], mass: &mut [f64]) {
    let least = LEAST_MASS * mass.iter().sum::<f64>() / mass.len() as f64;
    for &v in faces.iter().flat_map(|&f| &mesh.faces()[f as usize]) {
        let m = &mut mass[v as usize];
        *m = m.max(least);
    }
}

#[cfg(test)]
mod tests {
    use fairing_shapes as shapes;

    use super::*;

    /// Rows as the operators crate assembles them: on a closed mesh, with a border, three faces at an edge, a fan
    /// around a hub, and an isolated vertex.
    #[test]
    fn a_pattern_holds_the_cotangent_operator() {
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
            shapes::bumpy_sphere(4, 0.2, 5.0),
            shapes::plane(9, 7, shapes::Diagonals::Alternating),
            TriMesh::new(pages, vec![[0, 1, 2], [0, 1, 3], [1, 0, 4]]).unwrap(),
            TriMesh::new(hub, fan).unwrap(),
        ];
        for mesh in &meshes {
            let n = mesh.vertex_count();
            let held: Vec<bool> = (0..n).map(|v| v % 7 == 3).collect();
            for area in [LumpedArea::Barycentric, LumpedArea::Mixed] {
                let mut pattern = Cotangents::of(mesh, area, &held);
                let stiffness = cotan_stiffness(mesh).unwrap();
                let expected =
                    Laplacian::weighted(&stiffness, positive_mass(mesh, area).unwrap(), &held);
                // Assembled twice into the same memory: nothing is left of the first time.
                let mut found = pattern.assemble(mesh).unwrap();
                pattern.assemble_into(mesh, &mut found, Degenerate::Thin).unwrap();
                let x: Vec<[f64; 3]> =
                    mesh.positions().iter().map(|p| [p[0], p[1] * p[2], 1.0]).collect();
                let value = |l: &Laplacian| {
                    let mut y = vec![[0.0; 3]; n];
                    l.sweep(&x, &mut y, |_, l, _, _| l);
                    y
                };
                for (v, (a, b)) in value(&found).iter().zip(value(&expected)).enumerate() {
                    let size = expected.gershgorin();
                    for k in 0..3 {
                        // A sum of some ten terms of that size, in another order.
                        assert!((a[k] - b[k]).abs() < 1e-13 * size, "{area:?}, vertex {v}");
                    }
                    assert!((found.diagonal()[v] - expected.diagonal()[v]).abs() < 1e-12);
                    assert!((found.mass()[v] / expected.mass()[v] - 1.0).abs() < 1e-14);
                }
            }
        }
    }

    #[test]
    fn a_thin_face_is_the_error_of_the_operator() {
        let line = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [2.0, 0.0, 0.0]];
        let mesh = TriMesh::new(line, vec![[0, 1, 2], [0, 1, 3]]).unwrap();
        let mut pattern = Cotangents::of(&mesh, LumpedArea::Barycentric, &[false; 4]);
        let error = pattern.assemble(&mesh).map(|_| ()).unwrap_err();
        assert_eq!(error, FlowFailure::Operator(cotan_stiffness(&mesh).unwrap_err()));
    }

    /// A needle, a cap and a point become triangles of bounded cotangents and some area; a good face is left alone.
    #[test]
    fn degenerate_faces_have_terms() {
        for sides in [[1.0, 1.0, 1e-14], [1.0, 0.5, 0.5], [3.0, 4.0, 7.0], [2e-200, 1e-200, 1e-200]]
        {
            let [a, b, c, third] = mollified(sides);
            let longest = sides.iter().copied().fold(0.0, f64::max);
            // A cap with this slack has a height of √(slack/2) of its base, a needle a base of the slack.
            assert!([a, b, c].iter().all(|x| x.abs() < 1.0 / SLACK), "{sides:?}: {a} {b} {c}");
            assert!(third > 1e-7 * longest * longest || longest < 1e-100, "{sides:?}: {third}");
            // cot A cot B + cot B cot C + cot C cot A = 1.
            let sum = 4.0 * (a * b + b * c + c * a);
            assert!((sum - 1.0).abs() < 1e-4, "{sides:?}: {sum}");
        }
        // Lengthened by a hundred-thousandth and not by more: 16 area² = (a+b+c)(b+c−a)(c+a−b)(a+b−c).
        let [.., third] = mollified([1.0, 0.5, 0.5]);
        let expected = (2.0f64 * 1e-5).sqrt() / 4.0 / 3.0;
        assert!((third / expected - 1.0).abs() < 1e-3, "{third} {expected}");
        let [half, _, _, area] = mollified([0.0; 3]);
        assert!((half - 0.5 / 3f64.sqrt()).abs() < 1e-15 && area == 0.0);
        let [a, b, c, third] = mollified([3.0, 4.0, 5.0]);
        let expected = [0.5 * 4.0 / 3.0, 0.5 * 0.75, 0.0, 2.0];
        for (x, y) in [a, b, c, third].into_iter().zip(expected) {
            assert!((x - y).abs() < 1e-14, "{x} is not {y}");
        }
    }
}
