//! Common defects of files through the program: inconsistent windings and vertices that are not
//! shared.

use std::path::Path;

use fairing_evaluation::{NoiseKind, NoiseLevel, add_noise, normal_error};
use fairing_mesh::TriMesh;
use fairing_mesh::io;
use fairing_shapes as shapes;
use serde_json::Value;

use crate::command_line::{fairing, refuse, run};

/// The mesh with three faces in ten flipped.
pub(crate) fn with_turned_faces(mesh: &TriMesh) -> TriMesh {
    let turned = |(f, &[a, b, c]): (usize, &[u32; 3])| {
        if (f * 7) % 10 < 3 { [b, a, c] } else { [a, b, c] }
    };
    let faces = mesh.faces().iter().enumerate().map(turned).collect();
    TriMesh::new(mesh.positions().to_vec(), faces).unwrap()
}

/// The mesh with separate corners for every face.
pub(crate) fn soup(mesh: &TriMesh) -> TriMesh {
    let corners = mesh.faces().as_flattened().iter().map(|&v| mesh.positions()[v as usize]);
    let faces = (0..mesh.face_count() as u32).map(|f| [3 * f, 3 * f + 1, 3 * f + 2]).collect();
    TriMesh::new(corners.collect(), faces).unwrap()
}

fn noisy_block() -> (TriMesh, TriMesh) {
    let block = shapes::cad_block(0.15);
    let level = NoiseLevel::EdgeLengths(0.2);
    (add_noise(&block, NoiseKind::GaussianAlongNormals, level, 5).unwrap(), block)
}

fn save(folder: &Path, name: &str, mesh: &TriMesh) {
    io::write(folder.join(name), mesh).unwrap();
}

fn load(folder: &Path, name: &str) -> TriMesh {
    io::read(folder.join(name)).unwrap().mesh
}

#[test]
fn turned_faces_are_denoised_as_if_they_agreed() {
    let folder = tempfile::tempdir().unwrap();
    let (noisy, block) = noisy_block();
    let turned = with_turned_faces(&noisy);
    save(folder.path(), "even.ply", &noisy);
    save(folder.path(), "turned.ply", &turned);
    run(folder.path(), "denoise even.ply -o a.ply");
    let output = fairing(folder.path(), "denoise turned.ply -o b.ply --json");
    let said = String::from_utf8(output.stderr).unwrap();
    let count = noisy.faces().iter().zip(turned.faces()).filter(|(a, b)| a != b).count();
    assert!(
        said.contains(&format!("{count} of {} faces turn against", noisy.face_count())),
        "{said}"
    );
    let summary: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(summary["turned_faces"], count);
    let (a, b) = (load(folder.path(), "a.ply"), load(folder.path(), "b.ply"));
    assert_eq!(b.faces(), turned.faces());
    let [found, expected] = [&b, &a].map(|mesh| normal_error(mesh, &block).unwrap().mean);
    assert!((found - expected).abs() < 1e-6, "{found} and {expected}");
    let scores = run(folder.path(), "compare b.ply even.ply --json");
    let scores: Value = serde_json::from_str(&scores).unwrap();
    assert!(scores["normal_mean"]["value"].as_f64().unwrap() < 20.0, "{scores}");
}

#[test]
fn a_volume_is_kept_where_faces_turn_both_ways() {
    let folder = tempfile::tempdir().unwrap();
    save(folder.path(), "turned.ply", &with_turned_faces(&shapes::torus(3.0, 1.0, 40, 16)));
    for volume in ["rescale", "offset"] {
        let line = format!(
            "smooth turned.ply -o out.ply --force --json --method implicit --volume {volume}"
        );
        let summary: Value = serde_json::from_str(&run(folder.path(), &line)).unwrap();
        let change = summary["volume_change_percent"].as_f64().unwrap();
        assert!(change.abs() < 1e-6, "{volume}: {change}");
    }
}

#[test]
fn a_moebius_band_has_curvature_but_no_volume() {
    let folder = tempfile::tempdir().unwrap();
    let band = shapes::moebius(0.4, 40, 4);
    save(folder.path(), "band.ply", &band);
    let output = fairing(folder.path(), "curvature band.ply -o curved.ply --json");
    assert!(String::from_utf8(output.stderr).unwrap().contains("one-sided"));
    let summary: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(summary["one_sided_faces"], band.face_count());
    let curved = io::read(folder.path().join("curved.ply")).unwrap();
    assert!(curved.fields.scalar("mean").unwrap().iter().all(|&h| h >= 0.0));
    run(folder.path(), "smooth band.ply -o smooth.ply --method implicit");
    let line = "smooth band.ply -o kept.ply --method implicit --volume rescale";
    assert!(refuse(folder.path(), line, 1).contains("volume"));
    let denoised = fairing(folder.path(), "denoise band.ply -o denoised.ply");
    assert!(denoised.status.success());
}

/// Every verb that needs neighbours suggests --weld. With it the result has the vertices of the
/// file, at the positions of the welded mesh.
#[test]
fn faces_with_corners_of_their_own_are_welded_on_request() {
    let folder = tempfile::tempdir().unwrap();
    let (noisy, _) = noisy_block();
    let own = soup(&noisy);
    save(folder.path(), "soup.obj", &own);
    save(folder.path(), "whole.obj", &own.welded().mesh);
    for verb in [
        "smooth F -o out.ply --method implicit --pin 5",
        "denoise F -o out.ply",
        "noise F -o out.ply --sigma 0.1",
        "reconstruct F -o out.ply -k 30",
        "curvature F -o out.ply",
        "geodesic F -o out.ply --from 5",
        "spectrum F -o out.npz -k 5",
    ] {
        let on = |file: &str| verb.replace('F', file);
        let said = refuse(folder.path(), &on("soup.obj"), 3);
        assert!(said.contains("--weld") && said.contains("share their corners"), "{said}");
        assert!(!folder.path().join("out.ply").exists());
        run(folder.path(), &format!("{} --force --weld", on("soup.obj")));
        if verb.ends_with("-k 5") {
            continue;
        }
        let found = io::read(folder.path().join("out.ply")).unwrap();
        assert_eq!(found.mesh.faces(), own.faces());
        let expected = on("whole.obj").replace("out.ply", "expected.ply");
        // The vertex of the file that is vertex 5 of the welded mesh.
        let five = own.welded().vertices[5];
        let expected = ["--pin", "--from"].iter().fold(expected, |line, option| {
            line.replace(&format!("{option} 5"), &format!("{option} {five}"))
        });
        run(folder.path(), &format!("{expected} --force"));
        let expected = io::read(folder.path().join("expected.ply")).unwrap();
        let vertices = own.welded().vertices;
        for (v, &w) in vertices.iter().enumerate() {
            let (p, q) = (found.mesh.positions()[v], expected.mesh.positions()[w as usize]);
            assert_eq!(p, q, "{verb}");
        }
        for name in ["mean", "distance"] {
            let Some(own) = found.fields.scalar(name) else { continue };
            let welded = expected.fields.scalar(name).unwrap();
            assert!(vertices.iter().enumerate().all(|(v, &w)| own[v] == welded[w as usize]));
        }
        std::fs::remove_file(folder.path().join("out.ply")).unwrap();
    }
    // Modes at welded vertices are equal, and orthonormal in the mass that they share.
    let modes = fairing_spectral::Spectrum::load(folder.path().join("out.npz")).unwrap();
    assert_eq!(modes.vertex_count(), own.vertex_count());
    let gram = modes.transform(modes.modes.view()).unwrap();
    for ((i, j), x) in gram.indexed_iter() {
        assert!((x - f64::from(u8::from(i == j))).abs() < 1e-9, "{i} {j} {x}");
    }
}

#[test]
fn seams_are_named_and_stay_closed_when_welded() {
    let folder = tempfile::tempdir().unwrap();
    // A torus cut open along a seam.
    let torus = shapes::torus(3.0, 1.0, 40, 16);
    let mut positions = torus.positions().to_vec();
    let mut copies = std::collections::HashMap::new();
    let faces = torus.faces().iter().map(|face| {
        let beyond = face.iter().any(|&v| v % 40 == 39);
        face.map(|v| {
            if beyond && v % 40 == 0 {
                *copies.entry(v).or_insert_with(|| {
                    positions.push(torus.positions()[v as usize]);
                    positions.len() as u32 - 1
                })
            } else {
                v
            }
        })
    });
    let faces: Vec<_> = faces.collect();
    let open = TriMesh::new(positions, faces).unwrap();
    assert_eq!(open.seam_vertices(), 32);
    save(folder.path(), "open.ply", &open);
    let line = "smooth open.ply -o out.ply --force --method implicit";
    let output = fairing(folder.path(), line);
    assert!(output.status.success());
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(said.contains("32 boundary vertices") && said.contains("--weld"), "{said}");
    assert!(load(folder.path(), "out.ply").seam_vertices() < 32);
    run(folder.path(), &format!("{line} --weld"));
    assert_eq!(load(folder.path(), "out.ply").seam_vertices(), 32);
}

#[test]
fn a_tessellated_part_is_left_alone() {
    let folder = tempfile::tempdir().unwrap();
    let tube = shapes::cylinder(1.0, 2.0, 200, 1, shapes::Ends::Open);
    save(folder.path(), "tube.ply", &tube);
    let output = fairing(folder.path(), "denoise tube.ply -o out.ply --json");
    assert!(output.status.success());
    assert!(String::from_utf8(output.stderr).unwrap().contains("too uneven"));
    let summary: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(summary["kind"], "uneven");
    assert_eq!(
        load(folder.path(), "out.ply").positions(),
        load(folder.path(), "tube.ply").positions()
    );
}
