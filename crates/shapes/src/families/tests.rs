//! What holds of every family.

use fairing_mesh::Diagnosis;
use fairing_mesh::vec3::{cross, dot, norm, sub};

use super::*;

/// The smallest angle of all faces, in degrees.
fn smallest_angle(mesh: &TriMesh) -> (f64, usize) {
    let mut smallest = (f64::INFINITY, 0);
    for f in 0..mesh.face_count() {
        let t = mesh.triangle(f);
        for k in 0..3 {
            let (u, v) = (sub(t[(k + 1) % 3], t[k]), sub(t[(k + 2) % 3], t[k]));
            let angle = libm::atan2(norm(cross(u, v)), dot(u, v)).to_degrees();
            if angle < smallest.0 {
                smallest = (angle, f);
            }
        }
    }
    smallest
}

/// The least angle of the triangles of each kind.
fn least(triangulation: Triangulation) -> f64 {
    match triangulation {
        Triangulation::Regular => 14.0,
        Triangulation::Irregular | Triangulation::Graded => 8.0,
        Triangulation::Anisotropic => 3.0,
    }
}

#[test]
fn all_are_clean() {
    let mut wrong = vec![];
    for &family in Family::ALL {
        for triangulation in Triangulation::ALL {
            for seed in 0..2 {
                let name = format!("{family} {triangulation} {seed}");
                let start = std::time::Instant::now();
                let mesh = family.mesh(4000, triangulation, seed);
                let d = Diagnosis::of(&mesh);
                let (angle, face) = smallest_angle(&mesh);
                let count = mesh.face_count();
                eprintln!(
                    "{name}: {count} faces, {} parts, genus {:?}, {} loops, angle {angle:.1}, volume {:?}, {:.3} s",
                    d.components,
                    d.genus,
                    d.boundary_loops,
                    d.volume,
                    start.elapsed().as_secs_f64()
                );
                if !d.is_clean() || d.components != 1 || d.volume.is_some_and(|v| v < 0.0) {
                    wrong.push(format!("{name}: {d:?}"));
                }
                if !(3600..=4400).contains(&count) {
                    wrong.push(format!("{name}: {count} faces"));
                }
                if angle < least(triangulation) {
                    wrong.push(format!("{name}: {angle}° at {:?}", mesh.triangle(face)));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
