//! A Laplacian at other positions.

use fairing_mesh::TriMesh;

use super::{Laplacian, mass};
use crate::error::OperatorError;
use crate::kind::LaplacianKind;

impl Laplacian {
    /// Replaces stiffness and mass by those at the positions of `mesh`, which must
    /// have the faces of the original mesh.
    ///
    /// The result is that of [`Laplacian::new`], bit by bit, including the choice
    /// of [`choose`](crate::choose). Cotangents reuse the existing pattern, the
    /// uniform stiffness stays, and the robust one is reassembled, because its
    /// edges depend on the positions.
    ///
    /// # Errors
    ///
    /// As [`Laplacian::new`]; [`OperatorError::Length`] and
    /// [`OperatorError::Connectivity`] for a mesh of other vertices or edges, as
    /// far as the kind detects them, and for polygons. An error leaves the
    /// Laplacian unchanged.
    pub fn refill(&mut self, mesh: &TriMesh) -> Result<(), OperatorError> {
        self.check_length(mesh.vertex_count())?;
        let isolated = super::isolated(mesh);
        if isolated != self.isolated {
            let missing = |all: &[u32], v: &&u32| all.binary_search(v).is_err();
            let vertex = isolated.iter().find(|v| missing(&self.isolated, v));
            let vertex = vertex.or(self.isolated.iter().find(|v| missing(&isolated, v)));
            return Err(OperatorError::Connectivity { vertex: vertex.copied().unwrap_or(0) });
        }
        match self.kind {
            LaplacianKind::Uniform => self.mass = mass::assemble(mesh, self.mass_kind, None)?,
            // The faces of polygons are not known here; for triangles, `kind` is never this.
            LaplacianKind::Polygon => return Err(OperatorError::Connectivity { vertex: 0 }),
            _ => *self = Self::assemble(mesh, self.asked, self.mass_kind, Some(self))?,
        }
        Ok(())
    }
}
