//! Fields as a list and bytes, as a page keeps them for the next session.
//!
//! An entry of the list has the kind and the name of a field, and true if it was computed; its
//! numbers follow those of the entries before it.

use std::collections::BTreeSet;

use anyhow::{Result, anyhow, bail, ensure};
use fairing_mesh::io::VertexFields;
use serde_json::{Value, json};

/// The kinds and the names of fields that were computed here.
pub(crate) type Computed = BTreeSet<(&'static str, String)>;

/// Returns true for a field that was computed.
pub(crate) fn is_computed(computed: &Computed, kind: &str, name: &str) -> bool {
    computed.iter().any(|(k, n)| *k == kind && n == name)
}

/// The bytes of a value: numbers of 64 bits and bytes of colours.
fn width(kind: &str) -> Result<u64> {
    Ok(match kind {
        "scalar" | "face scalar" => 8,
        "vector" | "face vector" => 24,
        "color" | "face color" => 3,
        "texture" => 48,
        _ => bail!("{kind:?} is no kind of field"),
    })
}

/// The kind and the name of an entry.
fn entry(entry: &Value) -> Result<[&str; 2]> {
    match [entry[0].as_str(), entry[1].as_str()] {
        [Some(kind), Some(name)] => Ok([kind, name]),
        _ => bail!("{entry} must be the kind and the name of a field"),
    }
}

/// The number of values of a field of this kind.
fn count(kind: &str, vertices: u32, faces: u32) -> u32 {
    if kind.starts_with("face") || kind == "texture" { faces } else { vertices }
}

/// The number of bytes of a mesh with these fields: positions, faces, and the fields.
pub(crate) fn size(vertices: u32, faces: u32, fields: &[Value]) -> Result<u64> {
    let mut size = 24 * u64::from(vertices) + 12 * u64::from(faces);
    for field in fields {
        let [kind, _] = entry(field)?;
        let bytes = width(kind)? * u64::from(count(kind, vertices, faces));
        size = size.checked_add(bytes).ok_or_else(|| anyhow!("{} fields", fields.len()))?;
    }
    Ok(size)
}

/// The fields of a list, from their bytes, and those of them that were computed.
pub(crate) fn unpacked(
    mut bytes: &[u8],
    vertices: u32,
    faces: u32,
    fields: &[Value],
) -> Result<(VertexFields, Computed)> {
    let (mut made, mut computed) = (VertexFields::default(), Computed::new());
    for field in fields {
        let [kind, name] = entry(field)?;
        let length = width(kind)? as usize * count(kind, vertices, faces) as usize;
        ensure!(length <= bytes.len(), "{name} has {} bytes instead of {length}", bytes.len());
        let (own, rest) = bytes.split_at(length);
        let name = name.to_owned();
        if let Some(kind) = ["scalar", "vector"].into_iter().find(|known| *known == kind)
            && field[2] == true
        {
            computed.insert((kind, name.clone()));
        }
        match kind {
            "scalar" => made.scalars.push((name, numbers(own))),
            "vector" => made.vectors.push((name, numbers(own).as_chunks().0.to_vec())),
            "color" => made.colors = Some(own.as_chunks().0.to_vec()),
            "face scalar" => made.faces.scalars.push((name, numbers(own))),
            "face vector" => made.faces.vectors.push((name, numbers(own).as_chunks().0.to_vec())),
            "face color" => made.faces.colors = Some(own.as_chunks().0.to_vec()),
            _ => made.faces.texture = Some(numbers(own).as_chunks().0.to_vec()),
        }
        bytes = rest;
    }
    Ok((made, computed))
}

/// The list and the bytes of all fields but scalars of vertices.
pub(crate) fn packed(fields: &VertexFields, computed: &Computed) -> (Vec<Value>, Vec<u8>) {
    let (mut list, mut bytes) = (vec![], vec![]);
    let mut numbers = |kind: &str, name: &str, values: &[f64]| {
        list.push(json!([kind, name, is_computed(computed, kind, name)]));
        bytes.extend(values.iter().flat_map(|x| x.to_le_bytes()));
    };
    for (name, values) in &fields.vectors {
        numbers("vector", name, values.as_flattened());
    }
    for (name, values) in &fields.faces.scalars {
        numbers("face scalar", name, values);
    }
    for (name, values) in &fields.faces.vectors {
        numbers("face vector", name, values.as_flattened());
    }
    if let Some(texture) = &fields.faces.texture {
        numbers("texture", "", texture.as_flattened());
    }
    for (kind, colors) in [("color", &fields.colors), ("face color", &fields.faces.colors)] {
        if let Some(colors) = colors {
            list.push(json!([kind, "", false]));
            bytes.extend(colors.as_flattened());
        }
    }
    (list, bytes)
}

/// Numbers of 64 bits, the lowest byte first.
pub(crate) fn numbers(bytes: &[u8]) -> Vec<f64> {
    bytes.as_chunks().0.iter().map(|bytes| f64::from_le_bytes(*bytes)).collect()
}

/// Whole numbers of 32 bits, the lowest byte first.
pub(crate) fn integers(bytes: &[u8]) -> Vec<u32> {
    bytes.as_chunks().0.iter().map(|bytes| u32::from_le_bytes(*bytes)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One field of each kind on two vertices and one face.
    #[test]
    fn fields_survive() {
        let mut fields = VertexFields::default()
            .with_vector("normal", vec![[0.0, 0.5, 1.0], [2.0, 3.0, 4.0]])
            .with_vector("flow", vec![[5.0; 3], [-0.0; 3]])
            .with_colors(vec![[1, 2, 3], [4, 5, 6]]);
        fields.faces.scalars.push(("part".into(), vec![7.0]));
        fields.faces.vectors.push(("normal".into(), vec![[0.1; 3]]));
        fields.faces.colors = Some(vec![[7, 8, 9]]);
        fields.faces.texture = Some(vec![[0.0, 1.0], [0.25, 0.5], [1.0, 0.0]]);
        let computed = Computed::from([("vector", "flow".to_owned())]);
        let (list, bytes) = packed(&fields, &computed);
        assert_eq!(size(2, 1, &list).unwrap(), 2 * 24 + 12 + bytes.len() as u64);
        assert_eq!(unpacked(&bytes, 2, 1, &list).unwrap(), (fields, computed));
    }

    #[test]
    fn wrong_lists_are_refused() {
        for field in [json!("H"), json!(["H"]), json!(["scalar", 1]), json!(["matrix", "H"])] {
            assert!(size(1, 1, std::slice::from_ref(&field)).is_err(), "{field}");
        }
        let scalar = [json!(["scalar", "H"])];
        assert_eq!(size(u32::MAX, u32::MAX, &scalar).unwrap(), 44 * u64::from(u32::MAX));
        assert!(unpacked(&[0; 15], 2, 0, &scalar).is_err());
    }
}
