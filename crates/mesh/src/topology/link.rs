//! The sheets of faces at a vertex.

use rayon::prelude::*;

use super::Topology;
use super::components::find;

impl Topology {
    /// Labels the neighbours of `v` by sheet: `labels[i]` belongs to
    /// `neighbors(v)[i]`, and two neighbours are in one sheet if faces at `v`
    /// connect them. Returns the number of sheets.
    pub(super) fn label_sheets(&self, v: u32, labels: &mut Vec<u32>) -> u32 {
        let neighbors = self.neighbors(v);
        labels.clear();
        labels.extend(0..neighbors.len() as u32);
        let mut sheets = neighbors.len() as u32;
        for &c in self.incidence.corners(v) {
            let face = self.faces[c as usize / 3];
            let k = c as usize % 3;
            // Both ends are neighbours, since they share the face with `v`.
            let place = |w: u32| neighbors.partition_point(|&x| x < w) as u32;
            let a = find(labels, place(face[(k + 1) % 3]));
            let b = find(labels, place(face[(k + 2) % 3]));
            if a != b {
                sheets -= 1;
                labels[a.max(b) as usize] = a.min(b);
            }
        }
        // Roots are lowest, so that the label of a root is final when reached.
        for i in 0..labels.len() {
            labels[i] = labels[labels[i] as usize];
        }
        sheets
    }

    pub(super) fn find_nonmanifold_vertices(&self) -> Vec<u32> {
        (0..self.vertex_count as u32)
            .into_par_iter()
            .with_min_len(1024)
            .map_init(Vec::new, |labels, v| (self.label_sheets(v, labels) > 1).then_some(v))
            .flatten_iter()
            .collect()
    }
}
