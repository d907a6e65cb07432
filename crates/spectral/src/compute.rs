//! Computing spectra of meshes and of their graphs.

use fairing_mesh::TriMesh;
use fairing_operators::{Laplacian, LaplacianKind, MassKind};
use fairing_sparse::{EigenOptions, smallest_eigenpairs};
use ndarray::Array2;

use crate::error::SpectralError;
use crate::spectrum::Spectrum;

/// Settings of [`spectrum`].
#[derive(Debug, Clone, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
pub struct SpectrumOptions {
    /// Vertices where modes vanish, in any order; the boundary is natural (zero flux) elsewhere.
    pub fixed: Vec<u32>,
    /// The solver.
    pub eigen: EigenOptions,
}

impl SpectrumOptions {
    /// Dirichlet conditions: modes vanish on the boundary of the mesh.
    pub fn dirichlet(mesh: &TriMesh) -> Self {
        let boundary = mesh.topology().boundary_vertices();
        let fixed = (0..boundary.len() as u32).filter(|&v| boundary[v as usize]).collect();
        Self { fixed, eigen: EigenOptions::default() }
    }
}

/// The k smoothest modes of a Laplacian, S φ = ω M φ.
///
/// ω in 1/(mesh units)². Vertices without faces have the value 0 in every mode.
///
/// # Errors
///
/// [`SpectralError::TooManyModes`]; [`SpectralError::Operator`] for a fixed vertex that does not
/// exist or a mass that is not positive; [`SpectralError::Sparse`] if the solver fails.
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
/// Source: [vallet2008].
///
/// [vallet2008]: https://doi.org/10.1111/j.1467-8659.2008.01122.x
#[doc(alias("eigs", "manifold_harmonics"))]
pub fn spectrum(
    laplacian: &Laplacian,
    k: usize,
    options: &SpectrumOptions,
) -> Result<Spectrum, SpectralError> {
    let part = laplacian.restricted(&options.fixed)?;
    let (n, kept) = (laplacian.vertex_count(), part.free());
    if k > kept.len() {
        return Err(SpectralError::TooManyModes { wanted: k, available: kept.len() });
    }
    let mass = part.mass().as_mass();
    let pairs = smallest_eigenpairs(part.stiffness(), mass, k, &options.eigen)?;
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
/// (D − A) φ = ω M φ with [`MassKind::Unit`], or with [`MassKind::Degree`] −L φ = ω φ for the
/// random walk L = D⁻¹A − I, whose modes are orthonormal in D: a plain transpose does not invert
/// them.
///
/// # Errors
///
/// As [`spectrum`].
pub fn graph_spectrum(
    mesh: &TriMesh,
    k: usize,
    mass: MassKind,
    options: &EigenOptions,
) -> Result<Spectrum, SpectralError> {
    let laplacian = Laplacian::new(mesh, LaplacianKind::Uniform, mass)?;
    spectrum(&laplacian, k, &SpectrumOptions { fixed: vec![], eigen: options.clone() })
}
