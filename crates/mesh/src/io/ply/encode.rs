//! Encoding of PLY, binary (little endian) or text.

use fairing_watch::parallel;

use crate::io::columns::{
    Column, INDICES, TEXTURE, columns, field_names, put_text, rows, vertex_names, width_of,
};
use crate::io::error::WriteProblem;
use crate::io::number::put_integer;
use crate::io::ply::header::{NAME, name_of};
use crate::io::surface::{Encoded, Faces, Surface, face_lines, lines};
use crate::io::{Encoding, FloatWidth, NumberType, WriteOptions};

/// Texture coordinates, their type, and the place of the first corner of each face.
type Texture<'a> = (&'a [[f64; 2]], NumberType, Vec<usize>);

/// The lists of a face and its other columns.
struct FaceColumns<'a> {
    texture: Option<Texture<'a>>,
    columns: Vec<Column<'a>>,
    /// True if a byte counts the numbers of each list.
    short_lists: bool,
}

pub(super) fn encode(
    surface: Surface<'_>,
    options: &WriteOptions,
) -> Result<Encoded, WriteProblem> {
    let mut vertices = vec![Column::Vector(
        surface.positions,
        width_of(
            NAME,
            "the positions",
            surface.positions.as_flattened(),
            None,
            options.float_width,
        )?,
    )];
    vertices.extend(columns(NAME, surface.fields.into(), options.float_width)?);
    let faces = face_columns(surface, options.float_width)?;
    let header = header(surface, &vertices, &faces, options.encoding);
    let mut pieces = vec![header];
    match options.encoding {
        Encoding::Ascii => {
            pieces.extend(lines(surface.positions.len(), 64, |v, text| {
                let start = text.len();
                vertices.iter().for_each(|column| column.write(v, text));
                text.remove(start);
                text.push(b'\n');
            }));
            pieces.extend(face_lines(surface.faces, |f, text| faces.write(f, text)));
        }
        Encoding::Binary => {
            pieces.push(rows(surface.positions.len(), &vertices));
            pieces.extend(face_rows(surface.faces, &faces));
        }
    }
    Ok(Encoded { pieces, notes: vec![] })
}

impl FaceColumns<'_> {
    /// Texture coordinates of a face, if there are any.
    fn texture(&self, face: usize) -> Option<(&[f64], NumberType)> {
        let (all, number, starts) = self.texture.as_ref()?;
        Some((all[starts[face]..starts[face + 1]].as_flattened(), *number))
    }

    /// Appends what follows the corners in a line of text.
    fn write(&self, face: usize, text: &mut Vec<u8>) {
        if let Some((texture, number)) = self.texture(face) {
            text.push(b' ');
            put_integer(text, texture.len() as u64);
            put_text(texture, number, text);
        }
        self.columns.iter().for_each(|column| column.write(face, text));
    }

    /// Appends the length of a list.
    fn put_length(&self, length: usize, bytes: &mut Vec<u8>) {
        if self.short_lists {
            bytes.push(length as u8);
        } else {
            bytes.extend((length as u32).to_le_bytes());
        }
    }

    /// Appends what follows the corners in a row of bytes.
    fn put(&self, face: usize, bytes: &mut Vec<u8>) {
        if let Some((texture, number)) = self.texture(face) {
            self.put_length(texture.len(), bytes);
            put_number(bytes, number.size() * texture.len(), |room| number.put(texture, room));
        }
        for column in &self.columns {
            put_number(bytes, column.size(), |room| column.put(face, room));
        }
    }
}

/// Appends `size` bytes that `put` fills.
fn put_number(bytes: &mut Vec<u8>, size: usize, put: impl FnOnce(&mut [u8])) {
    let start = bytes.len();
    bytes.resize(start + size, 0);
    put(&mut bytes[start..]);
}

fn face_columns(surface: Surface<'_>, width: FloatWidth) -> Result<FaceColumns<'_>, WriteProblem> {
    let (faces, fields) = (surface.faces, &surface.fields.faces);
    let most = (0..faces.len()).map(|f| faces.face(f).len()).max().unwrap_or(0);
    let texture = match &fields.texture {
        None => None,
        Some(all) => {
            let kept = fields.types.get(TEXTURE).copied();
            let number =
                width_of(NAME, "the texture coordinates", all.as_flattened(), kept, width)?;
            let mut starts = vec![0];
            let mut end = 0;
            starts.extend((0..faces.len()).map(|f| {
                end += faces.face(f).len();
                end
            }));
            Some((&all[..], number, starts))
        }
    };
    let short_lists = most * if texture.is_some() { 2 } else { 1 } <= 255;
    Ok(FaceColumns { texture, columns: columns(NAME, fields.into(), width)?, short_lists })
}

fn header(
    surface: Surface<'_>,
    vertices: &[Column<'_>],
    faces: &FaceColumns<'_>,
    encoding: Encoding,
) -> Vec<u8> {
    let encoding = match encoding {
        Encoding::Ascii => "ascii",
        Encoding::Binary => "binary_little_endian",
    };
    let vertex_count = surface.positions.len();
    let mut text = format!("ply\nformat {encoding} 1.0\nelement vertex {vertex_count}\n");
    let properties = |text: &mut String, columns: &[Column<'_>], names: Vec<String>| {
        let mut names = names.into_iter();
        for column in columns {
            for name in names.by_ref().take(column.components()) {
                text.push_str(&format!("property {} {name}\n", name_of(column.number_type())));
            }
        }
    };
    properties(&mut text, vertices, vertex_names(surface.fields));
    let count = if faces.short_lists { "uchar" } else { "uint" };
    // Old readers support signed indices only.
    let index = if i32::try_from(vertex_count).is_ok() { "int" } else { "uint" };
    text.push_str(&format!("element face {}\n", surface.faces.len()));
    text.push_str(&format!("property list {count} {index} {}\n", INDICES[0]));
    if let Some((_, number, _)) = faces.texture {
        text.push_str(&format!("property list {count} {} {TEXTURE}\n", name_of(number)));
    }
    properties(&mut text, &faces.columns, field_names((&surface.fields.faces).into()));
    text.push_str("end_header\n");
    text.into_bytes()
}

fn face_rows(all: Faces<'_>, columns: &FaceColumns<'_>) -> Vec<Vec<u8>> {
    if let Faces::Triangles(faces) = all
        && columns.columns.is_empty()
        && columns.texture.is_none()
    {
        let mut bytes = vec![0; 13 * faces.len()];
        parallel::for_rows(bytes.as_chunks_mut::<13>().0, |f, row| {
            row[0] = 3;
            let words = row[1..].as_chunks_mut().0;
            words.iter_mut().zip(faces[f]).for_each(|(word, v)| *word = v.to_le_bytes());
        });
        return vec![bytes];
    }
    lines(all.len(), 32, |f, bytes| {
        let face = all.face(f);
        columns.put_length(face.len(), bytes);
        face.iter().for_each(|v| bytes.extend(v.to_le_bytes()));
        columns.put(f, bytes);
    })
}
