//! Every verb of the program on every small file of the corpus: no panic, no NaN, no partial
//! output, and within a time; the command that `info` proposes mends what it has found.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use fairing_mesh::io;
use libtest_mimic::Failed;
use serde_json::Value;

use crate::Test;

/// The tests of this area.
pub(crate) fn trials() -> Vec<(&'static str, Test)> {
    vec![("no_verb_fails_badly", run_all), ("proposed_repairs_mend", proposals)]
}

/// The largest file that every verb runs on, in bytes.
const MAX_BYTES: u64 = 130_000;

/// The time of a verb on one file.
const MAX_TIME: Duration = Duration::from_secs(60);

/// Verbs with their options, and the extension of the output.
const VERBS: [(&str, &str); 17] = [
    ("info IN --json", ""),
    ("convert IN OUT", "obj"),
    ("convert IN OUT", "vtp"),
    ("repair IN -o OUT", "ply"),
    ("repair IN -o OUT --tolerance 0.05 --thin 0.01 --holes 40 --components 4", "ply"),
    ("curvature IN -o OUT", "ply"),
    ("curvature IN -o OUT --weld --estimator normal-cycle", "ply"),
    ("spectrum IN -k 5 -o OUT", "npz"),
    ("reconstruct IN -k 5 -o OUT", "obj"),
    ("geodesic IN --from 0 -o OUT", "ply"),
    ("smooth IN --method implicit -o OUT", "ply"),
    ("smooth IN --method taubin --weld -o OUT", "off"),
    ("noise IN --sigma 0.1 -o OUT", "ply"),
    ("scan IN --size 60x45 -o OUT", "ply"),
    ("denoise IN -o OUT", "stl"),
    ("compare IN IN --json", ""),
    ("render IN --size 60x45 -o OUT", "png"),
];

/// The files of the corpus up to a size, in the order of their names.
pub(crate) fn files(folder: &Path, max_bytes: u64) -> std::io::Result<Vec<PathBuf>> {
    let (mut folders, mut found) = (vec![folder.to_owned()], vec![]);
    while let Some(place) = folders.pop() {
        for entry in fs::read_dir(place)? {
            let path = entry?.path();
            let is_mesh = io::Format::from_path(&path).is_some();
            match fs::metadata(&path)? {
                data if data.is_dir() => folders.push(path),
                data if is_mesh && data.len() <= max_bytes => found.push(path),
                _ => {}
            }
        }
    }
    found.sort();
    Ok(found)
}

/// The exit code, the standard output and the standard error of the program; `None` as code after
/// the time is over.
fn fairing(program: &Path, folder: &Path, words: &[&str]) -> (Option<i32>, String, String) {
    let [out, error] = ["stdout", "stderr"].map(|name| folder.join(name));
    let to = |path: &Path| Stdio::from(fs::File::create(path).expect("a file in our folder"));
    let mut command = Command::new(program);
    command.args(words).current_dir(folder).stdin(Stdio::null());
    let mut child = command.stdout(to(&out)).stderr(to(&error)).spawn().expect("the program runs");
    let start = Instant::now();
    let code = loop {
        match child.try_wait().expect("our own child") {
            Some(status) => break status.code(),
            None if start.elapsed() > MAX_TIME => {
                child.kill().and_then(|()| child.wait()).expect("our own child");
                break None;
            }
            None => std::thread::sleep(Duration::from_millis(2)),
        }
    };
    let text = |path| String::from_utf8_lossy(&fs::read(path).unwrap_or_default()).into_owned();
    (code, text(out), text(error))
}

fn run_all(folder: &Path) -> Result<(), Failed> {
    let program = fairing_tests::program();
    let mut wrong = String::new();
    for input in files(folder, MAX_BYTES)? {
        for (verb, extension) in VERBS {
            if let Err(what) = one(&program, &input, verb, extension) {
                wrong += &format!(
                    "{verb} on {}: {}\n",
                    input.display(),
                    what.message().unwrap_or_default()
                );
            }
        }
    }
    if wrong.is_empty() { Ok(()) } else { Err(wrong.into()) }
}

fn one(program: &Path, input: &Path, verb: &str, extension: &str) -> Result<(), Failed> {
    let place = tempfile::tempdir()?;
    let input = input.to_string_lossy();
    let name = format!("out.{extension}");
    let words: Vec<&str> = verb
        .split(' ')
        .map(|word| match word {
            "IN" => &*input,
            "OUT" => &*name,
            word => word,
        })
        .collect();
    let (code, out, error) = fairing(program, place.path(), &words);
    let done = match code {
        Some(0) => true,
        // A mesh on which the verb is not defined, and one that needs an option to be read.
        Some(1..=3) if error.starts_with("error: ") || error.contains("\nerror: ") => false,
        code => return Err(format!("code {code:?}: {error}").into()),
    };
    if ["panicked", "NaN"].iter().any(|bad| error.contains(bad) || out.contains("NaN")) {
        return Err(format!("{error}{out}").into());
    }
    let output = place.path().join(&name);
    if output.exists() != (done && !extension.is_empty()) {
        return Err(format!("code {code:?}, but the output exists: {}", output.exists()).into());
    }
    if fs::read_dir(place.path())?.count() > 2 + usize::from(output.exists()) {
        return Err("a temporary file is left".into());
    }
    if done && io::Format::from_path(&output).is_some() {
        // Reading refuses positions that are not finite.
        let read = io::read(&output)?;
        let scalars = read.fields.scalars.iter().flat_map(|(_, values)| values);
        let vectors = read.fields.vectors.iter().flat_map(|(_, values)| values.as_flattened());
        if scalars.chain(vectors).any(|x| x.is_nan()) {
            return Err("a field has NaN".into());
        }
    }
    Ok(())
}

/// The counts of `info` that repair changes.
const COUNTS: [&str; 9] = [
    "isolated_vertices",
    "degenerate_faces",
    "sliver_faces",
    "duplicate_faces",
    "duplicate_positions",
    "nonmanifold_edges",
    "nonmanifold_vertices",
    "inconsistent_edges",
    "boundary_loops",
];

fn proposals(folder: &Path) -> Result<(), Failed> {
    let program = fairing_tests::program();
    let mut wrong = String::new();
    for input in files(folder, 2 << 20)? {
        let place = tempfile::tempdir()?;
        let info = |file: &str| -> Result<Value, Failed> {
            let (code, out, error) = fairing(&program, place.path(), &["info", file, "--json"]);
            if code != Some(0) {
                return Err(error.into());
            }
            Ok(serde_json::from_str(&out)?)
        };
        let name = input.to_string_lossy();
        let before = info(&name)?;
        let Some(command) = before["repair"].as_str() else { continue };
        let words: Vec<&str> = command.split(' ').skip(1).collect();
        let (code, _, error) = fairing(&program, place.path(), &words);
        if code != Some(0) {
            wrong += &format!("{command}: {error}\n");
            continue;
        }
        let after = info("repaired.ply")?;
        if COUNTS.iter().all(|count| before[count] == after[count]) {
            wrong += &format!("{command}: mends nothing\n");
        }
        if let Some(again) = after["repair"].as_str() {
            wrong += &format!("{command}: then {again}\n");
        }
    }
    if wrong.is_empty() { Ok(()) } else { Err(wrong.into()) }
}
