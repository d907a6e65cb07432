//! Wavefront OBJ: vertices, faces, texture coordinates, normals and the statements about faces;
//! others are counted and reported.
//!
//! Objects, groups, materials and smoothing groups belong to faces, and are written back; the
//! files of materials are named, not read.
//!
//! Texture coordinates belong to the corners of faces, normals to vertices: those of a vertex
//! must be the same at all its corners.
//!
//! A `v` line holds a position, and optionally a weight (`x y z w`, which only
//! curves and surfaces use), a colour (`x y z r g b`, a common extension) or a
//! colour with alpha. Objects and groups share one list of vertices.

mod chunk;
mod corners;
mod indices;
mod scan;
mod statements;

use std::collections::HashMap;

use fairing_watch::parallel;

use crate::io::WriteOptions;
use crate::io::error::{Fault, ReadProblem, WriteProblem};
use crate::io::number::{put_float, put_integer, put_triple};
use crate::io::parsed::{Broken, Parsed, bytes_of_colors, vertex_index};
use crate::io::row::{Holds, Row};
use crate::io::surface::{Encoded, Surface, lines};
use crate::io::text::normalized;
use crate::polygon::Polygons;
use chunk::{Chunk, Counts};
pub use statements::Statements;

pub(super) const FORMAT: Row = Row {
    name: "OBJ",
    extensions: &["obj"],
    looks_like,
    parse,
    encode,
    holds: Holds { texture: true, statements: true, ..Holds::TEXT },
};

/// The size of the pieces that are parsed independently; fixed, so that results
/// do not depend on the number of threads.
const CHUNK: usize = 1 << 18;

/// Returns true if the first word is a keyword of OBJ.
fn looks_like(bytes: &[u8]) -> bool {
    scan::first_keyword(&normalized(&bytes[..bytes.len().min(1 << 16)]))
        .is_some_and(|keyword| scan::is_keyword(&keyword))
}

fn parse(bytes: &[u8], broken: Broken) -> Result<Parsed, Fault> {
    parse_in_chunks(bytes, CHUNK, broken)
}

fn parse_in_chunks(bytes: &[u8], size: usize, broken: Broken) -> Result<Parsed, Fault> {
    let text = normalized(bytes);
    let ranges = scan::split(&text, size);
    let watch = fairing_watch::current();
    watch.stage("reading", ranges.len() as u64);
    let parse = |range| {
        watch.advance(1);
        Chunk::parse(&text, range, broken)
    };
    let mut chunks: Vec<Chunk> = parallel::map_each(ranges, parse);
    if let Some(k) = chunks.iter().position(|chunk| chunk.fault.is_some())
        && let Some((offset, mut problem)) = chunks[k].fault.take()
    {
        // A piece counts its own vertices only.
        if let ReadProblem::NonFinite { vertex, .. } = &mut problem {
            *vertex += chunks[..k].iter().map(|chunk| chunk.positions.len() as u64).sum::<u64>();
        }
        return Err(Fault::on_line(&text, offset, problem));
    }

    let mut counts = Counts::default();
    let [mut vertices, mut texture, mut normals] = [0usize; 3];
    for chunk in &mut chunks {
        chunk.resolve_relative(vertices);
        chunk.texture_of.resolve_relative(texture);
        chunk.normal_of.resolve_relative(normals);
        vertices += chunk.positions.len();
        texture += chunk.texture.len();
        normals += chunk.normals.len();
        counts.add(&chunk.counts);
    }
    let largest = chunks.iter().map(|chunk| chunk.largest).max().unwrap_or(-1);
    let smallest = chunks.iter().map(|chunk| chunk.smallest).min().unwrap_or(0);
    if broken == Broken::Refused && (largest >= vertices as i64 || smallest < 0) {
        return Err(out_of_range(&text, &chunks, vertices));
    }

    let (positions, polygons) = rayon::join(
        || chunks.iter().map(|chunk| &chunk.positions[..]).collect::<Vec<_>>().concat(),
        || {
            let mut all = Polygons::with_capacity(chunks.iter().map(|c| c.polygons.len()).sum());
            chunks.iter().for_each(|chunk| all.append(&chunk.polygons));
            all
        },
    );
    let mut parsed = Parsed { positions, polygons, ..Parsed::default() };
    parsed.notes = counts.notes();
    if counts.small > 0 {
        let doubt = format!("{} faces have fewer than three corners: left out", counts.small);
        parsed.doubts.push(doubt);
    }
    keep_colors(&mut parsed, &chunks, &counts);
    corners::keep_texture(&mut parsed, &chunks);
    corners::keep_normals(&mut parsed, &chunks);
    let pieces = chunks.iter().map(|chunk| (chunk.polygons.len(), &chunk.stated[..]));
    parsed.fields.faces.statements = Statements::of_pieces(pieces);
    Ok(parsed)
}

/// Keeps colours if every vertex has one.
fn keep_colors(parsed: &mut Parsed, chunks: &[Chunk], counts: &Counts) {
    if counts.weighted > 0 {
        let doubt = format!("the weights of {} vertices are not 1, and ignored", counts.weighted);
        parsed.doubts.push(doubt);
    }
    let colored: usize = chunks.iter().map(|chunk| chunk.colors.len()).sum();
    if colored == 0 {
        return;
    }
    if colored < parsed.positions.len() {
        let doubt = format!("only {colored} vertices have colours: left out");
        parsed.doubts.push(doubt);
        return;
    }
    let colors = chunks.iter().map(|chunk| &chunk.colors[..]).collect::<Vec<_>>().concat();
    match bytes_of_colors(&colors, 0.0) {
        Some(colors) => parsed.fields.colors = Some(colors),
        None => parsed.doubts.push("vertex colours are out of range: left out".to_owned()),
    }
    if counts.alphas > 0 {
        parsed.notes.push(format!("the alpha values of {} vertices are ignored", counts.alphas));
    }
}

/// Finds the first face with an index out of range, and its line. A second
/// pass, for malformed files only.
fn out_of_range(text: &[u8], chunks: &[Chunk], vertices: usize) -> Fault {
    let mut before = 0usize;
    for chunk in chunks {
        let mut corner = 0usize;
        for face in 0..chunk.polygons.len() {
            for &v in chunk.polygons.face(face) {
                let index = chunk.index(corner, v);
                if let Err(problem) = vertex_index(index, before + face, vertices, Broken::Refused)
                {
                    let offset = scan::face_statement(text, chunk.range.clone(), face);
                    return Fault::on_line(text, offset, problem);
                }
                corner += 1;
            }
        }
        before += chunk.polygons.len();
    }
    // Unreachable: the caller has found an index out of range in one of the chunks.
    Fault::whole(ReadProblem::IndexOutOfRange { face: 0, index: -1, vertex_count: vertices as u64 })
}

/// `mtllib`; `v x y z` or, with colours, `v x y z r g b` from 0 to 1; `vt` and `vn`; `f` with
/// indices from 1, below the statements that change at the face.
fn encode(surface: Surface<'_>, _: &WriteOptions) -> Result<Encoded, WriteProblem> {
    let Surface { positions, faces, fields } = surface;
    let colors = fields.colors.as_deref();
    let statements = &fields.faces.statements;
    let mut libraries = vec![];
    for library in &statements.libraries {
        statements::write_line(b"mtllib", library, &mut libraries);
    }
    let mut pieces = vec![libraries];
    pieces.extend(lines(positions.len(), 64, |v, text| {
        text.push(b'v');
        put_triple(text, positions[v]);
        if let Some(colors) = colors {
            put_triple(text, colors[v].map(|c| f64::from(c) / 255.0));
        }
        text.push(b'\n');
    }));
    let texture = fields.faces.texture.as_deref().map(distinct);
    let (values, texture_of) = texture.unwrap_or_default();
    pieces.extend(lines(values.len(), 40, |k, text| {
        text.extend_from_slice(b"vt ");
        put_float(text, values[k][0]);
        text.push(b' ');
        put_float(text, values[k][1]);
        text.push(b'\n');
    }));
    let normals = fields.vector("normal");
    pieces.extend(lines(normals.map_or(0, <[_]>::len), 64, |v, text| {
        text.extend_from_slice(b"vn");
        normals.iter().for_each(|normals| put_triple(text, normals[v]));
        text.push(b'\n');
    }));
    let mut starts = vec![0];
    if !texture_of.is_empty() {
        starts = (0..faces.len())
            .scan(0, |end, f| Some(std::mem::replace(end, *end + faces.face(f).len())))
            .collect();
    }
    pieces.extend(lines(faces.len(), 26, |f, text| {
        statements.write_before(f, text);
        text.push(b'f');
        for (k, &v) in faces.face(f).iter().enumerate() {
            text.push(b' ');
            put_integer(text, u64::from(v) + 1);
            if !texture_of.is_empty() {
                text.push(b'/');
                put_integer(text, texture_of[starts[f] + k] as u64 + 1);
            }
            if normals.is_some() {
                text.extend_from_slice(if texture_of.is_empty() { b"//" } else { b"/" });
                put_integer(text, u64::from(v) + 1);
            }
        }
        text.push(b'\n');
    }));
    Ok(Encoded { pieces, notes: vec![] })
}

/// The distinct texture coordinates in order of first appearance, and those of each corner.
fn distinct(texture: &[[f64; 2]]) -> (Vec<[f64; 2]>, Vec<usize>) {
    let mut values = Vec::new();
    let mut known = HashMap::new();
    let of = texture.iter().map(|&value| {
        *known.entry(value.map(f64::to_bits)).or_insert_with(|| {
            values.push(value);
            values.len() - 1
        })
    });
    let of = of.collect();
    (values, of)
}

#[cfg(test)]
mod tests;
