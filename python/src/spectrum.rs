//! Spectra of the Laplacian.

use std::path::PathBuf;
use std::sync::Arc;

use fairing_operators::{LaplacianKind, MassKind};
use fairing_spectral::{
    self as spectral, Rest, SpectrumOptions, Split, global_point_signature, heat_kernel_signature,
    heat_kernel_times, reconstruct, shape_dna, wave_kernel_energies, wave_kernel_signature,
};
use ndarray::Array2;
use numpy::{PyArray1, PyArray2, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::arrays::{Rows, column, matrix, values, view};
use crate::error::Error;
use crate::mesh::Mesh;
use crate::operators::{PyMass, assemble, mass};
use crate::options::{choose, named};
use crate::run::Call;

/// The smoothest modes of a mesh.
#[pyclass(frozen, module = "pyfairing._core")]
pub(crate) struct Spectrum {
    inner: Arc<spectral::Spectrum>,
}

impl From<spectral::Spectrum> for Spectrum {
    fn from(spectrum: spectral::Spectrum) -> Self {
        Self { inner: Arc::new(spectrum) }
    }
}

impl Spectrum {
    fn share(&self) -> Arc<spectral::Spectrum> {
        Arc::clone(&self.inner)
    }
}

/// The numbers of modes below and above that split no cluster.
type Numbers = (usize, Option<usize>);

fn numbers(split: Option<Split>) -> Option<Numbers> {
    split.map(|s| (s.below, s.above))
}

fn owned(array: &PyReadonlyArray2<'_, f64>) -> Array2<f64> {
    array.as_array().to_owned()
}

#[pymethods]
impl Spectrum {
    #[getter]
    fn values<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &self.inner.values)
    }

    #[getter]
    fn residuals<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &self.inner.residuals)
    }

    /// `n × k`, a view that keeps the spectrum alive.
    #[getter]
    fn modes<'py>(slf: &Bound<'py, Self>) -> Bound<'py, PyArray2<f64>> {
        view(slf.get().inner.modes.view(), slf.clone().into_any())
    }

    #[getter]
    fn mass<'py>(&self, py: Python<'py>) -> PyMass<'py> {
        mass(py, self.inner.mass.clone())
    }

    #[getter]
    fn certified(&self) -> bool {
        self.inner.certified
    }

    #[getter]
    fn area(&self) -> f64 {
        self.inner.area()
    }

    fn clusters(&self) -> Vec<(usize, usize)> {
        self.inner.clusters().into_iter().map(|range| (range.start, range.end)).collect()
    }

    fn split(&self, k: usize) -> Option<(usize, Option<usize>)> {
        numbers(self.inner.split(k))
    }

    fn truncated(&self, k: usize) -> PyResult<Self> {
        Ok(self.inner.truncated(k).map_err(Error::from)?.into())
    }

    fn project<'py>(
        &self,
        py: Python<'py>,
        field: PyReadonlyArray2<'_, f64>,
        call: Call,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let (spectrum, field) = (self.share(), owned(&field));
        Ok(matrix(py, call.run(py, move || Ok(spectrum.transform(field.view())?))?))
    }

    fn expand<'py>(
        &self,
        py: Python<'py>,
        coefficients: PyReadonlyArray2<'_, f64>,
        call: Call,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let (spectrum, coefficients) = (self.share(), owned(&coefficients));
        Ok(matrix(py, call.run(py, move || Ok(spectrum.inverse(coefficients.view())?))?))
    }

    fn reconstruct(
        &self,
        py: Python<'_>,
        mesh: &Mesh,
        k: usize,
        call: Call,
    ) -> PyResult<(Mesh, Option<Numbers>)> {
        let (spectrum, mesh) = (self.share(), mesh.share());
        let found = call.run(py, move || Ok(reconstruct(&mesh, &spectrum, k)?))?;
        Ok((found.mesh.into(), numbers(found.split)))
    }

    /// `responses` at each λ; `rest` scales the part outside the modes, `None` drops it.
    fn filter<'py>(
        &self,
        py: Python<'py>,
        field: PyReadonlyArray2<'_, f64>,
        responses: PyReadonlyArray1<'_, f64>,
        rest: Option<f64>,
        call: Call,
    ) -> PyResult<(Rows<'py>, Option<Numbers>)> {
        let (spectrum, field, responses) = (self.share(), owned(&field), values(&responses));
        let found = call.run(py, move || {
            if responses.len() != spectrum.len() {
                let (found, k) = (responses.len(), spectrum.len());
                return Err(Error::option(format!("{found} responses for {k} modes")));
            }
            let rest = rest.map_or(Rest::Dropped, Rest::Scaled);
            // The crate calls the response for each λ in order.
            let next = std::cell::Cell::new(0);
            let response = |_| responses[next.replace(next.get() + 1)];
            Ok(spectrum.filter(field.view(), response, rest)?)
        })?;
        Ok((matrix(py, found.field), numbers(found.split)))
    }

    fn truncation_errors<'py>(
        &self,
        py: Python<'py>,
        field: PyReadonlyArray2<'_, f64>,
        call: Call,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let (spectrum, field) = (self.share(), owned(&field));
        Ok(column(py, call.run(py, move || Ok(spectrum.truncation_errors(field.view())?))?))
    }

    fn heat_kernel_times<'py>(&self, py: Python<'py>, count: usize) -> Bound<'py, PyArray1<f64>> {
        column(py, heat_kernel_times(&self.inner, count))
    }

    fn heat_kernel_signature<'py>(
        &self,
        py: Python<'py>,
        times: PyReadonlyArray1<'_, f64>,
        call: Call,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let (spectrum, times) = (self.share(), values(&times));
        Ok(matrix(py, call.run(py, move || Ok(heat_kernel_signature(&spectrum, &times)?))?))
    }

    fn wave_kernel_energies<'py>(
        &self,
        py: Python<'py>,
        count: usize,
    ) -> PyResult<(Bound<'py, PyArray1<f64>>, f64)> {
        let (energies, sigma) = wave_kernel_energies(&self.inner, count).map_err(Error::from)?;
        Ok((column(py, energies), sigma))
    }

    fn wave_kernel_signature<'py>(
        &self,
        py: Python<'py>,
        energies: PyReadonlyArray1<'_, f64>,
        sigma: f64,
        call: Call,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let (spectrum, energies) = (self.share(), values(&energies));
        let found =
            call.run(py, move || Ok(wave_kernel_signature(&spectrum, &energies, sigma)?))?;
        Ok(matrix(py, found))
    }

    fn global_point_signature<'py>(
        &self,
        py: Python<'py>,
        call: Call,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let spectrum = self.share();
        Ok(matrix(py, call.run(py, move || Ok(global_point_signature(&spectrum)))?))
    }

    fn shape_dna<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        column(py, shape_dna(&self.inner).to_vec())
    }

    fn save(&self, py: Python<'_>, path: PathBuf, call: Call) -> PyResult<()> {
        let spectrum = self.share();
        call.run(py, move || Ok(spectrum.save(&path)?))
    }

    fn to_bytes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        Ok(PyBytes::new(py, &self.inner.to_bytes().map_err(Error::from)?))
    }

    #[staticmethod]
    fn from_bytes(bytes: &[u8]) -> PyResult<Self> {
        Ok(spectral::Spectrum::from_bytes(bytes).map_err(Error::from)?.into())
    }

    #[staticmethod]
    fn load(py: Python<'_>, path: PathBuf, call: Call) -> PyResult<Self> {
        Ok(call.run(py, move || Ok(spectral::Spectrum::load(&path)?))?.into())
    }
}

#[expect(clippy::too_many_arguments, reason = "named in Python")]
#[pyfunction]
pub(crate) fn spectrum(
    py: Python<'_>,
    mesh: &Mesh,
    k: usize,
    kind: &str,
    mass_kind: &str,
    boundary: &str,
    fixed: Vec<u32>,
    call: Call,
) -> PyResult<(Spectrum, &'static str, Option<String>)> {
    let (kind, mass_kind) = (named::<LaplacianKind>(kind)?, named::<MassKind>(mass_kind)?);
    let dirichlet = choose("boundary", boundary, &[("neumann", false), ("dirichlet", true)])?;
    let mesh = mesh.share();
    let (found, taken, note) = call.run(py, move || {
        if k == 0 {
            return Err(Error::option("k is 0, but must be 1 or more"));
        }
        let (laplacian, note) = assemble(&mesh, kind, mass_kind)?;
        let mut options =
            if dirichlet { SpectrumOptions::dirichlet(&mesh) } else { SpectrumOptions::default() };
        options.fixed.extend(fixed);
        let found = spectral::spectrum(&laplacian, k, &options)?;
        Ok((found, laplacian.kind().name(), note))
    })?;
    Ok((found.into(), taken, note))
}
