//! The geodesic distance from a vertex to all others, by the heat method.
//!
//! `cargo run --example heat_distance -- bunny.ply 0`

use anyhow::{Result, bail};
use fairing::mesh::io;
use fairing::spectral::HeatGeodesics;

fn main() -> Result<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [path, source] = &arguments[..] else { bail!("expected a mesh and a vertex") };
    for (vertex, distance) in run(path, source.parse()?)?.iter().enumerate() {
        match distance {
            Some(distance) => println!("{vertex} {distance}"),
            None => println!("{vertex} is not connected to {source}"),
        }
    }
    Ok(())
}

pub(crate) fn run(path: &str, source: u32) -> Result<Vec<Option<f64>>> {
    let mesh = io::read(path)?.mesh;
    // Factorised once, for any number of sources.
    Ok(HeatGeodesics::new(&mesh)?.distance(&[source])?)
}
