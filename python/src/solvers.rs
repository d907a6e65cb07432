//! Factorisations and eigenpairs of any symmetric matrix.

use std::sync::Arc;

use fairing_sparse::{
    Cholesky, EigenOptions, Mass, SparseError, SparseMatrix, from_csr,
    smallest_symmetric_eigenpairs,
};
use ndarray::Array2;
use numpy::{PyArray1, PyArray2, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;

use crate::arrays::{Rows, column, matrix, values};
use crate::error::{Error, Result, chain};
use crate::run::Call;

/// Row starts, columns and values in CSR of a square matrix.
type Square<'py> =
    (PyReadonlyArray1<'py, u32>, PyReadonlyArray1<'py, u32>, PyReadonlyArray1<'py, f64>);

fn square((starts, columns, numbers): &Square<'_>) -> Result<SparseMatrix> {
    let starts = values(starts);
    let n = starts.len() - 1;
    from_csr((n, n), starts, values(columns), values(numbers)).map_err(named)
}

/// The error with the name of the matrix; that of an option for a matrix that is not symmetric.
fn named(error: SparseError) -> Error {
    let of_mass =
        matches!(error, SparseError::ConsistentMass(_) | SparseError::MassNotPositive { .. });
    let text = format!("{}: {}", if of_mass { "M" } else { "A" }, chain(&error));
    match error {
        SparseError::NotSymmetric { .. } => Error::Option(text),
        _ => Error::Computation(text),
    }
}

/// A factorised positive definite matrix.
#[pyclass(frozen, module = "pyfairing._core")]
pub(crate) struct Factor {
    inner: Arc<Cholesky>,
}

#[pymethods]
impl Factor {
    #[new]
    fn new(py: Python<'_>, a: Square<'_>, call: Call) -> PyResult<Self> {
        let a = square(&a)?;
        let factor = call.run(py, move || Cholesky::new(&a).map_err(named))?;
        Ok(Self { inner: Arc::new(factor) })
    }

    fn solve<'py>(
        &self,
        py: Python<'py>,
        b: PyReadonlyArray2<'_, f64>,
        call: Call,
    ) -> PyResult<Rows<'py>> {
        let (inner, b): (_, Array2<f64>) = (Arc::clone(&self.inner), b.as_array().to_owned());
        Ok(matrix(py, call.run(py, move || Ok(inner.solve_block(b.view())))?))
    }

    fn logdet(&self) -> f64 {
        self.inner.log_determinant()
    }
}

/// Values, vectors, true if an inertia count has found no other, and a bound of the next value.
type Pairs<'py> = (Bound<'py, PyArray1<f64>>, Bound<'py, PyArray2<f64>>, bool, f64);

/// The smallest pairs; the mass is a diagonal or a matrix.
#[pyfunction]
pub(crate) fn eigsh<'py>(
    py: Python<'py>,
    a: Square<'_>,
    diagonal: Option<PyReadonlyArray1<'_, f64>>,
    mass: Option<Square<'_>>,
    k: usize,
    tolerance: Option<f64>,
    call: Call,
) -> PyResult<Pairs<'py>> {
    let a = square(&a)?;
    let diagonal = diagonal.map_or_else(|| vec![1.0; a.rows()], |d| values(&d));
    let mass = mass.as_ref().map(square).transpose()?;
    let mut options = EigenOptions::default();
    options.tolerance = tolerance.unwrap_or(options.tolerance);
    let pairs = call.run(py, move || {
        let mass = mass.as_ref().map_or(Mass::Lumped(&diagonal), Mass::Consistent);
        smallest_symmetric_eigenpairs(&a, mass, k, &options).map_err(named)
    })?;
    let next = pairs.beyond.values.first().copied().unwrap_or(pairs.beyond.clear_below);
    Ok((column(py, pairs.values), matrix(py, pairs.vectors), pairs.certified, next))
}
