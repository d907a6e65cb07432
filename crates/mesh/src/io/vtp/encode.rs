//! Encoding of VTP: the numbers as bytes after the XML, or as text in it.

use std::collections::HashSet;

use quick_xml::escape::escape;

use crate::io::columns::width_of;
use crate::io::error::WriteProblem;
use crate::io::fields::Attributes;
use crate::io::number::{put_float, put_integer};
use crate::io::surface::{Encoded, Faces, Surface, lines};
use crate::io::vtp::document::{ArrayType, COLORS, NAME, TYPES};
use crate::io::{Encoding, FloatWidth, NumberType, WriteOptions};

/// The numbers of an array.
#[derive(Clone, Copy)]
enum Values<'a> {
    Floats(&'a [f64], NumberType),
    Bytes(&'a [u8]),
    /// The corners of all faces.
    Corners(Faces<'a>),
    /// Corners of vertices, or ends of cells among the corners.
    Numbers(&'a [i64]),
}

/// An array of numbers under a name.
struct DataArray<'a> {
    name: &'a str,
    components: usize,
    values: Values<'a>,
}

impl DataArray<'_> {
    fn type_name(&self) -> &'static str {
        let kind = match self.values {
            Values::Bytes(_) => ArrayType::Number(NumberType::U8),
            Values::Corners(_) | Values::Numbers(_) => ArrayType::I64,
            Values::Floats(_, number) => ArrayType::Number(number),
        };
        TYPES.iter().find(|(_, of_name)| *of_name == kind).map_or("", |&(name, _)| name)
    }

    /// The numbers in little-endian order, in pieces.
    fn binary(&self) -> Vec<Vec<u8>> {
        match self.values {
            Values::Bytes(bytes) => vec![bytes.to_vec()],
            Values::Floats(values, number) => {
                let mut bytes = vec![0; number.size() * values.len()];
                number.put(values, &mut bytes);
                vec![bytes]
            }
            Values::Corners(faces) => lines(faces.len(), 24, |f, bytes| {
                faces.face(f).iter().for_each(|&v| bytes.extend(u64::from(v).to_le_bytes()));
            }),
            Values::Numbers(ends) => vec![ends.iter().flat_map(|end| end.to_le_bytes()).collect()],
        }
    }

    /// The numbers as lines of text.
    fn text(&self) -> Vec<Vec<u8>> {
        let components = self.components;
        let put = |x: f64, number: NumberType, text: &mut Vec<u8>| {
            put_float(text, if number == NumberType::F32 { f64::from(x as f32) } else { x });
            text.push(b' ');
        };
        match self.values {
            Values::Bytes(bytes) => lines(bytes.len() / components, 12, |k, text| {
                for &byte in &bytes[components * k..components * (k + 1)] {
                    put_integer(text, u64::from(byte));
                    text.push(b' ');
                }
                text.push(b'\n');
            }),
            Values::Floats(values, number) => lines(values.len() / components, 64, |k, text| {
                let row = &values[components * k..components * (k + 1)];
                row.iter().for_each(|&x| put(x, number, text));
                text.push(b'\n');
            }),
            Values::Corners(faces) => lines(faces.len(), 24, |f, text| {
                for &v in faces.face(f) {
                    put_integer(text, u64::from(v));
                    text.push(b' ');
                }
                text.push(b'\n');
            }),
            Values::Numbers(ends) => lines(ends.len(), 8, |f, text| {
                put_integer(text, ends[f].unsigned_abs());
                text.push(b'\n');
            }),
        }
    }
}

/// A file under construction.
struct Writer {
    encoding: Encoding,
    /// The XML since the last text of an array.
    xml: String,
    pieces: Vec<Vec<u8>>,
    appended: Vec<Vec<u8>>,
    offset: usize,
}

pub(super) fn encode(
    surface: Surface<'_>,
    options: &WriteOptions,
) -> Result<Encoded, WriteProblem> {
    let Surface { positions, faces, fields } = surface;
    let width = options.float_width;
    let values = positions.as_flattened();
    let points = width_of(NAME, "the positions", values, None, width)?;
    let points =
        DataArray { name: "Points", components: 3, values: Values::Floats(values, points) };
    let mut end = 0;
    let ends: Vec<i64> = (0..faces.len())
        .map(|f| {
            end += faces.face(f).len() as i64;
            end
        })
        .collect();
    let polys = cells(Values::Corners(faces), &ends);
    // Programs show no points without cells.
    let lone = if faces.len() == 0 { positions.len() as i64 } else { 0 };
    let (numbers, lone_ends): (Vec<i64>, Vec<i64>) = (0..lone).map(|v| (v, v + 1)).unzip();
    let verts = cells(Values::Numbers(&numbers), &lone_ends);
    let of_points = arrays(fields.into(), width)?;
    let of_cells = arrays((&fields.faces).into(), width)?;

    let mut writer = Writer {
        encoding: options.encoding,
        xml: String::new(),
        pieces: vec![],
        appended: vec![],
        offset: 0,
    };
    writer.xml.push_str(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<VTKFile type=\"PolyData\" version=\"1.0\" \
         byte_order=\"LittleEndian\" header_type=\"UInt64\">\n<PolyData>\n",
    );
    writer.xml.push_str(&format!(
        "<Piece NumberOfPoints=\"{}\" NumberOfVerts=\"{lone}\" NumberOfLines=\"0\" \
         NumberOfStrips=\"0\" NumberOfPolys=\"{}\">\n",
        positions.len(),
        faces.len()
    ));
    writer.section("PointData", &of_points);
    writer.section("CellData", &of_cells);
    writer.section("Points", &[points]);
    if lone > 0 {
        writer.section("Verts", &verts);
    }
    writer.section("Polys", &polys);
    Ok(writer.finish())
}

/// The arrays of cells: their corners one after the other, and where each cell ends.
fn cells<'a>(corners: Values<'a>, ends: &'a [i64]) -> [DataArray<'a>; 2] {
    [("connectivity", corners), ("offsets", Values::Numbers(ends))]
        .map(|(name, values)| DataArray { name, components: 1, values })
}

/// The arrays of fields.
fn arrays(fields: Attributes<'_>, width: FloatWidth) -> Result<Vec<DataArray<'_>>, WriteProblem> {
    let mut arrays = Vec::new();
    let mut names = HashSet::new();
    let mut add = |name, components, values| {
        if !names.insert(name) {
            let reason = "two arrays of this name; colours are RGB";
            return Err(WriteProblem::FieldName { name: String::from(name), reason });
        }
        arrays.push(DataArray { name, components, values });
        Ok(())
    };
    let kept = |name: &str| fields.types.get(name).copied();
    for (name, values) in fields.scalars {
        let number = width_of(NAME, name, values, kept(name), width)?;
        add(name, 1, Values::Floats(values, number))?;
    }
    for (name, values) in fields.vectors {
        let values = values.as_flattened();
        // Three bytes of this name are colours.
        let kept = kept(name).filter(|&kept| name != COLORS || kept != NumberType::U8);
        let number = width_of(NAME, name, values, kept, width)?;
        add(name, 3, Values::Floats(values, number))?;
    }
    if let Some(colors) = fields.colors {
        add(COLORS, 3, Values::Bytes(colors.as_flattened()))?;
    }
    Ok(arrays)
}

impl Writer {
    /// Writes an element with its arrays. Programs show the first scalar field first.
    fn section(&mut self, name: &str, arrays: &[DataArray<'_>]) {
        self.xml.push_str(&format!("<{name}"));
        if name.ends_with("Data") {
            if let Some(first) = arrays.iter().find(|array| array.components == 1) {
                self.xml.push_str(&format!(" Scalars=\"{}\"", escape(first.name)));
            }
            if arrays.iter().any(|array| array.components == 3 && array.name == "normal") {
                self.xml.push_str(" Normals=\"normal\"");
            }
        }
        self.xml.push_str(">\n");
        arrays.iter().for_each(|array| self.array(array));
        self.xml.push_str(&format!("</{name}>\n"));
    }

    fn array(&mut self, array: &DataArray<'_>) {
        self.xml.push_str(&format!(
            "<DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\"",
            array.type_name(),
            escape(array.name),
            array.components
        ));
        match self.encoding {
            Encoding::Ascii => {
                self.xml.push_str(" format=\"ascii\">\n");
                self.pieces.push(std::mem::take(&mut self.xml).into_bytes());
                self.pieces.extend(array.text());
                self.xml.push_str("</DataArray>\n");
            }
            Encoding::Binary => {
                self.xml.push_str(&format!(" format=\"appended\" offset=\"{}\"/>\n", self.offset));
                let data = array.binary();
                let length: usize = data.iter().map(Vec::len).sum();
                self.appended.push((length as u64).to_le_bytes().to_vec());
                self.appended.extend(data);
                self.offset += 8 + length;
            }
        }
    }

    fn finish(mut self) -> Encoded {
        self.xml.push_str("</Piece>\n</PolyData>\n");
        if self.encoding == Encoding::Binary {
            self.xml.push_str("<AppendedData encoding=\"raw\">\n_");
        }
        self.pieces.push(self.xml.into_bytes());
        if self.encoding == Encoding::Binary {
            self.pieces.extend(self.appended);
            self.pieces.push(b"\n</AppendedData>\n".to_vec());
        }
        self.pieces.push(b"</VTKFile>\n".to_vec());
        Encoded { pieces: self.pieces, notes: vec![] }
    }
}
