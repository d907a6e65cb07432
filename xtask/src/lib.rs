//! The tasks that keep the repository in order: `cargo xtask reproduce`, `report`,
//! `data`, `bench`, `bed`, `tidy`, `test`.

mod bed;
pub mod bench;
pub mod cli;
pub mod data;
pub mod gate;
mod meshes;
mod python;
pub mod reference;
pub mod reproduce;
pub mod tasks;
pub mod tidy;

mod readme;
mod train;
