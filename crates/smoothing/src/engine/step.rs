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

    /// The positions before this step.
    pub fn positions_before(&self) -> &[[f64; 3]] {
        self.before
    }

    /// The largest displacement of a vertex in this step, in mesh units. Computed when called.
    pub fn largest_displacement(&self) -> f64 {
        self.squared_displacements().fold(0.0, f64::max).sqrt()
    }

    /// The root mean square displacement of the vertices in this step, in mesh units. Computed when
    /// called.
    pub fn rms_displacement(&self) -> f64 {
        let n = self.before.len().max(1) as f64;
        (self.squared_displacements().sum::<f64>() / n).sqrt()
    }

    /// The signed volume `⅙ Σ a · (b × c)`, in cubed mesh units, of the
    /// [oriented](TriMesh::oriented) mesh about the centre of its bounding box: the enclosed volume
    /// if the mesh is closed. Computed when called.
    pub fn volume(&self) -> f64 {
        self.mesh.signed_volume()
    }

    /// The surface area, in squared mesh units: the energy that cotangent flows decrease. Computed
    /// when called.
    pub fn area(&self) -> f64 {
        (0..self.mesh.face_count()).map(|f| self.mesh.face_area(f)).sum()
    }

    /// Half the sum of squared edge lengths, in squared mesh units: the energy that uniform flows
    /// decrease. Computed when called.
    pub fn edge_energy(&self) -> f64 {
        let x = self.mesh.positions();
        let edges = self.mesh.topology().edges().iter();
        let sum = edges
            .map(|&[a, b]| DVec3::from(x[a as usize]).distance_squared(x[b as usize].into()))
            .sum::<f64>();
        0.5 * sum
    }

    /// The largest relative residual of the linear systems of this step; `None` for explicit steps.
    pub fn residual(&self) -> Option<f64> {
        self.residual
    }

    fn squared_displacements(&self) -> impl Iterator<Item = f64> + '_ {
        let pairs = self.before.iter().zip(self.positions());
        pairs.map(|(&a, &b)| DVec3::from(b).distance_squared(a.into()))
    }
}
