//! Comparison of two outputs within a tolerance.

use anyhow::{Context as _, Result, bail, ensure};
use fairing_mesh::io;
use serde_json::Value;

/// Compares two outputs of this kind; the tolerance is relative to the largest value of each field.
pub(crate) fn check(kind: &str, here: &[u8], there: &[u8], tolerance: f64) -> Result<()> {
    match kind {
        "ply" => meshes(here, there, tolerance),
        "json" => {
            let [a, b] = [here, there].map(serde_json::from_slice::<Value>);
            let (a, b) = (a?, b?);
            eigenvalues(&a, &b)
        }
        other => bail!("there is no comparison of {other}"),
    }
}

/// Positions and scalar fields; directions are undefined at umbilic points.
fn meshes(here: &[u8], there: &[u8], tolerance: f64) -> Result<()> {
    let folder = tempfile::tempdir()?;
    let read = |name: &str, bytes: &[u8]| -> Result<io::MeshFile> {
        let path = folder.path().join(name);
        std::fs::write(&path, bytes)?;
        Ok(io::read(path)?)
    };
    let (a, b) = (read("a.ply", here)?, read("b.ply", there)?);
    ensure!(a.mesh.faces() == b.mesh.faces(), "other faces");
    let [x, y] = [&a, &b].map(|file| file.mesh.positions().as_flattened());
    fields("positions", x, y, tolerance)?;
    ensure!(a.fields.scalars.len() == b.fields.scalars.len(), "other fields");
    for ((name, x), (other, y)) in a.fields.scalars.iter().zip(&b.fields.scalars) {
        ensure!(name == other, "the field {name} became {other}");
        fields(name, x, y, tolerance)?;
    }
    Ok(())
}

fn fields(name: &str, a: &[f64], b: &[f64], tolerance: f64) -> Result<()> {
    ensure!(a.len() == b.len(), "{name}: {} values, and {}", a.len(), b.len());
    let size = a.iter().fold(0.0, |s: f64, x| s.max(x.abs()));
    for (k, (x, y)) in a.iter().zip(b).enumerate() {
        let close = x == y || (x - y).abs() <= tolerance * size;
        ensure!(close, "{name}, value {k}: {x} here, {y} there, {size} at most");
    }
    Ok(())
}

/// Eigenvalues agree within the sum of their residuals and the rounding of the matrix, which is
/// relative to its largest eigenvalue; 1e4 bounds it for these meshes.
fn eigenvalues(a: &Value, b: &Value) -> Result<()> {
    let numbers = |v: &Value, key: &str| -> Result<Vec<f64>> {
        let array = v[key].as_array().with_context(|| format!("no {key}"))?;
        array.iter().map(|x| x.as_f64().context("no number")).collect()
    };
    ensure!(a["certified"] == true && b["certified"] == true, "not certified");
    let rounding = 1e4 * 10.0 * f64::EPSILON;
    let (x, y) = (numbers(a, "eigenvalues")?, numbers(b, "eigenvalues")?);
    let (r, s) = (numbers(a, "residuals")?, numbers(b, "residuals")?);
    ensure!(x.len() == y.len(), "{} eigenvalues, and {}", x.len(), y.len());
    for k in 0..x.len() {
        let gap = (x[k] - y[k]).abs();
        let (x, y) = (x[k], y[k]);
        ensure!(gap <= r[k] + s[k] + rounding, "eigenvalue {k}: {x} here, {y} there");
    }
    Ok(())
}

/// The comparisons themselves: each accepts exactly the outputs that it should.
pub(crate) fn self_test() -> Result<()> {
    ensure!(fields("f", &[1.0, -2.0], &[1.0, -2.0 + 1e-13], 1e-12).is_ok(), "within");
    ensure!(fields("f", &[1.0, -2.0], &[1.0, -2.0 + 1e-11], 1e-12).is_err(), "beyond");
    ensure!(fields("f", &[1.0], &[f64::NAN], 1e-12).is_err(), "not a number");
    let json = |text: &str| serde_json::from_str::<Value>(text);
    let spectrum = |value: f64| {
        json(&format!(r#"{{"eigenvalues": [{value}], "residuals": [1e-9], "certified": true}}"#))
    };
    ensure!(eigenvalues(&spectrum(1.0)?, &spectrum(1.0 + 1.5e-9)?).is_ok(), "residuals");
    ensure!(eigenvalues(&spectrum(1.0)?, &spectrum(1.0 + 1e-8)?).is_err(), "residuals");
    Ok(())
}
