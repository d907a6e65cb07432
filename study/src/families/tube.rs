//! Tubes around closed curves.

use glam::DVec3;

/// A tube around a closed curve of period one.
pub(super) struct Tube<F> {
    axis: F,
}

impl<F: Fn(f64) -> [f64; 3]> Tube<F> {
    /// The curvature of the curve vanishes nowhere.
    pub(super) fn new(axis: F) -> Self {
        Self { axis }
    }

    pub(super) fn length(&self) -> f64 {
        const PARTS: u32 = 512;
        let at = |i: u32| DVec3::from((self.axis)(f64::from(i) / f64::from(PARTS)));
        (0..PARTS).map(|i| at(i).distance(at(i + 1))).sum()
    }

    /// The point at the fraction `u` of the curve's parameter and `v` of a turn
    /// around it, clockwise from its normal seen along it, so that u to the right and v
    /// upwards turn counter-clockwise seen from outside.
    pub(super) fn at(&self, u: f64, v: f64, radius: f64) -> [f64; 3] {
        const STEP: f64 = 1e-4;
        let [before, here, after] = [u - STEP, u, u + STEP].map(|u| DVec3::from((self.axis)(u)));
        let tangent = after - before;
        let tangent = tangent * (1.0 / tangent.length());
        let bend = (before + after) - (here * 2.0);
        let bend = bend - (tangent * bend.dot(tangent));
        let normal = bend * (1.0 / bend.length());
        let binormal = normal.cross(tangent);
        let (s, c) = libm::sincos(std::f64::consts::TAU * v);
        (here + (normal * (radius * c) + binormal * (radius * s))).into()
    }
}
