//! Which Laplacian: the same option in every verb that takes one.

use clap::ValueEnum;
use fairing::mesh::TriMesh;
use fairing::operators::{Laplacian, LaplacianKind, MassKind, OperatorError};

use super::Context;

/// The value of `--operator`.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum OperatorName {
    /// cotangent, or robust where a face is too thin for cotangents or an edge has a negative
    /// weight; with another mass than barycentric, always cotangent
    Auto,
    /// The cotangents of the faces
    Cotangent,
    /// Those of the intrinsic Delaunay triangulation, which any mesh has
    Robust,
}

impl OperatorName {
    /// The Laplacian, with a note where auto takes the robust one.
    pub(crate) fn assemble(
        self,
        context: &Context,
        mesh: &TriMesh,
        mass: MassKind,
    ) -> Result<Laplacian, OperatorError> {
        let kind = match self {
            Self::Auto => LaplacianKind::Auto,
            Self::Cotangent => LaplacianKind::Cotangent,
            Self::Robust => LaplacianKind::Robust,
        };
        let laplacian = Laplacian::new(mesh, kind, mass)?;
        if self == Self::Auto && laplacian.kind() == LaplacianKind::Robust {
            let reason = laplacian.reason();
            context.note(format_args!("{reason}; using the robust operator"));
        }
        Ok(laplacian)
    }
}
