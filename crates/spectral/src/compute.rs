//! Computing spectra of meshes and of their graphs.

use std::ops::ControlFlow;

use fairing_mesh::TriMesh;
use fairing_operators::intrinsic::{RobustOptions, robust_laplacian};
use fairing_operators::{
    LumpedArea, combinatorial_laplacian, consistent_mass, cotan_stiffness, lumped_mass,
};
use fairing_sparse::{EigenOptions, EigenWatch, Mass, SparseMatrix, smallest_eigenpairs_with};
use ndarray::Array2;

use crate::error::SpectralError;
use crate::spectrum::{MassMatrix, Spectrum};

/// Which mass belongs to the cotangent stiffness.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum MassKind {
    /// Diagonal, a third of the adjacent areas.
    #[default]
    Barycentric,
    /// Diagonal, mixed Voronoi areas.
    Mixed,
    /// Finite elements: eigenvalues approach those of the surface from above.
    Consistent,
}

/// What holds at the boundary of an open mesh.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum Boundary {
    /// Zero flux: the natural condition, constants are modes.
    #[default]
    Neumann,
    /// Modes vanish on the boundary.
    Dirichlet,
}

/// Where the stiffness comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum SurfaceOperator {
    /// The cotangents of the faces: refuses faces without area.
    #[default]
    Cotangent,
    /// The intrinsic Delaunay triangulation of the tufted cover, with its own barycentric mass: it
    /// exists for any mesh that has an edge with a length, faces without area and edges with many
    /// faces included. Source: \[sharp2020\].
    Robust,
}

/// How to compute a spectrum.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct SpectrumOptions {
    /// The stiffness.
    pub operator: SurfaceOperator,
    /// The mass.
    pub mass: MassKind,
    /// The boundary.
    pub boundary: Boundary,
    /// The solver.
    pub eigen: EigenOptions,
}

/// Which graph Laplacian: both ignore the shape of the faces.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum GraphWeights {
    /// (D − A) φ = λ φ.
    Combinatorial,
    /// (D − A) φ = λ D φ, that is −L φ = λ φ with the random walk L = D⁻¹A − I. Modes are orthonormal in D:
    /// a plain transpose does not invert them.
    RandomWalk,
}

/// The k smoothest modes of the Laplace–Beltrami operator, S φ = λ M φ.
///
/// λ in 1/(mesh units)². Vertices without faces take no part: their value is 0 in every mode.
///
/// # Errors
///
/// [`SpectralError::TooManyModes`], [`SpectralError::Mass`], [`SpectralError::RobustMass`] for a
/// robust operator with any but the barycentric mass, or what assembling and solving report.
///
/// # Examples
///
/// ```
/// use fairing_shapes as shapes;
/// use fairing_spectral::{SpectrumOptions, spectrum};
/// // The unit sphere has 0, then three times 2.
/// let modes = spectrum(&shapes::icosphere(3), 4, &SpectrumOptions::default())?;
/// assert_eq!(modes.values[0], 0.0);
/// assert!((modes.values[1] - 2.0).abs() < 0.02);
/// # Ok::<(), fairing_spectral::SpectralError>(())
/// ```
///
/// Source: \[vallet2008\].
pub fn spectrum(
    mesh: &TriMesh,
    k: usize,
    options: &SpectrumOptions,
) -> Result<Spectrum, SpectralError> {
    spectrum_with(mesh, k, options, &mut |_| ControlFlow::Continue(()))
}

/// [`spectrum`] with a watch, which sees the progress and may cancel.
///
/// # Errors
///
/// As [`spectrum`].
pub fn spectrum_with(
    mesh: &TriMesh,
    k: usize,
    options: &SpectrumOptions,
    watch: &mut EigenWatch<'_>,
) -> Result<Spectrum, SpectralError> {
    let (stiffness, mass) = operators(mesh, options)?;
    let topology = mesh.topology();
    let mut kept = with_faces(mesh);
    if options.boundary == Boundary::Dirichlet {
        kept.retain(|&v| !topology.is_boundary_vertex(v));
    }
    solve(&stiffness, mass, &kept, k, &options.eigen, watch)
}

fn operators(
    mesh: &TriMesh,
    options: &SpectrumOptions,
) -> Result<(SparseMatrix, MassMatrix), SpectralError> {
    if options.operator == SurfaceOperator::Robust {
        if options.mass != MassKind::Barycentric {
            return Err(SpectralError::RobustMass);
        }
        let robust = robust_laplacian(mesh, RobustOptions::default())?;
        return Ok((robust.stiffness, MassMatrix::Lumped(robust.mass)));
    }
    let stiffness = cotan_stiffness(mesh)?;
    let mass = match options.mass {
        MassKind::Barycentric => MassMatrix::Lumped(lumped_mass(mesh, LumpedArea::Barycentric)?),
        MassKind::Mixed => MassMatrix::Lumped(lumped_mass(mesh, LumpedArea::Mixed)?),
        MassKind::Consistent => MassMatrix::Consistent(consistent_mass(mesh)?),
    };
    Ok((stiffness, mass))
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
    let laplacian = combinatorial_laplacian(mesh)?;
    let mut mass = vec![0.0; mesh.vertex_count()];
    let kept = with_faces(mesh);
    for &v in &kept {
        mass[v as usize] = match weights {
            GraphWeights::Combinatorial => 1.0,
            GraphWeights::RandomWalk => {
                laplacian.get(v as usize, v as usize).copied().unwrap_or(0.0)
            }
        };
    }
    let mass = MassMatrix::Lumped(mass);
    solve(&laplacian, mass, &kept, k, options, &mut |_| ControlFlow::Continue(()))
}

fn with_faces(mesh: &TriMesh) -> Vec<u32> {
    let mut used = vec![false; mesh.vertex_count()];
    for &v in mesh.faces().as_flattened() {
        used[v as usize] = true;
    }
    (0..mesh.vertex_count() as u32).filter(|&v| used[v as usize]).collect()
}

/// Solves on the kept vertices and puts zeros elsewhere.
fn solve(
    stiffness: &SparseMatrix,
    mass: MassMatrix,
    kept: &[u32],
    k: usize,
    options: &EigenOptions,
    watch: &mut EigenWatch<'_>,
) -> Result<Spectrum, SpectralError> {
    if k > kept.len() {
        return Err(SpectralError::TooManyModes { wanted: k, available: kept.len() });
    }
    let diagonal = mass.as_mass().diagonal();
    for &vertex in kept {
        let mass = diagonal[vertex as usize];
        if mass.is_nan() || mass <= 0.0 {
            return Err(SpectralError::Mass { vertex, mass });
        }
    }
    let n = stiffness.rows();
    let whole = kept.len() == n;
    let pairs = if whole {
        smallest_eigenpairs_with(stiffness, mass.as_mass(), k, options, watch)?
    } else {
        let s = submatrix(stiffness, kept);
        match &mass {
            MassMatrix::Lumped(_) => {
                let m: Vec<f64> = kept.iter().map(|&v| diagonal[v as usize]).collect();
                smallest_eigenpairs_with(&s, Mass::Lumped(&m), k, options, watch)?
            }
            MassMatrix::Consistent(matrix) => {
                let m = submatrix(matrix, kept);
                smallest_eigenpairs_with(&s, Mass::Consistent(&m), k, options, watch)?
            }
        }
    };
    let modes = if whole {
        pairs.vectors
    } else {
        let mut modes = Array2::zeros((n, k));
        for (row, &v) in kept.iter().enumerate() {
            modes.row_mut(v as usize).assign(&pairs.vectors.row(row));
        }
        modes
    };
    Ok(Spectrum {
        values: pairs.values,
        modes,
        residuals: pairs.residuals,
        mass,
        certified: pairs.certified,
        beyond: pairs.beyond,
    })
}

/// Rows and columns of the kept vertices, which ascend.
fn submatrix(matrix: &SparseMatrix, kept: &[u32]) -> SparseMatrix {
    let mut place = vec![u32::MAX; matrix.cols()];
    for (new, &old) in kept.iter().enumerate() {
        place[old as usize] = new as u32;
    }
    let mut starts = vec![0];
    let (mut columns, mut values) = (vec![], vec![]);
    for &v in kept {
        if let Some(row) = matrix.outer_view(v as usize) {
            for (j, &value) in row.iter() {
                if place[j] != u32::MAX {
                    columns.push(place[j]);
                    values.push(value);
                }
            }
        }
        starts.push(columns.len() as u32);
    }
    SparseMatrix::new((kept.len(), kept.len()), starts, columns, values)
}
