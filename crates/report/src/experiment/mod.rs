//! An experiment is a value with a question, a run, and judgements of its claims from its own
//! tables.

pub mod inputs;
pub mod outcome;
pub mod progress;
pub(crate) mod text;

use anyhow::Result;
use sha2::{Digest, Sha256};

use crate::experiment::inputs::{Input, Inputs};
use crate::experiment::outcome::Outcome;
use crate::experiment::progress::Progress;
use crate::model::section::Section;
use crate::model::table::Tables;
use crate::model::verdict::Judgement;

/// One experiment of the report.
///
/// Experiments use no files, clocks or printing: the runner loads inputs, times, writes, draws the
/// page and records the provenance of numbers.
pub trait Experiment: Sync {
    /// Title, question, method and parameters.
    fn card(&self) -> Card;

    /// Runs the measurements. Random numbers come from [`Context::seed`], so that a second run
    /// returns the same.
    ///
    /// # Errors
    ///
    /// Any failure; the runner reports it and continues with the other experiments.
    fn run(&self, context: &Context<'_>) -> Result<Outcome>;

    /// Judges the claims from the tables, and from nothing else.
    fn judge(&self, tables: Tables<'_>) -> Result<Vec<Judgement>> {
        let _ = tables;
        Ok(vec![])
    }
}

/// The description of an experiment.
#[derive(Debug, Clone)]
pub struct Card {
    /// The id: `q1` to `q7` for the questions, a word for what goes beyond.
    pub id: &'static str,
    /// The title, a few words.
    pub title: &'static str,
    /// The question.
    pub question: String,
    /// The method in short. Paragraphs are separated by an empty line.
    pub method: String,
    /// The formulas behind the method, in TeX, without dollars.
    pub formulas: Vec<String>,
    /// Its place in the article and the words around it.
    pub section: Section,
    /// The meshes it loads, those without a stand-in where they are found;
    /// shapes that it makes itself are not listed.
    pub inputs: &'static [Input],
    /// Its parameters, as the report lists them.
    pub parameters: Vec<(&'static str, String)>,
}

/// Inputs, seeds and settings of a run, handed to an experiment by the runner.
pub struct Context<'a> {
    inputs: &'a Inputs,
    progress: &'a dyn Progress,
    seed: u64,
    quick: bool,
}

impl<'a> Context<'a> {
    /// Called by the runner.
    pub fn new(inputs: &'a Inputs, progress: &'a dyn Progress, seed: u64, quick: bool) -> Self {
        Self { inputs, progress, seed, quick }
    }

    /// The mesh that plays this part: the assignment's where it was found, its
    /// stand-in otherwise.
    ///
    /// # Errors
    ///
    /// If it cannot be read, or is not on the experiment's card.
    pub fn mesh(&self, input: Input) -> Result<fairing_mesh::TriMesh> {
        self.inputs.mesh(input)
    }

    /// The mesh that plays a part without a stand-in; `None` where it was not
    /// found.
    pub(crate) fn mesh_if_present(&self, input: Input) -> Result<Option<fairing_mesh::TriMesh>> {
        self.inputs.source(input).map(|_| self.inputs.mesh(input)).transpose()
    }

    /// Returns true if a stand-in plays this part.
    pub(crate) fn is_stand_in(&self, input: Input) -> bool {
        self.inputs.source(input).is_some_and(|source| source.stand_in)
    }

    /// A seed of its own for each purpose, the same in every run.
    pub fn seed(&self, purpose: &str) -> u64 {
        let digest = Sha256::new().chain_update(self.seed.to_le_bytes()).chain_update(purpose);
        let bytes = digest.finalize();
        bytes[..8].iter().fold(0, |seed, &b| seed << 8 | u64::from(b))
    }

    /// Returns true for small sizes and few repetitions.
    pub(crate) fn is_quick(&self) -> bool {
        self.quick
    }

    /// `full`, or `quick` in a quick run.
    pub fn choose<T>(&self, full: T, quick: T) -> T {
        if self.quick { quick } else { full }
    }

    /// Reports the current work and its progress, from 0 to 1.
    pub fn progress(&self, done: f64, what: &str) {
        self.progress.within(done, what);
    }
}
