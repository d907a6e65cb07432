//! Numbers of instructions of the kernels, against those of the version that was last accepted.
//!
//! A count does not depend on the load of the machine, as times do. It needs valgrind on a 64-bit
//! Intel or AMD processor; otherwise each test is listed by name as ignored.

use std::path::Path;
use std::process::Command;

use anyhow::{Context as _, Result, ensure};
use fairing_evaluation::{NoiseKind, NoiseLevel, add_noise};
use fairing_shapes::torus;
use libtest_mimic::{Arguments, Failed, Trial};

/// Millions of instructions of one run on a torus of 5120 vertices with noise, one thread.
const ACCEPTED: [(&str, f64); 7] = [
    ("load_obj", 10.0),
    ("laplacian", 11.7),
    ("curvature", 17.5),
    ("explicit_uniform", 19.0),
    ("implicit_uniform", 25.9),
    ("implicit_cotan", 87.6),
    ("factor", 76.4),
];
/// Other compilers may differ by less.
const MORE: f64 = 1.15;
/// A count below this share of the accepted one has to be accepted itself.
const LESS: f64 = 0.7;

fn main() {
    let version = Command::new("valgrind").arg("--version").output();
    let absent =
        !cfg!(target_arch = "x86_64") || !version.is_ok_and(|output| output.status.success());
    let trials = ACCEPTED.map(|(task, accepted)| {
        let test = move || compare(task, accepted).map_err(|e| Failed::from(format!("{e:#}")));
        Trial::test(task, test).with_kind("valgrind").with_ignored_flag(absent)
    });
    libtest_mimic::run(&Arguments::from_args(), trials.into()).exit();
}

fn compare(task: &str, accepted: f64) -> Result<()> {
    let folder = tempfile::tempdir()?;
    let path = folder.path().join("torus.obj");
    let noise = NoiseLevel::EdgeLengths(0.05);
    let mesh = add_noise(&torus(1.0, 0.4, 80, 64), NoiseKind::GaussianAlongNormals, noise, 1)?;
    fairing_mesh::io::write(&path, &mesh)?;
    // The difference leaves out reading and the start of the process.
    let millions = (count(task, &path, 2)? - count(task, &path, 1)?) / 1e6;
    ensure!(
        millions < MORE * accepted,
        "{task} takes {millions:.1} million instructions, {accepted} were accepted"
    );
    ensure!(
        millions > LESS * accepted,
        "{task} takes only {millions:.1} million instructions: accept them instead of {accepted}"
    );
    Ok(())
}

/// Instructions of a process that runs the task `repeat` times.
fn count(task: &str, mesh: &Path, repeat: usize) -> Result<f64> {
    let output = Command::new("valgrind")
        .args(["--tool=callgrind", "--callgrind-out-file=/dev/null"])
        .arg(env!("CARGO_BIN_EXE_bench"))
        .args([task, "--threads=1", &format!("--repeat={repeat}")])
        .arg("--in")
        .arg(mesh)
        .output()?;
    let text = String::from_utf8_lossy(&output.stderr);
    ensure!(output.status.success(), "{task} failed: {text}");
    let collected = text.lines().find_map(|line| line.split_once("Collected :"));
    let (_, number) = collected.with_context(|| format!("no count in: {text}"))?;
    Ok(number.trim().parse()?)
}
