//! The faces of a PLY file: polygons and triangle strips.

use std::sync::atomic::{AtomicBool, Ordering};

use crate::io::columns::{INDICES, Layout, TEXTURE};
use crate::io::error::{Fault, unexpected};
use crate::io::parsed::{Broken, FaceList, NO_VERTEX, Parsed, vertex_index};
use crate::io::ply::header::{Element, Kind};
use crate::io::ply::scalars::Scalars;
use crate::io::ply::source::Source;
use crate::io::ply::vertices::{list_length, value};
use crate::io::{FaceFields, NumberType};
use crate::polygon::Polygons;

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
    let scalars = Scalars::new(element, Layout::of_faces);
    let at_once = triangles_at_once(source, element, list, &scalars, limits);
    if let Some((faces, fields, length)) = at_once {
        source.advance(length);
        keep(parsed, Polygons::Triangles(faces), fields);
        return Ok(());
    }
    let texture = element.properties.iter().position(|property| {
        let is_floats = matches!(property.kind, Kind::List { item, .. } if !item.is_integer());
        property.name == TEXTURE && is_floats
    });
    let mut ignored: Vec<&str> = (0..element.properties.len())
        .filter(|&p| p != list && Some(p) != texture)
        .filter(|&p| matches!(element.properties[p].kind, Kind::List { .. }))
        .map(|p| &element.properties[p].name[..])
        .collect();
    let mut rows = FaceRows::new(source, element, &scalars, limits);
    for _ in 0..element.rows() {
        rows.read(source, list, texture)?;
        source.end_row();
    }
    let FaceRows { faces: FaceList { polygons, small, .. }, values, coordinates, .. } = rows;
    if small > 0 {
        parsed.doubts.push(format!("{small} faces have fewer than three corners: left out"));
    }
    let mut fields = scalars.of_values(values).of_faces();
    if let Some(p) = texture {
        fields.texture = coordinates;
        if fields.texture.is_none() {
            ignored.push(TEXTURE);
        } else if let Kind::List { item, .. } = element.properties[p].kind {
            fields.types.insert(TEXTURE.to_owned(), item);
        }
    }
    if !ignored.is_empty() {
        parsed.notes.push(format!("face properties are ignored: {}", ignored.join(", ")));
    }
    keep(parsed, polygons, fields);
    Ok(())
}

/// Faces that are read value by value.
struct FaceRows<'a> {
    element: &'a Element,
    scalars: &'a Scalars,
    faces: FaceList,
    values: Vec<Vec<f64>>,
    /// Two texture coordinates per corner, or `None` if a face has another number.
    coordinates: Option<Vec<[f64; 2]>>,
}

impl<'a> FaceRows<'a> {
    fn new(
        source: &impl Source,
        element: &'a Element,
        scalars: &'a Scalars,
        limits: Limits,
    ) -> Self {
        let room = element.rows().min(source.remaining() / 4);
        let faces = FaceList::with_capacity(room, limits.vertex_count, limits.broken);
        let values = scalars.kinds.iter().map(|_| Vec::new()).collect();
        Self { element, scalars, faces, values, coordinates: Some(Vec::new()) }
    }

    /// Reads a row. A face that is left out leaves its values out.
    fn read(
        &mut self,
        source: &mut impl Source,
        list: usize,
        texture: Option<usize>,
    ) -> Result<(), Fault> {
        let kept = self.faces.polygons.len();
        let (mut scalar, mut corners) = (0, 0);
        let mut numbers = None;
        for (p, property) in self.element.properties.iter().enumerate() {
            match property.kind {
                Kind::Scalar(kind) => {
                    let is_color = self.scalars.is_color(scalar);
                    self.values[scalar].push(value(source, kind, is_color, &property.name)?);
                    scalar += 1;
                }
                Kind::List { count, item } if p == list => {
                    corners = list_length(source, count, &property.name)?;
                    for _ in 0..corners {
                        let index = source.integer(item, "the index of a vertex")?;
                        self.faces.corner(index).map_err(|problem| source.fault(problem))?;
                    }
                    self.faces.end().map_err(|problem| source.fault(problem))?;
                }
                Kind::List { count, item } if Some(p) == texture && self.coordinates.is_some() => {
                    let length = list_length(source, count, &property.name)?;
                    let mut found = Vec::new();
                    for _ in 0..length {
                        found.push(source.float(item, &property.name)?);
                    }
                    numbers = Some(found);
                }
                Kind::List { count, item } => {
                    let length = list_length(source, count, &property.name)?;
                    source.skip(item, length, &property.name)?;
                }
            }
        }
        if self.faces.polygons.len() == kept {
            let rows = self.values.first().map_or(0, Vec::len).saturating_sub(1);
            self.values.iter_mut().for_each(|values| values.truncate(rows));
            return Ok(());
        }
        let fits = |numbers: &Vec<f64>| numbers.len() as u64 == corners.saturating_mul(2);
        match (&mut self.coordinates, numbers.filter(fits)) {
            (Some(all), Some(numbers)) => all.extend_from_slice(numbers.as_chunks().0),
            (coordinates, _) => *coordinates = None,
        }
        Ok(())
    }
}

/// Adds faces to those of the other element, if both exist; fields hold for all or none.
fn keep(parsed: &mut Parsed, polygons: Polygons, fields: FaceFields) {
    let (before, added) = (parsed.polygons.len(), polygons.len());
    if before == 0 {
        parsed.polygons = polygons;
    } else {
        parsed.polygons.append(&polygons);
    }
    let known = !parsed.fields.faces.is_empty();
    if before > 0 && added > 0 && (known || !fields.is_empty()) {
        parsed.notes.push("face properties are ignored, since strips have none".to_owned());
        parsed.fields.faces = FaceFields::default();
    } else if added > 0 || !known {
        parsed.fields.faces = fields;
    }
}

/// All faces at once, their other properties, and their size in bytes, if the body is binary,
/// every face is a triangle and every index is in range. `None` leaves the faces to the reader
/// of single values, which also reports errors.
fn triangles_at_once(
    source: &impl Source,
    element: &Element,
    list: usize,
    scalars: &Scalars,
    limits: Limits,
) -> Option<(Vec<[u32; 3]>, FaceFields, usize)> {
    let Kind::List { count, item } = element.properties[list].kind else { return None };
    let list_size = count.size() + 3 * item.size();
    let (mut stride, mut offset, mut offsets) = (0, 0, Vec::new());
    for (p, property) in element.properties.iter().enumerate() {
        match property.kind {
            Kind::Scalar(kind) => {
                offsets.push(stride);
                stride += kind.size();
            }
            Kind::List { .. } if p == list => {
                offset = stride;
                stride += list_size;
            }
            Kind::List { .. } => return None,
        }
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
    let plain =
        count.size() == 1 && matches!(item, NumberType::I32 | NumberType::U32) && !rows.big_endian;
    let faces = if plain {
        rows.map(|row| {
            let row = &row[offset..offset + 13];
            let words = row[1..].as_chunks().0;
            check(row[0] == 3, [words[0], words[1], words[2]].map(u32::from_le_bytes))
        })
    } else {
        rows.map(|row| {
            let row = &row[offset..];
            let length = count.decode_integer(rows.big_endian, row);
            let corners = [0, 1, 2].map(|k| {
                let at = count.size() + k * item.size();
                let index = item.decode_integer(rows.big_endian, &row[at..]);
                u32::try_from(index).unwrap_or(NO_VERTEX)
            });
            check(length == 3, corners)
        })
    };
    let length = rows.bytes.len();
    let fields = || scalars.of_rows(&rows, &offsets).of_faces();
    sound.into_inner().then(|| (faces, fields(), length))
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
    let joined = if joints > 0 {
        format!(", {joints} of their triangles without area")
    } else {
        String::new()
    };
    parsed.notes.push(format!("the faces are {strips} triangle strips{joined}"));
    keep(parsed, Polygons::Triangles(faces), FaceFields::default());
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
