//! STL, binary or text.

use crate::io::error::WriteProblem;
use crate::io::write::number::triple;
use crate::io::write::surface::{Faces, Surface, lines};
use crate::io::{Encoding, Format};
use crate::vec3::{cross, normalize, sub};

/// What begins a binary file: anything but `solid`.
const HEADER: &[u8] = b"binary STL";

/// Triangles with their unit normals (zero where a face has no area).
pub(super) fn encode(
    surface: Surface<'_>,
    encoding: Encoding,
    notes: &mut Vec<String>,
) -> Result<Vec<Vec<u8>>, WriteProblem> {
    let not_held = |what: String| WriteProblem::UnsupportedMesh { format: Format::Stl, what };
    let Faces::Triangles(faces) = surface.faces else {
        return Err(not_held("polygons: triangulate the mesh first".to_owned()));
    };
    note_losses(surface.positions, faces, encoding, notes);
    let corners = |f: usize| faces[f].map(|v| surface.positions[v as usize]);
    let normal =
        |[a, b, c]: [[f64; 3]; 3]| normalize(cross(sub(b, a), sub(c, a))).unwrap_or_default();
    if encoding == Encoding::Ascii {
        let mut pieces = vec![b"solid\n".to_vec()];
        pieces.extend(lines(faces.len(), 256, |f, text| {
            let corners = corners(f);
            text.extend_from_slice(b"facet normal");
            triple(text, normal(corners));
            text.extend_from_slice(b"\nouter loop\n");
            for corner in corners {
                text.extend_from_slice(b"vertex");
                triple(text, corner);
                text.push(b'\n');
            }
            text.extend_from_slice(b"endloop\nendfacet\n");
        }));
        pieces.push(b"endsolid\n".to_vec());
        return Ok(pieces);
    }
    let large = |p: &[f64; 3]| p.iter().any(|x| (*x as f32).is_infinite());
    if let Some(v) = surface.positions.iter().position(large) {
        let p = surface.positions[v];
        return Err(not_held(format!("vertex {v} at {p:?}, beyond 32 bits")));
    }
    let count =
        u32::try_from(faces.len()).map_err(|_| not_held(format!("{} faces", faces.len())))?;
    let mut header = HEADER.to_vec();
    header.resize(80, b' ');
    header.extend(count.to_le_bytes());
    let mut pieces = vec![header];
    pieces.extend(lines(faces.len(), 50, |f, bytes| {
        let corners = corners(f);
        for vector in [normal(corners), corners[0], corners[1], corners[2]] {
            for x in vector {
                bytes.extend((x as f32).to_le_bytes());
            }
        }
        bytes.extend([0; 2]);
    }));
    Ok(pieces)
}

/// Says what reading the file back will not give.
fn note_losses(
    positions: &[[f64; 3]],
    faces: &[[u32; 3]],
    encoding: Encoding,
    notes: &mut Vec<String>,
) {
    let mut used = vec![false; positions.len()];
    let mut next = 0;
    let mut in_order = true;
    for &v in faces.as_flattened() {
        if !used[v as usize] {
            used[v as usize] = true;
            in_order &= v as usize == next;
            next += 1;
        }
    }
    let isolated = used.iter().filter(|&&used| !used).count();
    if isolated > 0 {
        notes.push(format!("STL does not hold the {isolated} isolated vertices"));
    }
    if !in_order {
        notes.push("STL numbers vertices by first appearance, not as they were".to_owned());
    }
    let rounded = |x: &f64| f64::from(*x as f32) != *x;
    if encoding == Encoding::Binary && positions.as_flattened().iter().any(rounded) {
        notes.push("binary STL rounds coordinates to 32 bits".to_owned());
    }
}
