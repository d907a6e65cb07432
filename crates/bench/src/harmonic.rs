//! Systems of k-harmonic smoothing, as in Jacobson's `sparse-solver-benchmark`.

use anyhow::{Result, ensure};
use fairing_mesh::{TriMesh, io};
use fairing_operators::{LumpedArea, cotan_stiffness, lumped_mass};
use fairing_sparse::{
    Cholesky, LaplacianPower, Mass, Ordering, SparseMatrix, SymbolicCholesky, combine, larger,
    multiply_points,
};

use crate::task::{Job, Stopwatch, Work, fingerprint, forgetful, work};

/// The largest order: matrices of the fourth have 60 entries in a row.
const MAX_ORDER: usize = 3;

/// Corrections of the solution.
const CORRECTIONS: usize = 3;

/// `(Wᵏ + M) u = M x` with Wᵏ = S (M⁻¹S)ᵏ⁻¹, mixed areas in M, and the positions x in three
/// columns: assembly, factorisation, a solution, and its refinement.
pub(crate) fn harmonic(job: &Job) -> Result<Work> {
    ensure!(
        (1..=MAX_ORDER).contains(&job.k),
        "the order, --k {}, is not between 1 and {MAX_ORDER}",
        job.k
    );
    let (mesh, order) = (io::read(&job.input)?.mesh, job.k as u32);
    work(move |watch| {
        let solved = solve(&mesh, order, watch)?;
        Ok(move || {
            Ok(fingerprint! {
                entries: solved.entries,
                sum_squares: solved.sum_squares,
                residual: solved.first,
                residual_refined: solved.refined,
                change_by_refinement: solved.change,
            })
        })
    })
}

struct Solved {
    entries: usize,
    /// Largest entry of `M x − (Wᵏ + M) u` for the solution of the factor alone.
    first: f64,
    /// The same for the refined solution, kept as the sum of two numbers.
    refined: f64,
    /// Largest change of a coordinate by refinement, relative to the extent.
    change: f64,
    sum_squares: f64,
}

fn solve(mesh: &TriMesh, order: u32, watch: &mut Stopwatch) -> Result<Solved> {
    let mesh = forgetful(mesh, watch)?;
    let (s, m, matrix) = watch.phase("assemble", || {
        let s = cotan_stiffness(&mesh)?;
        let m = lumped_mass(&mesh, LumpedArea::Mixed)?;
        let matrix = system(&LaplacianPower::new(&s, &m, order), &m);
        anyhow::Ok((s, m, matrix))
    })?;
    let right = weighted(&m, mesh.positions());
    let analyse = || SymbolicCholesky::new(&matrix, Ordering::default());
    let symbolic = watch.phase("factor", analyse)?;
    let factor = watch.phase("factor", || symbolic.factorize(&matrix))?;
    let first = watch.phase("solve", || factor.solve_points(&right));
    let power = LaplacianPower::new(&s, &m, order);
    let start = difference(&right, &multiply_points(&matrix, &first));
    let refined = watch.phase("refine", || refine(&factor, &power, &m, mesh.positions(), &first));
    let change = largest(&difference(&refined.high, &first)) / extent(&mesh);
    Ok(Solved {
        entries: symbolic.factor_entries(),
        first: largest(&start),
        refined: refined.residual,
        change,
        sum_squares: refined.high.as_flattened().iter().map(|x| x * x).sum(),
    })
}

/// `Wᵏ + M`, exactly symmetric.
fn system(power: &LaplacianPower<'_>, m: &[f64]) -> SparseMatrix {
    let w = power.matrix();
    let transpose = w.transpose_view().to_csr();
    combine(1.0, Mass::Lumped(m), 0.5, &(&w + &transpose))
}

/// A solution as a sum of two numbers, and its largest residual.
struct Refined {
    high: Vec<[f64; 3]>,
    residual: f64,
}

/// Corrects the solution by residuals in double-double arithmetic. Entries of Wᵏ grow like the
/// area of a vertex to the power 1 − k, so a solution rounded to a double leaves a residual that
/// no factor removes: the corrections are kept apart, and the sum is the solution.
fn refine(
    factor: &Cholesky,
    power: &LaplacianPower<'_>,
    m: &[f64],
    x: &[[f64; 3]],
    first: &[[f64; 3]],
) -> Refined {
    let mut high = first.to_vec();
    let mut low = vec![[0.0; 3]; x.len()];
    let mut residual = left(power, m, x, &high, &low);
    for _ in 0..CORRECTIONS {
        let correction = factor.solve_points(&residual);
        for ((h, l), d) in high.iter_mut().zip(&mut low).zip(&correction) {
            for k in 0..3 {
                let part = l[k] + d[k];
                let sum = h[k] + part;
                l[k] = part - (sum - h[k]);
                h[k] = sum;
            }
        }
        residual = left(power, m, x, &high, &low);
    }
    Refined { high, residual: largest(&residual) }
}

/// `M (x − high) − Wᵏ high − Wᵏ low − M low`.
fn left(
    power: &LaplacianPower<'_>,
    m: &[f64],
    x: &[[f64; 3]],
    high: &[[f64; 3]],
    low: &[[f64; 3]],
) -> Vec<[f64; 3]> {
    let (a, b) = (power.apply(high), power.apply(low));
    let parts = x.iter().zip(high).zip(low).zip(a).zip(b).zip(m);
    parts
        .map(|(((((x, h), l), a), b), m)| {
            [0, 1, 2].map(|k| (m * ((x[k] - h[k]) - l[k]) - a[k]) - b[k])
        })
        .collect()
}

fn weighted(m: &[f64], x: &[[f64; 3]]) -> Vec<[f64; 3]> {
    m.iter().zip(x).map(|(m, p)| p.map(|x| m * x)).collect()
}

fn difference(a: &[[f64; 3]], b: &[[f64; 3]]) -> Vec<[f64; 3]> {
    a.iter().zip(b).map(|(a, b)| [0, 1, 2].map(|k| a[k] - b[k])).collect()
}

fn largest(points: &[[f64; 3]]) -> f64 {
    points.as_flattened().iter().fold(0.0, |m, x| larger(m, x.abs()))
}

fn extent(mesh: &TriMesh) -> f64 {
    mesh.bounding_box()
        .map_or(1.0, |[low, high]| (0..3).map(|k| high[k] - low[k]).fold(0.0, larger))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Refinement lowers the residuals of all orders.
    #[test]
    fn refinement_lowers_the_residual() {
        let mesh = fairing_shapes::icosphere(5);
        for order in 1..=3 {
            let solved = solve(&mesh, order, &mut Stopwatch::default()).unwrap();
            assert!(solved.refined < 1e-3 * solved.first, "{} {}", solved.refined, solved.first);
            assert!(solved.change < 1e-4);
            // The coordinates of a sphere are eigenvectors with w near 2: u = x / (1 + 2ᵏ).
            let expected = mesh.vertex_count() as f64 / (1.0 + 2f64.powi(order as i32)).powi(2);
            assert!((solved.sum_squares / expected - 1.0).abs() < 0.01, "order {order}");
        }
    }
}
