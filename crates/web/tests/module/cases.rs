//! Requests, and the properties of their answers.

use std::path::{Path, PathBuf};

use anyhow::{Context as _, Result, ensure};
use fairing_denoising::Denoiser;
use fairing_evaluation::{NoiseKind, NoiseLevel, add_noise};
use fairing_mesh::TriMesh;
use fairing_mesh::io::{self, Format};
use fairing_operators::curvature::Estimator;
use fairing_shapes::{self as shapes, Diagonals, Ends, HelicoidOptions};
use fairing_smoothing::Method;
use serde_json::{Value, json};

use crate::module::{Request, answers, expected, node, numbers};

/// Ten meshes: closed and open, smooth and with creases, even and uneven, with noise.
pub(crate) fn meshes() -> Vec<(&'static str, TriMesh)> {
    let helicoid =
        HelicoidOptions { rise: 0.3, radii: [0.2, 1.0], turns: 1.0, across: 12, along: 60 };
    let noisy = |mesh: TriMesh| {
        let level = NoiseLevel::EdgeLengths(0.2);
        add_noise(&mesh, NoiseKind::GaussianAlongNormals, level, 7).unwrap_or(mesh)
    };
    vec![
        ("sphere", shapes::icosphere(3)),
        ("bumpy_sphere", noisy(shapes::bumpy_sphere(3, 0.1, 5.0))),
        ("ellipsoid", shapes::ellipsoid([1.5, 1.0, 0.5], 3)),
        ("torus", noisy(shapes::torus(1.0, 0.4, 36, 18))),
        ("cylinder", shapes::cylinder(0.5, 2.0, 30, 20, Ends::Open)),
        ("plane", noisy(shapes::irregular_plane(0.05, 3))),
        ("cube", noisy(shapes::cube(9, Diagonals::Alternating))),
        ("block", noisy(shapes::cad_block(0.2))),
        ("flower", shapes::flower(0.1, 1)),
        ("helicoid", shapes::helicoid(&helicoid)),
    ]
}

/// Verbs whose results pass through a factorisation, or through a search by one: its order of
/// operations depends on the vector instructions.
fn factorises(request: &Value) -> bool {
    let method = request["method"].as_str().unwrap_or_default();
    let verb = request["verb"].as_str().unwrap_or_default();
    matches!(verb, "spectrum" | "reconstruct" | "distance" | "mode")
        || request["name"] == "distance"
        || matches!(method, "mean-curvature" | "conformal")
        || matches!(method, "bilateral-normal-global" | "l0" | "total-variation")
        || method == "total-generalised-variation"
}

/// Requests of every verb and method about one mesh, whose number is 1.
fn requests(mesh: &TriMesh) -> Result<Vec<Request>> {
    let bytes = io::to_bytes(Format::Ply, mesh, &Default::default(), &Default::default())?;
    let mut requests = vec![(json!({ "verb": "read", "name": "a.ply" }), bytes)];
    let mut ask = |request: Value| requests.push((request, vec![]));
    ask(json!({ "verb": "info", "mesh": 1 }));
    ask(json!({ "verb": "mesh", "mesh": 1 }));
    for estimator in Estimator::all() {
        ask(json!({ "verb": "curvature", "mesh": 1, "method": estimator.name() }));
        for name in ["mean", "gaussian", "kappa1", "kappa2"] {
            ask(json!({ "verb": "field", "mesh": 1, "name": name }));
        }
    }
    for kind in NoiseKind::ALL {
        ask(json!({ "verb": "noise", "mesh": 1, "method": kind.name() }));
    }
    for method in Method::all() {
        let values = match method.name() {
            "region" => json!({ "vertices": [5] }),
            // Where a surface collapses, rounding errors grow without bound.
            "mean-curvature" | "conformal" => json!({ "iterations": 1 }),
            _ => json!({}),
        };
        ask(json!({ "verb": "smooth", "mesh": 1, "method": method.name(), "values": values }));
    }
    for denoiser in Denoiser::all() {
        ask(json!({ "verb": "denoise", "mesh": 1, "method": denoiser.name() }));
    }
    ask(json!({ "verb": "compare", "mesh": 2, "reference": 1 }));
    ask(json!({ "verb": "compare", "mesh": 2, "reference": 1, "matching": true }));
    ask(json!({ "verb": "repair", "mesh": 1 }));
    ask(json!({ "verb": "spectrum", "mesh": 1, "values": { "k": MODES } }));
    ask(json!({ "verb": "reconstruct", "mesh": 1, "values": { "k": MODES } }));
    ask(json!({ "verb": "spectrum", "mesh": 1, "values": { "k": MODES, "operator": "uniform" } }));
    ask(json!({ "verb": "distance", "mesh": 1, "values": { "sources": [0] } }));
    ask(json!({ "verb": "field", "mesh": 1, "name": "distance" }));
    for format in ["obj", "off", "stl"] {
        ask(json!({ "verb": "write", "mesh": 1, "format": format }));
    }
    Ok(requests)
}

/// The number of modes.
const MODES: usize = 20;

/// The error of what passes through a factorisation, relative to the largest number.
const ROUNDING: f64 = 1e-10;

/// The answers have the same bits; those that pass through a factorisation agree to [`ROUNDING`].
///
/// A space of modes is determined to the error of its eigenvalues over the gap to the next one
/// (Davis and Kahan), so a reconstruction is compared with this bound.
pub(crate) fn same(module: &Path, mesh: &TriMesh) -> Result<()> {
    let requests = requests(mesh)?;
    let found = answers(module, &requests)?;
    let bound = ROUNDING / relative_gap(&requests[0])?;
    for (((request, _), found), expected) in requests.iter().zip(&found).zip(expected(&requests)) {
        match (factorises(request), request["verb"] == "reconstruct") {
            (false, _) => identical(found, &expected).with_context(|| request.to_string())?,
            (_, false) => near(found, &expected, ROUNDING).with_context(|| request.to_string())?,
            (_, true) => near(found, &expected, bound).with_context(|| request.to_string())?,
        }
    }
    Ok(())
}

/// The gap between the last of the modes and the next one, relative to its eigenvalue.
fn relative_gap(read: &Request) -> Result<f64> {
    let spectrum = json!({ "verb": "spectrum", "mesh": 1, "values": { "k": MODES + 1 } });
    let values = numbers(&expected(&[read.clone(), (spectrum, vec![])])[1], "values")?;
    let [.., last, next] = values[..] else { anyhow::bail!("{} eigenvalues", values.len()) };
    Ok((next - last) / next)
}

pub(crate) fn identical(found: &Value, expected: &Value) -> Result<()> {
    ensure!(found["error"] == expected["error"], "{} {}", found["error"], expected["error"]);
    let (of_found, of_expected) = (plain(&found["value"]), plain(&expected["value"]));
    ensure!(of_found == of_expected, "{of_found} is not {of_expected}");
    ensure!(found["arrays"] == expected["arrays"], "the arrays have other bits");
    Ok(())
}

fn near(found: &Value, expected: &Value, bound: f64) -> Result<()> {
    ensure!(found["error"] == expected["error"], "{} {}", found["error"], expected["error"]);
    let none = serde_json::Map::new();
    for (name, _) in expected["arrays"].as_object().unwrap_or(&none) {
        // Residuals are rounding errors themselves, and modes of one eigenvalue share their sizes
        // in any way.
        if name == "residuals" || name == "sizes" {
            continue;
        }
        let (found, expected) = (numbers(found, name)?, numbers(expected, name)?);
        ensure!(found.len() == expected.len(), "{name} has {} numbers", found.len());
        let largest = expected.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
        let apart = found.iter().zip(&expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        ensure!(apart <= bound * largest, "{name} differs by {apart:e} of {largest:e}");
    }
    Ok(())
}

/// JSON with numbers as in JavaScript, which has one kind only.
fn plain(value: &Value) -> Value {
    match value {
        Value::Number(number) => json!(number.as_f64().map(|x| x + 0.0)),
        Value::Array(list) => list.iter().map(plain).collect(),
        Value::Object(map) => map.iter().map(|(name, v)| (name.clone(), plain(v))).collect(),
        other => other.clone(),
    }
}

/// Requests that cannot be answered get the errors of the program, and the next ones are answered.
pub(crate) fn errors(module: PathBuf) -> Result<()> {
    let good = (json!({ "verb": "sample", "name": "sphere" }), vec![]);
    let wrong = [
        (json!({ "verb": "read", "name": "a.obj" }), b"v 0 0 0\nf 1 2 3\n".to_vec()),
        (json!({ "verb": "read", "name": "a.obj" }), vec![]),
        (json!({ "verb": "smooth", "mesh": 1, "values": { "mu": "x" } }), vec![]),
        (
            json!({ "verb": "smooth", "mesh": 1, "method": "explicit", "values": { "lambda": -1 } }),
            vec![],
        ),
        (json!({ "verb": "smooth", "mesh": 9 }), vec![]),
        (json!({ "verb": "spectrum", "mesh": 1, "values": { "k": 0 } }), vec![]),
        (json!({ "verb": "distance", "mesh": 1, "values": { "sources": [99999] } }), vec![]),
        // The sizes do not fit into 32 bits; the first are 8 bytes more than that.
        (json!({ "verb": "adopt", "vertices": 178_956_971, "faces": 0 }), vec![0; 8]),
        (json!({ "verb": "adopt", "vertices": u32::MAX, "faces": u32::MAX }), vec![0; 8]),
        (json!({ "verb": "adopt", "vertices": 0, "faces": 0, "fields": ["H"] }), vec![]),
        (json!({ "verb": "fly" }), vec![]),
        (json!([]), vec![]),
    ];
    let mut requests = vec![good];
    requests.extend(wrong);
    requests.push((json!({ "verb": "info", "mesh": 1 }), vec![]));
    let found = answers(&module, &requests)?;
    for (found, expected) in found.iter().zip(expected(&requests)) {
        identical(found, &expected)?;
    }
    let failed = found.iter().filter(|answer| answer["error"].is_string()).count();
    ensure!(failed == requests.len() - 2, "{failed} errors");
    Ok(())
}

/// Fifty meshes one after the other take no more memory than the first ten.
pub(crate) fn flat(module: PathBuf) -> Result<()> {
    let mesh = shapes::icosphere(5);
    let bytes = io::to_bytes(Format::Ply, &mesh, &Default::default(), &Default::default())?;
    let mut requests = vec![];
    for round in 0..50 {
        let [mesh, smooth] = [2 * round + 1, 2 * round + 2];
        requests.push((json!({ "verb": "read", "name": "a.ply" }), bytes.clone()));
        requests.push((json!({ "verb": "smooth", "mesh": mesh }), vec![]));
        requests.push((json!({ "verb": "curvature", "mesh": smooth }), vec![]));
        requests.push((json!({ "verb": "drop", "mesh": mesh }), vec![]));
        requests.push((json!({ "verb": "drop", "mesh": smooth }), vec![]));
    }
    let found = answers(&module, &requests)?;
    let failed = found.iter().find(|answer| answer["error"].is_string());
    ensure!(failed.is_none(), "{failed:?}");
    let size = |round: usize| found[5 * round + 4]["size"].as_u64();
    ensure!(size(49) == size(9), "{:?} bytes after ten, {:?} after fifty", size(9), size(49));
    Ok(())
}

/// A page cancels work, gets the messages of panics and failed allocations, and keeps its meshes.
pub(crate) fn client(module: PathBuf) -> Result<()> {
    node("client.mjs", &[&module]).map(|_| ())
}
