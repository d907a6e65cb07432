//! Faults of the machine: full disks, too little memory.

use std::fs::{self, File};
use std::path::Path;
use std::process::{Command, Output};

use fairing_mesh::io;
use fairing_shapes as shapes;

use crate::command_line::{files, program, refuse};

/// A folder with a mesh of 10 242 vertices.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    io::write(folder.path().join("sphere.ply"), &shapes::icosphere(5)).unwrap();
    folder
}

/// Runs the program in a shell, after a command and before a redirection.
fn in_shell(folder: &Path, before: &str, line: &str, after: &str) -> Output {
    let line = format!("{before}; exec \"$0\" {line} {after}");
    let mut shell = Command::new("sh");
    shell.args(["-c", &line]).arg(program()).current_dir(folder).output().unwrap()
}

#[test]
fn a_full_standard_output_is_an_error() {
    let folder = folder();
    for line in
        ["info sphere.ply", "convert sphere.ply -o - --format obj", "info sphere.ply --json"]
    {
        let output = in_shell(folder.path(), ":", line, "> /dev/full");
        let error = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(4), "{line}: {error}");
        assert!(error.contains("error: standard output: "), "{line}: {error}");
        assert!(error.contains("No space left"), "{line}: {error}");
    }
}

/// The limit of the address space, which holds as well as that of the machine.
#[test]
fn what_does_not_fit_is_refused_before_it_is_tried() {
    let folder = folder();
    for verb in ["spectrum sphere.ply -o modes.npz", "reconstruct sphere.ply -o out.ply"] {
        let line = format!("{verb} -k 10000 --threads 1");
        let output = in_shell(folder.path(), "ulimit -v 1500000", &line, "");
        let error = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(1), "{line}: {error}");
        assert!(error.contains("need at least 1664 MB of memory"), "{line}: {error}");
    }
    // A hole of a terabyte.
    File::create(folder.path().join("huge.obj")).unwrap().set_len(1 << 40).unwrap();
    let error = refuse(folder.path(), "info huge.obj", 3);
    assert!(error.contains("huge.obj: the mesh does not fit into memory"), "{error}");
    fs::remove_file(folder.path().join("huge.obj")).unwrap();
    // A stream without end.
    let output = in_shell(folder.path(), "ulimit -v 1000000", "info /dev/zero", "");
    let error = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(3), "{error}");
    assert!(error.contains("/dev/zero: ") && error.contains("memory"), "{error}");
    assert_eq!(files(folder.path()), ["sphere.ply"]);
}
