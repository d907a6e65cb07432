//! Total generalised variation of the normal field.

use fairing_mesh::TriMesh;
use fairing_parameters::{Options, Range};
use fairing_sparse::parallel::update;
use fairing_sparse::{CgOptions, FieldOperator, conjugate_gradients, product_by_rows};
use glam::DVec3;

use super::error::{DenoiseError, solved};
use super::faces::{FaceShapes, NO_HINGE};
use super::jumps::{JumpSystem, length, shorten};
use super::masked::Masked;
use super::vertex_update::follow_normals;
use crate::masked::on_oriented;

/// The accuracy of the linear systems. The solution of each is the first guess of the next, which
/// begins by measuring the residual.
const ACCURACY: CgOptions = CgOptions { tolerance: 1e-4, max_iterations: 1000 };

/// The weight of a term over its penalty: the length by which its vectors are shortened in a step.
const THRESHOLD: f64 = 0.5;

fairing_parameters::options! {
    /// Options of [`total_generalised_variation`].
    ///
    /// The weight grows with the noise of the normals: 0.5 suits independent noise of a third of
    /// the mean edge length, and 1 strong noise on large faces, and depth cameras, for which 100
    /// vertex updates help. A large ratio leaves the variation of first order.
    #[derive(Debug, Clone, Copy, PartialEq)]
    #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
    #[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
    pub struct TotalGeneralisedVariationOptions {
        /// The weight α₁ of first order relative to fidelity.
        pub weight: f64 = 0.5, in Range::POSITIVE, unit "mean edge lengths";
        /// The weight of second order relative to first order, α₀/α₁.
        pub ratio: f64 = 0.5, in Range::POSITIVE;
        /// Steps of the alternating direction method.
        pub iterations: usize = 100;
        /// Vertex updates at the end.
        pub vertex_steps: usize = 50;
    }
    "total-generalised-variation": "total generalised variation of normals (Liu et al. 2021)",
        ["liu2021"];
}

/// Denoises by total generalised variation of second order of face normals.
///
/// The unit normals n of the faces and the vectors v of the hinges minimise, with noisy normals m,
/// areas A, lengths ℓ of the hinges and weights α₁ and α₀ in units of h,
///
/// ```text
/// ½ Σ_faces A ‖n − m‖² + α₁ Σ_edges ℓ ‖n_f − n_g − v‖ + α₀ Σ_corners d ‖v_e + v_e′‖
/// ```
///
/// The last sum is over the corners of all faces: d is the distance of the corner from the
/// centroid, e and e′ are the two sides of the face at the corner, and their vectors count as
/// pointing out of the face. With v = n_f − n_g, the last term is the second difference 2 n_f − n_g
/// − n_g′ over three faces in a row. Where the normals turn evenly, v follows the jumps and only
/// the second term counts; at creases v is small, and the jump costs no more than its length. So
/// creases are kept, and curved parts do not turn into facets, as they do under
/// [`total_variation`](super::total_variation) of first order. Faces are not compared across
/// borders.
///
/// The functional is split into quadratic steps for n and v and into shortened vectors by the
/// alternating direction method of multipliers (both penalties are twice the weight over h). After
/// each step the normals are scaled to unit length. The vertices follow
/// ([`update_vertices`](super::update_vertices)). The cost of a step is linear in the number of
/// faces. The default weights are not from the source.
///
/// # Errors
///
/// [`DenoiseError::Option`] for a weight or ratio that is not positive;
/// [`DenoiseError::NotSolved`] if conjugate gradients stall.
///
/// Source: [liu2021].
///
/// [liu2021]: https://doi.org/10.1109/TVCG.2021.3088118
pub fn total_generalised_variation<'a>(
    mesh: impl Into<Masked<'a>>,
    options: &TotalGeneralisedVariationOptions,
) -> Result<TriMesh, DenoiseError> {
    on_oriented(mesh.into(), |mesh| filter(mesh, options))
}

fn filter(
    input: Masked<'_>,
    options: &TotalGeneralisedVariationOptions,
) -> Result<TriMesh, DenoiseError> {
    let mesh = input.mesh();
    options.check()?;
    if mesh.mean_edge_length() <= 0.0 {
        return Ok(mesh.clone());
    }
    let normals = filtered_normals(mesh, options)?;
    follow_normals(input, &normals, options.vertex_steps)
}

/// The normals of the minimiser.
pub(crate) fn filtered_normals(
    mesh: &TriMesh,
    options: &TotalGeneralisedVariationOptions,
) -> Result<Vec<DVec3>, DenoiseError> {
    let penalties = [1.0, options.ratio].map(|scale| scale * options.weight / THRESHOLD);
    let system = JumpSystem::new(mesh, penalties[0]);
    if system.hinges.all.is_empty() {
        return Ok(system.noisy.into_iter().map(DVec3::from).collect());
    }
    let bends = Bends::new(mesh, &system, penalties);
    let diagonal = system.diagonal();
    let mut solution = system.noisy.clone();
    let mut normals = solution.clone();
    let mut vectors = vec![[0.0; 3]; system.hinges.all.len()];
    let mut jumps = vectors.clone();
    let mut wanted = vec![[0.0; 3]; bends.corners.len()];
    let mut b = normals.clone();
    let mut c = vectors.clone();
    fairing_watch::stage("steps", options.iterations as u64);
    for step in 0..options.iterations {
        fairing_watch::advance(1);
        update(&mut jumps, |e, wanted| {
            let excess = system.jump(&normals, e) - DVec3::from(vectors[e]);
            (shorten(excess, wanted, THRESHOLD, step == 0), ())
        });
        update(&mut wanted, |corner, wanted| {
            (shorten(bends.bend(&vectors, corner), wanted, THRESHOLD, step == 0), ())
        });
        let jump = |e: usize| DVec3::from(vectors[e]) + DVec3::from(jumps[e]);
        system.right_hand_side(jump, &mut b);
        let operator = FieldOperator::new(&diagonal, |x: &[[f64; 3]], product: &mut [_]| {
            product_by_rows(x, product, |f| system.row(x, f))
        });
        let found = conjugate_gradients(&operator, &b, solution, &ACCURACY);
        solution = solved(found, &ACCURACY, step)?;
        update(&mut normals, |f, _| (DVec3::from(solution[f]).normalize_or_zero().to_array(), ()));
        let excess = |e: usize| system.jump(&normals, e) - DVec3::from(jumps[e]);
        bends.right_hand_side(excess, &wanted, &mut c);
        let operator = FieldOperator::new(&bends.diagonal, |v: &[[f64; 3]], product: &mut [_]| {
            product_by_rows(v, product, |e| bends.row(v, e))
        });
        let found = conjugate_gradients(&operator, &c, vectors, &ACCURACY);
        vectors = solved(found, &ACCURACY, step)?;
    }
    Ok(normals.into_iter().map(DVec3::from).collect())
}

/// The quadratic step for the vectors v of the hinges: with the excess q of the jumps and the
/// wanted bends w of the corners,
///
/// ```text
/// ½ r₁ Σ_hinges ℓ ‖v − q‖² + ½ r₀ Σ_corners d ‖v_e + v_e′ − w‖²
/// ```
struct Bends {
    /// The two hinges at each corner of each face and their signs; [`NO_HINGE`] and zero if one is
    /// missing.
    corners: Vec<([u32; 2], [f64; 2])>,
    /// r₁ ℓ of each hinge.
    widths: Vec<f64>,
    /// The diagonal of the matrix, and the entries for the hinges that share a corner with each:
    /// two in either face; the hinge itself, and zero, where one is missing.
    diagonal: Vec<f64>,
    entries: Vec<[(u32, f64); 4]>,
    /// The corners that an entry comes from, and the sign of the hinge times r₀ d there.
    pulls: Vec<[(u32, f64); 4]>,
}

impl Bends {
    fn new(mesh: &TriMesh, system: &JumpSystem, penalties: [f64; 2]) -> Self {
        let h = mesh.mean_edge_length();
        let sides = &system.hinges.of_face;
        let centroids = FaceShapes::new(mesh).centroids;
        let at_corner = |f: usize, c: usize| {
            let [k, l] = [(c + 1) % 3, (c + 2) % 3];
            let hinges = [sides[f][k], sides[f][l]];
            if hinges.contains(&NO_HINGE) {
                return (hinges, [0.0; 2]);
            }
            (hinges, [system.sign(f, k), system.sign(f, l)])
        };
        let corners: Vec<_> = (0..3 * sides.len()).map(|c| at_corner(c / 3, c % 3)).collect();
        let hinges = &system.hinges.all;
        let mut widths = Vec::with_capacity(hinges.len());
        let mut diagonal = Vec::with_capacity(hinges.len());
        let mut entries = Vec::with_capacity(hinges.len());
        let mut pulls = Vec::with_capacity(hinges.len());
        for (e, hinge) in hinges.iter().enumerate() {
            // Keeps the matrix definite where an edge has no length.
            let width = penalties[0] * (length(mesh, hinge) / h).max(1e-6);
            let (mut sum, mut count) = (width, 0);
            let mut row = [(e as u32, 0.0); 4];
            let mut pull = [(0, 0.0); 4];
            for f in hinge.faces {
                let triangle = mesh.triangle(f as usize).map(DVec3::from);
                for c in 0..3 {
                    let corner = 3 * f as usize + c;
                    let (pair, signs) = corners[corner];
                    let Some(own) = pair.iter().position(|&o| o == e as u32) else { continue };
                    let distance = triangle[c].distance(centroids[f as usize]) / h;
                    let weight = penalties[1] * distance * signs[own];
                    if signs[own] != 0.0 {
                        row[count] = (pair[1 - own], weight * signs[1 - own]);
                        pull[count] = (corner as u32, weight);
                        sum += weight * signs[own];
                        count += 1;
                    }
                }
            }
            widths.push(width);
            diagonal.push(sum);
            entries.push(row);
            pulls.push(pull);
        }
        Self { corners, widths, diagonal, entries, pulls }
    }

    /// v_e + v_e′ at a corner, `3 f + c` for corner c of face f; zero if a side is no hinge.
    #[inline]
    fn bend(&self, v: &[[f64; 3]], corner: usize) -> DVec3 {
        let (hinges, signs) = self.corners[corner];
        if signs[0] == 0.0 {
            return DVec3::ZERO;
        }
        let [a, b] = hinges.map(|e| DVec3::from(v[e as usize]));
        signs[0] * a + signs[1] * b
    }

    /// Row `e` of the matrix times v.
    #[inline]
    fn row(&self, v: &[[f64; 3]], e: usize) -> [f64; 3] {
        let mut sum = self.diagonal[e] * DVec3::from(v[e]);
        for (other, entry) in self.entries[e] {
            sum += entry * DVec3::from(v[other as usize]);
        }
        sum.to_array()
    }

    /// The right-hand side.
    fn right_hand_side(
        &self,
        excess: impl Fn(usize) -> DVec3 + Sync,
        wanted: &[[f64; 3]],
        c: &mut [[f64; 3]],
    ) {
        update(c, |e, _| {
            let mut sum = self.widths[e] * excess(e);
            for (corner, pull) in self.pulls[e] {
                sum += pull * DVec3::from(wanted[corner as usize]);
            }
            (sum.to_array(), ())
        });
    }
}

#[cfg(test)]
mod tests {
    use fairing_shapes as shapes;

    use super::super::total_variation::{TotalVariationOptions, total_variation};
    use super::*;

    fn jittered(mesh: &TriMesh, amount: f64) -> TriMesh {
        shapes::jittered(mesh, amount, 7, |p| p)
    }

    /// The mean angle between given normals and those of a mesh, in degrees.
    fn error(normals: &[DVec3], mesh: &TriMesh) -> f64 {
        let truth = FaceShapes::new(mesh).normals;
        let angle =
            |(n, m): (&DVec3, &DVec3)| libm::atan2(n.cross(*m).length(), n.dot(*m)).to_degrees();
        normals.iter().zip(&truth).map(angle).sum::<f64>() / normals.len() as f64
    }

    /// The matrix is that of r₁ Σ ℓ v² + r₀ Σ d (v_e + v_e′)², the right-hand side of the bends of
    /// a field and the field itself is the matrix times the field, and the bend of the jumps of a
    /// field of normals is its second difference.
    #[test]
    fn the_matrix_is_that_of_the_bends() {
        let plane = shapes::plane(4, 3, shapes::Diagonals::Alternating);
        for mesh in [shapes::cad_block(0.3), plane] {
            let penalties = [1.4, 0.6];
            let system = JumpSystem::new(&mesh, penalties[0]);
            let bends = Bends::new(&mesh, &system, penalties);
            let hinges = &system.hinges;
            let x: Vec<[f64; 3]> =
                (0..mesh.face_count()).map(|f| [(f % 5) as f64, (f % 3) as f64, 1.0]).collect();
            let v: Vec<[f64; 3]> =
                (0..hinges.all.len()).map(|e| system.jump(&x, e).to_array()).collect();
            let h = mesh.mean_edge_length();
            let mut expected = 0.0;
            for (hinge, v) in hinges.all.iter().zip(&v) {
                expected += 1.4 * length(&mesh, hinge) / h * DVec3::from(*v).length_squared();
            }
            for corner in 0..3 * mesh.face_count() {
                let (f, c) = (corner / 3, corner % 3);
                let found = bends.bend(&v, corner);
                let [g, k] = [hinges.beside[f][(c + 1) % 3], hinges.beside[f][(c + 2) % 3]];
                if g == NO_HINGE || k == NO_HINGE {
                    assert!(found == DVec3::ZERO);
                    continue;
                }
                let [own, g, k] = [f, g as usize, k as usize].map(|f| DVec3::from(x[f]));
                assert!(found.distance(2.0 * own - g - k) < 1e-12);
                let triangle = mesh.triangle(f).map(DVec3::from);
                let centroid = (triangle[0] + triangle[1] + triangle[2]) / 3.0;
                expected += 0.6 * triangle[c].distance(centroid) / h * found.length_squared();
            }
            let wanted: Vec<[f64; 3]> = (0..3 * mesh.face_count())
                .map(|corner| bends.bend(&v, corner).to_array())
                .collect();
            let mut c = v.clone();
            bends.right_hand_side(|e| DVec3::from(v[e]), &wanted, &mut c);
            let mut product = 0.0;
            for e in 0..v.len() {
                let row = DVec3::from(bends.row(&v, e));
                assert!(row.distance(DVec3::from(c[e])) < 1e-12);
                product += DVec3::from(v[e]).dot(row);
            }
            assert!((product - expected).abs() < 1e-12 * expected, "{product} {expected}");
        }
    }

    #[test]
    fn a_plane_becomes_flat() {
        let flat = shapes::jittered_plane(20, 20, 0.2, 3);
        let h = flat.mean_edge_length();
        let heights = flat.positions().iter().enumerate().map(|(i, &[x, y, _])| {
            // Pseudo-random heights within 0.2 h.
            [x, y, 0.4 * h * ((i * 7919 % 1009) as f64 / 1009.0 - 0.5)]
        });
        let noisy = flat.with_positions(heights.collect()).unwrap();
        let before = error(&FaceShapes::new(&noisy).normals, &flat);
        let options = TotalGeneralisedVariationOptions { weight: 1.0, ..Default::default() };
        let found = total_generalised_variation(&noisy, &options).unwrap();
        let after = error(&FaceShapes::new(&found).normals, &flat);
        assert!(before > 5.0 && after < 0.1 * before, "{before} {after}");
    }

    /// With a very large ratio v vanishes and first order is left: on a slightly noisy plane, where
    /// the weights of creases and the scaling to unit length have no effect to first order, the
    /// result is that of total variation.
    #[test]
    fn a_large_ratio_is_first_order() {
        let noisy = jittered(&shapes::plane(12, 12, shapes::Diagonals::Alternating), 0.02);
        let h = noisy.mean_edge_length();
        let first = TotalVariationOptions { weight: 0.2, iterations: 300, vertex_steps: 20 };
        let second = TotalGeneralisedVariationOptions {
            weight: 0.2,
            ratio: 1e3,
            iterations: 300,
            vertex_steps: 20,
        };
        let [a, b, c] = [
            total_variation(&noisy, &first).unwrap(),
            total_generalised_variation(&noisy, &second).unwrap(),
            noisy,
        ];
        let distance = |a: &TriMesh, b: &TriMesh| {
            let pairs = a.positions().iter().zip(b.positions());
            pairs.map(|(&p, &q)| DVec3::from(p).distance(q.into())).sum::<f64>() / h
        };
        let (moved, apart) = (distance(&a, &c), distance(&a, &b));
        assert!(apart < 0.02 * moved, "{apart} {moved}");
    }

    /// First order turns a cylinder into facets, second order does not. (Meshes are compared: the
    /// normals themselves turn evenly, while both faces of a square have the same.)
    #[test]
    fn second_order_keeps_a_cylinder_round() {
        let cylinder = shapes::cylinder(1.0, 3.0, 48, 24, shapes::Ends::Open);
        let noisy = jittered(&cylinder, 0.2);
        let with = |ratio| {
            let options =
                TotalGeneralisedVariationOptions { weight: 0.4, ratio, ..Default::default() };
            let denoised = total_generalised_variation(&noisy, &options).unwrap();
            error(&FaceShapes::new(&denoised).normals, &cylinder)
        };
        let (second, first) = (with(0.5), with(100.0));
        assert!(second < 0.7 * first, "{second} {first}");
    }
}
