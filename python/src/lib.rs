//! The extension module of the Python package `pyfairing`.
//!
//! Converts Python objects to values of the crates and back. Arguments are checked and get their
//! defaults in Python (`pyfairing/*.py`); the crates compute.

mod arrays;
mod denoising;
mod error;
mod evaluation;
mod figure;
mod geodesic;
mod heat;
mod mesh;
mod operators;
mod options;
mod repair;
mod run;
mod shapes;
mod smoothing;
mod spectrum;
mod surfaces;
mod tables;

use pyo3::prelude::*;

/// Reuses freed memory instead of returning it to the system.
#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

// No class has state that changes: all are frozen. The only global state is that of `run`, behind a
// lock. Arrays of callers are copied before other threads run.
#[pymodule(gil_used = false)]
fn _core(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    error::register(module)?;
    mesh::register(module)?;
    repair::register(module)?;
    operators::register(module)?;
    spectrum::register(module)?;
    geodesic::register(module)?;
    heat::register(module)?;
    smoothing::register(module)?;
    denoising::register(module)?;
    evaluation::register(module)?;
    figure::register(module)?;
    shapes::register(module)?;
    surfaces::register(module)?;
    tables::register(module)
}
