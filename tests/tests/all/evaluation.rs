//! Tests of this area across crates.
