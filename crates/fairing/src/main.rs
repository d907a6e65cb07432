//! The `fairing` program.
fn main() {}
