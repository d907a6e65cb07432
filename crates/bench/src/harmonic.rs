//! Systems of k-harmonic smoothing, as in Jacobson's `sparse-solver-benchmark`.

use anyhow::{Context as _, Result, ensure};
use fairing_mesh::{TriMesh, io};
use fairing_operators::{LumpedArea, cotan_stiffness, lumped_mass};
use fairing_sparse::{
    Cholesky, LaplacianPower, Ldlt, Mass, Ordering, SparseMatrix, SymbolicCholesky, combine,
    from_triplets, larger,
};

use crate::task::{Job, Stopwatch, Work, fingerprint, forgetful, work};

/// A system with the solution `u` of `(Wᵏ + M) u = M x`, with Wᵏ = S (M⁻¹S)ᵏ⁻¹, mixed areas in M,
/// and the positions x in three columns.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum System {
    /// The system as it stands, of order k, positive definite.
    Power(u32),
    /// With an unknown for each power of M⁻¹S below k, indefinite: the unknowns of a vertex stand
    /// together.
    ///
    /// ```text
    /// k = 2:  ⎡M  S⎤    k = 3:  ⎡M     S⎤
    ///         ⎣S −M⎦            ⎢   S −M⎥
    ///                           ⎣S −M   ⎦
    /// ```
    Mixed(u32),
}

/// The systems by name.
pub(crate) const SYSTEMS: [(&str, System); 5] = [
    ("harmonic", System::Power(1)),
    ("biharmonic", System::Power(2)),
    ("triharmonic", System::Power(3)),
    ("mixed biharmonic", System::Mixed(2)),
    ("mixed triharmonic", System::Mixed(3)),
];

/// Corrections of a solution at most.
const CORRECTIONS: usize = 5;

/// A solution whose error is below this is not corrected.
const ACCURATE: f64 = 1e-14;

/// The task: assembly, factorisation, and a solution that is corrected until its error is that of
/// rounding. `--k` is the place of the system in the list, from 1.
pub(crate) fn harmonic(job: &Job) -> Result<Work> {
    let system = SYSTEMS.get(job.k.wrapping_sub(1)).with_context(|| {
        let names: Vec<_> = SYSTEMS.iter().map(|(name, _)| *name).collect();
        format!("--k {} is not between 1 and {}: {}", job.k, SYSTEMS.len(), names.join(", "))
    })?;
    let (mesh, system) = (io::read(&job.input)?.mesh, system.1);
    work(move |watch| {
        let equations = Equations::new(&forgetful(&mesh, watch)?, system, watch)?;
        let solved = equations.solve(watch)?;
        let vertices = mesh.vertex_count();
        Ok(move || {
            let unknowns = solved.x.len() / vertices;
            let u = solved.x.iter().step_by(unknowns);
            Ok(fingerprint! {
                entries: solved.entries,
                sum_squares: u.flatten().map(|x| x * x).sum::<f64>(),
                error_first: solved.errors[0],
                error: solved.errors.last(),
                corrections: solved.errors.len() - 1,
            })
        })
    })
}

/// A matrix and three right-hand sides.
pub(crate) struct Equations {
    pub(crate) matrix: SparseMatrix,
    pub(crate) right: Vec<[f64; 3]>,
    /// The pattern of S, and the number of unknowns of each vertex.
    pattern: SparseMatrix,
    unknowns: usize,
    is_definite: bool,
}

/// A solution.
pub(crate) struct Solved {
    pub(crate) x: Vec<[f64; 3]>,
    /// The number of entries of the factor.
    pub(crate) entries: usize,
    /// The error of the first solution, and after each correction.
    pub(crate) errors: Vec<f64>,
}

/// A factor of either kind.
enum Factor {
    Definite(Cholesky),
    Indefinite(Ldlt),
}

impl Factor {
    fn solve(&self, b: &[[f64; 3]]) -> Vec<[f64; 3]> {
        match self {
            Self::Definite(factor) => factor.solve_points(b),
            Self::Indefinite(factor) => factor.solve_points(b),
        }
    }
}

impl Equations {
    pub(crate) fn new(mesh: &TriMesh, system: System, watch: &mut Stopwatch) -> Result<Self> {
        let assemble = || {
            let s = cotan_stiffness(mesh)?;
            let m = lumped_mass(mesh, LumpedArea::Mixed)?;
            ensure!(m.iter().all(|m| *m > 0.0), "a vertex has no area");
            let (unknowns, is_definite) = match system {
                System::Power(_) => (1, true),
                System::Mixed(order) => (order as usize, false),
            };
            let matrix = match system {
                System::Power(order) => {
                    let w = LaplacianPower::new(&s, &m, order).matrix();
                    let transpose = w.transpose_view().to_csr();
                    // Exactly symmetric.
                    combine(1.0, Mass::Lumped(&m), 0.5, &(&w + &transpose))
                }
                System::Mixed(_) => mixed(&s, &m, unknowns)?,
            };
            let mut right = vec![[0.0; 3]; unknowns * m.len()];
            for (i, (m, p)) in m.iter().zip(mesh.positions()).enumerate() {
                right[unknowns * i] = p.map(|x| m * x);
            }
            Ok(Self { matrix, right, pattern: s, unknowns, is_definite })
        };
        watch.phase("assemble", assemble)
    }

    /// Solves and corrects. The phase `factor` includes the ordering, `solve` the corrections.
    pub(crate) fn solve(&self, watch: &mut Stopwatch) -> Result<Solved> {
        let (entries, factor) = watch.phase("factor", || self.factorize())?;
        let solve = || {
            let mut x = factor.solve(&self.right);
            let mut errors = vec![];
            loop {
                let (rest, error) = self.rest(&x);
                errors.push(error);
                if errors.len() > CORRECTIONS || error < ACCURATE {
                    return Solved { x, entries, errors };
                }
                for (x, d) in x.iter_mut().zip(factor.solve(&rest)) {
                    *x = [0, 1, 2].map(|k| x[k] + d[k]);
                }
            }
        };
        Ok(watch.phase("solve", solve))
    }

    fn factorize(&self) -> Result<(usize, Factor)> {
        // The graph of the vertices has the separators, and no leading block is singular as long
        // as the unknowns of a vertex follow each other.
        let vertices = SymbolicCholesky::new(&self.pattern, Ordering::NestedDissection)?;
        let n = self.unknowns as u32;
        let order = vertices.order().iter().flat_map(|v| (0..n).map(move |k| n * v + k)).collect();
        let symbolic = SymbolicCholesky::new(&self.matrix, Ordering::Custom(order))?;
        let factor = if self.is_definite {
            Factor::Definite(symbolic.factorize(&self.matrix)?)
        } else {
            Factor::Indefinite(symbolic.factorize_indefinite(&self.matrix)?)
        };
        Ok((symbolic.factor_entries(), factor))
    }

    /// b − A x and the componentwise relative backward error of x, the largest of |b − A x|ᵢ / (|A|
    /// |x| + |b|)ᵢ: the least relative change of entries of A and b that makes x exact. Source:
    /// [oettli1964].
    ///
    /// [oettli1964]: https://doi.org/10.1007/BF01386090
    pub(crate) fn rest(&self, x: &[[f64; 3]]) -> (Vec<[f64; 3]>, f64) {
        let mut worst = 0.0;
        let rest = self.matrix.outer_iterator().zip(&self.right).map(|(row, b)| {
            let (mut rest, mut sizes) = (*b, b.map(f64::abs));
            for (j, a) in row.iter() {
                for k in 0..3 {
                    let product = a * x[j][k];
                    rest[k] -= product;
                    sizes[k] += product.abs();
                }
            }
            for k in 0..3 {
                if sizes[k] > 0.0 || sizes[k].is_nan() {
                    worst = larger(worst, rest[k].abs() / sizes[k]);
                }
            }
            rest
        });
        let rest = rest.collect();
        (rest, worst)
    }
}

/// The matrix of a mixed system.
fn mixed(s: &SparseMatrix, m: &[f64], unknowns: usize) -> Result<SparseMatrix> {
    let last = unknowns - 1;
    let mut triplets = vec![];
    let mut put = |i: usize, j: usize, value: f64| triplets.push((i as u32, j as u32, value));
    for (i, row) in s.outer_iterator().enumerate() {
        put(unknowns * i, unknowns * i, m[i]);
        for (j, value) in row.iter() {
            // The blocks of S stand on the other diagonal, those of −M below it.
            for k in 0..unknowns {
                put(unknowns * i + k, unknowns * j + last - k, *value);
            }
        }
        for k in 1..unknowns {
            put(unknowns * i + k, unknowns * i + unknowns - k, -m[i]);
        }
    }
    let n = unknowns * m.len();
    Ok(from_triplets((n, n), &triplets)?)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The coordinates of a sphere are eigenvectors with w near 2: u = x / (1 + 2ᵏ), in both forms,
    /// and the errors are those of rounding.
    #[test]
    fn both_forms_have_one_solution() {
        let mesh = fairing_shapes::icosphere(4);
        for (name, system) in SYSTEMS {
            let watch = &mut Stopwatch::default();
            let equations = Equations::new(&mesh, system, watch).unwrap();
            let solved = equations.solve(watch).unwrap();
            let error = *solved.errors.last().unwrap();
            assert!(error < 1e-13, "{name}: {:?}", solved.errors);
            let (System::Power(order) | System::Mixed(order)) = system;
            let squares: f64 =
                solved.x.iter().step_by(equations.unknowns).flatten().map(|x| x * x).sum();
            let expected = mesh.vertex_count() as f64 / (1.0 + 2f64.powi(order as i32)).powi(2);
            assert!((squares / expected - 1.0).abs() < 0.01, "{name}: {squares} {expected}");
        }
    }

    /// The error of a solution that is wrong in one number is large.
    #[test]
    fn a_wrong_solution_is_seen() {
        let mesh = fairing_shapes::icosphere(2);
        let watch = &mut Stopwatch::default();
        let equations = Equations::new(&mesh, System::Mixed(3), watch).unwrap();
        let mut x = equations.solve(watch).unwrap().x;
        x[17][1] += 1e-6;
        assert!(equations.rest(&x).1 > 1e-8);
        x[17][1] = f64::NAN;
        assert!(equations.rest(&x).1.is_nan());
    }
}
