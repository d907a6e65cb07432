//! The report: what experiments return, the experiments, their report as Markdown and as a page,
//! and the program behind `cargo xtask reproduce`.
//!
//! An experiment is a value: [`experiment::Experiment`] says what it asks, how it measures, and how
//! it judges its claims from its own tables. [`page`] shows what it returned and needs nothing
//! else, so a report can be rendered again without running any experiment.

pub mod experiment;
pub mod experiments;
pub mod model;
pub mod page;
pub mod run;
