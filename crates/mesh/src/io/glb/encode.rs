//! Encoding of GLB: one mesh in one node, its numbers one array after the other.

use fairing_watch::parallel;
use std::collections::HashSet;

use serde_json::{Map, Value, json};

use crate::io::columns::width_of;
use crate::io::error::WriteProblem;
use crate::io::glb::accessor::to_linear;
use crate::io::glb::document::{BINARY, JSON, MAGIC, NAME, POINTS, TRIANGLES};
use crate::io::number_type::NumberType;
use crate::io::surface::{Encoded, Surface, lines};
use crate::io::{FloatWidth, WriteOptions};

/// Targets of arrays: vertices, and the corners of faces.
const OF_VERTICES: u32 = 34962;
const OF_CORNERS: u32 = 34963;

/// The arrays of a file under construction, each of a multiple of four bytes.
#[derive(Default)]
struct Arrays {
    views: Vec<Value>,
    accessors: Vec<Value>,
    pieces: Vec<Vec<u8>>,
    length: usize,
    /// The names of the numbers that 32 bits do not hold.
    rounded: Vec<String>,
}

impl Arrays {
    /// Adds an array, and returns its number.
    fn add(&mut self, pieces: Vec<Vec<u8>>, target: u32, mut accessor: Value) -> usize {
        let length: usize = pieces.iter().map(Vec::len).sum();
        accessor["bufferView"] = json!(self.views.len());
        self.views.push(json!({
            "buffer": 0, "byteOffset": self.length, "byteLength": length, "target": target,
        }));
        self.accessors.push(accessor);
        self.pieces.extend(pieces);
        self.length += length;
        self.accessors.len() - 1
    }

    /// Adds numbers of 32 bits, `components` of each vertex.
    fn floats(
        &mut self,
        name: &str,
        values: &[f64],
        components: usize,
        bounds: bool,
    ) -> Result<usize, WriteProblem> {
        width_of(NAME, name, values, None, FloatWidth::Single)?;
        if !parallel::all(values.len(), 1 << 14, |i| NumberType::F32.holds(values[i])) {
            self.rounded.push(name.to_owned());
        }
        let mut bytes = vec![0; 4 * values.len()];
        NumberType::F32.put(values, &mut bytes);
        let kind = if components == 1 { "SCALAR" } else { "VEC3" };
        let mut accessor =
            json!({ "componentType": 5126, "count": values.len() / components, "type": kind });
        if bounds {
            let all = values.as_chunks::<3>().0;
            let of = |k: usize| all.iter().map(move |p| p[k] as f32);
            accessor["min"] = json!([0, 1, 2].map(|k| of(k).fold(f32::INFINITY, f32::min)));
            accessor["max"] = json!([0, 1, 2].map(|k| of(k).fold(f32::NEG_INFINITY, f32::max)));
        }
        Ok(self.add(vec![bytes], OF_VERTICES, accessor))
    }
}

pub(super) fn encode(surface: Surface<'_>, _: &WriteOptions) -> Result<Encoded, WriteProblem> {
    let Surface { positions, faces, .. } = surface;
    let mut arrays = Arrays::default();
    let attributes = attributes(&mut arrays, surface)?;
    let mut primitive = json!({ "attributes": attributes, "material": 0, "mode": POINTS });
    if faces.len() > 0 {
        let corners = lines(faces.len(), 12, |f, bytes| {
            faces.face(f).iter().for_each(|v| bytes.extend(v.to_le_bytes()));
        });
        let accessor = json!({ "componentType": 5125, "count": 3 * faces.len(), "type": "SCALAR" });
        primitive["indices"] = json!(arrays.add(corners, OF_CORNERS, accessor));
        primitive["mode"] = json!(TRIANGLES);
    }
    let Arrays { views, accessors, pieces: binary, length, rounded } = arrays;
    let material = json!({
        "doubleSided": true,
        "pbrMetallicRoughness": { "metallicFactor": 0.0, "roughnessFactor": 0.8 },
    });
    let document = json!({
        "asset": { "version": "2.0", "generator": "Fairing" },
        "scene": 0,
        "scenes": [{ "nodes": [0] }],
        "nodes": [{ "mesh": 0 }],
        "meshes": [{ "primitives": [primitive] }],
        "materials": [material],
        "accessors": accessors,
        "bufferViews": views,
        "buffers": [{ "byteLength": length }],
    });
    let mut text = document.to_string().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    let whole = 12 + 8 + text.len() + 8 + length;
    let Ok(whole) = u32::try_from(whole) else {
        let what = format!("{} vertices with their fields: {whole} bytes", positions.len());
        return Err(WriteProblem::UnsupportedMesh { format: NAME, what });
    };
    // The whole is larger than its parts, which have 32 bits, too.
    let header = [MAGIC, &word(2), &word(whole), &word(text.len() as u32), &word(JSON)].concat();
    let mut pieces = vec![header, text, [word(length as u32), word(BINARY)].concat()];
    pieces.extend(binary);
    let note = || format!("GLB rounds to 32 bits: {}", rounded.join(", "));
    Ok(Encoded { pieces, notes: (!rounded.is_empty()).then(note).into_iter().collect() })
}

fn word(word: u32) -> [u8; 4] {
    word.to_le_bytes()
}

/// Adds positions and fields, and returns the numbers of their arrays by name.
fn attributes(
    arrays: &mut Arrays,
    surface: Surface<'_>,
) -> Result<Map<String, Value>, WriteProblem> {
    let Surface { positions, fields, .. } = surface;
    let mut attributes = Map::new();
    let position = arrays.floats("positions", positions.as_flattened(), 3, true)?;
    attributes.insert("POSITION".to_owned(), json!(position));
    let mut names = HashSet::new();
    let scalars = fields.scalars.iter().map(|(name, values)| (name, &values[..], 1));
    let vectors = fields.vectors.iter().map(|(name, values)| (name, values.as_flattened(), 3));
    for (name, values, components) in scalars.chain(vectors) {
        // Normals of other lengths are no normals to the format.
        let is_normal = components == 3 && name == "normal" && are_units(values);
        if !is_normal && !names.insert(name) {
            let reason = "a scalar and a vector of this name";
            return Err(WriteProblem::FieldName { name: name.clone(), reason });
        }
        let attribute = if is_normal { "NORMAL".to_owned() } else { format!("_{name}") };
        let array = arrays.floats(name, values, components, false)?;
        attributes.insert(attribute, json!(array));
    }
    if let Some(colors) = &fields.colors {
        let bytes = lines(colors.len(), 8, |v, bytes| {
            let [r, g, b] = colors[v].map(to_linear);
            [r, g, b, u16::MAX].iter().for_each(|c| bytes.extend(c.to_le_bytes()));
        });
        let accessor = json!({
            "componentType": 5123, "normalized": true, "count": colors.len(), "type": "VEC4",
        });
        attributes.insert("COLOR_0".to_owned(), json!(arrays.add(bytes, OF_VERTICES, accessor)));
    }
    Ok(attributes)
}

/// Returns true for vectors of unit length, rounded to 32 bits or a little more.
fn are_units(vectors: &[f64]) -> bool {
    let is_unit = |v: &[f64; 3]| (v.iter().map(|x| x * x).sum::<f64>() - 1.0).abs() < 1e-5;
    vectors.as_chunks().0.iter().all(is_unit)
}
