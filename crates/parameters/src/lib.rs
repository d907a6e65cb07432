#![doc = include_str!("../README.md")]
//!
//! # Overview
//!
//! [`options!`] declares the options of an algorithm: a plain struct whose fields have a
//! description, a default, a unit and a range. [`algorithms!`] makes one enum of several. From them
//! follow defaults, range checks, options by name, and the tables from which programs make flags,
//! help and documentation ([`Algorithm`]).
//!
//! Choices with names ([`choices!`]) and the error of a name or a value
//! ([`ParameterError`]) are those of all crates.

mod algorithm;
mod error;
mod family;
mod field;
mod named;
mod options;
mod range;
mod value;
mod values;

pub use algorithm::{Algorithm, Choice, Kind, Parameter};
pub use error::ParameterError;
pub use family::Family;
pub use field::Field;
pub use named::by_name;
pub use options::{Entry, Options};
#[doc(hidden)]
pub use options::{hyphenated, sentence};
pub use range::Range;
pub use value::{Value, WeightedVertex};
pub use values::Values;
