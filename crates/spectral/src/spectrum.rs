//! Eigenvalues and modes with their mass: the transform and its inverse.

use fairing_operators::MassMatrix;
use fairing_sparse::{Beyond, multiply_block};
use ndarray::{Array2, ArrayView2, Axis, Slice};

use crate::error::SpectralError;

/// The k smoothest modes of a mesh.
///
/// Modes with equal eigenvalues are an arbitrary basis of their eigenspace; [`Spectrum::clusters`]
/// groups them. The error of ωᵢ is at most its residual rᵢ (or rᵢ² / gap if less), and the angle
/// error of φᵢ is rᵢ / gap, where gap is the distance to the nearest ω of another cluster. Results
/// on processors that round in another order differ by as much. Rounding adds some ε φᵀ|S|φ to ω.
///
/// Every mode is 0 at isolated and fixed vertices.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Spectrum {
    /// ω, ascending, in 1/(mesh units)² (dimensionless for graph spectra).
    pub values: Vec<f64>,
    /// `n × k`, a mode in each column, Φᵀ M Φ = I; in 1/(mesh unit).
    pub modes: Array2<f64>,
    /// ‖S φ − ω M φ‖ in the M⁻¹ norm of each mode, in the unit of ω.
    pub residuals: Vec<f64>,
    /// M over all vertices; 0 at isolated vertices.
    pub mass: MassMatrix,
    /// True if an inertia count or a dense decomposition, both in floating point, verified that no
    /// smaller eigenvalue was missed. The accuracy of the pairs is a separate matter: `residuals`
    /// are within [`EigenOptions::residual_limit`] or the rounding of each vector, certified or
    /// not.
    ///
    /// [`EigenOptions::residual_limit`]: fairing_sparse::EigenOptions::residual_limit
    pub certified: bool,
    /// Known eigenvalues after the last mode.
    pub beyond: Beyond,
}

impl Spectrum {
    /// Number of modes k.
    pub fn len(&self) -> usize {
        self.values.len()
    }

    /// Returns true if there are no modes.
    pub fn is_empty(&self) -> bool {
        self.values.is_empty()
    }

    /// Number of vertices n.
    pub fn vertex_count(&self) -> usize {
        self.modes.nrows()
    }

    /// The total mass 1ᵀ M 1: the area of the mesh.
    pub fn area(&self) -> f64 {
        self.mass.as_mass().total()
    }

    /// Keeps the first k modes. [`Spectrum::split`] of the result at k is the cluster that this
    /// splits, if any.
    ///
    /// # Errors
    ///
    /// [`SpectralError::TooManyModes`].
    pub fn truncated(&self, k: usize) -> Result<Self, SpectralError> {
        self.check_modes(k)?;
        let mut following = self.values[k..].to_vec();
        following.extend(&self.beyond.values);
        Ok(Self {
            beyond: Beyond::new(following, self.beyond.clear_below),
            values: self.values[..k].to_vec(),
            modes: self.modes.slice_axis(Axis(1), Slice::from(..k)).to_owned(),
            residuals: self.residuals[..k].to_vec(),
            mass: self.mass.clone(),
            certified: self.certified,
        })
    }

    /// Coefficients Φᵀ M F, `k × d`, of a field F with d columns; in squared mesh units for
    /// positions.
    ///
    /// # Errors
    ///
    /// [`SpectralError::Rows`].
    ///
    /// Source: [vallet2008].
    ///
    /// [vallet2008]: https://doi.org/10.1111/j.1467-8659.2008.01122.x
    pub fn transform(&self, field: ArrayView2<'_, f64>) -> Result<Array2<f64>, SpectralError> {
        self.check_rows(field.nrows(), self.vertex_count())?;
        Ok(self.modes.t().dot(&times(&self.mass, field)))
    }

    /// The field Σ φᵢ cᵢ, `n × d`, from the first coefficients (k or fewer).
    ///
    /// # Errors
    ///
    /// [`SpectralError::TooManyModes`].
    pub fn inverse(&self, coefficients: ArrayView2<'_, f64>) -> Result<Array2<f64>, SpectralError> {
        let k = coefficients.nrows();
        self.check_modes(k)?;
        Ok(self.modes.slice_axis(Axis(1), Slice::from(..k)).dot(&coefficients))
    }

    /// Energy per mode: Σ over columns of c². With all modes they sum to trace(Fᵀ M F) (Parseval).
    pub fn energies(coefficients: ArrayView2<'_, f64>) -> Vec<f64> {
        coefficients.rows().into_iter().map(|c| c.dot(&c)).collect()
    }

    /// Truncation error of keeping k modes, for k = 0 … len().
    ///
    /// Entry k is the M-weighted RMS √(‖F − F_k‖²_M / area), by Parseval
    /// √((‖F‖²_M − Σ_(i<k) |cᵢ|²) / area), in units of the field.
    ///
    /// # Errors
    ///
    /// [`SpectralError::Rows`].
    pub fn truncation_errors(&self, field: ArrayView2<'_, f64>) -> Result<Vec<f64>, SpectralError> {
        let coefficients = self.transform(field)?;
        // The first mode carries most of the norm and none of the error: the remainder after all
        // modes is measured instead of subtracted, and the energies are added to it from the last
        // to the first.
        let rest = &field - &self.inverse(coefficients.view())?;
        let mut square = (&rest * &times(&self.mass, rest.view())).sum().max(0.0);
        let area = self.area();
        let mut errors = vec![(square / area).sqrt()];
        for energy in Self::energies(coefficients.view()).into_iter().rev() {
            square += energy;
            errors.push((square / area).sqrt());
        }
        errors.reverse();
        Ok(errors)
    }

    pub(crate) fn check_rows(&self, found: usize, expected: usize) -> Result<(), SpectralError> {
        if found == expected { Ok(()) } else { Err(SpectralError::Rows { found, expected }) }
    }

    pub(crate) fn check_modes(&self, wanted: usize) -> Result<(), SpectralError> {
        let available = self.len();
        if wanted <= available {
            Ok(())
        } else {
            Err(SpectralError::TooManyModes { wanted, available })
        }
    }
}

/// M X.
fn times(mass: &MassMatrix, x: ArrayView2<'_, f64>) -> Array2<f64> {
    match mass {
        MassMatrix::Lumped(diagonal) => {
            let mut y = x.to_owned();
            for (mut row, m) in y.rows_mut().into_iter().zip(diagonal) {
                row *= *m;
            }
            y
        }
        MassMatrix::Consistent(matrix) => multiply_block(matrix, x),
    }
}
