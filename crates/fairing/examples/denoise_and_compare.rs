//! Denoises a mesh and compares the result with the original.
//!
//! `cargo run --example denoise_and_compare -- noisy.ply original.ply`

use anyhow::{Result, bail};
use fairing::denoising::{AutomaticOptions, automatic};
use fairing::evaluation::{ScoreOptions, Scores};
use fairing::mesh::io;

fn main() -> Result<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [noisy, original] = &arguments[..] else { bail!("expected a noisy mesh and its original") };
    print!("{}", run(noisy, original)?);
    Ok(())
}

pub(crate) fn run(noisy: &str, original: &str) -> Result<Scores> {
    let noisy = io::read(noisy)?.mesh;
    let original = io::read(original)?.mesh;
    let denoised = automatic(&noisy, &AutomaticOptions::default())?;
    Ok(Scores::new(&denoised.mesh, &original, &ScoreOptions::default())?)
}
