//! A mesh from arrays in memory, and back.
//!
//! `cargo run --example mesh_from_arrays`

use std::error::Error;

use fairing::mesh::{Diagnosis, TriMesh};

fn main() -> Result<(), Box<dyn Error>> {
    let positions = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
    let faces = [0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3];
    let mesh = run(&positions, &faces)?;
    println!("{:#?}", Diagnosis::of(&mesh));
    Ok(())
}

pub(crate) fn run(positions: &[f64], faces: &[u32]) -> Result<TriMesh, Box<dyn Error>> {
    // What is left over does not make a vertex or a face.
    let (points, []) = positions.as_chunks() else { return Err("three numbers a vertex".into()) };
    let (corners, []) = faces.as_chunks() else { return Err("three indices a face".into()) };
    let mesh = TriMesh::new(points.to_vec(), corners.to_vec())?;
    // The same arrays without a copy.
    assert_eq!(mesh.positions().as_flattened(), positions);
    assert_eq!(mesh.faces().as_flattened(), faces);
    Ok(mesh)
}
