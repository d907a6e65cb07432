//! Size, triangulation and proportions of a model.

use fairing_mesh::TriMesh;
use glam::DVec3;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// The kind of triangulation.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Triangulation {
    /// Nearly equal triangles.
    Regular,
    /// Delaunay triangles of points at random.
    Irregular,
    /// Triangles stretched by about three, as exports of CAD programs have them.
    Anisotropic,
    /// Density that varies by ten over the model.
    Graded,
}

fairing_parameters::named!(Triangulation, "triangulation",
    Regular: "regular",
    Irregular: "irregular",
    Anisotropic: "anisotropic",
    Graded: "graded",
);

/// The length of edges, relative to the mean, at a point of a model about two
/// across: from 0.56 to 1.78.
pub(super) fn grading([x, y, z]: [f64; 3]) -> f64 {
    libm::exp(0.576 * libm::sin(1.7 * (x + 0.6 * y + 0.4 * z) + 0.3))
}

/// The parameters of a mesh of a family.
#[derive(Debug, Clone, Copy)]
pub(super) struct Build {
    pub(super) spacing: f64,
    pub(super) triangulation: Triangulation,
    pub(super) seed: u64,
}

impl Build {
    /// The numbers that decide on proportions.
    pub(super) fn proportions(self) -> Proportions {
        Proportions(ChaCha8Rng::seed_from_u64(self.seed))
    }
}

/// Random proportions.
pub(super) struct Proportions(pub(super) ChaCha8Rng);

impl Proportions {
    pub(super) fn between(&mut self, low: f64, high: f64) -> f64 {
        self.0.random_range(low..high)
    }

    pub(super) fn count(&mut self, low: u32, high: u32) -> u32 {
        self.0.random_range(low..=high)
    }

    /// A unit vector, all directions equally likely.
    pub(super) fn direction(&mut self) -> DVec3 {
        let z = self.between(-1.0, 1.0);
        let (s, c) = libm::sincos(self.between(0.0, std::f64::consts::TAU));
        let r = (1.0 - z * z).sqrt();
        DVec3::new(r * c, r * s, z)
    }

    /// Evenly in the logarithm; `low` if the interval is empty.
    pub(super) fn log_between(&mut self, low: f64, high: f64) -> f64 {
        low * libm::pow((high / low).max(1.0), self.between(0.0, 1.0))
    }

    /// Three unit vectors at right angles.
    pub(super) fn axes(&mut self) -> [DVec3; 3] {
        loop {
            let x = self.direction();
            let y = x.cross(self.direction());
            if y.length() > 0.1 {
                let y = y * (1.0 / y.length());
                return [x, y, x.cross(y)];
            }
        }
    }
}

/// The mesh that `make` returns with about this many faces.
pub(super) fn sized(
    make: impl Fn(Build) -> TriMesh,
    faces: usize,
    triangulation: Triangulation,
    seed: u64,
) -> TriMesh {
    assert!((2000..=100_000).contains(&faces), "{faces} faces are not in 2000..=100000");
    let build = |spacing| make(Build { spacing, triangulation, seed });
    // A coarse mesh shows how many faces there are to a spacing.
    let coarse = 0.12;
    let mut spacing = coarse * (build(coarse).face_count() as f64 / faces as f64).sqrt();
    let mut mesh = build(spacing);
    for _ in 0..3 {
        let fraction = mesh.face_count() as f64 / faces as f64;
        if (fraction - 1.0).abs() < 0.08 {
            break;
        }
        spacing *= fraction.sqrt();
        mesh = build(spacing);
    }
    mesh
}

/// A mesh from positions and faces that the construction of a model guarantees.
pub(super) fn made(positions: Vec<[f64; 3]>, faces: Vec<[u32; 3]>) -> TriMesh {
    match TriMesh::new(positions, faces) {
        Ok(mesh) => mesh,
        Err(error) => panic!("a family gives no mesh: {error}"),
    }
}
