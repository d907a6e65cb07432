//! The commands and their options.

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand};
use fairing_study::Set;

/// Measures denoisers on generated models with noise, tunes the published ones, and trains ours
#[derive(Debug, Parser)]
#[command(name = "study", bin_name = "cargo xtask study", version, about)]
pub(crate) struct Cli {
    #[command(subcommand)]
    pub(crate) command: Command,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// List the cases
    List {
        #[command(flatten)]
        choice: Choice,
    },
    /// Search the best parameters of every published method on every case, with the truth
    ///
    /// The results go into study/results/published.csv; cases that are already there are skipped.
    Tune(Tune),
    /// Run a denoiser with its defaults on every case, and compare it with the published methods
    Measure(Measure),
    /// Train the networks of the automatic denoiser on generated models, and write their weights
    Train(Train),
    /// Write the tables of the report again, from the stored results
    Tables,
    /// Write the models of the experiment "denoisers" into data
    Models,
    /// Count where the denoiser finds the noise of a depth camera, on generated scans and models
    Correlation {
        /// Fit the weights of the test on the development set, and print them
        #[arg(long)]
        fit: bool,
    },
}

/// The cases to take.
#[derive(Debug, Args)]
pub(crate) struct Choice {
    /// Only one set of families: development, unseen or fresh
    #[arg(long, value_name = "SET")]
    pub(crate) set: Option<Set>,
    /// Views of models with the noise of a depth camera, with correlated noise and with the waves
    /// of fused views, and whole models with such waves, in place of the cases
    #[arg(long)]
    pub(crate) scans: bool,
    /// Surfaces that marching cubes finds in noisy volumes of models, in place of the cases
    #[arg(long, conflicts_with = "scans")]
    pub(crate) volumes: bool,
    /// Only cases whose name contains one of these texts
    #[arg(long, value_name = "TEXTS", value_delimiter = ',')]
    pub(crate) filter: Vec<String>,
}

#[derive(Debug, Args)]
pub(crate) struct Tune {
    #[command(flatten)]
    pub(crate) choice: Choice,
    /// Only these methods
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    pub(crate) methods: Vec<String>,
    /// Folder with the pairs of the literature, to tune on them too; FAIRING_MESHES does the same
    #[arg(long, value_name = "DIR")]
    pub(crate) meshes: Option<PathBuf>,
}

#[derive(Debug, Args)]
pub(crate) struct Measure {
    #[command(flatten)]
    pub(crate) choice: Choice,
    /// The denoiser
    #[arg(long, value_name = "NAME", default_value = "automatic")]
    pub(crate) denoiser: String,
    /// Write a line for each case into this CSV file
    #[arg(long, value_name = "FILE")]
    pub(crate) csv: Option<PathBuf>,
    /// Keep the results of the automatic denoiser on all cases in study/results/automatic.csv, and
    /// their tables in docs/reference/denoising, for the experiment "denoisers"
    #[arg(long, conflicts_with_all = ["set", "scans", "volumes", "filter", "denoiser", "csv"])]
    pub(crate) accept: bool,
    /// Write the true, noisy and denoised meshes into this folder
    #[arg(long, value_name = "DIR")]
    pub(crate) keep: Option<PathBuf>,
    /// Folder with the pairs of the literature, to measure on them too; FAIRING_MESHES does the
    /// same
    #[arg(long, value_name = "DIR")]
    pub(crate) meshes: Option<PathBuf>,
}

#[derive(Debug, Args)]
pub(crate) struct Train {
    /// Train the networks for correlated noise, on views and on cut models
    #[arg(long)]
    pub(crate) correlated: bool,
    /// Stages in a row
    #[arg(long, default_value_t = 4)]
    pub(crate) stages: usize,
    /// Networks of each stage
    #[arg(long, default_value_t = 2)]
    pub(crate) members: usize,
    /// Models of each family
    #[arg(long, default_value_t = 128)]
    pub(crate) models: u64,
    /// Faces drawn from each model for each stage
    #[arg(long, default_value_t = 1200)]
    pub(crate) faces: usize,
    /// Passes over these faces
    #[arg(long, default_value_t = 24)]
    pub(crate) epochs: usize,
    /// The seed of all draws
    #[arg(long, default_value_t = 1)]
    pub(crate) seed: u64,
    /// The file of weights; by default the one that the denoiser is built with
    #[arg(long, value_name = "FILE")]
    pub(crate) out: Option<PathBuf>,
}
