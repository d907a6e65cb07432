//! Which Laplacian: the same option in every verb that takes one.

use clap::ValueEnum;
use fairing::mesh::TriMesh;
use fairing::operators::{Laplacian, LaplacianKind, MassKind, OperatorError};

use super::Context;

/// The value of `--operator`.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum OperatorName {
    /// cotangent, or robust where a face is too thin for cotangents; with another mass than
    /// barycentric, always cotangent
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
            Self::Auto | Self::Cotangent => LaplacianKind::Cotangent,
            Self::Robust => LaplacianKind::Robust,
        };
        match Laplacian::new(mesh, kind, mass) {
            Err(OperatorError::DegenerateFace { face, .. })
                if self == Self::Auto && mass == MassKind::Barycentric =>
            {
                say_too_thin(context, face);
                Laplacian::robust(mesh)
            }
            other => other,
        }
    }
}

/// Says that auto took the robust operator, and why.
pub(crate) fn say_too_thin(context: &Context, face: u32) {
    context.note(format_args!("face {face} is too thin for cotangents; using the robust operator"));
}
