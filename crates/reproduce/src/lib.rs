//! Runs the experiments, renders their report in its place, and compares the results with the
//! reference values.

mod bar;
mod cli;
mod data;
mod place;
mod plan;
mod readme;
pub mod reference;

pub use cli::Cli;
pub use plan::{Plan, measure, reproduce};
