//! Pictures of triangle meshes: rasteriser, colour maps, plots, composed figures.
//!
//! [`render`] draws a mesh in software: perspective, supersampled, shaded in
//! linear light with baked [`Occlusion`]. Pictures are values: nothing here
//! writes files, and nothing depends on the number of threads.

mod camera;
mod color;
mod error;
mod field;
mod image;
mod light;
mod maps;
mod normals;
mod occlusion;
mod raster;
mod render;
mod scale;

pub use camera::{Camera, Up, Viewpoint};
pub use color::{from_hue, linear_from_srgb, srgb_from_linear};
pub use error::{EncodeError, RenderError, ScaleError};
pub use field::Field;
pub use image::Image;
pub use maps::ColorMap;
pub use normals::Shading;
pub use occlusion::Occlusion;
pub use render::{Background, Colors, MAX_SIDE, RenderOptions, Wireframe, render};
pub use scale::{Center, Limits, Scale, ScaleOptions, Spread, UNDEFINED};
