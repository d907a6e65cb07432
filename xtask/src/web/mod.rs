//! The module for browsers, and the laboratory.

mod toolchain;

use std::fs;
use std::num::NonZeroU64;
use std::path::Path;

use anyhow::{Result, ensure};
use zopfli::{Format, Options};

use crate::programs::{UNOPTIMISED, cargo, succeeds};
pub(crate) use toolchain::is_available;
use toolchain::{TARGET, Toolchain};

/// The committed module, from the root.
const COMMITTED: &str = "crates/web/assets/fairing.wasm.gz";

/// The part of the work to do.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Extent {
    /// The laboratory, with the committed module.
    Page,
    /// The module from source without optimisation, and those of its tests that are quick.
    Check,
    /// The module from source, its tests, and the laboratory.
    Build,
    /// Also replaces the committed module.
    Accept,
}

impl Extent {
    /// The profile of the module, and its folder.
    fn profile(self) -> &'static str {
        if self == Self::Check { UNOPTIMISED } else { "web" }
    }

    /// Tests of the module: the target, and its arguments. The other tests of the laboratory are
    /// about the page, and the step `browser` runs them with the committed module.
    fn tests(self) -> &'static [(&'static str, &'static [&'static str])] {
        match self {
            Self::Page => &[],
            Self::Check => &[(
                "module",
                &["--skip=same_answers", "--skip=memory", "--skip=damaged", "--skip=real_mesh"],
            )],
            Self::Build | Self::Accept => &[
                ("module", &[]),
                ("browser", &["laboratory::every_sample_opens_and_every_task_runs"]),
            ],
        }
    }
}

/// Builds what is asked for; returns `true` if the tests of the module and of the laboratory pass.
pub(crate) fn run(root: &Path, extent: Extent) -> Result<bool> {
    let folder = root.join("target/web");
    fs::create_dir_all(&folder)?;
    let committed = root.join(COMMITTED);
    if extent == Extent::Page {
        return laboratory(root, &committed, &folder);
    }
    let module = build(root, &folder, extent.profile())?;
    let packed = folder.join("fairing.wasm.gz");
    // The default is 15 rounds, each of which takes seconds and saves bytes of the page.
    let mut options = Options::default();
    if extent != Extent::Accept {
        options.iteration_count = NonZeroU64::MIN;
    }
    let mut bytes = vec![];
    zopfli::compress(options, Format::Gzip, &module[..], &mut bytes)?;
    fs::write(&packed, &bytes)?;
    println!("module: {} bytes, {} compressed", module.len(), bytes.len());
    for (target, arguments) in extent.tests() {
        let mut test = cargo(root);
        // The whole workspace, as elsewhere: with other features, crates compile again.
        test.args(["test", "--workspace", "--locked", "--features", "fairing-tests/browser"]);
        test.args(["--test", target, "--"]).args(*arguments);
        test.env("FAIRING_WEB_MODULE", &packed);
        if !succeeds(&mut test)? {
            return Ok(false);
        }
    }
    match extent {
        Extent::Check => return Ok(true),
        Extent::Accept => fs::write(committed, bytes)?,
        _ => {}
    }
    laboratory(root, &packed, &folder)
}

/// Writes the laboratory with a module; returns `false` if the program that does so does not
/// compile or fails.
fn laboratory(root: &Path, module: &Path, folder: &Path) -> Result<bool> {
    let page = folder.join("fairing.html");
    let mut program = cargo(root);
    // Of the default members: with the features of one package, dependencies compile again.
    program.args(["run", "--quiet", "--bin=laboratory", "--"]);
    if !succeeds(program.args([module, &page]))? {
        return Ok(false);
    }
    println!("{}: {} bytes", page.display(), fs::metadata(&page)?.len());
    Ok(true)
}

/// The module, from source.
fn build(root: &Path, folder: &Path, profile: &str) -> Result<Vec<u8>> {
    let toolchain = Toolchain::find(&folder.join("toolchain"))?;
    let mut build = cargo(root);
    build.args(["build", "--package=fairing-web", "--lib", "--profile", profile, "--locked"]);
    build.args(["--target", TARGET]);
    // A folder of its own: another compiler would replace what is in the other one.
    build.env("CARGO_TARGET_DIR", folder);
    let flags = "-Ctarget-feature=+simd128 -Clink-arg=-zstack-size=4194304 -Clink-arg=--strip-all";
    build.env("CARGO_TARGET_WASM32_UNKNOWN_UNKNOWN_RUSTFLAGS", flags);
    toolchain.prepare(&mut build);
    ensure!(succeeds(&mut build)?, "the module does not compile");
    Ok(fs::read(folder.join(TARGET).join(profile).join("fairing_web.wasm"))?)
}
