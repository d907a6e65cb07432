//! Diffusion of heat on a mesh by implicit steps.

use fairing_operators::{Laplacian, MassMatrix};
use fairing_parameters::{ParameterError, Range};
use fairing_sparse::{GraphSystem, combine};

use crate::error::SpectralError;

/// The heat equation Mu' = −S u in one backward Euler step, (M + tS) u = M u₀, factorised once.
///
/// Natural boundaries: no heat leaves the mesh. The heat of every component is conserved to
/// rounding for any time, because its mean is removed before the solve ([`GraphSystem`]). Vertices
/// without faces keep their heat.
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
#[doc(alias = "diffusion")]
#[derive(Debug)]
pub struct HeatDiffusion {
    mass: MassMatrix,
    /// Factor of M in the system: 1, or 1/t for long times.
    scale: f64,
    system: GraphSystem,
}

/// Time from which the equation is divided by the time, so that no time is too long; in units of
/// the least ratio of the mass to the diagonal of S.
const LONG: f64 = 100.0;

impl HeatDiffusion {
    /// Factorises M + tS for a time t in squared mesh units.
    ///
    /// # Errors
    ///
    /// [`SpectralError::Option`] for a negative time; a mass that is not positive; errors of the
    /// factorisation.
    pub fn new(laplacian: &Laplacian, time: f64) -> Result<Self, SpectralError> {
        Range::NOT_NEGATIVE.check("time", time)?;
        let mass = laplacian.positive_mass()?.into_owned();
        let (weights, diagonal) = (mass.lumped(), laplacian.stiffness().diag());
        let is_long = |(v, &s): (usize, &f64)| time * s > LONG * weights[v];
        let (scale, time) =
            if diagonal.iter().any(is_long) { (1.0 / time, 1.0) } else { (1.0, time) };
        let matrix = combine(scale, mass.as_mass(), time, laplacian.stiffness());
        let added = weights.iter().map(|m| scale * m).collect();
        let given = vec![false; weights.len()];
        let system = GraphSystem::new(&matrix, added, &weights, &given, None)?;
        drop(weights);
        Ok(Self { mass, scale, system })
    }

    /// The temperatures after time t, from the initial temperatures.
    ///
    /// # Errors
    ///
    /// [`SpectralError::Rows`]; [`SpectralError::Option`] for a temperature that is not finite;
    /// [`SpectralError::Sparse`] if rounding leaves too few digits of the solution.
    pub fn step(&self, temperatures: &[f64]) -> Result<Vec<f64>, SpectralError> {
        let mass = self.mass.as_mass();
        let (found, expected) = (temperatures.len(), mass.len());
        if found != expected {
            return Err(SpectralError::Rows { found, expected });
        }
        if let Some(&value) = temperatures.iter().find(|x| !x.is_finite()) {
            return Err(ParameterError::range("temperature", value, "finite").into());
        }
        let heat = mass.times(temperatures);
        let mut u = temperatures.to_vec();
        self.system.solve(|v| [self.scale * heat[v]], u.as_chunks_mut().0)?;
        Ok(u)
    }
}
