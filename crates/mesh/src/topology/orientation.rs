//! Whether faces are oriented consistently.

use super::edges::EdgeTables;

/// Which faces agree in orientation across the edges with exactly two faces.
/// Edges with more faces impose nothing.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Orientation {
    inconsistent_edges: Vec<u32>,
    orientable: bool,
    flipped: Vec<bool>,
}

impl Orientation {
    /// Spreads a turning sense over edges with two faces, component by
    /// component; linear.
    pub(super) fn new(faces: &[[u32; 3]], tables: &EdgeTables) -> Self {
        let inconsistent: Vec<bool> = (0..tables.edges.len())
            .map(|e| match *tables.faces_of(e) {
                [f, g] => {
                    let ends = tables.edges[e];
                    turns_along(faces[f as usize], ends) == turns_along(faces[g as usize], ends)
                }
                _ => false,
            })
            .collect();
        let inconsistent_edges: Vec<u32> =
            (0..tables.edges.len() as u32).filter(|&e| inconsistent[e as usize]).collect();
        let mut flipped = vec![false; faces.len()];
        let mut orientable = true;
        if !inconsistent_edges.is_empty() {
            let mut seen = vec![false; faces.len()];
            let mut stack = vec![];
            for start in 0..faces.len() {
                if seen[start] {
                    continue;
                }
                seen[start] = true;
                stack.push(start);
                while let Some(f) = stack.pop() {
                    for e in tables.face_edges[f].map(|e| e as usize) {
                        let [a, b] = *tables.faces_of(e) else { continue };
                        let other = if a as usize == f { b as usize } else { a as usize };
                        let wanted = flipped[f] != inconsistent[e];
                        if !seen[other] {
                            seen[other] = true;
                            flipped[other] = wanted;
                            stack.push(other);
                        } else if flipped[other] != wanted {
                            orientable = false;
                        }
                    }
                }
            }
        }
        Self { inconsistent_edges, orientable, flipped }
    }

    /// The edges whose two faces both run along them in the same direction,
    /// ascending.
    pub fn inconsistent_edges(&self) -> &[u32] {
        &self.inconsistent_edges
    }

    /// Whether all faces are oriented consistently as they are.
    pub fn is_consistent(&self) -> bool {
        self.inconsistent_edges.is_empty()
    }

    /// Whether flipping some faces orients all of them consistently.
    pub fn is_orientable(&self) -> bool {
        self.orientable
    }

    /// The faces to flip so that all turn as the lowest face of their
    /// edge-connected part; `None` where the mesh is not orientable.
    pub fn flips(&self) -> Option<&[bool]> {
        self.orientable.then_some(&self.flipped[..])
    }
}

/// Whether the face runs from the first end to the second.
fn turns_along(face: [u32; 3], [a, b]: [u32; 2]) -> bool {
    (0..3).any(|k| face[k] == a && face[(k + 1) % 3] == b)
}
