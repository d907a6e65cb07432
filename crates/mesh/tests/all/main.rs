//! Tests of meshes and files on shapes whose measures are known.

#![expect(clippy::disallowed_methods, reason = "tests do not need the same bits")]

mod conversions;
mod diagnosis;
mod large;
mod measures;
mod oracles;
mod subdivision;
