//! A system solved by conjugate gradients, up to four columns together.

use crate::conjugate_gradients::{CgSystem, CgWorkspace, descend, worst_row};
use crate::error::SparseError;
use crate::graph_laplacian::Padded;
use crate::graph_system::equations::{Centred, Equations};
use crate::graph_system::gauge::{Columns, Sides, reciprocal};
use crate::order::larger;
use crate::parallel::update;

/// Largest number of restarts after the measured residual turned out larger than that of the
/// recurrence.
const MAX_RESTARTS: usize = 3;

/// Memory shared by consecutive solves; clearing it in every solve would take longer than an
/// iteration.
#[derive(Debug, Clone, Default)]
pub(super) struct Scratch {
    /// The solution about the origins of the parts.
    pub(super) y: Vec<Padded>,
    cg: CgWorkspace<4>,
    /// The reciprocal of the diagonal of `D + tS`; empty after a change of the operator.
    pub(super) inverse: Vec<f64>,
}

/// The projection of a change of a row.
pub(super) type Projection<'a, const N: usize> = &'a (dyn Fn(usize, [f64; N]) -> [f64; N] + Sync);

/// A system in units of the scales of residuals, in which the right-hand side of each column of
/// each part has norm one: each is a linear system of its own, so scaling does not change it.
struct Iteration<'a, const N: usize> {
    centred: &'a Centred<'a, N>,
    /// The reciprocal scales.
    units: Vec<[f64; N]>,
    /// A projection of the changes of each row, which couples columns.
    project: Option<Projection<'a, N>>,
    inverse: &'a [f64],
}

/// Solves a system to a residual relative to the right-hand side of each column of each part, or to
/// the level of rounding, within `limit` iterations and with changes projected by `project`.
/// Without a projection, when a factorisation can take over, it ends at a quarter of the limit if
/// the residual, extrapolated, would take more than twice the limit. Returns the iterations taken
/// and the residual; the solution about the origins is left in `scratch`.
pub(super) fn iterate<const N: usize>(
    centred: &Centred<'_, N>,
    project: Option<Projection<'_, N>>,
    (tolerance, limit): (f64, usize),
    scratch: &mut Scratch,
) -> Result<(usize, f64), SparseError> {
    let Equations { laplacian, step, added, parts, .. } = centred.equations;
    let Scratch { y, cg, inverse } = scratch;
    if inverse.is_empty() {
        inverse.resize(added.len(), 0.0);
        let diagonal = laplacian.diagonal();
        update(inverse, |i, _| (reciprocal(added[i] + step * diagonal[i]), ()));
    }
    let reach = parts.largest(|_, i| {
        let (guess, far) = (centred.guess(i), centred.reach(i));
        std::array::from_fn(|k| larger(guess[k].abs(), far[k]))
    });
    let is_coupled = project.is_some();
    let columns_of = if is_coupled { Columns::Coupled } else { Columns::Independent };
    let scales = Sides::new(centred).scales(&reach, tolerance, columns_of);
    let units: Vec<[f64; N]> = scales.iter().map(|scale| scale.map(reciprocal)).collect();
    y.resize(centred.equations.len(), [0.0; 4]);
    cg.resize(y.len());
    update(y, |i, _| (padded(scaled(centred.guess(i), &units[parts.part(i)])), ()));
    let system = Iteration { centred, units, project, inverse };
    let (mut iterations, mut residual) = (0, f64::INFINITY);
    let done = |squares: &Padded| [root(squares) <= tolerance; 4];
    let mut first = f64::NAN;
    for restart in 0..=MAX_RESTARTS {
        residual = root(&system.residual(y, &mut cg.r));
        if restart == 0 {
            first = residual;
        }
        let ends = |iterations: usize, residual: f64| {
            let digits = libm::log(first / residual) / libm::log(first / tolerance);
            let spent = iterations as f64 / limit as f64;
            iterations >= limit || !is_coupled && spent >= 0.25 && digits < 0.5 * spent
        };
        if restart > 0 && residual <= tolerance {
            update(y, |i, y| (padded(scaled(columns(y), &scales[parts.part(i)])), ()));
            return Ok((iterations, residual));
        }
        if restart < MAX_RESTARTS {
            descend(&system, y, cg, done, &mut iterations, ends)?;
            system.settle(y);
        }
    }
    Err(SparseError::NotConverged { iterations, residual, row: worst_row(&cg.r) })
}

impl<const N: usize> Iteration<'_, N> {
    #[inline(always)]
    fn project(&self, i: usize, d: Padded) -> Padded {
        self.project.as_ref().map_or(d, |project| padded(project(i, columns(d))))
    }

    /// Computes `r = P (b − (D + tS) y)` and returns the squared norm of each column.
    fn residual(&self, y: &[Padded], r: &mut [Padded]) -> Padded {
        let Equations { laplacian, step, added, parts, .. } = self.centred.equations;
        laplacian.sweep_summing(y, r, |i, s, y, _| {
            let mut r = padded(scaled(self.centred.right(i), &self.units[parts.part(i)]));
            for k in 0..4 {
                r[k] -= added[i] * y[k] - step * s[k];
            }
            let r = self.project(i, r);
            (r, r.map(|r| r * r))
        })
    }

    /// Makes the mean of each floating part zero, as the equations require. Only D determines the
    /// mean, so residuals of long steps hardly show its error.
    fn settle(&self, y: &mut [Padded]) {
        if self.is_coupled() {
            return;
        }
        let equations = self.centred.equations;
        let means = equations.means(|i| y[i]);
        update(y, |i, mut y| {
            let part = equations.parts.part(i);
            if equations.parts.floats(part) {
                for k in 0..4 {
                    y[k] -= means[part][k];
                }
            }
            (y, ())
        });
    }
}

impl<const N: usize> CgSystem<4> for Iteration<'_, N> {
    fn multiply(&self, p: &[Padded], q: &mut [Padded]) -> Padded {
        let Equations { laplacian, step, added, .. } = self.centred.equations;
        laplacian.sweep_summing(p, q, |i, s, p, _| {
            let (d, mut q) = (added[i], [0.0; 4]);
            for k in 0..4 {
                q[k] = d * p[k] - step * s[k];
            }
            let q = self.project(i, q);
            (q, std::array::from_fn(|k| p[k] * q[k]))
        })
    }

    #[inline(always)]
    fn precondition(&self, i: usize, r: Padded) -> Padded {
        let s = self.inverse[i];
        self.project(i, r.map(|r| s * r))
    }

    fn is_coupled(&self) -> bool {
        self.project.is_some()
    }
}

/// The largest square root; NaN if one is NaN.
fn root(squares: &Padded) -> f64 {
    squares.iter().map(|s| s.sqrt()).fold(0.0, larger)
}

#[inline(always)]
fn scaled<const N: usize>(values: [f64; N], by: &[f64; N]) -> [f64; N] {
    std::array::from_fn(|k| values[k] * by[k])
}

#[inline(always)]
fn padded<const N: usize>(values: [f64; N]) -> Padded {
    std::array::from_fn(|k| if k < N { values[k] } else { 0.0 })
}

#[inline(always)]
pub(super) fn columns<const N: usize>(padded: Padded) -> [f64; N] {
    std::array::from_fn(|k| padded[k])
}
