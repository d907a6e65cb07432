//! HC smoothing: Laplacian steps that push vertices back towards their previous positions.

use fairing_mesh::TriMesh;
use fairing_parameters::{Options, ParameterError, Range};

use crate::engine::assemble::uniform;
use crate::engine::constraints::Constraints;
use crate::engine::error::{FlowError, FlowFailure};
use crate::engine::outcome::Smoothed;
use crate::engine::run::{Observer, Run, RunSettings, StepNote};
use crate::flows::explicit::{Stability, uniform_limit};

fairing_parameters::options! {
    /// Options of [`hc`].
    #[derive(Debug, Clone, PartialEq)]
    #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
    #[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
    pub struct Hc {
        /// The weight of the input positions, against the previous step, in the differences.
        pub alpha: f64 = 0.0, in Range::FRACTION;
        /// The weight of a vertex's own difference, against the mean of its neighbours', in the
        /// correction.
        pub beta: f64 = 0.5, in Range::FRACTION;
        /// The number of steps.
        pub iterations: usize = 10;
        /// Constraints of the vertices.
        pub constraints: Constraints = Constraints::NONE;
        /// The treatment of values of beta so small that modes grow.
        pub stability: Stability = Stability::Refuse, name "unstable";
    }
    "hc": "uniform steps, each followed by a correction; roughly preserves size", ["vollmer1999"];
}

const LARGE_ENOUGH: &str = "at least 1 − (2 − alpha) / (K (K − alpha)), so that no mode grows, \
    with K = 1.5 on closed meshes, 1.75 on open ones and 2 where an edge has three faces \
    (0.5 is always enough); or unstable steps must be allowed";

/// Smooths by Humphrey's Classes (HC) steps with uniform weights: a full Laplacian step, followed
/// by a correction with the smoothed differences.
///
/// ```text
/// p = q + L q,   b = p − (α o + (1 − α) q),   q' = p − (β b + (1 − β) A b)
/// ```
///
/// with the input o, the previous positions q, and the mean over neighbours A. Fine detail is
/// removed, while volume and size change far less than under the Laplacian alone.
///
/// Each step multiplies the mode of eigenvalue −k of `L` by `1 − α + (1 − β) k (α − k)` and adds a
/// multiple of the input, proportional to α. The factor is never above 1, and not below −1 as long
/// as
///
/// ```text
/// 1 − β ≤ (2 − α) / (K (K − α))
/// ```
///
/// for the spectral bound K: 3/2 on closed meshes, 7/4 on open ones, 2 if an edge has three or more
/// faces. Every β of at least ½ is stable on every mesh; with α = 0 the limit is 1/9 on closed
/// meshes and 0.347 on open ones.
///
/// # Errors
///
/// [`FlowError`] if an option is out of range, or if β is below the limit, unless [`Hc::stability`]
/// allows it.
///
/// # Examples
///
/// ```
/// use fairing_shapes as shapes;
/// use fairing_smoothing::{Hc, hc};
///
/// let smoothed = hc(&shapes::icosphere(3), &Hc::default(), None)?;
/// let radius = smoothed.mesh.positions()[0].iter().map(|x| x * x).sum::<f64>().sqrt();
/// assert!((radius - 1.0).abs() < 0.01);
/// # Ok::<(), fairing_smoothing::FlowError>(())
/// ```
///
/// Source: [vollmer1999].
///
/// [vollmer1999]: https://doi.org/10.1111/1467-8659.00334
#[doc(alias = "filter_humphrey")]
pub fn hc(
    mesh: &TriMesh,
    options: &Hc,
    observer: Option<&mut Observer<'_>>,
) -> Result<Smoothed, FlowError> {
    let Hc { alpha, beta, .. } = *options;
    options.check().map_err(|error| FlowFailure::from(error).before(mesh))?;
    let settings = RunSettings::new(&options.constraints, options.iterations);
    let mut run = Run::new(mesh, &settings, observer)?;
    // β of at least ½ is stable on every mesh, so its topology is not needed.
    if beta < 0.5 {
        let limit = returned_limit(alpha, 2.0 / uniform_limit(mesh));
        run.report.stable_limit = Some(limit);
        run.report.unstable = 1.0 - beta > limit;
        if run.report.unstable && options.stability == Stability::Refuse {
            let error = ParameterError::range("beta", beta, LARGE_ENOUGH);
            return Err(run.refuse(error.into()));
        }
    }
    let laplacian = uniform(run.arrangement.mesh(), &run.freedom.fixed);
    let input = run.arrangement.mesh().positions().to_vec();
    let mut difference = vec![[0.0; 3]; input.len()];
    run.iterate(|_, mesh, freedom, next| {
        let q = mesh.positions();
        laplacian.sweep(q, &mut difference, |i, l, q, _| {
            let o = input[i];
            [0, 1, 2].map(|k| q[k] + l[k] - (alpha * o[k] + (1.0 - alpha) * q[k]))
        });
        laplacian.sweep(&difference, next, |i, l, b, _| {
            let (q, o) = (q[i], input[i]);
            let (w, target) = freedom.pull(i);
            // The mean of the neighbours' differences is b + L b.
            let d = [0, 1, 2].map(|k| {
                let p = b[k] + alpha * o[k] + (1.0 - alpha) * q[k];
                let back = b[k] + (1.0 - beta) * l[k];
                (p - back - q[k] + w * (target[k] - q[k])) / (1.0 + w)
            });
            let d = freedom.project(i, d);
            [q[0] + d[0], q[1] + d[1], q[2] + d[2]]
        });
        Ok(StepNote { step_size: 1.0, residual: None })
    })
}

/// The largest `1 − β` for which no mode with an eigenvalue of at least `−bound` grows.
fn returned_limit(alpha: f64, bound: f64) -> f64 {
    (2.0 - alpha) / (bound * (bound - alpha))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Factors of modes at the limit and beyond: within ±1, and at −1 for the roughest.
    #[test]
    fn the_limit_is_that_of_the_roughest_mode() {
        for alpha in [0.0, 0.1, 0.5, 1.0] {
            for bound in [1.5, 1.75, 2.0] {
                let limit = returned_limit(alpha, bound);
                let factor = |k: f64| 1.0 - alpha + limit * k * (alpha - k);
                for i in 0..=100 {
                    let k = bound * f64::from(i) / 100.0;
                    assert!(factor(k).abs() <= 1.0 + 1e-14, "{alpha} {bound}: {}", factor(k));
                }
                assert!((factor(bound) + 1.0).abs() < 1e-14);
                assert!(limit >= 0.5);
            }
        }
    }

    /// Without the limit, positions of an ellipsoid ended at millions.
    #[test]
    fn growing_modes_are_refused() {
        let ball = fairing_shapes::bumpy_sphere(3, 0.2, 5.0);
        let options = Hc { beta: 0.0, iterations: 100, ..Hc::default() };
        let error = hc(&ball, &options, None).unwrap_err();
        assert!(matches!(error.failure, FlowFailure::Option(_)), "{error:?}");
        let few = Hc { iterations: 3, stability: Stability::Allow, ..options.clone() };
        assert!(hc(&ball, &few, None).unwrap().report.unstable);
        let size = |beta: f64| {
            let smoothed = hc(&ball, &Hc { beta, ..options.clone() }, None).unwrap();
            assert!(!smoothed.report.unstable);
            smoothed.mesh.diagonal() / ball.diagonal()
        };
        // 1/9 is the limit of closed meshes.
        for beta in [0.112, 0.3, 0.5, 1.0] {
            assert!((0.5..1.1).contains(&size(beta)), "{beta}: {}", size(beta));
        }
    }
}
