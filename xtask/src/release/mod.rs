//! `cargo xtask release --dry-run`: everything a release needs, short of the upload.

mod build;
mod crates;
mod manifests;
mod step;
mod wheels;

use std::path::Path;
use std::process::Command;
use std::time::Instant;

use anyhow::{Result, bail, ensure};
use step::{Passed, output};

use crate::packages::{self, Package};
use crate::tidy;

/// A step: its name, and the check.
type Step = (&'static str, fn(&Path, &[Package]) -> Result<Passed>);

/// The steps, quick ones first.
const STEPS: [Step; 9] = [
    ("clean tree", |root, _| clean(root)),
    ("versions", manifests::versions),
    ("changelog", manifests::changelog),
    ("metadata", manifests::metadata),
    ("tidy", |root, _| match tidy::run(root)? {
        true => Ok(Passed::Done("every rule holds".into())),
        false => bail!("cargo xtask tidy fails"),
    }),
    ("packages", crates::package),
    ("build from the packages alone", build::run),
    ("sdist", wheels::sdist),
    ("wheel", |root, _| wheels::wheel(root)),
];

/// Runs all steps, even after a failure; returns `true` if none failed.
pub(crate) fn run(root: &Path) -> Result<bool> {
    let packages = packages::read(root)?;
    let mut failed = vec![];
    for (name, step) in STEPS {
        println!("== {name}");
        let start = Instant::now();
        let outcome = step(root, &packages);
        let seconds = start.elapsed().as_secs_f64();
        match outcome {
            Ok(Passed::Done(remark)) => println!("ok: {name} ({seconds:.0} s): {remark}"),
            Ok(Passed::Skipped(reason)) => println!("skipped: {name}: {reason}"),
            Err(error) => {
                eprintln!("FAILED: {name}: {error:#}");
                failed.push(name);
            }
        }
    }
    match failed[..] {
        [] => println!("Ready: `.github/workflows/release.yml` does the same and uploads."),
        _ => eprintln!("Not ready: {}", failed.join(", ")),
    }
    Ok(failed.is_empty())
}

/// Checks that everything is committed: packages hold the files of a commit.
fn clean(root: &Path) -> Result<Passed> {
    let status = output(Command::new("git").args(["status", "--porcelain"]).current_dir(root))?;
    let changed: Vec<&str> = status.lines().collect();
    ensure!(changed.is_empty(), "commit these first:\n{}", changed.join("\n"));
    let commit =
        output(Command::new("git").args(["rev-parse", "--short", "HEAD"]).current_dir(root))?;
    Ok(Passed::Done(format!("commit {}", commit.trim())))
}
