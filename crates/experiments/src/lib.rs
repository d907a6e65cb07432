//! The experiments behind the report, one file each, and the runner that loads
//! their inputs, times them and writes what they return.
//!
//! An experiment is a value: [`experiment::Experiment`] says what it asks, how it
//! measures, and how it judges its claims from its own tables. How a report
//! looks is no matter of this crate.

pub mod experiment;
pub mod experiments;
pub mod inputs;
pub mod outcome;
pub mod progress;
pub mod provenance;
pub mod runner;

mod palette;

use fairing_results::{results, row, section, table, verdict, view};
