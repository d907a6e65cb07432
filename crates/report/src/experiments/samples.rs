//! Surfaces with known curvature, sampled in three ways, for the study of
//! estimators.

use fairing_mesh::TriMesh;
use fairing_operators::surface::{ImplicitSurface, PointCurvature, WavyGraph};
use fairing_shapes as shapes;
use glam::DVec3;
use rand::SeedableRng;
use rand::seq::SliceRandom;
use rand_chacha::ChaCha8Rng;

use super::surfaces::{JITTER, Sampling, TestSurface};

/// A surface of the study.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Sample {
    /// A closed one.
    Closed(TestSurface),
    /// `0.1 sin 2πx cos 2πy` over the unit square: an open one.
    Graph,
}

/// Arrangement of its vertices and edges.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Layout {
    /// As the construction gives them.
    Regular,
    /// Vertices moved at random along the surface.
    Jittered,
    /// Also edges flipped at random where both new faces are sound; the graph
    /// over a Delaunay triangulation of points at random.
    Irregular,
}

const GRAPH: WavyGraph = WavyGraph { amplitude: 0.1, wave_number: std::f64::consts::TAU };

/// Least distance from the border of the graph of an inner vertex: beyond the
/// reach of every neighbourhood on the meshes that orders are read from.
const MARGIN: f64 = 0.15;

/// The least angle of a face that a flip may make, in degrees.
const MIN_ANGLE: f64 = 20.0;

impl Sample {
    pub(super) const ALL: [Self; 4] = [
        Self::Closed(TestSurface::Sphere),
        Self::Closed(TestSurface::Torus),
        Self::Closed(TestSurface::Ellipsoid),
        Self::Graph,
    ];

    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Closed(surface) => surface.name(),
            Self::Graph => "graph",
        }
    }

    /// The mesh of a refinement level, as [`TestSurface::mesh`].
    pub(super) fn mesh(self, level: u32, layout: Layout, seed: u64) -> TriMesh {
        match (self, layout) {
            (Self::Closed(s), Layout::Regular) => s.mesh(level, Sampling::Regular, seed),
            (Self::Closed(s), Layout::Jittered) => s.mesh(level, Sampling::Jittered, seed),
            (Self::Closed(s), Layout::Irregular) => {
                flipped(&s.mesh(level, Sampling::Jittered, seed), seed)
            }
            (Self::Graph, Layout::Regular) => lifted(&grid(level)),
            (Self::Graph, Layout::Jittered) => {
                lifted(&shapes::jittered(&grid(level), JITTER, seed, |p| p))
            }
            (Self::Graph, Layout::Irregular) => {
                lifted(&shapes::irregular_plane(1.0 / f64::from(cells(level)), seed))
            }
        }
    }

    /// The exact curvature at a point of the surface.
    pub(super) fn exact(self, p: [f64; 3]) -> Option<PointCurvature> {
        match self {
            Self::Closed(surface) => surface.exact(p),
            Self::Graph => GRAPH.curvature(p),
        }
    }

    /// Returns true if the surface goes on around a point as far as an estimator reaches.
    pub(super) fn is_inner(self, p: [f64; 3]) -> bool {
        match self {
            Self::Closed(_) => true,
            Self::Graph => p[..2].iter().all(|x| (MARGIN..=1.0 - MARGIN).contains(x)),
        }
    }
}

impl Layout {
    pub(super) const ALL: [Self; 3] = [Self::Regular, Self::Jittered, Self::Irregular];

    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Regular => "regular",
            Self::Jittered => "jittered",
            Self::Irregular => "irregular",
        }
    }
}

fn grid(level: u32) -> TriMesh {
    shapes::plane(cells(level), cells(level), shapes::Diagonals::Alternating)
}

/// Along a side of the graph: as many vertices as the other surfaces have.
fn cells(level: u32) -> u32 {
    3 << level
}

fn lifted(plane: &TriMesh) -> TriMesh {
    let k = GRAPH.wave_number;
    let lift =
        |&[x, y, _]: &[f64; 3]| [x, y, GRAPH.amplitude * libm::sin(k * x) * libm::cos(k * y)];
    match plane.with_positions(plane.positions().iter().map(lift).collect()) {
        Ok(mesh) => mesh,
        Err(error) => unreachable!("heights are finite: {error}"),
    }
}

/// The mesh with edges flipped in random order: where neither face has been
/// touched, the new edge is new, all four vertices keep at least four edges,
/// and no angle falls below the least.
fn flipped(mesh: &TriMesh, seed: u64) -> TriMesh {
    let topology = mesh.topology();
    let mut order: Vec<u32> = (0..topology.edges().len() as u32).collect();
    order.shuffle(&mut ChaCha8Rng::seed_from_u64(seed));
    let mut faces = mesh.faces().to_vec();
    let mut touched = vec![false; faces.len()];
    let mut degrees: Vec<usize> =
        (0..mesh.vertex_count() as u32).map(|v| topology.neighbors(v).len()).collect();
    for e in order {
        let &[f, g] = topology.edge_faces(e) else { continue };
        let [f, g] = [f as usize, g as usize];
        if touched[f] || touched[g] {
            continue;
        }
        let [a, b] = topology.edges()[e as usize];
        let apex = |face: [u32; 3]| face.into_iter().find(|&v| v != a && v != b);
        let (Some(c), Some(d)) = (apex(faces[f]), apex(faces[g])) else { continue };
        let forward = (0..3).any(|k| faces[f][k] == a && faces[f][(k + 1) % 3] == b);
        let (c, d) = if forward { (c, d) } else { (d, c) };
        // The faces are abc and bad; the new ones adc and dbc.
        let new = [[a, d, c], [d, b, c]];
        let few = degrees[a as usize] < 5 || degrees[b as usize] < 5;
        if few || topology.edge_between(c, d).is_some() || !new.iter().all(|&t| sound(mesh, t)) {
            continue;
        }
        (faces[f], faces[g]) = (new[0], new[1]);
        (touched[f], touched[g]) = (true, true);
        for (v, change) in [(a, -1), (b, -1), (c, 1), (d, 1)] {
            degrees[v as usize] = degrees[v as usize].saturating_add_signed(change);
        }
    }
    match TriMesh::new(mesh.positions().to_vec(), faces) {
        Ok(mesh) => mesh,
        Err(error) => unreachable!("a flip keeps faces valid: {error}"),
    }
}

fn sound(mesh: &TriMesh, triangle: [u32; 3]) -> bool {
    let p = triangle.map(|v| DVec3::from(mesh.positions()[v as usize]));
    (0..3).all(|k| {
        let (x, y) = (p[(k + 1) % 3] - p[k], p[(k + 2) % 3] - p[k]);
        libm::atan2(x.cross(y).length(), x.dot(y)).to_degrees() >= MIN_ANGLE
    })
}
