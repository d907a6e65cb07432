//! Numpy arrays from values of the crates, and back.

use fairing_sparse::SparseMatrix;
use ndarray::ArrayView2;
use numpy::{Element, PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;

use crate::error::{Error, Result};

/// A numpy array with two axes.
pub(crate) type Rows<'py> = Bound<'py, PyArray2<f64>>;

/// `n × d`, without a copy.
pub(crate) fn rows<T: Element, const D: usize>(
    py: Python<'_>,
    rows: Vec<[T; D]>,
) -> PyResult<Bound<'_, PyArray2<T>>> {
    let n = rows.len();
    PyArray1::from_vec(py, rows.into_flattened()).reshape([n, D])
}

/// One number for each element, without a copy.
pub(crate) fn column<T: Element>(py: Python<'_>, values: Vec<T>) -> Bound<'_, PyArray1<T>> {
    PyArray1::from_vec(py, values)
}

/// A matrix of `ndarray`, without a copy.
pub(crate) fn matrix(py: Python<'_>, values: ndarray::Array2<f64>) -> Bound<'_, PyArray2<f64>> {
    PyArray2::from_owned_array(py, values)
}

/// Row starts, columns and values in CSR, and the shape; without a copy.
pub(crate) type Csr<'py> = (
    Bound<'py, PyArray1<u32>>,
    Bound<'py, PyArray1<u32>>,
    Bound<'py, PyArray1<f64>>,
    (usize, usize),
);

pub(crate) fn csr(py: Python<'_>, matrix: SparseMatrix) -> Csr<'_> {
    let shape = matrix.shape();
    let (starts, columns, values) = matrix.into_raw_storage();
    (column(py, starts), column(py, columns), column(py, values), shape)
}

/// A read-only view of memory that `owner` holds and never changes.
#[expect(unsafe_code, reason = "numpy cannot express the lifetime of the owner")]
pub(crate) fn view<'py, T: Element>(
    array: ArrayView2<'_, T>,
    owner: Bound<'py, PyAny>,
) -> Bound<'py, PyArray2<T>> {
    // SAFETY: the caller passes an array inside of `owner`, a frozen object, which the view keeps
    // alive; nothing moves or writes it, since the object has no method that does, and the view is
    // not writeable.
    let view = unsafe { PyArray2::borrow_from_array(&array, owner) };
    view.readwrite().make_nonwriteable();
    view
}

/// The rows of an `n × 3` array.
pub(crate) fn triples<T: Element + Copy>(array: &PyReadonlyArray2<'_, T>) -> Result<Vec<[T; 3]>> {
    let shape = array.as_array().dim();
    if shape.1 != 3 {
        return Err(Error::option(format!("an array of shape {shape:?} where (n, 3) is needed")));
    }
    match array.as_slice() {
        Ok(flat) => Ok(flat.as_chunks::<3>().0.to_vec()),
        Err(_) => Ok(array.as_array().rows().into_iter().map(|r| [r[0], r[1], r[2]]).collect()),
    }
}

/// The values of a vector.
pub(crate) fn values<T: Element + Copy>(array: &PyReadonlyArray1<'_, T>) -> Vec<T> {
    array.as_array().iter().copied().collect()
}
