//! A Laplacian without its fixed vertices.

use std::borrow::Cow;

use fairing_sparse::{SparseMatrix, principal_submatrix};

use super::{Laplacian, MassMatrix, mass};
use crate::error::OperatorError;

/// The rows and columns of the free vertices of a [`Laplacian`].
#[derive(Debug, Clone)]
pub struct Restricted<'a> {
    free: Vec<u32>,
    stiffness: Cow<'a, SparseMatrix>,
    mass: Cow<'a, MassMatrix>,
}

impl Laplacian {
    /// Removes the rows and columns of the vertices `fixed`, in any order, and of
    /// isolated vertices, which have no equation. Copies nothing if no vertex is
    /// removed.
    ///
    /// # Errors
    ///
    /// [`OperatorError::NoSuchVertex`]; [`OperatorError::Mass`] for the first
    /// free vertex whose mass is not positive.
    pub fn restricted(&self, fixed: &[u32]) -> Result<Restricted<'_>, OperatorError> {
        let n = self.vertex_count();
        let mut has_row = vec![true; n];
        for &vertex in fixed {
            let no = OperatorError::NoSuchVertex { vertex, vertices: n };
            *has_row.get_mut(vertex as usize).ok_or(no)? = false;
        }
        for &vertex in &self.isolated {
            has_row[vertex as usize] = false;
        }
        let free: Vec<u32> = (0..n as u32).filter(|&v| has_row[v as usize]).collect();
        let diagonal = self.mass.as_mass().diagonal();
        for &v in &free {
            mass::positive(v, diagonal[v as usize])?;
        }
        let (stiffness, mass) = if free.len() == n {
            (Cow::Borrowed(&self.stiffness), Cow::Borrowed(&self.mass))
        } else {
            let mass = match &self.mass {
                MassMatrix::Lumped(_) => {
                    MassMatrix::Lumped(free.iter().map(|&v| diagonal[v as usize]).collect())
                }
                MassMatrix::Consistent(m) => MassMatrix::Consistent(principal_submatrix(m, &free)),
            };
            (Cow::Owned(principal_submatrix(&self.stiffness, &free)), Cow::Owned(mass))
        };
        Ok(Restricted { free, stiffness, mass })
    }
}

impl Restricted<'_> {
    /// The free vertices, ascending: row i belongs to `free()[i]`.
    pub fn free(&self) -> &[u32] {
        &self.free
    }

    /// The stiffness, positive definite where every component has a fixed vertex.
    pub fn stiffness(&self) -> &SparseMatrix {
        &self.stiffness
    }

    /// The mass.
    pub fn mass(&self) -> &MassMatrix {
        &self.mass
    }
}
