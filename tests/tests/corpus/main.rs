//! Tests on real meshes, which are not part of the repository.
//!
//! `FAIRING_MESHES` names their folder. Without it every test is listed by name as ignored. An area
//! is a module with a function `trials() -> Vec<(&'static str, Test)>` and a line below.

mod denoising;
mod diagnosis;
mod operators;
mod reading;
mod repair;
mod report;
mod verbs;

use std::path::{Path, PathBuf};

use libtest_mimic::{Arguments, Failed, Trial};

/// A test that takes the folder of meshes.
type Test = fn(&Path) -> Result<(), Failed>;

fn main() {
    let folder = std::env::var_os("FAIRING_MESHES").map(PathBuf::from).filter(|d| d.is_dir());
    // The longest first.
    let areas = [
        ("operators", operators::trials()),
        ("repair", repair::trials()),
        ("denoising", denoising::trials()),
        ("report", report::trials()),
        ("verbs", verbs::trials()),
        ("diagnosis", diagnosis::trials()),
        ("reading", reading::trials()),
    ];
    let trials = areas
        .into_iter()
        .flat_map(|(area, tests)| tests.into_iter().map(move |(name, test)| (area, name, test)))
        .map(|(area, name, test)| {
            let folder = folder.clone();
            let absent = folder.is_none();
            let name = format!("{area}::{name}");
            Trial::test(name, move || match folder {
                Some(folder) => test(&folder),
                None => Ok(()),
            })
            .with_ignored_flag(absent)
        })
        .collect();
    libtest_mimic::run(&Arguments::from_args(), trials).exit();
}
