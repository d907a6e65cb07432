//! A task to be timed, and its work.

use std::path::PathBuf;

use anyhow::Result;
use fairing_mesh::TriMesh;
use serde_json::{Map, Value};

use crate::stopwatch::Stopwatch;

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
