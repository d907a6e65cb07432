//! The extension module of the Python package `pyfairing`.
//!
//! It maps objects of Python to values of the crates and back: arguments are
//! checked and given their defaults in Python (`pyfairing/*.py`), numbers are
//! computed in the crates. Everything here is the way in between.

mod arrays;
mod denoising;
mod error;
mod evaluation;
mod figure;
mod heat;
mod mesh;
mod operators;
mod options;
mod run;
mod shapes;
mod smoothing;
mod spectrum;
mod surfaces;
mod tables;

use pyo3::prelude::*;

/// Memory that a result has left is used again, not returned and cleared.
#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

#[pymodule]
fn _core(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    error::register(module)?;
    mesh::register(module)?;
    operators::register(module)?;
    spectrum::register(module)?;
    heat::register(module)?;
    smoothing::register(module)?;
    denoising::register(module)?;
    evaluation::register(module)?;
    figure::register(module)?;
    shapes::register(module)?;
    surfaces::register(module)?;
    tables::register(module)
}
