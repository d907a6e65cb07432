//! Encoding of PCD.

use std::collections::HashSet;

use crate::io::column::width_of;
use crate::io::column::{Column, columns, rows};
use crate::io::error::WriteProblem;
use crate::io::fields::Attributes;
use crate::io::pcd::header::{NAME, PADDING, is_packed};
use crate::io::ply::columns::vertex_names;
use crate::io::surface::{Encoded, Surface, lines};
use crate::io::{Encoding, NumberType, VertexFields, WriteOptions};

pub(super) fn encode(
    surface: Surface<'_>,
    options: &WriteOptions,
) -> Result<Encoded, WriteProblem> {
    let Surface { positions, fields, .. } = surface;
    let width = options.float_width;
    let number = width_of(NAME, "the positions", positions.as_flattened(), None, width)?;
    let mut all = vec![Column::Vector(positions, number)];
    let uncolored = Attributes { colors: None, ..fields.into() };
    all.extend(columns(NAME, uncolored, width)?);
    all.extend(fields.colors.as_deref().map(Column::Packed));
    let points = positions.len();
    let mut pieces = vec![header(&all, &names(fields)?, points, options.encoding)];
    match options.encoding {
        Encoding::Ascii => pieces.extend(lines(points, 64, |v, text| {
            let start = text.len();
            all.iter().for_each(|column| column.write(v, text));
            text.remove(start);
            text.push(b'\n');
        })),
        Encoding::Binary => pieces.push(rows(points, &all)),
    }
    Ok(Encoded { pieces, notes: vec![] })
}

/// The names of all numbers of a point.
fn names(fields: &VertexFields) -> Result<Vec<String>, WriteProblem> {
    let bad = |name: &str, reason| Err(WriteProblem::FieldName { name: name.to_owned(), reason });
    let mut names = vertex_names(fields);
    if fields.colors.is_some() {
        names.truncate(names.len() - 3);
    }
    let normals = fields.vector("normal").is_some();
    for name in names.iter_mut().filter(|_| normals) {
        if let Some(axis @ ("x" | "y" | "z")) = name.strip_prefix('n') {
            *name = format!("normal_{axis}");
        }
    }
    if let Some(name) = names.iter().find(|name| is_packed(name) || *name == PADDING) {
        return bad(name, "it has another meaning in PCD");
    }
    if fields.colors.is_some() {
        names.push("rgb".to_owned());
    }
    let mut known = HashSet::new();
    match names.iter().find(|name| !known.insert(&name[..])) {
        Some(name) => bad(name, "two fields of this name"),
        None => Ok(names),
    }
}

fn header(columns: &[Column<'_>], names: &[String], points: usize, encoding: Encoding) -> Vec<u8> {
    let kinds = columns.iter().flat_map(|column| {
        // Programs expect colours in the bits of a floating-point number, in text as an integer.
        let number = match (column, encoding) {
            (Column::Packed(_), Encoding::Binary) => NumberType::F32,
            _ => column.number_type(),
        };
        std::iter::repeat_n(number, column.components())
    });
    let letter = |number: NumberType| match number {
        NumberType::F32 | NumberType::F64 => "F",
        NumberType::I8 | NumberType::I16 | NumberType::I32 => "I",
        NumberType::U8 | NumberType::U16 | NumberType::U32 => "U",
    };
    let sizes: Vec<String> = kinds.clone().map(|number| number.size().to_string()).collect();
    let types: Vec<&str> = kinds.map(letter).collect();
    let data = match encoding {
        Encoding::Ascii => "ascii",
        Encoding::Binary => "binary",
    };
    format!(
        "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS {}\nSIZE {}\nTYPE {}\n\
         COUNT {}\nWIDTH {points}\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS {points}\nDATA {data}\n",
        names.join(" "),
        sizes.join(" "),
        types.join(" "),
        vec!["1"; names.len()].join(" "),
    )
    .into_bytes()
}
