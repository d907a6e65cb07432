//! Options for pictures of meshes.

use crate::normals::Shading;

/// The largest width or height of a picture, in pixels.
pub const MAX_SIDE: u32 = 16_384;

/// Lines along the edges of the mesh.
///
/// They fade out where the edges come closer than a few pixels, so that a
/// dense mesh shows its surface and not a black blot.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
pub struct Wireframe {
    /// Width in pixels of the picture.
    pub width: f32,
    /// sRGB colour.
    pub color: [u8; 3],
    /// The opacity of a line, from 0 to 1.
    pub opacity: f32,
}

impl Default for Wireframe {
    fn default() -> Self {
        Self { width: 1.0, color: [20, 22, 28], opacity: 0.7 }
    }
}

/// The background of a picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum Background {
    /// Nothing: the picture has an alpha channel.
    #[default]
    Transparent,
    /// An opaque sRGB colour.
    Color([u8; 3]),
}

impl Background {
    /// White paper.
    pub const WHITE: Self = Self::Color([255; 3]);
}

/// Options for rendering a picture.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
pub struct RenderOptions {
    /// Width in pixels, 1 to [`MAX_SIDE`].
    pub width: u32,
    /// Height in pixels, 1 to [`MAX_SIDE`].
    pub height: u32,
    /// Samples along each side of a pixel, 1 to 8: 3 means 3 × 3.
    pub samples: u32,
    /// The interpolation of normals over a face.
    pub shading: Shading,
    /// Lines along the edges of the mesh; `None` for none.
    pub wireframe: Option<Wireframe>,
    /// The background.
    pub background: Background,
    /// The colour towards which faces seen from behind are tinted, a third of
    /// the way;
    /// `None` shows both sides alike.
    pub back_tint: Option<[u8; 3]>,
}

impl Default for RenderOptions {
    fn default() -> Self {
        Self {
            width: 800,
            height: 600,
            samples: 3,
            shading: Shading::Smooth,
            wireframe: None,
            background: Background::Transparent,
            back_tint: Some([96, 110, 140]),
        }
    }
}

impl RenderOptions {
    /// Width over height, as [`Camera::fit`](crate::Camera::fit) takes it.
    pub fn aspect(&self) -> f64 {
        f64::from(self.width) / f64::from(self.height)
    }
}
