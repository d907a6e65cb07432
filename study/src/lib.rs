//! Measures denoisers on families of models with noise, tunes published ones and trains ours.
//!
//! The benchmark of denoisers is a set of [`cases`]: generated models with noise, each with its
//! truth, and the best that published methods reach on them.
//!
//! Families of models, not cases, are divided into three sets. What is chosen
//! by looking at results (constants, weights, candidates) is chosen on
//! [`Set::Development`]; the others are only reported. On [`Set::Fresh`] no
//! result was known when anything was chosen.
//!
//! Every case is made from seeds, the same on every processor.

#![cfg_attr(test, expect(clippy::disallowed_methods, reason = "tests do not need the same bits"))]

mod cases;
mod correlation;
pub mod families;
mod measure;
mod pairs;
mod published;
mod table;
mod tables;
mod training;
mod tune;
mod volumes;

pub use cases::{Case, Sight, cases, scans, volumes};
pub use correlation::{Sighting, fitted, sightings};
pub use families::{Family, Set, Triangulation};
pub use measure::{Found, Summary, found, read, summary, written};
pub use pairs::{Pair, is_pair, pairs};
pub use published::{Method, Setting, denoiser};
pub use table::{Entry, Published};
pub use tables::{MODELS, model, tables};
pub use training::{
    TrainingOptions, TrainingPair, correlated_pairs, train_normals, training_pairs,
};
pub use tune::tuned;
pub use volumes::{Grain, volume_surface};
