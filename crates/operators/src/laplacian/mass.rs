//! The masses of a Laplacian.

use std::borrow::Cow;

use fairing_mesh::TriMesh;
use fairing_sparse::{Mass, SparseMatrix};

use crate::error::OperatorError;
use crate::kind::LumpedArea;
use crate::kind::{LaplacianKind, MassKind};
use crate::mass::{consistent_on_pattern, lumped_mass};
use crate::stiffness::degrees;

/// A mass matrix, diagonal or sparse.
#[derive(Debug, Clone, PartialEq)]
pub enum MassMatrix {
    /// A diagonal, in squared mesh units ([`MassKind::Degree`] and
    /// [`MassKind::Unit`]: dimensionless).
    Lumped(Vec<f64>),
    /// A sparse matrix, in squared mesh units.
    Consistent(SparseMatrix),
}

impl MassMatrix {
    /// The mass in the form that [`fairing_sparse`] takes.
    pub fn as_mass(&self) -> Mass<'_> {
        match self {
            Self::Lumped(diagonal) => Mass::Lumped(diagonal),
            Self::Consistent(matrix) => Mass::Consistent(matrix),
        }
    }

    /// The sums of the rows: the area of each vertex.
    pub fn lumped(&self) -> Cow<'_, [f64]> {
        match self {
            Self::Lumped(diagonal) => Cow::Borrowed(diagonal),
            Self::Consistent(matrix) => {
                matrix.outer_iterator().map(|row| row.data().iter().sum()).collect()
            }
        }
    }

    /// The mass with the mean of all masses at the vertices `isolated`, which
    /// ascend (1 where all are zero).
    ///
    /// # Errors
    ///
    /// [`OperatorError::Mass`] for the first other vertex whose mass is not
    /// positive.
    pub(super) fn positive(&self, isolated: &[u32]) -> Result<Cow<'_, Self>, OperatorError> {
        let mut skipped = isolated.iter().peekable();
        for (v, mass) in self.as_mass().diagonal().into_iter().enumerate() {
            let vertex = v as u32;
            if skipped.next_if_eq(&&vertex).is_none() {
                positive(vertex, mass)?;
            }
        }
        if isolated.is_empty() {
            return Ok(Cow::Borrowed(self));
        }
        let mean = mean(&self.lumped());
        let mut filled = self.clone();
        for &v in isolated {
            match &mut filled {
                Self::Lumped(diagonal) => diagonal[v as usize] = mean,
                Self::Consistent(matrix) => {
                    if let Some(m) = matrix.get_mut(v as usize, v as usize) {
                        *m = mean;
                    }
                }
            }
        }
        Ok(Cow::Owned(filled))
    }
}

/// The mass of a mesh, for all kinds of Laplacian but the robust one; on the
/// pattern of one of the same faces if there is one.
pub(super) fn assemble(
    mesh: &TriMesh,
    kind: MassKind,
    pattern: Option<&MassMatrix>,
) -> Result<MassMatrix, OperatorError> {
    if let Some(area) = kind.area() {
        return Ok(MassMatrix::Lumped(lumped_mass(mesh, area)?));
    }
    let used = |degree: f64| if degree > 0.0 { 1.0 } else { 0.0 };
    Ok(match kind {
        MassKind::Degree => MassMatrix::Lumped(degrees(mesh)),
        MassKind::Unit => MassMatrix::Lumped(degrees(mesh).into_iter().map(used).collect()),
        _ => {
            let pattern = match pattern {
                Some(MassMatrix::Consistent(matrix)) => Some(matrix),
                _ => None,
            };
            MassMatrix::Consistent(consistent_on_pattern(mesh, pattern)?)
        }
    })
}

/// The error of a Laplacian that does not have such a mass.
pub(super) fn refused(laplacian: LaplacianKind, mass: MassKind) -> OperatorError {
    OperatorError::NoSuchMass { laplacian, mass }
}

/// The mass that an isolated vertex gets: the mean, or 1 where all are zero.
fn mean(mass: &[f64]) -> f64 {
    let mean = mass.iter().sum::<f64>() / mass.len() as f64;
    if mean > 0.0 { mean } else { 1.0 }
}

/// [`Laplacian::positive_mass`](crate::Laplacian::positive_mass) without a
/// stiffness: [`lumped_mass`], with a positive number at isolated vertices too.
///
/// # Errors
///
/// As [`lumped_mass`], and [`OperatorError::Mass`] for the first vertex with
/// faces whose mass is not positive.
pub fn positive_lumped_mass(mesh: &TriMesh, area: LumpedArea) -> Result<Vec<f64>, OperatorError> {
    let mut mass = lumped_mass(mesh, area)?;
    give_isolated(mesh, &mut mass)?;
    Ok(mass)
}

/// Gives isolated vertices the mass that they have in a system.
pub(super) fn give_isolated(mesh: &TriMesh, mass: &mut [f64]) -> Result<(), OperatorError> {
    let (mean, offsets) = (mean(mass), mesh.incidence().offsets());
    for (v, m) in mass.iter_mut().enumerate() {
        if offsets[v] == offsets[v + 1] { *m = mean } else { positive(v as u32, *m)? }
    }
    Ok(())
}

pub(super) fn positive(vertex: u32, mass: f64) -> Result<(), OperatorError> {
    if mass > 0.0 { Ok(()) } else { Err(OperatorError::Mass { vertex, mass }) }
}
