//! Times one task inside the process, for comparison with other libraries.

mod files;
mod metrics;
mod operators;
mod smoothing;
mod spectra;
mod stopwatch;
mod task;

use anyhow::{Context as _, Result};
use serde_json::{Value, json};

use crate::cli::Bench;
use stopwatch::Stopwatch;
use task::{Job, Task};

/// The tasks.
const ALL: &[&dyn Task] = &[
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
/// An unknown task, or a failure of the task.
fn measure(name: &str, job: &Job, repeat: usize) -> Result<Value> {
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
