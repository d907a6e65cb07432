//! The pictures, plots and the view of question 7.

use anyhow::Result;
use fairing_evaluation::NoiseLevel;
use fairing_figure::{Axis, Figure, Legend, Panel as FigurePanel, Plot, Series, Up, Viewpoint};
use fairing_mesh::TriMesh;
use fairing_smoothing::denoise::Denoiser;
use rayon::prelude::*;

use super::{ASSIGNMENT, SWEEP};
use crate::experiment::Context;
use crate::experiments::gallery::{VIEWPOINTS, plotted};
use crate::experiments::grid::{Grid, Row};
use crate::experiments::restoring::{Body, Method};
use crate::outcome::Picture;
use crate::table::{Cell, Table};
use crate::view::{Panel, Slider, View};

/// The columns of the pictures.
const SHOWN: [Method; 6] = [
    Method::Nothing,
    Method::Explicit,
    Method::Implicit,
    Method::Denoiser(Denoiser::BilateralNormal),
    Method::Denoiser(Denoiser::GuidedNormal),
    Method::Denoiser(Denoiser::Automatic),
];

/// The lines of the plots: as many as there are colours.
const CURVES: [Method; 7] = [
    Method::Explicit,
    Method::Implicit,
    Method::Taubin,
    Method::Spectral,
    Method::Denoiser(Denoiser::BilateralNormal),
    Method::Denoiser(Denoiser::GuidedNormal),
    Method::Denoiser(Denoiser::Automatic),
];

/// The levels of the scan's pictures, in h.
const SCAN_LEVELS: [f64; 3] = [0.1, 0.3, 1.0];

/// The noisy part and what the methods make of it, a row for each level of the assignment.
pub(super) fn of_levels(context: &Context<'_>, part: &Body) -> Result<Picture> {
    let rows = ASSIGNMENT.map(|sigma| (format!("σ = {sigma}"), NoiseLevel::Model(sigma)));
    grid(context, part, &rows, VIEWPOINTS[0], Up::Z)?.draw(
        part,
        "levels",
        "The machine part under the assignment's three levels of noise, in model units, and after each method; flat shaded, so that every face shows its normal.",
        "Three rows of six pictures of the machine part: at the two lower levels guided filtering and the automatic denoiser bring its faces and edges back, smoothing rounds them; at the highest nothing is left of it.",
    )
}

/// The same of the scan, levels in h.
pub(super) fn of_scan(context: &Context<'_>, scan: &Body) -> Result<Picture> {
    let rows = SCAN_LEVELS.map(|sigma| (format!("σ = {sigma} h"), NoiseLevel::EdgeLengths(sigma)));
    let viewpoint = Viewpoint::Angles { azimuth: 30.0, elevation: 10.0 };
    let up = if context.is_present(crate::inputs::Input::Scan) { Up::Y } else { Up::Z };
    grid(context, scan, &rows, viewpoint, up)?.draw(
        scan,
        "scan",
        "The scan under three levels of noise in mean edge lengths, and after each method.",
        "Three rows of six pictures of an animal: at the highest level only its outline is left.",
    )
}

/// The meshes of a grid.
struct Restored {
    rows: Vec<(String, Vec<TriMesh>)>,
    viewpoint: Viewpoint,
    up: Up,
}

fn grid(
    context: &Context<'_>,
    body: &Body,
    levels: &[(String, NoiseLevel)],
    viewpoint: Viewpoint,
    up: Up,
) -> Result<Restored> {
    let mut rows = vec![];
    for (title, level) in levels {
        let noisy = body.noisy(*level, context.seed("noise"))?;
        let meshes = SHOWN.par_iter().map(|&m| body.restore(m, &noisy));
        rows.push((title.clone(), meshes.collect::<Result<Vec<_>>>()?));
    }
    Ok(Restored { rows, viewpoint, up })
}

impl Restored {
    fn draw<'a>(&'a self, body: &'a Body, id: &str, caption: &str, alt: &str) -> Result<Picture> {
        let row = |(title, meshes): &'a (String, Vec<TriMesh>)| Row {
            title: title.clone(),
            frame: &body.truth,
            meshes: meshes.iter().collect(),
            titles: SHOWN.map(|m| m.name().into()).to_vec(),
        };
        Grid {
            rows: self.rows.iter().map(row).collect(),
            viewpoint: self.viewpoint,
            up: self.up,
            aspect: 1.0,
        }
        .draw(id, caption, alt)
    }
}

/// Errors over the noise, a figure for each error with a plot for each mesh.
pub(super) fn curves(sweep: &Table) -> Result<Vec<Picture>> {
    let errors = [
        (
            "normals",
            "E_a",
            "E_a in degrees",
            "E_a over the noise, mean and standard deviation over seeds; the dashed line is the noisy input. A method helps where it runs below.",
        ),
        (
            "distances",
            "E_v",
            "E_v in h",
            "E_v over the noise, likewise: at little noise smoothing moves vertices further from the surface than the noise did.",
        ),
    ];
    let draw = |(id, column, label, caption): (&str, &str, &str, &str)| -> Result<Picture> {
        let mut figure = Figure { columns: 3, ..Figure::default() };
        for (i, mesh) in ["block", "torus", "scan"].into_iter().enumerate() {
            let mut plot = Plot {
                title: mesh.into(),
                x: Axis::log("noise σ/h"),
                y: Axis::log(if i == 0 { label } else { "" }),
                legend: if i == 2 { Legend::Right } else { Legend::None },
                ..Plot::default()
            };
            let rows = sweep.only(&[("mesh", mesh.into())])?;
            for (style, method) in CURVES.into_iter().enumerate() {
                let rows = rows.only(&[("method", method.name().into())])?;
                let (x, y) = (rows.column("σ/h")?, rows.column(column)?);
                let spread = rows.index(&format!("± {column}"))?;
                let deviations = rows.rows.iter().map(|r| Cell::number(&r[spread]).unwrap_or(0.0));
                let band = x.iter().zip(&y).zip(deviations);
                let band = band.map(|((x, y), d)| [*x, (y - d).max(0.5 * y), y + d]).collect();
                plot.series.push(Series::band(band, style));
                let points = x.into_iter().zip(y).map(|(x, y)| [x, y]).collect();
                plot.series
                    .push(Series { style: Some(style), ..Series::marked(method.name(), points) });
            }
            let input = rows.only(&[("method", Method::Nothing.name().into())])?;
            let points = input.column("σ/h")?.into_iter().zip(input.column(column)?);
            let points = points.map(|(x, y)| [x, y]).collect();
            plot.series.push(Series::reference(Method::Nothing.name(), points));
            let width = if i == 2 { 420.0 } else { 270.0 };
            figure.panels.push(FigurePanel::drawing(plot.draw(width, 300.0)?));
        }
        plotted(
            &figure,
            id,
            caption,
            "Three plots of error over noise on logarithmic axes, a line for each method.",
        )
    };
    errors.into_iter().map(draw).collect()
}

/// The scan with a slider over the noise: noisy, smoothed, denoised.
pub(super) fn view(context: &Context<'_>, scan: &Body) -> Result<View> {
    let methods = [Method::Nothing, Method::Implicit, Method::Denoiser(Denoiser::Automatic)];
    let stops = context.choose(&SWEEP[..], &SWEEP[2..5]);
    let noisy = stops
        .iter()
        .map(|&sigma| scan.noisy(NoiseLevel::EdgeLengths(sigma), context.seed("noise")))
        .collect::<Result<Vec<_>>>()?;
    let mut panels = vec![];
    for method in methods {
        let restored = noisy.par_iter().map(|mesh| scan.restore(method, mesh));
        let restored = restored.collect::<Result<Vec<TriMesh>>>()?;
        let positions = restored.iter().map(TriMesh::positions);
        panels.push(Panel::moving(method.name(), &scan.truth, positions));
    }
    Ok(View {
        id: "scan-view".into(),
        caption: "The scan under growing noise, in mean edge lengths: as it is, after one implicit step, and after the automatic denoiser.".into(),
        alt: "The scan three times, to turn; a slider changes the noise.".into(),
        fallback: "scan".into(),
        sliders: vec![Slider {
            name: "σ/h".into(),
            stops: stops.iter().map(ToString::to_string).collect(),
        }],
        panels,
    })
}
