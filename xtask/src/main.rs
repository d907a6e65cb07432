//! `cargo xtask …`: reproduce, data, bench, tidy.
fn main() {}
