//! Only selected vertices move.

use std::path::Path;

use fairing_denoising::{AutomaticOptions, Denoiser, Masked, automatic};
use fairing_evaluation::{NoiseKind, NoiseLevel, add_noise};
use fairing_mesh::TriMesh;
use fairing_mesh::io::{self, VertexFields};
use fairing_shapes as shapes;

use crate::command_line::{refuse, run};

fn noisy(mesh: &TriMesh, level: f64) -> TriMesh {
    let level = NoiseLevel::EdgeLengths(level);
    add_noise(mesh, NoiseKind::GaussianAlongNormals, level, 3).unwrap()
}

/// A noisy sphere whose upper half is selected.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let sphere = shapes::icosphere(2);
    let upper = sphere.positions().iter().map(|p| p[2].max(-0.5)).collect();
    let noisy = noisy(&sphere, 0.2);
    let fields = VertexFields::default()
        .with_scalar("upper", upper)
        .with_scalar("none", vec![0.0; sphere.vertex_count()]);
    let path = folder.path().join("sphere.ply");
    io::write_with_fields(path, &noisy, &fields, &io::WriteOptions::default()).unwrap();
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
    lines.push("smooth --method region".to_owned());
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

#[test]
fn pins_of_denoisers_are_vertices_of_the_file() {
    let folder = folder();
    let command = "denoise sphere.ply -o out.ply --pin 3,7-9 --pin 80 --force -q";
    run(folder.path(), command);
    let read = |name| io::read(folder.path().join(name)).unwrap().mesh;
    let (old, new) = (read("sphere.ply"), read("out.ply"));
    let kept = |v: &usize| old.positions()[*v] == new.positions()[*v];
    let kept: Vec<usize> = (0..old.vertex_count()).filter(kept).collect();
    assert_eq!(kept, [3, 7, 8, 9, 80]);
    let said = refuse(folder.path(), "denoise sphere.ply -o none.ply --pin 162", 2);
    assert!(said.contains("--pin names vertex 162, but there are 162 vertices"), "{said}");
}

/// Fixed vertices keep their bits in every step, so that the result at the others is another one
/// than without them, unless a method looks at the noisy mesh only. Without fixed vertices the
/// result is that of the plain mesh.
#[test]
fn every_denoiser_holds_fixed_vertices() {
    let input = noisy(&shapes::cad_block(0.2), 0.3);
    let count = input.vertex_count();
    // One half, and pins in the other.
    let middle = input.positions().iter().map(|p| p[0]).sum::<f64>() / count as f64;
    let fixed: Vec<bool> =
        (0..count).map(|v| v % 7 == 0 || input.positions()[v][0] < middle).collect();
    let free = fixed.iter().filter(|fixed| !**fixed).count();
    assert!(5 * free > count && 5 * free < 4 * count, "{free} of {count}");
    for denoiser in Denoiser::all() {
        let plain = denoiser.denoise(&input).unwrap();
        let none = vec![false; count];
        assert_eq!(denoiser.denoise(Masked::new(&input, &none).unwrap()).unwrap(), plain);
        let part = denoiser.denoise(Masked::new(&input, &fixed).unwrap()).unwrap();
        let (mut moved, mut elsewhere) = (0, 0);
        for (v, &fixed) in fixed.iter().enumerate() {
            let at = |mesh: &TriMesh| mesh.positions()[v].map(f64::to_bits);
            assert!(!fixed || at(&part) == at(&input), "{denoiser}: vertex {v}");
            moved += usize::from(at(&part) != at(&input));
            elsewhere += usize::from(!fixed && at(&part) != at(&plain));
        }
        assert!(10 * moved > 9 * free, "{denoiser}: {moved} of {free}");
        assert_eq!(elsewhere > 0, denoiser.name() != "non-iterative", "{denoiser}: {elsewhere}");
    }
    let error = Masked::new(&input, &[true]).unwrap_err().to_string();
    assert!(error.contains("1, but must be the number of vertices"), "{error}");
}

/// On a sphere with noise at a fifth of the vertices, those are denoised as if all were noisy: the
/// clean ones, which are fixed, do not lower the noise level.
#[test]
fn the_noise_of_a_selection_is_measured_there() {
    let sphere = shapes::icosphere(4);
    let rough = noisy(&sphere, 0.3);
    let fixed: Vec<bool> = sphere.positions().iter().map(|p| p[2] < 0.6).collect();
    let positions = (0..fixed.len())
        .map(|v| if fixed[v] { sphere.positions()[v] } else { rough.positions()[v] });
    let input = sphere.with_positions(positions.collect()).unwrap();
    let masked = Masked::new(&input, &fixed).unwrap();
    let result = automatic(masked, &AutomaticOptions::default()).unwrap();
    let all = automatic(&rough, &AutomaticOptions::default()).unwrap();
    let [sigma, expected] = [&result, &all].map(|found| found.noise.unwrap().sigma);
    assert!((sigma / expected - 1.0).abs() < 0.15, "{sigma}, {expected}");
    // Distances from the sphere.
    let away = |mesh: &TriMesh| {
        let free = (0..fixed.len()).filter(|v| !fixed[*v]).map(|v| mesh.positions()[v]);
        free.map(|[x, y, z]| ((x * x + y * y + z * z).sqrt() - 1.0).powi(2)).sum::<f64>().sqrt()
    };
    let (before, after, usual) = (away(&input), away(&result.mesh), away(&all.mesh));
    assert!(after < 0.4 * before && after < 1.3 * usual, "{before} to {after}, {usual}");
}
