//! The experiments behind the report, and the tasks that keep the repository in
//! order: `cargo xtask reproduce`, `data`, `bench`, `tidy`, `test`.

pub mod bench;
pub mod cli;
pub mod compare;
pub mod data;
pub mod experiment;
pub mod experiments;
pub mod gate;
pub mod inputs;
pub mod outcome;
pub mod page;
pub mod progress;
pub mod provenance;
pub mod reference;
pub mod results;
pub mod runner;
pub mod table;
pub mod tidy;
pub mod verdict;
pub mod view;

mod json;
mod markdown;
mod palette;
mod readme;
