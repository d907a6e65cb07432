//! Files of the program: checks before the work, links, broken meshes, undefined values.

use std::path::Path;

use fairing_mesh::{TriMesh, io};
use fairing_shapes as shapes;
use serde_json::Value;

use crate::command_line::{fairing, refuse, run};

fn folder_with_torus() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    io::write(folder.path().join("torus.ply"), &shapes::torus(3.0, 1.0, 24, 12)).unwrap();
    folder
}

/// The verbs that write, each with a valid output.
const WRITERS: [(&str, &str); 11] = [
    ("convert torus.ply", "a.obj"),
    ("repair torus.ply -o", "a.off"),
    ("geodesic torus.ply --from 0 -o", "a.ply"),
    ("curvature torus.ply -o", "a.ply"),
    ("spectrum torus.ply -k 3 -o", "a.npz"),
    ("reconstruct torus.ply -k 3 -o", "a.obj"),
    ("smooth torus.ply -o", "a.off"),
    ("noise torus.ply --sigma 0.1 -o", "a.ply"),
    ("scan torus.ply --size 40x30 -o", "a.ply"),
    ("denoise torus.ply -o", "a.stl"),
    ("render torus.ply --size 40x30 -o", "a.png"),
];

/// The input does not exist, so a verb that checks its output first fails for the output.
#[test]
fn outputs_are_checked_before_anything_is_read() {
    let folder = folder_with_torus();
    let place = folder.path();
    std::fs::create_dir(place.join("folder")).unwrap();
    for (verb, output) in WRITERS {
        let verb = verb.replace("torus", "absent");
        let extension = output.strip_prefix('a').unwrap();
        std::fs::create_dir_all(place.join(format!("is-folder{extension}"))).unwrap();
        for (wrong, said) in [
            ("a.txt".to_owned(), "extension must be"),
            ("a".to_owned(), "extension must be"),
            (format!("nowhere/a{extension}"), "there is no folder nowhere"),
            (format!("torus.ply/a{extension}"), "there is no folder torus.ply"),
            (format!("is-folder{extension}"), "it is a folder"),
        ] {
            for force in ["", " --force"] {
                let error = refuse(place, &format!("{verb} {wrong}{force}"), 4);
                assert!(error.contains(said) && error.contains(&wrong), "{verb} {wrong}: {error}");
            }
        }
        refuse(place, &format!("{verb} {output}"), 3);
    }
    let error = refuse(place, "render absent.ply -o s.jpg", 4);
    assert!(error.contains(".png"), "{error}");
    for format in ["stl", "obj", "off", "obj.gz"] {
        let error = refuse(place, &format!("curvature absent.ply -o a.{format}"), 4);
        assert!(error.contains("holds no fields; write PLY"), "{error}");
    }
    run(place, "--quiet curvature torus.ply -o curved.ply.gz");
    assert!(io::read(place.join("curved.ply.gz")).unwrap().fields.scalar("mean").is_some());
}

/// Points are described and converted; other verbs name what is missing.
#[test]
fn points_are_described_and_converted() {
    let folder = folder_with_torus();
    let place = folder.path();
    let torus = io::read(place.join("torus.ply")).unwrap().mesh;
    let points = TriMesh::new(torus.positions().to_vec(), vec![]).unwrap();
    io::write(place.join("points.ply"), &points).unwrap();
    for (from, to) in [("points.ply", "points.obj"), ("points.obj", "torus-points.ply")] {
        run(place, &format!("--quiet convert {from} {to}"));
        let info: Value = serde_json::from_str(&run(place, &format!("info {to} --json"))).unwrap();
        assert_eq!((&info["vertices"], &info["faces"]), (&288.into(), &0.into()));
        assert!(["closed", "manifold", "area"].iter().all(|name| info[name].is_null()), "{info}");
        let text = run(place, &format!("info {to}"));
        let has_row = |name: &str| text.lines().any(|line| line.starts_with(name));
        assert!(has_row("duplicate positions") && has_row("lowest corner"), "{text}");
        assert!(!["edges", "genus", "closed", "mean edge"].into_iter().any(has_row), "{text}");
        let needs_faces = |verb: &str| !verb.starts_with("convert") && !verb.starts_with("repair");
        for (verb, output) in WRITERS.into_iter().filter(|(verb, _)| needs_faces(verb)) {
            let error = refuse(place, &format!("{} {output}", verb.replace("torus.ply", to)), 3);
            assert!(error.contains("288 points without faces"), "{verb}: {error}");
        }
    }
    assert!(refuse(place, "geodesic points.obj --from 0 -o a.ply", 3).contains("points without"));
    run(place, "--quiet repair points.obj -o repaired.ply");
}

/// A component limit above the size of every component leaves nothing, and the error names it.
#[test]
fn a_repair_that_would_leave_nothing_fails() {
    let folder = folder_with_torus();
    let error = refuse(folder.path(), "repair torus.ply -o a.ply --components 1000", 1);
    assert!(error.contains("no face would be left: --components drops 576"), "{error}");
    assert!(!folder.path().join("a.ply").exists());
}

/// Remarks on a file are lines that begin with its name.
#[test]
fn each_remark_names_its_file() {
    let folder = tempfile::tempdir().unwrap();
    let quad = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\nf 1 2 1\n";
    for name in ["a.obj", "b.obj"] {
        std::fs::write(folder.path().join(name), quad).unwrap();
    }
    let said = fairing(folder.path(), "repair a.obj b.obj -o {stem}.ply").stderr;
    let said = String::from_utf8(said).unwrap();
    for name in ["a.obj", "b.obj"] {
        for remark in ["1 face has more than three corners", "1 face repeats a corner"] {
            let line = format!("{name}: {remark}");
            assert!(said.lines().any(|said| said.starts_with(&line)), "{line}: {said}");
        }
    }
}

/// Every document that lists formats names all of them.
#[test]
fn documents_name_every_format() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    for document in
        ["README.md", "CHANGELOG.md", "crates/mesh/README.md", "python/pyfairing/_mesh.py"]
    {
        let text = std::fs::read_to_string(root.join(document)).unwrap();
        for format in io::Format::ALL {
            assert!(text.contains(format.name()), "{document} does not name {format}");
        }
    }
}

/// Every verb writes through a link, and the link stays.
#[cfg(unix)]
#[test]
fn links_are_written_through() {
    let folder = folder_with_torus();
    let place = folder.path();
    std::fs::create_dir(place.join("deep")).unwrap();
    for (verb, output) in WRITERS {
        let (link, real) = (place.join(output), place.join("deep").join(output));
        let _ = std::fs::remove_file(&link);
        std::fs::write(&real, "old").unwrap();
        std::os::unix::fs::symlink(Path::new("deep").join(output), &link).unwrap();
        refuse(place, &format!("{verb} {output}"), 4);
        run(place, &format!("--quiet {verb} {output} --force"));
        assert!(link.is_symlink(), "{verb}");
        assert!(std::fs::metadata(&real).unwrap().len() > 100, "{verb}");
    }
    let left = std::fs::read_dir(place.join("deep")).unwrap().count();
    assert_eq!(left, 6, "one of each kind, and nothing else");
}

/// A torus with two vertices that are not finite, one of them without faces.
#[test]
fn broken_meshes_are_read_by_every_verb_on_request() {
    let folder = folder_with_torus();
    let place = folder.path();
    run(place, "convert torus.ply torus.obj");
    let text = std::fs::read_to_string(place.join("torus.obj")).unwrap();
    let unused = text.replacen("\nf ", "\nv nan 0 0\nf ", 1);
    std::fs::write(place.join("unused.obj"), &unused).unwrap();
    std::fs::write(place.join("used.obj"), unused + "f 1 2 289\nf 1 2 999\n").unwrap();
    for file in ["unused", "used"] {
        for (verb, output) in WRITERS {
            let line =
                format!("{} {output} --force", verb.replace("torus.ply", &format!("{file}.obj")));
            let error = refuse(place, &line, 3);
            assert!(error.contains("NaN") && error.contains("--drop-broken"), "{error}");
            let done = fairing(place, &format!("{line} --drop-broken"));
            let said = String::from_utf8(done.stderr).unwrap();
            assert!(done.status.success(), "{line}: {said}");
            assert!(said.contains("1 vertex is not finite"), "{line}: {said}");
            assert_eq!(said.contains("2 faces are left out"), file == "used", "{said}");
        }
        let line = format!("info {file}.obj --json");
        refuse(place, &line, 3);
        let info: Value =
            serde_json::from_str(&run(place, &format!("{line} --drop-broken"))).unwrap();
        assert_eq!((&info["vertices"], &info["faces"]), (&289.into(), &576.into()));
        assert_eq!(info["file"]["broken_vertices"], 1);
        assert_eq!(info["file"]["broken_faces"], if file == "used" { 2 } else { 0 });
        let line = format!("compare {file}.obj {file}.obj --drop-broken --json");
        run(place, &line);
    }
    // Numbers are those of the file, and the bounding box that of the sound vertices.
    run(place, "--quiet convert used.obj sound.ply --drop-broken");
    let [sound, torus] =
        ["sound.ply", "torus.ply"].map(|name| io::read(place.join(name)).unwrap().mesh);
    assert_eq!(sound.faces(), torus.faces());
    assert_eq!(sound.positions()[..288], torus.positions()[..]);
    assert_eq!(sound.positions()[288], torus.positions()[0]);
    refuse(place, "convert used.obj b.ply --drop-broken --strict", 2);
}

/// Half of the vertices of an open strip and an isolated vertex have no curvature; they do not
/// affect the colours.
#[test]
fn undefined_values_are_grey_and_said() {
    let folder = folder_with_torus();
    let place = folder.path();
    run(place, "convert torus.ply torus.obj");
    let text = std::fs::read_to_string(place.join("torus.obj")).unwrap();
    let lone = "\nv 20 0 0\nv 21 0 0\nv 20 1 0\nv 30 0 0\nf 289 290 291\nf ";
    std::fs::write(place.join("with.obj"), text.replacen("\nf ", lone, 1)).unwrap();
    let line = "--quiet curvature with.obj -o curved.ply --estimator jet3 --json";
    let summary = run(place, line);
    let summary: Value = serde_json::from_str(&summary).unwrap();
    assert_eq!(summary["undefined"], 4);
    let reasons = summary["undefined_because"].as_object().unwrap();
    assert_eq!(reasons.values().map(|n| n.as_u64().unwrap()).sum::<u64>(), 4);
    run(place, "--quiet curvature torus.ply -o plain.ply --estimator jet3");
    let drawn = |file: &str, field: &str| {
        fairing(place, &format!("render {file} -o a.png --force --size 40x30 --field {field}"))
    };
    for field in ["mean", "gaussian", "kappa2", "direction1"] {
        let [all, plain] = ["curved.ply", "plain.ply"].map(|file| drawn(file, field));
        assert!(all.status.success());
        // The length of a vector is 1 or 0.
        assert_eq!(all.stdout, plain.stdout, "{field}: the same range as without them");
        let said = String::from_utf8(all.stderr).unwrap();
        assert!(said.contains("undefined at 4 of 292 vertices"), "{said}");
        assert!(plain.stderr.is_empty());
    }
    let flags = String::from_utf8(drawn("curved.ply", "defined").stdout).unwrap();
    assert!(flags.contains("defined"), "{flags}");
    // Separate triangles only: no vertex has curvature.
    let soup = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 5 5 5\nv 6 5 5\nv 5 6 5\nf 1 2 3\nf 4 5 6\n";
    std::fs::write(place.join("soup.obj"), soup).unwrap();
    let said = fairing(place, "curvature soup.obj -o soup.ply --estimator jet3");
    let said = String::from_utf8(said.stderr).unwrap();
    assert!(said.contains("undefined at 6 of 6 vertices (too few neighbours: 6)"), "{said}");
    let error = refuse(place, "render soup.ply -o b.png --field mean", 1);
    assert!(error.contains("undefined everywhere"), "{error}");
    assert!(!place.join("b.png").exists());
}
