//! The faces of a primitive.

use crate::io::error::{Fault, unexpected};
use crate::io::glb::accessor::Accessors;
use crate::io::glb::document::{Entry, POINTS, TRIANGLES};
use crate::io::parsed::{Broken, strip_triangles, vertex_index};

/// The content of a primitive.
pub(super) enum Shape {
    /// Triangles; none of points.
    Triangles(Vec<[u32; 3]>),
    /// Lines, which no mesh holds.
    Lines,
}

const STRIP: usize = 5;
const FAN: usize = 6;

/// The triangles of a primitive with that many vertices, the first of them of number `first_face`.
pub(super) fn shape(
    accessors: &mut Accessors<'_>,
    primitive: &Entry<'_>,
    vertices: usize,
    first_face: usize,
    broken: Broken,
) -> Result<Shape, Fault> {
    let mode = primitive.optional_count("mode")?.unwrap_or(TRIANGLES);
    match mode {
        POINTS => return Ok(Shape::Triangles(vec![])),
        1..=3 => return Ok(Shape::Lines),
        TRIANGLES | STRIP | FAN => {}
        _ => return Err(primitive.fault("a mode from 0 to 6", mode.to_string())),
    }
    let indices = match primitive.get("indices") {
        Some(entry) => {
            let accessor = accessors.open(entry.count()?)?;
            let mut indices = accessor.indices(&entry)?;
            for (k, index) in indices.iter_mut().enumerate() {
                // A triangle has three indices, further ones of strips and fans one.
                let face = if mode == TRIANGLES { k / 3 } else { k.saturating_sub(2) };
                *index = vertex_index(i64::from(*index), first_face + face, vertices, broken)
                    .map_err(|problem| accessor.fault(k, problem))?;
            }
            indices
        }
        None => {
            accessors.spend(primitive, vertices, 4)?;
            // Positions of more vertices than that are more than a file has.
            (0..vertices as u32).collect()
        }
    };
    Ok(Shape::Triangles(match mode {
        STRIP => strip_triangles(&indices).collect(),
        FAN => match indices.split_first() {
            Some((&centre, rim)) => rim.windows(2).map(|pair| [centre, pair[0], pair[1]]).collect(),
            None => vec![],
        },
        _ => {
            let (triangles, rest) = indices.as_chunks();
            if !rest.is_empty() {
                let problem =
                    unexpected("three indices for each triangle", indices.len().to_string());
                return Err(Fault::whole(problem));
            }
            triangles.to_vec()
        }
    }))
}
