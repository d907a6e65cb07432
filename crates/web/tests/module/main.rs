//! The module in Node, against the same requests answered without WebAssembly.
//!
//! Needs Node on the path and a module: the committed one, or the one that the variable
//! `FAIRING_WEB_MODULE` names. Otherwise each test is listed by name as ignored.

mod cases;
mod module;

use std::path::PathBuf;
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
    let others: [(&str, Test); 4] = [
        ("meshes_survive_cancelling_and_defects", cases::client),
        ("errors_leave_the_session_intact", cases::errors),
        ("memory_stays_flat", cases::flat),
        ("random_bytes_are_refused_in_words", cases::random),
    ];
    let others = others.map(|(name, test)| trial(name.to_owned(), Box::new(test)));
    libtest_mimic::run(&Arguments::from_args(), meshes.chain(others).collect()).exit();
}
