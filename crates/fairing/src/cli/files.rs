//! Files named on the command line.

use std::io::{Write, stdin, stdout};
use std::path::{Path, PathBuf};

use clap::Args;
use fairing::mesh::TriMesh;
use fairing::mesh::io::{
    self, Format, MeshFile, ReadError, ReadProblem, ReadReport, Reader, VertexFields, WriteError,
    WriteOptions, WriteProblem, WriteReport,
};
use fairing::watch;
use serde_json::Value;

use super::context::{Context, Failure, STDIN, STDOUT};
use super::inputs::{check_distinct, output_for};

/// The output of a verb, required or not.
#[derive(Args)]
pub(crate) struct Output<const REQUIRED: bool = true> {
    /// Output file; {stem} in it is replaced by the input's name without folder and extension; - is
    /// standard output
    #[arg(short = 'o', long = "output", value_name = "FILE", required = REQUIRED)]
    path: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) overwrite: Overwrite,
}

/// The optional output of a verb.
pub(crate) type OptionalOutput = Output<false>;

/// Permission to replace an existing file.
#[derive(Args)]
pub(crate) struct Overwrite {
    /// Overwrite an existing output; for a symbolic link, overwrite its target
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
    /// Polylines.
    Lines,
    /// A picture.
    Png,
    /// Arrays.
    Npz,
}

impl Content {
    /// Refuses a file extension that does not match, or the format of the standard output.
    fn check(self, path: &Path, stream: Option<Format>) -> Result<(), String> {
        let format = if !is_stream(path) {
            Format::from_path(path).map(|named| named.format)
        } else if matches!(self, Self::Lines | Self::Png | Self::Npz) {
            return Ok(());
        } else {
            Some(stream.ok_or("name the format of the standard output: --to")?)
        };
        let extension = path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase());
        let is = |wanted: &str| {
            let found = extension.as_deref() == Some(wanted);
            found.then_some(()).ok_or_else(|| format!("the file extension must be .{wanted}"))
        };
        match (self, format) {
            (Self::Lines, _) => is("obj"),
            (Self::Png, _) => is("png"),
            (Self::Npz, _) => is("npz"),
            (_, None) => Err(WriteProblem::unknown_extension().to_string()),
            (Self::Fields, Some(format)) if !format.holds().fields => {
                let holds = |format: &Format| format.holds().fields;
                let others = Format::ALL.into_iter().filter(holds);
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
    pub(crate) fn check(
        &self,
        context: &Context,
        path: &Path,
        content: Content,
    ) -> Result<(), Failure> {
        let refused =
            |reason: &str| Failure::output(anyhow::anyhow!("{}: {reason}", path.display()));
        content.check(path, context.to).map_err(|reason| refused(&reason))?;
        if is_stream(path) {
            return Ok(());
        }
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
}

impl<const REQUIRED: bool> Output<REQUIRED> {
    /// Refuses a pattern that gives two inputs the same output, and `--force` without one.
    pub(crate) fn check(&self, inputs: &[PathBuf]) -> Result<(), Failure> {
        if self.path.is_none() && self.overwrite.force {
            return Err(Failure::usage("--force needs --output: without it nothing is written"));
        }
        check_distinct(self.path.as_deref(), inputs)
    }

    /// Returns true if there is an output.
    pub(crate) fn is_given(&self) -> bool {
        self.path.is_some()
    }

    /// The output of an input, if any. Fails if it cannot be written.
    pub(crate) fn if_given(
        &self,
        context: &Context,
        input: &Path,
        content: Content,
    ) -> Result<Option<PathBuf>, Failure> {
        let Some(pattern) = self.path.as_deref() else { return Ok(None) };
        let path = output_for(pattern, input);
        self.overwrite.check(context, &path, content)?;
        Ok(Some(path))
    }
}

impl Output {
    /// The output of an input. Fails if it cannot be written.
    pub(crate) fn of(
        &self,
        context: &Context,
        input: &Path,
        content: Content,
    ) -> Result<PathBuf, Failure> {
        // Required, unless an option is given that stands alone.
        let path = self.if_given(context, input, content)?;
        path.ok_or_else(|| Failure::usage("missing --output"))
    }
}

/// Returns true for the name of the standard streams.
fn is_stream(path: &Path) -> bool {
    path == Path::new("-")
}

/// Reads a mesh with its fields.
pub(crate) fn read(context: &Context, path: &Path) -> Result<MeshFile, Failure> {
    read_with(context, path, &reading(context))
}

/// [`read`] by another reader.
pub(crate) fn read_with(
    context: &Context,
    path: &Path,
    reader: &Reader,
) -> Result<MeshFile, Failure> {
    let file = if is_stream(path) {
        reader.read_from(stdin().lock(), context.from).map_err(in_stdin)
    } else {
        reader.read(path)
    };
    let file = file.map_err(unreadable)?;
    watch::stage("preparing", 0);
    Ok(file)
}

/// [`read`] for commands that need faces: refuses points.
pub(crate) fn read_surface(context: &Context, path: &Path) -> Result<MeshFile, Failure> {
    let file = read(context, path)?;
    if file.mesh.face_count() == 0 {
        return Err(Failure::input(anyhow::anyhow!(
            "{}: {} points without faces; only info, convert and repair take these",
            path.display(),
            file.mesh.vertex_count()
        )));
    }
    Ok(file)
}

/// The error of reading the standard input, with its name.
fn in_stdin(mut error: ReadError) -> ReadError {
    error.file = STDIN.into();
    error
}

/// The reader of all verbs.
pub(crate) fn reading(context: &Context) -> Reader {
    if context.drop_broken { Reader::dropping_broken() } else { Reader::default() }
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

/// Prints the faces that the reader split, reduced or left out, and the content it ignored, a line
/// each.
pub(crate) fn say_report(context: &Context, path: &Path, report: &ReadReport) {
    // The first line is the summary.
    for line in report.to_string().lines().skip(1) {
        context.note(format_args!("{}: {line}", path.display()));
    }
}

/// Writes a mesh with fields, whole or not at all.
pub(crate) fn write(
    context: &Context,
    path: &Path,
    mesh: &TriMesh,
    fields: &VertexFields,
    options: &WriteOptions,
) -> Result<WriteReport, Failure> {
    let report = match (is_stream(path), context.to) {
        (true, Some(format)) => {
            let written = io::write_to(stdout().lock(), format, mesh, fields, options);
            written.map_err(|error| WriteError::new(STDOUT, error.problem))
        }
        _ => io::write_with_fields(path, mesh, fields, options),
    };
    let report = report.map_err(Failure::output)?;
    say_written(context, path, &report);
    Ok(report)
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

/// A JSON summary with the number of polygons that the output has as triangles.
pub(crate) fn with_split(mut summary: Value, report: &WriteReport) -> Value {
    if let Value::Object(entries) = &mut summary {
        entries.insert("split_polygons".to_owned(), report.split_polygons.into());
    }
    summary
}

/// The fields with others, which replace those of the same names.
pub(crate) fn with_fields(
    mut fields: VertexFields,
    scalars: Vec<(&str, Vec<f64>)>,
    vectors: Vec<(&str, Vec<[f64; 3]>)>,
) -> VertexFields {
    fields.scalars.retain(|(name, _)| scalars.iter().all(|(n, _)| n != name));
    fields.vectors.retain(|(name, _)| vectors.iter().all(|(n, _)| n != name));
    fields.scalars.extend(scalars.into_iter().map(|(name, values)| (name.to_owned(), values)));
    fields.vectors.extend(vectors.into_iter().map(|(name, values)| (name.to_owned(), values)));
    fields
}

/// Writes bytes, whole or not at all.
pub(crate) fn write_bytes(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    let written = if is_stream(path) {
        stdout().lock().write_all(bytes)
    } else {
        io::write_whole(path, |file| file.write_all(bytes))
    };
    let name = if is_stream(path) { STDOUT.into() } else { path.display().to_string() };
    written.map_err(|error| Failure::output(anyhow::Error::new(error).context(name)))
}

/// Writes a mesh whose vertices have moved, with its properties except normals, which do not fit
/// any more. Properties that the format cannot store are left out and named.
pub(crate) fn write_moved(
    context: &Context,
    path: &Path,
    mesh: &TriMesh,
    fields: VertexFields,
) -> Result<WriteReport, Failure> {
    write_held(context, path, mesh, &fields.without_normals())
}

/// Writes a mesh with the properties that the format can store, and names the others.
pub(crate) fn write_held(
    context: &Context,
    path: &Path,
    mesh: &TriMesh,
    fields: &VertexFields,
) -> Result<WriteReport, Failure> {
    let options = WriteOptions::default().dropping_fields();
    write(context, path, mesh, fields, &options)
}
