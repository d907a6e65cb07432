//! The mass matrix of a problem, lumped or consistent, and combinations α M + β S.

use crate::error::SparseError;
use crate::matrix::{Rows, SparseMatrix};
use crate::product;

/// A mass matrix M: diagonal (lumped), or sparse symmetric positive definite (consistent).
#[derive(Debug, Clone, Copy)]
pub enum Mass<'a> {
    /// The diagonal of M.
    Lumped(&'a [f64]),
    /// M itself, both triangles.
    Consistent(&'a SparseMatrix),
}

impl Mass<'_> {
    /// The number of rows of M.
    pub fn len(&self) -> usize {
        match self {
            Self::Lumped(diagonal) => diagonal.len(),
            Self::Consistent(matrix) => matrix.rows(),
        }
    }

    /// Returns true if M has no rows.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The diagonal of M.
    pub fn diagonal(&self) -> Vec<f64> {
        match self {
            Self::Lumped(diagonal) => diagonal.to_vec(),
            Self::Consistent(matrix) => Rows::new(matrix).diagonal(),
        }
    }

    /// M x.
    ///
    /// # Panics
    ///
    /// Panics if `x` has another length than M has rows.
    pub fn times(&self, x: &[f64]) -> Vec<f64> {
        match self {
            Self::Lumped(diagonal) => {
                assert_eq!(diagonal.len(), x.len(), "length of the vector");
                diagonal.iter().zip(x).map(|(m, x)| m * x).collect()
            }
            Self::Consistent(matrix) => product::multiply(matrix, x),
        }
    }

    /// The sum of all entries: the total mass, Σᵢⱼ Mᵢⱼ.
    pub fn total(&self) -> f64 {
        match self {
            Self::Lumped(diagonal) => diagonal.iter().sum(),
            Self::Consistent(matrix) => matrix.data().iter().sum(),
        }
    }

    /// Checks the size against `rows` and that every diagonal entry is positive and finite.
    ///
    /// # Errors
    ///
    /// [`SparseError`] with the first offending row.
    pub fn check(&self, rows: usize) -> Result<(), SparseError> {
        if self.len() != rows {
            return Err(SparseError::MassSize { mass: self.len(), stiffness: rows });
        }
        match self.diagonal().into_iter().enumerate().find(|(_, m)| !(*m > 0.0 && m.is_finite())) {
            Some((row, value)) => Err(SparseError::MassNotPositive { row, value }),
            None => Ok(()),
        }
    }
}

/// α M + β S, on the union of both patterns with the whole diagonal; columns ascend.
///
/// The pattern does not depend on α and β, so that a [`SymbolicCholesky`](crate::SymbolicCholesky)
/// of one combination serves all others.
///
/// # Panics
///
/// Panics if S is not square or the sizes differ.
///
/// # Examples
///
/// ```
/// use fairing_sparse::{Mass, SparseMatrix, combine};
/// let s = SparseMatrix::new((2, 2), vec![0, 2, 4], vec![0, 1, 0, 1], vec![1.0, -1.0, -1.0, 1.0]);
/// let a = combine(2.0, Mass::Lumped(&[10.0, 20.0]), 3.0, &s);
/// assert_eq!(a.data(), [23.0, -3.0, -3.0, 43.0]);
/// ```
pub fn combine(alpha: f64, mass: Mass<'_>, beta: f64, stiffness: &SparseMatrix) -> SparseMatrix {
    let n = stiffness.rows();
    assert_eq!((n, mass.len()), (stiffness.cols(), n), "sizes of the stiffness and the mass");
    let s = Rows::new(stiffness);
    let guess = s.values.len() + n;
    let (mut starts, mut columns, mut values) =
        (Vec::with_capacity(n + 1), Vec::with_capacity(guess), Vec::with_capacity(guess));
    starts.push(0);
    for i in 0..n {
        let row = i as u32;
        let lumped;
        let m = match mass {
            Mass::Lumped(diagonal) => {
                lumped = [diagonal[i]];
                (std::slice::from_ref(&row), &lumped[..])
            }
            Mass::Consistent(matrix) => Rows::new(matrix).row(i),
        };
        merge_row(row, (s.row(i), beta), (m, alpha), &mut columns, &mut values);
        starts.push(columns.len() as u32);
    }
    SparseMatrix::new((n, n), starts, columns, values)
}

type ScaledRow<'a> = ((&'a [u32], &'a [f64]), f64);

/// Appends the sum of two scaled rows, and a zero on the diagonal if neither has an entry there.
fn merge_row(
    row: u32,
    a: ScaledRow<'_>,
    b: ScaledRow<'_>,
    columns: &mut Vec<u32>,
    values: &mut Vec<f64>,
) {
    let (((a_columns, a_values), a_scale), ((b_columns, b_values), b_scale)) = (a, b);
    let (mut i, mut j) = (0, 0);
    let mut diagonal_due = true;
    loop {
        let next_a = a_columns.get(i).copied().unwrap_or(u32::MAX);
        let next_b = b_columns.get(j).copied().unwrap_or(u32::MAX);
        let mut next = next_a.min(next_b);
        if diagonal_due && row <= next {
            next = row;
            diagonal_due = false;
        }
        if next == u32::MAX {
            return;
        }
        let mut value = 0.0;
        if next_a == next {
            value += a_scale * a_values[i];
            i += 1;
        }
        if next_b == next {
            value += b_scale * b_values[j];
            j += 1;
        }
        columns.push(next);
        values.push(value);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rows with and without a diagonal entry, and columns that only one matrix has.
    #[test]
    fn combination_covers_both_patterns_and_the_diagonal() {
        let s = SparseMatrix::new((3, 3), vec![0, 1, 2, 2], vec![1, 0], vec![5.0, 5.0]);
        let m =
            SparseMatrix::new((3, 3), vec![0, 2, 3, 4], vec![0, 2, 1, 0], vec![1.0, 2.0, 1.0, 2.0]);
        let a = combine(10.0, Mass::Consistent(&m), 1.0, &s);
        assert_eq!(a.indptr().raw_storage(), [0, 3, 5, 7]);
        assert_eq!(a.indices(), [0, 1, 2, 0, 1, 0, 2]);
        assert_eq!(a.data(), [10.0, 5.0, 20.0, 5.0, 10.0, 20.0, 0.0]);
    }

    #[test]
    fn bad_masses_are_named() {
        assert_eq!(
            Mass::Lumped(&[1.0, 0.0]).check(2),
            Err(SparseError::MassNotPositive { row: 1, value: 0.0 })
        );
        assert!(matches!(
            Mass::Lumped(&[f64::NAN]).check(1),
            Err(SparseError::MassNotPositive { row: 0, .. })
        ));
        assert_eq!(
            Mass::Lumped(&[1.0]).check(2),
            Err(SparseError::MassSize { mass: 1, stiffness: 2 })
        );
    }
}
