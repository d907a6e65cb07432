//! The command line: one file per verb, and the code that verbs share.
//!
//! A verb is a struct of arguments with a method `run`. To add one, write its
//! file, and add a line to the modules, to [`Verb`] and to [`Verb::run`].

mod compare;
mod completions;
mod context;
mod convert;
mod curvature;
mod denoise;
mod files;
mod geodesic;
mod info;
mod inputs;
mod mask;
mod noise;
mod operator;
mod parameters;
mod progress;
mod reconstruct;
mod render;
mod repair;
mod scan;
mod smooth;
mod spectrum;
mod surface;
mod table;

use std::process::ExitCode;

use clap::{CommandFactory, Parser, Subcommand};
use fairing::mesh::io::Format;
use fairing::watch::Watch;
use indicatif::ProgressBar;

use context::{Context, Failure};
use surface::{INPUT_FORMAT, formats};

/// Formats, exit codes and examples, printed below the help of the program.
fn after_help() -> String {
    format!("Formats: {}{AFTER_FORMATS}", Format::ALL.map(Format::name).join(", "))
}

const AFTER_FORMATS: &str = ", each also gzip-compressed (.gz); the file extension decides.
Vertices keep their order in the file, isolated ones included.

Exit codes: 0 success; 1 the computation failed; 2 invalid usage; 3 an input cannot be read;
4 an output cannot be written, for instance because it exists and --force is missing;
130 interrupted by Ctrl-C.

Examples:
  fairing info bunny.ply
  fairing repair scan.stl -o clean.ply
  fairing curvature bunny.ply -o curved.ply
  fairing smooth scan.obj -o smooth.obj --method implicit --lambda 5
  curl … | fairing convert - - --to stl | fairing info -";

/// Geometry processing on triangle meshes with the Laplacian.
#[derive(Parser)]
#[command(name = "fairing", version, about, after_help = after_help(), arg_required_else_help = true)]
struct Cli {
    /// Maximum number of threads; results do not depend on it
    #[arg(long, global = true, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    threads: Option<u16>,
    /// Print only results and errors; show no progress
    #[arg(long, short, global = true)]
    quiet: bool,
    /// Drop faces that use a missing or non-finite vertex, and report how many; such vertices keep
    /// their indices and take the position of the first valid vertex
    #[arg(long, global = true)]
    drop_broken: bool,
    /// Format of the standard input (file name -), if its content is ambiguous
    #[arg(
        id = INPUT_FORMAT,
        long = "from",
        global = true,
        value_name = "NAME",
        value_parser = formats(),
    )]
    from: Option<Format>,
    /// Format of the standard output (file name -)
    #[arg(
        long,
        alias = "format",
        global = true,
        value_name = "NAME",
        value_parser = formats(),
    )]
    to: Option<Format>,
    #[command(subcommand)]
    verb: Verb,
}

#[derive(Subcommand)]
enum Verb {
    Info(info::Info),
    Convert(convert::Convert),
    Repair(repair::Repair),
    Curvature(curvature::Curvature),
    Spectrum(spectrum::Spectrum),
    Reconstruct(reconstruct::Reconstruct),
    Geodesic(geodesic::Geodesic),
    Smooth(Box<smooth::Smooth>),
    Noise(noise::Noise),
    Scan(scan::Scan),
    Denoise(denoise::Denoise),
    Compare(compare::Compare),
    Render(render::Render),
    Completions(completions::Completions),
}

impl Verb {
    fn run(&self, context: &Context) -> Result<(), Failure> {
        match self {
            Self::Info(verb) => verb.run(context),
            Self::Convert(verb) => verb.run(context),
            Self::Repair(verb) => verb.run(context),
            Self::Curvature(verb) => verb.run(context),
            Self::Spectrum(verb) => verb.run(context),
            Self::Reconstruct(verb) => verb.run(context),
            Self::Geodesic(verb) => verb.run(context),
            Self::Smooth(verb) => verb.run(context),
            Self::Noise(verb) => verb.run(context),
            Self::Scan(verb) => verb.run(context),
            Self::Denoise(verb) => verb.run(context),
            Self::Compare(verb) => verb.run(context),
            Self::Render(verb) => verb.run(context),
            Self::Completions(verb) => verb.run(context, &mut Cli::command()),
        }
    }
}

/// Parses the arguments, runs the verb and turns a failure into its exit code.
pub(crate) fn main() -> ExitCode {
    let cli = Cli::parse();
    if let Some(threads) = cli.threads {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads.into()).build_global();
        if let Err(error) = pool {
            eprintln!("error: {threads} threads cannot be started: {error}");
            return ExitCode::from(1);
        }
    }
    let context = Context {
        quiet: cli.quiet,
        drop_broken: cli.drop_broken,
        from: cli.from,
        to: cli.to,
        bar: ProgressBar::hidden(),
        watch: Watch::new(),
        file: None,
    };
    match progress::run(&context, || cli.verb.run(&context)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => failure.report(),
    }
}
