//! Total variation of the normal field.

use fairing_mesh::TriMesh;
use fairing_parameters::{Options, Range};
use fairing_sparse::parallel::update;
use fairing_sparse::{CgOptions, FieldOperator, conjugate_gradients, product_by_rows};
use glam::DVec3;
use rayon::prelude::*;

use super::error::{DenoiseError, solved};
use super::faces::{FaceShapes, Hinge, Hinges};
use super::oriented::on_oriented;
use super::vertex_update::{VertexUpdate, follow_normals};

/// The accuracy of the linear systems. The solution of each is the first guess of the next, which
/// begins by measuring the residual.
const ACCURACY: CgOptions = CgOptions { tolerance: 1e-5, max_iterations: 1000, measure: false };

fairing_parameters::options! {
    /// Options of [`total_variation`].
    ///
    /// A jump of one across an edge costs as much as an error of one over a strip beside it, as
    /// wide as the weight.
    #[derive(Debug, Clone, Copy, PartialEq)]
    #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
    #[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
    pub struct TotalVariationOptions {
        /// The weight of the variation relative to fidelity.
        pub weight: f64 = 0.7, in Range::POSITIVE, unit "mean edge lengths";
        /// Steps of the alternating direction method.
        pub iterations: usize = 40;
        /// Vertex updates at the end.
        pub vertex_steps: usize = 20;
    }
    "total-variation": "total variation of normals (Zhang et al. 2015)", ["zhang2015variational"];
}

/// Denoises by total variation of face normals.
///
/// The normals n minimise, with noisy normals m, areas A, lengths ℓ of the
/// hinges and weight α in units of h,
///
/// ```text
/// ½ Σ_faces A ‖n − m‖² + α Σ_edges w ℓ ‖n_f − n_g‖,    w = exp(−‖m̄_f − m̄_g‖⁴)
/// ```
///
/// over fields of vectors, by the alternating direction method of multipliers
/// (the penalty is 2 α / h), followed by scaling to unit length. The weights w spare strong
/// creases; m̄ are the normals after one averaging over the faces across the
/// edges, so that noise does not pass for a crease. The vertices follow
/// ([`update_vertices`]). This is the variation of first order, under which
/// curved parts turn into facets, and not the generalised one of second order.
///
/// # Errors
///
/// [`DenoiseError::Option`] for a weight that is not positive;
/// [`DenoiseError::NotSolved`] if conjugate gradients stall.
///
/// Source: \[zhang2015variational\].
pub fn total_variation(
    mesh: &TriMesh,
    options: &TotalVariationOptions,
) -> Result<TriMesh, DenoiseError> {
    on_oriented(mesh, |mesh| filter(mesh, options))
}

fn filter(mesh: &TriMesh, options: &TotalVariationOptions) -> Result<TriMesh, DenoiseError> {
    options.check()?;
    if mesh.mean_edge_length() <= 0.0 {
        return Ok(mesh.clone());
    }
    let problem = Problem::new(mesh, options.weight);
    let diagonal = problem.diagonal();
    let mut normals = problem.noisy.clone();
    let mut wanted = vec![[0.0; 3]; problem.hinges.all.len()];
    let mut b = normals.clone();
    fairing_watch::stage("steps", options.iterations as u64);
    for step in 0..options.iterations {
        fairing_watch::advance(1);
        problem.shrink(&normals, &mut wanted, step == 0);
        problem.right_hand_side(&wanted, &mut b);
        let operator = FieldOperator::new(&diagonal, |x: &[[f64; 3]], product: &mut [_]| {
            product_by_rows(x, product, |f| problem.row(x, f))
        });
        let (found, _) = conjugate_gradients(&operator, &b, normals, &ACCURACY);
        normals = solved(found, &ACCURACY, step)?;
    }
    let normals: Vec<DVec3> =
        normals.into_par_iter().map(|n| DVec3::from(n).normalize_or_zero()).collect();
    follow_normals(mesh, &normals, &VertexUpdate { steps: options.vertex_steps, limit: None })
}

/// The functional of a mesh, in units of h, so that the numbers do not depend
/// on the scale.
struct Problem {
    hinges: Hinges,
    /// The normals m.
    noisy: Vec<[f64; 3]>,
    areas: Vec<f64>,
    /// The face across each side of each face, and the penalty times ℓ there;
    /// the face itself, and zero, where there is no hinge.
    across: Vec<[u32; 3]>,
    widths: Vec<[f64; 3]>,
    /// α w of each hinge.
    thresholds: Vec<f64>,
    penalty: f64,
}

impl Problem {
    fn new(mesh: &TriMesh, weight: f64) -> Self {
        let hinges = Hinges::new(mesh);
        let FaceShapes { normals, areas, .. } = FaceShapes::new(mesh);
        let (h, penalty) = (mesh.mean_edge_length(), 2.0 * weight);
        let areas: Vec<f64> = areas.iter().map(|a| (a / (h * h)).max(1e-6)).collect();
        let weighted = |f: usize| areas[f] * normals[f];
        let averaged: Vec<DVec3> = (0..areas.len())
            .into_par_iter()
            .map(|f| hinges.across(f).fold(weighted(f), |s, g| s + weighted(g)).normalize_or_zero())
            .collect();
        let positions = mesh.positions();
        let threshold = |hinge: &Hinge| {
            let [m, n] = hinge.faces.map(|f| averaged[f as usize]);
            weight * libm::exp(-m.distance(n).powi(4))
        };
        let side = |f: usize, e: u32| {
            let Some(hinge) = hinges.all.get(e as usize) else { return (f as u32, 0.0) };
            let [a, b] = hinge.ends.map(|v| DVec3::from(positions[v as usize]));
            let [g, k] = hinge.faces;
            (if g as usize == f { k } else { g }, penalty * a.distance(b) / h)
        };
        let (across, widths) = (0..areas.len())
            .into_par_iter()
            .map(|f| {
                let sides = hinges.of_face[f].map(|e| side(f, e));
                (sides.map(|(g, _)| g), sides.map(|(_, width)| width))
            })
            .unzip();
        let thresholds = hinges.all.par_iter().map(threshold).collect();
        let noisy = normals.iter().map(DVec3::to_array).collect();
        Self { hinges, noisy, areas, across, widths, thresholds, penalty }
    }

    /// Row `f` of the matrix of the quadratic step times x.
    #[inline]
    fn row(&self, x: &[[f64; 3]], f: usize) -> [f64; 3] {
        let (across, widths) = (&self.across[f], &self.widths[f]);
        let own = DVec3::from(x[f]);
        let mut sum = self.areas[f] * own;
        for k in 0..3 {
            sum += widths[k] * (own - DVec3::from(x[across[k] as usize]));
        }
        sum.to_array()
    }

    /// The diagonal of that matrix.
    fn diagonal(&self) -> Vec<f64> {
        let faces = self.areas.par_iter().zip(&self.widths);
        faces.map(|(area, widths)| area + widths.iter().sum::<f64>()).collect()
    }

    /// The right-hand side of the quadratic step: the noisy normals and the
    /// jumps that are wanted.
    fn right_hand_side(&self, wanted: &[[f64; 3]], b: &mut [[f64; 3]]) {
        update(b, |f, _| {
            let mut sum = self.areas[f] * DVec3::from(self.noisy[f]);
            for k in 0..3 {
                let Some(jump) = wanted.get(self.hinges.of_face[f][k] as usize) else { continue };
                // A jump is the value of the lower face less that of the other.
                let sign = if (f as u32) < self.across[f][k] { 1.0 } else { -1.0 };
                sum += sign * self.widths[f][k] * DVec3::from(*jump);
            }
            (sum.to_array(), ())
        });
    }

    /// The two other steps, for each hinge. The dual variable is the jump of the
    /// normals minus the wanted one, or zero in the first step. Jump plus dual
    /// variable, shortened by its threshold, minus the dual variable is the
    /// jump wanted next.
    fn shrink(&self, normals: &[[f64; 3]], wanted: &mut [[f64; 3]], first: bool) {
        update(wanted, |e, wanted| {
            let [f, g] = self.hinges.all[e].faces.map(|f| DVec3::from(normals[f as usize]));
            let jump = f - g;
            let dual = if first { DVec3::ZERO } else { jump - DVec3::from(wanted) };
            let q = jump + dual;
            let size = q.length();
            let kept = size - self.thresholds[e] / self.penalty;
            let short = if kept > 0.0 { q * (kept / size) } else { DVec3::ZERO };
            ((short - dual).to_array(), ())
        });
    }
}

#[cfg(test)]
mod tests {
    use fairing_shapes as shapes;

    use super::*;

    /// The weight of a jump is exp(−‖m − n‖⁴) for the normals m and n averaged over a face and
    /// those across its sides, taken here from the topology.
    #[test]
    fn creases_cost_less() {
        let mesh = shapes::cad_block(0.3);
        let topology = mesh.topology();
        let averaged = |f: u32| {
            let across = topology.face_edges()[f as usize];
            let faces = across.iter().flat_map(|&e| topology.edge_faces(e)).filter(|&&g| g != f);
            let area = |f: u32| DVec3::from(mesh.area_vector(f as usize));
            faces.fold(area(f), |s, &g| s + area(g)).normalize_or_zero()
        };
        let weight = 3.0;
        let problem = Problem::new(&mesh, weight);
        let mut least = weight;
        for (hinge, &threshold) in problem.hinges.all.iter().zip(&problem.thresholds) {
            let [m, n] = hinge.faces.map(averaged);
            let jump: f64 = (0..3).map(|k| (m[k] - n[k]).powi(2)).sum();
            let expected = weight * libm::exp(-jump * jump);
            assert!((threshold - expected).abs() < 1e-12, "{threshold} {expected}");
            least = threshold.min(least);
        }
        assert!(least < 0.9 * weight, "{least}");
    }

    /// The matrix is that of Σ A x² + 2α Σ ℓ (x_f − x_g)² over the hinges, and the right-hand side
    /// of the jumps of a field is the matrix times the field where the noisy normals are the field.
    #[test]
    fn the_matrix_is_that_of_the_jumps() {
        let plane = shapes::plane(4, 3, shapes::Diagonals::Alternating);
        for mesh in [shapes::cad_block(0.3), plane] {
            let problem = Problem::new(&mesh, 0.7);
            let x = &problem.noisy;
            let vector = |x: [f64; 3]| DVec3::from(x);
            let h = mesh.mean_edge_length();
            let mut expected: f64 =
                x.iter().zip(&problem.areas).map(|(x, a)| a * vector(*x).length_squared()).sum();
            for hinge in &problem.hinges.all {
                let [a, b] = hinge.ends.map(|v| vector(mesh.positions()[v as usize]));
                let [f, g] = hinge.faces.map(|f| vector(x[f as usize]));
                expected += 1.4 * a.distance(b) / h * f.distance_squared(g);
            }
            let found: f64 =
                (0..x.len()).map(|f| vector(x[f]).dot(vector(problem.row(x, f)))).sum();
            assert!((found - expected).abs() < 1e-12 * expected, "{found} {expected}");
            let jumps = problem.hinges.all.iter().map(|hinge| {
                let [f, g] = hinge.faces.map(|f| vector(x[f as usize]));
                (f - g).to_array()
            });
            let mut b = vec![[0.0; 3]; x.len()];
            problem.right_hand_side(&jumps.collect::<Vec<_>>(), &mut b);
            let mut unit = vec![[0.0; 3]; x.len()];
            for f in 0..x.len() {
                // A few terms, in the same order but for the sign of a zero.
                assert!(vector(b[f]).distance(vector(problem.row(x, f))) < 1e-13, "{:?}", b[f]);
                unit[f] = [1.0; 3];
                assert!((problem.row(&unit, f)[0] - problem.diagonal()[f]).abs() < 1e-13);
                unit[f] = [0.0; 3];
            }
        }
    }
}
