//! Smoothing a mesh.

use fairing_mesh::TriMesh;
use fairing_smoothing::{Approach, Method, Smoothed};
use fairing_sparse::larger;
use glam::DVec3;
use serde_json::{Value, json};

/// The report of a method that has made `smoothed` of `before`: the entries of its
/// [report](fairing_smoothing::Report), the nearest numbers of modes that split no cluster if it
/// keeps modes, the changes of volume and area in percent, null without volume or area, and the
/// largest displacement.
pub fn smooth(method: &Method, before: &TriMesh, smoothed: &Smoothed) -> Value {
    let (report, after) = (&smoothed.report, &smoothed.mesh);
    let (gap_below, gap_above) = match (report.approach, report.split) {
        (Approach::Modes { .. }, Some(split)) => (Some(split.below), split.above),
        (Approach::Modes { count }, None) => (Some(count), Some(count)),
        _ => (None, None),
    };
    let moves = before.positions().iter().zip(after.positions());
    let distances = moves.map(|(&p, &q)| DVec3::from(p).distance(q.into()));
    json!({
        "gap_below": gap_below,
        "gap_above": gap_above,
        "method": method.name(),
        "iterations": report.iterations,
        "stopped": report.stopped,
        "stable_limit": report.stable_limit,
        "unstable": report.unstable,
        "too_thin_face": report.too_thin,
        "degenerate_faces": report.degenerate_faces,
        "computed_by": report.approach.to_string(),
        "worst_residual": report.worst_residual,
        "volume_change_percent": volume_change(before, after),
        "area_change_percent": percent(before.area(), after.area()),
        "largest_displacement": distances.fold(0.0, larger),
    })
}

fn percent(old: f64, new: f64) -> Option<f64> {
    (old != 0.0).then(|| 100.0 * (new / old - 1.0))
}

/// The change of volume in percent. The volume of a flat closed mesh is pure rounding; a ball of
/// the same area has (area/π)^(3/2)/6.
fn volume_change(before: &TriMesh, after: &TriMesh) -> Option<f64> {
    let old = before.signed_volume();
    let is_solid =
        before.topology().is_closed() && old.abs() > 1e-12 * libm::pow(before.area(), 1.5);
    if is_solid { percent(old, after.signed_volume()) } else { None }
}
