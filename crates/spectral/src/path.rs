//! Paths down the gradient of a distance.

use fairing_mesh::TriMesh;
use glam::DVec3;

use crate::error::SpectralError;
use crate::surface_point::SurfacePoint;

/// A path down the gradient of a distance.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct GeodesicPath {
    /// The points on edges and at vertices where the path bends, from start to end, in mesh units.
    pub points: Vec<[f64; 3]>,
    /// The vertex where the path ends; `None` for a source on a face.
    pub end: Option<u32>,
}

impl GeodesicPath {
    /// The length, in mesh units.
    pub fn length(&self) -> f64 {
        let steps = self.points.windows(2).map(|p| DVec3::from(p[0]).distance(p[1].into()));
        steps.sum()
    }
}

/// A position on a path.
#[derive(Clone, Copy, PartialEq)]
enum Place {
    Vertex(u32),
    /// The fraction of the way from the first to the second vertex, and the face to enter.
    Edge {
        ends: [u32; 2],
        fraction: f64,
        face: u32,
    },
}

/// Traces the path of steepest descent from a vertex to a source of
/// [`distance`](crate::HeatGeodesics): down the gradient of the distance, which is constant on each
/// face, and along an edge where both faces lead to it. The path is close to the shortest one, not
/// exactly the shortest.
///
/// The distance decreases at every step, so the path ends at a source, or at a spurious local
/// minimum caused by errors of the distance; `end` distinguishes the two. The path is longer than
/// the distance by the error of the distance, which is of first order in the edge length.
///
/// # Errors
///
/// [`SpectralError::Rows`] for distances of another mesh; [`SpectralError::NoSuchVertex`];
/// [`SpectralError::Unreached`] if the start has no distance.
///
/// # Examples
///
/// ```
/// use fairing_shapes::{self as shapes, Diagonals};
/// use fairing_spectral::{HeatGeodesics, SurfacePoint, geodesic_path};
///
/// let plane = shapes::plane(30, 30, Diagonals::Alternating);
/// let distance = HeatGeodesics::new(&plane)?.distance(&[0])?;
/// let farthest = plane.vertex_count() as u32 - 1;
/// let path = geodesic_path(&plane, &distance, &[SurfacePoint::vertex(0)], farthest)?;
/// assert_eq!(path.end, Some(0));
/// let corners = [0, farthest as usize].map(|v| plane.positions()[v]);
/// let straight: f64 = (0..3).map(|k| (corners[0][k] - corners[1][k]).powi(2)).sum();
/// assert!((path.length() / straight.sqrt() - 1.0).abs() < 0.02);
/// # Ok::<(), fairing_spectral::SpectralError>(())
/// ```
pub fn geodesic_path(
    mesh: &TriMesh,
    distance: &[Option<f64>],
    sources: &[SurfacePoint],
    start: u32,
) -> Result<GeodesicPath, SpectralError> {
    let (found, expected) = (distance.len(), mesh.vertex_count());
    if found != expected {
        return Err(SpectralError::Rows { found, expected });
    }
    let at_start = distance.get(start as usize);
    match at_start.ok_or(SpectralError::NoSuchVertex { vertex: start, vertices: expected })? {
        Some(_) => {}
        None => return Err(SpectralError::Unreached { vertex: start }),
    }
    let field = Field { mesh, distance };
    let mut place = Place::Vertex(start);
    let mut points = vec![field.position(place).to_array()];
    // Each face is entered once: values fall along the path.
    for _ in 0..=3 * mesh.face_count() {
        let faces = field.faces_at(place);
        let on_face = |source: &&SurfacePoint| {
            source.corners().count() > 1
                && faces.iter().any(|&f| {
                    let face = mesh.faces()[f as usize];
                    source.corner_distances().all(|(v, _)| face.contains(&v))
                })
        };
        let here = field.position(place);
        let to = |source: &&SurfacePoint| here.distance(source.position(mesh).into());
        let near = sources.iter().filter(on_face);
        if let Some(source) = near.min_by(|a, b| to(a).total_cmp(&to(b))) {
            points.push(source.position(mesh));
            return Ok(GeodesicPath { points, end: None });
        }
        match field.next(place) {
            Some(next) => place = next,
            None => break,
        }
        points.push(field.position(place).to_array());
    }
    let end = match place {
        Place::Vertex(v) => Some(v),
        Place::Edge { .. } => None,
    };
    Ok(GeodesicPath { points, end })
}

struct Field<'a> {
    mesh: &'a TriMesh,
    distance: &'a [Option<f64>],
}

impl Field<'_> {
    fn at(&self, v: u32) -> DVec3 {
        self.mesh.positions()[v as usize].into()
    }

    fn value(&self, v: u32) -> f64 {
        self.distance[v as usize].unwrap_or(f64::INFINITY)
    }

    fn position(&self, place: Place) -> DVec3 {
        match place {
            Place::Vertex(v) => self.at(v),
            Place::Edge { ends: [a, b], fraction, .. } => self.at(a).lerp(self.at(b), fraction),
        }
    }

    fn faces_at(&self, place: Place) -> Vec<u32> {
        match place {
            Place::Vertex(v) => self.mesh.incidence().corners(v).iter().map(|c| c / 3).collect(),
            Place::Edge { face, .. } => vec![face],
        }
    }

    /// The next point down the gradient; `None` at a local minimum.
    fn next(&self, place: Place) -> Option<Place> {
        match place {
            Place::Vertex(v) => self.steepest_at(v),
            Place::Edge { ends, face, .. } => {
                let here = self.position(place);
                let [a, b] = ends;
                let third =
                    self.mesh.faces()[face as usize].into_iter().find(|v| !ends.contains(v))?;
                let down = self.descent(face);
                // The sides that the ray can leave through. Without such a side it leads back over
                // the edge, and the path follows the edge to its lower end.
                let through = [[a, third], [third, b]].into_iter().find_map(|side| {
                    let fraction = self.crossing(face, here, down, side)?;
                    Some(self.on_edge(side, fraction, face))
                });
                let lower = if self.value(a) < self.value(b) { a } else { b };
                Some(through.unwrap_or(Place::Vertex(lower)))
            }
        }
    }

    /// The steepest way down from a vertex: along an edge, or through a face.
    fn steepest_at(&self, v: u32) -> Option<Place> {
        let here = self.at(v);
        let mut best: Option<(f64, Place)> = None;
        let mut offer = |slope: f64, place: Place| {
            if slope > 0.0 && best.is_none_or(|(steepest, _)| slope > steepest) {
                best = Some((slope, place));
            }
        };
        for &w in self.mesh.topology().neighbors(v) {
            let length = here.distance(self.at(w));
            if length > 0.0 {
                offer((self.value(v) - self.value(w)) / length, Place::Vertex(w));
            }
        }
        for &corner in self.mesh.incidence().corners(v) {
            let f = corner / 3;
            let face = self.mesh.faces()[f as usize];
            let k = corner as usize % 3;
            let side = [face[(k + 1) % 3], face[(k + 2) % 3]];
            let down = self.descent(f);
            if let Some(fraction) = self.crossing(f, here, down, side) {
                offer(down.length(), self.on_edge(side, fraction, f));
            }
        }
        best.map(|(_, place)| place)
    }

    /// The point on a side of a face, from which the path continues in the face beyond or at one of
    /// the ends of the side.
    fn on_edge(&self, side: [u32; 2], fraction: f64, from: u32) -> Place {
        const END: f64 = 1e-9;
        let topology = self.mesh.topology();
        let beyond = topology
            .edge_between(side[0], side[1])
            .and_then(|e| topology.edge_faces(e).iter().copied().find(|f| *f != from));
        let lower = if self.value(side[0]) < self.value(side[1]) { side[0] } else { side[1] };
        match (fraction, beyond) {
            (t, _) if t <= END => Place::Vertex(side[0]),
            (t, _) if t >= 1.0 - END => Place::Vertex(side[1]),
            (fraction, Some(face)) => Place::Edge { ends: side, fraction, face },
            // A path at the boundary follows it.
            (_, None) => Place::Vertex(lower),
        }
    }

    /// Minus the gradient on a face.
    fn descent(&self, f: u32) -> DVec3 {
        let face = self.mesh.faces()[f as usize];
        let [a, b, c] = face.map(|v| self.at(v));
        let normal = (b - a).cross(c - a);
        let area = normal.length_squared();
        let values = face.map(|v| self.value(v));
        if area == 0.0 || values.iter().any(|value| value.is_infinite()) {
            return DVec3::ZERO;
        }
        let gradient = normal.cross(c - b) * values[0]
            + normal.cross(a - c) * values[1]
            + normal.cross(b - a) * values[2];
        -gradient / area
    }

    /// The fraction of a side at which a ray in a face leaves through it; `None` if it does not.
    fn crossing(&self, f: u32, from: DVec3, down: DVec3, [a, b]: [u32; 2]) -> Option<f64> {
        let [p, q, r] = self.mesh.triangle(f as usize).map(DVec3::from);
        let normal = (q - p).cross(r - p);
        let across = down.cross(normal);
        let [to_a, to_b] = [a, b].map(|v| across.dot(self.at(v) - from));
        // The ray passes between the ends if they are on its two sides, and goes towards the side.
        let outward = {
            let side = self.at(b) - self.at(a);
            let third = self.mesh.faces()[f as usize].into_iter().find(|v| ![a, b].contains(v))?;
            let out = side.cross(normal);
            if out.dot(self.at(third) - self.at(a)) > 0.0 { -out } else { out }
        };
        let passes = (to_a <= 0.0) != (to_b <= 0.0) || to_a == 0.0 || to_b == 0.0;
        let leaves = down.dot(outward) > 0.0;
        (passes && leaves && to_a != to_b).then(|| (to_a / (to_a - to_b)).clamp(0.0, 1.0))
    }
}
