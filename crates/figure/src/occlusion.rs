//! Ambient occlusion, baked at vertices, and lamps.

use fairing_mesh::TriMesh;
use glam::{DVec3, Vec3, Vec3A};
use obvhs::BvhBuildParams;
use obvhs::aabb::Aabb;
use obvhs::cwbvh::CwBvh;
use obvhs::cwbvh::builder::build_cwbvh_from_tris;
use obvhs::ray::Ray;
use obvhs::triangle::Triangle;
use rayon::prelude::*;

use crate::camera::Camera;
use crate::normals::{area_vectors, vertex_normals};

/// Sky visibility of each vertex: 1 in the open, 0 when enclosed.
///
/// For a normal n, the part of the light of an evenly bright sky, cosine and
/// all, that reaches the vertex past the mesh itself:
///
/// ```text
/// (1/π) ∫ V(ω) n·ω dω,    V = 0 where the mesh is hit within ¼ of its diagonal
/// ```
///
/// estimated from 16 to 64 fixed directions per vertex and averaged once over
/// the neighbours. Values depend on the shape only: not on scale or position
/// (up to single precision), nor on the number of threads.
#[derive(Debug, Clone, PartialEq)]
pub struct Occlusion {
    front: Vec<f32>,
    /// For the inner side of an open surface; a closed one does not show it.
    back: Option<Vec<f32>>,
}

/// Rays end after this length, in diagonals of the bounding box.
const REACH: f32 = 0.25;

/// Rays start this far above the surface, in diagonals of the bounding box.
const LIFT: f32 = 5e-4;

/// The number of rays that a bake aims at, so that large meshes, whose
/// vertices stand close together, do not take longer in proportion.
const RAY_BUDGET: usize = 3_000_000;

impl Occlusion {
    /// Casts the rays: about a second for 50 thousand vertices on two cores,
    /// four for 350 thousand. Meshes without extent see the sky everywhere, and so do those in
    /// which thousands of long faces lie side by side, where each ray would have to pass most of
    /// them: the sum of the areas of their boxes is more than 64 times that of the mesh.
    /// Faces count as [oriented](TriMesh::oriented).
    pub fn bake(mesh: &TriMesh) -> Self {
        let mesh = &*mesh.oriented();
        let open = || Self { front: vec![1.0; mesh.vertex_count()], back: None };
        let Some([low, high]) = mesh.bounding_box() else { return open() };
        let (low, high) = (DVec3::from_array(low), DVec3::from_array(high));
        let (center, scale) = (low * 0.5 + high * 0.5, (high - low).length());
        if mesh.face_count() == 0 || !scale.is_normal() {
            return open();
        }
        let points: Vec<Vec3A> = mesh
            .positions()
            .iter()
            .map(|p| ((DVec3::from_array(*p) - center) / scale).as_vec3a())
            .collect();
        let normals: Vec<Vec3A> = vertex_normals(mesh, &area_vectors(mesh, scale))
            .into_iter()
            .map(|n| n.as_vec3a())
            .collect();
        let Some(tree) = Tree::new(mesh, &points) else { return open() };
        let rays = (RAY_BUDGET / points.len()).clamp(16, 64);
        let directions = hemisphere(rays);
        let closed = is_closed(mesh);
        let sides = if closed { 1 } else { 2 };
        let watch = fairing_watch::current();
        watch.stage("light", sides * points.len() as u64);
        let bake = |side: f32| {
            let values: Vec<f32> = (0..points.len())
                .into_par_iter()
                .map(|v| {
                    watch.advance(1);
                    tree.visibility(points[v], normals[v] * side, v, &directions)
                })
                .collect();
            average(mesh, &values)
        };
        let front = bake(1.0);
        let back = (!closed).then(|| bake(-1.0));
        Self { front, back }
    }

    /// One value in [0, 1] per vertex, for the outer side.
    pub fn front(&self) -> &[f32] {
        &self.front
    }

    /// One value in [0, 1] per vertex, for the inner side; the same as
    /// [`Self::front`] for a closed surface.
    pub fn back(&self) -> &[f32] {
        self.back.as_deref().unwrap_or(&self.front)
    }
}

/// Directions about +z, distributed like the cosine (Malley's method on the
/// points of the R₂ sequence).
fn hemisphere(count: usize) -> Vec<[f32; 2]> {
    (0..count).map(|i| plastic(i).map(|x| x as f32)).collect()
}

/// Point `i` of the R₂ sequence: steps of 1/ρ and 1/ρ² modulo 1, with the
/// plastic number ρ³ = ρ + 1.
fn plastic(i: usize) -> [f64; 2] {
    const STEPS: [f64; 2] = [0.754_877_666_246_692_7, 0.569_840_290_998_053_3];
    STEPS.map(|step| (0.5 + step * i as f64).fract())
}

/// The sum of the areas of the boxes of triangles over that of their common box above which no rays
/// are cast: one or two for even meshes, a quarter of the faces for a fan.
const CROWDED: f32 = 64.0;

/// Returns true if long triangles lie so close that a ray would meet the boxes of most of them, as
/// in a disc of thousands of faces around its centre.
fn is_crowded(triangles: &[Triangle]) -> bool {
    let crowd: f32 = triangles.iter().map(|t| t.aabb().half_area()).sum();
    let common = triangles.iter().fold(Aabb::empty(), |all, t| all.union(&t.aabb()));
    crowd > CROWDED * common.half_area()
}

struct Tree {
    bvh: CwBvh,
    /// In the order of the leaves.
    triangles: Vec<Triangle>,
}

impl Tree {
    /// `None` if rays would take too long.
    fn new(mesh: &TriMesh, points: &[Vec3A]) -> Option<Self> {
        let triangles: Vec<Triangle> = mesh
            .faces()
            .iter()
            .map(|f| {
                let [v0, v1, v2] = f.map(|v| points[v as usize]);
                Triangle { v0, v1, v2 }
            })
            .collect();
        if is_crowded(&triangles) {
            return None;
        }
        let mut spent = std::time::Duration::ZERO;
        let bvh = build_cwbvh_from_tris(&triangles, BvhBuildParams::fast_build(), &mut spent);
        let triangles = bvh.primitive_indices.iter().map(|&i| triangles[i as usize]).collect();
        Some(Self { bvh, triangles })
    }

    fn visibility(&self, point: Vec3A, normal: Vec3A, v: usize, directions: &[[f32; 2]]) -> f32 {
        if normal == Vec3A::ZERO {
            return 1.0;
        }
        let (tangent, bitangent) = normal.any_orthonormal_pair();
        let origin = point + normal * LIFT;
        // Shifting the pattern from vertex to vertex turns what would be
        // banding into noise that the average over neighbours takes away.
        let [du, dv] = plastic(v).map(|x| x as f32);
        let open = directions
            .iter()
            .filter(|[u, w]| {
                let (u, w) = ((u + du).fract(), (w + dv).fract());
                let (sin, cos) = libm::sincosf(std::f32::consts::TAU * w);
                let radius = u.sqrt();
                let direction = tangent * (radius * cos)
                    + bitangent * (radius * sin)
                    + normal * (1.0 - u).max(0.0).sqrt();
                let ray = Ray::new(origin, direction, 0.0, REACH);
                self.bvh.ray_traverse_miss(ray, |ray, i| self.triangles[i].intersect(ray))
            })
            .count();
        open as f32 / directions.len() as f32
    }
}

/// Half the own value, half the mean over the corners of the faces around.
fn average(mesh: &TriMesh, values: &[f32]) -> Vec<f32> {
    let incidence = mesh.incidence();
    let faces = mesh.faces();
    (0..values.len() as u32)
        .into_par_iter()
        .with_min_len(4096)
        .map(|v| {
            let own = values[v as usize];
            let corners = incidence.corners(v);
            if corners.is_empty() {
                return own;
            }
            let sum: f32 = corners
                .iter()
                .map(|&c| {
                    let (face, k) = (faces[c as usize / 3], c as usize % 3);
                    values[face[(k + 1) % 3] as usize] + values[face[(k + 2) % 3] as usize]
                })
                .sum();
            0.5 * own + 0.25 * sum / corners.len() as f32
        })
        .collect()
}

/// Returns true if every side of every face is shared with another face.
fn is_closed(mesh: &TriMesh) -> bool {
    let mut sides: Vec<[u32; 2]> = mesh
        .faces()
        .iter()
        .flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]])
        .map(|[a, b]| [a.min(b), a.max(b)])
        .collect();
    sides.par_sort_unstable();
    sides.chunk_by(|a, b| a == b).all(|edge| edge.len() > 1)
}

/// Lamps that travel with the camera: a key light from the upper left, a weak
/// fill light from the right, and a sky brighter above than below. Together
/// they light a surface that faces the key light at about its own colour.
pub(crate) struct Lamps {
    key: Vec3,
    fill: Vec3,
    up: Vec3,
}

const KEY: f32 = 0.84;
const FILL: f32 = 0.20;
const SKY_LOW: f32 = 0.13;
const SKY_HIGH: f32 = 0.32;
/// The key light is dimmed by this part of the occlusion: what a shadow would
/// do in crevices, without casting one.
const KEY_SHADE: f32 = 0.4;
const GLOSS: f32 = 0.06;
const SHARPNESS: i32 = 40;

impl Lamps {
    pub(crate) fn new(camera: &Camera) -> Self {
        let mix = |right: f64, up: f64, forward: f64| {
            (camera.right * right + camera.up * up + camera.forward * forward).normalize().as_vec3()
        };
        Self { key: mix(-0.5, 0.75, -0.8), fill: mix(0.9, 0.1, -0.6), up: camera.up.as_vec3() }
    }

    /// The light, in linear components, that leaves a point of colour `base`
    /// (linear) with unit normal `normal` towards the eye; `view` is the unit
    /// direction from the eye, `open` the part of the sky that is seen.
    pub(crate) fn shade(&self, base: Vec3, normal: DVec3, view: DVec3, open: f32) -> Vec3 {
        let (normal, view) = (normal.as_vec3(), view.as_vec3());
        let key = normal.dot(self.key).max(0.0) * (1.0 - KEY_SHADE * (1.0 - open));
        let fill = normal.dot(self.fill).max(0.0) * open;
        let height = 0.5 + 0.5 * normal.dot(self.up);
        let sky = (SKY_LOW + (SKY_HIGH - SKY_LOW) * height) * open;
        let half = (self.key - view).normalize_or_zero();
        let gloss = normal.dot(half).max(0.0).powi(SHARPNESS) * GLOSS * open;
        base * (KEY * key + FILL * fill + sky) + Vec3::splat(gloss)
    }
}
