//! A task to be timed, and its work.

use std::path::PathBuf;

use anyhow::Result;
use fairing_mesh::TriMesh;
use serde_json::{Map, Value};

use super::stopwatch::Stopwatch;

/// A task to be timed.
pub(super) trait Task: Sync {
    /// The name on the command line.
    fn name(&self) -> &'static str;

    /// A one-line description.
    fn about(&self) -> &'static str;

    /// Reads the inputs, untimed, and returns the work.
    ///
    /// # Errors
    ///
    /// An input that cannot be read.
    fn prepare(&self, job: &Job) -> Result<Box<dyn Work>>;
}

/// The work of a task, ready to be repeated.
pub(super) trait Work {
    /// Does the work once; every phase runs through the stopwatch.
    ///
    /// # Errors
    ///
    /// Any failure of the work.
    fn run(&mut self, watch: &mut Stopwatch) -> Result<()>;

    /// Numbers for comparing the last result with other libraries.
    ///
    /// # Errors
    ///
    /// A result that cannot be read back.
    fn fingerprint(&mut self) -> Result<Fingerprint>;
}

/// Returns a copy of the mesh without cached topology.
pub(super) fn forgetful(mesh: &TriMesh, watch: &mut Stopwatch) -> Result<TriMesh> {
    let copy = || TriMesh::new(mesh.positions().to_vec(), mesh.faces().to_vec());
    Ok(watch.phase("prepare", copy)?)
}

/// Names and numbers.
pub(super) type Fingerprint = Map<String, Value>;

/// Makes a fingerprint of names and numbers.
macro_rules! fingerprint {
    ($($name:ident: $value:expr),* $(,)?) => {{
        let mut map = serde_json::Map::new();
        $(map.insert(stringify!($name).into(), serde_json::json!($value));)*
        map
    }};
}

pub(super) use fingerprint;

/// The files and numbers of a task.
#[derive(Debug, Clone)]
pub(super) struct Job {
    /// The mesh.
    pub(super) input: PathBuf,
    /// The file for the result, if the task writes one.
    pub(super) out: Option<PathBuf>,
    /// The mesh without noise, for metrics.
    pub(super) reference: Option<PathBuf>,
    /// The name of a curvature estimator.
    pub(super) estimator: String,
    /// The number of eigenpairs.
    pub(super) k: usize,
    /// The step.
    pub(super) lambda: f64,
    /// The second, negative step of Taubin's method.
    pub(super) mu: f64,
    /// The number of steps.
    pub(super) iterations: usize,
}
