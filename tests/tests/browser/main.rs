//! The report's page in a real browser.
//!
//! Needs Chromium on the path; where there is none, each test is listed by
//! name as ignored. `FAIRING_SCREENSHOTS=FOLDER` keeps what was seen.

mod chrome;
mod live;
mod report;
mod scene;

use std::path::Path;

use anyhow::Result;
use libtest_mimic::{Arguments, Failed, Trial};

use chrome::Chrome;

/// A test that is given a browser and the path of a page.
type Test = fn(&mut Chrome, &Path) -> Result<()>;

fn main() {
    let browser = chrome::find();
    let mut arguments = Arguments::from_args();
    // Two browsers that draw in software take longer than one after another.
    arguments.test_threads = Some(1);
    let trials = [report::trials(), live::trials()]
        .concat()
        .into_iter()
        .map(|(name, test): (&'static str, Test)| {
            let program = browser.clone();
            let absent = program.is_none();
            Trial::test(format!("page::{name}"), move || match program {
                Some(program) => run(&program, test).map_err(|e| Failed::from(format!("{e:#}"))),
                None => Ok(()),
            })
            .with_kind("chromium")
            .with_ignored_flag(absent)
        })
        .collect();
    libtest_mimic::run(&arguments, trials).exit();
}

fn run(program: &Path, test: Test) -> Result<()> {
    let folder = tempfile::tempdir()?;
    let page = folder.path().join("report.html");
    std::fs::write(&page, scene::page()?)?;
    let mut chrome = Chrome::start(program)?;
    test(&mut chrome, &page)
}
