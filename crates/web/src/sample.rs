//! Meshes made by formula, to begin with.

use anyhow::{Result, bail};
use fairing_mesh::TriMesh;
use fairing_shapes::{self as shapes, Diagonals, Ends, HelicoidOptions};

/// A mesh by name.
pub(crate) struct Sample {
    /// The name in requests.
    pub(crate) name: &'static str,
    /// One line about it.
    pub(crate) about: &'static str,
    make: fn() -> TriMesh,
}

const fn sample(name: &'static str, about: &'static str, make: fn() -> TriMesh) -> Sample {
    Sample { name, about, make }
}

const HELICOID: HelicoidOptions =
    HelicoidOptions { rise: 0.3, radii: [-1.0, 1.0], turns: 2.0, across: 24, along: 160 };

/// All samples.
pub(crate) const SAMPLES: [Sample; 10] = [
    sample("bumpy-sphere", "a sphere with waves", || shapes::bumpy_sphere(5, 0.1, 6.0)),
    sample("creature", "a body with four legs, from a level set", || shapes::creature(96)),
    sample("block", "a machined part with sharp edges", || shapes::cad_block(0.04)),
    sample("torus", "a ring", || shapes::torus(1.0, 0.4, 120, 60)),
    sample("sphere", "a sphere of nearly equal triangles", || shapes::icosphere(5)),
    sample("ellipsoid", "an ellipsoid with axes 3, 2 and 1", || {
        shapes::ellipsoid([1.5, 1.0, 0.5], 5)
    }),
    sample("cube", "a cube of squares cut alternately", || {
        shapes::cube(24, Diagonals::Alternating)
    }),
    sample("cylinder", "a cylinder with open ends", || {
        shapes::cylinder(0.5, 2.0, 80, 60, Ends::Open)
    }),
    sample("flower", "an open surface with uneven triangles", || shapes::flower(0.03, 1)),
    sample("helicoid", "a minimal surface: its mean curvature is zero", || {
        shapes::helicoid(&HELICOID)
    }),
];

/// The sample of that name.
pub(crate) fn made(name: &str) -> Result<TriMesh> {
    match SAMPLES.iter().find(|sample| sample.name == name) {
        Some(sample) => Ok((sample.make)()),
        None => {
            bail!("there is no sample {name:?}; there are {}", SAMPLES.map(|s| s.name).join(", "))
        }
    }
}
