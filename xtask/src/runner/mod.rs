//! Runs experiments and writes the report.

mod cache;
mod shrink;
mod write;

use std::collections::BTreeSet;
use std::fs;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use anyhow::{Context as _, Result, anyhow, bail, ensure};

use crate::experiment::{Context, Experiment};
use crate::inputs::{Input, Inputs};
use crate::progress::Progress;
use crate::provenance::Provenance;
use crate::results::{Parameter, Record, Results};
use crate::table::Tables;
use crate::{json, markdown, page, reference};
use cache::Cache;

/// The seed of everything random in the report.
pub const SEED: u64 = 2021;

/// What an experiment is expected to take when it has never been run.
const UNKNOWN_SECONDS: f64 = 5.0;

/// What to run, and where to put it.
#[derive(Debug, Clone)]
pub struct Plan {
    /// The root of the repository.
    pub root: PathBuf,
    /// The experiments, by id; empty for all.
    pub only: Vec<String>,
    /// A folder that holds the assignment's meshes.
    pub meshes: Option<PathBuf>,
    /// Where the report goes.
    pub out: PathBuf,
    /// Where finished experiments are kept for the next run.
    pub cache: PathBuf,
    /// Whether to reduce sizes.
    pub quick: bool,
    /// Whether to run what has been run before.
    pub fresh: bool,
    /// What the report holds.
    pub form: Form,
}

/// What a report holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Form {
    /// Everything; the page is one file.
    Whole,
    /// What is small enough to be committed: no meshes, smaller pictures, and
    /// those beside the page instead of in it.
    Small,
}

/// Runs the plan and returns what was measured, failures included.
///
/// The report is put together in a temporary folder beside its place and moved
/// there when it is complete. A run that is killed leaves that folder behind,
/// under a hidden name, for a later one to remove.
///
/// # Errors
///
/// If an experiment is not known, an input is missing, or a file cannot be
/// written. An experiment that fails is no error here: its record says so.
pub fn reproduce(experiments: &[&dyn Experiment], plan: &Plan) -> Result<Results> {
    let chosen = choose(experiments, &plan.only)?;
    let wanted: BTreeSet<Input> = chosen.iter().flat_map(|e| e.card().inputs).copied().collect();
    let wanted: Vec<Input> = wanted.into_iter().collect();
    let inputs = Inputs::locate(&wanted, &plan.root.join("data"), plan.meshes.as_deref())?;
    check_place(&plan.out)?;
    let parent = plan.out.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    fs::create_dir_all(parent).with_context(|| format!("creating {}", parent.display()))?;
    sweep(parent)?;
    let work = tempfile::Builder::new().prefix(UNFINISHED).tempdir_in(parent)?;
    let cache = Cache::open(&plan.cache)?;
    // A first run is expected to take what it took for the reference values.
    let reference = reference::seconds(&plan.root, plan.quick);
    let expected = |e: &dyn Experiment| {
        let id = e.card().id;
        let known = cache.last_seconds(id, plan.quick).or_else(|| reference.get(id).copied());
        known.unwrap_or(UNKNOWN_SECONDS)
    };
    let mut left: f64 = chosen.iter().map(|&e| expected(e)).sum();
    let progress = Progress::new(left);
    progress.say(&format!("{} experiments, {}", chosen.len(), about(left)));
    let mut records = vec![];
    for (i, &experiment) in chosen.iter().enumerate() {
        let card = experiment.card();
        progress.begin(card.title, expected(experiment));
        left -= expected(experiment);
        let named = format!("[{}/{}] {}: {}", i + 1, chosen.len(), card.id, card.title);
        let key = cache.key(&card, &inputs, plan.quick, SEED)?;
        let place = work.path().join(card.id);
        let reused = if plan.fresh { None } else { cache.restore(card.id, &key, &place)? };
        let record = match reused {
            Some(record) => {
                progress.say(&format!("{named} (unchanged since the last run)"));
                record
            }
            None => {
                let record = run(experiment, &inputs, &progress, plan.quick, work.path())?;
                match &record.error {
                    Some(error) => progress.say(&format!("{named} FAILED: {error}")),
                    None => {
                        cache.store(&key, plan.quick, &place, &record)?;
                        let left = if i + 1 < chosen.len() {
                            about(left) + " left"
                        } else {
                            "done".into()
                        };
                        progress.say(&format!("{named} ({:.1} s, {left})", record.seconds));
                    }
                }
                record
            }
        };
        progress.end();
        records.push(record);
    }
    progress.say("writing the report");
    progress.finish();
    let provenance = Provenance::gather(&plan.root, SEED, plan.quick);
    if plan.form == Form::Small {
        shrink::records(&mut records, work.path())?;
    }
    let results = Results { provenance, experiments: records };
    write::text(&work.path().join("results.json"), &json::readable(&results)?)?;
    write::text(&work.path().join("report.md"), &markdown::report(&results, &chosen, plan.form))?;
    write::text(
        &work.path().join("report.html"),
        &page::report(&results, &chosen, work.path(), plan.form)?,
    )?;
    move_into_place(work, &plan.out)?;
    Ok(results)
}

/// `about 40 s`, `about 3 min`.
fn about(seconds: f64) -> String {
    match seconds {
        s if s < 100.0 => format!("about {s:.0} s"),
        s => format!("about {:.0} min", s / 60.0),
    }
}

/// The experiments with these ids, in the order of the report.
fn choose<'a>(all: &[&'a dyn Experiment], only: &[String]) -> Result<Vec<&'a dyn Experiment>> {
    let ids: Vec<&str> = all.iter().map(|e| e.card().id).collect();
    if let Some(unknown) = only.iter().find(|o| !ids.contains(&o.as_str())) {
        bail!("there is no experiment {unknown}; there are {}", ids.join(", "));
    }
    let wanted = |e: &&&dyn Experiment| only.is_empty() || only.iter().any(|o| o == e.card().id);
    Ok(all.iter().filter(wanted).copied().collect())
}

/// Runs one experiment, judges it and writes its files into `work/id`.
fn run(
    experiment: &dyn Experiment,
    inputs: &Inputs,
    progress: &Progress,
    quick: bool,
    work: &Path,
) -> Result<Record> {
    let card = experiment.card();
    let context = Context::new(inputs, progress, SEED, quick);
    let start = Instant::now();
    // A panic is a mistake of ours in one experiment: the others still run.
    let outcome = catch_unwind(AssertUnwindSafe(|| {
        let outcome = experiment.run(&context)?;
        let claims = experiment.judge(Tables(&outcome.tables))?;
        anyhow::Ok((outcome, claims))
    }))
    .unwrap_or_else(|panic| Err(anyhow!("panicked: {}", message(&*panic))));
    let mut record = Record {
        id: card.id.into(),
        title: card.title.into(),
        question: card.question.into(),
        error: None,
        inputs: card.inputs.iter().filter_map(|&i| inputs.source(i).cloned()).collect(),
        parameters: card
            .parameters
            .iter()
            .map(|(name, value)| Parameter { name: (*name).into(), value: value.clone() })
            .collect(),
        tables: vec![],
        claims: vec![],
        figures: vec![],
        files: vec![],
        notes: vec![],
        seconds: start.elapsed().as_secs_f64(),
        views: vec![],
    };
    match outcome {
        Ok((outcome, claims)) => {
            record.claims = claims;
            write::outcome(outcome, work, &mut record)?;
        }
        Err(error) => record.error = Some(format!("{error:#}")),
    }
    Ok(record)
}

/// What a panic said.
fn message(panic: &(dyn std::any::Any + Send)) -> String {
    let text = panic.downcast_ref::<&str>().map(|s| (*s).to_string());
    text.or_else(|| panic.downcast_ref::<String>().cloned()).unwrap_or_default()
}

/// Refuses a place that holds something other than an earlier report.
fn check_place(out: &Path) -> Result<()> {
    let Ok(mut entries) = fs::read_dir(out) else {
        ensure!(!out.exists(), "{} is a file, not a folder", out.display());
        return Ok(());
    };
    ensure!(
        entries.next().is_none() || out.join("results.json").is_file(),
        "{} holds something other than a report; it would be replaced as a whole",
        out.display()
    );
    Ok(())
}

/// How the folders begin in which reports are put together.
const UNFINISHED: &str = ".report-";

/// A run that began longer ago than this is not running any more.
const STALE: Duration = Duration::from_secs(6 * 3600);

/// Removes what runs that were killed have left behind.
fn sweep(parent: &Path) -> Result<()> {
    for entry in fs::read_dir(parent).with_context(|| format!("reading {}", parent.display()))? {
        let entry = entry?;
        let ours = entry.file_name().to_string_lossy().starts_with(UNFINISHED);
        let age = || entry.metadata().ok()?.modified().ok()?.elapsed().ok();
        if ours && age().is_some_and(|age| age > STALE) {
            fs::remove_dir_all(entry.path())
                .with_context(|| format!("removing {}", entry.path().display()))?;
        }
    }
    Ok(())
}

/// Puts the finished folder in its place; an earlier report gives way.
fn move_into_place(work: tempfile::TempDir, out: &Path) -> Result<()> {
    let context = || format!("moving the report to {}", out.display());
    let finished = work.keep();
    if out.exists() {
        let name = finished.file_name().map(|n| n.to_string_lossy().into_owned() + "-old");
        let old = finished.with_file_name(name.unwrap_or_default());
        fs::rename(out, &old).with_context(context)?;
        fs::rename(&finished, out).with_context(context)?;
        fs::remove_dir_all(&old).with_context(context)?;
    } else {
        fs::rename(&finished, out).with_context(context)?;
    }
    open_to_readers(out)
}

/// Temporary folders are closed to others; a report is not.
#[cfg(unix)]
fn open_to_readers(out: &Path) -> Result<()> {
    use std::os::unix::fs::PermissionsExt as _;
    Ok(fs::set_permissions(out, fs::Permissions::from_mode(0o755))?)
}

#[cfg(not(unix))]
fn open_to_readers(_: &Path) -> Result<()> {
    Ok(())
}
