//! `fairing completions`.

use clap::{Args, CommandFactory};

use super::exit::Failure;
use super::{Cli, Context};

/// Print a completion script for a shell
///
/// For bash: fairing completions bash > ~/.local/share/bash-completion/completions/fairing
#[derive(Args)]
pub(crate) struct Completions {
    /// The shell
    shell: clap_complete::Shell,
}

impl Completions {
    pub(crate) fn run(&self, context: &Context) -> Result<(), Failure> {
        // Into memory first: the generator panics when a pipe closes.
        let mut script = Vec::new();
        clap_complete::generate(self.shell, &mut Cli::command(), "fairing", &mut script);
        context.print(String::from_utf8_lossy(&script))
    }
}
