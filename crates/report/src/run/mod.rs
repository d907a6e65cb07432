//! Runs the experiments, renders their report in its place, and compares the results with the
//! reference values.

mod bar;
mod cli;
mod data;
mod place;
mod plan;
pub mod provenance;
pub mod reference;
pub mod runner;

pub use cli::Cli;
pub use plan::{Plan, measure, reproduce};
