//! Lighting of surfaces.

use glam::{DVec3, Vec3};

use crate::camera::Camera;

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
