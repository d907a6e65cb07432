//! From the bytes of an OBJ file to those of an STL file, without a file system.
//!
//! `cargo run --example convert_in_memory < bunny.obj > bunny.stl`

use std::io::{Read, Write};

use anyhow::Result;
use fairing::mesh::io::{self, Format, Reader, WriteOptions};

fn main() -> Result<()> {
    run(std::io::stdin().lock(), std::io::stdout().lock())
}

pub(crate) fn run(obj: impl Read, stl: impl Write) -> Result<()> {
    let file = Reader::default().read_from(obj, Some(Format::Obj))?;
    let options = WriteOptions::default().dropping_fields();
    let report = io::write_to(stl, Format::Stl, &file.mesh, &file.fields, &options)?;
    for loss in report.dropped.iter().chain(&report.notes) {
        eprintln!("{loss}");
    }
    Ok(())
}
