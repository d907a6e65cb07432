//! `fairing convert`.

use std::path::PathBuf;

use clap::Args;
use fairing::mesh::io::{
    self, Encoding, FloatWidth, Format, PolygonFile, ReadOptions, UnsupportedFields, WriteOptions,
};

use super::context::{Context, Failure};
use super::files::{self, Content, Overwrite};

/// Convert a mesh to another format
///
/// The file extensions decide the formats (`fairing help` lists them); add .gz to
/// compress. Vertices keep their order, isolated ones included, except in STL, which
/// stores corners instead of vertices. Polygons stay polygons if the format holds
/// them. Content that the format cannot hold is left out and named.
#[derive(Args)]
pub(crate) struct Convert {
    /// The mesh to read
    input: PathBuf,
    /// The file to write
    output: PathBuf,
    #[command(flatten)]
    overwrite: Overwrite,
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
        self.overwrite.check(&self.output, Content::Mesh)?;
        let format = Format::from_path(&self.output).map(|named| named.format);
        if let Some(format) = format {
            self.check(format)?;
        }
        let reading = match (self.strict, context.drop_broken) {
            (true, true) => {
                return Err(Failure::usage("--strict and --drop-broken exclude each other"));
            }
            (true, false) => ReadOptions::strict(),
            (false, _) => files::reading(context),
        };
        let PolygonFile { mesh, fields, report, .. } =
            io::read_polygons_with(&self.input, &reading).map_err(files::unreadable)?;
        files::say_report(context, &self.input, &report);
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
        if self.triangulate || format.is_some_and(|format| !format.holds().polygons) {
            let (mesh, fields) = io::triangulate(&mesh, fields);
            return files::write(context, &self.output, &mesh, &fields, &options);
        }
        let report = io::write_polygons(&self.output, &mesh, &fields, &options);
        files::say_written(context, &self.output, &report.map_err(Failure::output)?);
        Ok(())
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
