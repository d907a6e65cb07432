//! Reports of tasks, each written once for all programs.
//!
//! A report is an object of JSON with fixed names and order. The program prints it, the module for
//! browsers sends it, and the Python package turns it into a dictionary. Lengths are in mesh units
//! unless an entry says otherwise.

mod compare;
mod curvature;
mod denoise;
mod geodesic;
mod inspect;
mod noise;
mod repair;
mod smooth;
mod spectrum;
mod tables;

pub use compare::{compare, matching_scores, scores};
pub use curvature::{Columns, curvature, fields, undefined_because};
pub use denoise::denoise;
pub use geodesic::{GeodesicLines, farthest, geodesic};
pub use inspect::{diagnosis, file, read};
pub use noise::{Unit, noise_kind};
pub use repair::{counts, repair};
pub use smooth::smooth;
pub use spectrum::{modes, spectrum};
pub use tables::method;

use serde_json::{Map, Value};

/// An object with these entries.
fn object<N: Into<String>, V: Into<Value>>(entries: impl IntoIterator<Item = (N, V)>) -> Value {
    let entries = entries.into_iter().map(|(name, value)| (name.into(), value.into()));
    Value::Object(Map::from_iter(entries))
}
