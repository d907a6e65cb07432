//! `cargo xtask study …`.

mod cli;
mod denoisers;

use std::process::ExitCode;

use clap::Parser as _;
use cli::{Cli, Command};

#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

fn main() -> ExitCode {
    let result = match Cli::parse().command {
        Command::List { choice } => denoisers::list(&choice),
        Command::Tune(options) => denoisers::tune(options),
        Command::Measure(options) => denoisers::measure(options),
        Command::Train(options) => denoisers::train(&options),
        Command::Tables => denoisers::write_tables(None),
        Command::Models => denoisers::models(),
        Command::Correlation { fit } => denoisers::correlation(fit),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::FAILURE
        }
    }
}
