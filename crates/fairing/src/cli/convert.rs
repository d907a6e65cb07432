//! `fairing convert`.

use std::path::{Path, PathBuf};

use clap::Args;
use fairing::mesh::io::{
    Encoding, FloatWidth, Format, MeshFile, Strictness, UnsupportedFields, WriteOptions,
};

use serde_json::Value;

use super::context::{Context, Failure};
use super::files::{self, Content, Overwrite};
use super::inputs::{self, Jobs, Summary, check_distinct, output_for};

/// Convert a mesh to another format
///
/// The file extensions decide the formats (`fairing help` lists them); add .gz to
/// compress. Vertices keep their order, isolated ones included, except in STL, which
/// stores corners instead of vertices. Polygons stay polygons if the format holds
/// them. GLB and binary STL round numbers to 32 bits.
/// Content that the format cannot hold is left out and named.
#[derive(Args)]
pub(crate) struct Convert {
    /// Input and output file; with --output, all files are inputs
    #[arg(value_name = "FILE", required = true)]
    files: Vec<PathBuf>,
    /// The file to write; of several inputs, {stem} in it is the name of each without folder and
    /// extension; - is the standard output
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    #[command(flatten)]
    overwrite: Overwrite,
    #[command(flatten)]
    jobs: Jobs,
    /// Split polygons into triangles
    #[arg(long)]
    triangulate: bool,
    /// Write text instead of binary, for formats that have both
    #[arg(long)]
    ascii: bool,
    /// Write 32-bit numbers, for formats with several widths (default: as many bits as keep
    /// every number exact)
    #[arg(long)]
    single: bool,
    /// Fail if something would be lost (faces that repeat a corner, properties that the format
    /// cannot hold) instead of leaving it out and naming it
    #[arg(long)]
    strict: bool,
}

impl Convert {
    pub(crate) fn run(&self, context: &Context) -> Result<(), Failure> {
        let (inputs, pattern) = match (&self.files[..], &self.output) {
            (inputs, Some(pattern)) => (inputs, pattern),
            ([input, output], None) => (std::slice::from_ref(input), output),
            _ => {
                return Err(Failure::usage(
                    "give one mesh and the file to write, or several meshes and --output",
                ));
            }
        };
        check_distinct(Some(pattern), inputs)?;
        let inputs: Vec<&Path> = inputs.iter().map(PathBuf::as_path).collect();
        inputs::each(context, &inputs, &self.jobs, Summary::default(), &[], |context, input| {
            self.one(context, input, &output_for(pattern, input)).map(|()| Value::Null)
        })
    }

    fn one(&self, context: &Context, input: &Path, output: &Path) -> Result<(), Failure> {
        self.overwrite.check(context, output, Content::Mesh)?;
        let named = Format::from_path(output).map(|named| named.format);
        let format = named.or(context.to);
        if let Some(format) = format {
            self.check(format)?;
        }
        let mut reading = files::reading(context);
        if self.strict {
            if context.drop_broken {
                return Err(Failure::usage("--strict and --drop-broken exclude each other"));
            }
            reading.strictness = Strictness::Strict;
        }
        let MeshFile { mut mesh, fields, report, .. } = files::read_with(context, input, &reading)?;
        files::say_report(context, input, &report);
        let mut options = WriteOptions::default();
        if self.ascii {
            options.encoding = Encoding::Ascii;
        }
        if self.single {
            options.float_width = FloatWidth::Single;
        }
        if !self.strict {
            options.unsupported_fields = UnsupportedFields::Drop;
        }
        if self.triangulate {
            mesh = mesh.without_polygons();
        }
        files::write(context, output, &mesh, &fields, &options).map(drop)
    }

    /// Refuses options that the format would ignore.
    fn check(&self, format: Format) -> Result<(), Failure> {
        let holds = format.holds();
        let ignored = [
            (self.ascii && !holds.binary, "--ascii"),
            (self.single && !holds.float_widths, "--single"),
        ]
        .into_iter()
        .find_map(|(ignored, name)| ignored.then_some(name));
        match ignored {
            None => Ok(()),
            Some(option) => Err(Failure::usage(format_args!(
                "{option} has no effect on {format} files; leave it out"
            ))),
        }
    }
}
