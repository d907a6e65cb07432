//! Boxes around the positions of a view, in which they become 16-bit integers.

use crate::model::view::Panel;
use glam::DVec3;

/// The largest distance from `center` at the first stops; 1 if it is zero.
pub(super) fn reach(panels: &[Panel], center: [f64; 3]) -> f64 {
    let distance = |p: &[f64; 3]| DVec3::from(*p).distance(center.into());
    let far = panels.iter().flat_map(|p| &p.positions[0]).map(distance).fold(0.0, f64::max);
    if far > 0.0 { far } else { 1.0 }
}

/// A mesh that is less high than this part of its width and depth is seen from above: from the side
/// it would leave its picture half empty.
const LOW: f64 = 0.45;

/// A box around positions.
#[derive(Debug, Clone, Copy)]
pub(super) struct Frame {
    pub(super) low: [f64; 3],
    pub(super) high: [f64; 3],
}

impl Frame {
    pub(super) fn new(positions: &[[f64; 3]]) -> Self {
        let empty = Self { low: [f64::INFINITY; 3], high: [f64::NEG_INFINITY; 3] };
        positions.iter().fold(empty, |frame, p| Self {
            low: [0, 1, 2].map(|k| p[k].min(frame.low[k])),
            high: [0, 1, 2].map(|k| p[k].max(frame.high[k])),
        })
    }

    /// The box of all panels at their first stops: what the camera looks at.
    pub(super) fn around(panels: &[Panel]) -> Self {
        let boxes = panels.iter().map(|p| Self::new(&p.positions[0]));
        boxes
            .reduce(|a, b| Self {
                low: [0, 1, 2].map(|k| a.low[k].min(b.low[k])),
                high: [0, 1, 2].map(|k| a.high[k].max(b.high[k])),
            })
            .unwrap_or(Self { low: [0.0; 3], high: [0.0; 3] })
    }

    pub(super) fn center(&self) -> [f64; 3] {
        [0, 1, 2].map(|k| 0.5 * (self.low[k] + self.high[k]))
    }

    pub(super) fn size(&self) -> [f64; 3] {
        [0, 1, 2].map(|k| self.high[k] - self.low[k])
    }

    /// Half the diagonal; 1 for a point.
    fn radius(&self) -> f64 {
        let diagonal = DVec3::from(self.low).distance(self.high.into());
        if diagonal > 0.0 { 0.5 * diagonal } else { 1.0 }
    }

    /// The same with a margin of half the radius.
    pub(super) fn enlarged(&self) -> Self {
        let margin = 0.5 * self.radius();
        Self { low: self.low.map(|x| x - margin), high: self.high.map(|x| x + margin) }
    }

    pub(super) fn nearly_holds(&self, other: &Self) -> bool {
        let own = self.enlarged();
        (0..3).all(|k| own.low[k] <= other.low[k] && other.high[k] <= own.high[k])
    }

    /// The place in the box, in 65535ths.
    pub(super) fn code(&self, p: [f64; 3]) -> [u16; 3] {
        let last = f64::from(u16::MAX);
        [0, 1, 2].map(|k| {
            let size = self.high[k] - self.low[k];
            let t = if size > 0.0 { (p[k] - self.low[k]) / size } else { 0.0 };
            (t * last).round().min(last) as u16
        })
    }

    /// Azimuth and elevation at which the view begins, in degrees: almost face on for nearly flat
    /// meshes, from above for low ones, a little from the side and above for others.
    pub(super) fn angles(&self, z_up: bool) -> [f64; 2] {
        // Sideways, up, towards the camera.
        let axes = if z_up { [0, 2, 1] } else { [0, 1, 2] };
        let size = axes.map(|k| self.high[k] - self.low[k]);
        let thin = 0.1 * self.radius();
        match size.iter().position(|&s| s < thin) {
            Some(0) => [70.0, 15.0],
            Some(1) => [20.0, 65.0],
            Some(_) => [20.0, 20.0],
            None if size[1] < LOW * size[0].min(size[2]) => [30.0, 40.0],
            None => [30.0, 20.0],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn low_meshes_are_seen_from_above() {
        let elevation = |height: f64| {
            Frame { low: [-1.0, -1.0, 0.0], high: [1.0, 1.0, height] }.angles(true)[1]
        };
        assert_eq!([2.0, 0.6, 0.0].map(elevation), [20.0, 40.0, 65.0]);
    }
}
