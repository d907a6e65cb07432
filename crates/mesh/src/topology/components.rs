//! Connected components.

/// The parts of a mesh that are connected by shared vertices. Isolated
/// vertices belong to none.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Components {
    count: usize,
    labels: Vec<u32>,
}

/// The label of an isolated vertex.
const NONE: u32 = u32::MAX;

impl Components {
    /// A disjoint-set forest over the vertices, the lowest vertex at each
    /// root; nearly linear.
    pub(super) fn new(vertex_count: usize, faces: &[[u32; 3]]) -> Self {
        let mut parent: Vec<u32> = (0..vertex_count as u32).collect();
        let mut used = vec![false; vertex_count];
        for &[a, b, c] in faces {
            for v in [a, b, c] {
                used[v as usize] = true;
            }
            let root = join(&mut parent, a, b);
            join(&mut parent, root, c);
        }
        // Roots are lowest, so a root is labelled before its vertices.
        let mut count = 0;
        let mut labels = vec![NONE; vertex_count];
        for v in 0..vertex_count as u32 {
            if used[v as usize] {
                let root = find(&mut parent, v);
                if root == v {
                    labels[v as usize] = count;
                    count += 1;
                } else {
                    labels[v as usize] = labels[root as usize];
                }
            }
        }
        Self { count: count as usize, labels }
    }

    /// The number of components.
    pub fn count(&self) -> usize {
        self.count
    }

    /// The component of vertex `v`, numbered from 0 in the order of their
    /// lowest vertices; `None` for an isolated vertex.
    ///
    /// # Panics
    ///
    /// If there is no vertex `v`.
    pub fn label(&self, v: u32) -> Option<u32> {
        let label = self.labels[v as usize];
        (label != NONE).then_some(label)
    }
}

/// The root of `v` in a forest, with paths halved on the way.
pub(super) fn find(parent: &mut [u32], mut v: u32) -> u32 {
    while parent[v as usize] != v {
        let up = parent[parent[v as usize] as usize];
        parent[v as usize] = up;
        v = up;
    }
    v
}

fn join(parent: &mut [u32], a: u32, b: u32) -> u32 {
    let (a, b) = (find(parent, a), find(parent, b));
    let (low, high) = (a.min(b), a.max(b));
    parent[high as usize] = low;
    low
}
