//! The neighbourhood of a vertex, in its tangent frame.

use fairing_mesh::Topology;
use glam::DVec3;

use super::super::neighborhood::HUB;
use super::site::Sites;

/// The most vertices of a neighbourhood. Where a ball holds more, a smaller one is taken.
const MAX_NEIGHBORS: usize = 1200;

/// The reach of candidates: the number of radii that are left out, from the largest on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Extent {
    /// All candidates.
    Wide = 0,
    /// Candidates for meshes without noise.
    Narrow = 2,
    /// Candidates that show the noise, the residual of a jet included.
    Sample = 3,
}

/// A neighbour: lengths in local mean edges.
#[derive(Debug, Clone, Copy)]
pub(super) struct Neighbor {
    pub(super) vertex: u32,
    /// Coordinates along the tangents and the normal.
    pub(super) point: [f64; 3],
    /// The squared distance.
    pub(super) square: f64,
    /// The cosine of the angle between the normals; set by [`fits`](super::regression::fits).
    pub(super) cosine: f64,
}

/// Finds neighbourhoods, one vertex after another.
#[derive(Debug, Default)]
pub(super) struct Gathering {
    /// The search in which each vertex was last reached, counted from one.
    reached_in: Vec<u32>,
    searches: u32,
    /// Vertices next to those of the last ring.
    queue: Vec<u32>,
    /// The centre first.
    pub(super) found: Vec<Neighbor>,
}

impl Gathering {
    /// The vertices that paths of edges reach without leaving the ball of `radii[0]` local mean
    /// edges about `v`; of the next smaller radius where there are too many, and the nearest ones
    /// by edges where even the last has too many. Returns the radius of the ball.
    pub(super) fn gather(
        &mut self,
        sites: &Sites,
        topology: &Topology,
        v: u32,
        radii: &[f64],
    ) -> f64 {
        if self.reached_in.len() != sites.all.len() {
            self.reached_in = vec![0; sites.all.len()];
        }
        for &radius in radii {
            if self.search(sites, topology, v, radius) {
                return radius;
            }
        }
        radii[radii.len() - 1]
    }

    /// Returns false if there are too many vertices.
    ///
    /// Ring by ring, without the branch on whether a vertex was reached before, which is hard to
    /// predict.
    fn search(&mut self, sites: &Sites, topology: &Topology, v: u32, radius: f64) -> bool {
        let Self { reached_in, searches, queue, found } = self;
        *searches += 1;
        let search = *searches;
        found.clear();
        let centre = &sites.all[v as usize];
        let [e, f, n] = [centre.axis, centre.normal.cross(centre.axis), centre.normal];
        let position = sites.positions[v as usize];
        let (unit, limit) = (1.0 / sites.length[v as usize], radius * radius);
        reached_in[v as usize] = search;
        found.push(Neighbor { vertex: v, point: [0.0; 3], square: 0.0, cosine: 1.0 });
        let mut next = 0;
        while next < found.len() {
            let mut count = 0;
            for reached in &found[next..] {
                let neighbors = topology.neighbors(reached.vertex);
                if neighbors.len() > HUB && reached.vertex != v {
                    continue;
                }
                if queue.len() < count + neighbors.len() {
                    queue.resize(2 * (count + neighbors.len()), 0);
                }
                for &w in neighbors {
                    queue[count] = w;
                    count += usize::from(reached_in[w as usize] != search);
                    reached_in[w as usize] = search;
                }
            }
            next = found.len();
            for &w in &queue[..count] {
                let d = (sites.positions[w as usize] - position) * unit;
                let square = d.dot(d);
                if square <= limit {
                    let point = [d.dot(e), d.dot(f), d.dot(n)];
                    found.push(Neighbor { vertex: w, point, square, cosine: 1.0 });
                }
            }
            if found.len() > MAX_NEIGHBORS {
                found.truncate(MAX_NEIGHBORS);
                return false;
            }
        }
        true
    }
}

/// The turn of the tangent frame of `from` after the least rotation that takes its normal to that
/// of `to`: cosine and sine of the angle from the axis of `to`. `None` for opposite normals.
#[inline(always)]
pub(super) fn turn_of_frame(
    [axis, normal]: [DVec3; 2],
    [e, f, n]: [DVec3; 3],
    cosine: f64,
) -> Option<[f64; 2]> {
    if 1.0 + cosine < 1e-6 {
        return None;
    }
    let lean = n.dot(axis) / (1.0 + cosine);
    Some([axis.dot(e) - lean * normal.dot(e), axis.dot(f) - lean * normal.dot(f)])
}
