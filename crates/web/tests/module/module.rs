//! Requests to the module, and to a session in this process.

use std::path::Path;
use std::process::Command;

use anyhow::{Context as _, Result, ensure};
use base64::Engine as _;
use base64::prelude::BASE64_STANDARD as BASE64;
use fairing_web::Session;
use serde_json::{Map, Value, json};

/// A request and its bytes.
pub(crate) type Request = (Value, Vec<u8>);

/// The answers of the module, in one instance: `value` and `arrays`, or `error`; with `size`.
pub(crate) fn answers(module: &Path, requests: &[Request]) -> Result<Vec<Value>> {
    let folder = tempfile::tempdir()?;
    let file = folder.path().join("requests");
    let line = |(request, bytes): &Request| {
        format!("{}\n", json!({ "request": request, "bytes": BASE64.encode(bytes) }))
    };
    std::fs::write(&file, requests.iter().map(line).collect::<String>())?;
    let text = node("answers.mjs", &[module, &file])?;
    text.lines().map(|line| serde_json::from_str(line).context("an answer of node")).collect()
}

/// The output of a script of this folder.
pub(crate) fn node(script: &str, arguments: &[&Path]) -> Result<String> {
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/module").join(script);
    let output = Command::new("node").arg(script).args(arguments).output()?;
    ensure!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    Ok(String::from_utf8(output.stdout)?)
}

/// The answers of a session, in the same form.
pub(crate) fn expected(requests: &[Request]) -> Vec<Value> {
    let mut session = Session::new();
    let answer =
        |(request, bytes): &Request| match session.call(request.to_string().as_bytes(), bytes) {
            Err(error) => json!({ "error": format!("{error:#}") }),
            Ok(answer) => {
                let arrays = answer.arrays.iter();
                let arrays: Map<String, Value> = arrays
                    .map(|(name, a)| ((*name).to_owned(), json!(BASE64.encode(a.to_bytes()))))
                    .collect();
                json!({ "value": answer.value, "arrays": arrays })
            }
        };
    requests.iter().map(answer).collect()
}

/// The numbers of an array of an answer.
pub(crate) fn numbers(answer: &Value, name: &str) -> Result<Vec<f64>> {
    let text = answer["arrays"][name].as_str();
    let bytes = BASE64.decode(text.with_context(|| format!("{answer} has no {name}"))?)?;
    Ok(bytes.as_chunks().0.iter().map(|bytes| f64::from_le_bytes(*bytes)).collect())
}
