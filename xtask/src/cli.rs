//! The commands and their options.

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand};

/// Regenerates the report, measures speed, and keeps the repository in order.
#[derive(Debug, Parser)]
#[command(name = "cargo xtask", bin_name = "cargo xtask", version, about)]
pub struct Cli {
    #[command(subcommand)]
    pub(crate) command: Command,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Run the experiments and write the report: report.md, report.html, results.json, tables, figures, meshes
    Reproduce(Reproduce),
    /// Write report.md and report.html of a report again, from its results.json and the files beside it
    Report {
        /// The folder of the report
        #[arg(value_name = "DIR")]
        folder: PathBuf,
    },
    /// Generate the meshes of data/, which stand in for the assignment's
    Data {
        /// Verify the meshes that are there against the manifest and their generators
        #[arg(long)]
        check: bool,
    },
    /// Time one task inside the process
    Bench(Bench),
    /// The test bed of the denoisers: generated bodies with noise, and what published methods reach on them
    #[command(subcommand)]
    Bed(Bed),
    /// Train the regression of normals of the automatic denoiser on generated bodies, and write its numbers
    Train(Train),
    /// Hold the tree against its rules: arrows between crates, file lengths, machine paths, the README
    Tidy,
    /// Build the wheel of the Python package into target/wheels; makes a virtual environment and fetches maturin
    Wheel,
    /// Run everything that guards a merge: tidy, format, lints, documentation, tests, examples, reference values, Python
    ///
    /// The Python package is tested in a virtual environment, for which pip fetches packages; where it cannot, these
    /// tests are skipped by name.
    Test {
        /// Also build the wheel, install it, and run what is slow: data sets on a cluster, notebooks, type checkers
        #[arg(long)]
        python: bool,
    },
}

#[derive(Debug, Args)]
pub(crate) struct Reproduce {
    /// Run these experiments only
    #[arg(long, value_name = "IDS", value_delimiter = ',')]
    pub(crate) only: Vec<String>,
    /// Folder that holds the assignment's meshes, searched by file name; FAIRING_MESHES does the same. Without it, generated meshes take their place
    #[arg(long, value_name = "DIR")]
    pub(crate) meshes: Option<PathBuf>,
    /// Folder for the report, out/report by default; an earlier report there is replaced when the new one is complete
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Smaller sizes and fewer repetitions
    #[arg(long)]
    pub(crate) quick: bool,
    /// Run everything, also what has not changed since the last run
    #[arg(long)]
    pub(crate) fresh: bool,
    /// List the experiments and do nothing else
    #[arg(long)]
    pub(crate) list: bool,
    /// Run on the generated meshes and compare with the committed reference values, within each column's tolerance; times are not compared. Runs everything, and writes no report but to a folder given by --out
    #[arg(long, conflicts_with_all = ["meshes", "accept", "diff"])]
    pub(crate) check: bool,
    /// Run on the generated meshes and make the results the reference values: those of a full run are the report in docs/report, those of a quick one are in docs/reference
    #[arg(long, conflicts_with_all = ["meshes", "out", "only", "diff"])]
    pub(crate) accept: bool,
    /// Compare two results.json and do nothing else
    #[arg(long, num_args = 2, value_names = ["OLD", "NEW"])]
    pub(crate) diff: Option<Vec<PathBuf>>,
}

#[derive(Debug, Args)]
pub(crate) struct Bench {
    /// The task, or `build` for the times of builds from an empty target folder; without one, the tasks are listed
    pub(crate) task: Option<String>,
    /// The mesh
    #[arg(long = "in", value_name = "FILE")]
    pub(crate) input: Option<PathBuf>,
    /// How often to repeat the work
    #[arg(long, default_value_t = 1)]
    pub(crate) repeat: usize,
    /// Threads to use; all by default
    #[arg(long)]
    pub(crate) threads: Option<usize>,
    /// Print one JSON object on the last line
    #[arg(long)]
    pub(crate) json: bool,
    /// Curvature estimator of the task principal
    #[arg(long, default_value = "quadric")]
    pub(crate) estimator: String,
    /// Eigenpairs
    #[arg(long, default_value_t = 15)]
    pub(crate) k: usize,
    /// The step
    #[arg(long, default_value_t = 0.5)]
    pub(crate) lambda: f64,
    /// The second, negative step of Taubin's method
    #[arg(long, default_value_t = -0.53, allow_negative_numbers = true)]
    pub(crate) mu: f64,
    /// Steps
    #[arg(long, default_value_t = 10)]
    pub(crate) iters: usize,
    /// Where to write the resulting mesh
    #[arg(long, value_name = "FILE")]
    pub(crate) out: Option<PathBuf>,
    /// The mesh without noise
    #[arg(long, value_name = "FILE")]
    pub(crate) reference: Option<PathBuf>,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Bed {
    /// Search the best parameters of every published method on every case, with the truth, and keep what they reach in docs/reference/published.csv; cases that are there are passed over
    Tune {
        #[command(flatten)]
        which: Which,
        /// Search these methods only
        #[arg(long, value_name = "NAMES", value_delimiter = ',')]
        methods: Vec<String>,
        /// Folder that holds the pairs of the literature, which are tuned too; FAIRING_MESHES does the same
        #[arg(long, value_name = "DIR")]
        meshes: Option<PathBuf>,
    },
    /// Run a denoiser with its defaults on every case, and compare with what published methods reach
    Measure {
        #[command(flatten)]
        which: Which,
        /// The denoiser
        #[arg(long, value_name = "NAME", default_value = "automatic")]
        denoiser: String,
        /// Write a line for each case into this CSV file
        #[arg(long, value_name = "FILE")]
        csv: Option<PathBuf>,
        /// Keep the results of the automatic denoiser on all cases in docs/reference/bed.csv, for the experiment "denoisers"
        #[arg(long, conflicts_with_all = ["set", "filter", "denoiser", "csv"])]
        accept: bool,
        /// Write the true, noisy and denoised meshes into this folder
        #[arg(long, value_name = "DIR")]
        keep: Option<PathBuf>,
        /// Folder that holds the pairs of the literature; FAIRING_MESHES does the same
        #[arg(long, value_name = "DIR")]
        meshes: Option<PathBuf>,
    },
    /// List the cases
    List {
        #[command(flatten)]
        which: Which,
    },
}

/// Which cases.
#[derive(Debug, Args)]
pub(crate) struct Which {
    /// One set of families only: development, unseen, fresh
    #[arg(long, value_name = "SET")]
    pub(crate) set: Option<fairing_experiments::bed::Set>,
    /// Cases whose name contains one of these only
    #[arg(long, value_name = "TEXTS", value_delimiter = ',')]
    pub(crate) filter: Vec<String>,
}

#[derive(Debug, Args)]
pub(crate) struct Train {
    /// The stages in a row
    #[arg(long, default_value_t = 4)]
    pub(crate) stages: usize,
    /// The networks of each stage
    #[arg(long, default_value_t = 2)]
    pub(crate) members: usize,
    /// Bodies of each family
    #[arg(long, default_value_t = 26)]
    pub(crate) bodies: u64,
    /// Faces drawn from each body for each stage
    #[arg(long, default_value_t = 1200)]
    pub(crate) faces: usize,
    /// Passes over these faces
    #[arg(long, default_value_t = 16)]
    pub(crate) epochs: usize,
    /// The seed of all draws
    #[arg(long, default_value_t = 1)]
    pub(crate) seed: u64,
    /// The file; that of the release by default
    #[arg(long, value_name = "FILE")]
    pub(crate) out: Option<PathBuf>,
}
