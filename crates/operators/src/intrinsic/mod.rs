//! Laplacians from edge lengths alone, for meshes on which the cotangent Laplacian fails.
//!
//! Three steps, none of which changes a good mesh: lengths are *mollified* around faces without
//! area until every face has a positive one; the *tufted cover* makes two glued sides of each face,
//! so that every edge has two faces; edges are *flipped* in the intrinsic metric until they are
//! Delaunay, so that no weight is negative. A flip changes neither the surface nor its exact
//! operators. Source: [sharp2020].
//!
//! [sharp2020]: https://doi.org/10.1111/cgf.14069

mod cover;
mod delaunay;
mod mollify;
mod robust;

pub use robust::{IntrinsicFaces, RobustLaplacian, robust_laplacian};
