//! Runs the experiments and renders the report, in its place.

use std::path::PathBuf;

use anyhow::Result;
use fairing_experiments::experiment::Experiment;
use fairing_experiments::progress::Progress as _;
use fairing_experiments::runner;
use fairing_results::results::{Form, Results};

use crate::bar::Bar;
use crate::{place, reference};

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

impl Plan {
    fn run(&self) -> runner::Plan {
        runner::Plan {
            root: self.root.clone(),
            only: self.only.clone(),
            meshes: self.meshes.clone(),
            cache: self.cache.clone(),
            quick: self.quick,
            fresh: self.fresh,
            // A first run is expected to take what it took for the reference values.
            expected: reference::seconds(&self.root, self.quick),
        }
    }
}

/// Runs the plan and returns what was measured, failures included.
///
/// # Errors
///
/// If an experiment is not known, an input is missing, or a file cannot be
/// written. An experiment that fails is no error here: its record says so.
pub fn reproduce(experiments: &[&dyn Experiment], plan: &Plan) -> Result<Results> {
    let out = place::followed(&plan.out)?;
    let work = place::beside(&out)?;
    let bar = Bar::new();
    let measured = runner::run(experiments, &plan.run(), Some(work.path()), &bar)?;
    bar.say("writing the report");
    bar.finish();
    let results = fairing_report::publish(measured, work.path(), plan.form)?;
    place::move_into(work, &out)?;
    Ok(results)
}

/// Runs the plan for its numbers and verdicts alone.
///
/// # Errors
///
/// As [`reproduce`].
pub fn measure(experiments: &[&dyn Experiment], plan: &Plan) -> Result<Results> {
    let bar = Bar::new();
    let measured = runner::run(experiments, &plan.run(), None, &bar)?;
    bar.finish();
    Ok(measured)
}
