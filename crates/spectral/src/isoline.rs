//! Isolines of fields at vertices.

use std::cmp::Ordering;
use std::collections::{HashMap, HashSet};

use fairing_mesh::TriMesh;
use glam::DVec3;

use crate::error::SpectralError;

/// A connected piece of an isoline: a polyline without branches.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Isoline {
    /// The points, in mesh units. No two neighbours coincide; the first point of a closed piece is
    /// not repeated.
    pub points: Vec<[f64; 3]>,
    /// The edge that each point lies on, with the smaller vertex first; a vertex, twice, where the
    /// line passes through one.
    pub edges: Vec<[u32; 2]>,
    /// `true` if the last point is connected to the first.
    pub closed: bool,
}

impl Isoline {
    /// The segments, from first to last point; of a closed piece, back to the first.
    pub fn segments(&self) -> impl Iterator<Item = [[f64; 3]; 2]> + '_ {
        let count = self.points.len() - usize::from(!self.closed);
        (0..count).map(|i| [self.points[i], self.points[(i + 1) % self.points.len()]])
    }

    /// The length, in mesh units.
    pub fn length(&self) -> f64 {
        self.segments().map(|[p, q]| DVec3::from(p).distance(q.into())).sum()
    }
}

/// The isoline of a field that is linear on each face, as polylines.
///
/// A piece passes through the faces with values on both sides of the level, and along the edges
/// whose ends both have it. Of a region of faces whose corners all have the level, only the outline
/// belongs to the isoline. A lone vertex at the level, as in a minimum, is no piece. Each segment
/// occurs once, and none has length zero. Pieces end at boundaries, at faces with a corner without
/// a finite value, and where more than two segments meet; those with ends come first.
///
/// # Errors
///
/// [`SpectralError::Rows`] for a field of another mesh.
///
/// # Examples
///
/// ```
/// use fairing_shapes as shapes;
/// use fairing_spectral::isolines;
///
/// let sphere = shapes::icosphere(4);
/// let height: Vec<_> = sphere.positions().iter().map(|p| Some(p[2])).collect();
/// let circle = &isolines(&sphere, &height, 0.6)?[0];
/// assert!(circle.closed);
/// assert!((circle.length() / (0.8 * std::f64::consts::TAU) - 1.0).abs() < 1e-2);
/// # Ok::<(), fairing_spectral::SpectralError>(())
/// ```
pub fn isolines(
    mesh: &TriMesh,
    field: &[Option<f64>],
    level: f64,
) -> Result<Vec<Isoline>, SpectralError> {
    let (found, expected) = (field.len(), mesh.vertex_count());
    if found != expected {
        return Err(SpectralError::Rows { found, expected });
    }
    let mut graph = Graph::default();
    let topology = mesh.topology();
    for face in mesh.faces() {
        let Some(sides) = sides(field, face, level) else { continue };
        let at_level = sides.iter().filter(|side| side.is_eq()).count();
        let pairs = (0..3).map(|k| [k, (k + 1) % 3]);
        if at_level >= 2 {
            for [i, j] in pairs.filter(|&[i, j]| sides[i].is_eq() && sides[j].is_eq()) {
                let is_flat = |&f: &u32| {
                    let sides = self::sides(field, &mesh.faces()[f as usize], level);
                    sides.is_some_and(|sides| sides.iter().all(|side| side.is_eq()))
                };
                let [a, b] = [face[i], face[j]];
                let around =
                    topology.edge_between(a, b).map_or(&[][..], |e| topology.edge_faces(e));
                if around.len() < 2 || !around.iter().all(is_flat) {
                    graph.connect([(mesh, a), (mesh, b)].map(Crossing::at_vertex));
                }
            }
            continue;
        }
        let crossings = pairs.filter(|&[i, j]| sides[i] == sides[j].reverse() && sides[i].is_ne());
        let crossings =
            crossings.map(|[i, j]| Crossing::of_edge(mesh, field, face[i], face[j], level));
        let vertex =
            (0..3).filter(|&i| sides[i].is_eq()).map(|i| Crossing::at_vertex((mesh, face[i])));
        let mut ends = crossings.chain(vertex);
        if let (Some(a), Some(b)) = (ends.next(), ends.next()) {
            graph.connect([a, b]);
        }
    }
    Ok(graph.polylines())
}

/// The sides of the level on which the corners of a face lie; `None` if one has no value.
fn sides(field: &[Option<f64>], face: &[u32; 3], level: f64) -> Option<[Ordering; 3]> {
    let side = |v: u32| field[v as usize].filter(|value| value.is_finite())?.partial_cmp(&level);
    let [a, b, c] = face.map(side);
    Some([a?, b?, c?])
}

/// A point where an isoline crosses an edge or passes through a vertex.
#[derive(Debug, Clone, Copy)]
struct Crossing {
    point: [f64; 3],
    edge: [u32; 2],
}

impl Crossing {
    fn at_vertex((mesh, v): (&TriMesh, u32)) -> Self {
        Self { point: mesh.positions()[v as usize], edge: [v, v] }
    }

    /// The crossing of an edge whose ends lie on two sides of the level; at an end if rounding puts
    /// it there.
    fn of_edge(mesh: &TriMesh, field: &[Option<f64>], a: u32, b: u32, level: f64) -> Self {
        // From the smaller to the larger vertex, so that both faces compute the same point.
        let edge = [a.min(b), a.max(b)];
        // Quarters, since differences of large values overflow.
        let [x, y] = edge.map(|v| 0.25 * field[v as usize].unwrap_or(level) - 0.25 * level);
        let fraction = if x == y { 0.5 } else { x / (x - y) };
        let [from, to] = edge.map(|v| DVec3::from(mesh.positions()[v as usize]));
        let point = from.lerp(to, fraction).to_array();
        match edge.into_iter().find(|&v| mesh.positions()[v as usize] == point) {
            Some(v) => Self::at_vertex((mesh, v)),
            None => Self { point, edge },
        }
    }
}

/// Crossings as nodes, identified by their positions, and the segments between them.
#[derive(Default)]
struct Graph {
    nodes: Vec<Crossing>,
    numbers: HashMap<[u64; 3], u32>,
    neighbours: Vec<Vec<u32>>,
    segments: Vec<[u32; 2]>,
    known: HashSet<[u32; 2]>,
}

impl Graph {
    fn node(&mut self, crossing: Crossing) -> u32 {
        // Adding 0 makes the two zeros one.
        let bits = crossing.point.map(|x| (x + 0.0).to_bits());
        *self.numbers.entry(bits).or_insert_with(|| {
            self.nodes.push(crossing);
            self.neighbours.push(vec![]);
            self.nodes.len() as u32 - 1
        })
    }

    /// Adds a segment, unless it has no length or is there already.
    fn connect(&mut self, ends: [Crossing; 2]) {
        let [a, b] = ends.map(|end| self.node(end));
        if a != b && self.known.insert([a.min(b), a.max(b)]) {
            self.segments.push([a, b]);
            self.neighbours[a as usize].push(b);
            self.neighbours[b as usize].push(a);
        }
    }

    /// The pieces between nodes at which the line ends or branches, then the closed ones.
    fn polylines(mut self) -> Vec<Isoline> {
        let mut pieces = vec![];
        for only_from_ends in [true, false] {
            for segment in std::mem::take(&mut self.segments) {
                let ends = [segment, [segment[1], segment[0]]];
                let start =
                    ends.into_iter().find(|&[from, _]| self.neighbours[from as usize].len() != 2);
                match start.or((!only_from_ends).then_some(segment)) {
                    Some(start) => pieces.extend(self.trace(start)),
                    None => self.segments.push(segment),
                }
            }
        }
        pieces
    }

    /// The piece that begins with a segment; `None` if it was traced before.
    fn trace(&mut self, [start, mut here]: [u32; 2]) -> Option<Isoline> {
        let mut path = vec![start];
        let mut from = start;
        while self.known.remove(&[from.min(here), from.max(here)]) {
            path.push(here);
            let &[a, b] = &self.neighbours[here as usize][..] else { break };
            (from, here) = (here, if a == from { b } else { a });
        }
        if path.len() < 2 {
            return None;
        }
        let closed = path.len() > 3 && path[path.len() - 1] == start;
        path.truncate(path.len() - usize::from(closed));
        let nodes = path.iter().map(|&node| self.nodes[node as usize]);
        let (points, edges) = nodes.map(|node| (node.point, node.edge)).unzip();
        Some(Isoline { points, edges, closed })
    }
}
