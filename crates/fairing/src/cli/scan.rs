//! `fairing scan`.

use std::path::{Path, PathBuf};

use clap::Args;
use fairing::evaluation::{ScanOptions, add_noise, scan};
use fairing::mesh::io::VertexFields;
use fairing::task::Unit;
use serde_json::Value;

use super::context::{Context, Failure};
use super::files::{self, Content, Output};
use super::inputs::{Inputs, Summary, check_distinct, output_for};
use super::noise::{Kind, Point, point, units};
use super::render::size;
use super::table::number;

const EXAMPLES: &str = "\
Examples:
  fairing scan fandisk.off -o seen.ply --camera 3,1,6
  fairing scan fandisk.off -o noisy.ply --truth truth.ply --camera 3,1,6 --size 160x120 --sigma 0.67";

/// Simulate a depth camera's view of a mesh
///
/// Casts a ray through each pixel and connects the hits into triangles, except across depth
/// discontinuities. With --sigma, adds sensor noise; the noisy mesh and its ground truth have the
/// same faces, so the pair can train or score denoisers. +y is up, or +z for a camera that looks
/// along y.
#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Scan {
    #[command(flatten)]
    inputs: Inputs,
    #[command(flatten)]
    output: Output,
    /// Also write the mesh without noise; {stem} as in --output
    #[arg(long, value_name = "FILE")]
    truth: Option<PathBuf>,
    /// Position of the camera [default: three diagonals of the bounding box from its centre along
    /// +z]
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = point)]
    camera: Option<Point>,
    /// Point in the middle of the image [default: the centre of the bounding box]
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = point)]
    look_at: Option<Point>,
    /// Columns and rows of pixels, each from 2 to 2048
    #[arg(long, value_name = "WxH", value_parser = size, default_value = "320x240")]
    size: (u32, u32),
    /// Horizontal field of view, in degrees [default: the smallest that shows the whole mesh]
    #[arg(long, value_name = "DEGREES", allow_negative_numbers = true)]
    fov: Option<f64>,
    /// Largest difference of depth along an edge, in widths of a pixel
    #[arg(long, value_name = "N", default_value_t = 5.0, allow_negative_numbers = true)]
    jump: f64,
    /// Add noise of this level: the root mean square displacement of a depth camera
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    sigma: Option<f64>,
    /// The unit of sigma; edges are those of the scan
    #[arg(long, value_name = "UNIT", value_parser = units(), default_value = "edge")]
    unit: Unit,
    #[command(flatten)]
    kind: Kind,
    /// Seed of the random numbers
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
}

impl Scan {
    pub(crate) fn run(&self, context: &Context) -> Result<(), Failure> {
        self.output.check(&self.inputs.paths)?;
        check_distinct(self.truth.as_deref(), &self.inputs.paths)?;
        self.inputs.each(context, Summary::default(), &[], |context, input| {
            self.one(context, input).map(|()| Value::Null)
        })
    }

    fn one(&self, context: &Context, input: &Path) -> Result<(), Failure> {
        let output = self.output.of(context, input, Content::Mesh)?;
        let truth = self.truth.as_deref().map(|pattern| output_for(pattern, input));
        if let Some(truth) = &truth {
            self.output.overwrite.check(context, truth, Content::Mesh)?;
        }
        let kind = self.kind.or("depth-camera", None)?;
        if self.sigma.is_none() && self.kind.is_given() {
            return Err(Failure::usage("--kind, --fraction and --length need --sigma"));
        }
        let file = files::read_surface(context, input)?;
        files::say_report(context, input, &file.report);
        let options = ScanOptions {
            camera: self.camera.map(|Point(camera)| camera),
            look_at: self.look_at.map(|Point(target)| target),
            size: self.size.into(),
            field_of_view: self.fov,
            jump: self.jump,
        };
        let seen = scan(&file.mesh, &options)?;
        context.note(format_args!(
            "{} vertices and {} faces seen",
            seen.mesh.vertex_count(),
            seen.mesh.face_count()
        ));
        let fields = VertexFields::default();
        if let Some(truth) = &truth {
            files::write_held(context, truth, &seen.mesh, &fields)?;
        }
        let Some(sigma) = self.sigma else {
            return files::write_held(context, &output, &seen.mesh, &fields).map(drop);
        };
        let kind = kind.with_camera(seen.camera).unwrap_or(kind);
        let level = self.unit.level(sigma);
        let noisy = add_noise(&seen.mesh, kind, level, self.seed)?;
        let sigma = number(level.in_mesh_units(&seen.mesh));
        context.note(format_args!("sigma = {sigma} in units of the file"));
        files::write_held(context, &output, &noisy, &fields).map(drop)
    }
}
