//! The experiments behind the report, and the tasks that keep the repository in
//! order: `cargo xtask reproduce`, `data`, `bench`, `tidy`, `test`.

pub mod bench;
pub mod cli;
pub mod experiment;
pub mod experiments;
pub mod inputs;
pub mod outcome;
pub mod page;
pub mod progress;
pub mod provenance;
pub mod results;
pub mod runner;
pub mod table;
pub mod verdict;
pub mod view;

mod markdown;
