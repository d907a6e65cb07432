//! Estimating curvature.

use std::collections::BTreeMap;

use fairing_operators::curvature::{CurvatureField, VertexStatus};
use fairing_sparse::median;
use serde_json::{Map, Value, json};

use super::object;

/// The report of a curvature by an estimator: the numbers of vertices without a value, for each
/// reason, and of those on the boundary; and the range and the median of each field over the
/// interior vertices, null without interior vertices. `accuracy` is null if the estimator has no
/// errors.
pub fn curvature(estimator: &'static str, field: &CurvatureField) -> Value {
    let ranges = |columns: &[Column<'_>]| {
        object(columns.iter().map(|(name, values)| (*name, spread(field, values))))
    };
    json!({
        "estimator": estimator,
        "vertices": field.len(),
        "undefined": field.status.iter().filter(|status| !status.is_defined()).count(),
        "undefined_because": undefined_because(field),
        "too_thin_face": field.too_thin,
        "narrowed": field.narrowed,
        "boundary": field.boundary.iter().filter(|boundary| **boundary).count(),
        "interior": ranges(&curvatures(field)),
        "accuracy": errors(field).map(|errors| ranges(&errors)),
    })
}

fn spread(field: &CurvatureField, values: &[f64]) -> Value {
    let interior = (0..field.len() as u32).filter(|&v| field.is_interior(v));
    let mut sorted: Vec<f64> = interior.map(|v| values[v as usize]).collect();
    sorted.sort_unstable_by(f64::total_cmp);
    match (sorted.first(), sorted.last()) {
        (Some(least), Some(greatest)) => {
            json!({ "least": least, "median": median(&sorted), "greatest": greatest })
        }
        _ => Value::Null,
    }
}

/// The number of vertices without a value for each reason.
pub fn undefined_because(field: &CurvatureField) -> Map<String, Value> {
    let mut reasons = BTreeMap::<String, usize>::new();
    for status in &field.status {
        if let VertexStatus::Undefined(reason) = status {
            *reasons.entry(reason.to_string()).or_default() += 1;
        }
    }
    reasons.into_iter().map(|(reason, count)| (reason, count.into())).collect()
}

/// Columns of numbers or of vectors with their names.
pub type Columns<T> = Vec<(&'static str, Vec<T>)>;

/// The fields of a curvature in files: `mean`, `gaussian`, `kappa1`, `kappa2`, the standard errors
/// with their `scale` if there are any, and the flags `defined` and `boundary`, which are 0 or 1;
/// and the principal directions `direction1` and `direction2` if there are any.
pub fn fields(field: &CurvatureField) -> (Columns<f64>, Columns<[f64; 3]>) {
    let columns = curvatures(field).into_iter().chain(errors(field).into_iter().flatten());
    let mut scalars: Columns<f64> = columns.map(|(name, x)| (name, x.to_vec())).collect();
    let flag = |flag: bool| f64::from(u8::from(flag));
    scalars.push(("defined", field.status.iter().map(|s| flag(s.is_defined())).collect()));
    scalars.push(("boundary", field.boundary.iter().map(|&b| flag(b)).collect()));
    let directions = field.directions.clone().into_iter().flatten();
    (scalars, ["direction1", "direction2"].into_iter().zip(directions).collect())
}

type Column<'a> = (&'static str, &'a [f64]);

fn curvatures(field: &CurvatureField) -> [Column<'_>; 4] {
    [
        ("mean", &field.mean),
        ("gaussian", &field.gaussian),
        ("kappa1", &field.kappa1),
        ("kappa2", &field.kappa2),
    ]
}

/// The standard errors and the radius with the largest weight in H.
fn errors(field: &CurvatureField) -> Option<[Column<'_>; 3]> {
    let found = field.accuracy.as_ref()?;
    Some([
        ("mean_error", &found.mean_error),
        ("gaussian_error", &found.gaussian_error),
        ("scale", &found.scale),
    ])
}
