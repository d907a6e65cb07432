//! Texture coordinates and normals, which corners of faces name by their own indices.

use crate::io::obj::chunk::Chunk;
use crate::io::obj::indices::{Indices, NONE};
use crate::io::parsed::Parsed;

/// The indices of all corners of the file, empty if none names one.
fn joined(chunks: &[Chunk], of: fn(&Chunk) -> &Indices) -> Vec<u32> {
    let mut all = Vec::new();
    if chunks.iter().all(|chunk| of(chunk).values.is_empty()) {
        return all;
    }
    for chunk in chunks {
        let end = all.len() + chunk.polygons.corner_count();
        all.extend_from_slice(&of(chunk).values);
        all.resize(end, NONE);
    }
    all
}

/// Keeps texture coordinates if every corner has some.
pub(super) fn keep_texture(parsed: &mut Parsed, chunks: &[Chunk]) {
    let values = chunks.iter().map(|chunk| &chunk.texture[..]).collect::<Vec<_>>().concat();
    let indices = joined(chunks, |chunk| &chunk.texture_of);
    if values.is_empty() && indices.is_empty() {
        return;
    }
    let named = indices.iter().filter(|&&index| index != NONE).count();
    if named == 0 {
        parsed.notes.push(format!("{} texture coordinates are ignored", values.len()));
    } else if named < indices.len() {
        let corners = indices.len();
        let note = format!("only {named} of {corners} corners have texture coordinates: left out");
        parsed.notes.push(note);
    } else {
        let texture = indices.iter().map(|&index| values.get(index as usize).copied());
        match texture.collect() {
            Some(texture) => parsed.fields.faces.texture = Some(texture),
            None => parsed.doubts.push(out_of_range("texture coordinates", &indices, values.len())),
        }
    }
}

fn out_of_range(what: &str, indices: &[u32], count: usize) -> String {
    let missing = indices.iter().filter(|&&index| index != NONE && index as usize >= count).count();
    format!("{missing} corners name {what} that do not exist: left out")
}

/// Keeps normals if every vertex has one.
pub(super) fn keep_normals(parsed: &mut Parsed, chunks: &[Chunk]) {
    let values = chunks.iter().map(|chunk| &chunk.normals[..]).collect::<Vec<_>>().concat();
    let indices = joined(chunks, |chunk| &chunk.normal_of);
    if values.is_empty() && indices.is_empty() {
        return;
    }
    let corners = (0..parsed.polygons.len()).flat_map(|face| parsed.polygons.face(face));
    let named = || corners.clone().zip(&indices).filter(|&(_, &index)| index != NONE);
    let vertices = parsed.positions.len();
    // In the order of the vertices, used or not.
    if values.len() == vertices && named().all(|(v, index)| v == index) {
        parsed.fields.vectors.push(("normal".to_owned(), values));
        return;
    }
    if indices.is_empty() {
        parsed.notes.push(format!("{} vertex normals are ignored", values.len()));
        return;
    }
    if named().any(|(_, &index)| index as usize >= values.len()) {
        parsed.doubts.push(out_of_range("normals", &indices, values.len()));
        return;
    }
    let mut of = vec![NONE; vertices];
    let mut several = vec![false; vertices];
    for (&v, &index) in named() {
        let v = v as usize;
        match of.get(v) {
            // No vertex has this index.
            None => {}
            Some(&NONE) => of[v] = index,
            Some(&first) => several[v] |= values[first as usize] != values[index as usize],
        }
    }
    let different = several.iter().filter(|&&several| several).count();
    let missing = of.iter().filter(|&&index| index == NONE).count();
    if different > 0 {
        let note = format!("vertex normals are ignored: {different} vertices have several");
        parsed.notes.push(note);
    } else if missing > 0 {
        let with = vertices - missing;
        parsed.notes.push(format!("only {with} vertices have normals: left out"));
    } else {
        let normals = of.iter().map(|&index| values[index as usize]).collect();
        parsed.fields.vectors.push(("normal".to_owned(), normals));
    }
}
