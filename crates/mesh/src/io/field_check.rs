//! Checks of fields before they are written.

use crate::io::error::WriteProblem;
use crate::io::fields::Attributes;
use crate::io::{FaceFields, Format, VertexFields};

/// The elements that fields belong to, in the plural and the singular of messages.
type Elements = (&'static str, &'static str);

/// Checks lengths, values and names.
pub(crate) fn check(
    fields: &VertexFields,
    vertices: usize,
    faces: usize,
) -> Result<(), WriteProblem> {
    check_values(fields.into(), vertices, ("vertices", "vertex"))?;
    check_names(fields.into())?;
    let of_faces = &fields.faces;
    check_values(of_faces.into(), faces, ("faces", "face"))?;
    if let Some(texture) = &of_faces.texture {
        let elements = ("corners", "corner");
        check_length("of texture coordinates", texture.len(), 3 * faces, elements)?;
        check_finite("of texture coordinates", texture.as_flattened(), 2, elements)?;
    }
    if let Some(found) = of_faces.statements.faces() {
        check_length("of statements", found, faces, ("faces", "face"))?;
    }
    check_names(of_faces.into())
}

fn check_values(
    fields: Attributes<'_>,
    count: usize,
    elements: Elements,
) -> Result<(), WriteProblem> {
    for (name, values) in fields.scalars {
        check_length(name, values.len(), count, elements)?;
        check_finite(name, values, 1, elements)?;
    }
    for (name, values) in fields.vectors {
        check_length(name, values.len(), count, elements)?;
        check_finite(name, values.as_flattened(), 3, elements)?;
    }
    match fields.colors {
        Some(colors) => check_length("of colours", colors.len(), count, elements),
        None => Ok(()),
    }
}

fn check_length(
    name: &str,
    found: usize,
    expected: usize,
    (elements, _): Elements,
) -> Result<(), WriteProblem> {
    if found == expected {
        return Ok(());
    }
    Err(WriteProblem::FieldLength { field: name.to_owned(), elements, expected, found })
}

fn check_finite(
    name: &str,
    values: &[f64],
    per_element: usize,
    (_, element): Elements,
) -> Result<(), WriteProblem> {
    match values.iter().position(|x| !x.is_finite()) {
        None => Ok(()),
        Some(at) => Err(WriteProblem::FieldNonFinite {
            field: name.to_owned(),
            element,
            index: at / per_element,
            value: values[at],
        }),
    }
}

/// Checks that names are visible and belong to one scalar and one vector at most.
fn check_names(fields: Attributes<'_>) -> Result<(), WriteProblem> {
    let bad = |name: &str, reason| Err(WriteProblem::FieldName { name: name.to_owned(), reason });
    let scalars: Vec<&str> = fields.scalars.iter().map(|(name, _)| &name[..]).collect();
    let vectors: Vec<&str> = fields.vectors.iter().map(|(name, _)| &name[..]).collect();
    for mut names in [scalars, vectors] {
        let odd = |name: &&&str| name.is_empty() || name.bytes().any(|b| b.is_ascii_control());
        if let Some(name) = names.iter().find(odd) {
            return bad(name, "empty, or with control characters");
        }
        names.sort_unstable();
        if let Some(pair) = names.windows(2).find(|pair| pair[0] == pair[1]) {
            return bad(pair[0], "two fields of this name");
        }
    }
    Ok(())
}

/// The names of what a file of a format cannot hold of a mesh: fields and colours.
pub fn unsupported(format: Format, fields: &VertexFields) -> Vec<String> {
    let holds = format.holds();
    let mut unsupported = Vec::new();
    if !holds.fields {
        let scalars = fields.scalars.iter().map(|(name, _)| name.clone());
        let vectors = fields.vectors.iter().map(|(name, _)| name.clone());
        let vectors = vectors.filter(|name| !holds.normals || name != "normal");
        unsupported.extend(scalars.chain(vectors));
    }
    if !holds.colors && fields.colors.is_some() {
        unsupported.push("colours".to_owned());
    }
    if !holds.face_fields {
        let FaceFields { scalars, vectors, colors, .. } = &fields.faces;
        let names = scalars.iter().map(|(name, _)| name);
        let names = names.chain(vectors.iter().map(|(name, _)| name));
        unsupported.extend(names.map(|name| format!("{name} of faces")));
        unsupported.extend(colors.iter().map(|_| "colours of faces".to_owned()));
    }
    if !holds.texture && fields.faces.texture.is_some() {
        unsupported.push("texture coordinates of corners".to_owned());
    }
    unsupported
}
