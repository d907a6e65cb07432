//! Only selected vertices move.

use std::path::Path;

use fairing_mesh::io::{self, VertexFields};
use fairing_shapes as shapes;

use crate::command_line::{refuse, run};

/// A noisy sphere whose upper half is selected.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let sphere = shapes::icosphere(2);
    let upper = sphere.positions().iter().map(|p| p[2].max(-0.5)).collect();
    let noisy = fairing_evaluation::add_noise(
        &sphere,
        fairing_evaluation::NoiseKind::GaussianAlongNormals,
        fairing_evaluation::NoiseLevel::EdgeLengths(0.2),
        3,
    );
    let fields = VertexFields::default()
        .with_scalar("upper", upper)
        .with_scalar("none", vec![0.0; sphere.vertex_count()]);
    let path = folder.path().join("sphere.ply");
    io::write_with_fields(path, &noisy.unwrap(), &fields, &io::WriteOptions::default()).unwrap();
    folder
}

/// The number of selected vertices that moved; the others must not have.
fn moved(folder: &Path) -> usize {
    let [old, new] = ["sphere.ply", "out.ply"].map(|name| io::read(folder.join(name)).unwrap());
    let upper = old.fields.scalar("upper").unwrap();
    let pairs = old.mesh.positions().iter().zip(new.mesh.positions());
    let mut count = 0;
    for ((p, q), selected) in pairs.zip(upper) {
        assert!(*selected > 0.0 || p == q, "{p:?} {q:?}");
        count += usize::from(p != q);
    }
    count
}

#[test]
fn every_flow_denoiser_and_noise_moves_the_selected_vertices_only() {
    let folder = folder();
    let names = |verb: &str| -> Vec<String> {
        let list = run(folder.path(), &format!("{verb} --list"));
        let names = list.lines().filter(|line| !line.starts_with(' '));
        names.map(|line| line.split(':').next().unwrap().to_owned()).collect()
    };
    let (flows, denoisers) = (names("smooth"), names("denoise"));
    assert!(flows.len() >= 9 && denoisers.len() >= 8, "{flows:?} {denoisers:?}");
    let mut lines: Vec<String> = flows
        .iter()
        .map(|name| match name.as_str() {
            "region" => "smooth --method region --vertices 0-99".to_owned(),
            "low-pass" => "smooth --method low-pass --modes 40".to_owned(),
            name => format!("smooth --method {name}"),
        })
        .collect();
    lines.push("smooth --method low-pass --time 0.01".to_owned());
    lines.push("smooth --method implicit --volume offset --pin 0-20".to_owned());
    lines.extend(denoisers.iter().map(|name| format!("denoise --method {name}")));
    lines.push("noise --sigma 0.1".to_owned());
    for line in lines {
        run(folder.path(), &format!("{line} sphere.ply -o out.ply --where upper --force -q"));
        assert!(moved(folder.path()) > 20, "{line}");
    }
}

#[test]
fn a_mask_names_a_property_that_selects_something() {
    let folder = folder();
    let said = refuse(folder.path(), "denoise sphere.ply -o out.ply --where lower", 2);
    assert!(said.contains("no field lower; the file has upper, none"), "{said}");
    let said = refuse(folder.path(), "noise sphere.ply -o out.ply --sigma 1 --where none", 2);
    assert!(said.contains("none is above zero at no vertex"), "{said}");
}
