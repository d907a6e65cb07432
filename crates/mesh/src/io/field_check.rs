//! Checks of fields before they are written.

use crate::io::error::WriteProblem;
use crate::io::ply::layout::{Column, Layout, property_names};
use crate::io::{Format, VertexFields};

/// Checks lengths, values and names.
pub(crate) fn check(fields: &VertexFields, vertices: usize) -> Result<(), WriteProblem> {
    for (name, values) in &fields.scalars {
        check_length(name, values.len(), vertices)?;
        check_finite(name, values, 1)?;
    }
    for (name, values) in &fields.vectors {
        check_length(name, values.len(), vertices)?;
        check_finite(name, values.as_flattened(), 3)?;
    }
    if let Some(colors) = &fields.colors {
        check_length("of colours", colors.len(), vertices)?;
    }
    check_names(fields)
}

fn check_length(name: &str, found: usize, expected: usize) -> Result<(), WriteProblem> {
    if found == expected {
        return Ok(());
    }
    Err(WriteProblem::FieldLength { field: name.to_owned(), expected, found })
}

fn check_finite(name: &str, values: &[f64], per_vertex: usize) -> Result<(), WriteProblem> {
    match values.iter().position(|x| !x.is_finite()) {
        None => Ok(()),
        Some(at) => Err(WriteProblem::FieldNonFinite {
            field: name.to_owned(),
            vertex: at / per_vertex,
            value: values[at],
        }),
    }
}

/// Checks that the reader of PLY would group the names as they are. Other formats hold
/// no names, but every mesh that can be written should fit into PLY.
fn check_names(fields: &VertexFields) -> Result<(), WriteProblem> {
    let bad = |name: &str, reason| Err(WriteProblem::FieldName { name: name.to_owned(), reason });
    let names = property_names(fields);
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
        .map(|(k, name)| Column { name, is_byte: k >= bytes_from })
        .collect();
    let layout = Layout::new(&columns);
    let scalars = layout.scalars.iter().map(|(name, _)| name);
    if !scalars.eq(fields.scalars.iter().map(|(name, _)| name)) {
        let name = layout.vectors.iter().map(|(name, _)| name);
        let name = name.into_iter().find(|&n| !fields.vectors.iter().any(|(own, _)| own == n));
        return bad(name.map_or("", |name| name), "scalars would be read back as a vector");
    }
    Ok(())
}

/// The fields that a format cannot hold.
pub(crate) fn unsupported(format: Format, fields: &VertexFields) -> Vec<String> {
    let holds = format.holds();
    if holds.fields {
        return Vec::new();
    }
    let scalars = fields.scalars.iter().map(|(name, _)| name.clone());
    let vectors = fields.vectors.iter().map(|(name, _)| name.clone());
    let vectors = vectors.filter(|name| !holds.normals || name != "normal");
    let colors = (!holds.colors && fields.colors.is_some()).then(|| "colours".to_owned());
    scalars.chain(vectors).chain(colors).collect()
}
