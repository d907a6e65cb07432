#![doc = include_str!("../README.md")]
//!
//! # Overview
//!
//! [`render`] draws a mesh in software: perspective, supersampled, shaded in linear light with
//! baked [`Occlusion`]; [`page`] makes an HTML page of meshes to turn and to click.
//! Pictures and pages are values: nothing here writes files, and nothing depends on the
//! number of threads.

#![cfg_attr(test, expect(clippy::disallowed_methods, reason = "tests do not need the same bits"))]

pub mod bundle;
mod camera;
mod color;
mod colorbar;
mod coloring;
mod drawing;
mod error;
mod field;
mod figure;
mod image;
mod normals;
mod occlusion;
mod outline;
mod page;
mod paint;
mod palette;
mod plot;
mod raster;
mod render;
mod render_options;
mod scale;
mod svg;
mod text;
mod ticks;

pub use camera::{Camera, Up, Viewpoint};
pub use color::ColorMap;
pub use colorbar::ColorBar;
pub use coloring::ColoringOptions;
pub use drawing::Drawing;
pub use error::FigureError;
pub use field::Field;
pub use figure::{Figure, Panel};
pub use image::Image;
pub use normals::Shading;
pub use occlusion::Occlusion;
pub use page::{Exhibit, VIEWER, color_maps, page};
pub use plot::{Axis, AxisScale, Legend, Plot, Series, Shape};
pub use render::{Colors, render};
pub use render_options::{Background, MAX_SIDE, RenderOptions, Wireframe};
pub use scale::{Center, Limits, Scale, ScaleOptions, Spread, UNDEFINED};
