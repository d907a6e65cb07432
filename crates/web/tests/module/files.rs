//! Files of all kinds, broken ones included: a result or a sentence.

use std::path::{Path, PathBuf};

use anyhow::{Context as _, Result, ensure};
use fairing_mesh::io::{Format, Reader};
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use serde_json::{Value, json};

use crate::cases::identical;
use crate::module::{Request, answers, expected};

/// Random bytes under the names of all formats are no meshes.
pub(crate) fn random(module: PathBuf) -> Result<()> {
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    let requests = (0..200).map(|round| {
        let format = Format::ALL[round % Format::ALL.len()];
        let length = rng.random_range(0..400);
        let bytes: Vec<u8> = (0..length).map(|_| rng.random()).collect();
        read(format!("a.{}", format.extensions()[0]), bytes)
    });
    agree(&module, &requests.collect::<Vec<_>>())
}

/// The seeds of the fuzz target, whole, cut off, and with bytes that were exchanged.
pub(crate) fn damaged(module: PathBuf) -> Result<()> {
    let seeds = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz/seeds");
    let mut rng = ChaCha8Rng::seed_from_u64(2);
    let mut requests = vec![];
    for path in files(&seeds)? {
        let whole = std::fs::read(&path)?;
        requests.push(read(name(&path), whole.clone()));
        for _ in 0..10 {
            let length = rng.random_range(0..whole.len());
            requests.push(read(name(&path), whole[..length].to_vec()));
            let mut exchanged = whole.clone();
            for _ in 0..4 {
                let at = rng.random_range(0..whole.len());
                exchanged[at] = rng.random();
            }
            requests.push(read(name(&path), exchanged));
        }
    }
    ensure!(requests.len() > 200, "{} requests", requests.len());
    agree(&module, &requests)
}

/// The largest file, in bytes, of which curvature is asked too.
const MEDIUM: usize = 2_000_000;
/// The largest file, in bytes, of which also the slow verbs are asked.
const SMALL: usize = 200_000;

/// Every file of the folder of real meshes is read or refused as it is elsewhere, and no verb
/// breaks the module.
pub(crate) fn corpus(module: PathBuf) -> Result<()> {
    let folder = std::env::var_os("FAIRING_MESHES").context("no folder")?;
    let paths = files(Path::new(&folder))?;
    ensure!(paths.len() > 50, "{} files", paths.len());
    let mut requests = vec![];
    let mut mesh = 0;
    for path in paths {
        let bytes = std::fs::read(&path)?;
        let size = bytes.len();
        let found = Reader::default().read_bytes(name(&path), &bytes);
        requests.push(read(name(&path), bytes));
        if found.is_err() {
            continue;
        }
        mesh += 1;
        let mut ask = |request: Value| requests.push((request, vec![]));
        ask(json!({ "verb": "info", "mesh": mesh }));
        if size <= MEDIUM {
            ask(json!({ "verb": "curvature", "mesh": mesh }));
        }
        if size <= SMALL {
            ask(json!({ "verb": "distance", "mesh": mesh, "values": { "sources": [0] } }));
            ask(json!({ "verb": "spectrum", "mesh": mesh, "values": { "k": 5 } }));
        }
        ask(json!({ "verb": "drop", "mesh": mesh }));
    }
    let found = answers(&module, &requests)?;
    ensure!(found.len() == requests.len(), "{} answers", found.len());
    for ((request, _), found) in requests.iter().zip(&found) {
        sound(found).with_context(|| request.to_string())?;
    }
    Ok(())
}

/// The request to read a file.
fn read(name: String, bytes: Vec<u8>) -> Request {
    (json!({ "verb": "read", "name": name }), bytes)
}

/// The module gives the answers of a session of this process, and is not broken by any request.
fn agree(module: &Path, requests: &[Request]) -> Result<()> {
    let found = answers(module, requests)?;
    for (((request, _), found), expected) in requests.iter().zip(&found).zip(expected(requests)) {
        sound(found).and_then(|()| identical(found, &expected)).context(request.to_string())?;
    }
    Ok(())
}

/// A result or a sentence.
fn sound(answer: &Value) -> Result<()> {
    let says = answer["error"].as_str().is_none_or(|words| words.len() > 10);
    ensure!(answer["isBroken"] != true && says, "{answer}");
    Ok(())
}

fn name(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

/// The files below a folder, in the order of their paths.
fn files(folder: &Path) -> Result<Vec<PathBuf>> {
    let mut found = vec![];
    for entry in std::fs::read_dir(folder)? {
        let path = entry?.path();
        if path.is_dir() { found.extend(files(&path)?) } else { found.push(path) }
    }
    found.sort();
    Ok(found)
}
