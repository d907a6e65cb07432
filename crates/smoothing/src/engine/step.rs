//! The view of a running flow given to its observer.

use std::ops::ControlFlow;

use fairing_mesh::TriMesh;
use glam::DVec3;

/// A callback invoked after every step; `ControlFlow::Break` ends the flow.
///
/// # Examples
///
/// Stop as soon as no vertex moves by more than a thousandth of an edge:
///
/// ```
/// use std::ops::ControlFlow;
/// use fairing_shapes as shapes;
/// use fairing_smoothing::{Diffusion, Explicit, Step, explicit};
///
/// let sphere = shapes::icosphere(3);
/// let small = 1e-3 * sphere.mean_edge_length();
/// let options = Explicit { iterations: 1000, ..Explicit::new(Diffusion::uniform(0.5)) };
/// let mut observer = |step: &Step<'_>| match step.largest_displacement() < small {
///     true => ControlFlow::Break(()),
///     false => ControlFlow::Continue(()),
/// };
/// let smoothed = explicit(&sphere, &options, Some(&mut observer))?;
/// assert!(smoothed.report.stopped);
/// # Ok::<(), fairing_smoothing::FlowError>(())
/// ```
pub type Observer<'a> = dyn FnMut(&Step<'_>) -> ControlFlow<()> + 'a;

/// A completed step of a flow.
pub struct Step<'a> {
    pub(crate) iteration: usize,
    pub(crate) step_size: f64,
    pub(crate) before: &'a [[f64; 3]],
    pub(crate) mesh: &'a TriMesh,
    pub(crate) residual: Option<f64>,
}

impl Step<'_> {
    /// The number of this step, from 1.
    pub fn iteration(&self) -> usize {
        self.iteration
    }

    /// The factor of the Laplacian in this step: λ for uniform weights, a time in squared mesh
    /// units for cotangent weights.
    pub fn step_size(&self) -> f64 {
        self.step_size
    }

    /// The mesh after this step, by reference without a copy.
    pub fn mesh(&self) -> &TriMesh {
        self.mesh
    }

    /// The positions after this step, in the vertex order of the input.
    pub fn positions(&self) -> &[[f64; 3]] {
        self.mesh.positions()
    }

    /// The largest displacement of a vertex in this step, in mesh units. Computed when called.
    pub fn largest_displacement(&self) -> f64 {
        let pairs = self.before.iter().zip(self.positions());
        let squares = pairs.map(|(&a, &b)| DVec3::from(b).distance_squared(a.into()));
        squares.fold(0.0, f64::max).sqrt()
    }

    /// The largest relative residual of the linear systems of this step; `None` for explicit steps.
    pub fn residual(&self) -> Option<f64> {
        self.residual
    }
}
