//! Errors of an estimator against exact curvature.

use anyhow::{Context as _, Result};
use fairing_mesh::TriMesh;
use fairing_operators::curvature::CurvatureField;
use fairing_operators::surface::PointCurvature;
use fairing_sparse::larger;
use glam::DVec3;

use super::samples::Sample;

/// The columns of [`Study::errors`].
pub(super) const MEASURES: [&str; 8] =
    ["RMS H", "max H", "RMS K", "max K", "RMS κ₁", "max κ₁", "RMS κ₂", "max κ₂"];

/// The exact curvature at inner vertices, `None` elsewhere.
pub(super) fn exact_values(sample: Sample, mesh: &TriMesh) -> Result<Vec<Option<PointCurvature>>> {
    let exact = |&p: &[f64; 3]| {
        let inner = sample.is_inner(p).then(|| sample.exact(p).context("a vertex off the surface"));
        inner.transpose()
    };
    mesh.positions().iter().map(exact).collect()
}

/// Errors of one estimator on one mesh.
#[derive(Debug, Clone)]
pub(super) struct Study {
    /// In the order of [`MEASURES`].
    pub(super) errors: [f64; 8],
    /// In degrees; `None` without directions, or where all points are umbilic.
    pub(super) angle: Option<f64>,
    /// Inner vertices without a value.
    pub(super) undefined: usize,
}

impl Study {
    pub(super) fn new(field: &CurvatureField, exact: &[Option<PointCurvature>]) -> Self {
        let inner = || exact.iter().enumerate().filter_map(|(v, c)| Some((v, (*c)?)));
        let defined = || inner().filter(|(v, _)| field.status[*v].is_defined());
        let count = defined().count() as f64;
        let error = |value: fn(&CurvatureField, usize) -> f64,
                     truth: fn(&PointCurvature) -> f64,
                     size: fn(&PointCurvature) -> f64| {
            let (mut square, mut largest, mut scale) = (0.0, 0.0f64, 0.0);
            for (v, c) in defined() {
                let gap = value(field, v) - truth(&c);
                square += gap * gap;
                largest = largest.max(gap.abs());
                scale += size(&c).powi(2);
            }
            let scale = (scale / count).sqrt();
            [(square / count).sqrt() / scale, largest / scale]
        };
        let h = error(|f, v| f.mean[v], PointCurvature::mean, PointCurvature::mean);
        let k = error(|f, v| f.gaussian[v], PointCurvature::gaussian, PointCurvature::gaussian);
        let a = error(|f, v| f.kappa1[v], |c| c.values[0], |c| c.values[0]);
        let b = error(|f, v| f.kappa2[v], |c| c.values[1], |c| c.values[0]);
        Self {
            errors: [h[0], h[1], k[0], k[1], a[0], a[1], b[0], b[1]],
            angle: angle(field, &defined().collect::<Vec<_>>()),
            undefined: inner().count() - defined().count(),
        }
    }
}

/// The root mean square angle between directions of κ₁, in degrees.
fn angle(field: &CurvatureField, defined: &[(usize, PointCurvature)]) -> Option<f64> {
    let [first, _] = field.directions.as_ref()?;
    let split = |c: &PointCurvature| c.values[0] - c.values[1];
    let largest = defined.iter().map(|(_, c)| split(c)).fold(0.0, larger);
    if largest < 1e-9 {
        return None;
    }
    let angles: Vec<f64> = defined
        .iter()
        .filter(|(_, c)| split(c) > 0.1 * largest)
        .map(|(v, c)| {
            let (found, truth) = (DVec3::from(first[*v]), DVec3::from(c.directions[0]));
            libm::atan2(found.cross(truth).length(), found.dot(truth).abs()).to_degrees()
        })
        .collect();
    let square = angles.iter().map(|a| a * a).sum::<f64>();
    (!angles.is_empty()).then(|| (square / angles.len() as f64).sqrt())
}
