//! Symbolic analysis: the ordering of a matrix and the pattern of its factor.

use crate::direct::supernodes::Supernodes;

/// Everything about a factor except its values.
#[derive(Debug)]
pub(crate) struct Analysis {
    pub(crate) nodes: Supernodes,
    /// `order[k]`: the row of the matrix that is eliminated k-th.
    pub(crate) order: Vec<u32>,
    pub(crate) starts: Vec<u32>,
    pub(crate) columns: Vec<u32>,
}
