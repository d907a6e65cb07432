//! Parameters of algorithms, declared once.
//!
//! [`options!`] declares the options of an algorithm: a plain struct whose fields have a
//! description, a default, a unit and a range. [`algorithms!`] makes one enum of several. From them
//! follow defaults, range checks, options by name, and the tables from which programs make flags,
//! help and documentation ([`Algorithm`]).
//!
//! Choices with names ([`choices!`]) and the error of an option outside its range
//! ([`OptionError`]) are those of all crates.

mod algorithm;
mod family;
mod field;
mod named;
pub mod old;
mod options;
mod range;
mod value;

pub use algorithm::{Algorithm, Choice, Kind, Parameter};
pub use family::Family;
pub use field::Field;
pub use named::UnknownName;
#[doc(hidden)]
pub use named::by_name;
pub use options::{Entry, Options};
#[doc(hidden)]
pub use options::{hyphenated, sentence};
pub use range::{OptionError, Range};
pub use value::{ParameterError, Value, Values, WeightedVertex};
