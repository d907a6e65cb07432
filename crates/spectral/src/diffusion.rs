//! Diffusion of heat on a mesh by implicit steps.

use fairing_mesh::TriMesh;
use fairing_operators::{LumpedArea, cotan_stiffness, lumped_mass};
use fairing_sparse::{Cholesky, Mass, combine};

use crate::error::SpectralError;

/// The heat equation Mu' = −S u in one backward Euler step, (M + tS) u = M u₀, factorised once.
///
/// Natural boundaries: no heat leaves the mesh. Vertices without faces keep their heat.
#[derive(Debug)]
pub struct HeatDiffusion {
    mass: Vec<f64>,
    factor: Cholesky,
}

impl HeatDiffusion {
    /// Factorises M + tS for a time t in squared mesh units; masses are barycentric.
    ///
    /// # Errors
    ///
    /// [`SpectralError::Parameter`] for a negative time; what assembling and factorising report.
    pub fn new(mesh: &TriMesh, time: f64) -> Result<Self, SpectralError> {
        check_time(time)?;
        let stiffness = cotan_stiffness(mesh)?;
        let mass = solvable_mass(mesh)?;
        let matrix = combine(1.0, Mass::Lumped(&mass), time, &stiffness);
        Ok(Self { factor: Cholesky::new(&matrix)?, mass })
    }

    /// The temperatures after the time, from those at the beginning.
    ///
    /// # Errors
    ///
    /// [`SpectralError::Rows`].
    pub fn step(&self, temperatures: &[f64]) -> Result<Vec<f64>, SpectralError> {
        let (found, expected) = (temperatures.len(), self.mass.len());
        if found != expected {
            return Err(SpectralError::Rows { found, expected });
        }
        let mut heat: Vec<f64> = temperatures.iter().zip(&self.mass).map(|(u, m)| u * m).collect();
        self.factor.solve_in_place(&mut heat);
        Ok(heat)
    }
}

/// Barycentric masses, with the mean mass at vertices without faces: their rows of S are zero, and any positive
/// number there keeps them apart from everything else.
pub(crate) fn solvable_mass(mesh: &TriMesh) -> Result<Vec<f64>, SpectralError> {
    let mut mass = lumped_mass(mesh, LumpedArea::Barycentric)?;
    let mean = mass.iter().sum::<f64>() / mass.len().max(1) as f64;
    let mut used = vec![false; mass.len()];
    for &v in mesh.faces().as_flattened() {
        used[v as usize] = true;
    }
    for (mass, used) in mass.iter_mut().zip(used) {
        if !used {
            *mass = if mean > 0.0 { mean } else { 1.0 };
        }
    }
    Ok(mass)
}

pub(crate) fn check_time(time: f64) -> Result<(), SpectralError> {
    if time >= 0.0 && time.is_finite() {
        return Ok(());
    }
    Err(SpectralError::Parameter { name: "time", value: time, must: "finite and not negative" })
}
