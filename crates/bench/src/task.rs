//! A task to be timed, and its work.

use std::fs;
use std::path::PathBuf;
use std::time::Instant;

use anyhow::Result;
use fairing_mesh::TriMesh;
use serde_json::{Map, Value, json};

/// A task to be timed.
pub(crate) struct Task {
    /// The name on the command line.
    pub(crate) name: &'static str,
    /// A one-line description.
    pub(crate) about: &'static str,
    /// Reads the inputs, untimed, and returns the work.
    pub(crate) prepare: fn(&Job) -> Result<Work>,
}

impl Task {
    pub(crate) const fn new(
        name: &'static str,
        about: &'static str,
        prepare: fn(&Job) -> Result<Work>,
    ) -> Self {
        Self { name, about, prepare }
    }
}

/// Does the work once; every phase runs through the stopwatch.
pub(crate) type Work = Box<dyn FnMut(&mut Stopwatch) -> Result<Done>>;

/// Numbers of a result, for comparing it with other libraries.
pub(crate) type Done = Box<dyn FnOnce() -> Result<Fingerprint>>;

/// Work that keeps its result until the next repetition.
pub(crate) fn work<F, D>(mut run: F) -> Result<Work>
where
    F: FnMut(&mut Stopwatch) -> Result<D> + 'static,
    D: FnOnce() -> Result<Fingerprint> + 'static,
{
    Ok(Box::new(move |watch| Ok(Box::new(run(watch)?))))
}

/// Returns a copy of the mesh without cached topology.
pub(crate) fn forgetful(mesh: &TriMesh, watch: &mut Stopwatch) -> Result<TriMesh> {
    let copy = || TriMesh::new(mesh.positions().to_vec(), mesh.faces().to_vec());
    Ok(watch.phase("prepare", copy)?)
}

/// Names and numbers.
pub(crate) type Fingerprint = Map<String, Value>;

/// Makes a fingerprint of names and numbers.
macro_rules! fingerprint {
    ($($name:ident: $value:expr),* $(,)?) => {{
        let mut map = serde_json::Map::new();
        $(map.insert(stringify!($name).into(), serde_json::json!($value));)*
        map
    }};
}

pub(crate) use fingerprint;

/// The files and numbers of a task.
#[derive(Debug, Clone)]
pub(crate) struct Job {
    /// The mesh.
    pub(crate) input: PathBuf,
    /// The file for the result, if the task writes one.
    pub(crate) out: Option<PathBuf>,
    /// The mesh without noise, for metrics.
    pub(crate) reference: Option<PathBuf>,
    /// The name of a curvature estimator.
    pub(crate) estimator: String,
    /// The number of eigenpairs.
    pub(crate) k: usize,
    /// The step.
    pub(crate) lambda: f64,
    /// The second, negative step of Taubin's method.
    pub(crate) mu: f64,
    /// The number of steps.
    pub(crate) iterations: usize,
}

/// Times named phases; a name used twice adds up.
#[derive(Debug, Default)]
pub(crate) struct Stopwatch {
    phases: Vec<(&'static str, f64)>,
    processor: Option<f64>,
}

/// Copying into the layout that the task needs: timed, but not counted.
pub(crate) const PREPARE: &str = "prepare";

impl Stopwatch {
    /// Does the work and adds its time to the phase.
    pub(crate) fn phase<T>(&mut self, name: &'static str, work: impl FnOnce() -> T) -> T {
        let before = processor_seconds();
        let start = Instant::now();
        let result = work();
        let seconds = start.elapsed().as_secs_f64();
        let after = processor_seconds();
        match self.phases.iter_mut().find(|(n, _)| *n == name) {
            Some((_, total)) => *total += seconds,
            None => self.phases.push((name, seconds)),
        }
        if let (Some(before), Some(after)) = (before, after)
            && name != PREPARE
        {
            *self.processor.get_or_insert(0.0) += after - before;
        }
        result
    }

    /// `{"phase": seconds, …, "_cpu": seconds}`.
    pub(crate) fn into_json(self) -> Value {
        let mut map: Map<String, Value> =
            self.phases.into_iter().map(|(name, seconds)| (name.into(), json!(seconds))).collect();
        if let Some(seconds) = self.processor {
            map.insert("_cpu".into(), json!(seconds));
        }
        Value::Object(map)
    }
}

/// Processor time of all threads of this process in seconds; `None` unless on Linux. The first
/// number of each `schedstat` is nanoseconds on a processor. Threads that have ended are not
/// counted; those of a pool do not end.
fn processor_seconds() -> Option<f64> {
    let mut nanoseconds = 0u64;
    for task in fs::read_dir("/proc/self/task").ok()? {
        let path = task.ok()?.path().join("schedstat");
        let Ok(text) = fs::read_to_string(path) else { continue };
        nanoseconds += text.split_whitespace().next()?.parse::<u64>().ok()?;
    }
    Some(nanoseconds as f64 * 1e-9)
}

/// The peak memory of this process in megabytes; `None` unless on Linux.
pub(crate) fn peak_megabytes() -> Option<f64> {
    let status = fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|l| l.starts_with("VmHWM:"))?;
    let kilobytes: f64 = line.split_whitespace().nth(1)?.parse().ok()?;
    Some(kilobytes / 1024.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn phases_of_one_name_add_up() {
        let mut watch = Stopwatch::default();
        let a = watch.phase("solve", || 1);
        let b = watch.phase("solve", || 2);
        let json = watch.into_json();
        assert_eq!(a + b, 3);
        assert!(json["solve"].as_f64().unwrap() >= 0.0);
        assert_eq!(json.as_object().unwrap().keys().filter(|k| *k == "solve").count(), 1);
    }
}
