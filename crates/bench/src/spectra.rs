//! Eigenpairs and factorisations.

use anyhow::Result;
use fairing_mesh::io;
use fairing_operators::{LumpedArea, cotan_stiffness, lumped_mass};
use fairing_sparse::{
    EigenOptions, Mass, Ordering, SymbolicCholesky, combine, larger, multiply_points,
    smallest_eigenpairs,
};
use glam::DVec3;

use crate::task::{Job, Work, fingerprint, forgetful, work};

/// The tolerance of the comparison.
const TOLERANCE: f64 = 1e-8;

/// The k smallest eigenpairs of the cotangent stiffness and the barycentric mass.
pub(crate) fn eigs(job: &Job) -> Result<Work> {
    let (mesh, k) = (io::read(&job.input)?.mesh, job.k);
    work(move |watch| {
        let mesh = forgetful(&mesh, watch)?;
        let (s, m) = watch.phase("assemble", || {
            anyhow::Ok((cotan_stiffness(&mesh)?, lumped_mass(&mesh, LumpedArea::Barycentric)?))
        })?;
        // Measured residuals stay within ten times the tolerance of the solver.
        let options = EigenOptions { tolerance: 0.1 * TOLERANCE, ..Default::default() };
        let solve = || smallest_eigenpairs(&s, Mass::Lumped(&m), k, &options);
        let pairs = watch.phase("solve", solve)?;
        Ok(move || {
            let largest = pairs.values.last().copied().unwrap_or(0.0).max(f64::MIN_POSITIVE);
            let worst = pairs.residuals.iter().fold(0.0, |m, r| larger(m, *r)) / largest;
            Ok(fingerprint! {
                eigenvalues: pairs.values[..pairs.values.len().min(10)],
                eig_sum: pairs.values.iter().sum::<f64>(),
                converged: pairs.values.len(),
                residual: worst,
                certified: pairs.certified,
            })
        })
    })
}

/// Analysis, factorisation of M + λh²S and a solution for three right-hand sides.
pub(crate) fn factor(job: &Job) -> Result<Work> {
    let (mesh, lambda) = (io::read(&job.input)?.mesh, job.lambda);
    work(move |watch| {
        let mesh = forgetful(&mesh, watch)?;
        let h = mesh.mean_edge_length();
        let matrix = watch.phase("assemble", || {
            let m = lumped_mass(&mesh, LumpedArea::Barycentric)?;
            let stiffness = cotan_stiffness(&mesh)?;
            anyhow::Ok(combine(1.0, Mass::Lumped(&m), lambda * h * h, &stiffness))
        })?;
        let symbolic =
            watch.phase("analyse", || SymbolicCholesky::new(&matrix, Ordering::default()))?;
        let factor = watch.phase("factor", || symbolic.factorize(&matrix))?;
        let solution = watch.phase("solve", || factor.solve_points(mesh.positions()));
        Ok(move || {
            let rest: Vec<[f64; 3]> = multiply_points(&matrix, &solution)
                .iter()
                .zip(mesh.positions())
                .map(|(&a, &b)| (DVec3::from(a) - DVec3::from(b)).to_array())
                .collect();
            Ok(fingerprint! {
                entries: symbolic.factor_entries(),
                sum_squares: square(&solution),
                residual: (square(&rest) / square(mesh.positions())).sqrt(),
            })
        })
    })
}

fn square(points: &[[f64; 3]]) -> f64 {
    points.as_flattened().iter().map(|x| x * x).sum()
}
