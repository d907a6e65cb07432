//! Checks of fields before they are written.

use crate::TriMesh;
use crate::io::error::WriteProblem;
use crate::io::fields::Attributes;
use crate::io::ply::columns::{Column, Layout, face_names, field_names, vertex_names};
use crate::io::{FaceFields, Format, NumberType, VertexFields};

/// The elements that fields belong to, in the plural and the singular of messages.
type Elements = (&'static str, &'static str);

/// Checks lengths, values and names.
pub(crate) fn check(
    fields: &VertexFields,
    vertices: usize,
    faces: usize,
) -> Result<(), WriteProblem> {
    check_values(fields.into(), vertices, ("vertices", "vertex"))?;
    check_names(fields.into(), vertex_names(fields), 0, Layout::of_vertices)?;
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
    let names = face_names(of_faces);
    let lists = names.len() - field_names(of_faces.into()).len();
    check_names(of_faces.into(), names, lists, Layout::of_faces)
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

/// Checks that the reader of PLY would group the names of properties as they are. Other
/// formats hold other names, but every mesh that can be written should fit into PLY. The
/// first `lists` names are those of lists, which are not grouped.
fn check_names(
    fields: Attributes<'_>,
    names: Vec<String>,
    lists: usize,
    layout: fn(&[Column<'_>]) -> Layout,
) -> Result<(), WriteProblem> {
    let bad = |name: &str, reason| Err(WriteProblem::FieldName { name: name.to_owned(), reason });
    let own = fields.scalars.iter().map(|(name, _)| name);
    for name in own.chain(fields.vectors.iter().map(|(name, _)| name)) {
        if name.is_empty() || name.bytes().any(|b| b.is_ascii_whitespace() || b.is_ascii_control())
        {
            return bad(name, "empty, or with white space or control characters");
        }
    }
    let mut sorted: Vec<&String> = names.iter().collect();
    sorted.sort_unstable();
    if let Some(pair) = sorted.windows(2).find(|pair| pair[0] == pair[1]) {
        return bad(pair[0], "two properties of this name");
    }
    let bytes_from = names.len() - if fields.colors.is_some() { 3 } else { 0 };
    let columns: Vec<Column<'_>> = names
        .iter()
        .enumerate()
        .map(|(k, name)| {
            let is_byte = k >= bytes_from || fields.types.get(name) == Some(&NumberType::U8);
            Column { name, is_byte }
        })
        .collect();
    let layout = layout(&columns[lists..]);
    let scalars = layout.scalars.iter().map(|(name, _)| name);
    if !scalars.eq(fields.scalars.iter().map(|(name, _)| name)) {
        let name = layout.vectors.iter().map(|(name, _)| name);
        let name = name.into_iter().find(|&n| !fields.vectors.iter().any(|(own, _)| own == n));
        return bad(name.map_or("", |name| name), "scalars would be read back as a vector");
    }
    Ok(())
}

/// The names of what a file of a format cannot hold of a mesh: fields, colours, and faces where it
/// holds points only.
pub fn unsupported(format: Format, mesh: &TriMesh, fields: &VertexFields) -> Vec<String> {
    let holds = format.holds();
    let mut unsupported = Vec::new();
    if !holds.faces && mesh.face_count() > 0 {
        unsupported.push("faces".to_owned());
    }
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
