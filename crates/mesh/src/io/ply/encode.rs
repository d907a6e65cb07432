//! Encoding of PLY, binary (little endian) or text.

use rayon::prelude::*;

use crate::io::error::WriteProblem;
use crate::io::number::{put_float, put_integer};
use crate::io::ply::layout::property_names;
use crate::io::surface::{Encoded, Faces, Surface, face_lines, lines};
use crate::io::{Encoding, FloatWidth, VertexFields, WriteOptions};

/// The values of one property group and their width in the file.
#[derive(Clone, Copy)]
enum Column<'a> {
    Scalar(&'a [f64], Width),
    Vector(&'a [[f64; 3]], Width),
    Color(&'a [[u8; 3]]),
}

#[derive(Clone, Copy, PartialEq)]
enum Width {
    Single,
    Double,
}

impl Column<'_> {
    fn components(self) -> usize {
        if matches!(self, Self::Scalar(..)) { 1 } else { 3 }
    }

    fn type_name(self) -> &'static str {
        match self {
            Self::Color(_) => "uchar",
            Self::Scalar(_, Width::Single) | Self::Vector(_, Width::Single) => "float",
            Self::Scalar(_, Width::Double) | Self::Vector(_, Width::Double) => "double",
        }
    }

    /// The number of bytes per vertex.
    fn size(self) -> usize {
        self.components()
            * match self.type_name() {
                "uchar" => 1,
                "float" => 4,
                _ => 8,
            }
    }

    fn put(self, vertex: usize, bytes: &mut [u8]) {
        match self {
            Self::Scalar(values, width) => put_floats(&[values[vertex]], width, bytes),
            Self::Vector(values, width) => put_floats(&values[vertex], width, bytes),
            Self::Color(values) => bytes.copy_from_slice(&values[vertex]),
        }
    }

    fn write(self, vertex: usize, text: &mut Vec<u8>) {
        let mut put = |x: f64, width| {
            // The shortest decimal of the rounded number.
            let x = if width == Width::Single { f64::from(x as f32) } else { x };
            put_float(text, x);
            text.push(b' ');
        };
        match self {
            Self::Scalar(values, width) => put(values[vertex], width),
            Self::Vector(values, width) => values[vertex].into_iter().for_each(|x| put(x, width)),
            Self::Color(values) => {
                for c in values[vertex] {
                    put_integer(text, u64::from(c));
                    text.push(b' ');
                }
            }
        }
    }
}

#[inline]
fn put_floats(values: &[f64], width: Width, bytes: &mut [u8]) {
    match width {
        Width::Single => {
            let words = bytes.as_chunks_mut().0;
            words.iter_mut().zip(values).for_each(|(word, &x)| *word = (x as f32).to_le_bytes());
        }
        Width::Double => {
            let words = bytes.as_chunks_mut().0;
            words.iter_mut().zip(values).for_each(|(word, &x)| *word = x.to_le_bytes());
        }
    }
}

pub(super) fn encode(
    surface: Surface<'_>,
    options: &WriteOptions,
) -> Result<Encoded, WriteProblem> {
    let columns = columns(surface.positions, surface.fields, options.float_width)?;
    let short_lists = match surface.faces {
        Faces::Triangles(_) => true,
        Faces::Polygons(mesh) => mesh.polygons().all(|polygon| polygon.len() <= 255),
    };
    let header = header(surface, &columns, options.encoding, short_lists);
    let pieces = match options.encoding {
        Encoding::Ascii => {
            let mut pieces = vec![header];
            pieces.extend(lines(surface.positions.len(), 64, |v, text| {
                columns.iter().for_each(|column| column.write(v, text));
                text.pop();
                text.push(b'\n');
            }));
            pieces.extend(face_lines(surface.faces));
            pieces
        }
        Encoding::Binary => vec![header, rows(surface, &columns), face_rows(surface, short_lists)],
    };
    Ok(Encoded { pieces, notes: vec![] })
}

fn columns<'a>(
    positions: &'a [[f64; 3]],
    fields: &'a VertexFields,
    width: FloatWidth,
) -> Result<Vec<Column<'a>>, WriteProblem> {
    let width_of = |name: &str, values: &[f64]| match width {
        FloatWidth::Double => Ok(Width::Double),
        FloatWidth::Lossless => {
            let exact = |x: &f64| f64::from(*x as f32) == *x;
            let all = values.par_iter().with_min_len(1 << 14).all(exact);
            Ok(if all { Width::Single } else { Width::Double })
        }
        FloatWidth::Single => match values.iter().find(|x| (**x as f32).is_infinite()) {
            None => Ok(Width::Single),
            Some(x) => Err(WriteProblem::UnsupportedMesh {
                format: "PLY",
                what: format!("{x:e} in {name} as a 32-bit number"),
            }),
        },
    };
    let mut columns =
        vec![Column::Vector(positions, width_of("the positions", positions.as_flattened())?)];
    for (name, values) in &fields.scalars {
        columns.push(Column::Scalar(values, width_of(name, values)?));
    }
    for (name, values) in &fields.vectors {
        columns.push(Column::Vector(values, width_of(name, values.as_flattened())?));
    }
    columns.extend(fields.colors.as_deref().map(Column::Color));
    Ok(columns)
}

fn header(
    surface: Surface<'_>,
    columns: &[Column<'_>],
    encoding: Encoding,
    short_lists: bool,
) -> Vec<u8> {
    let encoding = match encoding {
        Encoding::Ascii => "ascii",
        Encoding::Binary => "binary_little_endian",
    };
    let vertices = surface.positions.len();
    let mut text = format!("ply\nformat {encoding} 1.0\nelement vertex {vertices}\n");
    let mut names = property_names(surface.fields).into_iter();
    for column in columns {
        for name in names.by_ref().take(column.components()) {
            text.push_str(&format!("property {} {name}\n", column.type_name()));
        }
    }
    let count = if short_lists { "uchar" } else { "uint" };
    // Old readers support signed indices only.
    let index = if i32::try_from(vertices).is_ok() { "int" } else { "uint" };
    text.push_str(&format!("element face {}\n", surface.faces.len()));
    text.push_str(&format!("property list {count} {index} vertex_indices\nend_header\n"));
    text.into_bytes()
}

fn rows(surface: Surface<'_>, columns: &[Column<'_>]) -> Vec<u8> {
    let stride: usize = columns.iter().map(|column| column.size()).sum();
    let mut bytes = vec![0; stride * surface.positions.len()];
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

fn face_rows(surface: Surface<'_>, short_lists: bool) -> Vec<u8> {
    match surface.faces {
        Faces::Triangles(faces) => {
            let mut bytes = vec![0; 13 * faces.len()];
            bytes.par_chunks_exact_mut(13).with_min_len(1 << 13).zip(faces).for_each(
                |(row, face)| {
                    row[0] = 3;
                    let words = row[1..].as_chunks_mut().0;
                    words.iter_mut().zip(face).for_each(|(word, v)| *word = v.to_le_bytes());
                },
            );
            bytes
        }
        Faces::Polygons(mesh) => {
            let mut bytes = Vec::new();
            for face in mesh.polygons() {
                if short_lists {
                    bytes.push(face.len() as u8);
                } else {
                    bytes.extend((face.len() as u32).to_le_bytes());
                }
                face.iter().for_each(|v| bytes.extend(v.to_le_bytes()));
            }
            bytes
        }
    }
}
