//! The commands and their options.

use std::path::{Path, PathBuf};

use crate::experiments;
use crate::model::compare::differences;
use crate::model::results::{Form, Results};
use anyhow::Result;
use clap::{Args, Parser, Subcommand};

use crate::run::plan::{Plan, measure, reproduce};
use crate::run::{data, reference};

/// Runs the experiments, writes the report, and generates the data
#[derive(Debug, Parser)]
#[command(name = "reproduce", bin_name = "cargo xtask", version, about)]
pub struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Run the experiments and write the report: report.md, report.html, results.json, tables,
    /// figures, meshes
    Reproduce(Reproduce),
    /// Write report.md and report.html of a report again, from its results.json and the files
    /// beside it
    Report {
        /// The folder of the report
        #[arg(value_name = "DIR")]
        folder: PathBuf,
    },
    /// Generate the meshes of data/, which stand in for the assignment's
    Data {
        /// Compare the meshes that are there with the manifest and with their generators
        #[arg(long)]
        check: bool,
    },
}

#[derive(Debug, Args)]
struct Reproduce {
    /// Run these experiments only
    #[arg(long, value_name = "IDS", value_delimiter = ',')]
    only: Vec<String>,
    /// Folder that holds the assignment's meshes, searched by file name; FAIRING_MESHES does the
    /// same. Without it, generated meshes take their place
    #[arg(long, value_name = "DIR")]
    meshes: Option<PathBuf>,
    /// Folder for the report, out/report by default; an earlier report there is replaced when the
    /// new one is complete
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Smaller sizes and fewer repetitions
    #[arg(long)]
    quick: bool,
    /// Run all experiments, including those that have not changed since the last run
    #[arg(long)]
    fresh: bool,
    /// List the experiments and do nothing else
    #[arg(long)]
    list: bool,
    /// Run on the generated meshes and compare with the committed reference values, within each
    /// column's tolerance; times are not compared. Runs everything, and writes no report but to a
    /// folder given by --out
    #[arg(long, conflicts_with_all = ["meshes", "accept", "diff"])]
    check: bool,
    /// Run on the generated meshes and make the results the reference values: those of a full run
    /// are the report in docs/report, those of a quick one are in docs/reference
    #[arg(long, conflicts_with_all = ["meshes", "out", "only", "diff"])]
    accept: bool,
    /// Compare two results.json and do nothing else
    #[arg(long, num_args = 2, value_names = ["OLD", "NEW"])]
    diff: Option<Vec<PathBuf>>,
}

impl Cli {
    /// Runs the command; `false` if a check failed or an experiment did not run.
    pub fn run(self) -> Result<bool> {
        match self.command {
            Command::Reproduce(options) => options.run(),
            Command::Report { folder } => crate::page::render(&folder).map(|()| true),
            Command::Data { check: false } => data::generate(&root().join("data")).map(|()| true),
            Command::Data { check: true } => check_data(),
        }
    }
}

/// The root of the repository, known when this program was built.
pub(crate) fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// The folder that `FAIRING_MESHES` names; an empty name is none.
fn meshes_folder() -> Option<PathBuf> {
    std::env::var_os("FAIRING_MESHES").filter(|name| !name.is_empty()).map(PathBuf::from)
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
            // Compared values are measured, never taken from an earlier run.
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
            if !publish {
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

/// Prints the differences; returns true if there is no difference.
fn agree(differences: &[String]) -> bool {
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
