//! Computing spectra of meshes and of their graphs.

use std::ops::ControlFlow;

use fairing_mesh::TriMesh;
use fairing_operators::{Laplacian, LaplacianKind, MassKind};
use fairing_sparse::{EigenOptions, EigenWatch, smallest_eigenpairs_with};
use ndarray::Array2;

use crate::error::SpectralError;
use crate::spectrum::Spectrum;

/// How to compute a spectrum.
#[derive(Debug, Clone, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
pub struct SpectrumOptions {
    /// The vertices where modes vanish, in any order; everywhere else the boundary is natural (zero flux).
    pub fixed: Vec<u32>,
    /// The solver.
    pub eigen: EigenOptions,
}

impl SpectrumOptions {
    /// Modes vanish on the boundary of the mesh (Dirichlet).
    pub fn dirichlet(mesh: &TriMesh) -> Self {
        let boundary = mesh.topology().boundary_vertices();
        let fixed = (0..boundary.len() as u32).filter(|&v| boundary[v as usize]).collect();
        Self { fixed, eigen: EigenOptions::default() }
    }
}

/// Which graph Laplacian: both ignore the shape of the faces.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum GraphWeights {
    /// (D − A) φ = λ φ.
    Combinatorial,
    /// (D − A) φ = λ D φ, that is −L φ = λ φ with the random walk L = D⁻¹A − I. Modes are orthonormal in D:
    /// a plain transpose does not invert them.
    RandomWalk,
}

impl GraphWeights {
    fn mass(self) -> MassKind {
        match self {
            Self::Combinatorial => MassKind::Unit,
            Self::RandomWalk => MassKind::Degree,
        }
    }
}

/// The k smoothest modes of a Laplacian, S φ = λ M φ.
///
/// λ in 1/(mesh units)². Vertices without faces take no part: their value is 0 in every mode.
///
/// # Errors
///
/// [`SpectralError::TooManyModes`]; in [`SpectralError::Operator`], a fixed vertex that does not exist and a mass that
/// is not positive; the errors of solving.
///
/// # Examples
///
/// ```
/// use fairing_shapes as shapes;
/// use fairing_operators::Laplacian;
/// use fairing_spectral::{SpectrumOptions, spectrum};
/// // The unit sphere has 0, then three times 2.
/// let laplacian = Laplacian::auto(&shapes::icosphere(3))?;
/// let modes = spectrum(&laplacian, 4, &SpectrumOptions::default())?;
/// assert_eq!(modes.values[0], 0.0);
/// assert!((modes.values[1] - 2.0).abs() < 0.02);
/// # Ok::<(), fairing_spectral::SpectralError>(())
/// ```
///
/// Source: \[vallet2008\].
pub fn spectrum(
    laplacian: &Laplacian,
    k: usize,
    options: &SpectrumOptions,
) -> Result<Spectrum, SpectralError> {
    spectrum_with(laplacian, k, options, &mut |_| ControlFlow::Continue(()))
}

/// [`spectrum`] with a watch, which sees the progress and may cancel.
///
/// # Errors
///
/// As [`spectrum`].
pub fn spectrum_with(
    laplacian: &Laplacian,
    k: usize,
    options: &SpectrumOptions,
    watch: &mut EigenWatch<'_>,
) -> Result<Spectrum, SpectralError> {
    let part = laplacian.restricted(&options.fixed)?;
    let (n, kept) = (laplacian.vertex_count(), part.free());
    if k > kept.len() {
        return Err(SpectralError::TooManyModes { wanted: k, available: kept.len() });
    }
    let mass = part.mass().as_mass();
    let pairs = smallest_eigenpairs_with(part.stiffness(), mass, k, &options.eigen, watch)?;
    let modes = if kept.len() == n {
        pairs.vectors
    } else {
        let mut modes = Array2::zeros((n, k));
        for (row, &v) in pairs.vectors.rows().into_iter().zip(kept) {
            modes.row_mut(v as usize).assign(&row);
        }
        modes
    };
    Ok(Spectrum {
        values: pairs.values,
        modes,
        residuals: pairs.residuals,
        mass: laplacian.mass().clone(),
        certified: pairs.certified,
        beyond: pairs.beyond,
    })
}

/// The k smoothest modes of the graph of the edges, for comparison with those of the surface.
///
/// # Errors
///
/// As [`spectrum`].
pub fn graph_spectrum(
    mesh: &TriMesh,
    k: usize,
    weights: GraphWeights,
    options: &EigenOptions,
) -> Result<Spectrum, SpectralError> {
    let laplacian = Laplacian::new(mesh, LaplacianKind::Uniform, weights.mass())?;
    spectrum(&laplacian, k, &SpectrumOptions { fixed: vec![], eigen: options.clone() })
}
