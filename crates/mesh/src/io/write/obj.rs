//! OBJ text.

use crate::io::write::number::{integer, triple};
use crate::io::write::surface::{Surface, lines};

/// `v x y z` or, with colours, `v x y z r g b` from 0 to 1; `f` with indices
/// from 1.
pub(super) fn encode(surface: Surface<'_>) -> Vec<Vec<u8>> {
    let colors = surface.fields.colors.as_deref();
    let mut pieces = lines(surface.positions.len(), 64, |v, text| {
        text.push(b'v');
        triple(text, surface.positions[v]);
        if let Some(colors) = colors {
            triple(text, colors[v].map(|c| f64::from(c) / 255.0));
        }
        text.push(b'\n');
    });
    pieces.extend(lines(surface.faces.len(), 26, |f, text| {
        text.push(b'f');
        for &v in surface.faces.face(f) {
            text.push(b' ');
            integer(text, u64::from(v) + 1);
        }
        text.push(b'\n');
    }));
    pieces
}
