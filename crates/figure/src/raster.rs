//! From faces to samples.

use fairing_mesh::TriMesh;
use glam::DVec3;
use rayon::prelude::*;

use crate::camera::Camera;
use crate::error::FigureError;
use crate::render_options::RenderOptions;

/// Rows of pixels that are drawn together: few enough for the samples to stay
/// in the processor's cache.
pub(crate) const ROWS: usize = 8;

/// Distances beyond this, in scales of the camera, are refused: their squares
/// and products must not overflow.
const HORIZON: f64 = 1e60;

/// Faces projected into the picture and sorted into bands of rows.
pub(crate) struct Raster {
    /// Width and height in samples.
    width: usize,
    height: usize,
    samples: f64,
    /// The vertices of the mesh, then those made by clipping: horizontal and
    /// vertical position in samples, and one over depth.
    points: Vec<[f64; 3]>,
    triangles: Vec<Triangle>,
    /// The triangles that touch each band, ascending.
    bands: Vec<Vec<u32>>,
}

struct Triangle {
    corners: [u32; 3],
    face: u32,
}

/// The faces that are seen in a band of rows.
pub(crate) struct Band {
    /// In samples.
    pub(crate) first_row: usize,
    width: usize,
    faces: Vec<u32>,
}

impl Band {
    /// Marks a sample in which no face shows.
    pub(crate) const NONE: u32 = u32::MAX;

    /// The faces seen in row `y` of samples, counted from the first.
    pub(crate) fn row(&self, y: usize) -> &[u32] {
        &self.faces[y * self.width..(y + 1) * self.width]
    }
}

impl Raster {
    /// Projects, clips and sorts.
    pub(crate) fn new(
        mesh: &TriMesh,
        camera: &Camera,
        options: &RenderOptions,
    ) -> Result<Self, FigureError> {
        let samples = options.samples as usize;
        let mut raster = Self {
            width: options.width as usize * samples,
            height: options.height as usize * samples,
            samples: samples as f64,
            points: Vec::new(),
            triangles: Vec::with_capacity(mesh.face_count()),
            bands: Vec::new(),
        };
        // Right, up and forward from the eye, in scales of the camera.
        let seen: Vec<DVec3> = mesh
            .positions()
            .par_iter()
            .with_min_len(4096)
            .map(|p| {
                let d = (DVec3::from_array(*p) - camera.eye) / camera.scale;
                DVec3::new(d.dot(camera.right), d.dot(camera.up), d.dot(camera.forward))
            })
            .collect();
        // Written so that NaN, from infinities that cancel, fails as well.
        let within = |p: &DVec3| p.to_array().iter().all(|x| x.abs() < HORIZON);
        if let Some(vertex) = seen.iter().position(|p| !within(p)) {
            return Err(FigureError::TooFar { vertex, position: mesh.positions()[vertex] });
        }
        let near = camera.near / camera.scale;
        raster.points = seen.iter().map(|&p| raster.project(camera, p)).collect();
        for (f, &corners) in mesh.faces().iter().enumerate() {
            let inside = corners.map(|v| seen[v as usize].z >= near);
            match inside.iter().filter(|&&i| i).count() {
                3 => raster.triangles.push(Triangle { corners, face: f as u32 }),
                0 => {}
                _ => raster.clip(camera, f as u32, corners, &seen, near),
            }
        }
        raster.sort();
        Ok(raster)
    }

    fn project(&self, camera: &Camera, p: DVec3) -> [f64; 3] {
        let inverse = 1.0 / p.z;
        let zoom = self.height as f64 / (2.0 * camera.half_height) * inverse;
        [self.width as f64 / 2.0 + p.x * zoom, self.height as f64 / 2.0 - p.y * zoom, inverse]
    }

    /// Cuts a face at the near plane: what stays has three or four corners.
    fn clip(&mut self, camera: &Camera, face: u32, corners: [u32; 3], seen: &[DVec3], near: f64) {
        let mut polygon: Vec<u32> = Vec::with_capacity(4);
        for k in 0..3 {
            let (v, w) = (corners[k], corners[(k + 1) % 3]);
            let (p, q) = (seen[v as usize], seen[w as usize]);
            if p.z >= near {
                polygon.push(v);
            }
            if (p.z >= near) != (q.z >= near) {
                let cut = p.lerp(q, (near - p.z) / (q.z - p.z));
                polygon.push(self.points.len() as u32);
                self.points.push(self.project(camera, DVec3::new(cut.x, cut.y, near)));
            }
        }
        for k in 2..polygon.len() {
            let corners = [polygon[0], polygon[k - 1], polygon[k]];
            self.triangles.push(Triangle { corners, face });
        }
    }

    fn sort(&mut self) {
        let rows = ROWS * self.samples as usize;
        let mut bands = vec![Vec::new(); self.height.div_ceil(rows)];
        for (t, triangle) in self.triangles.iter().enumerate() {
            let y = triangle.corners.map(|v| self.points[v as usize][1]);
            let low = y[0].min(y[1]).min(y[2]);
            let high = y[0].max(y[1]).max(y[2]);
            if high < 0.0 || low >= self.height as f64 {
                continue;
            }
            // Casts saturate: rows above the picture count as row 0.
            let last = (high as usize).min(self.height - 1) / rows;
            for band in &mut bands[low as usize / rows..=last] {
                band.push(t as u32);
            }
        }
        self.bands = bands;
    }

    /// Finds the nearest face in every sample of band `b`. Where two are
    /// equally near, the first in the mesh shows.
    pub(crate) fn band(&self, b: usize) -> Band {
        let rows = ROWS * self.samples as usize;
        let first_row = b * rows;
        let last_row = (first_row + rows).min(self.height);
        let mut nearness = vec![0f32; self.width * (last_row - first_row)];
        let mut faces = vec![Band::NONE; nearness.len()];
        for &t in &self.bands[b] {
            let triangle = &self.triangles[t as usize];
            let [p, q, r] = triangle.corners.map(|v| self.points[v as usize]);
            // Twice the signed area; either sign, both sides are drawn.
            let area = (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
            if area == 0.0 {
                continue;
            }
            let scale = 1.0 / area;
            let all_columns = span([p[0], q[0], r[0]], 0, self.width);
            for y in span([p[1], q[1], r[1]], first_row, last_row) {
                let py = y as f64 + 0.5;
                let row = (y - first_row) * self.width;
                let columns = if all_columns.len() > WIDE {
                    columns([p, q, r], py, self.width)
                } else {
                    all_columns.clone()
                };
                for x in columns {
                    let px = x as f64 + 0.5;
                    // For the two faces of an edge, these differ exactly in
                    // sign, so that no sample falls between them.
                    let w0 = edge(q, r, px, py) * scale;
                    let w1 = edge(r, p, px, py) * scale;
                    let w2 = edge(p, q, px, py) * scale;
                    if w0 < 0.0 || w1 < 0.0 || w2 < 0.0 {
                        continue;
                    }
                    let near = (w0 * p[2] + w1 * q[2] + w2 * r[2]) as f32;
                    if near > nearness[row + x] {
                        nearness[row + x] = near;
                        faces[row + x] = triangle.face;
                    }
                }
            }
        }
        Band { first_row, width: self.width, faces }
    }

    /// The unit direction from the eye through the sample coordinates (x, y).
    pub(crate) fn ray(&self, camera: &Camera, x: f64, y: f64) -> DVec3 {
        let step = 2.0 * camera.half_height / self.height as f64;
        let right = (x - self.width as f64 / 2.0) * step;
        let up = (self.height as f64 / 2.0 - y) * step;
        (camera.forward + camera.right * right + camera.up * up).normalize()
    }

    /// The fraction of a pixel at the sample coordinates (x, y) covered by the lines along the
    /// sides of face `f`, `width` in pixels. Fades from full where the face is 8 pixels high to
    /// nothing at 2.
    pub(crate) fn line_coverage(
        &self,
        mesh: &TriMesh,
        f: usize,
        x: f64,
        y: f64,
        width: f32,
    ) -> f32 {
        let [p, q, r] = mesh.faces()[f].map(|v| self.points[v as usize]);
        if p[2].min(q[2]).min(r[2]) <= 0.0 {
            return 0.0;
        }
        let length = |a: [f64; 3], b: [f64; 3]| libm::hypot(b[0] - a[0], b[1] - a[1]);
        let sides = [(q, r), (r, p), (p, q)];
        let longest = sides.iter().fold(0.0f64, |m, &(a, b)| m.max(length(a, b)));
        let area = edge(p, q, r[0], r[1]).abs();
        let height = area / (longest * self.samples);
        let fade = ((height - 2.0) / 6.0).clamp(0.0, 1.0) as f32;
        if fade == 0.0 {
            return 0.0;
        }
        let distance = sides.iter().fold(f64::INFINITY, |m, &(a, b)| {
            let d = edge(a, b, x, y).abs() / length(a, b);
            if d.is_nan() { m } else { m.min(d) }
        });
        let distance = (distance / self.samples) as f32;
        (0.5 * width + 0.5 - distance).clamp(0.0, width.min(1.0)) * fade
    }
}

/// Twice the signed area of the triangle a, b, (x, y). Exchanging a and b
/// changes the sign and nothing else.
#[inline]
fn edge(a: [f64; 3], b: [f64; 3], x: f64, y: f64) -> f64 {
    (a[0] - x) * (b[1] - y) - (a[1] - y) * (b[0] - x)
}

/// Columns of a triangle above which those of each row are computed; below, testing all of them is
/// faster.
const WIDE: usize = 16;

/// The columns of a row that a triangle may cover, with one more on either side for rounding. For a
/// sliver across the picture they are few, although its box has all columns.
fn columns(corners: [[f64; 3]; 3], y: f64, width: usize) -> std::ops::Range<usize> {
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    for k in 0..3 {
        let (p, q) = (corners[k], corners[(k + 1) % 3]);
        let (below, above) = (p[1].min(q[1]), p[1].max(q[1]));
        if below <= y && y <= above {
            let t = if above > below { (y - p[1]) / (q[1] - p[1]) } else { 0.0 };
            let x = p[0] + t * (q[0] - p[0]);
            // A level side has both of its ends in the row.
            let other = if above > below { x } else { q[0] };
            (low, high) = (low.min(x).min(other), high.max(x).max(other));
        }
    }
    let first = ((low - 1.5).ceil().max(0.0) as usize).min(width);
    let last = ((high + 0.5).floor() + 1.0).max(0.0) as usize;
    first..last.min(width).max(first)
}

/// The samples whose centres can lie between the extremes of three
/// coordinates, limited to `low..high`.
fn span(coordinates: [f64; 3], low: usize, high: usize) -> std::ops::Range<usize> {
    let [a, b, c] = coordinates;
    let first = ((a.min(b).min(c) - 0.5).ceil().max(0.0) as usize).max(low);
    let last = ((a.max(b).max(c) - 0.5).floor() + 1.0).max(0.0) as usize;
    first..last.min(high).max(first)
}
