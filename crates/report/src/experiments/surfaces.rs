//! Closed surfaces whose curvature is known, and meshes of them.

use fairing_mesh::TriMesh;
use fairing_operators::surface::{Ellipsoid, ImplicitSurface, PointCurvature, Sphere, Torus};
use fairing_shapes as shapes;

/// A closed surface with known curvature.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum TestSurface {
    /// The unit sphere.
    Sphere,
    /// Curvature of both signs.
    Torus,
    /// Curvature that varies in two directions.
    Ellipsoid,
}

/// Arrangement of vertices on the surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Sampling {
    /// As the construction gives them.
    Regular,
    /// Moved at random along the surface.
    Jittered,
}

const TORUS: Torus = Torus { major: 1.0, minor: 0.4 };
const AXES: [f64; 3] = [1.0, 1.5, 2.0];

/// The part of the shortest edge by which a jittered vertex moves at most.
pub(super) const JITTER: f64 = 0.3;

impl TestSurface {
    pub(super) const ALL: [Self; 3] = [Self::Sphere, Self::Torus, Self::Ellipsoid];

    /// All of them with their sizes, and the jitter, for a list of parameters.
    pub(super) fn parameters() -> [(&'static str, String); 2] {
        let [a, b, c] = AXES;
        let Torus { major, minor } = TORUS;
        let surfaces = format!(
            "unit sphere; torus with radii {major} and {minor}; ellipsoid with half axes {a}, {b}, {c}"
        );
        [("surfaces", surfaces), ("jitter", format!("{JITTER} of the shortest edge at the vertex"))]
    }

    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Sphere => "sphere",
            Self::Torus => "torus",
            Self::Ellipsoid => "ellipsoid",
        }
    }

    /// The mesh of a refinement level, 2 at least; each has about four times
    /// the faces of the one before, and the three are of about one size. The
    /// seed matters to jittered meshes only.
    pub(super) fn mesh(self, level: u32, sampling: Sampling, seed: u64) -> TriMesh {
        let regular = match self {
            Self::Sphere => shapes::icosphere(level),
            Self::Torus => shapes::torus(TORUS.major, TORUS.minor, 4 << level, 2 << level),
            Self::Ellipsoid => shapes::ellipsoid(AXES, level),
        };
        match (sampling, self) {
            (Sampling::Regular, _) => regular,
            (_, Self::Sphere) => shapes::jittered(&regular, JITTER, seed, shapes::onto_sphere),
            (_, Self::Torus) => shapes::jittered(
                &regular,
                JITTER,
                seed,
                shapes::onto_torus(TORUS.major, TORUS.minor),
            ),
            (_, Self::Ellipsoid) => {
                shapes::jittered(&regular, JITTER, seed, shapes::onto_ellipsoid(AXES))
            }
        }
    }

    /// The exact curvature at a point of the surface; `None` nowhere on it.
    pub(super) fn exact(self, p: [f64; 3]) -> Option<PointCurvature> {
        let [a, b, c] = AXES;
        match self {
            Self::Sphere => Sphere { radius: 1.0 }.curvature(p),
            Self::Torus => TORUS.curvature(p),
            Self::Ellipsoid => Ellipsoid { a, b, c }.curvature(p),
        }
    }
}

impl Sampling {
    pub(super) const BOTH: [Self; 2] = [Self::Regular, Self::Jittered];

    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Regular => "regular",
            Self::Jittered => "jittered",
        }
    }
}
