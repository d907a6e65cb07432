//! Parameters of algorithms: names, units, defaults, ranges, and values given by name.

mod algorithm;
mod named;
mod option_error;

pub use algorithm::{Algorithm, Choice, Kind, Parameter, ParameterError, Values, WeightedVertex};
pub use named::UnknownName;
#[doc(hidden)]
pub use named::by_name;
pub use option_error::OptionError;
