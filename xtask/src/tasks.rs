//! What the commands do.

use std::path::{Path, PathBuf};
use std::process::Command as Process;

use anyhow::{Context as _, Result};
use fairing_experiments::experiments;
use fairing_results::compare::{Difference, differences};
use fairing_results::results::{Form, Results};

use crate::cli::{Bench, Cli, Command, Reproduce};
use crate::meshes::meshes_folder;
use crate::reproduce::{Plan, measure, reproduce};
use crate::{bed, bench, data, gate, python, readme, reference, tidy, train};

/// Does what was asked; `false` if something that was checked did not hold.
///
/// # Errors
///
/// Any failure of the task.
pub fn run(cli: Cli) -> Result<bool> {
    match cli.command {
        Command::Reproduce(options) => options.run(),
        Command::Report { folder } => fairing_report::render(&folder).map(|()| true),
        Command::Data { check: false } => data::generate(&root().join("data")).map(|()| true),
        Command::Data { check: true } => check_data(),
        Command::Bench(options) => options.run(),
        Command::Bed(command) => bed::run(command, &root()).map(|()| true),
        Command::Train(options) => train::run(&options, &root()).map(|()| true),
        Command::Tidy => tidy::run(&root()),
        Command::Wheel => python::wheel(&root()),
        Command::Test { python } => gate::run(&root(), python),
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
        let meshes = self.meshes.clone().or_else(meshes_folder);
        let out = self.out.as_deref().unwrap_or(Path::new("out/report"));
        let results = reproduce(experiments::ALL, &self.plan(meshes, out))?;
        println!("The report is in {}.", out.display());
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
        let results = match &self.out {
            // What is compared is measured, never taken from an earlier run.
            Some(out) => {
                let plan = Plan { fresh: true, ..self.plan(None, out) };
                reproduce(experiments::ALL, &plan)?
            }
            None if publish => {
                reproduce(experiments::ALL, &self.plan(None, &root().join(reference::REPORT)))?
            }
            None => measure(experiments::ALL, &self.plan(None, Path::new("")))?,
        };
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
