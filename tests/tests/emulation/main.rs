//! The `fairing` program on other processors, emulated by `qemu-x86_64`.
//!
//! `docs/conventions.md` has the guarantees, under "Randomness and processors". If the emulator is
//! not on the path, each test is listed by name as ignored. The emulator has no AVX-512: a machine
//! that has it compares the others with itself.

mod cases;
mod near;

use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::{Arc, OnceLock};

use anyhow::{Context as _, Result, ensure};
use fairing_evaluation::{NoiseKind, NoiseLevel, add_noise};
use fairing_mesh::io;
use fairing_shapes as shapes;
use libtest_mimic::{Arguments, Failed, Trial};

use cases::{Case, Promise, cases};

const EMULATOR: &str = "qemu-x86_64";

/// SSE4.2 without AVX and fused multiply-add; AVX2 with fused multiply-add.
const PROCESSORS: [&str; 2] = ["Nehalem", "Haswell"];

fn main() {
    let emulator = std::env::split_paths(&std::env::var_os("PATH").unwrap_or_default())
        .map(|folder| folder.join(EMULATOR))
        .find(|path| path.is_file());
    let session: Arc<OnceLock<std::result::Result<Session, String>>> = Arc::default();
    let trials = PROCESSORS.into_iter().flat_map(|processor| {
        let (emulator, session) = (emulator.clone(), Arc::clone(&session));
        cases().into_iter().map(move |case| {
            let (emulator, session) = (emulator.clone(), Arc::clone(&session));
            let absent = emulator.is_none();
            Trial::test(format!("{}::{}", processor, case.name), move || {
                let Some(emulator) = emulator else { return Ok(()) };
                let session = session.get_or_init(|| Session::new().map_err(|e| format!("{e:#}")));
                let session = session.as_ref().map_err(Failed::from)?;
                session
                    .check(&emulator, processor, &case)
                    .map_err(|e| Failed::from(format!("{e:#}")))
            })
            .with_kind("qemu-user")
            .with_ignored_flag(absent)
        })
    });
    let mut all: Vec<Trial> = trials.collect();
    all.push(Trial::test("near::a_difference_is_seen", || {
        near::self_test().map_err(|e| Failed::from(format!("{e:#}")))
    }));
    libtest_mimic::run(&Arguments::from_args(), all).exit();
}

/// The program, and a folder with the meshes of all cases.
struct Session {
    program: PathBuf,
    folder: tempfile::TempDir,
}

impl Session {
    fn new() -> Result<Self> {
        let folder = tempfile::tempdir()?;
        // Emulation is slow: only methods with another code path for large meshes get the large
        // one.
        for (level, prefix) in [(2, ""), (3, "large-")] {
            let truth = shapes::bumpy_sphere(level, 0.12, 4.0);
            let noise = NoiseLevel::EdgeLengths(0.2);
            let noisy = add_noise(&truth, NoiseKind::GaussianPerAxis, noise, 3)?;
            let path = |name: &str| folder.path().join(format!("{prefix}{name}.ply"));
            io::write(path("truth"), &truth)?;
            io::write(path("in"), &noisy)?;
        }
        io::write(folder.path().join("fine.ply"), &shapes::icosphere(4))?;
        Ok(Self { program: fairing_tests::program(), folder })
    }

    /// Runs the case on both processors and compares the outputs.
    fn check(&self, emulator: &Path, processor: &str, case: &Case) -> Result<()> {
        let emulated = [emulator.as_os_str(), "-cpu".as_ref(), processor.as_ref()];
        let there = self.run(&emulated, processor, case)?;
        // Two processors are compared at once; each has its own copy.
        let here = self.run(&[], &format!("native-{}", processor), case)?;
        match case.promise {
            Promise::SameBits => same(&here, &there),
            Promise::Near(tolerance) => near::check(case.output, &here, &there, tolerance),
        }
    }

    /// The output of a case: its file, or its standard output.
    fn run(&self, emulator: &[&std::ffi::OsStr], name: &str, case: &Case) -> Result<Vec<u8>> {
        let file = format!("{}-{name}.{}", case.name, case.output);
        let mut words: Vec<&std::ffi::OsStr> = emulator.to_vec();
        words.push(self.program.as_os_str());
        let line = case.line.replace("OUT", &file);
        words.extend(line.split_whitespace().map(std::ffi::OsStr::new));
        let output = Command::new(words[0])
            .args(&words[1..])
            .current_dir(self.folder.path())
            .output()
            .context("starting the program")?;
        // The emulator warns of unsupported features.
        let error = String::from_utf8_lossy(&output.stderr);
        ensure!(output.status.success(), "{line} on {name}: {error}");
        if case.line.contains("OUT") {
            Ok(std::fs::read(self.folder.path().join(file))?)
        } else {
            Ok(output.stdout)
        }
    }
}

fn same(here: &[u8], there: &[u8]) -> Result<()> {
    let first = here.iter().zip(there).position(|(a, b)| a != b);
    ensure!(first.is_none(), "byte {} differs", first.unwrap_or_default());
    ensure!(here.len() == there.len(), "{} bytes here, {} there", here.len(), there.len());
    Ok(())
}
