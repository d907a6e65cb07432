//! Total variation of the normal field.

use fairing_mesh::TriMesh;
use fairing_parameters::{Options, Range};
use fairing_sparse::parallel::update;
use fairing_sparse::{CgOptions, FieldOperator, conjugate_gradients, product_by_rows};
use fairing_watch::parallel;
use glam::DVec3;

use super::error::{DenoiseError, solved};
use super::faces::Hinge;
use super::jump_tree::JumpTree;
use super::jumps::{JumpSystem, shorten};
use super::masked::Masked;
use super::vertex_update::follow_normals;
use crate::masked::on_oriented;

/// The accuracy of the linear systems. The solution of each is the first guess of the next, which
/// begins by measuring the residual.
const ACCURACY: CgOptions = CgOptions { tolerance: 1e-5, max_iterations: 1000 };

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
/// over fields of vectors, by the alternating direction method of multipliers (the penalty is 2 α /
/// h), followed by scaling to unit length. The weights w spare strong creases; m̄ are the normals
/// after one averaging over the faces across the edges, so that noise is not mistaken for a crease.
/// The linear systems are solved by conjugate gradients, preconditioned by a spanning tree of the
/// faces where these are very thin. The vertices follow
/// ([`update_vertices`](super::update_vertices)). This is the variation of first order, under which
/// curved parts turn into facets, and not the [generalised](super::total_generalised_variation) one
/// of second order.
///
/// # Errors
///
/// [`DenoiseError::Option`] for a weight that is not positive;
/// [`DenoiseError::NotSolved`] if conjugate gradients stall.
///
/// Source: [zhang2015variational].
///
/// [zhang2015variational]: https://doi.org/10.1109/TVCG.2015.2398432
pub fn total_variation<'a>(
    mesh: impl Into<Masked<'a>>,
    options: &TotalVariationOptions,
) -> Result<TriMesh, DenoiseError> {
    on_oriented(mesh.into(), |mesh| filter(mesh, options))
}

fn filter(input: Masked<'_>, options: &TotalVariationOptions) -> Result<TriMesh, DenoiseError> {
    let mesh = input.mesh();
    options.check()?;
    if mesh.mean_edge_length() <= 0.0 {
        return Ok(mesh.clone());
    }
    let penalty = 2.0 * options.weight;
    let system = JumpSystem::new(mesh, penalty);
    let thresholds = thresholds(&system, options.weight);
    let diagonal = system.diagonal();
    let tree = system.is_stiff().then(|| JumpTree::new(&system));
    let mut normals = system.noisy.clone();
    let mut wanted = vec![[0.0; 3]; system.hinges.all.len()];
    let mut b = normals.clone();
    fairing_watch::stage("steps", options.iterations as u64);
    for step in 0..options.iterations {
        fairing_watch::advance(1);
        update(&mut wanted, |e, wanted| {
            let jump = system.jump(&normals, e);
            (shorten(jump, wanted, thresholds[e] / penalty, step == 0), ())
        });
        system.right_hand_side(|e| DVec3::from(wanted[e]), &mut b);
        if let Some(tree) = &tree {
            (normals, _) = tree.solve(&system, &b, normals, &ACCURACY, step)?;
            continue;
        }
        let operator = FieldOperator::new(&diagonal, |x: &[[f64; 3]], product: &mut [_]| {
            product_by_rows(x, product, |f| system.row(x, f))
        });
        let found = conjugate_gradients(&operator, &b, normals, &ACCURACY);
        normals = solved(found, &ACCURACY, step)?;
    }
    let normals: Vec<DVec3> =
        normals.into_iter().map(|n| DVec3::from(n).normalize_or_zero()).collect();
    follow_normals(input, &normals, options.vertex_steps)
}

/// α w of each hinge.
fn thresholds(system: &JumpSystem, weight: f64) -> Vec<f64> {
    let JumpSystem { hinges, noisy, areas, .. } = system;
    let weighted = |f: usize| areas[f] * DVec3::from(noisy[f]);
    let averaged: Vec<DVec3> = parallel::map(areas.len(), 64, |f| {
        hinges.across(f).fold(weighted(f), |s, g| s + weighted(g)).normalize_or_zero()
    });
    let threshold = |hinge: &Hinge| {
        let [m, n] = hinge.faces.map(|f| averaged[f as usize]);
        weight * libm::exp(-m.distance(n).powi(4))
    };
    parallel::map(hinges.all.len(), 64, |i| threshold(&hinges.all[i]))
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
        let system = JumpSystem::new(&mesh, 1.0);
        let mut least = weight;
        for (hinge, threshold) in system.hinges.all.iter().zip(thresholds(&system, weight)) {
            let [m, n] = hinge.faces.map(averaged);
            let jump: f64 = (0..3).map(|k| (m[k] - n[k]).powi(2)).sum();
            let expected = weight * libm::exp(-jump * jump);
            assert!((threshold - expected).abs() < 1e-12, "{threshold} {expected}");
            least = threshold.min(least);
        }
        assert!(least < 0.9 * weight, "{least}");
    }
}
