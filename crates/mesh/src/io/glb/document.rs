//! The chunks of a GLB file, its JSON by paths, and the meshes of its scene.

use std::borrow::Cow;

use glam::{DAffine3, DMat3, DMat4, DQuat, DVec3, DVec4};
use serde_json::Value;

use crate::io::error::{Fault, unexpected};
use crate::io::glb::buffers::{self, Beside, Buffer};
use crate::io::glb::entry::Entry;

/// The name of the format.
pub(super) const NAME: &str = "GLB";

/// The first four bytes of a file.
pub(super) const MAGIC: &[u8] = b"glTF";

/// The types of chunks.
pub(super) const JSON: u32 = u32::from_le_bytes(*b"JSON");
pub(super) const BINARY: u32 = u32::from_le_bytes(*b"BIN\0");

/// The modes of primitives.
pub(super) const POINTS: usize = 0;
pub(super) const TRIANGLES: usize = 4;

/// The JSON and the binary data of a file.
pub(super) struct Document<'a> {
    pub(super) root: Value,
    pub(super) buffers: Vec<Option<Buffer<'a>>>,
}

impl<'a> Document<'a> {
    /// Reads GLB, or JSON alone.
    pub(super) fn read(bytes: &'a [u8], beside: Beside<'_>) -> Result<Self, Fault> {
        let json = |at: usize, text| {
            serde_json::from_slice(text).map_err(|error| {
                Fault::at_byte(at, unexpected("the JSON of glTF", error.to_string()))
            })
        };
        let (root, binary) = if bytes.starts_with(MAGIC) {
            let (text, binary) = chunks(bytes)?;
            (json(20, text)?, binary)
        } else {
            (json(0, bytes)?, None)
        };
        let entry = Entry::root(&root);
        let buffers = buffers::read(&entry, binary, beside)?;
        Ok(Self { root, buffers })
    }

    /// The number of bytes of all buffers.
    pub(super) fn length(&self) -> usize {
        self.buffers.iter().flatten().map(|buffer| buffer.data.len()).sum()
    }

    /// The whole of the JSON.
    pub(super) fn root(&self) -> Entry<'_> {
        Entry::root(&self.root)
    }
}

/// The JSON of a GLB file and its binary data.
fn chunks(bytes: &[u8]) -> Result<(&[u8], Option<Buffer<'_>>), Fault> {
    let version = word(bytes, 4).unwrap_or_default();
    if version != 2 {
        return Err(Fault::at_byte(4, unexpected("version 2 of glTF", version.to_string())));
    }
    let length = word(bytes, 8).unwrap_or_default() as usize;
    let Some(bytes) = bytes.get(..length) else {
        let expected = format!("{length} bytes, as the header says");
        return Err(Fault::at_byte(8, unexpected(expected, bytes.len().to_string())));
    };
    let (json, mut at) = chunk(bytes, 12, JSON)?;
    let mut binary = None;
    if at < bytes.len() && word(bytes, at + 4) == Some(BINARY) {
        let start = at + 8;
        let data;
        (data, at) = chunk(bytes, at, BINARY)?;
        binary = Some(Buffer { data: Cow::Borrowed(data), at: Some(start) });
    }
    // Chunks of other types may follow, which readers have to ignore.
    while at < bytes.len() {
        let kind = word(bytes, at + 4).unwrap_or_default();
        (_, at) = chunk(bytes, at, kind)?;
    }
    Ok((json, binary))
}

/// The number of four bytes.
fn word(bytes: &[u8], at: usize) -> Option<u32> {
    let bytes = bytes.get(at..)?.first_chunk()?;
    Some(u32::from_le_bytes(*bytes))
}

/// The content of a chunk, and the place after it.
fn chunk(bytes: &[u8], at: usize, kind: u32) -> Result<(&[u8], usize), Fault> {
    let fault = |expected: &str| {
        let found = format!("{} bytes", bytes.len().saturating_sub(at));
        Fault::at_byte(at, unexpected(expected, found))
    };
    let (Some(length), Some(found)) = (word(bytes, at), word(bytes, at + 4)) else {
        return Err(fault("the 8 bytes of the header of a chunk"));
    };
    if found != kind {
        let problem = unexpected("the chunk of JSON", format!("a chunk of type {found:#x}"));
        return Err(Fault::at_byte(at, problem));
    }
    let start = at + 8;
    let end = start.checked_add(length as usize).filter(|&end| end <= bytes.len());
    let Some(end) = end else {
        return Err(fault(&format!("a chunk of {length} bytes")));
    };
    Ok((&bytes[start..end], end))
}

/// A mesh in its place.
pub(super) struct Instance {
    pub(super) mesh: usize,
    pub(super) to_scene: DAffine3,
}

/// The meshes of the scene that the file shows first, in the order of its nodes.
pub(super) fn instances(root: &Entry<'_>, notes: &mut Vec<String>) -> Result<Vec<Instance>, Fault> {
    let scenes = root.list("scenes")?.len();
    let nodes = root.list("nodes")?.len();
    if scenes == 0 {
        let meshes = root.list("meshes")?.len();
        if nodes > 0 {
            notes.push("there is no scene: meshes are read without transformations".to_owned());
        }
        let identity = |mesh| Instance { mesh, to_scene: DAffine3::IDENTITY };
        return Ok((0..meshes).map(identity).collect());
    }
    if scenes > 1 {
        notes.push(format!("one of {scenes} scenes is read"));
    }
    let scene = root.at("scenes", root.optional_count("scene")?.unwrap_or(0))?;
    let mut instances = Vec::new();
    let mut seen = vec![false; nodes];
    let mut skins = 0;
    let mut stack = Vec::new();
    let push = |stack: &mut Vec<_>, of: &Entry<'_>, key, to_scene| {
        for child in of.list(key)?.iter().rev() {
            stack.push((child.count()?, to_scene));
        }
        Ok::<_, Fault>(())
    };
    push(&mut stack, &scene, "nodes", DAffine3::IDENTITY)?;
    while let Some((node, parent)) = stack.pop() {
        let entry = root.at("nodes", node)?;
        if std::mem::replace(&mut seen[node], true) {
            return Err(entry.fault("a node in one place of the scene", "it in two"));
        }
        let to_scene = match placement(&entry)? {
            Some(to_parent) => parent * to_parent,
            None => parent,
        };
        if let Some(mesh) = entry.optional_count("mesh")? {
            instances.push(Instance { mesh, to_scene });
            skins += usize::from(entry.get("skin").is_some());
        }
        push(&mut stack, &entry, "children", to_scene)?;
    }
    if skins > 0 {
        notes.push(format!("the skins of {skins} meshes are ignored"));
    }
    Ok(instances)
}

/// The transformation of a node into the space of its parent, if it has one.
fn placement(node: &Entry<'_>) -> Result<Option<DAffine3>, Fault> {
    if let Some(matrix) = node.numbers::<16>("matrix")? {
        let matrix = DMat4::from_cols_array(&matrix);
        if matrix.row(3) != DVec4::W {
            return Err(
                node.fault("a matrix whose last row is 0, 0, 0, 1", matrix.row(3).to_string())
            );
        }
        return Ok(Some(DAffine3::from_mat4(matrix)));
    }
    let translation = node.numbers("translation")?;
    let rotation = node.numbers::<4>("rotation")?;
    let scale = node.numbers("scale")?;
    if translation.is_none() && rotation.is_none() && scale.is_none() {
        return Ok(None);
    }
    let linear = match rotation {
        Some(rotation) => {
            let length = DVec4::from(rotation).length();
            if !(length.is_finite() && length > 0.0) {
                return Err(node.fault("a rotation as a unit quaternion", format!("{rotation:?}")));
            }
            DMat3::from_quat(DQuat::from_vec4(DVec4::from(rotation) / length))
        }
        None => DMat3::IDENTITY,
    };
    let scale = scale.map_or(DMat3::IDENTITY, |scale| DMat3::from_diagonal(DVec3::from(scale)));
    let translation = translation.map_or(DVec3::ZERO, DVec3::from);
    Ok(Some(DAffine3 { matrix3: linear * scale, translation }))
}
