//! The solver backend, faer, for orderings, patterns of factors, and small dense matrices: the only
//! file that names it.
//!
//! faer expects compressed columns; a symmetric CSR matrix is its own CSC form, so sprs arrays are
//! passed without a copy and `Side::Lower` selects one triangle. Everything runs on the calling
//! thread.

use dyn_stack::{MemBuffer, MemStack, StackReq};
use faer::linalg::cholesky::ldlt::{self, factor::LdltError};
use faer::linalg::{evd, matmul, triangular_solve};
use faer::perm::PermRef;
use faer::reborrow::{Reborrow as _, ReborrowMut as _};
use faer::sparse::SymbolicSparseColMatRef;
use faer::sparse::linalg::SupernodalThreshold;
use faer::sparse::linalg::amd;
use faer::sparse::linalg::cholesky::{
    self, CholeskySymbolicParams, SymbolicCholeskyRaw, SymmetricOrdering,
};
use faer::{Accum, ColMut, MatMut, MatRef, Par, Side};

use crate::direct::supernodes::Supernodes;
use crate::matrix::Rows;
use crate::order::larger;

const SIDE: Side = Side::Lower;
const SEQUENTIAL: Par = Par::Seq;

/// Not enough memory, or more entries than `u32` can index.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct TooLarge;

/// A pivot that ends an elimination: its column and value.
pub(crate) type Stop = (usize, f64);

/// Entries of L below this become zero: products of two would be subnormal, where arithmetic is
/// slower by an order of magnitude.
pub(crate) const NEGLIGIBLE: f64 = f64::from_bits((1023 - 800) << 52);

/// Returns true if the pivot ends the elimination.
#[inline(always)]
pub(crate) fn stops(pivot: f64, definite: bool) -> bool {
    pivot == 0.0 || (definite && (pivot < 0.0 || pivot.is_nan()))
}

/// The pattern of the factor for an elimination order and its inverse, in postorder: row
/// `order[k]` of the matrix comes k-th.
pub(crate) fn supernodes(
    rows: Rows<'_>,
    order: &[u32],
    inverse: &[u32],
) -> Result<Supernodes, TooLarge> {
    let ordering = SymmetricOrdering::Custom(PermRef::new_checked(order, inverse, order.len()));
    // Always supernodal: this crate supports no other form, and meshes gain from it. (Zero would
    // exclude diagonal matrices, which need no operations.)
    let params = CholeskySymbolicParams {
        supernodal_flop_ratio_threshold: SupernodalThreshold(-1.0),
        ..Default::default()
    };
    let symbolic = cholesky::factorize_symbolic_cholesky(pattern(rows), SIDE, ordering, params)
        .map_err(|_| TooLarge)?;
    let both = (order, inverse);
    Ok(match symbolic.raw() {
        SymbolicCholeskyRaw::Supernodal(raw) => {
            let node = |s: usize| {
                let columns = raw.supernode_begin()[s] as usize..raw.supernode_end()[s] as usize;
                (columns, raw.supernode(s).pattern())
            };
            Supernodes::new((0..raw.n_supernodes()).map(node), rows, both)
        }
        // Every ratio of operations to entries exceeds the threshold, except 0 / 0 of an empty
        // matrix.
        SymbolicCholeskyRaw::Simplicial(_) => Supernodes::new(std::iter::empty(), rows, both),
    })
}

/// Eliminates the first `width` columns of a matrix with the lower triangle in its first rows:
/// columns of L, with D on the diagonal, take their place. `stride` is the distance of columns.
///
/// # Errors
///
/// The first pivot that is not positive if `definite`, or is zero.
pub(crate) fn eliminate_block(
    values: &mut [f64],
    width: usize,
    stride: usize,
    definite: bool,
) -> Result<(), Stop> {
    let height = values.len() - (width - 1) * stride;
    let block = MatMut::from_column_major_slice_with_stride_mut(values, height, width, stride);
    let (mut triangle, mut below) = block.split_at_row_mut(width);
    let scratch =
        ldlt::factor::cholesky_in_place_scratch::<f64>(width, SEQUENTIAL, Default::default());
    let mut memory = MemBuffer::new(scratch);
    let (regular, own) = Default::default();
    let stack = MemStack::new(&mut memory);
    let done = ldlt::factor::cholesky_in_place(triangle.rb_mut(), regular, SEQUENTIAL, stack, own);
    let end = match done {
        Ok(_) => width,
        Err(LdltError::ZeroPivot { index }) => index + 1,
    };
    for k in 0..end {
        let pivot = triangle[(k, k)];
        if stops(pivot, definite) {
            return Err((k, pivot));
        }
    }
    if end < width || done.is_err() {
        return Err((end - 1, 0.0));
    }
    triangular_solve::solve_unit_lower_triangular_in_place(
        triangle.rb(),
        below.rb_mut().transpose_mut(),
        SEQUENTIAL,
    );
    for k in 0..width {
        let inverse = 1.0 / values[k * stride + k];
        let column = &mut values[k * stride + k + 1..][..height - k - 1];
        column[width - k - 1..].iter_mut().for_each(|l| *l *= inverse);
        for l in column {
            *l = if l.abs() < NEGLIGIBLE { 0.0 } else { *l };
        }
    }
    Ok(())
}

/// C ← C − A Bᵀ for matrices stored by columns, each with the distance of its columns; `size` has
/// the rows and columns of C, and the columns of A and B.
pub(crate) fn subtract_product(
    (c, c_stride): (&mut [f64], usize),
    (a, a_stride): (&[f64], usize),
    (b, b_stride): (&[f64], usize),
    [rows, columns, inner]: [usize; 3],
) {
    let c = MatMut::from_column_major_slice_with_stride_mut(c, rows, columns, c_stride);
    let a = MatRef::from_column_major_slice_with_stride(a, rows, inner, a_stride);
    let b = MatRef::from_column_major_slice_with_stride(b, columns, inner, b_stride);
    matmul::matmul(c, Accum::Add, a, b.transpose(), -1.0, SEQUENTIAL);
}

/// Allocates working memory.
fn allocate(needed: StackReq) -> Result<MemBuffer, TooLarge> {
    MemBuffer::try_new(needed).map_err(|_| TooLarge)
}

/// The minimum degree order of a symmetric matrix: row `order[k]` is eliminated k-th.
pub(crate) fn minimum_degree(rows: Rows<'_>) -> Result<Vec<u32>, TooLarge> {
    let n = rows.count();
    let (mut order, mut inverse) = (vec![0; n], vec![0; n]);
    let mut memory = allocate(amd::order_scratch::<u32>(n, rows.columns.len()))?;
    let stack = MemStack::new(&mut memory);
    amd::order(&mut order, &mut inverse, pattern(rows), Default::default(), stack)
        .map_err(|_| TooLarge)?;
    Ok(order)
}

fn pattern(rows: Rows<'_>) -> SymbolicSparseColMatRef<'_, u32> {
    let n = rows.count();
    SymbolicSparseColMatRef::new_checked(n, n, rows.starts, None, rows.columns)
}

/// The dense eigensolver did not converge.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct NoConvergence;

/// Ascending eigenvalues and consecutive eigenvectors of a dense symmetric `n × n` matrix.
///
/// The matrix is scaled exactly to entries near one: on matrices with entries of 10⁸ the backend
/// loses half of the digits of the eigenvectors (residuals of 10⁻⁶ instead of 10⁻¹³).
pub(crate) fn symmetric_eigen(
    n: usize,
    matrix: &[f64],
) -> Result<(Vec<f64>, Vec<f64>), NoConvergence> {
    let largest = matrix.iter().fold(0.0, |m, v| larger(m, v.abs()));
    if !largest.is_finite() {
        return Err(NoConvergence);
    }
    let unit = if largest > 0.0 { 2f64.powi(libm::log2(largest).floor() as i32) } else { 1.0 };
    let scaled: Vec<f64> = matrix.iter().map(|v| v / unit).collect();
    let (mut values, mut vectors) = (vec![0.0; n], vec![0.0; n * n]);
    let scratch = evd::self_adjoint_evd_scratch::<f64>(
        n,
        evd::ComputeEigenvectors::Yes,
        SEQUENTIAL,
        Default::default(),
    );
    let mut memory = MemBuffer::try_new(scratch).map_err(|_| NoConvergence)?;
    evd::self_adjoint_evd(
        MatRef::from_column_major_slice(&scaled, n, n),
        ColMut::from_slice_mut(&mut values).as_diagonal_mut(),
        Some(MatMut::from_column_major_slice_mut(&mut vectors, n, n)),
        SEQUENTIAL,
        MemStack::new(&mut memory),
        Default::default(),
    )
    .map_err(|_| NoConvergence)?;
    values.iter_mut().for_each(|v| *v *= unit);
    Ok((values, vectors))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_matrix_with_nan_has_no_eigenvalues() {
        for place in 0..4 {
            let mut matrix = [2.0, 1.0, 1.0, 2.0];
            matrix[place] = f64::NAN;
            assert_eq!(symmetric_eigen(2, &matrix), Err(NoConvergence), "{place}");
        }
    }
}
