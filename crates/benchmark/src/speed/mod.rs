//! Times of tasks: one inside the process, for comparison with other libraries, or all of a page.

mod bandwidth;
mod denoise;
mod files;
mod fresh;
mod harmonic;
mod metrics;
mod operators;
mod page;
mod smoothing;
mod spectra;
mod stopwatch;
mod task;

use anyhow::{Context as _, Result};
use serde_json::{Value, json};

use crate::cli::Bench;
use fresh::{Fresh, Times, median};
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
    &harmonic::Harmonic,
    &denoise::Denoise,
    &bandwidth::Bandwidth,
];

/// Times the task, or lists the tasks, and prints the result.
pub(crate) fn run(options: Bench) -> Result<()> {
    let Some(task) = options.task.clone() else {
        println!("{:<22} builds from an empty target folder", "build");
        println!("{:<22} all tasks over the number of vertices, into docs/speed.md", "page");
        for task in ALL {
            println!("{:<22} {}", task.name(), task.about());
        }
        return Ok(());
    };
    if task == "page" {
        return page::write(options.comparison.as_deref(), options.finest);
    }
    if options.once {
        return once(&task, &options);
    }
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

/// Starts a process for each repetition, and prints the median of their times.
fn once(task: &str, options: &Bench) -> Result<()> {
    let input = options.input.as_deref().context("missing input mesh: --in FILE")?;
    let mut more = vec![
        format!("--estimator={}", options.estimator),
        format!("--k={}", options.k),
        format!("--lambda={}", options.lambda),
        format!("--mu={}", options.mu),
        format!("--iters={}", options.iters),
    ];
    more.extend(options.threads.map(|threads| format!("--threads={threads}")));
    for (name, path) in [("--out", &options.out), ("--reference", &options.reference)] {
        more.extend(path.as_ref().map(|path| format!("{name}={}", path.display())));
    }
    let more: Vec<&str> = more.iter().map(String::as_str).collect();
    let process = Fresh::new(task, input, &more);
    let times: Vec<Times> =
        (0..options.repeat.max(1)).map(|_| process.run()).collect::<Result<_>>()?;
    let seconds: Vec<f64> = times.iter().map(|t| t.first).collect();
    let least = seconds.iter().copied().fold(f64::INFINITY, f64::min);
    println!("{}", json!({ "first": median(seconds), "least": least, "processes": times.len() }));
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
