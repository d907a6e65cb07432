//! The choice between a factorisation, conjugate gradients and a Chebyshev series, by a cost model
//! fitted to measurements.
//!
//! Times per row of M + tS, two cores, three right-hand sides together; the example
//! `direct_or_iterative` measures them on regular grids. Scans have half of the fill of spheres
//! that are subdivided icosahedra:
//!
//! | mesh | rows | nonzeros of L | analyse | factorise | solve |
//! |---|--:|--:|--:|--:|--:|
//! | sphere | 2 562 | 39 | 0.8 µs | 0.6 µs | 57 ns |
//! | rocker arm | 10 044 | 26 | 0.9 µs | 0.3 µs | 43 ns |
//! | sphere | 10 242 | 52 | 0.7 µs | 0.7 µs | 74 ns |
//! | armadillo | 43 243 | 28 | 1.1 µs | 0.4 µs | 67 ns |
//! | sphere | 40 962 | 70 | 0.8 µs | 1.2 µs | 98 ns |
//! | armadillo | 172 966 | 42 | 1.1 µs | 0.6 µs | 112 ns |
//! | sphere | 163 842 | 87 | 0.9 µs | 1.7 µs | 200 ns |
//! | head | 403 031 | 80 | 1.5 µs | 2.5 µs | 224 ns |
//! | sphere | 655 362 | 107 | 1.3 µs | 3.8 µs | 200 ns |
//!
//! A product of a series takes 8 to 16 ns per row, an iteration of conjugate gradients 17 to 26 ns.
//! Iterations depend on t, not on the size: after Jacobi scaling, the spectrum of a triangle mesh
//! lies between M/(M + tS) and 3/2. The least of these ratios often belongs to a few slivers, which
//! conjugate gradients single out; the root mean square of t Sᵢᵢ/Mᵢᵢ describes what remains. With
//! it, Chebyshev's bound ½ √κ ln (2/ε) is 0.8 to 1.6 times the iterations measured on scans and on
//! fine spheres, and several times as much where slivers abound.
//!
//! Beyond some million rows memory decides: a factor takes 8 bytes for each of its 40 to 110
//! nonzeros per row, conjugate gradients 20 numbers per row in all.

use crate::direct::ordering;
use crate::graph_laplacian::GraphLaplacian;

/// Properties of the systems to solve that decide between the solvers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Workload {
    /// Rows of the matrix.
    pub rows: usize,
    /// Entries of the matrix.
    pub entries: usize,
    /// Condition κ of the matrix scaled to a unit diagonal, without a few extreme rows.
    pub condition: f64,
    /// Residual to reach, relative to the initial one. Cholesky solves to rounding.
    pub tolerance: f64,
    /// Number of solves with this matrix, each for up to three right-hand sides together.
    pub solves: usize,
}

/// Analysis, assembly and factorisation, in nanoseconds per row: constant term and coefficient of
/// √n.
const FACTORISE: (f64, f64) = (1400.0, 8.0);
/// A solve for three right-hand sides and its residual, in nanoseconds: per row, and per entry of
/// the factor.
const SOLVE: (f64, f64) = (60.0, 1.8);
/// An iteration for three right-hand sides, in nanoseconds per entry of the matrix.
const ITERATE: f64 = 2.9;
/// A product of a series with three columns, in nanoseconds per entry of the matrix.
const MULTIPLY: f64 = 1.5;

impl Workload {
    /// The work of solving `(D + tS) x = b` with t = `step` and D = `added`.
    ///
    /// # Panics
    ///
    /// Panics if `added` has another length than the Laplacian has rows.
    pub fn new(
        laplacian: &GraphLaplacian,
        step: f64,
        added: &[f64],
        tolerance: f64,
        solves: usize,
    ) -> Self {
        assert_eq!(added.len(), laplacian.len(), "sizes of the operands");
        let moving = || (0..added.len()).filter(|&i| !laplacian.is_fixed(i));
        let squares = moving().map(|i| (step * laplacian.diagonal()[i] / added[i]).powi(2));
        let mean = squares.sum::<f64>() / moving().count().max(1) as f64;
        Self {
            rows: laplacian.len(),
            entries: laplacian.entries(),
            condition: 1.5 * (1.0 + mean.sqrt()),
            tolerance,
            solves,
        }
    }

    /// Returns true if [`Cholesky`](crate::Cholesky), with the factor of a surface mesh, is
    /// expected to be faster than conjugate gradients.
    ///
    /// # Examples
    ///
    /// ```
    /// use fairing_sparse::Workload;
    /// let step = Workload {
    ///     rows: 10_000,
    ///     entries: 70_000,
    ///     condition: 6.0,
    ///     tolerance: 1e-10,
    ///     solves: 1,
    /// };
    /// // A factorisation pays for one long step of a flow or for many, but not for a short one.
    /// assert!(!step.prefers_factorisation());
    /// assert!(Workload { condition: 6000.0, ..step }.prefers_factorisation());
    /// assert!(Workload { solves: 50, ..step }.prefers_factorisation());
    /// ```
    pub fn prefers_factorisation(&self) -> bool {
        self.iterations() >= self.patience()
    }

    /// Returns true if a series of `products` products, which stands for all solves, is expected to
    /// be faster than any of the solvers.
    pub fn prefers_series(&self, products: usize) -> bool {
        let iterations = self.solves as f64 * self.iterations().min(self.patience());
        products as f64 * MULTIPLY <= iterations * ITERATE
    }

    /// The iterations of one solve that take as long as its part of the factorisation.
    pub(crate) fn patience(&self) -> f64 {
        self.direct() / (self.solves.max(1) as f64 * ITERATE * self.entries.max(1) as f64)
    }

    /// Expected nanoseconds of the factorisation and all solves.
    fn direct(&self) -> f64 {
        let (rows, solves) = (self.rows as f64, self.solves as f64);
        rows * (FACTORISE.0 + FACTORISE.1 * rows.sqrt())
            + solves * (SOLVE.0 * rows + SOLVE.1 * ordering::usual_fill(self.rows))
    }

    /// Expected iterations of conjugate gradients in one solve: ½ √κ ln (2/ε), at most one per row.
    fn iterations(&self) -> f64 {
        let digits = libm::log(2.0 / self.tolerance.clamp(f64::EPSILON, 1.0));
        (0.5 * self.condition.max(1.0).sqrt() * digits).clamp(1.0, self.rows.max(1) as f64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mesh(rows: usize, spread: f64, solves: usize) -> Workload {
        Workload {
            rows,
            entries: 7 * rows,
            condition: 1.5 * (1.0 + spread),
            tolerance: 1e-8,
            solves,
        }
    }

    /// No series has fewer than two thousand terms.
    const NONE: usize = usize::MAX;

    /// Rows, t times the root mean square of Sᵢᵢ/Mᵢᵢ, implicit steps, milliseconds with a factor
    /// and with conjugate gradients, and degree and milliseconds of the series.
    type Measured = (usize, f64, usize, f64, f64, usize, f64);

    /// Spheres, whose factors have twice the entries of those of scans.
    #[rustfmt::skip]
    const SPHERES: [Measured; 16] = [
        (163_842, 100.0, 1, 964.0, 317.0, 163, 219.0),
        (163_842, 100.0, 10, 1522.0, 2156.0, 270, 316.0),
        (163_842, 1000.0, 1, 862.0, 678.0, 515, 629.0),
        (163_842, 1000.0, 10, 1310.0, 3473.0, 853, 921.0),
        (163_842, 412.0, 1, 693.0, 401.0, 319, 523.0),
        (163_842, 412.0, 10, 1165.0, 3650.0, 528, 727.0),
        (163_842, 4120.0, 1, 751.0, 690.0, 1009, 1498.0),
        (163_842, 4120.0, 10, 1586.0, 6849.0, 1671, 2140.0),
        (655_362, 100.0, 1, 6192.0, 1512.0, 163, 1120.0),
        (655_362, 100.0, 10, 7888.0, 7613.0, 270, 1944.0),
        (655_362, 1000.0, 1, 5215.0, 3618.0, 515, 2582.0),
        (655_362, 1000.0, 10, 7984.0, 25_515.0, 853, 4636.0),
        (655_362, 412.0, 1, 5896.0, 3084.0, 319, 2877.0),
        (655_362, 412.0, 10, 7836.0, 15_863.0, 529, 4874.0),
        (655_362, 4120.0, 1, 6312.0, 6771.0, 1010, 8706.0),
        (655_362, 4120.0, 10, 7779.0, 51_019.0, 1673, 12_034.0),
    ];

    /// Nine scans and models.
    #[rustfmt::skip]
    const SCANS: [Measured; 42] = [
        (172_966, 5.0, 1, 423.0, 166.0, 37, 144.0),
        (172_966, 5.0, 10, 931.0, 847.0, 61, 162.0),
        (172_966, 100.0, 1, 558.0, 653.0, 163, 387.0),
        (172_966, 100.0, 10, 1089.0, 3389.0, 270, 589.0),
        (172_966, 1000.0, 1, 506.0, 1625.0, 515, 1089.0),
        (172_966, 1000.0, 10, 852.0, 10_401.0, 853, 2096.0),
        (172_966, 66.5, 1, 570.0, 390.0, 813, 1823.0),
        (172_966, 66.5, 10, 941.0, 2994.0, 1347, 3215.0),
        (172_966, 1330.0, 1, 464.0, 1430.0, NONE, f64::INFINITY),
        (172_966, 1330.0, 10, 989.0, 12_855.0, NONE, f64::INFINITY),
        (172_966, 13_300.0, 1, 533.0, 4705.0, NONE, f64::INFINITY),
        (172_966, 13_300.0, 10, 753.0, 21_774.0, NONE, f64::INFINITY),
        (43_243, 50.9, 1, 89.0, 74.0, 401, 201.0),
        (43_243, 50.9, 10, 210.0, 867.0, 665, 321.0),
        (34_834, 30.4, 1, 90.0, 39.0, 403, 97.0),
        (34_834, 30.4, 10, 136.0, 293.0, 667, 160.0),
        (10_044, 1000.0, 1, 23.0, 73.0, 515, 86.0),
        (10_044, 1000.0, 10, 31.0, 467.0, 853, 110.0),
        (10_044, 68.0, 1, 26.0, 20.0, 421, 71.0),
        (10_044, 68.0, 10, 34.0, 129.0, 698, 135.0),
        (11_381, 4800.0, 1, 22.0, 42.0, NONE, f64::INFINITY),
        (11_381, 4800.0, 10, 49.0, 537.0, NONE, f64::INFINITY),
        (50_419, 42.4, 1, 193.0, 201.0, 419, 547.0),
        (50_419, 42.4, 10, 369.0, 1606.0, 694, 861.0),
        (50_002, 1000.0, 1, 123.0, 335.0, 515, 283.0),
        (50_002, 1000.0, 10, 259.0, 2451.0, 853, 516.0),
        (50_002, 49.3, 1, 148.0, 118.0, 409, 288.0),
        (50_002, 49.3, 10, 233.0, 738.0, 678, 480.0),
        (30_906, 5.0, 1, 73.0, 20.0, 37, 14.0),
        (30_906, 5.0, 10, 93.0, 101.0, 61, 23.0),
        (30_906, 100.0, 1, 68.0, 59.0, 163, 38.0),
        (30_906, 100.0, 10, 80.0, 300.0, 270, 69.0),
        (30_906, 1000.0, 1, 55.0, 130.0, 515, 86.0),
        (30_906, 1000.0, 10, 86.0, 1093.0, 853, 168.0),
        (30_906, 28.4, 1, 56.0, 34.0, 98, 29.0),
        (30_906, 28.4, 10, 98.0, 246.0, 163, 71.0),
        (30_906, 568.0, 1, 61.0, 127.0, 439, 106.0),
        (30_906, 568.0, 10, 101.0, 1017.0, 727, 170.0),
        (30_906, 5680.0, 1, 62.0, 416.0, 1388, 391.0),
        (30_906, 5680.0, 10, 186.0, 5487.0, NONE, f64::INFINITY),
        (44_461, 31.4, 1, 124.0, 103.0, 103, 62.0),
        (44_461, 31.4, 10, 199.0, 801.0, 170, 93.0),
    ];

    /// The choice takes at most 1.2 times the time of the fastest, on spheres 1.45 times.
    #[test]
    fn the_choice_is_nearly_the_fastest() {
        let scans = SCANS.into_iter().map(|measured| (measured, 1.2));
        for (measured, most) in scans.chain(SPHERES.map(|measured| (measured, 1.45))) {
            let (rows, spread, solves, direct, iterative, degree, series) = measured;
            let work = mesh(rows, spread, solves);
            let chosen = if work.prefers_series(degree) {
                series
            } else if work.prefers_factorisation() {
                direct
            } else {
                iterative
            };
            let best = f64::min(direct, iterative).min(series);
            assert!(chosen <= most * best, "{rows} rows, {spread}, {solves}: {chosen}, {best}");
        }
    }
}
