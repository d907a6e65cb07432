//! Directions of view and cameras.

use std::fmt;
use std::str::FromStr;

use fairing_mesh::TriMesh;
use fairing_parameters::{ParameterError, by_name};
use glam::DVec3;

use crate::error::FigureError;

/// The direction from which a mesh is seen.
///
/// `Display` and `FromStr` use the name or the angles: `front`, `30,20`.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
pub enum Viewpoint {
    /// From +z (with [`Up::Y`]), from −y (with [`Up::Z`]).
    Front,
    /// Opposite to [`Viewpoint::Front`].
    Back,
    /// From −x.
    Left,
    /// From +x.
    Right,
    /// From above.
    Top,
    /// From below.
    Bottom,
    /// From the front, 30° to the right of it and 20° above: shows three sides.
    #[default]
    ThreeQuarter,
    /// From the back, 30° to the left of it seen from there and 20° above.
    ThreeQuarterBack,
    /// Any other direction, in degrees: azimuth from the front towards +x,
    /// elevation above the horizon.
    Angles {
        /// Turn about the upward axis, from the front towards +x.
        azimuth: f64,
        /// Height above the horizon, −90 to 90.
        elevation: f64,
    },
}

impl Viewpoint {
    /// All named directions.
    pub const ALL: [Self; 8] = [
        Self::Front,
        Self::Back,
        Self::Left,
        Self::Right,
        Self::Top,
        Self::Bottom,
        Self::ThreeQuarter,
        Self::ThreeQuarterBack,
    ];

    /// The name on the command line; `None` for [`Viewpoint::Angles`].
    pub fn name(self) -> Option<&'static str> {
        Some(match self {
            Self::Front => "front",
            Self::Back => "back",
            Self::Left => "left",
            Self::Right => "right",
            Self::Top => "top",
            Self::Bottom => "bottom",
            Self::ThreeQuarter => "three-quarter",
            Self::ThreeQuarterBack => "behind",
            Self::Angles { .. } => return None,
        })
    }

    /// Azimuth and elevation, in degrees.
    pub fn angles(self) -> (f64, f64) {
        match self {
            Self::Front => (0.0, 0.0),
            Self::Back => (180.0, 0.0),
            Self::Left => (-90.0, 0.0),
            Self::Right => (90.0, 0.0),
            Self::Top => (0.0, 90.0),
            Self::Bottom => (0.0, -90.0),
            Self::ThreeQuarter => (30.0, 20.0),
            Self::ThreeQuarterBack => (210.0, 20.0),
            Self::Angles { azimuth, elevation } => (azimuth, elevation),
        }
    }
}

impl fmt::Display for Viewpoint {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (self, self.name()) {
            (_, Some(name)) => f.pad(name),
            (Self::Angles { azimuth, elevation }, None) => write!(f, "{azimuth},{elevation}"),
            (_, None) => Ok(()),
        }
    }
}

impl FromStr for Viewpoint {
    type Err = ParameterError;

    fn from_str(text: &str) -> Result<Self, ParameterError> {
        let angle = |text: &str| text.trim().parse().ok().filter(|a: &f64| a.is_finite());
        let angles = text.split_once(',').and_then(|(a, e)| Some((angle(a)?, angle(e)?)));
        match angles {
            Some((azimuth, elevation)) => Ok(Self::Angles { azimuth, elevation }),
            None => by_name("view", &Self::ALL, |view| view.name().unwrap_or_default(), text),
        }
    }
}

#[cfg(feature = "serde")]
fairing_parameters::serde_by_name!(Viewpoint);

/// The axis that points upward in the picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum Up {
    /// +y, as in most files made for graphics.
    #[default]
    Y,
    /// +z, as in most files made for engineering and surveying.
    Z,
}

/// A perspective camera in mesh units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Camera {
    pub(crate) eye: DVec3,
    pub(crate) right: DVec3,
    pub(crate) up: DVec3,
    pub(crate) forward: DVec3,
    /// Tangent of half the vertical field of view.
    pub(crate) half_height: f64,
    /// The nearest distance that is drawn, in mesh units.
    pub(crate) near: f64,
    /// The unit of length of the picture, in mesh units.
    pub(crate) scale: f64,
}

/// Vertical field of view, in degrees: about what a portrait lens sees, so
/// that shapes are neither flat nor distorted.
const FIELD_OF_VIEW: f64 = 30.0;

/// The part of each side of the picture that stays free.
const MARGIN: f64 = 0.03;

impl Camera {
    /// The nearest camera in direction `viewpoint` from which every face of
    /// every one of `meshes` is in the picture, with a margin of 3 % and the
    /// outline centred; `aspect` is width over height of the picture.
    ///
    /// Meshes that are to be compared share a camera fitted to all of them,
    /// or to the one that sets the scale. Isolated vertices do not count.
    /// Linear in vertices.
    ///
    /// # Errors
    ///
    /// [`FigureError::NoFaces`] without faces, [`FigureError::NoExtent`] if all
    /// lie in one point, [`FigureError::TooFar`] if distances overflow.
    pub fn fit(
        meshes: &[&TriMesh],
        viewpoint: Viewpoint,
        up: Up,
        aspect: f64,
    ) -> Result<Self, FigureError> {
        let [right, upward, forward] = axes(viewpoint, up);
        let (center, scale) = bounds(meshes)?;
        let half_height = libm::tan((FIELD_OF_VIEW / 2.0).to_radians());
        let ty = half_height * (1.0 - 2.0 * MARGIN);
        let tx = ty * aspect;

        // In camera axes a point is inside the right side of the view pyramid
        // iff x − tx z ≤ eₓ − tx e_z, and so on for the other three: the
        // extreme left-hand sides give the nearest eye at once.
        let mut limits = [f64::NEG_INFINITY; 4];
        let mut nearest = f64::INFINITY;
        for_each_used(meshes, |p| {
            let q = (p - center) / scale;
            let (x, y, z) = (q.dot(right), q.dot(upward), q.dot(forward));
            for (limit, value) in
                limits.iter_mut().zip([x - tx * z, -x - tx * z, y - ty * z, -y - ty * z])
            {
                *limit = limit.max(value);
            }
            nearest = nearest.min(z);
        });
        let [a, b, c, d] = limits;
        // The last bound keeps the eye in front of what is seen edge-on.
        let z = (-(a + b) / (2.0 * tx)).min(-(c + d) / (2.0 * ty)).min(nearest - 0.25);
        let eye = right * ((a - b) / 2.0) + upward * ((c - d) / 2.0) + forward * z;
        Ok(Self {
            eye: center + eye * scale,
            right,
            up: upward,
            forward,
            half_height,
            near: scale * (nearest - z) * 0.05,
            scale,
        })
    }

    /// The position of the camera, in mesh units.
    pub fn eye(&self) -> [f64; 3] {
        self.eye.to_array()
    }

    /// The unit direction of view.
    pub fn forward(&self) -> [f64; 3] {
        self.forward.to_array()
    }
}

/// The camera's right, up and forward directions.
fn axes(viewpoint: Viewpoint, up: Up) -> [DVec3; 3] {
    let (azimuth, elevation) = viewpoint.angles();
    let (sa, ca) = libm::sincos(azimuth.to_radians());
    let (se, ce) = libm::sincos(elevation.clamp(-90.0, 90.0).to_radians());
    // With y up; azimuth alone gives the right direction, so that it stays
    // defined when looking straight down.
    let right = DVec3::new(ca, 0.0, -sa);
    let forward = -DVec3::new(sa * ce, se, ca * ce);
    let upward = right.cross(forward);
    [right, upward, forward].map(|v| match up {
        Up::Y => v,
        Up::Z => DVec3::new(v.x, -v.z, v.y),
    })
}

/// Centre and half the diagonal of the bounding box of all faces.
fn bounds(meshes: &[&TriMesh]) -> Result<(DVec3, f64), FigureError> {
    let mut low = DVec3::INFINITY;
    let mut high = DVec3::NEG_INFINITY;
    for_each_used(meshes, |p| {
        low = low.min(p);
        high = high.max(p);
    });
    if low.x > high.x {
        return Err(FigureError::NoFaces {
            vertices: meshes.iter().map(|m| m.vertex_count()).sum(),
        });
    }
    let scale = (high - low).length() / 2.0;
    if !scale.is_finite() {
        let (vertex, position) = meshes
            .iter()
            .flat_map(|m| m.positions().iter().enumerate())
            .max_by(|(_, p), (_, q)| largest(p).total_cmp(&largest(q)))
            .map_or((0, [0.0; 3]), |(v, p)| (v, *p));
        return Err(FigureError::TooFar { vertex, position });
    }
    // A mesh smaller than the rounding of its own coordinates has no shape.
    let magnitude = low.abs().max(high.abs()).max_element();
    if scale <= magnitude * 4.0 * f64::EPSILON || scale < f64::MIN_POSITIVE.sqrt() {
        return Err(FigureError::NoExtent { point: low.to_array() });
    }
    Ok((low + (high - low) / 2.0, scale))
}

fn largest(p: &[f64; 3]) -> f64 {
    p.iter().fold(0.0, |m, x| m.max(x.abs()))
}

/// Visits the corners of all faces; vertices are visited once per corner.
fn for_each_used(meshes: &[&TriMesh], mut visit: impl FnMut(DVec3)) {
    for mesh in meshes {
        for &v in mesh.faces().as_flattened() {
            visit(DVec3::from_array(mesh.positions()[v as usize]));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn named_directions_look_along_their_axes() {
        let along = |v, up| {
            let [right, upward, forward] = axes(v, up);
            (right.round(), upward.round(), forward.round())
        };
        assert_eq!(along(Viewpoint::Front, Up::Y), (DVec3::X, DVec3::Y, DVec3::NEG_Z));
        assert_eq!(along(Viewpoint::Right, Up::Y), (DVec3::NEG_Z, DVec3::Y, DVec3::NEG_X));
        assert_eq!(along(Viewpoint::Top, Up::Y), (DVec3::X, DVec3::NEG_Z, DVec3::NEG_Y));
        assert_eq!(along(Viewpoint::Front, Up::Z), (DVec3::X, DVec3::Z, DVec3::Y));
        assert_eq!(along(Viewpoint::Left, Up::Z), (DVec3::NEG_Y, DVec3::Z, DVec3::X));
    }

    /// Every corner is inside, and at least one touches each of two opposite
    /// margins: nearer would cut something off.
    #[test]
    fn the_fit_is_tight() {
        let mesh = TriMesh::new(
            vec![[5e5, 4.6e6, 1.0], [5e5 + 3.0, 4.6e6, 0.5], [5e5, 4.6e6 + 1.0, 0.0]],
            vec![[0, 1, 2]],
        )
        .unwrap();
        for aspect in [0.5, 1.0, 2.0] {
            for viewpoint in [Viewpoint::Front, Viewpoint::ThreeQuarter, Viewpoint::Top] {
                let camera = Camera::fit(&[&mesh], viewpoint, Up::Y, aspect).unwrap();
                let mut extent = [0.0f64; 2];
                for p in mesh.positions() {
                    let d = DVec3::from_array(*p) - camera.eye;
                    let depth = d.dot(camera.forward);
                    assert!(depth > camera.near);
                    let t = camera.half_height * depth;
                    extent[0] = extent[0].max((d.dot(camera.right) / (t * aspect)).abs());
                    extent[1] = extent[1].max((d.dot(camera.up) / t).abs());
                }
                let fill = extent[0].max(extent[1]);
                assert!((fill - 0.94).abs() < 1e-6, "{viewpoint:?} {aspect}: {extent:?}");
            }
        }
    }

    #[test]
    fn what_cannot_be_framed_is_refused() {
        let fit = |p: Vec<[f64; 3]>, f: Vec<[u32; 3]>| {
            let mesh = TriMesh::new(p, f).unwrap();
            Camera::fit(&[&mesh], Viewpoint::Front, Up::Y, 1.0).unwrap_err()
        };
        assert_eq!(fit(vec![[0.0; 3]; 4], vec![]), FigureError::NoFaces { vertices: 4 });
        assert_eq!(
            fit(vec![[7.0; 3]; 3], vec![[0, 1, 2]]),
            FigureError::NoExtent { point: [7.0; 3] }
        );
    }
}
