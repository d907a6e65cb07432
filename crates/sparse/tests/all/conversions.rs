//! Matrices of other crates, behind features.

#[cfg(any(feature = "faer", feature = "nalgebra"))]
fn wide() -> fairing_sparse::SparseMatrix {
    let entries = [(0, 0, 2.0), (0, 3, -1.0), (2, 1, 0.5), (2, 2, 0.0), (2, 4, 1e-300)];
    fairing_sparse::from_triplets((4, 5), &entries).unwrap()
}

#[cfg(feature = "faer")]
#[test]
fn matrices_of_faer_are_the_same() {
    let theirs = fairing_sparse::to_faer(&wide());
    let pattern = theirs.symbolic();
    assert_eq!((pattern.nrows(), pattern.ncols(), theirs.val().len()), (4, 5, 5));
    assert_eq!(theirs.to_dense()[(0, 3)], -1.0);
    assert_eq!(fairing_sparse::from_faer(theirs.as_ref()).unwrap(), wide());
    let mut broken = theirs;
    broken.val_mut()[2] = f64::NAN;
    let error = fairing_sparse::from_faer(broken.as_ref()).unwrap_err().to_string();
    assert!(error.contains("NaN"), "{error}");
}

#[cfg(feature = "nalgebra")]
#[test]
fn matrices_of_nalgebra_are_the_same() {
    let theirs = fairing_sparse::to_nalgebra(&wide());
    assert_eq!((theirs.nrows(), theirs.ncols(), theirs.nnz()), (4, 5, 5));
    assert_eq!(theirs.get_entry(0, 3).unwrap().into_value(), -1.0);
    assert_eq!(fairing_sparse::from_nalgebra(&theirs).unwrap(), wide());
}
