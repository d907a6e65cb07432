//! Runs the experiments and renders the report, in its place.

use std::path::PathBuf;

use crate::experiment::Experiment;
use crate::experiment::progress::Progress as _;
use crate::model::results::{Form, Results};
use crate::run::runner;
use anyhow::Result;

use crate::run::bar::Bar;
use crate::run::{place, reference};

/// A run of experiments and the place of its report.
#[derive(Debug, Clone)]
pub struct Plan {
    /// The root of the repository.
    pub root: PathBuf,
    /// The experiments, by id; empty for all.
    pub only: Vec<String>,
    /// A folder that holds the assignment's meshes.
    pub meshes: Option<PathBuf>,
    /// The folder of the report.
    pub out: PathBuf,
    /// The folder in which finished experiments are kept for the next run.
    pub cache: PathBuf,
    /// Reduces sizes and repetitions.
    pub quick: bool,
    /// Runs again the experiments that are kept.
    pub fresh: bool,
    /// The form of the report.
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

/// Runs the plan, writes the report and returns the results, failures included.
///
/// # Errors
///
/// An unknown experiment, a missing input, or a file that cannot be written. An experiment that
/// fails is no error here: its record holds the error.
pub fn reproduce(experiments: &[&dyn Experiment], plan: &Plan) -> Result<Results> {
    let out = place::followed(&plan.out)?;
    let work = place::beside(&out)?;
    let bar = Bar::new();
    let measured = runner::run(experiments, &plan.run(), Some(work.path()), &bar)?;
    bar.say("writing the report");
    bar.finish();
    let results = crate::page::publish(measured, work.path(), plan.form)?;
    place::move_into(work, &out)?;
    Ok(results)
}

/// Runs the plan for its numbers and verdicts alone.
pub fn measure(experiments: &[&dyn Experiment], plan: &Plan) -> Result<Results> {
    let bar = Bar::new();
    let measured = runner::run(experiments, &plan.run(), None, &bar)?;
    bar.finish();
    Ok(measured)
}
