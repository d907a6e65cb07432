//! Runs experiments and writes their files.

mod cache;
mod write;

use std::collections::{BTreeSet, HashMap};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::time::Instant;

use anyhow::{Result, anyhow, bail};

use crate::experiment::inputs::{Input, Inputs};
use crate::experiment::progress::Progress;
use crate::experiment::{Context, Experiment};
use crate::model::results::{Form, Parameter, Record, Results};
use crate::model::table::Tables;
use crate::run::provenance;
use cache::Cache;

/// The seed of everything random in the report.
pub const SEED: u64 = 2021;

/// Expected time of an experiment that has never run.
const UNKNOWN_SECONDS: f64 = 5.0;

/// Settings of a run.
#[derive(Debug, Clone)]
pub struct Plan {
    /// The root of the repository.
    pub root: PathBuf,
    /// The experiments, by id; empty for all.
    pub only: Vec<String>,
    /// A folder that holds the assignment's meshes.
    pub meshes: Option<PathBuf>,
    /// Where finished experiments are kept for the next run.
    pub cache: PathBuf,
    /// True for reduced sizes.
    pub quick: bool,
    /// True to run again what has been run before.
    pub fresh: bool,
    /// Expected times of experiments that have never run here, in
    /// seconds, by id.
    pub expected: HashMap<String, f64>,
}

/// Runs the plan, writes the files of each experiment into a folder of its own
/// below `work`, and returns what was measured, failures included. Without
/// `work` nothing is written, and nothing is taken from an earlier run.
///
/// Nothing is left out yet: each figure has a picture in both sizes.
///
/// # Errors
///
/// If an experiment is not known, an input is missing, or a file cannot be
/// written. An experiment that fails is no error here: its record says so.
pub fn run(
    experiments: &[&dyn Experiment],
    plan: &Plan,
    work: Option<&Path>,
    progress: &dyn Progress,
) -> Result<Results> {
    let chosen = choose(experiments, &plan.only)?;
    let wanted: BTreeSet<Input> = chosen.iter().flat_map(|e| e.card().inputs).copied().collect();
    let wanted: Vec<Input> = wanted.into_iter().collect();
    let inputs = Inputs::locate(&wanted, &plan.root.join("data"), plan.meshes.as_deref())?;
    let cache = Cache::open(&plan.cache)?;
    let expected = |e: &dyn Experiment| {
        let id = e.card().id;
        let known = cache.last_seconds(id, plan.quick).or_else(|| plan.expected.get(id).copied());
        known.unwrap_or(UNKNOWN_SECONDS)
    };
    let mut left: f64 = chosen.iter().map(|&e| expected(e)).sum();
    progress.start(left);
    progress.say(&format!("{} experiments, {}", chosen.len(), about(left)));
    if let (Some(folder), replaced @ [_, ..]) = (&plan.meshes, &inputs.replaced()[..]) {
        let (folder, replaced) = (folder.display(), replaced.join(", "));
        progress.say(&format!(
            "generated meshes take the place of what {folder} does not hold: {replaced} (a noisy \
             mesh and the one without noise go together)"
        ));
    }
    let mut records = vec![];
    for (i, &experiment) in chosen.iter().enumerate() {
        let card = experiment.card();
        progress.begin(card.title, expected(experiment));
        left -= expected(experiment);
        let named = format!("[{}/{}] {}: {}", i + 1, chosen.len(), card.id, card.title);
        let key = cache.key(&card, &inputs, plan.quick, SEED)?;
        let place = work.map(|work| work.join(card.id));
        let reused = match &place {
            Some(place) if !plan.fresh => cache.restore(card.id, &key, place)?,
            _ => None,
        };
        let fresh = reused.is_none();
        let record = match reused {
            Some(record) => record,
            None => measure(experiment, &inputs, progress, plan.quick, work)?,
        };
        if let (true, None, Some(place)) = (fresh, &record.error, &place) {
            cache.store(&key, plan.quick, place, &record)?;
        }
        let left = if i + 1 < chosen.len() { about(left) + " left" } else { "done".into() };
        progress.say(&match &record.error {
            _ if !fresh => format!("{named} (unchanged since the last run)"),
            Some(error) => format!("{named} FAILED: {error}"),
            None => format!("{named} ({:.1} s, {left})", record.seconds),
        });
        progress.end();
        records.push(record);
    }
    let provenance = provenance::gather(&plan.root, SEED, plan.quick);
    Ok(Results { provenance, form: Form::Whole, experiments: records })
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

/// Runs one experiment, judges it and writes its files, if any, into `work/id`.
fn measure(
    experiment: &dyn Experiment,
    inputs: &Inputs,
    progress: &dyn Progress,
    quick: bool,
    work: Option<&Path>,
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
        question: card.question,
        method: card.method,
        formulas: card.formulas,
        section: card.section,
        inputs: card.inputs.iter().filter_map(|&i| inputs.source(i).cloned()).collect(),
        parameters: card
            .parameters
            .into_iter()
            .map(|(name, value)| Parameter { name: name.into(), value })
            .collect(),
        seconds: start.elapsed().as_secs_f64(),
        ..Record::default()
    };
    match outcome {
        Ok((outcome, claims)) => {
            record.claims = claims;
            match work {
                Some(work) => write::outcome(outcome, work, &mut record)?,
                None => (record.tables, record.notes) = (outcome.tables, outcome.notes),
            }
        }
        Err(error) => record.error = Some(format!("{error:#}")),
    }
    Ok(record)
}

/// The message of a panic.
fn message(panic: &(dyn std::any::Any + Send)) -> String {
    let text = panic.downcast_ref::<&str>().map(|s| (*s).to_string());
    text.or_else(|| panic.downcast_ref::<String>().cloned()).unwrap_or_default()
}
