//! Systems `(D + tS) x = b` of a diagonal D and the Laplacian S of a graph.

mod equations;
mod factored;
mod gauge;
mod iteration;
mod parts;
mod system;

pub use system::{GraphSystem, Solved};
