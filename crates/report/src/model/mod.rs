//! Measured results as values: tables, verdicts, views, records, and `results.json`, which holds
//! all of them.
//!
//! Experiments create these values and the report shows them.

pub mod compare;
pub mod json;
pub mod provenance;
pub mod results;
pub mod section;
pub mod table;
pub mod verdict;
pub mod view;
