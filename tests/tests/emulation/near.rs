//! Whether two outputs agree within a tolerance.

use anyhow::{Context as _, Result, bail, ensure};
use fairing_mesh::io;
use serde_json::Value;

/// Compares two outputs of this kind; the tolerance is relative to the largest
/// value of each field.
pub(crate) fn check(kind: &str, here: &[u8], there: &[u8], tolerance: f64) -> Result<()> {
    match kind {
        "ply" => meshes(here, there, tolerance),
        "png" => pictures(here, there),
        "json" => {
            let [a, b] = [here, there].map(serde_json::from_slice::<Value>);
            let (a, b) = (a?, b?);
            match a.get("eigenvalues") {
                Some(_) => eigenvalues(&a, &b),
                None => values("output", &a, &b, tolerance),
            }
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

/// A colour may fall to the other side of a rounding.
fn pictures(here: &[u8], there: &[u8]) -> Result<()> {
    let decode = |bytes: &[u8]| -> Result<Vec<u8>> {
        let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info()?;
        let mut pixels = vec![0; reader.output_buffer_size().context("no size")?];
        reader.next_frame(&mut pixels)?;
        Ok(pixels)
    };
    let (a, b) = (decode(here)?, decode(there)?);
    ensure!(a.len() == b.len(), "other sizes");
    ensure!(a.iter().zip(&b).all(|(x, y)| x.abs_diff(*y) <= 1), "a colour differs by two or more");
    Ok(())
}

/// Numbers near each other, everything else the same.
fn values(place: &str, a: &Value, b: &Value, tolerance: f64) -> Result<()> {
    match (a, b) {
        (Value::Number(x), Value::Number(y)) => {
            let (x, y) = (x.as_f64().context("a number")?, y.as_f64().context("a number")?);
            let close = (x - y).abs() <= tolerance * x.abs().max(1.0);
            ensure!(close, "{place}: {x} here, {y} there");
        }
        (Value::Array(x), Value::Array(y)) if x.len() == y.len() => {
            for (k, (x, y)) in x.iter().zip(y).enumerate() {
                values(&format!("{place}[{k}]"), x, y, tolerance)?;
            }
        }
        (Value::Object(x), Value::Object(y)) if x.len() == y.len() => {
            for (key, x) in x {
                let y = y.get(key).with_context(|| format!("{place}.{key} is gone"))?;
                values(&format!("{place}.{key}"), x, y, tolerance)?;
            }
        }
        _ => ensure!(a == b, "{place}: {a} here, {b} there"),
    }
    Ok(())
}

/// Each within the sum of the residuals, and of the rounding of the matrix,
/// which is relative to its largest eigenvalue; 1e4 bounds it for these meshes.
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

/// The comparisons themselves: each passes what it should, and nothing more.
pub(crate) fn self_test() -> Result<()> {
    ensure!(fields("f", &[1.0, -2.0], &[1.0, -2.0 + 1e-13], 1e-12).is_ok(), "within");
    ensure!(fields("f", &[1.0, -2.0], &[1.0, -2.0 + 1e-11], 1e-12).is_err(), "beyond");
    ensure!(fields("f", &[1.0], &[f64::NAN], 1e-12).is_err(), "not a number");
    let json = |text: &str| serde_json::from_str::<Value>(text);
    let (a, b) = (json(r#"{"x": [1.0, "a"]}"#)?, json(r#"{"x": [1.001, "a"]}"#)?);
    ensure!(values("v", &a, &a, 0.0).is_ok() && values("v", &a, &b, 1e-6).is_err(), "values");
    let spectrum = |value: f64| {
        json(&format!(r#"{{"eigenvalues": [{value}], "residuals": [1e-9], "certified": true}}"#))
    };
    ensure!(eigenvalues(&spectrum(1.0)?, &spectrum(1.0 + 1.5e-9)?).is_ok(), "residuals");
    ensure!(eigenvalues(&spectrum(1.0)?, &spectrum(1.0 + 1e-8)?).is_err(), "residuals");
    Ok(())
}
