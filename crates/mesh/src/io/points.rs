//! Named columns of points as positions and fields.

use crate::io::NumberType;
use crate::io::arrays::{NamedArray, columns};
use crate::io::error::{ReadProblem, unexpected};
use crate::io::parsed::Parsed;
use crate::io::ply::columns::{Column, Layout};

/// Positions from the columns `x`, `y` and `z`, and fields from the others, grouped by name as
/// the properties of PLY.
pub(crate) fn of_columns(
    arrays: Vec<NamedArray>,
    colors: Option<Vec<[u8; 3]>>,
    notes: Vec<String>,
) -> Result<Parsed, ReadProblem> {
    let is_byte = |array: &NamedArray| {
        matches!(array.kind, None | Some(NumberType::U8))
            && array.values.iter().all(|&x| NumberType::U8.holds(x))
    };
    let names: Vec<Column<'_>> = arrays
        .iter()
        // Only columns of one number are grouped.
        .map(|array| Column {
            name: if array.components == 1 { &array.name } else { "" },
            is_byte: is_byte(array),
        })
        .collect();
    let layout = Layout::of_vertices(&names);
    let Some([x, y, z]) = layout.position else {
        let found: Vec<&str> = arrays.iter().map(|array| &array.name[..]).collect();
        return Err(unexpected("the columns x, y and z", found.join(", ")));
    };
    let column = |k: usize| &arrays[k].values;
    let triples = |[a, b, c]: [usize; 3]| {
        let rows = column(a).iter().zip(column(b)).zip(column(c));
        rows.map(|((&a, &b), &c)| [a, b, c])
    };
    let positions = triples([x, y, z]).collect();
    let bytes = layout.colors.filter(|_| colors.is_none());
    let colors = colors.or(bytes.map(|three| triples(three).map(|c| c.map(|x| x as u8)).collect()));
    let mut fields: Vec<NamedArray> =
        layout.scalars.iter().map(|&(_, k)| arrays[k].clone()).collect();
    fields.extend(layout.vectors.iter().map(|(name, three)| {
        NamedArray {
            name: name.clone(),
            kind: arrays[three[0]]
                .kind
                .filter(|&kind| three.iter().all(|&k| arrays[k].kind == Some(kind))),
            components: 3,
            values: triples(*three).flatten().collect(),
        }
    }));
    let mut parsed = Parsed { positions, notes, ..Parsed::default() };
    parsed.fields = columns(fields, colors, &mut parsed.notes).of_vertices();
    Ok(parsed)
}
