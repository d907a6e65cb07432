//! The options `--operator` and `--mass` of all verbs that take a Laplacian.

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use fairing::mesh::TriMesh;
use fairing::operators::{Laplacian, LaplacianKind, MassKind, OperatorError, Reason};

use super::context::Context;

/// The parser of `--operator`.
pub(crate) fn kinds() -> impl TypedValueParser<Value = LaplacianKind> {
    let kinds = [
        (
            LaplacianKind::Auto,
            "cotangent, or robust where a face is too thin for cotangents; with another mass than \
             barycentric, always cotangent",
        ),
        (LaplacianKind::Cotangent, "The cotangents of the faces"),
        (
            LaplacianKind::Robust,
            "Those of the intrinsic Delaunay triangulation, which any mesh has",
        ),
    ];
    let names = kinds.map(|(kind, about)| PossibleValue::new(kind.name()).help(about));
    PossibleValuesParser::new(names).try_map(|name| name.parse::<LaplacianKind>())
}

/// The parser of `--mass`.
pub(crate) fn masses() -> impl TypedValueParser<Value = MassKind> {
    let masses = [MassKind::Barycentric, MassKind::Mixed, MassKind::Consistent];
    PossibleValuesParser::new(masses.map(MassKind::name)).try_map(|name| name.parse::<MassKind>())
}

/// The Laplacian, with a note where a face is too thin for cotangents.
pub(crate) fn assemble(
    context: &Context,
    mesh: &TriMesh,
    kind: LaplacianKind,
    mass: MassKind,
) -> Result<Laplacian, OperatorError> {
    let laplacian = Laplacian::new(mesh, kind, mass)?;
    if let Reason::ThinFace { face, .. } = laplacian.reason() {
        say_too_thin(context, face);
    }
    Ok(laplacian)
}

/// Says that auto took the robust operator, and why.
pub(crate) fn say_too_thin(context: &Context, face: u32) {
    context.note(format_args!("face {face} is too thin for cotangents; using the robust operator"));
}
