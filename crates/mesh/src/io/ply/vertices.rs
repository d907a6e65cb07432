//! The vertices of a PLY file: positions, fields, colours.

use rayon::prelude::*;

use crate::io::VertexFields;
use crate::io::error::{Fault, unexpected};
use crate::io::parsed::{Broken, Parsed, check_finite};
use crate::io::ply::header::{Element, Kind, Scalar};
use crate::io::ply::layout::{Column, Layout};
use crate::io::ply::source::{Rows, Source, decode_float};

pub(super) fn read(
    source: &mut impl Source,
    element: &Element,
    broken: Broken,
    parsed: &mut Parsed,
) -> Result<(), Fault> {
    let columns: Vec<usize> = (0..element.properties.len())
        .filter(|&p| matches!(element.properties[p].kind, Kind::Scalar(_)))
        .collect();
    let described: Vec<Column<'_>> = columns
        .iter()
        .map(|&p| {
            let property = &element.properties[p];
            Column { name: &property.name, is_byte: property.kind == Kind::Scalar(Scalar::U8) }
        })
        .collect();
    let layout = Layout::new(&described);
    let Some(position) = layout.position else {
        let found = described.iter().map(|column| column.name).collect::<Vec<_>>().join(", ");
        return Err(source.fault(unexpected("vertex properties x, y and z", found)));
    };
    for property in &element.properties {
        if let Kind::List { .. } = property.kind {
            parsed.notes.push(format!("vertex property {}, a list, is ignored", property.name));
        }
    }
    let by_rows = match source.take_rows(element)? {
        Some(rows) => Some(from_rows(&rows, element, position, &layout, broken)?),
        None => None,
    };
    (parsed.positions, parsed.fields) = match by_rows {
        Some(found) => found,
        None => from_columns(
            value_by_value(source, element, position, &layout, broken)?,
            position,
            &layout,
        ),
    };
    Ok(())
}

/// Decodes rows of one size: positions and each field in turn, in parallel.
fn from_rows(
    rows: &Rows<'_>,
    element: &Element,
    position: [usize; 3],
    layout: &Layout,
    broken: Broken,
) -> Result<(Vec<[f64; 3]>, VertexFields), Fault> {
    let mut offsets = Vec::with_capacity(element.properties.len());
    let mut offset = 0;
    for property in &element.properties {
        if let Kind::Scalar(scalar) = property.kind {
            offsets.push((offset, scalar));
            offset += scalar.size();
        }
    }
    let triples = |columns: [usize; 3]| vectors(rows, columns.map(|k| offsets[k]));
    let positions = triples(position);
    let bad = |p: &[f64; 3]| check_finite(p, 0, broken).is_err();
    if let Some(vertex) = positions.par_iter().with_min_len(1 << 13).position_first(bad) {
        let at = rows.start + vertex * rows.stride;
        check_finite(&positions[vertex], vertex, broken)
            .map_err(|problem| Fault::at_byte(at, problem))?;
    }
    let scalar = |k: usize| -> Vec<f64> {
        let (offset, scalar) = offsets[k];
        rows.map(|row| decode_float(scalar, rows.big_endian, &row[offset..]))
    };
    let fields = VertexFields {
        scalars: layout.scalars.iter().map(|(name, k)| (name.clone(), scalar(*k))).collect(),
        vectors: layout.vectors.iter().map(|(name, ks)| (name.clone(), triples(*ks))).collect(),
        colors: layout.colors.map(|ks| {
            let at = ks.map(|k| offsets[k].0);
            rows.map(|row| at.map(|offset| row[offset]))
        }),
    };
    Ok((positions, fields))
}

/// Three columns as vectors. The usual case, three adjacent little-endian numbers of
/// one type, has its own branch-free loop.
fn vectors(rows: &Rows<'_>, columns: [(usize, Scalar); 3]) -> Vec<[f64; 3]> {
    let [(offset, kind), ..] = columns;
    let side_by_side = [0, 1, 2].map(|k| (offset + k * kind.size(), kind)) == columns;
    match kind {
        Scalar::F32 if side_by_side && !rows.big_endian => rows.map(|row| {
            let words = row[offset..offset + 12].as_chunks().0;
            [words[0], words[1], words[2]].map(|word| f64::from(f32::from_le_bytes(word)))
        }),
        Scalar::F64 if side_by_side && !rows.big_endian => rows.map(|row| {
            let words = row[offset..offset + 24].as_chunks().0;
            [words[0], words[1], words[2]].map(f64::from_le_bytes)
        }),
        _ => rows.map(|row| {
            columns.map(|(offset, scalar)| decode_float(scalar, rows.big_endian, &row[offset..]))
        }),
    }
}

/// Reads text, or rows of varying size, value by value.
fn value_by_value(
    source: &mut impl Source,
    element: &Element,
    position: [usize; 3],
    layout: &Layout,
    broken: Broken,
) -> Result<Vec<Vec<f64>>, Fault> {
    // Every value takes a byte or more.
    let room = element.rows().min(source.remaining() / element.properties.len().max(1));
    let count = element.properties.iter().filter(|p| matches!(p.kind, Kind::Scalar(_))).count();
    let mut columns: Vec<Vec<f64>> = (0..count).map(|_| Vec::with_capacity(room)).collect();
    for vertex in 0..element.rows() {
        let mut column = 0;
        for property in &element.properties {
            match property.kind {
                Kind::Scalar(scalar) => {
                    // Colours must be bytes in text as well.
                    let is_color = layout.colors.is_some_and(|ks| ks.contains(&column));
                    let value = if is_color {
                        source.integer(scalar, &property.name)? as f64
                    } else {
                        source.float(scalar, &property.name)?
                    };
                    if position.contains(&column) {
                        check_finite(&[value; 3], vertex, broken).map_err(|p| source.fault(p))?;
                    }
                    columns[column].push(value);
                    column += 1;
                }
                Kind::List { count, item } => {
                    let length = list_length(source, count, &property.name)?;
                    source.skip(item, length, &property.name)?;
                }
            }
        }
        source.end_row();
    }
    Ok(columns)
}

fn from_columns(
    mut columns: Vec<Vec<f64>>,
    position: [usize; 3],
    layout: &Layout,
) -> (Vec<[f64; 3]>, VertexFields) {
    let triples = |[a, b, c]: [usize; 3]| -> Vec<[f64; 3]> {
        let (a, b, c) = (&columns[a], &columns[b], &columns[c]);
        a.iter().zip(b).zip(c).map(|((&a, &b), &c)| [a, b, c]).collect()
    };
    let positions = triples(position);
    let vectors = layout.vectors.iter().map(|(name, ks)| (name.clone(), triples(*ks))).collect();
    let colors = layout.colors.map(|ks| triples(ks).iter().map(|c| c.map(|x| x as u8)).collect());
    let scalars = layout.scalars.iter();
    let scalars =
        scalars.map(|(name, k)| (name.clone(), std::mem::take(&mut columns[*k]))).collect();
    (positions, VertexFields { scalars, vectors, colors })
}

/// The length of a list, which must not be negative.
pub(super) fn list_length(
    source: &mut impl Source,
    count: Scalar,
    name: &str,
) -> Result<u64, Fault> {
    let length = source.integer(count, "the length of a list")?;
    u64::try_from(length).map_err(|_| {
        source.fault(unexpected(format!("the length of list {name}"), length.to_string()))
    })
}
