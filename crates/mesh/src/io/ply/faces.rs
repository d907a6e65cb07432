//! The faces of a PLY file: polygons and triangle strips.

use std::sync::atomic::{AtomicBool, Ordering};

use crate::io::error::{Fault, unexpected};
use crate::io::parsed::{Broken, FaceList, NO_VERTEX, Parsed, vertex_index};
use crate::io::ply::header::{Element, Kind, Scalar};
use crate::io::ply::source::{Source, decode_integer};
use crate::io::ply::vertices::list_length;
use crate::polygon::Polygons;

/// The usual names of the property that lists the corners of a face.
pub(super) const INDICES: [&str; 2] = ["vertex_indices", "vertex_index"];

/// The number of vertices, and the treatment of faces with other indices.
#[derive(Clone, Copy)]
pub(super) struct Limits {
    pub(super) vertex_count: usize,
    pub(super) broken: Broken,
}

/// Reads the element `face`; property number `list` lists the corners.
pub(super) fn read(
    source: &mut impl Source,
    element: &Element,
    list: usize,
    limits: Limits,
    parsed: &mut Parsed,
) -> Result<(), Fault> {
    let others = element.properties.iter().enumerate().filter(|&(p, _)| p != list);
    let others: Vec<&str> = others.map(|(_, property)| &property.name[..]).collect();
    if !others.is_empty() {
        parsed.notes.push(format!("face properties are ignored: {}", others.join(", ")));
    }
    if let Some((faces, length)) = triangles_at_once(source, element, list, limits) {
        source.advance(length);
        keep(parsed, Polygons::Triangles(faces));
        return Ok(());
    }
    let room = element.rows().min(source.remaining() / 4);
    let mut faces = FaceList::with_capacity(room, limits.vertex_count, limits.broken);
    for _ in 0..element.rows() {
        for (p, property) in element.properties.iter().enumerate() {
            match property.kind {
                Kind::Scalar(scalar) => source.skip(scalar, 1, &property.name)?,
                Kind::List { count, item } if p == list => {
                    let length = list_length(source, count, &property.name)?;
                    for _ in 0..length {
                        let index = source.integer(item, "the index of a vertex")?;
                        faces.corner(index).map_err(|problem| source.fault(problem))?;
                    }
                    faces.end().map_err(|problem| source.fault(problem))?;
                }
                Kind::List { count, item } => {
                    let length = list_length(source, count, &property.name)?;
                    source.skip(item, length, &property.name)?;
                }
            }
        }
        source.end_row();
    }
    let FaceList { polygons, small, .. } = faces;
    if small > 0 {
        parsed.doubts.push(format!("{small} faces have fewer than three corners: left out"));
    }
    keep(parsed, polygons);
    Ok(())
}

/// Adds faces to those of the other element, if both exist.
fn keep(parsed: &mut Parsed, polygons: Polygons) {
    if parsed.polygons.len() == 0 {
        parsed.polygons = polygons;
    } else {
        parsed.polygons.append(&polygons);
    }
}

/// All faces at once and their size in bytes, if the body is binary, every face is a
/// triangle and every index is in range. `None` leaves the faces to the reader of
/// single values, which also reports errors.
fn triangles_at_once(
    source: &impl Source,
    element: &Element,
    list: usize,
    limits: Limits,
) -> Option<(Vec<[u32; 3]>, usize)> {
    let Kind::List { count, item } = element.properties[list].kind else { return None };
    let mut stride = count.size() + 3 * item.size();
    let mut offset = 0;
    for (p, property) in element.properties.iter().enumerate().filter(|&(p, _)| p != list) {
        let Kind::Scalar(scalar) = property.kind else { return None };
        stride += scalar.size();
        offset += if p < list { scalar.size() } else { 0 };
    }
    let rows = source.peek_rows(stride, element.rows())?;
    let sound = AtomicBool::new(true);
    let limit = u32::try_from(limits.vertex_count).unwrap_or(NO_VERTEX);
    let refused = limits.broken == Broken::Refused;
    let check = |is_triangle: bool, [a, b, c]: [u32; 3]| {
        if !is_triangle || (refused && a.max(b).max(c) >= limit) {
            sound.store(false, Ordering::Relaxed);
        }
        [a, b, c]
    };
    let plain = count.size() == 1 && matches!(item, Scalar::I32 | Scalar::U32) && !rows.big_endian;
    let faces = if plain {
        rows.map(|row| {
            let row = &row[offset..offset + 13];
            let words = row[1..].as_chunks().0;
            check(row[0] == 3, [words[0], words[1], words[2]].map(u32::from_le_bytes))
        })
    } else {
        rows.map(|row| {
            let row = &row[offset..];
            let length = decode_integer(count, rows.big_endian, row);
            let corners = [0, 1, 2].map(|k| {
                let at = count.size() + k * item.size();
                let index = decode_integer(item, rows.big_endian, &row[at..]);
                u32::try_from(index).unwrap_or(NO_VERTEX)
            });
            check(length == 3, corners)
        })
    };
    let length = rows.bytes.len();
    sound.into_inner().then_some((faces, length))
}

/// Reads the element `tristrips`: each list is one strip, or several separated
/// by −1. Triangle k of a strip has its first two corners swapped if k is odd, so
/// that all turn the same way. Triangles that repeat a corner only join strips and
/// are dropped.
pub(super) fn read_strips(
    source: &mut impl Source,
    element: &Element,
    list: usize,
    limits: Limits,
    parsed: &mut Parsed,
) -> Result<(), Fault> {
    let mut faces = Vec::new();
    let (mut joints, mut strips) = (0usize, 0usize);
    for _ in 0..element.rows() {
        for (p, property) in element.properties.iter().enumerate() {
            let Kind::List { count, item } = property.kind else {
                if let Kind::Scalar(scalar) = property.kind {
                    source.skip(scalar, 1, &property.name)?;
                }
                continue;
            };
            let length = list_length(source, count, &property.name)?;
            if p != list {
                source.skip(item, length, &property.name)?;
                continue;
            }
            // The corners since the last restart; the last two are used.
            let mut since = 0usize;
            let [mut a, mut b] = [0u32; 2];
            for _ in 0..length {
                let index = source.integer(item, "the index of a vertex")?;
                if index == -1 {
                    since = 0;
                    continue;
                }
                let c = vertex_index(index, faces.len(), limits.vertex_count, limits.broken)
                    .map_err(|problem| source.fault(problem))?;
                strips += usize::from(since == 0);
                if since >= 2 {
                    if a == b || b == c || c == a {
                        joints += 1;
                    } else {
                        faces.push(if since.is_multiple_of(2) { [a, b, c] } else { [b, a, c] });
                    }
                }
                [a, b] = [b, c];
                since += 1;
            }
        }
        source.end_row();
    }
    parsed.notes.push(format!("{strips} triangle strips, with {joints} joints without area"));
    keep(parsed, Polygons::Triangles(faces));
    Ok(())
}

/// The property that lists the corners.
pub(super) fn index_list(element: &Element, source: &impl Source) -> Result<usize, Fault> {
    let list = element.position_of(&INDICES).filter(
        |&p| matches!(element.properties[p].kind, Kind::List { item, .. } if item.is_integer()),
    );
    list.ok_or_else(|| {
        let found = element.properties.iter().map(|property| &property.name[..]);
        let found = found.collect::<Vec<_>>().join(", ");
        let expected = format!("a list of integers vertex_indices in element {}", element.name);
        source.fault(unexpected(expected, found))
    })
}
