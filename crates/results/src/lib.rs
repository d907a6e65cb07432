//! What has been measured, as values: tables, verdicts, views, records, and
//! `results.json`, which holds them.
//!
//! Experiments make these values and the report shows them. Neither of the two
//! knows the other: this crate is what they share.

pub mod compare;
pub mod json;
pub mod provenance;
pub mod results;
pub mod section;
pub mod table;
pub mod verdict;
pub mod view;
