//! The equations of a system, and their solution about the mean of each part.

use crate::graph_laplacian::GraphLaplacian;
use crate::graph_system::parts::Parts;
use crate::matrix::SparseMatrix;

/// The rows of a right-hand side. Not a type parameter: solvers would be compiled for each.
pub(super) type RightSide<'a, const N: usize> = &'a (dyn Fn(usize) -> [f64; N] + Sync);

/// `(D + tS) x = b`, with some entries of x given.
#[derive(Debug, Clone)]
pub(super) struct Equations {
    /// S, zero in the rows of given values. Its mass M defines the means of parts where D is zero.
    pub(super) laplacian: GraphLaplacian,
    /// t.
    pub(super) step: f64,
    /// D.
    pub(super) added: Vec<f64>,
    pub(super) parts: Parts,
    /// The sum of D over each part.
    totals: Vec<f64>,
    /// The sum over each part of the weights of its mean: D, or M where D is zero on the part.
    weights: Vec<f64>,
}

impl Equations {
    pub(super) fn new(laplacian: GraphLaplacian, step: f64, added: Vec<f64>, parts: Parts) -> Self {
        let (totals, weights) = (Vec::new(), Vec::new());
        let mut equations = Self { laplacian, step, added, parts, totals, weights };
        equations.weigh();
        equations
    }

    /// Recomputes the weights of the parts after a change of D.
    pub(super) fn weigh(&mut self) {
        self.totals = self.parts.sums(|_, i| self.added[i]);
        self.weights = self.parts.sums(|_, i| self.weight(i));
    }

    /// The weight of row `i` in the mean of its part.
    #[inline(always)]
    fn weight(&self, i: usize) -> f64 {
        if self.totals[self.parts.part(i)] > 0.0 { self.added[i] } else { self.laplacian.mass()[i] }
    }

    /// [`Self::weight`] as a fraction of that of the part.
    #[inline(always)]
    fn fraction(&self, i: usize) -> f64 {
        self.weight(i) / self.weights[self.parts.part(i)]
    }

    /// The weighted mean over each part.
    pub(super) fn means<const N: usize>(
        &self,
        value: impl Fn(usize) -> [f64; N] + Sync,
    ) -> Vec<[f64; N]> {
        self.parts.sums(|_, i| {
            let fraction = self.fraction(i);
            value(i).map(|value| fraction * value)
        })
    }

    /// The number of rows.
    pub(super) fn len(&self) -> usize {
        self.added.len()
    }

    /// The diagonal of tS in row `i`.
    pub(super) fn stiffness(&self, i: usize) -> f64 {
        self.step * self.laplacian.stiffness_row(i).map(|(_, s)| -s).sum::<f64>()
    }

    /// The equations of a right-hand side b about the origins of the parts.
    pub(super) fn centred<'a, const N: usize>(
        &'a self,
        right: RightSide<'a, N>,
        x: &'a [[f64; N]],
    ) -> Centred<'a, N> {
        // Sums are formed about a value of the part, so that values far from zero lose no digits.
        let mut origins = vec![[0.0; N]; self.parts.count()];
        for (part, &first) in self.parts.firsts().iter().enumerate() {
            let d = self.added[first as usize];
            if d > 0.0 {
                origins[part] = right(first as usize).map(|b| b / d);
            }
        }
        let excess = vec![[0.0; N]; self.parts.count()];
        let mut centred = Centred { equations: self, right, x, origins, excess };
        let sums = self.parts.sums(|_, i| centred.moment(i));
        for (origin, (moment, weight)) in centred.origins.iter_mut().zip(sums) {
            for k in 0..N {
                origin[k] += if weight > 0.0 { moment[k] / weight } else { 0.0 };
            }
        }
        centred.excess = self.parts.sums(|_, i| centred.load(i));
        centred
    }

    /// The matrix, plus `ground(i)` on the diagonal; rows and columns of given values are those of
    /// the identity.
    pub(super) fn matrix(&self, ground: impl Fn(usize) -> f64) -> SparseMatrix {
        let n = self.len();
        let (mut starts, mut columns, mut values) = (vec![0u32], Vec::new(), Vec::new());
        let mut row: Vec<(u32, f64)> = Vec::new();
        for i in 0..n {
            row.clear();
            let mut own = 1.0;
            if !self.parts.is_given(i) {
                own = self.added[i] + ground(i) + self.stiffness(i);
                let entries = self.laplacian.stiffness_row(i);
                let free = entries.filter(|&(j, _)| !self.parts.is_given(j as usize));
                row.extend(free.map(|(j, s)| (j, self.step * s)));
            }
            row.push((i as u32, own));
            row.sort_unstable_by_key(|&(j, _)| j);
            columns.extend(row.iter().map(|e| e.0));
            values.extend(row.iter().map(|e| e.1));
            starts.push(columns.len() as u32);
        }
        SparseMatrix::new((n, n), starts, columns, values)
    }
}

/// Equations about the origins c of the parts: `(D + tS) y = b − Dc + t Σ w (g − c)` for y = x − c,
/// with y = 0 in the rows of given values g and a sum over the given neighbours of a row, whose
/// weights are w.
///
/// The origin is the mean of a floating part, which D and b determine: the sum of `D x` is that of
/// b. Other parts have an origin between `b/D` and the given values next to them. Digits are thus
/// lost neither far from zero nor in the mean of a nearly singular system. If D is zero on a
/// floating part, the right-hand side is reduced to one of sum zero.
pub(super) struct Centred<'a, const N: usize> {
    pub(super) equations: &'a Equations,
    right: RightSide<'a, N>,
    x: &'a [[f64; N]],
    pub(super) origins: Vec<[f64; N]>,
    /// The sum of `b − Dc` over each part: for a floating part that of b if D is zero, otherwise
    /// the rounding error of its mean.
    excess: Vec<[f64; N]>,
}

impl<const N: usize> Centred<'_, N> {
    /// Weights and given values of the given neighbours of row `i`.
    fn given(&self, i: usize) -> impl Iterator<Item = (f64, [f64; N])> {
        let Equations { laplacian, parts, .. } = self.equations;
        let anchored = !parts.floats(parts.part(i)) && !parts.is_given(i);
        let row = anchored.then(|| laplacian.stiffness_row(i)).into_iter().flatten();
        row.map(|(j, s)| (j as usize, -s))
            .filter(|&(j, _)| parts.is_given(j))
            .map(|(j, w)| (self.equations.step * w, self.x[j]))
    }

    /// The sums of the weights in an origin, and of the weighted values about the origin.
    fn moment(&self, i: usize) -> ([f64; N], f64) {
        let part = self.equations.parts.part(i);
        let (origin, mut moment) = (&self.origins[part], [0.0; N]);
        if self.equations.totals[part] > 0.0 {
            moment = self.load(i);
        }
        let mut weight = self.equations.added[i];
        for (w, g) in self.given(i) {
            for k in 0..N {
                moment[k] += w.abs() * (g[k] - origin[k]);
            }
            weight += w.abs();
        }
        (moment, weight)
    }

    /// `b − Dc` in row `i`.
    #[inline(always)]
    pub(super) fn load(&self, i: usize) -> [f64; N] {
        let Equations { added, parts, .. } = self.equations;
        let (origin, mut load) = (&self.origins[parts.part(i)], [0.0; N]);
        if !parts.is_given(i) {
            load = (self.right)(i);
            for k in 0..N {
                load[k] -= added[i] * origin[k];
            }
        }
        load
    }

    /// The right-hand side in row `i`.
    #[inline(always)]
    pub(super) fn right(&self, i: usize) -> [f64; N] {
        let part = self.equations.parts.part(i);
        let (origin, mut right) = (&self.origins[part], self.load(i));
        if self.equations.parts.floats(part) {
            let (fraction, excess) = (self.equations.fraction(i), &self.excess[part]);
            for k in 0..N {
                right[k] -= fraction * excess[k];
            }
        }
        for (w, g) in self.given(i) {
            for k in 0..N {
                right[k] += w * (g[k] - origin[k]);
            }
        }
        right
    }

    /// The origins, for floating parts with the rounding errors of their means.
    pub(super) fn into_origins(mut self) -> Vec<[f64; N]> {
        let Equations { parts, totals, .. } = self.equations;
        for (part, (origin, excess)) in self.origins.iter_mut().zip(&self.excess).enumerate() {
            if parts.floats(part) && totals[part] > 0.0 {
                for k in 0..N {
                    origin[k] += excess[k] / totals[part];
                }
            }
        }
        self.origins
    }

    /// The value of `x` in row `i` about the origin; zero if it is given.
    #[inline(always)]
    pub(super) fn guess(&self, i: usize) -> [f64; N] {
        let parts = &self.equations.parts;
        let (x, origin) = (&self.x[i], &self.origins[parts.part(i)]);
        if parts.is_given(i) { [0.0; N] } else { std::array::from_fn(|k| x[k] - origin[k]) }
    }

    /// The distance from the origin that values near row `i` have at least: that of `b/D` and of
    /// the given values next to the row.
    #[inline(always)]
    pub(super) fn reach(&self, i: usize) -> [f64; N] {
        let (d, mut reach) = (self.equations.added[i], self.load(i).map(f64::abs));
        reach = reach.map(|load| if d > 0.0 { load / d } else { 0.0 });
        let origin = &self.origins[self.equations.parts.part(i)];
        for (_, g) in self.given(i) {
            for k in 0..N {
                reach[k] = reach[k].max((g[k] - origin[k]).abs());
            }
        }
        reach
    }
}
