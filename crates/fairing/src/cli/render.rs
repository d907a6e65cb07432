//! `fairing render`.

use std::path::Path;

use anyhow::anyhow;
use clap::{Args, ValueEnum};
use fairing::figure::{
    Background, Camera, ColorBar, ColorMap, ColoringOptions, Colors, Figure, Image, Occlusion,
    Panel, RenderOptions, Scale, Shading, Up, Viewpoint, Wireframe, render,
};
use fairing::mesh::TriMesh;
use fairing::mesh::io::VertexFields;
use glam::DVec3;
use serde_json::Value;

use super::context::{Context, Failure};
use super::files::{self, Content, Output};
use super::inputs::{Inputs, Summary};
use super::mask::unknown;
use super::surface::say_orientation;
use super::table::number;

const EXAMPLES: &str = "\
Examples:
  fairing render bunny.ply -o bunny.png
  fairing render bunny.ply -o bunny.png --view front --wireframe --size 1600x1200
  fairing curvature bunny.ply -o curved.ply
  fairing render curved.ply -o mean.png --field mean --map coolwarm --bar
  fairing render curved.ply -o mean.png --field mean --map hue --equalize";

/// Draw a mesh to a PNG picture, coloured by one of its fields
///
/// Without --field, shows the vertex colours of the file, if any. Vector fields are
/// shown by their length. The colour range is printed; by default it runs from the 2nd
/// to the 98th percentile. Vertices whose property `defined` is 0, as `fairing
/// curvature` writes it, are grey and do not affect the range.
#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Render {
    #[command(flatten)]
    inputs: Inputs,
    #[command(flatten)]
    output: Output,
    /// Vertex property to colour by
    #[arg(long, value_name = "NAME")]
    field: Option<String>,
    /// Colour map: viridis, cividis, magma, turbo, coolwarm or hue
    #[arg(long, value_name = "MAP", requires = "field")]
    map: Option<ColorMap>,
    /// Values at the two ends of the colour map
    #[arg(long, value_name = "LOW,HIGH", value_parser = range, allow_hyphen_values = true, requires = "field")]
    range: Option<(f64, f64)>,
    /// Equalise the histogram: each colour covers the same number of vertices
    #[arg(long, requires = "field")]
    equalize: bool,
    /// Draw a colour bar with the values below the picture
    #[arg(long, requires = "field", conflicts_with = "transparent")]
    bar: bool,
    /// Viewing direction: front, back, left, right, top, bottom, three-quarter,
    /// behind, or AZIMUTH,ELEVATION in degrees
    #[arg(long, value_name = "VIEW", default_value = "three-quarter", allow_hyphen_values = true)]
    view: Viewpoint,
    /// Axis that points up in the picture
    #[arg(long, value_enum, default_value = "y")]
    up: UpAxis,
    /// Width and height in pixels
    #[arg(long, value_name = "WxH", value_parser = size, default_value = "1200x900")]
    size: (u32, u32),
    /// Draw edges; they fade where they are denser than the pixels
    #[arg(long)]
    wireframe: bool,
    /// Normals used for shading
    #[arg(long, value_enum, default_value = "creased")]
    shading: ShadingKind,
    /// Leave the background transparent instead of white
    #[arg(long)]
    transparent: bool,
}

#[derive(Clone, Copy, ValueEnum)]
enum UpAxis {
    Y,
    Z,
}

#[derive(Clone, Copy, ValueEnum)]
enum ShadingKind {
    /// Smooth, except across edges sharper than 45°
    Creased,
    /// Smooth everywhere
    Smooth,
    /// Constant on each face
    Flat,
}

impl Render {
    pub(crate) fn run(&self, context: &Context) -> Result<(), Failure> {
        self.output.check(&self.inputs.paths)?;
        self.inputs.each(context, Summary::default(), &[], |context, input| {
            self.one(context, input).map(|()| Value::Null)
        })
    }

    fn one(&self, context: &Context, input: &Path) -> Result<(), Failure> {
        let output = self.output.of(context, input, Content::Png)?;
        let file = files::read_surface(context, input)?;
        files::say_report(context, input, &file.report);
        say_orientation(context, input, &file.mesh);
        let (scale, colors) = self.colors(context, &file.mesh, &file.fields)?;
        let mut image = self.draw(&file.mesh, &colors)?;
        if let (true, Some(scale), Some(quantity)) = (self.bar, scale, self.field.clone()) {
            image = with_bar(image, ColorBar { scale, quantity, unit: String::new() })?;
        }
        let png = image.to_png()?;
        files::write_bytes(&output, &png)
    }

    fn draw(&self, mesh: &TriMesh, colors: &Option<Vec<[u8; 3]>>) -> Result<Image, Failure> {
        let (width, height) = self.size;
        let options = RenderOptions {
            width,
            height,
            shading: match self.shading {
                ShadingKind::Creased => Shading::Creased { degrees: 45.0 },
                ShadingKind::Smooth => Shading::Smooth,
                ShadingKind::Flat => Shading::Flat,
            },
            wireframe: self.wireframe.then(Wireframe::default),
            background: if self.transparent { Background::Transparent } else { Background::WHITE },
            ..RenderOptions::default()
        };
        let up = match self.up {
            UpAxis::Y => Up::Y,
            UpAxis::Z => Up::Z,
        };
        let camera = Camera::fit(&[mesh], self.view, up, options.aspect())?;
        let colors = colors.as_deref().map_or(Colors::CLAY, Colors::PerVertex);
        Ok(render(mesh, colors, Some(&Occlusion::bake(mesh)), &camera, &options)?)
    }

    /// One colour per vertex, from the requested field, with its scale, or from the file.
    fn colors(
        &self,
        context: &Context,
        mesh: &TriMesh,
        fields: &VertexFields,
    ) -> Result<Colored, Failure> {
        let Some(name) = &self.field else {
            return Ok((None, fields.colors.clone()));
        };
        let values = values_of(fields, name)?;
        // Flags have a value everywhere.
        let flags = ["defined", "boundary"].contains(&&name[..]);
        let defined = fields.scalar("defined").filter(|_| !flags);
        let undefined: Option<Vec<bool>> =
            defined.map(|defined| defined.iter().map(|&d| d == 0.0).collect());
        let asked = ColoringOptions { map: self.map, range: self.range, equalize: self.equalize };
        let (scale, colors) = asked.colors(mesh, &values, undefined.as_deref())?;
        let without = undefined.iter().flatten().filter(|&&undefined| undefined).count();
        if without > 0 {
            let all = mesh.vertex_count();
            context.note(format_args!("{name} is undefined at {without} of {all} vertices: grey"));
        }
        context.print(format_args!(
            "{name}: {} from {} to {}\n",
            scale.map().name(),
            number(scale.low()),
            number(scale.high())
        ))?;
        Ok((Some(scale), Some(colors)))
    }
}

/// The scale of a field, and colours of the vertices.
type Colored = (Option<Scale>, Option<Vec<[u8; 3]>>);

/// The picture with a colour bar below it.
fn with_bar(image: Image, bar: ColorBar) -> Result<Image, Failure> {
    // Pixels of the picture for a CSS pixel of the bar, so that its words can be read.
    let zoom = if image.width() < 800 { 1.0 } else { 2.0 };
    let width = f64::from(image.width());
    let panel = Panel::image(image, width / zoom);
    let figure = Figure { panels: vec![panel], bars: vec![bar], ..Figure::default() };
    Ok(figure.draw().to_image(zoom)?)
}

/// The values of a scalar field, or the lengths of a vector field.
fn values_of(fields: &VertexFields, name: &str) -> Result<Vec<f64>, Failure> {
    if let Some(values) = fields.scalar(name) {
        return Ok(values.to_vec());
    }
    if let Some(vectors) = fields.vector(name) {
        return Ok(vectors.iter().map(|&v| DVec3::from(v).length()).collect());
    }
    let scalars = fields.scalars.iter().map(|(n, _)| &n[..]);
    Err(unknown(name, scalars.chain(fields.vectors.iter().map(|(n, _)| &n[..]))))
}

fn range(text: &str) -> anyhow::Result<(f64, f64)> {
    pair(text, ',')
}

pub(crate) fn size(text: &str) -> anyhow::Result<(u32, u32)> {
    let (w, h) = text.split_once('x').ok_or_else(|| anyhow!("expected WIDTHxHEIGHT"))?;
    Ok((w.parse()?, h.parse()?))
}

fn pair(text: &str, separator: char) -> anyhow::Result<(f64, f64)> {
    let (a, b) = text
        .split_once(separator)
        .ok_or_else(|| anyhow!("expected two numbers with '{separator}' between them"))?;
    let (a, b): (f64, f64) = (a.trim().parse()?, b.trim().parse()?);
    anyhow::ensure!(a.is_finite() && b.is_finite(), "{text} is not finite");
    Ok((a, b))
}
