//! Fairing in WebAssembly.
//!
//! A [`Session`] keeps meshes and answers requests. A request is a JSON object with a `verb`, and
//! bytes where the verb reads a file; an [`Answer`] is a JSON object with arrays. On
//! `wasm32-unknown-unknown` the module exports a session by a plain interface (`memory.rs`): a page
//! writes a request into the memory of the module and sees the arrays of the answer there.
//!
//! The verbs are those of the program, with the same names, parameters and errors.

mod answer;
mod change;
mod file;
#[cfg(target_arch = "wasm32")]
mod memory;
mod meshes;
mod parts;
mod request;
mod sample;
mod session;
mod tables;
pub mod tasks;
mod values;

pub use answer::{Answer, Array};
pub use session::Session;
