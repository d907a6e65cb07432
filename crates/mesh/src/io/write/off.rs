//! OFF text.

use crate::io::write::number::{float, integer, triple};
use crate::io::write::surface::{Surface, face_lines, lines};

/// `OFF`, with the prefix C for colours (red, green, blue and alpha from 0 to
/// 255) and N for normals. The number of edges is written as 0: nobody reads
/// it.
pub(super) fn encode(surface: Surface<'_>) -> Vec<Vec<u8>> {
    let colors = surface.fields.colors.as_deref();
    let normals = surface.fields.vector("normal");
    let color = if colors.is_some() { "C" } else { "" };
    let normal = if normals.is_some() { "N" } else { "" };
    let (vertices, faces) = (surface.positions.len(), surface.faces.len());
    let mut pieces = vec![format!("{color}{normal}OFF\n{vertices} {faces} 0\n").into_bytes()];
    pieces.extend(lines(vertices, 64, |v, text| {
        let [x, y, z] = surface.positions[v];
        float(text, x);
        text.push(b' ');
        float(text, y);
        text.push(b' ');
        float(text, z);
        if let Some(normals) = normals {
            triple(text, normals[v]);
        }
        if let Some(colors) = colors {
            for c in colors[v].into_iter().chain([255]) {
                text.push(b' ');
                integer(text, u64::from(c));
            }
        }
        text.push(b'\n');
    }));
    pieces.extend(face_lines(surface.faces));
    pieces
}
