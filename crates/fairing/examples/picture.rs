//! A picture of a mesh as the bytes of a PNG file.
//!
//! `cargo run --example picture -- bunny.ply > bunny.png`

use std::io::Write;

use anyhow::{Context as _, Result};
use fairing::figure::{Camera, Colors, Occlusion, RenderOptions, Up, Viewpoint, render};
use fairing::mesh::io;

fn main() -> Result<()> {
    let path = std::env::args().nth(1).context("missing mesh file")?;
    Ok(std::io::stdout().write_all(&run(&path, 800, 600)?)?)
}

pub(crate) fn run(path: &str, width: u32, height: u32) -> Result<Vec<u8>> {
    let mesh = io::read(path)?.mesh;
    let options = RenderOptions { width, height, ..RenderOptions::default() };
    let camera = Camera::fit(&[&mesh], Viewpoint::default(), Up::default(), options.aspect())?;
    // The soft shadows in hollows that show shape.
    let occlusion = Occlusion::bake(&mesh);
    Ok(render(&mesh, Colors::CLAY, Some(&occlusion), &camera, &options)?.to_png()?)
}
