//! Pictures of triangle meshes: rasteriser, colour maps, plots, composed figures.
//!
//! [`render`] draws a mesh in software: perspective, supersampled, shaded in
//! linear light with baked [`Occlusion`]. Pictures are values: nothing here
//! writes files, and nothing depends on the number of threads.

mod camera;
mod color;
mod error;
mod image;
mod light;
mod normals;
mod occlusion;
mod raster;
mod render;

pub use camera::{Camera, Up, Viewpoint};
pub use color::{from_hue, linear_from_srgb, srgb_from_linear};
pub use error::{EncodeError, RenderError};
pub use image::Image;
pub use normals::Shading;
pub use occlusion::Occlusion;
pub use render::{Background, Colors, MAX_SIDE, RenderOptions, Wireframe, render};
