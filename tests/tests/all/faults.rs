//! Faults of the machine: full disks, read-only folders, files that change, too little memory.

use std::fs::{self, File, OpenOptions, Permissions};
use std::io::Write as _;
use std::os::unix::fs::PermissionsExt as _;
use std::path::Path;
use std::process::{Command, Output};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use fairing_mesh::io;
use fairing_shapes as shapes;

use crate::command_line::{fairing, files, program, refuse};

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
    for line in ["info sphere.ply", "convert sphere.ply -o - --to obj", "info sphere.ply --json"] {
        let output = in_shell(folder.path(), ":", line, "> /dev/full");
        let error = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(4), "{line}: {error}");
        assert!(error.contains("error: standard output: "), "{line}: {error}");
        assert!(error.contains("No space left"), "{line}: {error}");
    }
}

/// The limit of the size of files stops writing in the middle, as a full disk does.
#[test]
fn a_full_disk_leaves_the_old_file() {
    let folder = folder();
    fs::write(folder.path().join("old.ply"), "old").unwrap();
    for line in [
        "repair sphere.ply -o new.ply",
        "smooth sphere.ply -o new.obj",
        "convert sphere.ply new.stl",
        "convert sphere.ply new.vtp",
        "noise sphere.ply --sigma 0.1 -o old.ply --force",
    ] {
        // In blocks of 512 bytes.
        let output = in_shell(folder.path(), "trap '' XFSZ; ulimit -f 200", line, "");
        let error = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(4), "{line}: {error}");
        assert!(error.contains("File too large"), "{line}: {error}");
        assert_eq!(files(folder.path()), ["old.ply", "sphere.ply"], "{line}");
    }
    assert_eq!(fs::read_to_string(folder.path().join("old.ply")).unwrap(), "old");
}

/// A folder that root can write to all the same, so that root skips this.
#[test]
fn a_read_only_folder_is_refused_before_the_work() {
    let folder = folder();
    let place = folder.path().join("locked");
    fs::create_dir(&place).unwrap();
    fs::set_permissions(&place, Permissions::from_mode(0o555)).unwrap();
    if File::create(place.join("probe")).is_ok() {
        eprintln!("skipped: this user can write to read-only folders");
        return;
    }
    // The input does not exist: its error would have the code 3.
    for line in ["repair absent.ply -o locked/a.ply", "render absent.ply -o locked/a.png"] {
        let error = refuse(folder.path(), line, 4);
        assert!(error.contains("locked/a.p") && error.contains("ermission"), "{error}");
    }
    assert_eq!(files(&place), [""; 0]);
}

/// Sets a flag when dropped, also in a panic, so that no thread waits for the flag for ever.
struct Done<'a>(&'a AtomicBool);

impl Drop for Done<'_> {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Relaxed);
    }
}

#[test]
fn a_file_that_changes_while_it_is_read_is_an_error() {
    let folder = folder();
    let path = folder.path().join("growing.obj");
    io::write(&path, &shapes::icosphere(7)).unwrap();
    let done = AtomicBool::new(false);
    let error = std::thread::scope(|scope| {
        let _done = Done(&done);
        scope.spawn(|| {
            let mut file = OpenOptions::new().append(true).open(&path).unwrap();
            while !done.load(Ordering::Relaxed) {
                file.write_all(b"# one more line\n").unwrap();
                std::thread::sleep(Duration::from_micros(200));
            }
        });
        // On a busy machine the writer may be suspended during the whole reading.
        (0..20).find_map(|_| {
            let output = fairing(folder.path(), "repair growing.obj -o out.ply");
            if output.status.success() {
                fs::remove_file(folder.path().join("out.ply")).map(|()| None).unwrap()
            } else {
                Some((output.status.code(), String::from_utf8(output.stderr).unwrap()))
            }
        })
    });
    let (code, error) = error.expect("the file has changed");
    assert_eq!(code, Some(3), "{error}");
    assert!(error.contains("growing.obj") && error.contains("changed"), "{error}");
    assert_eq!(files(folder.path()), ["growing.obj", "sphere.ply"]);
}

/// A file longer than the limit of the reader, and a stream that outgrows the address space.
#[test]
fn files_without_end_are_refused() {
    let folder = folder();
    // A hole of a terabyte.
    File::create(folder.path().join("huge.obj")).unwrap().set_len(1 << 40).unwrap();
    let error = refuse(folder.path(), "info huge.obj", 3);
    assert!(error.contains("huge.obj: there are more than"), "{error}");
    fs::remove_file(folder.path().join("huge.obj")).unwrap();
    // A stream without end.
    let output = in_shell(folder.path(), "ulimit -v 1000000", "info /dev/zero", "");
    let error = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(3), "{error}");
    assert!(error.contains("/dev/zero: ") && error.contains("memory"), "{error}");
    assert_eq!(files(folder.path()), ["sphere.ply"]);
}
