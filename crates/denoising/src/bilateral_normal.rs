//! Bilateral filtering of normals, local and global.

use std::f64::consts::LOG2_E;
use std::sync::{Mutex, PoisonError};

use fairing_mesh::TriMesh;
use fairing_parameters::{Options, Range};
use fairing_sparse::parallel::update;
use fairing_sparse::{CgOptions, FieldOperator, conjugate_gradients, product_by_rows};
use fairing_watch::parallel;
use glam::DVec3;

use super::error::{DenoiseError, solved};
use super::faces::{FaceLists, FaceShapes, Hinges, mean_centroid_distance};
use super::masked::Masked;
use super::vertex_update::follow_normals;
use crate::masked::on_oriented;

fairing_parameters::options! {
    /// Options of [`bilateral_normal`].
    #[derive(Debug, Clone, Copy, PartialEq)]
    #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
    #[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
    pub struct BilateralNormalOptions {
        /// The spatial scale.
        pub spatial: f64 = 1.0, in Range::POSITIVE, unit "mean distances of neighbouring centroids";
        /// The scale of differences between unit normals.
        pub range: f64 = 0.45, in Range::POSITIVE;
        /// Rounds of normal filtering.
        pub iterations: usize = 20;
        /// Vertex updates at the end.
        pub vertex_steps: usize = 10;
    }
    "bilateral-normal": "iterated bilateral filter of normals (Zheng et al. 2011)", ["zheng2011"];
}

/// Denoises by repeated bilateral filtering of face normals.
///
/// Over the faces j that share a vertex with face i, and i itself,
///
/// ```text
/// nᵢ ← normalise Σⱼ Aⱼ exp(−‖cᵢ − cⱼ‖²/2σ_c²) exp(−‖nᵢ − nⱼ‖²/2σ_s²) nⱼ
/// ```
///
/// with areas A and centroids c of the input; then the vertices follow
/// ([`update_vertices`](super::update_vertices)). A face without area takes the direction of its
/// neighbours.
///
/// # Errors
///
/// [`DenoiseError::Option`] for a scale that is not positive.
///
/// Source: [zheng2011], the local iterative scheme.
///
/// [zheng2011]: https://doi.org/10.1109/TVCG.2010.264
pub fn bilateral_normal<'a>(
    mesh: impl Into<Masked<'a>>,
    options: &BilateralNormalOptions,
) -> Result<TriMesh, DenoiseError> {
    on_oriented(mesh.into(), |mesh| filter(mesh, options))
}

fn filter(input: Masked<'_>, options: &BilateralNormalOptions) -> Result<TriMesh, DenoiseError> {
    let mesh = input.mesh();
    options.check()?;
    let weights = Weights::new(mesh, options.spatial, options.range);
    let mut normals = weights.shapes.normals.clone();
    fairing_watch::stage("rounds", options.iterations as u64);
    for _ in 0..options.iterations {
        fairing_watch::advance(1);
        normals = parallel::map(normals.len(), 64, |f| {
            let weighted = weights.row(f, &normals).map(|(g, w)| w * normals[g]);
            weighted.sum::<DVec3>().normalize_or_zero()
        });
    }
    follow_normals(input, &normals, options.vertex_steps)
}

fairing_parameters::options! {
    /// Options of [`bilateral_normal_global`].
    #[derive(Debug, Clone, Copy, PartialEq)]
    #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
    #[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
    pub struct BilateralNormalGlobalOptions {
        /// The spatial scale.
        pub spatial: f64 = 1.0, in Range::POSITIVE, unit "mean distances of neighbouring centroids";
        /// The scale of differences between unit normals.
        pub range: f64 = 0.45, in Range::POSITIVE;
        /// The weight of fidelity to the noisy normals against smoothness.
        pub fidelity: f64 = 0.01, in Range::above(0.0).up_to(1.0);
        /// Vertex updates at the end.
        pub vertex_steps: usize = 10;
    }
    "bilateral-normal-global": "bilateral filter of normals, as one linear system (Zheng et al. 2011)",
        ["zheng2011"];
}

/// Denoises by one linear system in the face normals.
///
/// With the weights W of [`bilateral_normal`], taken from the noisy normals n
/// and scaled to unit row sums, the new normals minimise
///
/// ```text
/// (1 − λ) Σᵢ Aᵢ ‖n′ᵢ − Σⱼ Wᵢⱼ n′ⱼ‖² + λ Σᵢ Aᵢ ‖n′ᵢ − nᵢ‖²
/// ```
///
/// and are scaled to unit length; the vertices follow
/// ([`update_vertices`](super::update_vertices)).
/// Areas are scaled to a mean of one, and a face without area counts as one of
/// 10⁻³.
///
/// # Errors
///
/// [`DenoiseError::Option`] for a parameter outside its range;
/// [`DenoiseError::NotSolved`] if conjugate gradients stall.
///
/// Source: [zheng2011], the global scheme.
///
/// [zheng2011]: https://doi.org/10.1109/TVCG.2010.264
pub fn bilateral_normal_global<'a>(
    mesh: impl Into<Masked<'a>>,
    options: &BilateralNormalGlobalOptions,
) -> Result<TriMesh, DenoiseError> {
    on_oriented(mesh.into(), |mesh| filter_globally(mesh, options))
}

fn filter_globally(
    input: Masked<'_>,
    options: &BilateralNormalGlobalOptions,
) -> Result<TriMesh, DenoiseError> {
    let mesh = input.mesh();
    options.check()?;
    let weights = Weights::new(mesh, options.spatial, options.range);
    let noisy = &weights.shapes.normals;
    let count = noisy.len();
    let rows = Rows::new(&weights, noisy);
    let mean = (weights.shapes.areas.iter().sum::<f64>() / count.max(1) as f64).max(1e-300);
    let areas: Vec<f64> = weights.shapes.areas.iter().map(|a| (a / mean).max(1e-3)).collect();
    let (smooth, keep) = (1.0 - options.fidelity, options.fidelity);
    // Written by every product before it is read.
    let defects = Mutex::new(vec![[0.0; 3]; count]);
    let apply = |x: &[[f64; 3]], product: &mut [[f64; 3]]| {
        let mut defects = defects.lock().unwrap_or_else(PoisonError::into_inner);
        update(&mut defects, |f, _| {
            let mean: DVec3 = rows.forward(f).map(|(g, w)| w * DVec3::from(x[g])).sum();
            ((areas[f] * (DVec3::from(x[f]) - mean)).to_array(), ())
        });
        product_by_rows(x, product, |f| {
            let spread: DVec3 = rows.backward(f).map(|(g, w)| w * DVec3::from(defects[g])).sum();
            let d = DVec3::from(defects[f]);
            (smooth * (d - spread) + keep * areas[f] * DVec3::from(x[f])).to_array()
        })
    };
    let diagonal: Vec<f64> = parallel::map(count, 64, |f| {
        let own = rows.forward(f).find(|&(g, _)| g == f).map_or(0.0, |(_, w)| w);
        let others: f64 =
            rows.backward(f).filter(|&(g, _)| g != f).map(|(g, w)| areas[g] * w * w).sum();
        smooth * (areas[f] * (1.0 - own) * (1.0 - own) + others) + keep * areas[f]
    });
    let b: Vec<[f64; 3]> =
        noisy.iter().zip(&areas).map(|(&n, a)| (keep * a * n).to_array()).collect();
    let accuracy = CgOptions { tolerance: 1e-6, max_iterations: 5000 };
    let operator = FieldOperator::new(&diagonal, apply);
    let found =
        conjugate_gradients(&operator, &b, noisy.iter().map(DVec3::to_array).collect(), &accuracy);
    let normals = solved(found, &accuracy, 0)?;
    let normals: Vec<DVec3> =
        normals.into_iter().map(|n| DVec3::from(n).normalize_or_zero()).collect();
    follow_normals(input, &normals, options.vertex_steps)
}

/// The geometric part of the weights, computed once.
struct Weights {
    shapes: FaceShapes,
    rings: FaceLists,
    /// `−log2(e) / 2σ²`, so that the weight is a power of two.
    spatial: f64,
    range: f64,
}

impl Weights {
    fn new(mesh: &TriMesh, spatial: f64, range: f64) -> Self {
        let shapes = FaceShapes::new(mesh);
        let unit = mean_centroid_distance(&Hinges::new(mesh), &shapes.centroids);
        let half = -0.5 * LOG2_E;
        let spatial = half / (spatial * unit).powi(2).max(f64::MIN_POSITIVE);
        Self { shapes, rings: FaceLists::rings(mesh), spatial, range: half / range.powi(2) }
    }

    /// Face `f` and the faces of its ring with their weights.
    fn row<'a>(
        &'a self,
        f: usize,
        normals: &'a [DVec3],
    ) -> impl Iterator<Item = (usize, f64)> + 'a {
        let FaceShapes { areas, centroids, .. } = &self.shapes;
        std::iter::once(f).chain(self.rings.row(f).iter().map(|&g| g as usize)).map(move |g| {
            let d = centroids[f].distance(centroids[g]);
            let t = normals[f].distance(normals[g]);
            (g, areas[g] * libm::exp2(self.spatial * d * d + self.range * t * t))
        })
    }
}

/// The weights of the global scheme, scaled to unit row sums, by rows and by
/// columns, in the order of the rings.
struct Rows<'a> {
    rings: &'a FaceLists,
    own: Vec<f64>,
    forward: Vec<f64>,
    backward: Vec<f64>,
}

impl<'a> Rows<'a> {
    fn new(weights: &'a Weights, normals: &[DVec3]) -> Self {
        let rings = &weights.rings;
        let mut own = vec![0.0; normals.len()];
        let forward = rings.fill(&mut own, |f, own, row| {
            let mut all = weights.row(f, normals).map(|(_, w)| w);
            *own = all.next().unwrap_or(0.0);
            row.iter_mut().zip(all).for_each(|(slot, w)| *slot = w);
            let sum = row.iter().fold(*own, |sum, w| sum + w);
            // Faces without area all around: an identity row.
            if sum > 0.0 {
                *own /= sum;
                row.iter_mut().for_each(|w| *w /= sum);
            } else {
                *own = 1.0;
            }
        });
        // Sharing a vertex is mutual, so the ring of a face holds the rows of its column.
        let backward = rings.fill(&mut vec![(); normals.len()], |f, (), column| {
            for (slot, &g) in column.iter_mut().zip(rings.row(f)) {
                let place = rings.row(g as usize).partition_point(|&k| (k as usize) < f);
                *slot = forward[rings.range(g as usize)][place];
            }
        });
        Self { rings, own, forward, backward }
    }

    fn forward(&self, f: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        self.entries(f, &self.forward)
    }

    /// Column `f`.
    fn backward(&self, f: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        self.entries(f, &self.backward)
    }

    #[inline]
    fn entries<'b>(
        &'b self,
        f: usize,
        values: &'b [f64],
    ) -> impl Iterator<Item = (usize, f64)> + 'b {
        let ring = self.rings.row(f).iter().map(|&g| g as usize);
        let values = values[self.rings.range(f)].iter().copied();
        std::iter::once((f, self.own[f])).chain(ring.zip(values))
    }
}

#[cfg(test)]
mod tests {
    use fairing_shapes as shapes;

    use super::*;

    /// Column f of the weights is the entry f of each row, and rows sum to one, with a border and
    /// where a face has no area.
    #[test]
    fn columns_are_those_of_the_rows() {
        let mut positions = shapes::plane(5, 4, shapes::Diagonals::Alternating).into_positions();
        positions[7] = positions[8];
        let plane = shapes::plane(5, 4, shapes::Diagonals::Alternating);
        for mesh in [plane.with_positions(positions).unwrap(), shapes::cad_block(0.3)] {
            let weights = Weights::new(&mesh, 1.0, 0.45);
            let rows = Rows::new(&weights, &weights.shapes.normals);
            let count = mesh.face_count();
            let mut columns = vec![vec![]; count];
            for f in 0..count {
                let sum: f64 = rows.forward(f).map(|(_, w)| w).sum();
                assert!((sum - 1.0).abs() < 1e-14, "row {f} sums to {sum}");
                rows.forward(f).for_each(|(g, w)| columns[g].push((f, w)));
            }
            for (f, expected) in columns.iter().enumerate() {
                let mut found: Vec<(usize, f64)> = rows.backward(f).collect();
                found.sort_by_key(|&(g, _)| g);
                assert_eq!(&found, expected, "column {f}");
            }
        }
    }
}
