//! Seeded noise on vertices.

use fairing_mesh::TriMesh;
use fairing_mesh::vec3::{add, norm, scale};
use fairing_operators::vertex_normals;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::EvaluationError;
use crate::normal::standard_normal;

/// How large the noise is, in the unit of its name.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum NoiseLevel {
    /// In mesh units.
    Model(f64),
    /// In mean edge lengths h, an edge counted once for each of its faces.
    EdgeLengths(f64),
    /// In diagonals of the bounding box.
    Diagonals(f64),
}

impl NoiseLevel {
    /// The level on this mesh, in mesh units.
    pub fn in_mesh_units(self, mesh: &TriMesh) -> f64 {
        match self {
            Self::Model(sigma) => sigma,
            Self::EdgeLengths(share) => share * mesh.mean_edge_length(),
            Self::Diagonals(share) => share * mesh.diagonal(),
        }
    }
}

/// What the level σ measures, and where it moves the vertices.
///
/// Written as its name (`Display`), and read from it (`FromStr`).
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum NoiseKind {
    /// Each coordinate by an independent Gaussian of standard deviation σ: the
    /// root mean square displacement is √3 σ.
    GaussianPerAxis,
    /// Along the vertex normal, by a Gaussian of standard deviation σ.
    GaussianAlongNormals,
    /// In a direction of its own for each vertex, all equally likely, by a
    /// Gaussian of standard deviation σ.
    GaussianAlongDirections,
    /// Each coordinate by a number between −σ and σ, all equally likely: the
    /// root mean square displacement is σ.
    UniformPerAxis,
    /// As [`Self::GaussianAlongDirections`], but of a share of the vertices
    /// only; the others stay.
    Impulsive {
        /// The probability of each vertex to be moved, from 0 to 1.
        share: f64,
    },
}

impl NoiseKind {
    /// One of each, impulsive noise on a quarter of the vertices.
    pub const ALL: [Self; 5] = [
        Self::GaussianAlongNormals,
        Self::GaussianPerAxis,
        Self::GaussianAlongDirections,
        Self::UniformPerAxis,
        Self::Impulsive { share: 0.25 },
    ];

    /// The name on the command line and in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::GaussianAlongNormals => "normal",
            Self::GaussianPerAxis => "axes",
            Self::GaussianAlongDirections => "direction",
            Self::UniformPerAxis => "uniform",
            Self::Impulsive { .. } => "impulsive",
        }
    }

    /// One line: how vertices move.
    pub fn description(self) -> &'static str {
        match self {
            Self::GaussianAlongNormals => "Gaussian along the vertex normal",
            Self::GaussianPerAxis => "Gaussian along each axis (the assignment's)",
            Self::GaussianAlongDirections => "Gaussian along a random direction",
            Self::UniformPerAxis => "uniform along each axis",
            Self::Impulsive { .. } => {
                "Gaussian along a random direction, on a share of the vertices"
            }
        }
    }
}

fairing_mesh::named!(NoiseKind, "kind of noise");

/// The mesh with noise on its vertices; faces and topology are shared.
///
/// Each vertex draws the same amount of random numbers in vertex order from
/// ChaCha8, so that the noise of a seed does not depend on the level, and
/// grows with it in proportion. Vertices without a normal (isolated ones) stay
/// where noise follows the normals.
///
/// # Errors
///
/// [`EvaluationError::NoiseParameter`] if the level is negative or not finite
/// or the share is not between 0 and 1; [`EvaluationError::Positions`] if a
/// position leaves the range of numbers.
///
/// # Examples
///
/// ```
/// use fairing_evaluation::{NoiseKind, NoiseLevel, add_noise};
/// let sphere = fairing_shapes::icosphere(3);
/// let noisy = add_noise(&sphere, NoiseKind::GaussianPerAxis, NoiseLevel::EdgeLengths(0.2), 7)?;
/// assert_eq!(noisy.faces(), sphere.faces());
/// # Ok::<(), fairing_evaluation::EvaluationError>(())
/// ```
pub fn add_noise(
    mesh: &TriMesh,
    kind: NoiseKind,
    level: NoiseLevel,
    seed: u64,
) -> Result<TriMesh, EvaluationError> {
    let sigma = level.in_mesh_units(mesh);
    if !sigma.is_finite() || sigma < 0.0 {
        return Err(EvaluationError::NoiseParameter { what: "level", value: sigma });
    }
    if let NoiseKind::Impulsive { share } = kind
        && !(0.0..=1.0).contains(&share)
    {
        return Err(EvaluationError::NoiseParameter { what: "share", value: share });
    }
    let normals = match kind {
        NoiseKind::GaussianAlongNormals => vertex_normals(mesh),
        _ => vec![],
    };
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let positions = mesh
        .positions()
        .iter()
        .enumerate()
        .map(|(v, &p)| {
            let unit = match kind {
                NoiseKind::GaussianPerAxis => std::array::from_fn(|_| standard_normal(&mut rng)),
                NoiseKind::GaussianAlongNormals => scale(normals[v], standard_normal(&mut rng)),
                NoiseKind::GaussianAlongDirections => {
                    let direction = direction(&mut rng);
                    scale(direction, standard_normal(&mut rng))
                }
                NoiseKind::UniformPerAxis => std::array::from_fn(|_| rng.random_range(-1.0..=1.0)),
                NoiseKind::Impulsive { share } => {
                    let moved = rng.random::<f64>() < share;
                    let direction = direction(&mut rng);
                    scale(direction, if moved { standard_normal(&mut rng) } else { 0.0 })
                }
            };
            add(p, scale(unit, sigma))
        })
        .collect();
    mesh.with_positions(positions).map_err(EvaluationError::Positions)
}

/// A unit vector, all directions equally likely: by the area of the sphere
/// between two heights, which depends on their difference only.
fn direction(rng: &mut ChaCha8Rng) -> [f64; 3] {
    let z: f64 = rng.random_range(-1.0..=1.0);
    let (s, c) = libm::sincos(rng.random_range(0.0..std::f64::consts::TAU));
    let r = (1.0 - z * z).sqrt();
    let d = [r * c, r * s, z];
    debug_assert!((norm(d) - 1.0).abs() < 1e-12);
    d
}

#[cfg(test)]
mod tests {
    use fairing_mesh::vec3::{dot, sub};
    use fairing_shapes as shapes;

    use super::*;

    const KINDS: [NoiseKind; 5] = NoiseKind::ALL;

    #[test]
    fn names_read_back() {
        for kind in KINDS {
            assert_eq!(kind.to_string().parse(), Ok(kind));
        }
        assert!("white".parse::<NoiseKind>().unwrap_err().to_string().contains("axes, direction"));
    }

    fn displacements(kind: NoiseKind, level: NoiseLevel, seed: u64) -> Vec<[f64; 3]> {
        let sphere = shapes::icosphere(5);
        let noisy = add_noise(&sphere, kind, level, seed).unwrap();
        noisy.positions().iter().zip(sphere.positions()).map(|(&p, &q)| sub(p, q)).collect()
    }

    /// 10242 vertices: the variance of a Gaussian is known to √(2/n) = 1.4 %,
    /// of an impulse of share ¼ to 2.4 times that; four standard errors.
    #[test]
    fn each_kind_has_its_variance() {
        let sigma = 0.01;
        for (kind, expected) in KINDS.into_iter().zip([1.0, 3.0, 1.0, 1.0, 0.25]) {
            let d = displacements(kind, NoiseLevel::Model(sigma), 1);
            let square = d.iter().map(|&x| dot(x, x)).sum::<f64>() / d.len() as f64;
            let ratio = square / (sigma * sigma) / expected;
            assert!((ratio - 1.0).abs() < 0.14, "{kind:?}: {ratio}");
            for k in 0..3 {
                let mean = d.iter().map(|x| x[k]).sum::<f64>() / d.len() as f64;
                assert!(mean.abs() < 4.0 * sigma / (d.len() as f64).sqrt(), "{kind:?}: {mean}");
            }
        }
    }

    #[test]
    fn noise_along_normals_is_radial_on_a_sphere() {
        let sphere = shapes::icosphere(4);
        let level = NoiseLevel::EdgeLengths(0.1);
        let noisy = add_noise(&sphere, NoiseKind::GaussianAlongNormals, level, 3).unwrap();
        for (&p, &q) in noisy.positions().iter().zip(sphere.positions()) {
            let d = sub(p, q);
            // Area-weighted normals of an icosphere are off by O(h²).
            assert!(dot(d, q).abs() >= 0.999 * norm(d), "{d:?} at {q:?}");
        }
    }

    #[test]
    fn impulses_move_their_share() {
        let d = displacements(NoiseKind::Impulsive { share: 0.25 }, NoiseLevel::Model(1.0), 9);
        let moved = d.iter().filter(|&&x| x != [0.0; 3]).count() as f64 / d.len() as f64;
        // Four standard errors of a share of ¼ among 10242.
        assert!((moved - 0.25).abs() < 0.018, "{moved}");
    }

    #[test]
    fn the_seed_decides_and_the_level_scales() {
        for kind in KINDS {
            let a = displacements(kind, NoiseLevel::Model(0.5), 5);
            assert_eq!(a, displacements(kind, NoiseLevel::Model(0.5), 5));
            assert_ne!(a, displacements(kind, NoiseLevel::Model(0.5), 6));
            let b = displacements(kind, NoiseLevel::Model(1.0), 5);
            for (x, y) in a.iter().zip(&b) {
                // Differences of numbers up to 5, rounded.
                assert!(norm(sub(scale(*x, 2.0), *y)) < 1e-14);
            }
        }
    }

    #[test]
    fn units() {
        let sphere = shapes::icosphere(2);
        let h = sphere.mean_edge_length();
        assert_eq!(NoiseLevel::EdgeLengths(0.5).in_mesh_units(&sphere), 0.5 * h);
        assert_eq!(NoiseLevel::Diagonals(2.0).in_mesh_units(&sphere), 2.0 * sphere.diagonal());
    }

    #[test]
    fn bad_parameters_are_named() {
        let sphere = shapes::icosphere(1);
        for level in [-1.0, f64::NAN, f64::INFINITY] {
            let e = add_noise(&sphere, NoiseKind::UniformPerAxis, NoiseLevel::Model(level), 0);
            assert!(matches!(e, Err(EvaluationError::NoiseParameter { what: "level", .. })));
        }
        let kind = NoiseKind::Impulsive { share: 1.5 };
        let e = add_noise(&sphere, kind, NoiseLevel::Model(1.0), 0).unwrap_err();
        assert_eq!(e.to_string(), "the share of the noise is 1.5");
        let e = add_noise(&sphere, NoiseKind::GaussianPerAxis, NoiseLevel::Model(1e308), 0);
        assert!(matches!(e, Err(EvaluationError::Positions(_))));
    }
}
