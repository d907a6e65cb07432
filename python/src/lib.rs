//! The extension module of the Python package `pyfairing`.
//!
//! Converts Python objects to values of the crates and back. Arguments are checked and get their
//! defaults in Python (`pyfairing/*.py`); the crates compute.

mod arrays;
mod error;
mod evaluation;
mod figure;
mod geodesic;
mod mesh;
mod operators;
mod options;
mod repair;
mod run;
mod shapes;
mod smoothing;
mod solvers;
mod spectrum;
mod surfaces;
mod tables;
mod topology;

use pyo3::pymodule;

/// Reuses freed memory instead of returning it to the system.
#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

// No class has state that changes: all are frozen. The only global state is that of `run`, behind a
// lock. Arrays of callers are copied before other threads run.
#[pymodule(gil_used = false)]
mod _core {
    use pyo3::prelude::*;

    #[pymodule_export]
    use super::evaluation::{compare, noise, scan};
    #[pymodule_export]
    use super::figure::{png, render_mesh, viewer_page};
    #[pymodule_export]
    use super::geodesic::{Geodesics, isolines};
    #[pymodule_export]
    use super::geodesic::{Heat, poisson};
    #[pymodule_export]
    use super::mesh::{Mesh, from_polygons, read, read_bytes};
    #[pymodule_export]
    use super::operators::{
        curvature, divergence_of, gradient_of, laplacian, noise_level_of, polygon_laplacian,
    };
    #[pymodule_export]
    use super::repair::{closest, components, repair_mesh};
    #[pymodule_export]
    use super::shapes::shape;
    #[pymodule_export]
    use super::smoothing::denoise;
    #[pymodule_export]
    use super::smoothing::smooth;
    #[pymodule_export]
    use super::solvers::{Factor, eigsh};
    #[pymodule_export]
    use super::spectrum::{Spectrum, spectrum};
    #[pymodule_export]
    use super::surfaces::Surface;
    #[pymodule_export]
    use super::tables::tables;
    #[pymodule_export]
    use super::topology::{
        boundary_loops, corner_angles, dihedral_angles, face_neighbors, moments, special_edges,
    };

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("__version__", env!("CARGO_PKG_VERSION"))?;
        super::error::register(module)
    }
}
