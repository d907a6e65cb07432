//! Laplacians from edge lengths alone, for meshes that break the plain one.
//!
//! Three steps, each of which leaves a good mesh as it is: lengths are
//! *mollified* around faces that have no area, until every face has some; the *tufted cover* makes two glued
//! sides of each face, so that every edge has two faces; edges are *flipped*
//! in the intrinsic metric until they are Delaunay, so that no weight is
//! negative. The surface, and with it the exact operators, do not change by a
//! flip. Source: \[sharp2020\].

mod cover;
mod delaunay;
mod mollify;
mod robust;
mod triangulation;

pub use robust::{Cover, IntrinsicFaces, RobustLaplacian, RobustOptions, robust_laplacian};
