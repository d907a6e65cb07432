//! Files named on the command line.

use std::io::Write;
use std::path::{Path, PathBuf};

use clap::Args;
use fairing::mesh::TriMesh;
use fairing::mesh::io::{
    self, Format, MeshFile, ReadError, ReadOptions, ReadProblem, ReadReport, VertexFields,
    WriteOptions, WriteProblem, WriteReport,
};
use fairing::watch;

use super::context::{Context, Failure};

/// The output file of a verb.
#[derive(Args)]
pub(crate) struct Output {
    /// The file to write
    #[arg(short = 'o', long = "output", value_name = "FILE")]
    pub(crate) path: PathBuf,
    #[command(flatten)]
    pub(crate) overwrite: Overwrite,
}

/// [`Output`], optional if `--list` is given.
#[derive(Args)]
pub(crate) struct MaybeOutput {
    /// The file to write
    #[arg(short = 'o', long = "output", value_name = "FILE", required_unless_present = "list")]
    path: Option<PathBuf>,
    #[command(flatten)]
    overwrite: Overwrite,
}

impl MaybeOutput {
    /// The output, if given.
    pub(crate) fn given(&self) -> Option<Output> {
        let path = self.path.clone()?;
        Some(Output { path, overwrite: Overwrite { force: self.overwrite.force } })
    }
}

/// Permission to replace an existing file.
#[derive(Args)]
pub(crate) struct Overwrite {
    /// Replace the output if it exists; a symbolic link stays and its target is replaced
    #[arg(long)]
    pub(crate) force: bool,
}

/// The content of an output file, which its extension must allow.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Content {
    /// A mesh, with fields if the format holds them.
    Mesh,
    /// A mesh with fields, which the format must hold.
    Fields,
    /// A picture.
    Png,
    /// Arrays.
    Npz,
}

impl Content {
    /// Refuses a file extension that does not match.
    fn check(self, path: &Path) -> Result<(), String> {
        let extension = path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase());
        let is = |wanted: &str| match extension.as_deref() == Some(wanted) {
            true => Ok(()),
            false => Err(format!("the file extension must be .{wanted}")),
        };
        match (self, Format::from_path(path).map(|named| named.format)) {
            (Self::Png, _) => is("png"),
            (Self::Npz, _) => is("npz"),
            (_, None) => Err(WriteProblem::unknown_extension().to_string()),
            (Self::Fields, Some(format)) if !format.holds().fields => {
                let others = Format::ALL.into_iter().filter(|format| format.holds().fields);
                let others: Vec<String> = others
                    .map(|format| format!("{format} (.{0} or .{0}.gz)", format.extensions()[0]))
                    .collect();
                Err(format!("{format} holds no fields; write {}", others.join(" or ")))
            }
            _ => Ok(()),
        }
    }
}

impl Overwrite {
    /// Refuses an output that cannot be written, before any work is done for it: an extension
    /// that does not match its content, a folder that is missing or read-only, an existing file.
    pub(crate) fn check(&self, path: &Path, content: Content) -> Result<(), Failure> {
        let refused =
            |reason: &str| Failure::output(anyhow::anyhow!("{}: {reason}", path.display()));
        content.check(path).map_err(|reason| refused(&reason))?;
        io::check_writable(path)
            .map_err(|error| refused(&format!("cannot be written: {error}")))?;
        if !self.force && path.exists() {
            return Err(Failure::output(anyhow::anyhow!(
                "{} exists; add --force to replace it",
                path.display()
            )));
        }
        Ok(())
    }

    /// [`check`](Self::check) for an optional output; refuses `--force` without one.
    pub(crate) fn check_given(&self, path: Option<&Path>, content: Content) -> Result<(), Failure> {
        match path {
            Some(path) => self.check(path, content),
            None if self.force => {
                Err(Failure::usage("--force needs --output: without it nothing is written"))
            }
            None => Ok(()),
        }
    }
}

impl Output {
    /// [`Overwrite::check`] of the path.
    pub(crate) fn check(&self, content: Content) -> Result<(), Failure> {
        self.overwrite.check(&self.path, content)
    }
}

/// Reads a mesh with its fields.
pub(crate) fn read(context: &Context, path: &Path) -> Result<MeshFile, Failure> {
    let file = io::read_with(path, &reading(context)).map_err(unreadable)?;
    watch::stage("preparing", 0);
    Ok(file)
}

/// Reading options shared by all verbs.
pub(crate) fn reading(context: &Context) -> ReadOptions {
    match context.drop_broken {
        true => ReadOptions::dropping_broken(),
        false => ReadOptions::default(),
    }
}

/// The failure to read a file, with the option that would read it if there is one.
pub(crate) fn unreadable(error: ReadError) -> Failure {
    use ReadProblem::{IndexOutOfRange, NonFinite};
    match error.problem {
        NonFinite { .. } | IndexOutOfRange { .. } => Failure::input(anyhow::anyhow!(
            "{error}; --drop-broken leaves out faces with such vertices"
        )),
        _ => Failure::input(error),
    }
}

/// Prints the faces that the reader split, reduced or left out, and the content it ignored.
pub(crate) fn say_report(context: &Context, path: &Path, report: &ReadReport) {
    let changed = report.polygons > 0 || report.reduced > 0 || report.left_out > 0;
    let changed = changed || report.broken_vertices > 0 || report.broken_faces > 0;
    if changed || !report.notes.is_empty() {
        context.note(format_args!("{}: {report}", path.display()));
    }
}

/// Writes a mesh with fields, whole or not at all.
pub(crate) fn write(
    context: &Context,
    path: &Path,
    mesh: &TriMesh,
    fields: &VertexFields,
    options: &WriteOptions,
) -> Result<(), Failure> {
    let report = io::write_with_fields(path, mesh, fields, options).map_err(Failure::output)?;
    say_written(context, path, &report);
    Ok(())
}

/// Prints the properties that the format could not store, if any.
pub(crate) fn say_written(context: &Context, path: &Path, report: &WriteReport) {
    if !report.dropped.is_empty() {
        let names = report.dropped.join(", ");
        context.note(format_args!("{}: {} cannot store {names}", path.display(), report.format));
    }
    for note in &report.notes {
        context.note(format_args!("{}: {note}", path.display()));
    }
}

/// Writes bytes, whole or not at all.
pub(crate) fn write_bytes(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    io::write_whole(path, |file| file.write_all(bytes))
        .map_err(|error| Failure::output(anyhow::anyhow!("{}: {error}", path.display())))
}

/// Writes a mesh whose vertices have moved, with its properties except normals, which do not fit
/// any more. Properties that the format cannot store are left out and named.
pub(crate) fn write_moved(
    context: &Context,
    output: &Output,
    mesh: &TriMesh,
    fields: VertexFields,
) -> Result<(), Failure> {
    write_held(context, &output.path, mesh, &fields.without_normals())
}

/// Writes a mesh with the properties that the format can store, and names the others.
pub(crate) fn write_held(
    context: &Context,
    path: &Path,
    mesh: &TriMesh,
    fields: &VertexFields,
) -> Result<(), Failure> {
    let options = WriteOptions::default().dropping_fields();
    write(context, path, mesh, fields, &options)
}
