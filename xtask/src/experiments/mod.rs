//! The experiments, in the order of the report.

use crate::experiment::Experiment;

/// The table of contents: the seven questions, then what goes beyond.
pub const ALL: &[&dyn Experiment] = &[];
