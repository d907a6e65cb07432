//! Columns of numbers to encode, one value or three for each element.

use rayon::prelude::*;

use crate::io::error::WriteProblem;
use crate::io::fields::Attributes;
use crate::io::number::{put_float, put_integer};
use crate::io::{FloatWidth, NumberType};

/// The values of one property group and their type in the file.
#[derive(Clone, Copy)]
pub(crate) enum Column<'a> {
    Scalar(&'a [f64], NumberType),
    Vector(&'a [[f64; 3]], NumberType),
    Color(&'a [[u8; 3]]),
}

impl Column<'_> {
    pub(crate) fn components(self) -> usize {
        if matches!(self, Self::Scalar(..)) { 1 } else { 3 }
    }

    pub(crate) fn number_type(self) -> NumberType {
        match self {
            Self::Color(_) => NumberType::U8,
            Self::Scalar(_, number) | Self::Vector(_, number) => number,
        }
    }

    /// The number of bytes per element.
    pub(crate) fn size(self) -> usize {
        self.components() * self.number_type().size()
    }

    pub(crate) fn put(self, element: usize, bytes: &mut [u8]) {
        match self {
            Self::Scalar(values, number) => number.put(&[values[element]], bytes),
            Self::Vector(values, number) => number.put(&values[element], bytes),
            Self::Color(values) => bytes.copy_from_slice(&values[element]),
        }
    }

    /// Appends the numbers of an element with a space before each.
    pub(crate) fn write(self, element: usize, text: &mut Vec<u8>) {
        match self {
            Self::Scalar(values, number) => put_text(&[values[element]], number, text),
            Self::Vector(values, number) => put_text(&values[element], number, text),
            Self::Color(values) => {
                for c in values[element] {
                    text.push(b' ');
                    put_integer(text, u64::from(c));
                }
            }
        }
    }
}

/// Appends numbers with a space before each; those of 32 bits as the shortest decimal of the
/// rounded number.
pub(crate) fn put_text(values: &[f64], number: NumberType, text: &mut Vec<u8>) {
    for &x in values {
        text.push(b' ');
        put_float(text, if number == NumberType::F32 { f64::from(x as f32) } else { x });
    }
}

/// The columns of fields: scalars, vectors, colours.
pub(crate) fn columns<'a>(
    format: &'static str,
    fields: Attributes<'a>,
    width: FloatWidth,
) -> Result<Vec<Column<'a>>, WriteProblem> {
    let kept = |name: &str| fields.types.get(name).copied();
    let mut columns = Vec::new();
    for (name, values) in fields.scalars {
        columns.push(Column::Scalar(values, width_of(format, name, values, kept(name), width)?));
    }
    for (name, values) in fields.vectors {
        let number = width_of(format, name, values.as_flattened(), kept(name), width)?;
        columns.push(Column::Vector(values, number));
    }
    columns.extend(fields.colors.map(Column::Color));
    Ok(columns)
}

/// The bytes of all elements in turn.
pub(crate) fn rows(count: usize, columns: &[Column<'_>]) -> Vec<u8> {
    let stride: usize = columns.iter().map(|column| column.size()).sum();
    let mut bytes = vec![0; stride * count];
    let each_row = bytes.par_chunks_exact_mut(stride).with_min_len(1 << 13).enumerate();
    match columns {
        [only] => each_row.for_each(|(v, row)| only.put(v, row)),
        _ => each_row.for_each(|(v, row)| {
            let mut rest = row;
            for column in columns {
                let (bytes, after) = rest.split_at_mut(column.size());
                column.put(v, bytes);
                rest = after;
            }
        }),
    }
    bytes
}

/// The type of the numbers of a property group: the kept one if it holds them all, otherwise
/// one of floating-point numbers.
pub(crate) fn width_of(
    format: &'static str,
    name: &str,
    values: &[f64],
    kept: Option<NumberType>,
    width: FloatWidth,
) -> Result<NumberType, WriteProblem> {
    let holds =
        |number: NumberType| values.par_iter().with_min_len(1 << 14).all(|&x| number.holds(x));
    if let Some(kept) = kept
        && (kept.is_integer() || width == FloatWidth::Lossless)
        && holds(kept)
    {
        return Ok(kept);
    }
    match width {
        FloatWidth::Double => Ok(NumberType::F64),
        FloatWidth::Lossless if holds(NumberType::F32) => Ok(NumberType::F32),
        FloatWidth::Lossless => Ok(NumberType::F64),
        FloatWidth::Single => match values.iter().find(|x| (**x as f32).is_infinite()) {
            None => Ok(NumberType::F32),
            Some(x) => Err(WriteProblem::UnsupportedMesh {
                format,
                what: format!("{x:e} in {name} as a 32-bit number"),
            }),
        },
    }
}
