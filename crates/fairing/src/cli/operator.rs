//! The options `--operator` and `--mass` of all verbs that take a Laplacian.

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use fairing::mesh::TriMesh;
use fairing::operators::{Laplacian, LaplacianKind, MassKind, OperatorError, Reason};

use super::context::Context;

/// The parser of `--operator`.
pub(crate) fn kinds() -> impl TypedValueParser<Value = LaplacianKind> {
    let kinds = LaplacianKind::CHOICES.iter();
    let names = kinds.map(|kind| PossibleValue::new(kind.name).help(kind.about));
    PossibleValuesParser::new(names).try_map(|name| name.parse::<LaplacianKind>())
}

/// The parser of `--mass`.
pub(crate) fn masses() -> impl TypedValueParser<Value = MassKind> {
    let masses = [MassKind::Barycentric, MassKind::Mixed, MassKind::Consistent];
    PossibleValuesParser::new(masses.map(MassKind::name)).try_map(|name| name.parse::<MassKind>())
}

/// The Laplacian, with a note if a face is too thin for cotangents.
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

/// Notes that `auto` chose the robust operator, and the face that caused it.
pub(crate) fn say_too_thin(context: &Context, face: u32) {
    context.note(format_args!("face {face} is too thin for cotangents; using the robust operator"));
}
