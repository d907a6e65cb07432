//! A Laplacian at other positions.

use fairing_mesh::TriMesh;

use super::choice::negative_weight;
use super::{Laplacian, LaplacianKind, MassKind, MassMatrix, mass};
use crate::error::OperatorError;
use crate::mass::refill_consistent_mass;
use crate::stiffness::refill_cotan_stiffness;

impl Laplacian {
    /// Replaces stiffness and mass by those at the positions of `mesh`, which
    /// has the faces that this one was made of.
    ///
    /// The result is that of [`Laplacian::new`], bit by bit, and
    /// [`LaplacianKind::Auto`] chooses again. Cotangents are written into the
    /// pattern that there is, the uniform stiffness stays, and the robust one
    /// is assembled again, because its edges depend on the positions.
    ///
    /// # Errors
    ///
    /// As [`Laplacian::new`]; [`OperatorError::Length`] and
    /// [`OperatorError::Connectivity`] for a mesh of other vertices or edges,
    /// as far as a kind notices, and for polygons. After an error nothing has
    /// changed.
    pub fn refill(&mut self, mesh: &TriMesh) -> Result<(), OperatorError> {
        self.check_length(mesh.vertex_count())?;
        let isolated = super::isolated(mesh);
        if isolated != self.isolated {
            let missing = |all: &[u32], v: &&u32| all.binary_search(v).is_err();
            let vertex = isolated.iter().find(|v| missing(&self.isolated, v));
            let vertex = vertex.or(self.isolated.iter().find(|v| missing(&isolated, v)));
            return Err(OperatorError::Connectivity { vertex: vertex.copied().unwrap_or(0) });
        }
        match (self.asked, self.kind) {
            (_, LaplacianKind::Uniform) => {
                self.mass = mass::assemble(mesh, self.mass_kind)?;
                Ok(())
            }
            (_, LaplacianKind::Polygon) => Err(OperatorError::Connectivity { vertex: 0 }),
            (LaplacianKind::Auto, LaplacianKind::Cotangent)
                if self.mass_kind == MassKind::Barycentric =>
            {
                self.refill_or_choose(mesh)
            }
            (_, LaplacianKind::Cotangent) => self.refill_cotangents(mesh),
            _ => {
                *self = Self::new(mesh, self.asked, self.mass_kind)?;
                Ok(())
            }
        }
    }

    fn refill_cotangents(&mut self, mesh: &TriMesh) -> Result<(), OperatorError> {
        // What may fail comes before what changes anything.
        if let MassMatrix::Consistent(matrix) = &mut self.mass {
            refill_cotan_stiffness(mesh, &mut self.stiffness)?;
            return refill_consistent_mass(mesh, matrix);
        }
        let mass = mass::assemble(mesh, self.mass_kind)?;
        refill_cotan_stiffness(mesh, &mut self.stiffness)?;
        self.mass = mass;
        Ok(())
    }

    /// Cotangents where they are still sound, else what [`LaplacianKind::Auto`] takes.
    fn refill_or_choose(&mut self, mesh: &TriMesh) -> Result<(), OperatorError> {
        // A copy, so that an error of the robust operator changes nothing.
        let mut stiffness = self.stiffness.clone();
        match refill_cotan_stiffness(mesh, &mut stiffness) {
            Ok(()) if negative_weight(&stiffness).is_none() => {
                self.mass = mass::assemble(mesh, self.mass_kind)?;
                self.stiffness = stiffness;
            }
            Ok(()) | Err(OperatorError::DegenerateFace { .. }) => {
                *self = Self::new(mesh, self.asked, self.mass_kind)?;
            }
            Err(error) => return Err(error),
        }
        Ok(())
    }
}
