//! Tests of meshes and files on shapes whose measures are known.

mod diagnosis;
mod large;
mod measures;
mod oracles;
mod subdivision;
mod unit_scale;
