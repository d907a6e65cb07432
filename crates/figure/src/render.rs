//! A mesh as a picture.

use fairing_mesh::TriMesh;
use glam::{DVec3, Vec3};
use rayon::prelude::*;

use crate::camera::Camera;
use crate::color::{linear_from_srgb, srgb_from_linear};
use crate::error::FigureError;
use crate::image::Image;
use crate::normals::{area_vectors, corner_normals};
use crate::occlusion::Lamps;
use crate::occlusion::Occlusion;
use crate::raster::{Band, ROWS, Raster};
use crate::render_options::{Background, MAX_SIDE, RenderOptions, Wireframe};

/// The colours of a surface before lighting.
#[derive(Debug, Clone, Copy)]
pub enum Colors<'a> {
    /// One colour everywhere.
    Uniform([u8; 3]),
    /// One sRGB colour per vertex, interpolated in linear light.
    PerVertex(&'a [[u8; 3]]),
    /// One sRGB colour per face.
    PerFace(&'a [[u8; 3]]),
}

impl Colors<'_> {
    /// A light warm grey that shows shape well.
    pub const CLAY: Colors<'static> = Colors::Uniform([214, 208, 198]);
}

/// Enough to tell the sides apart, little enough to read a field's colours.
const BACK_TINT: f32 = 1.0 / 3.0;

/// Draws a mesh.
///
/// Perspective, z-buffered, two-sided, shaded in linear light and averaged
/// over `samples²` samples per pixel. Faces are shaded once per pixel in which
/// they show. Faces count as [oriented](TriMesh::oriented); those in front of
/// the near plane are cut off there. The picture does not depend on the number
/// of threads. Cost: linear in faces and in
/// samples; 700 thousand faces at 1600 × 1200 with 4 × 4 samples take about a
/// second on two cores.
///
/// # Errors
///
/// [`FigureError::NoFaces`] without faces, [`FigureError::Count`] if colours or
/// occlusion do not match the mesh, [`FigureError::Size`] for an impossible
/// size, [`FigureError::TooFar`] for a vertex beyond what the camera can
/// place.
pub fn render(
    mesh: &TriMesh,
    colors: Colors<'_>,
    occlusion: Option<&Occlusion>,
    camera: &Camera,
    options: &RenderOptions,
) -> Result<Image, FigureError> {
    check(mesh, colors, occlusion, options)?;
    let mesh = &*mesh.oriented();
    let raster = Raster::new(mesh, camera, options)?;
    let area_vectors = area_vectors(mesh, camera.scale);
    let painter = Painter {
        mesh,
        camera,
        options,
        raster: &raster,
        corner_normals: corner_normals(mesh, &area_vectors, options.shading),
        area_vectors,
        colors: match colors {
            Colors::Uniform(color) => Linear::Uniform(linear(color)),
            Colors::PerVertex(c) => Linear::PerVertex(c.iter().map(|&c| linear(c)).collect()),
            Colors::PerFace(c) => Linear::PerFace(c.iter().map(|&c| linear(c)).collect()),
        },
        occlusion,
        lamps: Lamps::new(camera),
        tint: options.back_tint.map(linear),
        line: options.wireframe.map(|w| (w, linear(w.color))),
    };
    let width = options.width as usize;
    let mut pixels = vec![[0u8; 4]; width * options.height as usize];
    let watch = fairing_watch::current();
    watch.stage("drawing", u64::from(options.height).div_ceil(ROWS as u64));
    pixels.par_chunks_mut(width * ROWS).enumerate().for_each(|(b, chunk)| {
        watch.advance(1);
        let band = raster.band(b);
        let mut patches = Vec::new();
        for (i, pixel) in chunk.iter_mut().enumerate() {
            painter.gather(&band, i % width, i / width, &mut patches);
            *pixel = painter.pixel(&patches);
        }
    });
    Ok(Image::new(options.width, options.height, pixels))
}

fn linear(color: [u8; 3]) -> Vec3 {
    Vec3::from_array(linear_from_srgb(color))
}

fn check(
    mesh: &TriMesh,
    colors: Colors<'_>,
    occlusion: Option<&Occlusion>,
    options: &RenderOptions,
) -> Result<(), FigureError> {
    let &RenderOptions { width, height, samples, .. } = options;
    let side = 1..=MAX_SIDE;
    if !side.contains(&width) || !side.contains(&height) || !(1..=8).contains(&samples) {
        return Err(FigureError::Size { width, height, samples });
    }
    let expect = |what, expected, found| {
        if expected == found { Ok(()) } else { Err(FigureError::Count { what, expected, found }) }
    };
    match colors {
        Colors::Uniform(_) => {}
        Colors::PerVertex(c) => expect("colours", mesh.vertex_count(), c.len())?,
        Colors::PerFace(c) => expect("face colours", mesh.face_count(), c.len())?,
    }
    if let Some(occlusion) = occlusion {
        expect("occlusion values", mesh.vertex_count(), occlusion.front().len())?;
    }
    if mesh.face_count() == 0 {
        return Err(FigureError::NoFaces { vertices: mesh.vertex_count() });
    }
    Ok(())
}

/// Colours in linear light.
enum Linear {
    Uniform(Vec3),
    PerVertex(Vec<Vec3>),
    PerFace(Vec<Vec3>),
}

struct Painter<'a> {
    mesh: &'a TriMesh,
    camera: &'a Camera,
    options: &'a RenderOptions,
    raster: &'a Raster,
    corner_normals: Vec<[DVec3; 3]>,
    area_vectors: Vec<DVec3>,
    colors: Linear,
    occlusion: Option<&'a Occlusion>,
    lamps: Lamps,
    tint: Option<Vec3>,
    line: Option<(Wireframe, Vec3)>,
}

/// The samples of one pixel that show one face.
struct Patch {
    face: u32,
    count: u32,
    /// Sums of the sample indices, counted from the top left of the picture.
    x: u32,
    y: u32,
}

impl Painter<'_> {
    /// The faces that show in column `x`, row `y` of a band.
    fn gather(&self, band: &Band, x: usize, y: usize, patches: &mut Vec<Patch>) {
        patches.clear();
        let samples = self.options.samples as usize;
        for y in y * samples..(y + 1) * samples {
            let row = band.row(y);
            let y = (band.first_row + y) as u32;
            for x in x * samples..(x + 1) * samples {
                let face = row[x];
                let x = x as u32;
                if face == Band::NONE {
                    continue;
                }
                match patches.iter_mut().rev().find(|p| p.face == face) {
                    Some(p) => {
                        p.count += 1;
                        p.x += x;
                        p.y += y;
                    }
                    None => patches.push(Patch { face, count: 1, x, y }),
                }
            }
        }
    }

    /// The colour of a pixel: the mean over its samples, in linear light.
    fn pixel(&self, patches: &[Patch]) -> [u8; 4] {
        let share = 1.0 / self.options.samples.pow(2) as f32;
        let (mut light, mut alpha) = (Vec3::ZERO, 0.0);
        for patch in patches {
            let center = |sum: u32| f64::from(sum) / f64::from(patch.count) + 0.5;
            let weight = patch.count as f32 * share;
            let shade = self.shade(patch.face as usize, center(patch.x), center(patch.y));
            light += shade.min(Vec3::ONE) * weight;
            alpha += weight;
        }
        match self.options.background {
            Background::Color(color) => {
                let behind = linear(color) * (1.0 - alpha);
                let [r, g, b] = srgb_from_linear((light + behind).to_array());
                [r, g, b, 255]
            }
            Background::Transparent if patches.is_empty() => [0; 4],
            Background::Transparent => {
                let [r, g, b] = srgb_from_linear((light / alpha).to_array());
                [r, g, b, (alpha * 255.0 + 0.5) as u8]
            }
        }
    }

    /// The light from face `f` at the sample coordinates (x, y), where it
    /// shows.
    fn shade(&self, f: usize, x: f64, y: f64) -> Vec3 {
        let view = self.raster.ray(self.camera, x, y);
        let corners = self.mesh.faces()[f];
        let weights = self.weights(f, view);
        let blend = |values: [DVec3; 3]| {
            values[0] * weights[0] + values[1] * weights[1] + values[2] * weights[2]
        };
        let face_normal = self.area_vectors[f];
        let from_behind = face_normal.dot(view) > 0.0;
        let toward = if from_behind { -1.0 } else { 1.0 };
        let mut normal = (blend(self.corner_normals[f]) * toward).normalize_or_zero();
        // Interpolated normals may turn away at the outline: bend them back
        // until they are seen edge-on.
        let away = normal.dot(view);
        if away > 0.0 {
            normal = (normal - view * away).normalize_or(face_normal.normalize_or_zero() * toward);
        }
        let mut base = match &self.colors {
            Linear::Uniform(c) => *c,
            Linear::PerFace(c) => c[f],
            Linear::PerVertex(c) => {
                let [a, b, d] = corners.map(|v| c[v as usize]);
                a * weights[0] as f32 + b * weights[1] as f32 + d * weights[2] as f32
            }
        };
        if let (true, Some(tint)) = (from_behind, self.tint) {
            base = base.lerp(tint, BACK_TINT);
        }
        let open = self.occlusion.map_or(1.0, |o| {
            let values = if from_behind { o.back() } else { o.front() };
            (0..3).map(|k| values[corners[k] as usize] * weights[k] as f32).sum()
        });
        let light = self.lamps.shade(base, normal, view, open);
        match self.line {
            Some((line, color)) => {
                let coverage = self.raster.line_coverage(self.mesh, f, x, y, line.width);
                light.lerp(color, coverage * line.opacity)
            }
            None => light,
        }
    }

    /// Barycentric coordinates of the point in which the ray from the eye
    /// along `view` meets face `f`: for corners a, b, c seen from the eye, in
    /// proportion to det(view, b, c), det(a, view, c) and det(a, b, view).
    fn weights(&self, f: usize, view: DVec3) -> [f64; 3] {
        let [a, b, c] = self
            .mesh
            .triangle(f)
            .map(|p| (DVec3::from_array(p) - self.camera.eye) / self.camera.scale);
        let w = [view.dot(b.cross(c)), view.dot(c.cross(a)), view.dot(a.cross(b))];
        let sum: f64 = w.iter().sum();
        let w = w.map(|w| (w / sum).clamp(0.0, 1.0));
        let sum: f64 = w.iter().sum();
        // A face seen exactly edge-on leaves no weights to normalise.
        if sum > 0.0 { w.map(|w| w / sum) } else { [1.0 / 3.0; 3] }
    }
}
