//! One file per flow: its options, formula and entry point.

pub(crate) mod conformal;
pub(crate) mod explicit;
pub(crate) mod hc;
pub(crate) mod implicit;
pub(crate) mod low_pass;
pub(crate) mod region;
pub(crate) mod scale_dependent;
pub(crate) mod taubin;
pub(crate) mod windowed_sinc;
