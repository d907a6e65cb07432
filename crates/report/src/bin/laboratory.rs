//! `laboratory MODULE PAGE`: writes the laboratory with a compressed module.

use std::path::PathBuf;

use anyhow::{Context as _, Result, bail};

fn main() -> Result<()> {
    let arguments: Vec<PathBuf> = std::env::args_os().skip(1).map(PathBuf::from).collect();
    let [module, page] = &arguments[..] else { bail!("usage: laboratory MODULE PAGE") };
    let module = std::fs::read(module).with_context(|| module.display().to_string())?;
    std::fs::write(page, fairing_report::page::laboratory(&module)?)
        .with_context(|| page.display().to_string())
}
