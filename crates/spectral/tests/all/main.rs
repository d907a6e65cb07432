//! Spectra and distances on bad meshes, in any frame and unit, and where modes are an arbitrary
//! basis.

#![expect(clippy::disallowed_methods, reason = "tests do not need the same bits")]

mod clusters;
mod files;
mod geodesics;
mod hard;
mod invariance;
mod meshes;
mod paths;
mod thin;
