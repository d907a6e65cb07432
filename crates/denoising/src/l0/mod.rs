//! L0 minimisation of dihedral bends.

mod system;

use fairing_mesh::TriMesh;
use fairing_parameters::{Options, Range};
use fairing_sparse::{CgOptions, FieldOperator, conjugate_gradients, product_by_rows};
use fairing_watch::parallel;
use glam::DVec3;

use crate::error::DenoiseError;
use crate::faces::{FaceShapes, Hinge, Hinges};
use crate::masked::{Masked, on_oriented};
use system::{Stencils, System, combine};

/// The accuracy of the linear systems. The solution of each is the first guess of the next, which
/// begins by measuring the residual.
const ACCURACY: CgOptions = CgOptions { tolerance: 1e-4, max_iterations: 200 };

fairing_parameters::options! {
    /// Options of [`l0`].
    ///
    /// The defaults are those of the source except for the sparsity, whose value 1 in the source
    /// keeps most of a noise of 0.3 h. γ is the mean of unsigned angles: that of signed ones is
    /// near zero.
    #[derive(Debug, Clone, Copy, PartialEq)]
    #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
    #[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
    pub struct L0Options {
        /// The penalty of a bent edge.
        pub sparsity: f64 = 15.0, in Range::POSITIVE,
            unit "0.02 γ h², with the mean angle γ between normals and the mean edge length h";
        /// The initial weight against folds, halved after each step.
        pub regularity: f64 = 1.0, in Range::POSITIVE, unit "0.1 γ";
        /// The growth of the coupling β in each step.
        pub growth: f64 = std::f64::consts::SQRT_2, in Range::above(1.0);
        /// The coupling β of the last step; the first is 0.001.
        pub last_beta: f64 = 1e3, in Range::POSITIVE;
    }
    "l0": "as few bent edges as possible (He and Schaefer 2013)", ["he2013"];
}

/// Denoises by minimising the number of bent edges.
///
/// Minimises over the positions p, with the noisy ones p*,
///
/// ```text
/// ‖p − p*‖² + α ‖R p‖² + λ #{edges with D p ≠ 0}
/// ```
///
/// by alternating with auxiliary variables whose coupling β grows. D is the area-based edge
/// operator: for a hinge (p₁, p₂, p₃, p₄) with ends p₁ and p₃, a combination of the four corners
/// that vanishes when they are in one plane and the triangles (1,2,3), (1,3,4) keep their areas;
/// its coefficients are taken from the current positions. R = p₁ − p₂ + p₃ − p₄ guards against
/// folds. Each step is a linear system, solved by conjugate gradients to 10⁻⁴ or, if β makes it
/// stiff, by 200 iterations, because the next step starts from the result.
///
/// Slow, with about forty systems.
///
/// # Errors
///
/// [`DenoiseError::Option`] for a parameter that is not positive or a
/// growth of at most 1; [`DenoiseError::Build`] if coordinates overflow.
///
/// Source: [he2013].
///
/// [he2013]: https://doi.org/10.1145/2461912.2461965
#[doc(alias = "l0_minimization")]
pub fn l0<'a>(mesh: impl Into<Masked<'a>>, options: &L0Options) -> Result<TriMesh, DenoiseError> {
    on_oriented(mesh.into(), |mesh| filter(mesh, options))
}

fn filter(input: Masked<'_>, options: &L0Options) -> Result<TriMesh, DenoiseError> {
    let mesh = input.mesh();
    options.check()?;
    let hinges = Hinges::new(mesh);
    if hinges.all.is_empty() {
        return Ok(mesh.clone());
    }
    let normals = FaceShapes::new(mesh).normals;
    let turn = |h: &Hinge| {
        let [a, b] = h.faces.map(|f| normals[f as usize]);
        libm::atan2(a.cross(b).length(), a.dot(b))
    };
    let angle = hinges.all.iter().map(turn).sum::<f64>() / hinges.all.len() as f64;
    let h = mesh.mean_edge_length();
    let lambda = options.sparsity * 0.02 * angle * h * h;
    let mut alpha = options.regularity * 0.1 * angle;
    let stencils = Stencils::new(mesh, &hinges);
    // Both operators leave out translations; far from the origin the tolerance
    // of the systems would be larger than the mesh.
    let sum: DVec3 = mesh.positions().iter().copied().map(DVec3::from).sum();
    let centre = sum * (1.0 / mesh.vertex_count() as f64);
    let noisy: Vec<[f64; 3]> =
        mesh.positions().iter().map(|&p| (DVec3::from(p) - centre).to_array()).collect();
    // Fixed vertices are known: the equation of each is x = p*, and no direction moves it.
    let mut positions = noisy.clone();
    let mut system = System::new(&stencils);
    let mut beta = 1e-3;
    let betas = std::iter::successors(Some(beta), |beta| Some(beta * options.growth));
    let rounds = betas.take_while(|beta| *beta < options.last_beta).count();
    fairing_watch::stage("rounds", rounds as u64);
    while beta < options.last_beta {
        let weights = stencils.edge_operators(&positions);
        let bend = |e: usize| {
            let bend = combine(&stencils.corners[e], &weights[e], &positions);
            if bend.dot(bend) <= lambda / beta { DVec3::ZERO } else { bend }
        };
        let delta: Vec<DVec3> = parallel::map(weights.len(), 64, bend);
        let b = stencils.transpose(&weights, &delta);
        let at = |(v, (&p, &d)): (usize, (&[f64; 3], &DVec3))| {
            if input.is_fixed(v) { p } else { (DVec3::from(p) + beta * d).to_array() }
        };
        let b: Vec<[f64; 3]> = noisy.iter().zip(&b).enumerate().map(at).collect();
        system.fill(&weights, beta, alpha);
        let operator = FieldOperator::new(&system.diagonal(), |p: &[[f64; 3]], q: &mut [_]| {
            product_by_rows(p, q, |v| if input.is_fixed(v) { p[v] } else { system.row(v, p) })
        });
        positions = conjugate_gradients(&operator, &b, positions, &ACCURACY).x;
        beta *= options.growth;
        alpha *= 0.5;
        fairing_watch::advance(1);
    }
    let moved = positions.into_iter().enumerate().map(|(v, p)| {
        if input.is_fixed(v) { mesh.positions()[v] } else { (DVec3::from(p) + centre).to_array() }
    });
    Ok(mesh.with_positions(moved.collect())?)
}
