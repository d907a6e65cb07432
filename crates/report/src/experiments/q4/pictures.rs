//! The pictures of question 4: meshes from their modes, modes, and errors.

use anyhow::Result;
use fairing_figure::{
    Axis, Figure, Limits, Panel as FigurePanel, Plot, ScaleOptions, Series, Shape, Up, Viewpoint,
};
use fairing_mesh::TriMesh;
use fairing_operators::curvature::{ScalarCurvature, VertexStatus};
use fairing_sparse::{larger, smaller};
use fairing_spectral::Spectrum;

use super::super::gallery::{Coloring, Gallery, Look, Range, plotted};
use super::super::mode_sums::TEXT;
use super::super::models::slug;
use super::super::refinement::{between, second_order};
use super::super::surfaces::Sampling;
use crate::experiment::outcome::Picture;
use crate::experiment::text::values;
use crate::model::table::{Table, brief};
use crate::model::view::{Panel, Slider, View};

/// The name of the generated mesh, which both kinds of runs have.
pub(super) const BALL: &str = "bumpy ball";

const VIEWS: [Viewpoint; 2] = [
    Viewpoint::Angles { azimuth: 20.0, elevation: 10.0 },
    Viewpoint::Angles { azimuth: 140.0, elevation: 20.0 },
];

pub(super) fn picture(
    id: &str,
    name: &str,
    to_see: &str,
    mesh: &TriMesh,
    stops: &[usize],
    rebuilt: &[TriMesh],
    occlusion: bool,
) -> Result<Picture> {
    let titles: Vec<String> = stops.iter().map(|k| format!("k = {k}")).collect();
    let mut looks = vec![];
    for i in [0, 1, 3, stops.len() - 1] {
        if let (Some(title), Some(mesh)) = (titles.get(i), rebuilt.get(i)) {
            looks.push((title.as_str(), mesh));
        }
    }
    looks.push(("original", mesh));
    looks.dedup_by_key(|l| l.0);
    let looks =
        looks.into_iter().map(|(title, mesh)| Look { title, mesh, coloring: None }).collect();
    Gallery { looks, viewpoints: &VIEWS, up: Up::Y, aspect: 0.9, occlusion }.draw(
        id,
        &TEXT.say(
            "figure rebuilt",
            values! { seen: to_see, name, counterpart: counterpart(name)? },
        )?,
        &TEXT.say("figure rebuilt alt", values! { name })?,
    )
}

/// The figure of the original report that shows the same, in parentheses; it has no bumpy ball.
fn counterpart(name: &str) -> Result<String> {
    if name == BALL {
        return Ok(String::new());
    }
    Ok(format!(" {}", TEXT.say("counterpart", &[])?))
}

/// The modes drawn, by number.
const DRAWN: [usize; 5] = [1, 2, 4, 9, 29];

pub(super) fn modes_picture(
    id: &str,
    name: &str,
    mesh: &TriMesh,
    modes: &Spectrum,
    occlusion: bool,
) -> Result<Picture> {
    let fields: Vec<(String, ScalarCurvature)> = DRAWN
        .iter()
        .filter(|&&i| i < modes.len())
        .map(|&i| {
            let mode = modes.modes.column(i);
            let largest = mode.iter().fold(f64::MIN_POSITIVE, |m, x| larger(m, x.abs()));
            let n = mesh.vertex_count();
            let field = ScalarCurvature::new(
                mode.iter().map(|x| x / largest).collect(),
                vec![VertexStatus::Defined; n],
                vec![false; n],
            );
            (format!("mode {i}, ω = {}", brief(modes.values[i])), field)
        })
        .collect();
    let changes: Vec<usize> =
        fields.iter().map(|(_, field)| sign_changes(mesh, &field.values)).collect();
    let rising = changes.windows(2).all(|w| w[0] < w[1]);
    let to_see = match (rising, changes.first(), changes.last()) {
        (true, Some(first), Some(last)) => {
            TEXT.say("modes rise", values! { first: *first, last: *last })?
        }
        _ => TEXT.say("modes differ", &[])?,
    };
    let options =
        ScaleOptions { limits: Limits::Fixed { low: -1.0, high: 1.0 }, ..ScaleOptions::SIGNED };
    let looks = fields
        .iter()
        .map(|(title, field)| Look {
            title,
            mesh,
            coloring: Some(Coloring {
                field,
                range: Range::All,
                options,
                quantity: "mode over its largest value",
                unit: "",
            }),
        })
        .collect();
    Gallery { looks, viewpoints: &VIEWS, up: Up::Y, aspect: 0.9, occlusion }.draw(
        &format!("{id}-modes"),
        &TEXT.say("figure modes", values! { seen: to_see, name })?,
        &TEXT.say("figure modes alt", values! { name })?,
    )
}

/// The number of edges across which a field changes its sign.
fn sign_changes(mesh: &TriMesh, values: &[f64]) -> usize {
    let changes = |edge: &&[u32; 2]| values[edge[0] as usize] * values[edge[1] as usize] < 0.0;
    mesh.topology().edges().iter().filter(changes).count()
}

pub(super) fn view(
    id: &str,
    name: &str,
    to_see: &str,
    mesh: &TriMesh,
    stops: &[usize],
    rebuilt: &[TriMesh],
) -> Result<View> {
    let counterpart = counterpart(name)?;
    Ok(View {
        id: format!("{id}-view"),
        mesh: name.into(),
        caption: TEXT.say("view", values! { seen: to_see, name, counterpart })?,
        alt: TEXT.say("view alt", values! { name })?,
        fallback: String::new(),
        color: None,
        z_up: false,
        sliders: vec![Slider::new("k", stops)],
        start: vec![2.min(stops.len() - 1)],
        panels: vec![
            Panel::moving("k modes", mesh, rebuilt.iter().map(TriMesh::positions)),
            Panel::still("original", mesh),
        ],
        from: Some(1),
        truth: Some(mesh.positions().to_vec()),
    })
}

/// The number of modes at which meshes are compared in words.
const COMPARED: usize = 50;

/// The names of the curves with the least and the greatest error at [`COMPARED`] modes.
fn extremes(curves: &[Series]) -> Option<[&str; 2]> {
    let at = |series: &Series| {
        let Shape::Line(points) = &series.shape else { return None };
        points.iter().rev().find(|p| p[0] <= COMPARED as f64).map(|p| p[1])
    };
    let known = || curves.iter().filter_map(|c| Some((at(c)?, c.name.as_str())));
    let least = known().min_by(|a, b| a.0.total_cmp(&b.0))?;
    let most = known().max_by(|a, b| a.0.total_cmp(&b.0))?;
    (least.1 != most.1).then_some([least.1, most.1])
}
pub(super) fn decay(curves: Vec<Series>) -> Result<Picture> {
    let plot = Plot {
        x: Axis::log("modes k"),
        y: Axis::log("RMS displacement / diagonal"),
        series: curves,
        ..Plot::default()
    };
    let mut figure = Figure::default();
    let mut words = String::new();
    if let Some([least, most]) = extremes(&plot.series) {
        words = format!(" {}", TEXT.say("extremes", values! { modes: COMPARED, least, most })?);
    }
    let names: Vec<String> = plot.series.iter().map(|s| s.name.clone()).collect();
    figure.panels.push(FigurePanel::drawing(plot.draw(560.0, 240.0)?));
    let picture = plotted(
        &figure,
        "decay",
        &TEXT.say("figure decay", values! { extremes: words })?,
        &TEXT.say("figure decay alt", &[])?,
    )?;
    Ok(names.iter().fold(picture, |picture, name| {
        picture.linked("", name, &format!("{}-view", slug(name)), "k")
    }))
}

/// Errors of eigenvalues over h.
pub(super) fn eigenvalues(sphere: &Table, torus: &Table) -> Result<Picture> {
    let mut plot = Plot {
        x: Axis::log("mean edge length h"),
        y: Axis::log("relative error"),
        ..Plot::default()
    };
    let mut steepness = vec![];
    for (name, table) in [("sphere", sphere), ("torus", torus)] {
        for sampling in Sampling::BOTH {
            let rows = table.only(&[("sampling", sampling.name().into())])?;
            let points = rows.column("h")?.into_iter().zip(rows.column("error")?);
            let name = match sampling {
                Sampling::Regular => name.to_string(),
                Sampling::Jittered => format!("{name}, {}", sampling.name()),
            };
            plot.series.push(Series::marked(name, points.map(<[f64; 2]>::from).collect()));
            steepness.extend(rows.numbers("order")?);
        }
    }
    let least = steepness.iter().copied().fold(f64::INFINITY, smaller);
    let orders = between(least, steepness.iter().copied().fold(f64::NEG_INFINITY, larger));
    plot.series.extend(second_order(&plot.series));
    let mut figure = Figure::default();
    figure.panels.push(FigurePanel::drawing(plot.draw(450.0, 215.0)?));
    plotted(
        &figure,
        "eigenvalues",
        &TEXT.say("figure eigenvalues", values! { orders })?,
        &TEXT.say("figure eigenvalues alt", &[])?,
    )
}
