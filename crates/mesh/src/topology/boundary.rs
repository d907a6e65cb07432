//! Boundary loops.

use super::Topology;

/// A boundary edge, in the direction that has its face on the left, as the
/// nodes at its ends.
type Side = [u32; 2];

/// A sheet of faces at a boundary vertex.
struct Node {
    vertex: u32,
    /// The boundary edges of the sheet, ascending.
    sides: Vec<u32>,
}

impl Topology {
    /// Searches nodes depth first, the first side first: if every node has two
    /// sides, this is the walk around the loop.
    pub(super) fn find_boundary_loops(&self) -> Vec<Vec<u32>> {
        let (sides, nodes) = self.boundary_graph();
        let mut seen = vec![false; nodes.len()];
        let mut loops = vec![];
        let mut stack = vec![];
        for side in &sides {
            if seen[side[0] as usize] {
                continue;
            }
            let mut vertices = vec![];
            stack.push(side[0]);
            while let Some(n) = stack.pop() {
                if std::mem::replace(&mut seen[n as usize], true) {
                    continue;
                }
                let node = &nodes[n as usize];
                vertices.push(node.vertex);
                stack.extend(node.sides.iter().rev().map(|&s| {
                    let [a, b] = sides[s as usize];
                    if a == n { b } else { a }
                }));
            }
            loops.push(vertices);
        }
        loops
    }

    fn boundary_graph(&self) -> (Vec<Side>, Vec<Node>) {
        let mut sides: Vec<Side> = vec![];
        // Vertex, other end, side, place in the side.
        let mut ends: Vec<(u32, u32, u32, usize)> = vec![];
        for e in self.boundary_edges() {
            let [a, b] = self.edges()[e as usize];
            let face = self.faces[self.edge_faces(e)[0] as usize];
            let forward = (0..3).any(|k| face[k] == a && face[(k + 1) % 3] == b);
            let [from, to] = if forward { [a, b] } else { [b, a] };
            let s = sides.len() as u32;
            ends.push((from, to, s, 0));
            ends.push((to, from, s, 1));
            sides.push([0; 2]);
        }
        ends.sort_unstable();
        let mut nodes: Vec<Node> = vec![];
        let (mut labels, mut node_of) = (vec![], vec![]);
        for group in ends.chunk_by(|x, y| x.0 == y.0) {
            let vertex = group[0].0;
            self.label_sheets(vertex, &mut labels);
            // The node of each label, which is the place of a neighbour.
            node_of.clear();
            node_of.resize(labels.len(), None);
            for &(_, other, s, place) in group {
                let label = labels[self.neighbors(vertex).partition_point(|&x| x < other)];
                let node = *node_of[label as usize].get_or_insert_with(|| {
                    nodes.push(Node { vertex, sides: vec![] });
                    nodes.len() as u32 - 1
                });
                nodes[node as usize].sides.push(s);
                sides[s as usize][place] = node;
            }
        }
        for node in &mut nodes {
            node.sides.sort_unstable();
        }
        (sides, nodes)
    }
}
