//! The scale-dependent umbrella operator.

use fairing_mesh::{Components, TriMesh};
use fairing_parameters::{Options, Range};
use fairing_sparse::{GraphLaplacian, larger};
use glam::DVec3;

use crate::engine::assemble::uniform;
use crate::engine::constraints::Constraints;
use crate::engine::error::{FlowError, FlowFailure};
use crate::engine::outcome::Smoothed;
use crate::engine::run::Observer;
use crate::engine::run::{Run, RunSettings, StepNote};

fairing_parameters::options! {
    /// Options of [`scale_dependent`].
    #[derive(Debug, Clone, PartialEq)]
    #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
    #[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
    pub struct ScaleDependent {
        /// The fraction of the largest stable step.
        pub fraction: f64 = 0.5, in Range::FRACTION;
        /// The number of steps.
        pub iterations: usize = 10;
        /// Constraints of the vertices.
        pub constraints: Constraints = Constraints::NONE;
    }
    "scale-dependent": "explicit steps weighted by inverse edge lengths; for uneven meshes",
        ["fujiwara1995", "desbrun1999"];
}

/// Smooths by explicit steps with the scale-dependent umbrella operator, whose weights are the
/// inverse edge lengths of the current mesh.
///
/// ```text
/// (Lx)ᵢ = (2/Eᵢ) Σⱼ (xⱼ − xᵢ)/|eᵢⱼ|,    Eᵢ = Σⱼ |eᵢⱼ|
/// ```
///
/// Unlike uniform weights it hardly moves vertices within the surface where edges have different
/// lengths, and unlike cotangents its weights are never negative. It scales as 1/length², so a step
/// is a time. The largest stable step is the reciprocal of the largest `(2/Eᵢ) Σ 1/|eᵢⱼ|` of a
/// component, computed for each step, so that no step is unstable. Each component flows as it would
/// alone; observers see the smallest step.
///
/// # Errors
///
/// [`FlowError`] if an option is out of range; [`FlowFailure::NoLength`] if two neighbours
/// coincide.
///
/// # Examples
///
/// ```
/// use fairing_shapes as shapes;
/// use fairing_smoothing::{ScaleDependent, scale_dependent};
///
/// let smoothed = scale_dependent(&shapes::icosphere(2), &ScaleDependent::default(), None)?;
/// assert_eq!(smoothed.report.iterations, 10);
/// # Ok::<(), fairing_smoothing::FlowError>(())
/// ```
///
/// Source: \[fujiwara1995\], [desbrun1999].
///
/// [desbrun1999]: https://doi.org/10.1145/311535.311576
pub fn scale_dependent(
    mesh: &TriMesh,
    options: &ScaleDependent,
    observer: Option<&mut Observer<'_>>,
) -> Result<Smoothed, FlowError> {
    let fraction = options.fraction;
    options.check().map_err(|error| FlowFailure::from(error).before(mesh))?;
    let settings = RunSettings::new(&options.constraints, options.iterations);
    let run = Run::new(mesh, &settings, observer)?;
    let laplacian = uniform(run.arrangement.mesh(), &run.freedom.fixed);
    let connectivity = run.arrangement.mesh().connectivity().clone();
    let components = connectivity.topology().components();
    run.iterate(|_, mesh, freedom, next| {
        let x = mesh.positions();
        let rates = largest_rates(&laplacian, components, x)?;
        let step_at = |rate: f64| if rate > 0.0 { fraction / rate } else { 0.0 };
        let largest = rates.iter().copied().fold(0.0, larger);
        laplacian.visit(next, |i, neighbors, next| {
            let mut sum = [0.0; 3];
            let mut around = 0.0;
            for &j in neighbors {
                let length = DVec3::from(x[i]).distance(x[j as usize].into());
                if length > 0.0 {
                    around += length;
                    for k in 0..3 {
                        sum[k] += (x[j as usize][k] - x[i][k]) / length;
                    }
                }
            }
            let step = components.label(i as u32).map_or(0.0, |c| step_at(rates[c as usize]));
            let (w, target) = freedom.pull(i);
            let d = [0, 1, 2].map(|k| {
                let flow = if around > 0.0 { step * 2.0 / around * sum[k] } else { 0.0 };
                (flow + w * (target[k] - x[i][k])) / (1.0 + w)
            });
            let d = freedom.project(i, d);
            *next = [x[i][0] + d[0], x[i][1] + d[1], x[i][2] + d[2]];
        });
        Ok(StepNote { step_size: step_at(largest), residual: None })
    })
}

/// The largest `(2/Eᵢ) Σ 1/|eᵢⱼ|` of each component; by Gershgorin's circles, eigenvalues of `−L`
/// are at most twice as large.
fn largest_rates(
    laplacian: &GraphLaplacian,
    components: &Components,
    x: &[[f64; 3]],
) -> Result<Vec<f64>, FlowFailure> {
    let mut largest = vec![0.0f64; components.count()];
    for i in 0..laplacian.len() {
        let (mut around, mut inverse) = (0.0, 0.0);
        for &j in laplacian.neighbors(i) {
            // A fixed or isolated vertex is its own neighbour.
            if j as usize == i {
                continue;
            }
            let length = DVec3::from(x[i]).distance(x[j as usize].into());
            if length == 0.0 {
                return Err(FlowFailure::NoLength { vertex: i as u32, neighbor: j });
            }
            around += length;
            inverse += 1.0 / length;
        }
        if let Some(component) = components.label(i as u32).filter(|_| around > 0.0) {
            let largest = &mut largest[component as usize];
            *largest = larger(*largest, 2.0 / around * inverse);
        }
    }
    Ok(largest)
}

#[cfg(test)]
mod tests {
    use fairing_shapes as shapes;

    use super::*;

    /// A second component a thousand times smaller or larger does not change the flow of the first.
    #[test]
    fn components_flow_apart() {
        let ball = shapes::bumpy_sphere(2, 0.2, 5.0);
        let n = ball.vertex_count();
        let alone = scale_dependent(&ball, &ScaleDependent::default(), None).unwrap().mesh;
        for size in [1e-3, 1e3] {
            let other = ball.positions().iter().map(|p| p.map(|x| size * x + 3.0));
            let positions = ball.positions().iter().copied().chain(other).collect();
            let second = ball.faces().iter().map(|f| f.map(|v| v + n as u32));
            let faces = ball.faces().iter().copied().chain(second).collect();
            let both = TriMesh::new(positions, faces).unwrap();
            let both = scale_dependent(&both, &ScaleDependent::default(), None).unwrap().mesh;
            for (&p, &q) in alone.positions().iter().zip(both.positions()) {
                assert!(DVec3::from(p).distance(q.into()) < 1e-12, "{p:?} {q:?}");
            }
        }
    }
}
