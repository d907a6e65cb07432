//! Diffusion of heat on a mesh by implicit steps.

use fairing_mesh::OptionError;
use fairing_operators::{Laplacian, MassMatrix};
use fairing_sparse::{Cholesky, combine};

use crate::error::SpectralError;

/// The heat equation Mu' = −S u in one backward Euler step, (M + tS) u = M u₀, factorised once.
///
/// Natural boundaries: no heat leaves the mesh. Vertices without faces keep their heat.
///
/// # Examples
///
/// ```
/// use fairing_shapes as shapes;
/// use fairing_operators::Laplacian;
/// use fairing_spectral::HeatDiffusion;
///
/// // On the unit sphere Δz = −2z: one step divides z by 1 + 2t.
/// let sphere = shapes::icosphere(4);
/// let heat = HeatDiffusion::new(&Laplacian::auto(&sphere)?, 0.5)?;
/// let z: Vec<f64> = sphere.positions().iter().map(|p| p[2]).collect();
/// assert!(heat.step(&z)?.iter().zip(&z).all(|(u, z)| (u - 0.5 * z).abs() < 0.002));
/// # Ok::<(), fairing_spectral::SpectralError>(())
/// ```
#[derive(Debug)]
pub struct HeatDiffusion {
    mass: MassMatrix,
    factor: Cholesky,
}

impl HeatDiffusion {
    /// Factorises M + tS for a time t in squared mesh units.
    ///
    /// # Errors
    ///
    /// [`SpectralError::Option`] for a negative time; a mass that is not positive; the errors of factorising.
    pub fn new(laplacian: &Laplacian, time: f64) -> Result<Self, SpectralError> {
        OptionError::require_not_negative("time", time)?;
        let mass = laplacian.positive_mass()?.into_owned();
        let matrix = combine(1.0, mass.as_mass(), time, laplacian.stiffness());
        Ok(Self { factor: Cholesky::new(&matrix)?, mass })
    }

    /// The temperatures after the time, from those at the beginning.
    ///
    /// # Errors
    ///
    /// [`SpectralError::Rows`].
    pub fn step(&self, temperatures: &[f64]) -> Result<Vec<f64>, SpectralError> {
        let mass = self.mass.as_mass();
        let (found, expected) = (temperatures.len(), mass.len());
        if found != expected {
            return Err(SpectralError::Rows { found, expected });
        }
        let mut heat = mass.times(temperatures);
        self.factor.solve_in_place(&mut heat);
        Ok(heat)
    }
}
