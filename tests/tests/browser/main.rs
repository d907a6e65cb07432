//! The report's page in a real browser.
//!
//! Needs Chromium on the path; where there is none, each test is listed by
//! name as ignored. `FAIRING_SCREENSHOTS=FOLDER` keeps what was seen.

mod chrome;
mod committed;
mod live;
mod report;
mod scene;

use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};

use anyhow::{Result, anyhow};
use libtest_mimic::{Arguments, Failed, Trial};

use chrome::Chrome;

/// A test that is given a browser and the path of a page.
type Test = fn(&mut Chrome, &Path) -> Result<()>;

fn main() {
    let browser = chrome::find();
    let mut arguments = Arguments::from_args();
    // One browser serves all tests, each in a tab of its own.
    arguments.test_threads = Some(1);
    let shared: Arc<Mutex<Option<Session>>> = Arc::default();
    let trial = |name: String, page: Option<PathBuf>, test: Test| {
        let (program, shared) = (browser.clone(), Arc::clone(&shared));
        let absent = program.is_none() || page.as_ref().is_some_and(|p| !p.is_file());
        Trial::test(name.clone(), move || match program {
            Some(program) => fairing_tests::timed(&name, || {
                run(&program, &shared, page.as_deref(), test)
                    .map_err(|e| Failed::from(format!("{e:#}")))
            }),
            None => Ok(()),
        })
        .with_kind("chromium")
        .with_ignored_flag(absent)
    };
    let made = [report::trials(), live::trials()].concat().into_iter();
    let made = made.map(|(name, test)| trial(format!("page::{name}"), None, test));
    let committed = committed::trials()
        .into_iter()
        .map(|(name, test)| trial(format!("committed::{name}"), Some(committed::page()), test));
    let trials = made.chain(committed).collect();
    let conclusion = libtest_mimic::run(&arguments, trials);
    // Leaving the process would skip closing the browser.
    drop(shared.lock().map(|mut session| session.take()));
    conclusion.exit();
}

/// The browser and the page, made by the first test that needs them.
struct Session {
    chrome: Chrome,
    folder: tempfile::TempDir,
}

/// Runs a test on this page, or on that of [`scene`].
fn run(
    program: &Path,
    shared: &Mutex<Option<Session>>,
    page: Option<&Path>,
    test: Test,
) -> Result<()> {
    let mut shared = shared.lock().map_err(|_| anyhow!("another test has panicked"))?;
    let session = match &mut *shared {
        Some(session) => session,
        none => {
            let folder = tempfile::tempdir()?;
            std::fs::write(folder.path().join("report.html"), scene::page()?)?;
            none.insert(Session { chrome: Chrome::start(program)?, folder })
        }
    };
    session.chrome.new_tab()?;
    let made = session.folder.path().join("report.html");
    test(&mut session.chrome, page.unwrap_or(&made))
}
