//! The commands and their options.

use std::path::{Path, PathBuf};
use std::process::Command as Process;

use anyhow::{Context as _, Result};
use clap::{Args, Parser, Subcommand};

use crate::compare::{Difference, differences};
use crate::results::Results;
use crate::runner::{self, Form, Plan};
use crate::{bench, data, experiments, gate, readme, reference, tidy};

/// Regenerates the report, measures speed, and keeps the repository in order.
#[derive(Debug, Parser)]
#[command(name = "cargo xtask", bin_name = "cargo xtask", version, about)]
pub struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Run the experiments and write the report: report.md, report.html, results.json, tables, figures, meshes
    Reproduce(Reproduce),
    /// Generate the meshes of data/, which stand in for the assignment's
    Data {
        /// Verify the meshes that are there against the manifest and their generators
        #[arg(long)]
        check: bool,
    },
    /// Time one task inside the process
    Bench(Bench),
    /// Hold the tree against its rules: arrows between crates, file lengths, machine paths, the README
    Tidy,
    /// Run everything that guards a merge: tidy, format, lints, documentation, tests, examples, reference values
    Test,
}

#[derive(Debug, Args)]
struct Reproduce {
    /// Run these experiments only
    #[arg(long, value_name = "IDS", value_delimiter = ',')]
    only: Vec<String>,
    /// Folder that holds the assignment's meshes, searched by file name; FAIRING_MESHES does the same. Without it, generated meshes stand in
    #[arg(long, value_name = "DIR")]
    meshes: Option<PathBuf>,
    /// Folder for the report; an earlier report there is replaced when the new one is complete
    #[arg(long, value_name = "DIR", default_value = "out/report")]
    out: PathBuf,
    /// Smaller sizes and fewer repetitions
    #[arg(long)]
    quick: bool,
    /// Run everything, also what has not changed since the last run
    #[arg(long)]
    fresh: bool,
    /// List the experiments and do nothing else
    #[arg(long)]
    list: bool,
    /// Run on the generated meshes and compare with the committed reference values, within each column's tolerance; times are not compared. Writes no report
    #[arg(long, conflicts_with_all = ["meshes", "out", "accept", "diff"])]
    check: bool,
    /// Run on the generated meshes and make the results the reference values: those of a full run are the report in docs/report, those of a quick one stand in docs/reference
    #[arg(long, conflicts_with_all = ["meshes", "out", "only", "diff"])]
    accept: bool,
    /// Compare two results.json and do nothing else
    #[arg(long, num_args = 2, value_names = ["OLD", "NEW"])]
    diff: Option<Vec<PathBuf>>,
}

#[derive(Debug, Args)]
struct Bench {
    /// The task, or `build` for the times of builds from an empty target folder; without one, the tasks are listed
    task: Option<String>,
    /// The mesh
    #[arg(long = "in", value_name = "FILE")]
    input: Option<PathBuf>,
    /// How often to repeat the work
    #[arg(long, default_value_t = 1)]
    repeat: usize,
    /// Threads to use; all by default
    #[arg(long)]
    threads: Option<usize>,
    /// Print one JSON object on the last line
    #[arg(long)]
    json: bool,
    /// Curvature estimator of the task principal
    #[arg(long, default_value = "quadric")]
    estimator: String,
    /// Eigenpairs
    #[arg(long, default_value_t = 15)]
    k: usize,
    /// The step
    #[arg(long, default_value_t = 0.5)]
    lambda: f64,
    /// The second, negative step of Taubin's method
    #[arg(long, default_value_t = -0.53, allow_negative_numbers = true)]
    mu: f64,
    /// Steps
    #[arg(long, default_value_t = 10)]
    iters: usize,
    /// Where to write the resulting mesh
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// The mesh without noise
    #[arg(long, value_name = "FILE")]
    reference: Option<PathBuf>,
}

impl Cli {
    /// Does what was asked; `false` if something that was checked did not hold.
    ///
    /// # Errors
    ///
    /// Whatever stands in the way.
    pub fn run(self) -> Result<bool> {
        match self.command {
            Command::Reproduce(options) => options.run(),
            Command::Data { check: false } => data::generate(&root().join("data")).map(|()| true),
            Command::Data { check: true } => check_data(),
            Command::Bench(options) => options.run(),
            Command::Tidy => tidy::run(&root()),
            Command::Test => gate::run(&root()),
        }
    }
}

/// The root of the repository, known when this program was built.
pub(crate) fn root() -> PathBuf {
    let manifest = Path::new(env!("CARGO_MANIFEST_DIR"));
    manifest.parent().unwrap_or(manifest).to_path_buf()
}

fn check_data() -> Result<bool> {
    let wrong = data::check(&root().join("data"))?;
    for line in &wrong {
        eprintln!("data: {line}");
    }
    if wrong.is_empty() {
        println!("data: every mesh is as the manifest says");
    }
    Ok(wrong.is_empty())
}

impl Reproduce {
    fn run(self) -> Result<bool> {
        if self.list {
            for experiment in experiments::ALL {
                let card = experiment.card();
                println!("{:<12} {}", card.id, card.title);
            }
            return Ok(true);
        }
        if let Some([old, new]) = self.diff.as_deref() {
            let (old, new) = (Results::read(old)?, Results::read(new)?);
            return Ok(agree(&differences(&old, &new, false)));
        }
        if self.check || self.accept {
            return self.hold_against_reference();
        }
        let meshes = self.meshes.clone();
        let meshes = meshes.or_else(|| std::env::var_os("FAIRING_MESHES").map(PathBuf::from));
        let results = runner::reproduce(experiments::ALL, &self.plan(meshes, &self.out))?;
        println!("The report is in {}.", self.out.display());
        Ok(succeeded(&results))
    }

    fn plan(&self, meshes: Option<PathBuf>, out: &Path) -> Plan {
        Plan {
            root: root(),
            only: self.only.clone(),
            meshes,
            out: out.to_path_buf(),
            cache: root().join("target/reproduce"),
            quick: self.quick,
            fresh: self.fresh,
            form: if self.accept { Form::Small } else { Form::Whole },
        }
    }

    /// Reference values are those of the generated meshes, which everybody has.
    fn hold_against_reference(&self) -> Result<bool> {
        let publish = self.accept && !self.quick;
        let folder = root().join(if publish { reference::REPORT } else { "target/check" });
        let results = runner::reproduce(experiments::ALL, &self.plan(None, &folder))?;
        if self.accept {
            if publish {
                readme::update(&root(), &results)?;
            } else {
                reference::accept(&root(), &results)?;
            }
            println!(
                "The reference values are in {}.",
                reference::path(&root(), self.quick).display()
            );
            return Ok(succeeded(&results));
        }
        let partial = !self.only.is_empty();
        Ok(succeeded(&results) & agree(&reference::check(&root(), &results, partial)?))
    }
}

/// Prints the differences, and says whether there are none.
fn agree(differences: &[Difference]) -> bool {
    for difference in differences {
        eprintln!("{difference}");
    }
    match differences.len() {
        0 => println!("No differences."),
        n => eprintln!("{n} differences."),
    }
    differences.is_empty()
}

/// Prints the verdicts, and says whether every experiment ran.
fn succeeded(results: &Results) -> bool {
    for claim in results.experiments.iter().flat_map(|r| &r.claims) {
        println!("  {:<4} {:<10} {}", claim.id, claim.verdict.to_string(), claim.claim);
    }
    results.experiments.iter().all(|r| r.error.is_none())
}

/// Runs the same command in a build without checks, with the optimisation that
/// people who install the program get.
fn optimised() -> Result<bool> {
    let mut cargo = Process::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    let manifest = root().join("Cargo.toml");
    cargo.args(["run", "--release", "--package=xtask", "--manifest-path"]).arg(manifest);
    cargo.arg("--").args(std::env::args_os().skip(1));
    Ok(cargo.status().context("running cargo")?.success())
}

impl Bench {
    fn run(self) -> Result<bool> {
        let Some(task) = self.task else {
            println!("{:<22} builds from an empty target folder", "build");
            for task in bench::ALL {
                println!("{:<22} {}", task.name(), task.about());
            }
            return Ok(true);
        };
        if task == "build" {
            return bench::build::run(&root()).map(|()| true);
        }
        if cfg!(debug_assertions) {
            return optimised();
        }
        let job = bench::Job {
            input: self.input.context("which mesh? say --in FILE")?,
            out: self.out,
            reference: self.reference,
            estimator: self.estimator,
            k: self.k,
            lambda: self.lambda,
            mu: self.mu,
            iterations: self.iters,
        };
        let threads = rayon::ThreadPoolBuilder::new().num_threads(self.threads.unwrap_or(0));
        threads.build_global().context("starting threads")?;
        let result = bench::measure(&task, &job, self.repeat)?;
        if self.json {
            println!("{result}");
        } else {
            println!("{}", serde_json::to_string_pretty(&result)?);
        }
        Ok(true)
    }
}
