//! The test bed of the denoisers: generated bodies with noise, each with its
//! truth, the best that published methods reach on them, and how a denoiser
//! compares.
//!
//! Families of bodies, not cases, are divided into three sets. What is chosen
//! by looking at results (constants, weights, candidates) is chosen on
//! [`Set::Development`]; the others are only reported. On [`Set::Fresh`] no
//! result was known when anything was chosen.
//!
//! Every case is made from seeds, the same on every processor.

mod cases;
mod measure;
mod pairs;
mod published;
mod table;
mod tune;

pub use cases::{Case, Set, cases, set_of};
pub use measure::{Found, Summary, committed, found, summary, written};
pub use pairs::{PAIR_NAMES, Pair, pairs};
pub use published::{Method, Setting, denoiser};
pub use table::{Entry, Published};
pub use tune::tuned;
