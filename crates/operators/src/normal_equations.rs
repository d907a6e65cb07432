//! Small weighted least squares by their normal equations.

/// The normal equations `(Σ w a aᵀ) x = Σ w a b` of a weighted least-squares
/// fit with `N` unknowns.
///
/// The condition number of the fit is squared here. The units of single unknowns
/// do not matter, since each pivot is compared with its own diagonal entry; a
/// frame that mixes unknowns of different size does. Use coordinates along the
/// principal axes of the data.
#[derive(Debug, Clone, Copy)]
pub struct NormalEquations<const N: usize> {
    matrix: [[f64; N]; N],
    rhs: [f64; N],
}

impl<const N: usize> Default for NormalEquations<N> {
    fn default() -> Self {
        Self { matrix: [[0.0; N]; N], rhs: [0.0; N] }
    }
}

impl<const N: usize> NormalEquations<N> {
    /// The equations with the lower half of `Σ w a aᵀ`, and `Σ w a b`, summed
    /// elsewhere.
    pub fn from_sums(matrix: [[f64; N]; N], rhs: [f64; N]) -> Self {
        Self { matrix, rhs }
    }

    /// Adds the equation `row · x = value` with a weight, which is the inverse
    /// of the variance of `value` up to a common factor.
    #[inline]
    pub fn add(&mut self, row: &[f64; N], value: f64, weight: f64) {
        for i in 0..N {
            let w = weight * row[i];
            for j in 0..=i {
                self.matrix[i][j] += w * row[j];
            }
            self.rhs[i] += w * value;
        }
    }

    /// The Cholesky factor of the matrix, or `None` where a pivot falls below
    /// 10⁻¹⁰ of its diagonal entry: the rows do not determine the unknowns.
    pub fn factor(&self) -> Option<NormalFactor<N>> {
        let mut l = self.matrix;
        let mut inverse = [0.0; N];
        for i in 0..N {
            for j in 0..=i {
                let mut sum = l[i][j];
                for k in 0..j {
                    sum -= l[i][k] * l[j][k];
                }
                if i == j {
                    if sum.is_nan() || sum <= 1e-10 * self.matrix[i][i] || sum <= 0.0 {
                        return None;
                    }
                    inverse[i] = 1.0 / sum.sqrt();
                } else {
                    l[i][j] = sum * inverse[j];
                }
            }
        }
        Some(NormalFactor { l, inverse })
    }

    /// The least-squares solution, or `None` where [`Self::factor`] has none.
    pub fn solve(&self) -> Option<[f64; N]> {
        Some(self.factor()?.solve(&self.rhs))
    }

    /// The right-hand side `Σ w a b`.
    pub fn rhs(&self) -> &[f64; N] {
        &self.rhs
    }
}

/// The Cholesky factor `L` of the matrix `Σ w a aᵀ = L Lᵀ` of
/// [`NormalEquations`].
#[derive(Debug, Clone, Copy)]
pub struct NormalFactor<const N: usize> {
    /// Its part below the diagonal.
    l: [[f64; N]; N],
    /// The inverse of its diagonal.
    inverse: [f64; N],
}

impl<const N: usize> NormalFactor<N> {
    /// Solves `L Lᵀ x = b`.
    pub fn solve(&self, b: &[f64; N]) -> [f64; N] {
        let mut x = self.forward(b);
        for i in (0..N).rev() {
            for k in i + 1..N {
                x[i] -= self.l[k][i] * x[k];
            }
            x[i] *= self.inverse[i];
        }
        x
    }

    /// The factor of the equations of the first `M` unknowns alone.
    ///
    /// # Panics
    ///
    /// If there are fewer than `M`.
    pub fn leading<const M: usize>(&self) -> NormalFactor<M> {
        let mut leading = NormalFactor { l: [[0.0; M]; M], inverse: [0.0; M] };
        for i in 0..M {
            leading.l[i].copy_from_slice(&self.l[i][..M]);
            leading.inverse[i] = self.inverse[i];
        }
        leading
    }

    /// The variance `aᵀ (L Lᵀ)⁻¹ a` of the prediction `a · x`, in units of the
    /// variance of an equation of weight one.
    pub fn variance(&self, a: &[f64; N]) -> f64 {
        self.forward(a).iter().map(|y| y * y).sum()
    }

    fn forward(&self, b: &[f64; N]) -> [f64; N] {
        let mut y = *b;
        for i in 0..N {
            for k in 0..i {
                y[i] -= self.l[i][k] * y[k];
            }
            y[i] *= self.inverse[i];
        }
        y
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Four points of y = 2 − 3 x: the fit is exact, and the variance of its
    /// value at x is 1/n + (x − x̄)²/Σ(xᵢ − x̄)².
    #[test]
    fn line_through_four_points() {
        let mut equations = NormalEquations::<2>::default();
        for x in [0.0, 1.0, 2.0, 3.0] {
            equations.add(&[1.0, x], 2.0 - 3.0 * x, 1.0);
        }
        let line = equations.solve().unwrap();
        assert!((line[0] - 2.0).abs() < 1e-13 && (line[1] + 3.0).abs() < 1e-13);
        let variance = equations.factor().unwrap().variance(&[1.0, 4.0]);
        assert!((variance - (0.25 + 2.5 * 2.5 / 5.0)).abs() < 1e-13);
    }

    /// The first unknowns of a quadric are those of a line.
    #[test]
    fn the_leading_factor_is_that_of_fewer_unknowns() {
        let mut quadric = NormalEquations::<3>::default();
        let mut line = NormalEquations::<2>::default();
        for x in [0.0, 1.0, 2.0, 3.0, 5.0] {
            quadric.add(&[1.0, x, x * x], 1.0 + x * x, 1.0);
            line.add(&[1.0, x], 1.0 + x * x, 1.0);
        }
        let leading = quadric.factor().unwrap().leading::<2>();
        assert_eq!(leading.solve(line.rhs()), line.solve().unwrap());
    }

    #[test]
    fn rows_that_do_not_determine_the_unknowns() {
        let mut equations = NormalEquations::<2>::default();
        assert!(equations.solve().is_none());
        equations.add(&[1.0, 1.0], 1.0, 1.0);
        equations.add(&[2.0, 2.0], 1.0, 1.0);
        assert!(equations.solve().is_none());
    }
}
