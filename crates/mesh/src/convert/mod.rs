//! Meshes of other crates, each behind a feature of its name.

#[cfg(feature = "nalgebra")]
mod nalgebra;
#[cfg(feature = "parry3d")]
mod parry3d;
#[cfg(feature = "ply-rs")]
mod ply_rs;
#[cfg(feature = "tobj")]
mod tobj;
