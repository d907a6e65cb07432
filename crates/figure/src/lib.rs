//! Pictures of triangle meshes: rasteriser, colour maps, plots, composed figures.
//!
//! [`render`] draws a mesh in software: perspective, supersampled, shaded in
//! linear light with baked [`Occlusion`]. Pictures are values: nothing here
//! writes files, and nothing depends on the number of threads.
//!
//! ```
//! use fairing_figure::{Camera, Colors, Occlusion, RenderOptions, Up, Viewpoint, render};
//! use fairing_mesh::TriMesh;
//!
//! let corners = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
//! let mesh = TriMesh::new(corners, vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])?;
//! let options = RenderOptions { width: 120, height: 90, ..RenderOptions::default() };
//! let camera = Camera::fit(&[&mesh], Viewpoint::ThreeQuarter, Up::Z, options.aspect())?;
//! let picture = render(&mesh, Colors::CLAY, Some(&Occlusion::bake(&mesh)), &camera, &options)?;
//! assert!(picture.to_png()?.starts_with(b"\x89PNG"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

#![cfg_attr(test, expect(clippy::disallowed_methods, reason = "tests do not need the same bits"))]

mod camera;
mod color;
mod colorbar;
mod coloring;
mod drawing;
mod error;
mod field;
mod figure;
mod image;
mod light;
mod maps;
mod normals;
mod number;
mod occlusion;
mod outline;
mod paint;
mod plot;
mod raster;
mod render;
mod render_options;
mod scale;
mod svg;
mod text;
mod ticks;

pub use camera::{Camera, Up, Viewpoint};
pub use color::{from_hue, linear_from_srgb, srgb_from_linear};
pub use colorbar::ColorBar;
pub use coloring::ColoringOptions;
pub use drawing::Drawing;
pub use error::FigureError;
pub use field::Field;
pub use figure::{Figure, Panel};
pub use image::Image;
pub use maps::ColorMap;
pub use normals::Shading;
#[doc(hidden)]
pub use number::number;
pub use occlusion::Occlusion;
pub use plot::{Axis, AxisScale, Legend, Plot, Series, Shape};
pub use render::{Colors, render};
pub use render_options::{Background, MAX_SIDE, RenderOptions, Wireframe};
pub use scale::{Center, Limits, Scale, ScaleOptions, Spread, UNDEFINED};
