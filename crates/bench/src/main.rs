//! Times of tasks: one inside the process, for comparison with other libraries, or all of a page.

mod bandwidth;
mod files;
mod fresh;
mod harmonic;
mod hubs;
mod leaderboard;
mod operators;
mod page;
mod rock;
mod smoothing;
mod spectra;
mod task;

use std::path::PathBuf;
use std::process::ExitCode;

use anyhow::{Context as _, Result};
use clap::Parser;
use serde_json::{Value, json};

use fairing_sparse::upper_median;
use fresh::{Fresh, Times};
use task::{Job, Stopwatch, Task};

#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

/// Times one task inside the process, for comparison with other libraries
#[derive(Debug, Parser)]
#[command(name = "bench", bin_name = "cargo xtask bench", version, about)]
struct Bench {
    /// The task; `page` writes docs/speed.md, `hubs` times all verbs of the program on meshes with
    /// a vertex of thousands of faces, `leaderboard` prints tables of k-harmonic systems in the
    /// form of sparse-solver-benchmark, `rock` writes a mesh without symmetry to --out.
    /// Without a task, the tasks are listed
    task: Option<String>,
    /// The mesh
    #[arg(long = "in", value_name = "FILE")]
    input: Option<PathBuf>,
    /// Number of repetitions
    #[arg(long, default_value_t = 1)]
    repeat: usize,
    /// Start a process for each repetition, and print the median of their times: the time of a
    /// program that is called once
    #[arg(long)]
    once: bool,
    /// Number of threads; all by default
    #[arg(long)]
    threads: Option<usize>,
    /// Print one JSON object on the last line
    #[arg(long)]
    json: bool,
    /// Curvature estimator of the task principal
    #[arg(long, default_value = "quadric")]
    estimator: String,
    /// Number of eigenpairs, or the system of the task harmonic: of order 1, 2, 3, or mixed
    /// biharmonic (4) or triharmonic (5)
    #[arg(long, default_value_t = 15)]
    k: usize,
    /// The step
    #[arg(long, default_value_t = 0.5)]
    lambda: f64,
    /// The second, negative step of Taubin's method
    #[arg(long, default_value_t = -0.53, allow_negative_numbers = true)]
    mu: f64,
    /// Number of steps
    #[arg(long, default_value_t = 10)]
    iters: usize,
    /// Write the resulting mesh to this file
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// The mesh without noise
    #[arg(long, value_name = "FILE")]
    reference: Option<PathBuf>,
    /// For the page: results of a comparison with other libraries, as JSON
    #[arg(long, value_name = "FILE")]
    comparison: Option<PathBuf>,
    /// For the page: the tables that `leaderboard` has printed
    #[arg(long, value_name = "FILE")]
    leaderboard: Option<PathBuf>,
    /// For the page: measure times over the number of vertices, up to this sphere, as subdivisions
    /// of the icosahedron; 10 has ten million vertices. Without it, those of the page stay
    #[arg(long, value_name = "LEVEL")]
    finest: Option<u32>,
}

/// The tasks.
const ALL: &[Task] = &[
    Task::new("load_obj", "OBJ file to positions and faces", files::load),
    Task::new("load_ply", "PLY file to positions and faces", files::load),
    Task::new("save_ply", "positions and faces to a binary PLY, doubles", files::save_ply),
    Task::new("laplacian", "cotangent stiffness and lumped barycentric mass", operators::laplacian),
    Task::new(
        "laplacian_again",
        "the same at other positions of the same faces",
        operators::refill,
    ),
    Task::new("curvature", "‖S x‖ / 2M and the angle defect", operators::curvature),
    Task::new(
        "principal",
        "principal curvatures and directions by --estimator",
        operators::principal,
    ),
    Task::new("explicit_uniform", "x + λLx, uniform weights", smoothing::explicit_uniform),
    Task::new("taubin", "pairs of steps λ and μ, uniform weights", smoothing::taubin),
    Task::new("implicit_uniform", "(I − λL)x' = x, uniform weights", smoothing::implicit_uniform),
    Task::new(
        "implicit_cotan",
        "(M + λh²S)x' = Mx, operator of the input",
        smoothing::implicit_cotan,
    ),
    Task::new("implicit_cotan_stiff", "the same, for large λ", smoothing::implicit_cotan),
    Task::new("implicit_mcf", "the same, operator of each step", smoothing::implicit_mcf),
    Task::new(
        "end_to_end",
        "read an OBJ, implicit uniform steps, write a binary PLY",
        smoothing::end_to_end,
    ),
    Task::new(
        "metrics",
        "vertex-to-surface distances both ways and normal angles, against --reference",
        operators::metrics,
    ),
    Task::new("eigs", "k smallest eigenpairs of S φ = ω M φ, with an inertia count", spectra::eigs),
    Task::new(
        "factor",
        "Cholesky of M + λh²S: analyse, factorise, solve for the positions",
        spectra::factor,
    ),
    Task::new(
        "harmonic",
        "(Wᵏ + M) u = M x, also mixed, by --k: factorise, solve, correct",
        harmonic::harmonic,
    ),
    Task::new("denoise", "the automatic denoiser", smoothing::denoise),
    Task::new(
        "bandwidth",
        "S times three columns, and the triad a = b + s c of STREAM",
        bandwidth::bandwidth,
    ),
];

fn main() -> ExitCode {
    match run(Bench::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::FAILURE
        }
    }
}

/// Times the task, or lists the tasks, and prints the result.
fn run(options: Bench) -> Result<()> {
    let Some(task) = options.task.clone() else {
        println!("{:<22} docs/speed.md, from measurements", "page");
        println!("{:<22} all verbs on fans, stars, cones and combs of n and 4 n triangles", "hubs");
        println!("{:<22} k-harmonic systems on a mesh, beside CHOLMOD and Eigen", "leaderboard");
        println!("{:<22} a mesh without symmetry, written to --out", "rock");
        for task in ALL {
            println!("{:<22} {}", task.name, task.about);
        }
        return Ok(());
    };
    if task == "page" {
        let [comparison, leaderboard] = [&options.comparison, &options.leaderboard];
        return page::write(comparison.as_deref(), leaderboard.as_deref(), options.finest);
    }
    if task == "hubs" {
        return hubs::run();
    }
    if task == "leaderboard" {
        let input = options.input.as_deref().context("missing input mesh: --in FILE")?;
        return leaderboard::run(input, options.repeat);
    }
    if task == "rock" {
        return rock::write(options.out.as_deref().context("missing output mesh: --out FILE")?);
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
    println!(
        "{}",
        json!({ "first": upper_median(seconds), "least": least, "processes": times.len() })
    );
    Ok(())
}

/// Runs a task and returns `{"runs": […], "fingerprint": {…}, "rss_mb": n}`.
fn measure(name: &str, job: &Job, repeat: usize) -> Result<Value> {
    let task = ALL.iter().find(|t| t.name == name).with_context(|| {
        let names: Vec<_> = ALL.iter().map(|t| t.name).collect();
        format!("there is no task {name}; there are {}", names.join(", "))
    })?;
    let mut work = (task.prepare)(job)?;
    let mut once = || {
        let mut watch = Stopwatch::default();
        let done = work(&mut watch)?;
        anyhow::Ok((watch.into_json(), done))
    };
    let (run, mut done) = once()?;
    let mut runs = vec![run];
    for _ in 1..repeat {
        drop(done);
        let (run, next) = once()?;
        runs.push(run);
        done = next;
    }
    // The peak is read before the fingerprint adds to it.
    let rss = task::peak_megabytes();
    let mut result = json!({ "runs": runs, "fingerprint": done()? });
    if let Some(megabytes) = rss {
        result["rss_mb"] = json!(megabytes);
    }
    Ok(result)
}
