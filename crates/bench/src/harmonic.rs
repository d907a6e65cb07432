//! Systems of k-harmonic smoothing, as in Jacobson's `sparse-solver-benchmark`.

use anyhow::{Context as _, Result, ensure};
use fairing_mesh::{TriMesh, io};
use fairing_operators::{LumpedArea, cotan_stiffness, lumped_mass};
use fairing_sparse::{
    LaplacianPower, Ldlt, Mass, Ordering, SparseMatrix, SymbolicCholesky, combine, from_triplets,
    larger,
};

use crate::task::{Job, Stopwatch, Work, fingerprint, forgetful, work};

/// A form of `(Wᵏ + M) u = M x` with Wᵏ = S (M⁻¹S)ᵏ⁻¹, mixed areas in M, and the positions x in
/// three columns.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum System {
    /// As it stands, of order k, positive definite.
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

/// The task: assembly, factorisation, and a solution that is corrected until its backward error is
/// that of rounding. `--k` is the place of the system in the list, from 1.
///
/// A small backward error does not mean an accurate solution: on an armadillo of 173 thousand
/// vertices in a unit box, the two triharmonic systems have errors of 10⁻¹⁵ and solutions of which
/// no digit agrees.
pub(crate) fn harmonic(job: &Job) -> Result<Work> {
    let system = SYSTEMS.get(job.k.wrapping_sub(1)).with_context(|| {
        let names: Vec<_> = SYSTEMS.iter().map(|(name, _)| *name).collect();
        format!("--k {} is not between 1 and {}: {}", job.k, SYSTEMS.len(), names.join(", "))
    })?;
    let (mesh, system) = (io::read(&job.input)?.mesh, system.1);
    work(move |watch| {
        let equations = Equations::new(&forgetful(&mesh, watch)?, system, watch)?;
        let stored = watch.phase("assemble", || equations.stored())?;
        let solved = equations.solve(&stored, watch)?;
        Ok(move || {
            let u = solved.x.iter().step_by(equations.unknowns());
            Ok(fingerprint! {
                entries: solved.entries,
                sum_squares: u.flatten().map(|x| x * x).sum::<f64>(),
                error: stored.rest(&solved.x).1,
                corrections: solved.corrections,
            })
        })
    })
}

/// The operators of a system.
pub(crate) struct Equations {
    stiffness: SparseMatrix,
    mass: Vec<f64>,
    positions: Vec<[f64; 3]>,
    system: System,
}

/// A matrix and three right-hand sides.
pub(crate) struct Stored {
    pub(crate) matrix: SparseMatrix,
    pub(crate) right: Vec<[f64; 3]>,
}

/// A solution.
pub(crate) struct Solved {
    pub(crate) x: Vec<[f64; 3]>,
    /// The number of entries of the factor.
    pub(crate) entries: usize,
    pub(crate) corrections: usize,
}

impl Equations {
    pub(crate) fn new(mesh: &TriMesh, system: System, watch: &mut Stopwatch) -> Result<Self> {
        let assemble = || {
            let stiffness = cotan_stiffness(mesh)?;
            let mass = lumped_mass(mesh, LumpedArea::Mixed)?;
            ensure!(mass.iter().all(|m| *m > 0.0), "a vertex has no area");
            Ok(Self { stiffness, mass, positions: mesh.positions().to_vec(), system })
        };
        watch.phase("assemble", assemble)
    }

    /// The number of unknowns of a vertex.
    fn unknowns(&self) -> usize {
        if let System::Mixed(order) = self.system { order as usize } else { 1 }
    }

    /// The system as a matrix, exactly symmetric.
    pub(crate) fn stored(&self) -> Result<Stored> {
        let (s, m) = (&self.stiffness, &self.mass[..]);
        let matrix = match self.system {
            System::Power(order) => {
                let w = LaplacianPower::new(s, m, order).matrix();
                let transpose = w.transpose_view().to_csr();
                combine(1.0, Mass::Lumped(m), 0.5, &(&w + &transpose))
            }
            System::Mixed(order) => mixed(s, m, order as usize)?,
        };
        let weighted = m.iter().zip(&self.positions).map(|(m, p)| p.map(|x| m * x));
        Ok(Stored { matrix, right: spread(weighted, self.unknowns()) })
    }

    /// Solves and corrects. The phase `factor` includes the ordering, `solve` the corrections.
    pub(crate) fn solve(&self, stored: &Stored, watch: &mut Stopwatch) -> Result<Solved> {
        let (entries, factor) = watch.phase("factor", || self.factorize(stored))?;
        let solve = || {
            let (mut x, mut corrections) = (factor.solve_points(&stored.right), 0);
            loop {
                let (rest, error) = stored.rest(&x);
                if corrections == CORRECTIONS || error < ACCURATE {
                    return Solved { x, entries, corrections };
                }
                for (x, d) in x.iter_mut().zip(factor.solve_points(&rest)) {
                    *x = [0, 1, 2].map(|k| x[k] + d[k]);
                }
                corrections += 1;
            }
        };
        Ok(watch.phase("solve", solve))
    }

    /// The factor, and the number of its entries. It is that of an indefinite matrix also for the
    /// powers: rounded, the triharmonic matrix of a large mesh is no longer positive definite.
    fn factorize(&self, stored: &Stored) -> Result<(usize, Ldlt)> {
        let ordering = match self.system {
            System::Power(_) => Ordering::LeastFill,
            System::Mixed(unknowns) => {
                // The graph of the vertices has the separators, and no leading block is singular
                // as long as the unknowns of a vertex follow each other.
                let vertices = SymbolicCholesky::new(&self.stiffness, Ordering::LeastFill)?;
                let all = |v: &u32| (unknowns * v)..unknowns * (v + 1);
                Ordering::Custom(vertices.order().iter().flat_map(all).collect())
            }
        };
        let symbolic = SymbolicCholesky::new(&stored.matrix, ordering)?;
        let factor = symbolic.factorize_indefinite(&stored.matrix)?;
        Ok((symbolic.factor_entries(), factor))
    }
}

/// The rows, each followed by zeros up to `unknowns` rows.
fn spread(rows: impl Iterator<Item = [f64; 3]>, unknowns: usize) -> Vec<[f64; 3]> {
    let zeros = move || std::iter::repeat_n([0.0; 3], unknowns - 1);
    rows.flat_map(|row| std::iter::once(row).chain(zeros())).collect()
}

impl Stored {
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

    /// The coordinates of a sphere are eigenvectors with w near 2: u = x / (1 + 2ᵏ). Both forms
    /// have this solution to all digits, and errors of rounding.
    #[test]
    fn both_forms_have_one_solution() {
        let mesh = fairing_shapes::icosphere(4);
        let mut by_order = [const { vec![] }; 4];
        for (name, system) in SYSTEMS {
            let watch = &mut Stopwatch::default();
            let equations = Equations::new(&mesh, system, watch).unwrap();
            let stored = equations.stored().unwrap();
            let solved = equations.solve(&stored, watch).unwrap();
            let error = stored.rest(&solved.x).1;
            assert!(error < 1e-14, "{name}: {error}");
            let (System::Power(order) | System::Mixed(order)) = system;
            let order = order as usize;
            let u: Vec<[f64; 3]> = solved.x.iter().step_by(equations.unknowns()).copied().collect();
            let squares: f64 = u.as_flattened().iter().map(|x| x * x).sum();
            let expected = mesh.vertex_count() as f64 / (1.0 + 2f64.powi(order as i32)).powi(2);
            assert!((squares / expected - 1.0).abs() < 0.01, "{name}: {squares} {expected}");
            by_order[order].push(u);
        }
        for [power, mixed] in by_order.into_iter().filter_map(|both| <[_; 2]>::try_from(both).ok())
        {
            let pairs = power.as_flattened().iter().zip(mixed.as_flattened());
            let apart = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, larger);
            assert!(apart < 1e-9, "{apart}");
        }
    }

    /// The error of a solution that is wrong in one number is large.
    #[test]
    fn a_wrong_solution_is_seen() {
        let mesh = fairing_shapes::icosphere(2);
        let watch = &mut Stopwatch::default();
        let equations = Equations::new(&mesh, System::Mixed(3), watch).unwrap();
        let stored = equations.stored().unwrap();
        let mut x = equations.solve(&stored, watch).unwrap().x;
        x[17][1] += 1e-6;
        assert!(stored.rest(&x).1 > 1e-8);
        x[17][1] = f64::NAN;
        assert!(stored.rest(&x).1.is_nan());
    }
}
