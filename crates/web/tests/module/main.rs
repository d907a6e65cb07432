//! The module in Node, against the same requests answered without WebAssembly.
//!
//! Needs Node on the path and a module: the committed one, or the one that the variable
//! `FAIRING_WEB_MODULE` names. Otherwise each test is listed by name as ignored, as is the test of
//! real meshes unless `FAIRING_MESHES` names their folder.

mod cases;
mod files;
mod module;

use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::Result;
use libtest_mimic::{Arguments, Failed, Trial};

/// A test that takes the path of a module.
type Test = fn(PathBuf) -> Result<()>;

fn main() {
    let path = std::env::var_os("FAIRING_WEB_MODULE").map(PathBuf::from);
    let path = path.unwrap_or_else(|| {
        PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("assets/fairing.wasm.gz")
    });
    let node = Command::new("node").arg("--version").output();
    let absent = !path.is_file() || !node.is_ok_and(|output| output.status.success());
    let trial = |name: String, test: Box<dyn FnOnce(PathBuf) -> Result<()> + Send>| {
        let path = path.clone();
        Trial::test(name, move || test(path).map_err(|e| Failed::from(format!("{e:#}"))))
            .with_kind("node")
            .with_ignored_flag(absent)
    };
    let meshes = cases::meshes().into_iter().map(|(name, mesh)| {
        trial(format!("same_answers::{name}"), Box::new(move |path| cases::same(&path, &mesh)))
    });
    let others: [(&str, Test); 6] = [
        ("meshes_survive_cancelling_and_defects", cases::client),
        ("errors_leave_the_session_intact", cases::errors),
        ("memory_stays_flat", cases::flat),
        ("random_bytes_are_refused_in_words", files::random),
        ("damaged_files_are_read_or_refused_in_words", files::damaged),
        ("every_real_mesh_is_read_or_refused_in_words", files::corpus),
    ];
    let corpus =
        std::env::var_os("FAIRING_MESHES").is_some_and(|folder| Path::new(&folder).is_dir());
    let others = others.map(|(name, test)| {
        let needs = name.starts_with("every_real_mesh");
        trial(name.to_owned(), Box::new(test)).with_ignored_flag(absent || (needs && !corpus))
    });
    libtest_mimic::run(&Arguments::from_args(), meshes.chain(others).collect()).exit();
}
