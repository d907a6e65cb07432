//! A mesh from arrays in memory, and back.
//!
//! `cargo run --example mesh_from_arrays`

use anyhow::Result;
use fairing::mesh::{Diagnosis, TriMesh};

fn main() -> Result<()> {
    let positions = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
    let faces = [0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3];
    let mesh = run(&positions, &faces)?;
    println!("{:#?}", Diagnosis::new(&mesh));
    Ok(())
}

pub(crate) fn run(positions: &[f64], faces: &[u32]) -> Result<TriMesh> {
    // `TriMesh::from_indexed` takes other types of numbers, `TriMesh::new` vectors without a copy.
    let mesh = TriMesh::from_flat(positions, faces)?;
    // The same arrays without a copy.
    assert_eq!(mesh.positions().as_flattened(), positions);
    assert_eq!(mesh.faces().as_flattened(), faces);
    Ok(mesh)
}
