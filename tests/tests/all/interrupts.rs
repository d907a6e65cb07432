//! Ctrl-C while the `fairing` program works.

use std::fs;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use fairing_mesh::io;
use fairing_shapes as shapes;

use crate::command_line::{files, program};

/// The program ends within 100 ms on a free processor; the other tests use it as well.
const PATIENCE: Duration = Duration::from_millis(1000);

/// A folder with a noisy mesh of 163 842 vertices.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let sphere = shapes::jittered(&shapes::icosphere(7), 0.1, 1, |p| p);
    io::write(folder.path().join("sphere.ply"), &sphere).unwrap();
    folder
}

/// Starts the program with the signal as a terminal leaves it: jobs in the background ignore it.
fn start(folder: &Path, line: &str) -> Child {
    let mut command = Command::new("env");
    command.arg("--default-signal=INT").arg(program());
    command.args(line.split(' ')).current_dir(folder);
    command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap()
}

/// Interrupts the program, which must end in time, with the exit code of shells and one line.
fn interrupt(program: Child) {
    let start = Instant::now();
    let killed = Command::new("kill").args(["-INT", &program.id().to_string()]).status();
    assert!(killed.unwrap().success());
    let output = program.wait_with_output().unwrap();
    let error = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(130), "{error}");
    assert!(error.ends_with("interrupted\n"), "{error}");
    assert!(start.elapsed() < PATIENCE, "{:?}", start.elapsed());
}

#[test]
fn long_work_is_interrupted() {
    let folder = folder();
    let tube = shapes::cylinder(1.0, 0.01, 2000, 2, shapes::Ends::Open);
    io::write(folder.path().join("tube.ply"), &tube).unwrap();
    for line in [
        "denoise sphere.ply -o out.ply",
        "spectrum sphere.ply -k 1000 -o modes.npz",
        "smooth sphere.ply -o out.ply --method explicit --lambda 0.1 --iterations 10000000",
        "curvature sphere.ply -o out.ply --estimator normal-cycle --radius 30",
        // The time of a hole grows with the cube of its edges.
        "repair tube.ply -o out.ply --holes 2000",
    ] {
        let program = start(folder.path(), line);
        sleep(Duration::from_millis(500));
        interrupt(program);
        assert_eq!(files(folder.path()), ["sphere.ply", "tube.ply"], "{line}");
    }
}

#[test]
fn a_file_that_is_being_written_is_removed() {
    let folder = folder();
    let program = start(folder.path(), "convert sphere.ply out.obj.gz");
    let temporary = |name: &String| name.starts_with(".fairing-");
    // The first one is the check that the file can be written; the content follows after reading.
    let filled = || {
        let names = files(folder.path()).into_iter().filter(temporary);
        names.filter_map(|name| fs::metadata(folder.path().join(name)).ok()).any(|m| m.len() > 0)
    };
    let start = Instant::now();
    while !filled() {
        assert!(start.elapsed() < Duration::from_secs(60), "nothing is written");
    }
    interrupt(program);
    assert_eq!(files(folder.path()), ["sphere.ply"]);
}
