//! Denoises a mesh and compares the result with the original.
//!
//! `cargo run --example denoise_and_compare -- noisy.ply original.ply`

use std::error::Error;

use fairing::denoising::{AutomaticOptions, automatic};
use fairing::evaluation::{ScoreOptions, Scores};
use fairing::mesh::io;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [noisy, original] = &arguments[..] else { return Err("two files".into()) };
    print!("{}", run(noisy, original)?);
    Ok(())
}

pub(crate) fn run(noisy: &str, original: &str) -> Result<Scores, Box<dyn Error>> {
    let noisy = io::read(noisy)?.mesh;
    let original = io::read(original)?.mesh;
    let denoised = automatic(&noisy, &AutomaticOptions::default())?;
    Ok(Scores::new(&denoised.mesh, &original, &ScoreOptions::default())?)
}
