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
            Err(thin) if self.gives_way(context, &thin, mass) => Laplacian::robust(mesh),
            other => other,
        }
    }

    /// The operator of a flow, as it is tried first.
    pub(crate) fn of_flow(self) -> &'static str {
        match self {
            Self::Auto | Self::Cotangent => "cotangent",
            Self::Robust => "robust",
        }
    }

    /// Whether the robust operator is taken where another failed, which a note then says.
    pub(crate) fn gives_way(
        self,
        context: &Context,
        error: &OperatorError,
        mass: MassKind,
    ) -> bool {
        let thin = matches!(error, OperatorError::DegenerateFace { .. });
        let gives_way = thin && self == Self::Auto && mass == MassKind::Barycentric;
        if gives_way {
            context.note(format_args!("{error}; using the robust operator"));
        }
        gives_way
    }
}
