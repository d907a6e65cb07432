//! The vertices of a PLY file: positions, fields, colours.

use fairing_watch::parallel;

use crate::io::NumberType;
use crate::io::columns::Layout;
use crate::io::error::{Fault, unexpected};
use crate::io::fields::Columns;
use crate::io::parsed::{Broken, Parsed, check_finite};
use crate::io::ply::header::{Element, Kind};
use crate::io::ply::scalars::{Scalars, triples};
use crate::io::ply::source::{Rows, Source};

pub(super) fn read(
    source: &mut impl Source,
    element: &Element,
    broken: Broken,
    parsed: &mut Parsed,
) -> Result<(), Fault> {
    let scalars = Scalars::new(element, Layout::of_vertices);
    let is_list = |kind: Kind| matches!(kind, Kind::List { .. });
    let Some(position) = scalars.layout.position else {
        let found = element.properties.iter().filter(|property| !is_list(property.kind));
        let found = found.map(|property| &property.name[..]).collect::<Vec<_>>().join(", ");
        return Err(source.fault(unexpected("vertex properties x, y and z", found)));
    };
    for property in element.properties.iter().filter(|property| is_list(property.kind)) {
        parsed.notes.push(format!("vertex property {}, a list, is ignored", property.name));
    }
    let by_rows = match source.take_rows(element)? {
        Some(rows) => Some(from_rows(&rows, &scalars, position, broken)?),
        None => None,
    };
    let (positions, columns) = match by_rows {
        Some(found) => found,
        None => {
            let values = value_by_value(source, element, &scalars, position, broken)?;
            (triples(&values, position), scalars.of_values(values))
        }
    };
    parsed.positions = positions;
    // Faces may come before vertices.
    let faces = std::mem::take(&mut parsed.fields.faces);
    parsed.fields = columns.of_vertices();
    parsed.fields.faces = faces;
    Ok(())
}

/// Decodes rows of one size: positions and each field in turn, in parallel.
fn from_rows(
    rows: &Rows<'_>,
    scalars: &Scalars,
    position: [usize; 3],
    broken: Broken,
) -> Result<(Vec<[f64; 3]>, Columns), Fault> {
    let mut offset = 0;
    let offsets: Vec<usize> = scalars
        .kinds
        .iter()
        .map(|kind| {
            offset += kind.size();
            offset - kind.size()
        })
        .collect();
    let positions = scalars.triples_of_rows(rows, &offsets, position);
    let bad = |p: &[f64; 3]| check_finite(p, 0, broken).is_err();
    let first = parallel::map_ranges(positions.len(), 1 << 14, |rows| {
        rows.clone().find(|&v| bad(&positions[v]))
    });
    if let Some(vertex) = first.into_iter().flatten().next() {
        let at = rows.start + vertex * rows.stride;
        check_finite(&positions[vertex], vertex, broken)
            .map_err(|problem| Fault::at_byte(at, problem))?;
    }
    Ok((positions, scalars.of_rows(rows, &offsets)))
}

/// Reads text, or rows of varying size, value by value.
fn value_by_value(
    source: &mut impl Source,
    element: &Element,
    scalars: &Scalars,
    position: [usize; 3],
    broken: Broken,
) -> Result<Vec<Vec<f64>>, Fault> {
    // Every value takes a byte or more.
    let room = element.rows().min(source.remaining() / element.properties.len().max(1));
    let mut columns: Vec<Vec<f64>> =
        scalars.kinds.iter().map(|_| Vec::with_capacity(room)).collect();
    for vertex in 0..element.rows() {
        let mut column = 0;
        for property in &element.properties {
            match property.kind {
                Kind::Scalar(kind) => {
                    let value = value(source, kind, scalars.is_color(column), &property.name)?;
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

/// The next value of a scalar property.
pub(super) fn value(
    source: &mut impl Source,
    kind: NumberType,
    is_color: bool,
    name: &str,
) -> Result<f64, Fault> {
    if is_color { Ok(source.integer(kind, name)? as f64) } else { source.float(kind, name) }
}

/// The length of a list, which must not be negative.
pub(super) fn list_length(
    source: &mut impl Source,
    count: NumberType,
    name: &str,
) -> Result<u64, Fault> {
    let length = source.integer(count, "the length of a list")?;
    u64::try_from(length).map_err(|_| {
        source.fault(unexpected(format!("the length of list {name}"), length.to_string()))
    })
}
