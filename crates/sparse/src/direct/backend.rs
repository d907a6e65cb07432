//! The solver backend, faer: the only file that names it.
//!
//! faer expects compressed columns; a symmetric CSR matrix is its own CSC form, so sprs arrays are
//! passed without a copy and `Side::Lower` selects one triangle. Everything runs on the calling
//! thread: supernodes of meshes are too small for the backend's threads (a factorisation of 160
//! thousand rows took 430 ms on two threads, 375 ms on one).

use dyn_stack::{MemBuffer, MemStack, StackReq};
use faer::linalg::cholesky::ldlt::factor::LdltError;
use faer::linalg::cholesky::llt::factor::LltError;
use faer::linalg::evd;
use faer::perm::PermRef;
use faer::sparse::linalg::SupernodalThreshold;
use faer::sparse::linalg::amd;
use faer::sparse::linalg::cholesky::{
    self, CholeskySymbolicParams, SymbolicCholeskyRaw, SymmetricOrdering,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{ColMut, MatMut, MatRef, Par, Side};

use crate::direct::supernodes::Supernodes;
use crate::matrix::Rows;

const SIDE: Side = Side::Lower;
const SEQUENTIAL: Par = Par::Seq;

/// Failure of the backend.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Failure {
    /// The pivot of this row of the permuted matrix is not positive (LLᵀ) or is zero (LDLᵀ).
    Pivot(usize),
    /// Not enough memory, or more entries than `u32` can index.
    TooLarge,
}

/// A permutation and the pattern of the factor.
pub(crate) struct Symbolic {
    inner: cholesky::SymbolicCholesky<u32>,
}

/// An elimination order: the backend's minimum degree, or a permutation and its inverse.
pub(crate) enum Order<'a> {
    MinimumDegree,
    Given(&'a [u32], &'a [u32]),
}

impl std::fmt::Debug for Symbolic {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Symbolic").field("rows", &self.inner.nrows()).finish()
    }
}

impl Symbolic {
    pub(crate) fn new(rows: Rows<'_>, order: &Order<'_>) -> Result<Self, Failure> {
        let ordering = match *order {
            Order::MinimumDegree => SymmetricOrdering::Amd,
            Order::Given(order, inverse) => {
                SymmetricOrdering::Custom(PermRef::new_checked(order, inverse, order.len()))
            }
        };
        // Always supernodal: the sweeps of this crate support no other form, and meshes gain from
        // it. (Zero would exclude diagonal matrices, which need no operations.)
        let params = CholeskySymbolicParams {
            supernodal_flop_ratio_threshold: SupernodalThreshold(-1.0),
            ..Default::default()
        };
        let inner = cholesky::factorize_symbolic_cholesky(pattern(rows), SIDE, ordering, params)
            .map_err(|_| Failure::TooLarge)?;
        Ok(Self { inner })
    }

    /// The elimination order: row `order[k]` of the matrix comes k-th.
    pub(crate) fn order(&self) -> Vec<u32> {
        match self.inner.perm() {
            Some(perm) => perm.arrays().0.to_vec(),
            None => (0..self.inner.nrows() as u32).collect(),
        }
    }

    /// The supernodes of the factor.
    pub(crate) fn supernodes(&self) -> Supernodes {
        match self.inner.raw() {
            SymbolicCholeskyRaw::Supernodal(raw) => {
                Supernodes::new((0..raw.n_supernodes()).map(|s| {
                    let columns =
                        raw.supernode_begin()[s] as usize..raw.supernode_end()[s] as usize;
                    (columns, raw.supernode(s).pattern())
                }))
            }
            // Every ratio of operations to entries exceeds the threshold, except 0 / 0 of an empty
            // matrix.
            SymbolicCholeskyRaw::Simplicial(_) => Supernodes::new(std::iter::empty()),
        }
    }

    /// The number of values stored in a factor.
    pub(crate) fn len(&self) -> usize {
        self.inner.len_val()
    }

    /// Factorises A = L Lᵀ into `values`.
    pub(crate) fn llt(&self, rows: Rows<'_>, values: &mut [f64]) -> Result<(), Failure> {
        let scratch =
            self.inner.factorize_numeric_llt_scratch::<f64>(SEQUENTIAL, Default::default());
        let (mut memory, a) = (allocate(scratch)?, values_of(rows));
        let stack = MemStack::new(&mut memory);
        let (regular, own) = Default::default();
        match self.inner.factorize_numeric_llt(values, a, SIDE, regular, SEQUENTIAL, stack, own) {
            Ok(_) => Ok(()),
            Err(LltError::NonPositivePivot { index }) => Err(Failure::Pivot(index)),
        }
    }

    /// Factorises A = L D Lᵀ into `values`, with D on the diagonals of the supernodes.
    pub(crate) fn ldlt(&self, rows: Rows<'_>, values: &mut [f64]) -> Result<(), Failure> {
        let scratch =
            self.inner.factorize_numeric_ldlt_scratch::<f64>(SEQUENTIAL, Default::default());
        let (mut memory, a) = (allocate(scratch)?, values_of(rows));
        let stack = MemStack::new(&mut memory);
        let (regular, own) = Default::default();
        match self.inner.factorize_numeric_ldlt(values, a, SIDE, regular, SEQUENTIAL, stack, own) {
            Ok(_) => Ok(()),
            Err(LdltError::ZeroPivot { index }) => Err(Failure::Pivot(index)),
        }
    }
}

/// Allocates working memory.
fn allocate(needed: StackReq) -> Result<MemBuffer, Failure> {
    MemBuffer::try_new(needed).map_err(|_| Failure::TooLarge)
}

fn values_of(rows: Rows<'_>) -> SparseColMatRef<'_, u32, f64> {
    SparseColMatRef::new(pattern(rows), rows.values)
}

/// The minimum degree order of a symmetric matrix: row `order[k]` is eliminated k-th.
pub(crate) fn minimum_degree(rows: Rows<'_>) -> Result<Vec<u32>, Failure> {
    let n = rows.count();
    let (mut order, mut inverse) = (vec![0; n], vec![0; n]);
    let mut memory = allocate(amd::order_scratch::<u32>(n, rows.columns.len()))?;
    let stack = MemStack::new(&mut memory);
    amd::order(&mut order, &mut inverse, pattern(rows), Default::default(), stack)
        .map_err(|_| Failure::TooLarge)?;
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
    let largest = matrix.iter().fold(0.0, |m: f64, v| m.max(v.abs()));
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
