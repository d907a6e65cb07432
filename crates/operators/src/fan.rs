//! The fan of faces around a vertex, as sorted neighbours.

/// The neighbours of a vertex, ascending, and where in them the two other
/// vertices of each of its corners are.
#[derive(Debug, Default)]
pub(crate) struct Fan {
    /// The neighbours, ascending, each once.
    pub(crate) neighbors: Vec<u32>,
    /// For each corner, the ranks of the next and of the previous vertex of
    /// its face among the neighbours.
    pub(crate) ranks: Vec<[u32; 2]>,
    /// True if each neighbour follows once and precedes once: no border, no
    /// edge of three faces, no change of orientation.
    pub(crate) closed: bool,
}

impl Fan {
    /// Becomes the fan with these sides: the next and the previous vertex of
    /// each corner.
    #[inline]
    pub(crate) fn gather(&mut self, sides: impl ExactSizeIterator<Item = [u32; 2]> + Clone) {
        self.closed = match sides.len() {
            3..=8 => self.gather_closed::<8>(sides.clone()),
            9..=16 => self.gather_closed::<16>(sides.clone()),
            _ => false,
        };
        if !self.closed {
            self.gather_any(sides);
        }
    }

    /// The common case, without sorting: a rank is the number of smaller
    /// neighbours, counted over rows of fixed length. Says whether the fan is
    /// closed.
    #[inline]
    fn gather_closed<const ROOM: usize>(
        &mut self,
        sides: impl ExactSizeIterator<Item = [u32; 2]>,
    ) -> bool {
        let count = sides.len();
        // Stands for "none": no vertex has this number, and every vertex has a smaller one.
        let (mut after, mut before) = ([u32::MAX; ROOM], [u32::MAX; ROOM]);
        for (i, [next, previous]) in sides.enumerate() {
            after[i] = next;
            before[i] = previous;
        }
        let mut ranks = [[0u32; ROOM]; 2];
        for w in after {
            // Inside, so that the compiler counts for many at a time.
            for i in 0..ROOM {
                ranks[0][i] += u32::from(w < after[i]);
                ranks[1][i] += u32::from(w < before[i]);
            }
        }
        let mut sorted = [u32::MAX; ROOM];
        let mut seen = [0u32; 2];
        for i in 0..count {
            sorted[ranks[0][i] as usize % ROOM] = after[i];
            seen[0] |= 1 << ranks[0][i];
            seen[1] |= 1 << ranks[1][i];
        }
        let agree = (0..count).all(|i| sorted[ranks[1][i] as usize % ROOM] == before[i]);
        self.neighbors.clear();
        self.neighbors.extend_from_slice(&sorted[..count]);
        self.ranks.clear();
        self.ranks.extend((0..count).map(|i| [ranks[0][i], ranks[1][i]]));
        agree && seen == [(1 << count) - 1; 2]
    }

    fn gather_any(&mut self, sides: impl Iterator<Item = [u32; 2]> + Clone) {
        self.neighbors.clear();
        self.neighbors.extend(sides.clone().flatten());
        self.neighbors.sort_unstable();
        self.neighbors.dedup();
        let neighbors = &self.neighbors;
        let rank = |w: u32| neighbors.partition_point(|&x| x < w) as u32;
        self.ranks.clear();
        self.ranks.extend(sides.map(|side| side.map(rank)));
    }

    /// Returns true if an edge at the vertex has only one face.
    pub(crate) fn has_boundary_edge(&self) -> bool {
        if self.closed {
            return false;
        }
        let mut faces = vec![0u32; self.neighbors.len()];
        for &rank in self.ranks.as_flattened() {
            faces[rank as usize] += 1;
        }
        faces.contains(&1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fairing_mesh::TriMesh;

    fn fan(faces: &[[u32; 3]]) -> Fan {
        let mesh = TriMesh::new(vec![[0.0; 3]; 64], faces.to_vec()).unwrap();
        let mut fan = Fan::default();
        fan.gather(mesh.incidence().sides(20).iter().copied());
        fan
    }

    #[test]
    fn a_closed_fan_is_seen_without_sorting() {
        let fan = fan(&[[20, 9, 40], [40, 33, 20], [33, 9, 20]]);
        assert!(fan.closed && !fan.has_boundary_edge());
        assert_eq!(fan.neighbors, [9, 33, 40]);
        assert_eq!(fan.ranks, [[0, 2], [2, 1], [1, 0]]);
    }

    #[test]
    fn an_open_fan_and_one_that_turns_back_are_not_closed() {
        let open = fan(&[[20, 9, 40], [40, 33, 20], [33, 1, 20]]);
        assert!(!open.closed && open.has_boundary_edge());
        assert_eq!(open.neighbors, [1, 9, 33, 40]);
        assert_eq!(open.ranks, [[1, 3], [3, 2], [2, 0]]);
        let turned = fan(&[[20, 9, 40], [40, 33, 20], [9, 33, 20]]);
        assert!(!turned.closed && !turned.has_boundary_edge());
    }

    #[test]
    fn long_fans_agree_with_short_ones() {
        for n in [3u32, 8, 9, 16, 17, 40] {
            let at = |i: u32| if i % n < 20 { i % n } else { i % n + 1 };
            let faces: Vec<[u32; 3]> = (0..n).map(|i| [at(i), at(i + 1), 20]).collect();
            let fan = fan(&faces);
            assert!(!fan.has_boundary_edge());
            assert_eq!(fan.neighbors, (0..n).map(at).collect::<Vec<_>>());
            for (i, ranks) in fan.ranks.iter().enumerate() {
                assert_eq!(*ranks, [i as u32, (i as u32 + 1) % n]);
            }
        }
    }
}
