//! Times one task inside the process, for comparison with other libraries.

mod files;
mod metrics;
mod operators;
mod smoothing;
mod spectra;
mod stopwatch;

use std::path::PathBuf;

use anyhow::{Context as _, Result};
use fairing_mesh::TriMesh;
use serde_json::{Map, Value, json};

pub(crate) use stopwatch::Stopwatch;

use crate::cli::Bench;

/// A task to be timed.
pub(crate) trait Task: Sync {
    /// Its name on the command line.
    fn name(&self) -> &'static str;

    /// What it does, in a line.
    fn about(&self) -> &'static str;

    /// Reads what it needs (not timed) and returns the work.
    ///
    /// # Errors
    ///
    /// If an input cannot be read.
    fn prepare(&self, job: &Job) -> Result<Box<dyn Work>>;
}

/// The work of a task, ready to be repeated.
pub(crate) trait Work {
    /// Does it once; every phase runs through the stopwatch.
    ///
    /// # Errors
    ///
    /// Any failure of the work.
    fn run(&mut self, watch: &mut Stopwatch) -> Result<()>;

    /// Numbers by which the last result can be compared with that of others.
    ///
    /// # Errors
    ///
    /// If the result cannot be read back.
    fn fingerprint(&mut self) -> Result<Fingerprint>;
}

/// A mesh that remembers nothing: what follows from its faces must be found again.
fn forgetful(mesh: &TriMesh, watch: &mut Stopwatch) -> Result<TriMesh> {
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

use fingerprint;

/// The files and numbers of a task.
#[derive(Debug, Clone)]
pub(crate) struct Job {
    /// The mesh.
    pub(crate) input: PathBuf,
    /// Where to write the result, if the task writes one.
    pub(crate) out: Option<PathBuf>,
    /// The mesh without noise, for metrics.
    pub(crate) reference: Option<PathBuf>,
    /// The name of a curvature estimator.
    pub(crate) estimator: String,
    /// How many eigenpairs.
    pub(crate) k: usize,
    /// The step.
    pub(crate) lambda: f64,
    /// The second, negative step of Taubin's method.
    pub(crate) mu: f64,
    /// How many steps.
    pub(crate) iterations: usize,
}

/// The tasks.
pub(crate) const ALL: &[&dyn Task] = &[
    &files::Load { name: "load_obj", about: "OBJ file to positions and faces" },
    &files::Load { name: "load_ply", about: "PLY file to positions and faces" },
    &files::SavePly,
    &operators::Laplacian,
    &operators::Refill,
    &operators::Curvature,
    &operators::Principal,
    &smoothing::Flow {
        name: "explicit_uniform",
        about: "x + λLx, uniform weights",
        method: smoothing::explicit_uniform,
    },
    &smoothing::Flow {
        name: "taubin",
        about: "pairs of steps λ and μ, uniform weights",
        method: smoothing::taubin,
    },
    &smoothing::Flow {
        name: "implicit_uniform",
        about: "(I − λL)x' = x, uniform weights",
        method: smoothing::implicit_uniform,
    },
    &smoothing::Flow {
        name: "implicit_cotan",
        about: "(M + λh²S)x' = Mx, operator of the input",
        method: smoothing::implicit_cotan,
    },
    &smoothing::Flow {
        name: "implicit_cotan_stiff",
        about: "the same, for large λ",
        method: smoothing::implicit_cotan,
    },
    &smoothing::Flow {
        name: "implicit_mcf",
        about: "the same, operator of each step",
        method: smoothing::implicit_mcf,
    },
    &smoothing::EndToEnd,
    &metrics::Metrics,
    &spectra::Eigs,
    &spectra::Factor,
];

/// Times the task, or lists the tasks, and prints the result.
pub(crate) fn run(options: Bench) -> Result<()> {
    let Some(task) = options.task else {
        println!("{:<22} builds from an empty target folder", "build");
        for task in ALL {
            println!("{:<22} {}", task.name(), task.about());
        }
        return Ok(());
    };
    let job = Job {
        input: options.input.context("missing input mesh: --in FILE")?,
        out: options.out,
        reference: options.reference,
        estimator: options.estimator,
        k: options.k,
        lambda: options.lambda,
        mu: options.mu,
        iterations: options.iters,
    };
    let threads = rayon::ThreadPoolBuilder::new().num_threads(options.threads.unwrap_or(0));
    threads.build_global().context("starting threads")?;
    let result = measure(&task, &job, options.repeat)?;
    if options.json {
        println!("{result}");
    } else {
        println!("{}", serde_json::to_string_pretty(&result)?);
    }
    Ok(())
}

/// Runs a task and returns `{"runs": […], "fingerprint": {…}, "rss_mb": n}`.
///
/// # Errors
///
/// If there is no such task, or it fails.
pub(crate) fn measure(name: &str, job: &Job, repeat: usize) -> Result<Value> {
    let task = ALL.iter().find(|t| t.name() == name).with_context(|| {
        let names: Vec<_> = ALL.iter().map(|t| t.name()).collect();
        format!("there is no task {name}; there are {}", names.join(", "))
    })?;
    let mut work = task.prepare(job)?;
    let mut runs = vec![];
    for _ in 0..repeat.max(1) {
        let mut watch = Stopwatch::default();
        work.run(&mut watch)?;
        runs.push(watch.into_json());
    }
    // The peak is read before the fingerprint adds to it.
    let rss = stopwatch::peak_megabytes();
    let mut result = json!({ "runs": runs, "fingerprint": work.fingerprint()? });
    if let Some(megabytes) = rss {
        result["rss_mb"] = json!(megabytes);
    }
    Ok(result)
}
