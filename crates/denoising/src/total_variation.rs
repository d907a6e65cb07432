//! Total variation of the normal field.

use fairing_mesh::vec3::{add, distance, norm, scale, sub};
use fairing_mesh::{Algorithm, Parameter, ParameterError, TriMesh, Values};
use rayon::prelude::*;

use super::DenoiseError;
use super::conjugate_gradients::{inner, solved};
use super::denoiser::Method;
use super::error::positive;
use super::faces::{FaceShapes, Hinges, NO_HINGE, unit_or_zero};
use super::unit_scale::at_unit_scale;
use super::vertex_update::{VertexUpdate, update_vertices};

/// The relative residual of the systems, and the most iterations.
const TOLERANCE: f64 = 1e-5;
const ITERATIONS: usize = 1000;

/// Parameters of [`total_variation`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TotalVariationOptions {
    /// The weight of the variation against fidelity, in mean edge lengths: a
    /// jump of one across an edge costs as much as an error of one over a strip
    /// of this width beside it.
    pub weight: f64,
    /// Steps of the alternating direction method.
    pub iterations: usize,
    /// Vertex steps at the end.
    pub vertex_steps: usize,
}

impl Default for TotalVariationOptions {
    /// Weight 0.7, 40 iterations, 20 vertex steps.
    fn default() -> Self {
        Self { weight: 0.7, iterations: 40, vertex_steps: 20 }
    }
}

impl Method for TotalVariationOptions {
    const ALGORITHM: &'static Algorithm = &Algorithm::new(
        "total-variation",
        "total variation of normals (Zhang et al. 2015)",
        &["zhang2015variational"],
        &[
            Parameter::number("weight", "0.7", "The weight of the variation against fidelity")
                .unit("mean edge lengths"),
            Parameter::count("iterations", "40", "Steps of the alternating direction method"),
            Parameter::count("vertex-steps", "20", "Vertex steps at the end"),
        ],
    );

    fn read(&mut self, values: &Values<'_>) -> Result<(), ParameterError> {
        values.read("weight", &mut self.weight)?;
        values.read("iterations", &mut self.iterations)?;
        values.read("vertex-steps", &mut self.vertex_steps)
    }

    fn run(&self, mesh: &TriMesh) -> Result<TriMesh, DenoiseError> {
        total_variation(mesh, self)
    }
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
/// [`DenoiseError::InvalidOption`] for a weight that is not positive;
/// [`DenoiseError::NotSolved`] if conjugate gradients stall.
///
/// Source: \[zhang2015variational\].
pub fn total_variation(
    mesh: &TriMesh,
    options: &TotalVariationOptions,
) -> Result<TriMesh, DenoiseError> {
    at_unit_scale(mesh, |mesh| filter(mesh, options))
}

fn filter(mesh: &TriMesh, options: &TotalVariationOptions) -> Result<TriMesh, DenoiseError> {
    positive("weight", options.weight)?;
    if mesh.mean_edge_length() <= 0.0 {
        return Ok(mesh.clone());
    }
    let problem = Problem::new(mesh, options.weight);
    let (noisy, edges) = (&problem.noisy, problem.hinges.all.len());
    let diagonal = problem.diagonal();
    let data: Vec<[f64; 3]> =
        noisy.iter().zip(&problem.areas).map(|(n, a)| scale(*n, *a)).collect();
    let mut normals = noisy.clone();
    // Scaled dual variables, one per hinge.
    let mut dual = vec![[0.0; 3]; edges];
    fairing_watch::stage("steps", options.iterations as u64);
    for step in 0..options.iterations {
        fairing_watch::advance(1);
        let shrunk = problem.shrink(&normals, &dual);
        let target: Vec<[f64; 3]> = (0..edges)
            .into_par_iter()
            .map(|e| scale(sub(shrunk[e], dual[e]), problem.penalty))
            .collect();
        let b: Vec<[f64; 3]> =
            data.iter().zip(problem.diverge(&target)).map(|(d, t)| add(*d, t)).collect();
        let found = inner(|x| problem.apply(x), &diagonal, &b, normals, TOLERANCE, ITERATIONS);
        normals = solved(found, TOLERANCE, ITERATIONS, step)?;
        dual = (0..edges)
            .into_par_iter()
            .map(|e| add(dual[e], sub(problem.jump(&normals, e), shrunk[e])))
            .collect();
    }
    let normals: Vec<[f64; 3]> = normals.into_par_iter().map(unit_or_zero).collect();
    update_vertices(mesh, &normals, &VertexUpdate { steps: options.vertex_steps, limit: None })
}

/// The functional of a mesh, in units of h, so that the numbers do not depend
/// on the scale.
struct Problem {
    hinges: Hinges,
    /// The normals m.
    noisy: Vec<[f64; 3]>,
    areas: Vec<f64>,
    /// ℓ of each hinge.
    lengths: Vec<f64>,
    /// α w of each hinge.
    thresholds: Vec<f64>,
    penalty: f64,
}

impl Problem {
    fn new(mesh: &TriMesh, weight: f64) -> Self {
        let hinges = Hinges::new(mesh);
        let FaceShapes { normals, areas, .. } = FaceShapes::new(mesh);
        let h = mesh.mean_edge_length();
        let areas: Vec<f64> = areas.iter().map(|a| (a / (h * h)).max(1e-6)).collect();
        let weighted = |f: usize| scale(normals[f], areas[f]);
        let averaged: Vec<[f64; 3]> = (0..areas.len())
            .into_par_iter()
            .map(|f| unit_or_zero(hinges.across(f).fold(weighted(f), |s, g| add(s, weighted(g)))))
            .collect();
        let positions = mesh.positions();
        let (lengths, thresholds) = hinges
            .all
            .par_iter()
            .map(|hinge| {
                let [a, b] = hinge.ends.map(|v| positions[v as usize]);
                let [m, n] = hinge.faces.map(|f| averaged[f as usize]);
                (distance(a, b) / h, weight * libm::exp(-distance(m, n).powi(4)))
            })
            .unzip();
        Self { hinges, noisy: normals, areas, lengths, thresholds, penalty: 2.0 * weight }
    }

    /// The difference of the fields of the two faces of hinge `e`.
    fn jump(&self, x: &[[f64; 3]], e: usize) -> [f64; 3] {
        let [f, g] = self.hinges.all[e].faces;
        sub(x[f as usize], x[g as usize])
    }

    /// The hinges of a face.
    fn sides(&self, f: usize) -> impl Iterator<Item = usize> + '_ {
        let all = self.hinges.of_face[f].into_iter();
        all.filter(|&e| e != NO_HINGE).map(|e| e as usize)
    }

    /// The adjoint of the jumps, weighted by lengths: a value for each face.
    fn diverge(&self, values: &[[f64; 3]]) -> Vec<[f64; 3]> {
        (0..self.areas.len())
            .into_par_iter()
            .map(|f| {
                self.sides(f).fold([0.0; 3], |s, e| {
                    let sign = if self.hinges.all[e].faces[0] as usize == f { 1.0 } else { -1.0 };
                    add(s, scale(values[e], sign * self.lengths[e]))
                })
            })
            .collect()
    }

    /// The matrix of the quadratic step times x.
    fn apply(&self, x: &[[f64; 3]]) -> Vec<[f64; 3]> {
        let jumps: Vec<_> = (0..self.hinges.all.len())
            .into_par_iter()
            .map(|e| scale(self.jump(x, e), self.penalty))
            .collect();
        let spread = self.diverge(&jumps);
        (0..x.len()).into_par_iter().map(|f| add(scale(x[f], self.areas[f]), spread[f])).collect()
    }

    /// The diagonal of that matrix.
    fn diagonal(&self) -> Vec<f64> {
        (0..self.areas.len())
            .into_par_iter()
            .map(|f| {
                self.areas[f] + self.penalty * self.sides(f).map(|e| self.lengths[e]).sum::<f64>()
            })
            .collect()
    }

    /// The jumps plus the dual variables, shortened by their thresholds.
    fn shrink(&self, normals: &[[f64; 3]], dual: &[[f64; 3]]) -> Vec<[f64; 3]> {
        (0..dual.len())
            .into_par_iter()
            .map(|e| {
                let q = add(self.jump(normals, e), dual[e]);
                let size = norm(q);
                let kept = size - self.thresholds[e] / self.penalty;
                if kept > 0.0 { scale(q, kept / size) } else { [0.0; 3] }
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use fairing_shapes as shapes;

    use super::*;

    /// The weight of a jump is exp(−‖m − n‖⁴) for the normals m and n averaged over a face and those across its
    /// sides, taken here from the topology.
    #[test]
    fn creases_cost_less() {
        let mesh = shapes::cad_block(0.3);
        let topology = mesh.topology();
        let averaged = |f: u32| {
            let across = topology.face_edges()[f as usize];
            let faces = across.iter().flat_map(|&e| topology.edge_faces(e)).filter(|&&g| g != f);
            unit_or_zero(
                faces.fold(mesh.area_vector(f as usize), |s, &g| {
                    add(s, mesh.area_vector(g as usize))
                }),
            )
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
}
