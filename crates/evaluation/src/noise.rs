//! Seeded noise on vertices.

use fairing_mesh::TriMesh;
use fairing_operators::vertex_normals;
use fairing_parameters::OptionError;
use glam::DVec3;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

use crate::EvaluationError;
use crate::normal::standard_normal;

/// The number of neighbours above which correlation does not pass through a
/// vertex: each of n neighbours would sum over all others.
const HUB: usize = 256;

/// The noise level σ, in the unit of the variant's name.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
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

/// The distribution of the displacements, with the meaning of the level σ.
///
/// Written as its name (`Display`), and read from it (`FromStr`).
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum NoiseKind {
    /// Each coordinate by an independent Gaussian of standard deviation σ: the
    /// root mean square displacement is √3 σ.
    #[cfg_attr(feature = "serde", serde(rename = "axes"))]
    GaussianPerAxis,
    /// Along the vertex normal, by a Gaussian of standard deviation σ.
    #[cfg_attr(feature = "serde", serde(rename = "normal"))]
    GaussianAlongNormals,
    /// In a direction of its own for each vertex, all equally likely, by a
    /// Gaussian of standard deviation σ.
    #[cfg_attr(feature = "serde", serde(rename = "direction"))]
    GaussianAlongDirections,
    /// Each coordinate by a number between −σ and σ, all equally likely: the
    /// root mean square displacement is σ.
    #[cfg_attr(feature = "serde", serde(rename = "uniform"))]
    UniformPerAxis,
    /// As [`Self::GaussianAlongDirections`], but of a share of the vertices
    /// only; the others stay.
    Impulsive {
        /// The probability that a vertex is moved, from 0 to 1.
        share: f64,
    },
    /// Along the vertex normal, by Gaussians of standard deviation σ whose
    /// correlation falls with the number d of edges between two vertices, about
    /// as exp(−d²/r²): a scanner's.
    ///
    /// The displacement of vertex v is Σ k(d) g(w) / √Σ k(d)² over the vertices w
    /// within 3/2 r edges, with independent Gaussians g and k(d) = exp(−2 d²/r²).
    /// Paths of edges do not pass through vertices of more than 256 neighbours,
    /// which would make all around such a vertex alike.
    Correlated {
        /// The reach r, in edges, from 0.1 to 8.
        reach: f64,
    },
    /// Along the vertex normal, by a Gaussian whose standard deviation varies
    /// over the surface from σ/4 to 7σ/4, as σ (1 + ¾ sin 2πt) with t the mean of
    /// the shares of the bounding box along the axes.
    Varying,
}

impl NoiseKind {
    /// One of each, impulsive noise on a quarter of the vertices, correlated
    /// noise over two edges.
    pub const ALL: [Self; 7] = [
        Self::GaussianAlongNormals,
        Self::GaussianPerAxis,
        Self::GaussianAlongDirections,
        Self::UniformPerAxis,
        Self::Impulsive { share: 0.25 },
        Self::Correlated { reach: 2.0 },
        Self::Varying,
    ];

    /// The name on the command line and in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::GaussianAlongNormals => "normal",
            Self::GaussianPerAxis => "axes",
            Self::GaussianAlongDirections => "direction",
            Self::UniformPerAxis => "uniform",
            Self::Impulsive { .. } => "impulsive",
            Self::Correlated { .. } => "correlated",
            Self::Varying => "varying",
        }
    }

    /// One-line description of the displacement.
    pub fn description(self) -> &'static str {
        match self {
            Self::GaussianAlongNormals => "Gaussian along the vertex normal",
            Self::GaussianPerAxis => "Gaussian along each axis (the assignment's)",
            Self::GaussianAlongDirections => "Gaussian along a random direction",
            Self::UniformPerAxis => "uniform along each axis",
            Self::Impulsive { .. } => {
                "Gaussian along a random direction, on a share of the vertices"
            }
            Self::Correlated { .. } => {
                "Gaussian along the vertex normal, alike at vertices up to two edges apart"
            }
            Self::Varying => "Gaussian along the vertex normal, its level varying over the surface",
        }
    }
}

fairing_parameters::named!(NoiseKind, "kind of noise");

/// Adds noise to the vertices; faces and topology are shared with the input.
///
/// Each vertex draws the same amount of random numbers in vertex order from
/// ChaCha8, so that the noise of a seed does not depend on the level, and
/// grows with it in proportion. Vertices without a normal (isolated ones) stay
/// where noise follows the normals.
///
/// # Errors
///
/// [`EvaluationError::Option`] if the level is negative or not finite
/// or the share is not between 0 and 1 or the reach not between 0.1 and 8;
/// [`EvaluationError::Positions`] if the moved vertices are not a valid mesh.
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
    OptionError::require_not_negative("noise level in mesh units", sigma)?;
    if let NoiseKind::Impulsive { share } = kind {
        OptionError::require_fraction("share of impulses", share)?;
    }
    if let NoiseKind::Correlated { reach } = kind {
        let between = (0.1..=8.0).contains(&reach);
        OptionError::require(between, "reach of the noise", reach, "between 0.1 and 8")?;
    }
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let displacements = match kind {
        NoiseKind::GaussianAlongNormals | NoiseKind::Correlated { .. } | NoiseKind::Varying => {
            along_normals(mesh, kind, &mut rng)
        }
        _ => (0..mesh.vertex_count()).map(|_| in_space(kind, &mut rng)).collect(),
    };
    let positions = mesh.positions().iter().zip(displacements);
    let positions =
        positions.map(|(&p, unit)| (DVec3::from(p) + sigma * unit).to_array()).collect();
    mesh.with_positions(positions).map_err(EvaluationError::Positions)
}

/// A displacement for σ = 1 that does not follow the surface.
fn in_space(kind: NoiseKind, rng: &mut ChaCha8Rng) -> DVec3 {
    match kind {
        NoiseKind::GaussianPerAxis => std::array::from_fn(|_| standard_normal(rng)).into(),
        NoiseKind::UniformPerAxis => std::array::from_fn(|_| rng.random_range(-1.0..=1.0)).into(),
        NoiseKind::Impulsive { share } => {
            let moved = rng.random::<f64>() < share;
            let direction = direction(rng);
            (if moved { standard_normal(rng) } else { 0.0 }) * direction
        }
        _ => {
            let direction = direction(rng);
            standard_normal(rng) * direction
        }
    }
}

/// The displacements for σ = 1 of a noise along the normals.
fn along_normals(mesh: &TriMesh, kind: NoiseKind, rng: &mut ChaCha8Rng) -> Vec<DVec3> {
    let normals = vertex_normals(mesh);
    let mut heights: Vec<f64> = normals.iter().map(|_| standard_normal(rng)).collect();
    match kind {
        NoiseKind::Correlated { reach } => heights = correlated(mesh, &heights, reach),
        NoiseKind::Varying => {
            for (height, &p) in heights.iter_mut().zip(mesh.positions()) {
                *height *= level_at(mesh, p);
            }
        }
        _ => {}
    }
    normals.iter().zip(heights).map(|(&n, height)| height * DVec3::from(n)).collect()
}

/// The level of varying noise at a point, for σ = 1.
fn level_at(mesh: &TriMesh, p: [f64; 3]) -> f64 {
    let Some([low, high]) = mesh.bounding_box() else { return 1.0 };
    let share = |k: usize| {
        let width = high[k] - low[k];
        if width > 0.0 { (p[k] - low[k]) / width } else { 0.0 }
    };
    let t = (share(0) + share(1) + share(2)) / 3.0;
    1.0 + 0.75 * libm::sin(std::f64::consts::TAU * t)
}

/// Independent heights averaged over the vertices within 3/2 of the reach, with
/// weights that leave their variance.
fn correlated(mesh: &TriMesh, heights: &[f64], reach: f64) -> Vec<f64> {
    let topology = mesh.topology();
    let rings = (1.5 * reach).floor() as u32;
    let weights: Vec<f64> =
        (0..=rings).map(|d| libm::exp(-2.0 * f64::from(d).powi(2) / (reach * reach))).collect();
    // A thread's marks are as many as vertices: for few runs of vertices only.
    let run = heights.len().div_ceil(64);
    (0..heights.len())
        .into_par_iter()
        .with_min_len(run)
        .map_init(
            || (vec![u32::MAX; heights.len()], vec![]),
            |(found_for, found), v| {
                let v = v as u32;
                found.clear();
                found.push(v);
                found_for[v as usize] = v;
                let (mut from, mut sum, mut square) = (0, 0.0, 0.0);
                for weight in &weights {
                    let end = found.len();
                    for &w in &found[from..end] {
                        sum += weight * heights[w as usize];
                        square += weight * weight;
                    }
                    for k in from..end {
                        let neighbors = topology.neighbors(found[k]);
                        if neighbors.len() > HUB && found[k] != v {
                            continue;
                        }
                        for &w in neighbors {
                            if std::mem::replace(&mut found_for[w as usize], v) != v {
                                found.push(w);
                            }
                        }
                    }
                    from = end;
                }
                sum / square.sqrt()
            },
        )
        .collect()
}

/// A unit vector, all directions equally likely: by the area of the sphere
/// between two heights, which depends on their difference only.
fn direction(rng: &mut ChaCha8Rng) -> DVec3 {
    let z: f64 = rng.random_range(-1.0..=1.0);
    let (s, c) = libm::sincos(rng.random_range(0.0..std::f64::consts::TAU));
    let r = (1.0 - z * z).sqrt();
    let d = DVec3::new(r * c, r * s, z);
    debug_assert!((d.length() - 1.0).abs() < 1e-12);
    d
}

#[cfg(test)]
mod tests {
    use fairing_shapes as shapes;

    use super::*;

    const KINDS: [NoiseKind; 7] = NoiseKind::ALL;

    #[test]
    fn names_read_back() {
        for kind in KINDS {
            assert_eq!(kind.to_string().parse(), Ok(kind));
        }
        assert!("white".parse::<NoiseKind>().unwrap_err().to_string().contains("axes, direction"));
    }

    fn displacements(kind: NoiseKind, level: NoiseLevel, seed: u64) -> Vec<DVec3> {
        let sphere = shapes::icosphere(5);
        let noisy = add_noise(&sphere, kind, level, seed).unwrap();
        noisy
            .positions()
            .iter()
            .zip(sphere.positions())
            .map(|(&p, &q)| DVec3::from(p) - DVec3::from(q))
            .collect()
    }

    /// 10242 vertices: the variance of a Gaussian is known to √(2/n) = 1.4 %,
    /// of an impulse of share ¼ to 2.4 times that, of correlated noise, which has
    /// a tenth as many independent values, to 4 %; four standard errors. The mean
    /// square level of varying noise is 1 + 9/32 where t is spread evenly; on a
    /// sphere it is near ½ more often, where the level is near one.
    #[test]
    fn each_kind_has_its_variance() {
        let sigma = 0.01;
        for (kind, expected) in KINDS.into_iter().zip([1.0, 3.0, 1.0, 1.0, 0.25, 1.0, 1.21]) {
            let d = displacements(kind, NoiseLevel::Model(sigma), 1);
            let square = d.iter().map(|&x| x.dot(x)).sum::<f64>() / d.len() as f64;
            let ratio = square / (sigma * sigma) / expected;
            assert!((ratio - 1.0).abs() < 0.16, "{kind:?}: {ratio}");
            let independent = match kind {
                NoiseKind::Correlated { .. } => 0.08 * d.len() as f64,
                _ => d.len() as f64,
            };
            for k in 0..3 {
                let mean = d.iter().map(|x| x[k]).sum::<f64>() / d.len() as f64;
                assert!(mean.abs() < 4.0 * sigma / independent.sqrt(), "{kind:?}: {mean}");
            }
        }
    }

    #[test]
    fn noise_along_normals_is_radial_on_a_sphere() {
        let sphere = shapes::icosphere(4);
        let level = NoiseLevel::EdgeLengths(0.1);
        let noisy = add_noise(&sphere, NoiseKind::GaussianAlongNormals, level, 3).unwrap();
        for (&p, &q) in noisy.positions().iter().zip(sphere.positions()) {
            let q = DVec3::from(q);
            let d = DVec3::from(p) - q;
            // Area-weighted normals of an icosphere are off by O(h²).
            assert!(d.dot(q).abs() >= 0.999 * d.length(), "{d:?} at {q:?}");
        }
    }

    /// Heights at vertices d edges apart on a regular mesh: the sum of products
    /// of the weights over their squares. exp(−d²/4) is the limit of a wide and
    /// fine kernel in the plane; rings count more vertices than their share.
    #[test]
    fn correlation_falls_with_edges() {
        let plane = shapes::plane(100, 100, shapes::Diagonals::Regular);
        let kind = NoiseKind::Correlated { reach: 2.0 };
        let noisy = add_noise(&plane, kind, NoiseLevel::Model(1.0), 4).unwrap();
        let height = |i: usize, j: usize| noisy.positions()[j * 101 + i][2];
        let correlation = |d: usize| {
            let products = (5..85).flat_map(|i| (5..95).map(move |j| (i, j)));
            let sum: f64 = products.map(|(i, j)| height(i, j) * height(i + d, j)).sum();
            sum / 7200.0
        };
        for (d, expected) in [(1, 0.78), (2, 0.37), (4, 0.02), (7, 0.0)] {
            let found = correlation(d);
            // About 600 independent patches.
            assert!((found - expected).abs() < 0.13, "{d} edges: {found}");
        }
    }

    /// A fan of 20000 faces: all pairs of rim vertices would be 200 million.
    #[test]
    fn correlation_does_not_pass_through_a_hub() {
        let n = 20_000u32;
        let rim = (0..n).map(|i| {
            let (y, x) = libm::sincos(std::f64::consts::TAU * f64::from(i) / f64::from(n));
            [x, y, 0.0]
        });
        let positions = std::iter::once([0.0; 3]).chain(rim).collect();
        let faces = (0..n).map(|i| [0, i + 1, (i + 1) % n + 1]).collect();
        let fan = TriMesh::new(positions, faces).unwrap();
        let kind = NoiseKind::Correlated { reach: 2.0 };
        let noisy = add_noise(&fan, kind, NoiseLevel::Model(1.0), 4).unwrap();
        let height = |i: u32| noisy.positions()[(i % n) as usize + 1][2];
        let mean = |f: &dyn Fn(u32) -> f64| (0..n).map(f).sum::<f64>() / f64::from(n);
        // The hub's own part is in all of them; of the rest, there are about 5000
        // independent stretches.
        let common = mean(&height);
        let product = |apart: u32| mean(&|i| (height(i) - common) * (height(i + apart) - common));
        let (near, far) = (product(1) / product(0), product(9) / product(0));
        assert!(near > 0.6 && far.abs() < 0.1, "{near} {far}");
    }

    #[test]
    fn the_level_varies() {
        let sphere = shapes::icosphere(5);
        let noisy = add_noise(&sphere, NoiseKind::Varying, NoiseLevel::Model(1e-3), 2).unwrap();
        // Where the coordinates add up to the sine's peak, and to its valley.
        let spread = |near: f64| {
            let at = sphere.positions().iter().zip(noisy.positions()).filter_map(|(&p, &q)| {
                let sum = p[0] + p[1] + p[2];
                ((sum - near).abs() < 0.2).then(|| DVec3::from(q).distance(p.into()).powi(2))
            });
            let (sum, count) = at.fold((0.0, 0), |(s, n), x| (s + x, n + 1));
            (sum / f64::from(count)).sqrt()
        };
        assert!((spread(-1.5) / 1.75e-3 - 1.0).abs() < 0.1, "{}", spread(-1.5));
        assert!((spread(1.5) / 0.25e-3 - 1.0).abs() < 0.15, "{}", spread(1.5));
    }

    #[test]
    fn impulses_move_their_share() {
        let d = displacements(NoiseKind::Impulsive { share: 0.25 }, NoiseLevel::Model(1.0), 9);
        let moved = d.iter().filter(|&&x| x != DVec3::ZERO).count() as f64 / d.len() as f64;
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
                assert!((2.0 * *x - *y).length() < 1e-14);
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
            let Err(EvaluationError::Option(OptionError { option, .. })) = e else {
                panic!("{e:?}")
            };
            assert_eq!(option, "noise level in mesh units");
        }
        let kind = NoiseKind::Impulsive { share: 1.5 };
        let e = add_noise(&sphere, kind, NoiseLevel::Model(1.0), 0).unwrap_err();
        assert_eq!(e.to_string(), "share of impulses is 1.5, but must be between 0 and 1");
        let kind = NoiseKind::Correlated { reach: 0.0 };
        let e = add_noise(&sphere, kind, NoiseLevel::Model(1.0), 0).unwrap_err();
        assert_eq!(e.to_string(), "reach of the noise is 0, but must be between 0.1 and 8");
        let e = add_noise(&sphere, NoiseKind::GaussianPerAxis, NoiseLevel::Model(1e308), 0);
        assert!(matches!(e, Err(EvaluationError::Positions(_))));
    }
}
