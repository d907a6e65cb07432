//! `fairing completions`.

use clap::{Args, Command};

use super::context::{Context, Failure};

/// Print a completion script for a shell
///
/// For bash: fairing completions bash > ~/.local/share/bash-completion/completions/fairing
#[derive(Args)]
pub(crate) struct Completions {
    /// The shell
    shell: clap_complete::Shell,
}

impl Completions {
    pub(crate) fn run(&self, context: &Context, command: &mut Command) -> Result<(), Failure> {
        // Into memory first: the generator panics when a pipe closes.
        let mut script = Vec::new();
        clap_complete::generate(self.shell, command, "fairing", &mut script);
        context.print(String::from_utf8_lossy(&script))
    }
}
