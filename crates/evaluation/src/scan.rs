//! Depth images of meshes, as meshes.

use std::ops::Range;

use fairing_mesh::{EXTENTS, TriMesh};
use fairing_parameters::ParameterError;
use fairing_watch::parallel;
use glam::{DVec2, DVec3};
use rayon::prelude::*;

use crate::error::EvaluationError;
use crate::noise::camera_and_centre;

/// The pixels along either side of a depth image.
const PIXELS: Range<u32> = 2..2049;

/// The rows of a depth image that one task renders.
const ROWS: usize = 16;

/// The margin around a face within which a ray still meets it, as a fraction of its sides: rays
/// through a common side miss neither face.
const MARGIN: f64 = 1e-12;

/// The camera of a [`scan`].
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
pub struct ScanOptions {
    /// The position of the camera, in mesh units; `None` is three diagonals of the bounding box
    /// from its centre along +z.
    pub camera: Option<[f64; 3]>,
    /// The point in the middle of the image; `None` is the centre of the bounding box.
    pub look_at: Option<[f64; 3]>,
    /// Columns and rows of pixels, each from 2 to 2048.
    pub size: [u32; 2],
    /// The horizontal field of view, in degrees, from 1 to 150; `None` is the smallest that shows
    /// all vertices.
    pub field_of_view: Option<f64>,
    /// The largest difference of depth along an edge of the result, in widths of a pixel at its
    /// nearer end, from 1 to 1000: triangles with a longer edge bridge the rim of the model or are
    /// seen at a grazing angle, 79° at 5, and are left out.
    pub jump: f64,
}

impl Default for ScanOptions {
    fn default() -> Self {
        Self { camera: None, look_at: None, size: [320, 240], field_of_view: None, jump: 5.0 }
    }
}

/// A depth image of a mesh, as a mesh.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Scan {
    /// The seen part of the model: vertices on its surface, row by row from the upper left, faces
    /// counter-clockwise as seen from the camera.
    pub mesh: TriMesh,
    /// The position of the camera, in mesh units.
    pub camera: [f64; 3],
}

/// Renders the depth image of a mesh from a camera, and joins its pixels to a mesh.
///
/// A ray goes from the camera through the centre of each pixel to the first face, seen from either
/// side. The image is upright: +y is up, or +z for a camera that looks along ±y. Four pixels of a
/// square that all see the model become two triangles, along the diagonal with the smaller
/// difference of depth, and three become one; [`ScanOptions::jump`] leaves out those that bridge a
/// step of depth. Pixels without a triangle are not vertices. The mesh is exact up to rounding and
/// has no noise: it is the ground truth of a sensor's mesh, which [`add_noise`](crate::add_noise())
/// simulates with [`NoiseKind::DepthCamera`](crate::NoiseKind::DepthCamera) at [`Scan::camera`].
///
/// Linear in faces and in the pixels that all faces cover.
///
/// # Errors
///
/// [`EvaluationError::Option`] for options outside their range;
/// [`EvaluationError::NoFaces`] without faces; [`EvaluationError::NoView`] for a camera at the
/// point it looks at, inside of a closed mesh, or that sees nothing;
/// [`EvaluationError::NotInFront`] for a vertex behind a camera without a field of view.
///
/// # Examples
///
/// ```
/// use fairing_evaluation::{NoiseKind, NoiseLevel, ScanOptions, add_noise, scan};
/// let model = fairing_shapes::icosphere(4);
/// let truth = scan(&model, &ScanOptions { size: [80, 60], ..ScanOptions::default() })?;
/// let kind = NoiseKind::DepthCamera { camera: Some(truth.camera), length: 5.0 };
/// let noisy = add_noise(&truth.mesh, kind, NoiseLevel::EdgeLengths(0.67), 1)?;
/// assert_eq!(noisy.faces(), truth.mesh.faces());
/// # Ok::<(), fairing_evaluation::EvaluationError>(())
/// ```
pub fn scan(mesh: &TriMesh, options: &ScanOptions) -> Result<Scan, EvaluationError> {
    for pixels in options.size {
        let fits = PIXELS.contains(&pixels);
        ParameterError::require(fits, "pixels of a side", pixels.into(), "between 2 and 2048")?;
    }
    fairing_parameters::Range::from(1.0..=1000.0).check("jump of depth in pixels", options.jump)?;
    if mesh.face_count() == 0 {
        return Err(EvaluationError::NoFaces { which: "mesh" });
    }
    let camera = Camera::new(mesh, options)?;
    if mesh.topology().is_closed() && camera.is_inside(mesh) {
        return Err(camera.no_view("is inside of the mesh"));
    }
    let depths = camera.depths(mesh);
    let faces = camera.triangles(&depths, options.jump);
    if faces.is_empty() {
        return Err(camera.no_view("sees no part of the mesh as large as its pixels"));
    }
    let mesh = camera.mesh(&depths, faces).map_err(EvaluationError::Positions)?;
    Ok(Scan { mesh, camera: camera.eye.to_array() })
}

struct Camera {
    eye: DVec3,
    right: DVec3,
    up: DVec3,
    forward: DVec3,
    columns: usize,
    rows: usize,
    /// The width of a pixel at a depth of one.
    pixel: f64,
}

impl Camera {
    fn new(mesh: &TriMesh, options: &ScanOptions) -> Result<Self, EvaluationError> {
        let [eye, centre] = camera_and_centre(mesh, options.camera)?;
        let target = options.look_at.map_or(centre, DVec3::from);
        for x in target.to_array() {
            let near = x.abs() <= 10.0 * EXTENTS.end();
            ParameterError::require(near, "coordinate to look at", x, "between -1e31 and 1e31")?;
        }
        let [columns, rows] = options.size.map(|pixels| pixels as usize);
        let mut camera = Self {
            eye,
            right: DVec3::X,
            up: DVec3::Y,
            forward: DVec3::NEG_Z,
            columns,
            rows,
            pixel: 0.0,
        };
        let Some(forward) = (target - eye).try_normalize() else {
            return Err(camera.no_view("is at the point it looks at"));
        };
        let upward = if forward.y.abs() < 0.999 { DVec3::Y } else { DVec3::Z };
        camera.forward = forward;
        camera.right = forward.cross(upward).normalize();
        camera.up = camera.right.cross(forward);
        camera.pixel = match options.field_of_view {
            Some(angle) => {
                fairing_parameters::Range::from(1.0..=150.0)
                    .check("field of view in degrees", angle)?;
                2.0 * libm::tan(angle.to_radians() / 2.0) / columns as f64
            }
            None => camera.fitted(mesh)?,
        };
        Ok(camera)
    }

    /// The smallest pixels with which all vertices are half a pixel inside of the image.
    fn fitted(&self, mesh: &TriMesh) -> Result<f64, EvaluationError> {
        let (columns, rows) = (self.columns as f64 - 1.0, self.rows as f64 - 1.0);
        let mut pixel: f64 = 0.0;
        for (v, &p) in mesh.positions().iter().enumerate() {
            let [x, y, z] = self.local(p).to_array();
            if z <= 0.0 {
                let camera = self.eye.to_array();
                return Err(EvaluationError::NotInFront { vertex: v as u32, camera });
            }
            pixel = pixel.max(2.0 * (x / z).abs() / columns).max(2.0 * (y / z).abs() / rows);
        }
        if pixel.is_finite() && pixel > 0.0 {
            Ok(pixel)
        } else {
            Err(self.no_view("sees the mesh as a point"))
        }
    }

    fn no_view(&self, reason: &'static str) -> EvaluationError {
        EvaluationError::NoView { camera: self.eye.to_array(), reason }
    }

    /// A point by its distances to the right, upward and forward.
    fn local(&self, p: [f64; 3]) -> DVec3 {
        let p = DVec3::from(p) - self.eye;
        DVec3::new(p.dot(self.right), p.dot(self.up), p.dot(self.forward))
    }

    /// The ray through a pixel, of depth one.
    fn ray(&self, column: usize, row: usize) -> DVec3 {
        let x = (column as f64 + 0.5 - 0.5 * self.columns as f64) * self.pixel;
        let y = (0.5 * self.rows as f64 - row as f64 - 0.5) * self.pixel;
        DVec3::new(x, y, 1.0)
    }

    /// Returns true if the surface turns around the camera at least half: its solid angle, as
    /// the sum over faces. Source: [vanoosterom1983].
    ///
    /// [vanoosterom1983]: https://doi.org/10.1109/TBME.1983.325207
    fn is_inside(&self, mesh: &TriMesh) -> bool {
        let oriented = mesh.oriented();
        let angles = (0..oriented.face_count()).map(|f| {
            let [a, b, c] = oriented.triangle(f).map(|p| DVec3::from(p) - self.eye);
            let [la, lb, lc] = [a, b, c].map(DVec3::length);
            let below = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
            2.0 * libm::atan2(a.dot(b.cross(c)), below)
        });
        angles.sum::<f64>().abs() > std::f64::consts::TAU
    }

    /// The depth of each pixel, row by row; infinite where it sees nothing.
    fn depths(&self, mesh: &TriMesh) -> Vec<f64> {
        let local: Vec<DVec3> = parallel::map(mesh.positions().len(), 64, |i| {
            let p = mesh.positions()[i];
            self.local(p)
        });
        let corners = |f: usize| mesh.faces()[f].map(|v| local[v as usize]);
        let windows: Vec<Option<[Range<usize>; 2]>> =
            parallel::map(mesh.face_count(), 64, |f| self.window(corners(f)));
        let mut depths = vec![f64::INFINITY; self.columns * self.rows];
        depths.par_chunks_mut(ROWS * self.columns).enumerate().for_each(|(task, part)| {
            let own = task * ROWS..(task + 1) * ROWS;
            for (f, window) in windows.iter().enumerate() {
                let Some([columns, rows]) = window else { continue };
                for row in rows.start.max(own.start)..rows.end.min(own.end) {
                    for column in columns.clone() {
                        if let Some(depth) = depth_at(self.ray(column, row), corners(f)) {
                            let pixel = &mut part[(row - own.start) * self.columns + column];
                            *pixel = pixel.min(depth);
                        }
                    }
                }
            }
        });
        depths
    }

    /// The columns and rows of pixels that a face may cover; `None` if none.
    fn window(&self, corners: [DVec3; 3]) -> Option<[Range<usize>; 2]> {
        // The part in front of a plane close to the camera.
        let nearest = 1e-9 * corners.iter().fold(0.0, |m: f64, p| m.max(p.z));
        let (mut low, mut high) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
        let mut add = |p: DVec3| {
            let q = DVec2::new(p.x, -p.y) / (p.z * self.pixel);
            (low, high) = (low.min(q), high.max(q));
        };
        for k in 0..3 {
            let (p, q) = (corners[k], corners[(k + 1) % 3]);
            if p.z > nearest {
                add(p);
            }
            if (p.z > nearest) != (q.z > nearest) {
                let middle = p + (q - p) * ((nearest - p.z) / (q.z - p.z));
                add(DVec3::new(middle.x, middle.y, nearest));
            }
        }
        let range = |low: f64, high: f64, pixels: usize| {
            let half = 0.5 * pixels as f64;
            // A cast from floating point saturates.
            let first = (low + half - 1.0).floor().max(0.0) as usize;
            let last = (high + half + 1.0).ceil().max(0.0) as usize;
            first..last.min(pixels)
        };
        let window = [range(low.x, high.x, self.columns), range(low.y, high.y, self.rows)];
        (low.x <= high.x && window.iter().all(|range| !range.is_empty())).then_some(window)
    }

    /// Triangles of pixels, none across a jump of depth.
    fn triangles(&self, depths: &[f64], jump: f64) -> Vec<[u32; 3]> {
        let joined = |a: u32, b: u32| {
            let (a, b) = (depths[a as usize], depths[b as usize]);
            (a - b).abs() <= jump * self.pixel * a.min(b)
        };
        let seen = |p: u32| depths[p as usize].is_finite();
        let mut faces = vec![];
        for row in 0..self.rows - 1 {
            for column in 0..self.columns - 1 {
                let first = (row * self.columns + column) as u32;
                let below = first + self.columns as u32;
                // Counter-clockwise, from the upper left.
                let [a, b, c, d] = [first, below, below + 1, first + 1];
                let along_ac = match [a, b, c, d].map(seen) {
                    [true, true, true, true] => {
                        let step = |p: u32, q: u32| (depths[p as usize] - depths[q as usize]).abs();
                        step(a, c) <= step(b, d)
                    }
                    [_, true, _, true] => false,
                    _ => true,
                };
                let two = if along_ac { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] };
                faces.extend(two.into_iter().filter(|&[p, q, r]| {
                    [p, q, r].into_iter().all(seen) && joined(p, q) && joined(q, r) && joined(r, p)
                }));
            }
        }
        faces
    }

    /// The mesh of triangles of pixels.
    fn mesh(
        &self,
        depths: &[f64],
        mut faces: Vec<[u32; 3]>,
    ) -> Result<TriMesh, fairing_mesh::BuildError> {
        let mut numbers = vec![u32::MAX; depths.len()];
        faces.as_flattened().iter().for_each(|&p| numbers[p as usize] = 0);
        let mut positions = vec![];
        for (p, number) in numbers.iter_mut().enumerate().filter(|(_, number)| **number == 0) {
            *number = positions.len() as u32;
            let ray = depths[p] * self.ray(p % self.columns, p / self.columns);
            let away = ray.x * self.right + ray.y * self.up + ray.z * self.forward;
            positions.push((self.eye + away).to_array());
        }
        faces.as_flattened_mut().iter_mut().for_each(|p| *p = numbers[*p as usize]);
        TriMesh::new(positions, faces)
    }
}

/// The depth at which a ray of depth one meets a face.
fn depth_at(ray: DVec3, [a, b, c]: [DVec3; 3]) -> Option<f64> {
    // Source: [moeller1997].
    let (u, v) = (b - a, c - a);
    let across = ray.cross(v);
    let volume = across.dot(u);
    if volume == 0.0 {
        return None;
    }
    let s = across.dot(-a) / volume;
    let across = (-a).cross(u);
    let t = across.dot(ray) / volume;
    let depth = across.dot(v) / volume;
    let meets = s >= -MARGIN && t >= -MARGIN && s + t <= 1.0 + MARGIN;
    (meets && depth > 0.0 && depth.is_finite()).then_some(depth)
}

#[cfg(test)]
mod tests {
    use fairing_shapes as shapes;

    use super::*;
    use crate::vertex_distance;

    fn small() -> ScanOptions {
        ScanOptions { size: [64, 48], ..ScanOptions::default() }
    }

    /// All pixels of a plane that faces the camera are at its depth, and make a full grid.
    #[test]
    fn a_plane_has_its_depth() {
        let plane = shapes::plane(7, 5, shapes::Diagonals::Regular);
        let camera = Some([0.4, 0.6, 2.5]);
        let look_at = Some([0.4, 0.6, 0.0]);
        let field_of_view = Some(10.0);
        let options = ScanOptions { camera, look_at, field_of_view, ..small() };
        let found = scan(&plane, &options).unwrap();
        assert_eq!(found.camera, [0.4, 0.6, 2.5]);
        assert_eq!(found.mesh.vertex_count(), 64 * 48);
        assert_eq!(found.mesh.face_count(), 2 * 63 * 47);
        for p in found.mesh.positions() {
            assert!(p[2].abs() < 1e-14, "{p:?}");
        }
        let [low, high] = found.mesh.bounding_box().unwrap();
        let width = 2.0 * 2.5 * libm::tan(5f64.to_radians()) * 63.0 / 64.0;
        assert!((high[0] - low[0] - width).abs() < 1e-12);
        // Faces toward the camera.
        assert!((0..found.mesh.face_count()).all(|f| found.mesh.area_vector(f)[2] > 0.0));
    }

    #[test]
    fn vertices_lie_on_the_model() {
        let sphere = shapes::icosphere(4);
        let cameras = [None, Some([3.0, 1.0, -2.0]), Some([0.0, 4.0, 0.0])];
        for camera in cameras {
            let found = scan(&sphere, &ScanOptions { camera, ..small() }).unwrap();
            assert!(vertex_distance(&found.mesh, &sphere).unwrap().max < 1e-13);
            let eye = DVec3::from(found.camera);
            let topology = found.mesh.topology();
            assert!(topology.components().count() == 1 && !topology.is_closed());
            for (f, corners) in found.mesh.faces().iter().enumerate() {
                let corner = DVec3::from(found.mesh.positions()[corners[0] as usize]);
                assert!((eye - corner).dot(found.mesh.area_vector(f).into()) > 0.0);
            }
            // The circle fills most of the height, less what is seen at a grazing angle.
            assert!((1000..48 * 48).contains(&found.mesh.vertex_count()));
        }
    }

    /// A small plate in front of a large one: no triangle joins them, and both have a rim.
    #[test]
    fn no_triangle_bridges_a_step() {
        let plane = shapes::plane(2, 2, shapes::Diagonals::Regular);
        let (n, mut positions) = (plane.vertex_count() as u32, plane.positions().to_vec());
        let near = plane.positions().iter().map(|&[x, y, _]| [0.25 + x / 2.0, 0.25 + y / 2.0, 0.5]);
        positions.extend(near);
        let mut faces = plane.faces().to_vec();
        faces.extend(plane.faces().iter().map(|face| face.map(|v| v + n)));
        let plates = TriMesh::new(positions, faces).unwrap();
        let found = scan(&plates, &small()).unwrap().mesh;
        assert_eq!(found.topology().components().count(), 2);
        for face in found.faces() {
            let [a, b, c] = face.map(|v| found.positions()[v as usize][2]);
            assert!((a - b).abs() < 1e-12 && (b - c).abs() < 1e-12);
        }
        let all = scan(&plates, &ScanOptions { jump: 1000.0, ..small() }).unwrap().mesh;
        assert_eq!(all.topology().components().count(), 1);
    }

    #[test]
    fn views_of_nothing_are_errors() {
        let sphere = shapes::icosphere(2);
        let message = |options: ScanOptions| scan(&sphere, &options).unwrap_err().to_string();
        let at =
            |camera| ScanOptions { camera: Some(camera), field_of_view: Some(40.0), ..small() };
        let found = message(ScanOptions { look_at: Some([1.0, 0.0, 0.0]), ..at([0.3, 0.0, 0.0]) });
        assert_eq!(found, "the camera at [0.3, 0.0, 0.0] is inside of the mesh");
        let found = message(at([0.0; 3]));
        assert_eq!(found, "the camera at [0.0, 0.0, 0.0] is at the point it looks at");
        let found = message(ScanOptions { look_at: Some([0.0, 0.0, 9.0]), ..at([0.0, 0.0, 4.0]) });
        assert!(found.contains("sees no part of the mesh"), "{found}");
        let options = ScanOptions { look_at: Some([9.0, 0.0, 0.0]), ..small() };
        let found = message(ScanOptions { camera: Some([1.0, 1.0, 1.0]), ..options });
        assert!(found.contains("is not in front of the camera at [1.0, 1.0, 1.0]"), "{found}");
        let found = message(ScanOptions { size: [64, 4000], ..small() });
        assert_eq!(found, "pixels of a side is 4000, but must be between 2 and 2048");
        let found = message(ScanOptions { field_of_view: Some(180.0), ..small() });
        assert_eq!(found, "field of view in degrees is 180, but must be between 1 and 150");
        let found = message(ScanOptions { jump: f64::NAN, ..small() });
        assert!(found.starts_with("jump of depth in pixels is NaN"), "{found}");
        let empty = TriMesh::new(vec![[0.0; 3]], vec![]).unwrap();
        assert_eq!(scan(&empty, &small()).unwrap_err().to_string(), "the mesh has no faces");
    }

    /// A tube seen from within: faces beside the camera are cut at its plane.
    #[test]
    fn faces_beside_the_camera_are_cut() {
        let tube = shapes::cylinder(1.0, 2.0, 24, 12, shapes::Ends::Open);
        let options = ScanOptions {
            camera: Some([0.0, 0.0, 1.0]),
            look_at: Some([1.0, 0.0, 1.0]),
            field_of_view: Some(90.0),
            jump: 50.0,
            ..small()
        };
        let found = scan(&tube, &options).unwrap().mesh;
        assert!(vertex_distance(&found, &tube).unwrap().max < 1e-12);
        assert!(found.vertex_count() > 2000);
    }
}
