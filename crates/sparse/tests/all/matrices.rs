//! Matrices whose spectra are known.

use fairing_sparse::SparseMatrix;
use rand::RngExt;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

/// The combinatorial Laplacian D − A of a graph, with every diagonal entry.
pub(crate) fn graph_laplacian(
    n: usize,
    edges: impl IntoIterator<Item = (usize, usize)>,
) -> SparseMatrix {
    weighted_laplacian(n, edges.into_iter().map(|(i, j)| (i, j, 1.0)))
}

/// The Laplacian of a graph with weighted edges.
pub(crate) fn weighted_laplacian(
    n: usize,
    edges: impl IntoIterator<Item = (usize, usize, f64)>,
) -> SparseMatrix {
    let mut t = sprs::TriMatI::<f64, u32>::new((n, n));
    for i in 0..n {
        t.add_triplet(i, i, 0.0);
    }
    for (i, j, w) in edges {
        t.add_triplet(i, i, w);
        t.add_triplet(j, j, w);
        t.add_triplet(i, j, -w);
        t.add_triplet(j, i, -w);
    }
    t.to_csr()
}

/// A path: eigenvalues 2 − 2 cos(πk/n).
pub(crate) fn path(n: usize) -> SparseMatrix {
    graph_laplacian(n, (1..n).map(|i| (i - 1, i)))
}

/// A cycle: eigenvalues 2 − 2 cos(2πk/n), all but one or two of them double.
pub(crate) fn cycle(n: usize) -> SparseMatrix {
    graph_laplacian(n, (0..n).map(|i| (i, (i + 1) % n)))
}

/// An `nx × ny` grid: eigenvalues are sums of those of two paths.
pub(crate) fn grid(nx: usize, ny: usize) -> SparseMatrix {
    let at = move |x, y| y * nx + x;
    let along_x = (0..ny).flat_map(move |y| (1..nx).map(move |x| (at(x - 1, y), at(x, y))));
    let along_y = (1..ny).flat_map(move |y| (0..nx).map(move |x| (at(x, y - 1), at(x, y))));
    graph_laplacian(nx * ny, along_x.chain(along_y))
}

/// Sorted eigenvalues of [`grid`].
pub(crate) fn grid_eigenvalues(nx: usize, ny: usize) -> Vec<f64> {
    let path = |k: usize, n: usize| 2.0 - 2.0 * (std::f64::consts::PI * k as f64 / n as f64).cos();
    let mut all: Vec<f64> =
        (0..nx).flat_map(|i| (0..ny).map(move |j| path(i, nx) + path(j, ny))).collect();
    all.sort_by(f64::total_cmp);
    all
}

/// A random symmetric positive definite matrix: a random graph's Laplacian plus a positive
/// diagonal.
pub(crate) fn random_definite(n: usize, edges: usize, seed: u64) -> SparseMatrix {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let pairs: Vec<(usize, usize, f64)> = (0..edges)
        .map(|_| (rng.random_range(0..n), rng.random_range(0..n), rng.random_range(0.1..2.0)))
        .filter(|(i, j, _)| i != j)
        .collect();
    let laplacian = weighted_laplacian(n, pairs);
    let diagonal: Vec<f64> = (0..n).map(|_| rng.random_range(0.1..1.0)).collect();
    fairing_sparse::combine(1.0, fairing_sparse::Mass::Lumped(&diagonal), 1.0, &laplacian)
}

/// Numbers between −1 and 1.
pub(crate) fn random_vector(n: usize, seed: u64) -> Vec<f64> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    (0..n).map(|_| rng.random_range(-1.0..1.0)).collect()
}

/// max |a − b|.
pub(crate) fn distance(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}
