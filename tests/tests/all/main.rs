//! Tests across the crates that need no files but their own.

#![expect(clippy::disallowed_methods, reason = "tests do not need the same bits")]

mod advice;
mod command_line;
mod convergence;
mod denoising;
mod distances;
mod ellipsoid;
mod evaluation;
mod examples;
mod extents;
mod extremes;
#[cfg(target_os = "linux")]
mod faults;
mod files;
mod folder;
mod guide;
#[cfg(target_os = "linux")]
mod interrupts;
mod invariants;
mod many_files;
mod masks;
mod mending;
mod packages;
mod public_types;
mod readme;
mod rendering;
mod report;
mod robustness;
mod serialized;
mod sizes;
mod smoothing;
mod spectra;
mod spectral_verbs;
mod ugly_files;
mod written_back;
