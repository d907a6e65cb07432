//! One step of inverse iteration on converged vectors, and the residual that rounding leaves.
//!
//! For a Ritz pair of A = (S − σM)⁻¹ M, A φ − θ φ = Q z, and φ' = A φ / θ has (S − λM) φ' = −M Q z
//! / θ². If ‖z‖ is at the level of rounding, so is the residual of φ', whereas the residual of φ
//! magnifies rough errors by up to the largest eigenvalue. The step matters on meshes with a few
//! tiny masses or huge weights.

use crate::direct::factor::LANES;
use crate::eigen::basis::{self, Block, Small};
use crate::eigen::operator::ShiftInvert;
use crate::eigen::problem::Problem;

/// Attainable residual in roundings: sums over some ten entries of a row, and the errors of a
/// factorisation.
const ATTAINABLE: f64 = 64.0;

/// The eigenvalues of a block; zero in empty lanes.
pub(crate) fn lanes_of(lambdas: &[f64], block: usize) -> [f64; LANES] {
    std::array::from_fn(|lane| lambdas.get(block * LANES + lane).copied().unwrap_or(0.0))
}

/// ‖S' φ − λ' M' φ‖ in the M'⁻¹ norm of each vector of a block.
pub(crate) fn residuals(problem: &Problem, block: &Block, lambda: &[f64; LANES]) -> [f64; LANES] {
    let square = problem.inverse_gram(&problem.residual(block, lambda));
    std::array::from_fn(|j| square[j][j].max(0.0).sqrt())
}

/// The residual that rounding alone may leave: this many ε ‖|S'| |φ| + |λ'| M' |φ|‖ in the M'⁻¹
/// norm.
pub(crate) fn attainable(problem: &Problem, block: &Block, lambda: &[f64; LANES]) -> [f64; LANES] {
    let square = problem.inverse_gram(&problem.magnitude(block, lambda));
    std::array::from_fn(|j| ATTAINABLE * f64::EPSILON * square[j][j].max(0.0).sqrt())
}

/// Removes the rough errors of vectors whose residual is above `goal`; others change by rounding.
pub(crate) fn polish(operator: &ShiftInvert<'_>, lambdas: &[f64], blocks: &mut [Block], goal: f64) {
    let problem = operator.problem;
    let mut changed = false;
    for (b, block) in blocks.iter_mut().enumerate() {
        let lambda = lanes_of(lambdas, b);
        let before = residuals(problem, block, &lambda);
        if before.iter().all(|r| *r <= goal) {
            continue;
        }
        let mut better = operator.apply_refined(block);
        let scale = problem.squares(&better).map(|s| if s > 0.0 { 1.0 / s.sqrt() } else { 0.0 });
        // With σ above λ the operator flips the sign.
        let sign: [f64; LANES] =
            std::array::from_fn(|j| if lambda[j] < operator.sigma { -1.0 } else { 1.0 });
        for row in &mut better {
            for j in 0..LANES {
                row[j] *= sign[j] * scale[j];
            }
        }
        let after = residuals(problem, &better, &lambda);
        for j in (0..LANES).filter(|&j| after[j] < before[j] && before[j] > goal) {
            changed = true;
            for (row, better) in block.iter_mut().zip(&better) {
                row[j] = better[j];
            }
        }
        problem.remove_constants(block);
    }
    if changed {
        orthonormalise(problem, blocks);
    }
}

/// V ← V (3 − VᵀM'V) / 2, which squares the deviation from orthonormality: solutions with huge
/// weights deviate by more than ε.
fn orthonormalise(problem: &Problem, blocks: &mut [Block]) {
    let gram: Vec<Vec<Small>> = blocks
        .iter()
        .map(|w| {
            let [column] = problem.mass_products([&*blocks], w);
            column
        })
        .collect();
    let better = basis::combine(blocks, blocks.len(), |u, j| {
        std::array::from_fn(|a| {
            std::array::from_fn(|b| {
                let one = if u == j && a == b { 1.5 } else { 0.0 };
                one - 0.5 * gram[j][u][a][b]
            })
        })
    });
    for (block, better) in blocks.iter_mut().zip(better) {
        *block = better;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mass::{Mass, combine};
    use crate::matrix::SparseMatrix;

    /// A path of 40 rows, pinned at one end.
    fn pinned_path() -> SparseMatrix {
        let n = 40_usize;
        let (mut starts, mut columns, mut values) = (vec![0], vec![], vec![]);
        for i in 0..n {
            for j in [i.wrapping_sub(1), i, i + 1] {
                if j < n {
                    columns.push(j as u32);
                    values.push(if i == j { 2.0 } else { -1.0 });
                }
            }
            starts.push(columns.len() as u32);
        }
        SparseMatrix::new((n, n), starts, columns, values)
    }

    /// Rough errors of 10⁻⁶ disappear, signs stay on both sides of σ, and the attainable residual
    /// is at most some hundred ε for entries of S of size 1.
    #[test]
    fn rough_errors_are_taken_off() {
        let s = combine(1.0, Mass::Lumped(&[0.0; 40]), 1.0, &pinned_path());
        let ones = [1.0; 40];
        let problem = Problem::new(&s, Mass::Lumped(&ones)).unwrap();
        let angle = |k: usize| std::f64::consts::PI * (k + 1) as f64 / 41.0;
        let lambdas: Vec<f64> =
            (0..4).map(|k| (2.0 - 2.0 * angle(k).cos()) / problem.unit).collect();
        let exact: Block = problem
            .order()
            .iter()
            .map(|&row| {
                std::array::from_fn(|k| {
                    let x = (angle(k) * f64::from(row + 1)).sin() * (2.0f64 / 41.0).sqrt();
                    if k < 4 { x * problem.norm_unit() } else { 0.0 }
                })
            })
            .collect();
        let mut rough = exact.clone();
        for (i, row) in rough.iter_mut().enumerate() {
            for value in &mut row[..4] {
                *value += if i % 2 == 0 { 1e-6 } else { -1e-6 };
            }
        }
        let sigma = 0.5 * (lambdas[1] + lambdas[2]);
        let (operator, ..) = ShiftInvert::among(&problem, sigma).unwrap();
        let lanes = lanes_of(&lambdas, 0);
        let before = residuals(&problem, &rough, &lanes);
        let mut blocks = [rough];
        polish(&operator, &lambdas, &mut blocks, 0.0);
        let after = residuals(&problem, &blocks[0], &lanes);
        assert!((0..4).all(|k| after[k] < 0.2 * before[k]), "{before:?} {after:?}");
        for (row, exact) in blocks[0].iter().zip(&exact) {
            assert!((0..LANES).all(|k| (row[k] - exact[k]).abs() < 1e-4), "{row:?} {exact:?}");
        }
        let limits = attainable(&problem, &exact, &lanes);
        assert!(limits[..4].iter().all(|l| (1e-15..1e-12).contains(l)), "{limits:?}");
        assert_eq!(limits[4..], [0.0; 4]);
    }
}
