//! What a flow says of itself.

use fairing_mesh::TriMesh;
use fairing_parameters::ParameterError;
use fairing_parameters::old::{Algorithm, Values};

use crate::engine::error::FlowError;
use crate::engine::outcome::Smoothed;
use crate::engine::step::Observer;

/// What the options of a flow say for programs.
pub(crate) trait Flow: Sized {
    /// The flow by name; several where a choice among its options has a name of its own.
    const ALGORITHMS: &'static [Algorithm];

    /// The options with these values, for a mesh with these positions.
    fn with(values: &Values<'_>, positions: &[[f64; 3]]) -> Result<Self, ParameterError>;

    /// The name that these options go by.
    fn algorithm(&self) -> &'static Algorithm {
        &Self::ALGORITHMS[0]
    }

    /// The flow.
    const RUN: FlowFn<Self>;
}

/// A flow: a mesh, its options, and who sees every step.
pub(crate) type FlowFn<Options> =
    fn(&TriMesh, &Options, Option<&mut Observer<'_>>) -> Result<Smoothed, FlowError>;
