//! The page of the report and pages of meshes in a real browser.
//!
//! Needs Chromium on the path; otherwise each test is listed by name as ignored.
//! `FAIRING_SCREENSHOTS=FOLDER` saves screenshots.

mod article;
mod chrome;
mod laboratory;
mod live;
mod page;
mod play;
mod report;
mod scene;
mod show;

use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};

use anyhow::{Result, anyhow};
use libtest_mimic::{Arguments, Failed, Trial};

use chrome::Chrome;

/// Browsers that run at the same time.
const BROWSERS: usize = 2;

/// A test that takes a browser and the path of a page.
type Test = fn(&mut Chrome, &Path) -> Result<()>;

fn main() {
    let browser = chrome::find();
    let mut arguments = Arguments::from_args();
    // Each browser serves many tests, one after the other and each in its own tab; a browser that
    // draws keeps more than one processor busy.
    arguments.test_threads = Some(BROWSERS);
    let idle: Arc<Mutex<Vec<Session>>> = Arc::default();
    let trial = |name: String, page: Page, test: Test| {
        let (program, idle) = (browser.clone(), Arc::clone(&idle));
        let absent = program.is_none() || matches!(&page, Page::File(path) if !path.is_file());
        Trial::test(name, move || match program {
            Some(program) => {
                run(&program, &idle, &page, test).map_err(|e| Failed::from(format!("{e:#}")))
            }
            None => Ok(()),
        })
        .with_kind("chromium")
        .with_ignored_flag(absent)
    };
    let made =
        [report::trials(), live::trials(), page::trials(), play::trials()].concat().into_iter();
    let made = made.map(|(name, test)| trial(format!("page::{name}"), Page::Made, test));
    let show = show::trials().into_iter();
    let show = show.map(|(name, test)| trial(format!("show::{name}"), Page::Made, test));
    let article = article::trials()
        .into_iter()
        .map(|(name, test)| trial(format!("article::{name}"), Page::File(article::page()), test));
    let laboratory = laboratory::trials().into_iter();
    let laboratory =
        laboratory.map(|(name, test)| trial(format!("laboratory::{name}"), Page::Made, test));
    // The longest first.
    let trials = laboratory.chain(made).chain(show).chain(article).collect();
    let conclusion = libtest_mimic::run(&arguments, trials);
    // Exiting the process would skip closing the browsers.
    drop(idle.lock().map(|mut idle| std::mem::take(&mut *idle)));
    conclusion.exit();
}

/// A page to open.
enum Page {
    /// The page of [`scene`].
    Made,
    /// The page of the article, which may be absent.
    File(PathBuf),
}

/// A browser, and its folder of the pages of [`scene`].
struct Session {
    chrome: Chrome,
    folder: tempfile::TempDir,
}

/// Runs a test on this page, in a browser that no other test uses.
fn run(program: &Path, idle: &Mutex<Vec<Session>>, page: &Page, test: Test) -> Result<()> {
    let lock = || idle.lock().map_err(|_| anyhow!("another test has panicked"));
    let found = lock()?.pop();
    let mut session = match found {
        Some(session) => session,
        None => {
            let folder = tempfile::tempdir()?;
            scene::publish(&folder.path().join("report"))?;
            Session { chrome: Chrome::start(program)?, folder }
        }
    };
    session.chrome.new_tab()?;
    let page = match page {
        Page::Made => session.folder.path().join("report/report.html"),
        Page::File(path) => path.clone(),
    };
    let done = test(&mut session.chrome, &page);
    lock()?.push(session);
    done
}
