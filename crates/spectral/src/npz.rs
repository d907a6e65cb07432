//! Spectra in files that numpy reads: `numpy.load("modes.npz")["modes"]`.

use std::fs::File;
use std::io;
use std::path::Path;

use fairing_mesh::io::write_whole;
use fairing_sparse::{Beyond, SparseMatrix};
use ndarray::{Array1, Array2};
use ndarray_npy::{NpzReader, NpzWriter};

use crate::error::SpectralError;
use crate::spectrum::{MassMatrix, Spectrum};

impl Spectrum {
    /// Writes `values` (k), `modes` (n × k), `residuals` (k), `certified` (1 or 0), the eigenvalues known `beyond`
    /// and what is `clear_below`, and the mass: `mass` (n) where lumped, `mass_indptr`, `mass_indices`, `mass_data`
    /// (CSR) where consistent. Whole or not at all.
    ///
    /// # Errors
    ///
    /// [`SpectralError::File`].
    pub fn save(&self, path: impl AsRef<Path>) -> Result<(), SpectralError> {
        let path = path.as_ref();
        write_whole(path, |file| self.write(file)).map_err(|e| problem(path, e))
    }

    fn write(&self, file: &mut File) -> io::Result<()> {
        let array = |values: &[f64]| Array1::from(values.to_vec());
        let mut npz = NpzWriter::new(file);
        let mut add = |name: &str, values: &[f64]| {
            npz.add_array(name, &array(values)).map_err(io::Error::other)
        };
        add("values", &self.values)?;
        add("residuals", &self.residuals)?;
        add("certified", &[f64::from(u8::from(self.certified))])?;
        add("beyond", &self.beyond.values)?;
        add("clear_below", &[self.beyond.clear_below])?;
        match &self.mass {
            MassMatrix::Lumped(diagonal) => add("mass", diagonal)?,
            MassMatrix::Consistent(matrix) => {
                add("mass_data", matrix.data())?;
                let starts = Array1::from(matrix.indptr().into_raw_storage().to_vec());
                npz.add_array("mass_indptr", &starts).map_err(io::Error::other)?;
                let columns = Array1::from(matrix.indices().to_vec());
                npz.add_array("mass_indices", &columns).map_err(io::Error::other)?;
            }
        }
        npz.add_array("modes", &self.modes).map_err(io::Error::other)?;
        npz.finish().map_err(io::Error::other)?;
        Ok(())
    }

    /// Reads what [`Spectrum::save`] has written. Without `beyond` nothing is known after the last eigenvalue.
    ///
    /// # Errors
    ///
    /// [`SpectralError::File`]: not to be read, an array missing, or shapes that do not fit.
    pub fn load(path: impl AsRef<Path>) -> Result<Self, SpectralError> {
        let path = path.as_ref();
        let file = File::open(path).map_err(|e| problem(path, e))?;
        let mut npz = NpzReader::new(file).map_err(|e| problem(path, e))?;
        let names = npz.names().map_err(|e| problem(path, e))?;
        let mut vector = |name: &str| -> Result<Vec<f64>, SpectralError> {
            let array: Array1<f64> = npz.by_name(name).map_err(|e| problem(path, e))?;
            Ok(array.to_vec())
        };
        let (values, residuals) = (vector("values")?, vector("residuals")?);
        let certified = vector("certified")? == [1.0];
        let has = |name: &str| names.iter().any(|n| n.trim_end_matches(".npy") == name);
        let beyond = if has("beyond") && has("clear_below") {
            let clear_below = vector("clear_below")?.first().copied();
            let clear_below = clear_below.ok_or_else(|| problem(path, "clear_below is empty"))?;
            Beyond { values: vector("beyond")?, clear_below }
        } else {
            Beyond { values: vec![], clear_below: values.last().copied().unwrap_or(0.0) }
        };
        let lumped = has("mass");
        let weights = vector(if lumped { "mass" } else { "mass_data" })?;
        let modes: Array2<f64> = npz.by_name("modes").map_err(|e| problem(path, e))?;
        let n = modes.nrows();
        let mass = if lumped {
            MassMatrix::Lumped(weights)
        } else {
            let mut indices = |name: &str| -> Result<Vec<u32>, SpectralError> {
                let array: Array1<u32> = npz.by_name(name).map_err(|e| problem(path, e))?;
                Ok(array.to_vec())
            };
            let (starts, columns) = (indices("mass_indptr")?, indices("mass_indices")?);
            let matrix = SparseMatrix::try_new((n, n), starts, columns, weights);
            MassMatrix::Consistent(matrix.map_err(|(.., e)| problem(path, e))?)
        };
        let k = values.len();
        let finite = values.iter().chain(&modes).chain(&residuals).all(|x| x.is_finite())
            && beyond.values.iter().all(|x| x.is_finite())
            && !beyond.clear_below.is_nan();
        if modes.ncols() != k || residuals.len() != k || mass.as_mass().len() != n || !finite {
            return Err(problem(path, "the arrays of the spectrum do not fit together"));
        }
        Ok(Self { values, modes, residuals, mass, certified, beyond })
    }
}

fn problem(path: &Path, problem: impl std::fmt::Display) -> SpectralError {
    SpectralError::File { path: path.display().to_string(), problem: problem.to_string() }
}
