//! A folder of forty scans, ten of them broken, through `repair`, `denoise` and `info`.

use std::fs;
use std::path::Path;
use std::process::Output;

use fairing_mesh::io::{self, VertexFields, WriteOptions};
use fairing_mesh::{Diagnosis, TriMesh};
use fairing_shapes as shapes;

use crate::command_line::{fairing, files, run};
use crate::ugly_files::{soup, with_turned_faces};

/// The number of broken files.
const BROKEN: usize = 10;

/// Thirty meshes: six shapes, each with noise and with one of four defects that repair mends.
fn write_sound(folder: &Path) {
    let meshes = [
        ("sphere", shapes::bumpy_sphere(3, 0.1, 3.0)),
        ("torus", shapes::torus(3.0, 1.0, 40, 20)),
        ("block", shapes::cad_block(0.25)),
        ("tube", shapes::cylinder(1.0, 2.0, 24, 12, shapes::Ends::Closed)),
        ("flower", shapes::flower(0.08, 1)),
        ("plane", shapes::jittered_plane(16, 12, 0.1, 2)),
    ];
    for (name, mesh) in &meshes {
        let shaken = |(v, p): (usize, &[f64; 3])| {
            let step = 0.05 * mesh.mean_edge_length();
            [0, 1, 2].map(|k| p[k] + step * (((7 * v + 5 * k) % 11) as f64 / 5.0 - 1.0))
        };
        let positions = mesh.positions().iter().enumerate().map(shaken).collect();
        let mesh = mesh.with_positions(positions).unwrap();
        let save = |end: &str, mesh: &TriMesh| {
            io::write(folder.join(format!("{name}{end}")), mesh).unwrap();
        };
        save(".stl", &mesh);
        save("-soup.obj", &soup(&with_turned_faces(&mesh)));
        save("-inside-out.ply.gz", &with_faces(&mesh, |[a, b, c]| vec![[b, a, c]]));
        save("-doubled.off", &with_faces(&mesh, |face| vec![face; 1 + (face[0] as usize % 5) / 4]));
        let holes = with_faces(&mesh, |face| {
            if face.contains(&17) || face.contains(&99) { vec![] } else { vec![face] }
        });
        let height = holes.positions().iter().map(|p| p[2]).collect();
        let fields = VertexFields::default().with_scalar("height", height);
        let path = folder.join(format!("{name}-holes.ply"));
        io::write_with_fields(path, &holes, &fields, &WriteOptions::default()).unwrap();
    }
}

fn with_faces(mesh: &TriMesh, replace: impl Fn([u32; 3]) -> Vec<[u32; 3]>) -> TriMesh {
    let faces = mesh.faces().iter().flat_map(|&face| replace(face)).collect();
    TriMesh::new(mesh.positions().to_vec(), faces).unwrap()
}

/// Files that cannot be read as meshes.
fn write_broken(folder: &Path) {
    let bytes = |name: &str| fs::read(folder.join(name)).unwrap();
    let half = |name: &str| bytes(name)[..bytes(name).len() / 2].to_vec();
    let triangle = |third: &str| format!("v 0 0 0\nv 1 0 0\nv {third}\nf 1 2 3\n");
    let garbage: Vec<u8> = (0..3000_u32).map(|i| ((i * i * 31) >> 3) as u8).collect();
    let broken = [
        ("bad-cut-ply.ply", half("sphere-holes.ply")),
        ("bad-cut-stl.stl", half("sphere.stl")),
        ("bad-cut-gz.ply.gz", half("sphere-inside-out.ply.gz")),
        ("bad-garbage-obj.obj", garbage.clone()),
        ("bad-garbage-stl.stl", garbage),
        ("bad-nan.obj", triangle("nan 0 0").into_bytes()),
        ("bad-infinite.obj", triangle("0 1e999 0").into_bytes()),
        ("bad-index.obj", triangle("0 1 0").replace("2 3", "2 9").into_bytes()),
        ("bad-empty.off", vec![]),
        ("bad-name.ply", bytes("torus.stl")),
    ];
    assert_eq!(broken.len(), BROKEN);
    for (name, bytes) in broken {
        fs::write(folder.join(name), bytes).unwrap();
    }
}

/// Checks that exactly the broken files were reported; returns the rows of the table.
fn rows(output: Output, names: &[String]) -> Vec<String> {
    let error = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(3), "{error}");
    assert!(error.ends_with(&format!("error: {BROKEN} of {} files failed\n", names.len())));
    let table = String::from_utf8(output.stdout).unwrap();
    let rows: Vec<String> = table.lines().map(str::to_owned).collect();
    assert_eq!(rows.len(), names.len() + 1, "{table}");
    let columns = rows[0].split(',').count();
    for (row, name) in rows[1..].iter().zip(names) {
        let broken = name.contains("bad-");
        assert!(row.starts_with(&format!("{name},")), "{row}");
        assert_eq!(error.contains(&format!("error: {name}")), broken, "{name}: {error}");
        // Values of a sound file, or the error at the end.
        assert_eq!(row.ends_with(','), !broken, "{row}");
        assert!(broken || row.split(',').count() == columns, "{row}");
    }
    rows
}

#[test]
fn a_folder_of_scans_is_repaired_denoised_and_measured() {
    let folder = tempfile::tempdir().unwrap();
    let place = |name: &str| folder.path().join(name);
    for name in ["scans", "clean", "smooth"] {
        fs::create_dir(place(name)).unwrap();
    }
    write_sound(&place("scans"));
    write_broken(&place("scans"));
    let scans: Vec<String> =
        files(&place("scans")).iter().map(|name| format!("scans/{name}")).collect();
    assert_eq!(scans.len(), 40);
    let all = scans.join(" ");

    let line = format!("repair {all} -o clean/{{stem}}.ply --holes 12 --jobs 2 --table=csv");
    let repaired = rows(fairing(folder.path(), &line), &scans);
    assert!(repaired[0].starts_with("path,unchanged,vertices,faces,merged-vertices,"));
    let clean = files(&place("clean"));
    assert_eq!(clean.len(), 30, "{clean:?}");
    for name in &clean {
        let diagnosis = Diagnosis::new(&io::read(place("clean").join(name)).unwrap().mesh);
        assert!(diagnosis.is_clean() && diagnosis.boundary_loops < 2, "{name}: {diagnosis:?}");
        assert!(diagnosis.volume.is_none_or(|volume| volume > 0.0), "{name}");
    }
    let again = format!("repair clean/{} --dry-run --holes 12 --table", clean.join(" clean/"));
    let again = run(folder.path(), &again);
    for row in again.lines().skip(1) {
        assert_eq!(row.split_whitespace().nth(1), Some("yes"), "changed again: {row}");
    }

    // The repaired files, and the broken ones once more.
    let inputs: Vec<String> = (clean.iter().map(|name| format!("clean/{name}")))
        .chain(scans.iter().filter(|name| name.contains("bad-")).cloned())
        .collect();
    let all = inputs.join(" ");
    let line = format!("denoise {all} -o smooth/{{stem}}.ply --jobs 2 --table=csv");
    rows(fairing(folder.path(), &line), &inputs);
    assert_eq!(files(&place("smooth")), clean);
    for name in &clean {
        let [before, after] =
            ["clean", "smooth"].map(|folder| io::read(place(folder).join(name)).unwrap());
        assert_eq!(after.mesh.faces(), before.mesh.faces());
        assert_eq!(after.fields.scalar("height"), before.fields.scalar("height"));
    }

    let inputs: Vec<String> = inputs.iter().map(|name| name.replace("clean/", "smooth/")).collect();
    let all = inputs.join(" ");
    let info = rows(fairing(folder.path(), &format!("info {all} --table=csv")), &inputs);
    assert!(info[0].contains(",volume,") && info[0].ends_with(",error"), "{}", info[0]);
}
