//! All estimates at one vertex.

use std::ops::Range;

use fairing_mesh::Topology;

use super::gather::{Extent, Gathering};
use super::jets::{self, Row};
use super::regression::{self, Point};
use super::site::Sites;

/// The number of regressions, the corrected one-ring density among them.
pub(super) const REGRESSIONS: usize = 1 + regression::RADII.len();

/// The number of candidates: regressions by increasing radius, then jets.
pub(super) const COUNT: usize = MEANS_FROM + regression::MEANS;

/// The first of the means.
pub(super) const MEANS_FROM: usize = REGRESSIONS + jets::RADII.len();

/// The candidates of each family, by increasing radius.
pub(super) const JETS: Range<usize> = REGRESSIONS..MEANS_FROM;
pub(super) const MEANS: Range<usize> = MEANS_FROM..COUNT;

/// The radii of the candidates, in local mean edges; that of one ring stands for its reach.
pub(super) const RADII: [f64; COUNT] = {
    let mut all = [1.4; COUNT];
    let mut k = 1;
    while k < COUNT {
        all[k] = if k < REGRESSIONS {
            regression::RADII[k - 1]
        } else if k < MEANS_FROM {
            jets::RADII[k - REGRESSIONS]
        } else {
            regression::RADII[k + 1 - MEANS_FROM]
        };
        k += 1;
    }
    all
};

/// The least cosine between the normals of the neighbourhood of a jet that judges others.
const STEADY: f64 = 0.2;

/// The largest amplification of a variance.
const MAX_AMPLIFIED: f64 = 1e6;

/// From this regression on, and for all means, K is that of the second form.
const BY_FORM: usize = 3;

/// The balls that are searched: the first of them that is not too full.
const SEARCHED: [f64; 6] = [11.0, 8.0, 5.5, 4.0, 2.75, 2.0];

/// The covariance of H of two regressions, for noise of variance 1 in local areas of a vertex: the
/// sums of products of their derivatives by the heights of a regular plane.
#[rustfmt::skip]
pub(super) const GAINS: [[f64; REGRESSIONS]; REGRESSIONS] = [
    [1.8294e-1, 1.7617e-1, 1.1683e-1, 3.0300e-2, 5.5410e-3, 5.9855e-4, 8.9039e-5],
    [1.7617e-1, 1.7071e-1, 1.1477e-1, 3.0526e-2, 5.5489e-3, 5.9855e-4, 8.9039e-5],
    [1.1683e-1, 1.1477e-1, 8.3995e-2, 2.7244e-2, 5.5293e-3, 5.9855e-4, 8.9039e-5],
    [3.0300e-2, 3.0526e-2, 2.7244e-2, 1.5302e-2, 5.0377e-3, 5.9855e-4, 8.9039e-5],
    [5.5410e-3, 5.5489e-3, 5.5293e-3, 5.0377e-3, 3.2281e-3, 5.9680e-4, 8.9039e-5],
    [5.9855e-4, 5.9855e-4, 5.9855e-4, 5.9855e-4, 5.9680e-4, 4.2194e-4, 8.9028e-5],
    [8.9039e-5, 8.9039e-5, 8.9039e-5, 8.9039e-5, 8.9039e-5, 8.9028e-5, 6.9651e-5],
];

/// The leverage of the intercept of each regression on a regular plane.
const LEVERAGES: [f64; regression::RADII.len()] = [7.6367, 4.9905, 3.4898, 3.1021, 2.8655, 2.7687];

/// The variance of H of each jet on a regular plane.
const JET_GAINS: [f64; jets::RADII.len()] = [4.5966, 0.54598, 0.10758, 0.017439];

/// The same of two means.
#[rustfmt::skip]
const MEAN_GAINS: [[f64; regression::MEANS]; regression::MEANS] = [
    [6.1646e-3, 1.9187e-3, 3.5795e-4, 3.7861e-5, 5.6016e-6],
    [1.9187e-3, 1.0786e-3, 3.2902e-4, 3.7861e-5, 5.6016e-6],
    [3.5795e-4, 3.2902e-4, 2.0832e-4, 3.7768e-5, 5.6016e-6],
    [3.7861e-5, 3.7861e-5, 3.7768e-5, 2.6663e-5, 5.6010e-6],
    [5.6016e-6, 5.6016e-6, 5.6016e-6, 5.6010e-6, 4.3890e-6],
];

/// The candidates at a vertex, in local units.
#[derive(Debug, Clone, Copy)]
pub(super) struct Candidates {
    pub(super) mean: [f64; COUNT],
    pub(super) gaussian: [f64; COUNT],
    /// The second form without its trace.
    pub(super) deviator: [[f32; 2]; COUNT],
    /// A bit for each candidate.
    valid: u16,
    /// The variance of each candidate over that on a regular plane, as at borders; at least 1.
    pub(super) amplified: [f32; COUNT],
    /// A bit for each jet whose neighbourhood is flat enough for comparisons with other candidates.
    steady: u16,
    /// The components along the tangents of the normals of the jets.
    pub(super) lean: [[f32; 2]; jets::RADII.len()],
    /// The covariance of H of the jets, for noise of variance 1.
    covariance: [[f32; jets::RADII.len()]; jets::RADII.len()],
    /// The local area of a vertex.
    area: f32,
}

/// Memory of a search and of fits.
#[derive(Debug, Default)]
pub(super) struct Work {
    gathering: Gathering,
    points: Vec<Point>,
    rows: Vec<Row>,
}

impl Candidates {
    /// The candidates at `v`, and the residual of a jet, as [`jets::Jets::residual`].
    pub(super) fn new(
        sites: &Sites,
        topology: &Topology,
        work: &mut Work,
        v: u32,
        extent: Extent,
    ) -> (Self, Option<f64>) {
        let from = extent as usize;
        let reach = work.gathering.gather(sites, topology, v, &SEARCHED[from..]);
        let found = &mut work.gathering.found;
        let fits = regression::fits(sites, found, &mut work.points);
        let jets = jets::jets(found, &mut work.rows, extent);
        let mut all = Self {
            lean: jets.lean.map(|lean| lean.map(|x| x as f32)),
            covariance: jets.covariance.map(|row| row.map(|x| x as f32)),
            area: sites.area[v as usize] as f32,
            ..Self::none()
        };
        let values = fits.regressions.iter().chain(&jets.values).chain(&fits.means);
        for (k, value) in values.enumerate() {
            if let Some([mean, gaussian, p, q]) = value
                && RADII[k] <= reach.max(2.0)
            {
                let of_form = mean * mean - p * p - q * q;
                let by_form = k >= BY_FORM && !JETS.contains(&k);
                (all.mean[k], all.gaussian[k]) = (*mean, if by_form { of_form } else { *gaussian });
                all.deviator[k] = [*p as f32, *q as f32];
                all.valid |= 1 << k;
            }
        }
        let of_radius = |k: usize| fits.leverage[k] / LEVERAGES[k];
        for (k, amplified) in all.amplified.iter_mut().enumerate() {
            let ratio = match k {
                0 => of_radius(1),
                k if k < REGRESSIONS => of_radius(k - 1),
                k if k < MEANS_FROM => {
                    let jet = k - REGRESSIONS;
                    jets.covariance[jet][jet] / JET_GAINS[jet]
                }
                k => of_radius(k + 1 - MEANS_FROM),
            };
            *amplified = ratio.clamp(1.0, MAX_AMPLIFIED) as f32;
        }
        for (k, cosine) in jets.cosines.iter().enumerate() {
            all.steady |= u16::from(*cosine > STEADY) << (REGRESSIONS + k);
        }
        (all, jets.residual)
    }

    /// No candidates.
    pub(super) fn none() -> Self {
        Self {
            mean: [0.0; COUNT],
            gaussian: [0.0; COUNT],
            deviator: [[0.0; 2]; COUNT],
            valid: 0,
            steady: 0,
            amplified: [1.0; COUNT],
            lean: [[0.0; 2]; jets::RADII.len()],
            covariance: [[0.0; jets::RADII.len()]; jets::RADII.len()],
            area: 0.0,
        }
    }

    /// Returns true where the surface turns so far within 2.75 edges that one ring describes it
    /// best.
    pub(super) fn is_coarse(&self) -> bool {
        !self.is_valid(2)
    }

    pub(super) fn is_steady(&self, k: usize) -> bool {
        self.steady & (1 << k) != 0
    }

    pub(super) fn is_valid(&self, k: usize) -> bool {
        self.valid & (1 << k) != 0
    }

    pub(super) fn value(&self, quantity: Quantity, k: usize) -> f64 {
        match quantity {
            Quantity::Mean => self.mean[k],
            Quantity::Gaussian => self.gaussian[k],
        }
    }

    /// The variance of a candidate for noise of variance `square`.
    pub(super) fn variance(&self, quantity: Quantity, k: usize, noise: Level) -> f64 {
        self.with_mean_variance(quantity, k, noise.of(k) * self.covariance(k, k))
    }

    /// The variance of the difference of two candidates, the second of the larger radius.
    pub(super) fn variance_of_difference(
        &self,
        quantity: Quantity,
        [a, b]: [usize; 2],
        noise: Level,
    ) -> f64 {
        let gain = self.covariance(a, a) + self.covariance(b, b) - 2.0 * self.covariance(a, b);
        self.with_mean_variance(quantity, b, noise.of(a) * gain.max(0.0))
    }

    /// `Var K = 4 Var H (H² + (H² − K) / 2) + (1.75 Var H)²`
    fn with_mean_variance(&self, quantity: Quantity, k: usize, variance: f64) -> f64 {
        match quantity {
            Quantity::Mean => variance,
            Quantity::Gaussian => {
                let square = self.mean[k].powi(2);
                let shape = square + 0.5 * (square - self.gaussian[k]).max(0.0);
                4.0 * variance * shape + (1.75 * variance).powi(2)
            }
        }
    }

    /// The covariance of H of two candidates of a family.
    fn covariance(&self, a: usize, b: usize) -> f64 {
        let amplified = f64::from(self.amplified[a] * self.amplified[b]).sqrt();
        if a < REGRESSIONS {
            return amplified * GAINS[a][b] / f64::from(self.area * self.area);
        }
        if a >= MEANS_FROM {
            let gain = MEAN_GAINS[a - MEANS_FROM][b - MEANS_FROM];
            return amplified * gain / f64::from(self.area * self.area);
        }
        f64::from(self.covariance[a - REGRESSIONS][b - REGRESSIONS])
    }
}

/// The variance of the noise at a vertex, in squared local units.
#[derive(Debug, Clone, Copy)]
pub(super) struct Level {
    /// The variance of heights, for jets.
    pub(super) heights: f64,
    /// The variance for measures, larger by irregular faces and second-order terms.
    pub(super) measures: f64,
}

impl Level {
    fn of(self, k: usize) -> f64 {
        if JETS.contains(&k) { self.heights } else { self.measures }
    }
}

/// H or K.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Quantity {
    Mean,
    Gaussian,
}

/// Both.
pub(super) const QUANTITIES: [Quantity; 2] = [Quantity::Mean, Quantity::Gaussian];

#[cfg(test)]
mod tests {
    use super::*;
    use fairing_mesh::TriMesh;

    /// A regular plane of triangles with sides of one, one vertex raised.
    #[test]
    fn gains_are_those_of_a_regular_plane() {
        let (n, rise) = (46u32, 1e-5);
        let mut positions = vec![];
        let mut faces = vec![];
        for j in 0..n {
            for i in 0..n {
                let (x, y) = (f64::from(i) - 0.5 * f64::from(j), f64::from(j) * 0.75f64.sqrt());
                positions.push([x, y, 0.0]);
                if i + 1 < n && j + 1 < n {
                    let a = j * n + i;
                    faces.extend([[a, a + 1, a + n + 1], [a, a + n + 1, a + n]]);
                }
            }
        }
        positions[(n / 2 * n + n / 2) as usize][2] = rise;
        let mesh = TriMesh::new(positions, faces).unwrap();
        let sites = Sites::new(&mesh);
        let mut work = Work::default();
        let mut sums = [[0.0; COUNT]; COUNT];
        for v in 0..n * n {
            let (all, _) = Candidates::new(&sites, mesh.topology(), &mut work, v, Extent::Wide);
            let derivative = |k: usize| all.mean[k] / rise * 0.75f64.sqrt();
            for i in 0..COUNT {
                for j in 0..COUNT {
                    sums[i][j] += derivative(i) * derivative(j);
                }
            }
        }
        let close = |found: f64, expected: f64| (found / expected - 1.0).abs() < 1e-3;
        for i in 0..COUNT {
            for j in 0..COUNT {
                let expected = match () {
                    () if i.max(j) < REGRESSIONS => GAINS[i][j],
                    () if i.min(j) >= MEANS_FROM => MEAN_GAINS[i - MEANS_FROM][j - MEANS_FROM],
                    () if JETS.contains(&i) && i == j => JET_GAINS[i - REGRESSIONS] * 0.75,
                    () => continue,
                };
                assert!(close(sums[i][j], expected), "{i} {j}: {} {expected}", sums[i][j]);
            }
        }
    }
}
