//! Eigenpairs and factorisations.

use anyhow::{Context as _, Result};
use fairing_mesh::{TriMesh, io};
use fairing_operators::{LumpedArea, cotan_stiffness, lumped_mass};
use fairing_sparse::{
    EigenOptions, EigenPairs, Mass, Ordering, SymbolicCholesky, combine, multiply_points,
    smallest_eigenpairs,
};
use glam::DVec3;

use super::stopwatch::Stopwatch;
use super::task::{Fingerprint, Job, Task, Work, fingerprint, forgetful};

/// The tolerance of the comparison.
const TOLERANCE: f64 = 1e-8;

/// The k smallest eigenpairs of the cotangent stiffness and the barycentric mass.
pub(super) struct Eigs;

impl Task for Eigs {
    fn name(&self) -> &'static str {
        "eigs"
    }

    fn about(&self) -> &'static str {
        "k smallest eigenpairs of S u = w M u, certified"
    }

    fn prepare(&self, job: &Job) -> Result<Box<dyn Work>> {
        let mesh = io::read(&job.input)?.mesh;
        Ok(Box::new(Solving { mesh, k: job.k, result: None }))
    }
}

struct Solving {
    mesh: TriMesh,
    k: usize,
    result: Option<EigenPairs>,
}

impl Work for Solving {
    fn run(&mut self, watch: &mut Stopwatch) -> Result<()> {
        self.result = None;
        let mesh = forgetful(&self.mesh, watch)?;
        let assemble =
            || anyhow::Ok((cotan_stiffness(&mesh)?, lumped_mass(&mesh, LumpedArea::Barycentric)?));
        let (s, m) = watch.phase("assemble", assemble)?;
        // Measured residuals stay within ten times the tolerance of the solver.
        let options = EigenOptions { tolerance: 0.1 * TOLERANCE, ..Default::default() };
        let solve = || smallest_eigenpairs(&s, Mass::Lumped(&m), self.k, &options);
        self.result = Some(watch.phase("solve", solve)?);
        Ok(())
    }

    fn fingerprint(&mut self) -> Result<Fingerprint> {
        let pairs = self.result.as_ref().context("nothing was solved")?;
        let largest = pairs.values.last().copied().unwrap_or(0.0).max(f64::MIN_POSITIVE);
        let worst = pairs.residuals.iter().fold(0.0, |m: f64, r| m.max(*r)) / largest;
        Ok(fingerprint! {
            eigenvalues: pairs.values[..pairs.values.len().min(10)],
            eig_sum: pairs.values.iter().sum::<f64>(),
            converged: pairs.values.len(),
            residual: worst,
            certified: pairs.certified,
        })
    }
}

/// Analysis, factorisation of M + λh²S and a solution for three right-hand sides.
pub(super) struct Factor;

impl Task for Factor {
    fn name(&self) -> &'static str {
        "factor"
    }

    fn about(&self) -> &'static str {
        "Cholesky of M + λh²S: analyse, factorise, solve for the positions"
    }

    fn prepare(&self, job: &Job) -> Result<Box<dyn Work>> {
        let mesh = io::read(&job.input)?.mesh;
        Ok(Box::new(Factoring { mesh, lambda: job.lambda, result: None }))
    }
}

struct Factoring {
    mesh: TriMesh,
    lambda: f64,
    result: Option<Factored>,
}

struct Factored {
    entries: usize,
    solution: Vec<[f64; 3]>,
    residual: f64,
}

impl Work for Factoring {
    fn run(&mut self, watch: &mut Stopwatch) -> Result<()> {
        self.result = None;
        let mesh = forgetful(&self.mesh, watch)?;
        let h = mesh.mean_edge_length();
        let matrix = watch.phase("assemble", || {
            let m = lumped_mass(&mesh, LumpedArea::Barycentric)?;
            anyhow::Ok(combine(
                1.0,
                Mass::Lumped(&m),
                self.lambda * h * h,
                &cotan_stiffness(&mesh)?,
            ))
        })?;
        let symbolic =
            watch.phase("analyse", || SymbolicCholesky::new(&matrix, Ordering::default()))?;
        let factor = watch.phase("factor", || symbolic.factorize(&matrix))?;
        let solution = watch.phase("solve", || factor.solve_points(mesh.positions()));
        let back = multiply_points(&matrix, &solution);
        let square = |points: &[[f64; 3]]| points.as_flattened().iter().map(|x| x * x).sum::<f64>();
        let rest: Vec<[f64; 3]> = back
            .iter()
            .zip(mesh.positions())
            .map(|(&a, &b)| (DVec3::from(a) - DVec3::from(b)).to_array())
            .collect();
        let residual = (square(&rest) / square(mesh.positions())).sqrt();
        let entries = symbolic.factor_entries();
        self.result = Some(Factored { entries, solution, residual });
        Ok(())
    }

    fn fingerprint(&mut self) -> Result<Fingerprint> {
        let result = self.result.as_ref().context("nothing was factorised")?;
        Ok(fingerprint! {
            entries: result.entries,
            sum_squares: result.solution.as_flattened().iter().map(|x| x * x).sum::<f64>(),
            residual: result.residual,
        })
    }
}
