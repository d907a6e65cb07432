//! Spectra and distances on bad meshes, in any frame and unit, and where modes are an arbitrary basis.

mod clusters;
mod geodesics;
mod hard;
mod invariance;
mod meshes;
