//! Normal equations of four fits at once, a lane for each.
//!
//! Factorisation and solution are chains of dependent operations, so four of them in parallel lanes
//! take the time of one. The formulas are those of [`NormalEquations`](crate::NormalEquations) for
//! a single fit.

/// A number for each fit.
pub(super) type Lanes = [f64; LANES];
pub(super) const LANES: usize = 4;

/// The Cholesky factors of the matrices.
pub(super) struct Factors<const N: usize> {
    /// Its part below the diagonal.
    l: [[Lanes; N]; N],
    /// The inverse of its diagonal; zeros where the rows do not determine the unknowns.
    inverse: [Lanes; N],
    /// The determinants of the matrices.
    pub(super) determinant: Lanes,
}

impl<const N: usize> Factors<N> {
    /// Of matrices whose lower half is given.
    #[inline(always)]
    pub(super) fn new(matrix: &[[Lanes; N]; N]) -> Self {
        let (mut l, mut inverse, mut determinant) = (*matrix, [[0.0; LANES]; N], [1.0; LANES]);
        for i in 0..N {
            for j in 0..=i {
                let mut sum = l[i][j];
                for k in 0..j {
                    subtract(&mut sum, l[i][k], l[j][k]);
                }
                for lane in 0..LANES {
                    if i == j {
                        determinant[lane] *= sum[lane];
                        let is_right = sum[lane] > 1e-10 * matrix[i][i][lane] && sum[lane] > 0.0;
                        inverse[i][lane] = if is_right { 1.0 / sum[lane].sqrt() } else { 0.0 };
                    } else {
                        sum[lane] *= inverse[j][lane];
                    }
                }
                l[i][j] = sum;
            }
        }
        Self { l, inverse, determinant }
    }

    /// Returns true where the rows determine the unknowns of a fit.
    #[inline(always)]
    pub(super) fn is_valid(&self, lane: usize) -> bool {
        self.inverse.iter().all(|inverse| inverse[lane] > 0.0)
    }

    /// The solutions for these right-hand sides.
    #[inline(always)]
    pub(super) fn solve(&self, rhs: &[Lanes; N]) -> [Lanes; N] {
        let mut x = *rhs;
        for i in 0..N {
            for k in 0..i {
                let y = x[k];
                subtract(&mut x[i], self.l[i][k], y);
            }
            multiply(&mut x[i], self.inverse[i]);
        }
        for i in (0..N).rev() {
            for k in i + 1..N {
                let y = x[k];
                subtract(&mut x[i], self.l[k][i], y);
            }
            multiply(&mut x[i], self.inverse[i]);
        }
        x
    }
}

#[inline(always)]
fn subtract(from: &mut Lanes, a: Lanes, b: Lanes) {
    for lane in 0..LANES {
        from[lane] -= a[lane] * b[lane];
    }
}

#[inline(always)]
fn multiply(a: &mut Lanes, by: Lanes) {
    for lane in 0..LANES {
        a[lane] *= by[lane];
    }
}
