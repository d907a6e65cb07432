//! The option `--operator`, the same in every verb that takes a Laplacian.

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use fairing::mesh::TriMesh;
use fairing::operators::{Laplacian, LaplacianKind, MassKind, OperatorError, Reason};

use super::Context;

/// The parser of `--operator`.
pub(crate) fn kinds() -> impl TypedValueParser<Value = LaplacianKind> {
    let kinds = LaplacianKind::CHOICES.iter();
    let names = kinds.map(|kind| PossibleValue::new(kind.name).help(kind.about));
    PossibleValuesParser::new(names).try_map(|name| name.parse::<LaplacianKind>())
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
