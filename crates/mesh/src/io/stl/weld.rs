//! Vertices from corners at equal positions.

use std::collections::HashMap;
use std::collections::hash_map::Entry;

/// Makes one vertex of all corners at exactly one position, numbered in the
/// order of first appearance. −0 and 0 are one; the first one seen is kept.
#[derive(Default)]
pub(super) struct Welder {
    positions: Vec<[f64; 3]>,
    vertices: HashMap<[u64; 3], u32>,
}

impl Welder {
    pub(super) fn with_capacity(vertices: usize) -> Self {
        Self { positions: Vec::with_capacity(vertices), vertices: HashMap::with_capacity(vertices) }
    }

    /// The vertex at a position; `None` if they outnumber `u32`.
    pub(super) fn vertex(&mut self, position: [f64; 3]) -> Option<u32> {
        // −0 + 0 = 0, and nothing else changes.
        match self.vertices.entry(position.map(|x| (x + 0.0).to_bits())) {
            Entry::Occupied(entry) => Some(*entry.get()),
            Entry::Vacant(entry) => {
                let vertex = u32::try_from(self.positions.len()).ok()?;
                self.positions.push(position);
                Some(*entry.insert(vertex))
            }
        }
    }

    pub(super) fn into_positions(self) -> Vec<[f64; 3]> {
        self.positions
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn zeros_of_both_signs_are_one_and_neighbours_are_two() {
        let mut welder = Welder::default();
        assert_eq!(welder.vertex([0.0, 1.0, 2.0]), Some(0));
        assert_eq!(welder.vertex([0.0, 1.0_f64.next_up(), 2.0]), Some(1));
        assert_eq!(welder.vertex([-0.0, 1.0, 2.0]), Some(0));
        assert_eq!(welder.into_positions().len(), 2);
    }
}
