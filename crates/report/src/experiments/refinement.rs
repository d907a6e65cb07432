//! Errors of curvature estimators under refinement, against exact curvature.

use anyhow::{Context as _, Result};
use fairing_figure::{Axis, Figure, Legend, Panel, Plot, Series, Shape};
use fairing_mesh::TriMesh;
use fairing_operators::{LumpedArea, lumped_mass};
use fairing_sparse::{larger, smaller};

use super::gallery::plotted;
use super::surfaces::{Sampling, TestSurface};
use crate::experiment::Context;
use crate::experiment::outcome::Picture;
use crate::experiment::text::Text;
use crate::model::table::{Table, Unit};
use crate::row;

static TEXT: Text = Text::new("refinement", include_str!("../../text/refinement.md"));

/// The estimated quantity.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Quantity {
    /// H
    Mean,
    /// K
    Gaussian,
}

/// An estimator under study: one value per vertex.
pub(super) struct Estimator {
    pub(super) name: &'static str,
    pub(super) quantity: Quantity,
    pub(super) estimate: fn(&TriMesh) -> Result<Vec<f64>>,
}

/// Errors of estimates, relative to the size of the truth.
#[derive(Debug, Clone, Copy)]
pub(super) struct Deviation {
    /// `√(Σ m (x − x̂)² / Σ m x̂²)` with the barycentric areas m.
    pub(super) rms: f64,
    /// `max |x − x̂|` over the same root mean square of x̂.
    pub(super) max: f64,
}

impl Deviation {
    pub(super) fn new(estimates: &[f64], exact: &[f64], mass: &[f64]) -> Self {
        let total: f64 = mass.iter().sum();
        let size: f64 = exact.iter().zip(mass).map(|(x, m)| m * x * x).sum();
        let gaps = || estimates.iter().zip(exact).map(|(x, y)| x - y);
        let square: f64 = gaps().zip(mass).map(|(d, m)| m * d * d).sum();
        let largest = gaps().fold(0.0, |a, d| larger(a, d.abs()));
        Self { rms: (square / size).sqrt(), max: largest / (size / total).sqrt() }
    }
}

/// The refinement levels.
fn levels(context: &Context<'_>) -> std::ops::RangeInclusive<u32> {
    context.choose(2..=5, 2..=4)
}

/// The seed of the jitter of a mesh.
pub(super) fn seed(context: &Context<'_>, surface: TestSurface, level: u32) -> u64 {
    context.seed(&format!("{} {level}", surface.name()))
}

/// Empty tables of errors and of their orders.
fn tables() -> Result<[Table; 2]> {
    let errors = Table::new(
        "analytic",
        &TEXT.say("table analytic", &[])?,
        &[
            ("surface", Unit::Label),
            ("sampling", Unit::Label),
            ("estimator", Unit::Label),
            ("vertices", Unit::Count),
            ("h", Unit::Length),
            ("RMS error", Unit::Relative),
            ("largest error", Unit::Relative),
        ],
    );
    let orders = Table::new(
        "orders",
        &TEXT.say("table orders", &[])?,
        &[
            ("surface", Unit::Label),
            ("sampling", Unit::Label),
            ("estimator", Unit::Label),
            ("order in RMS", Unit::Order),
            ("order of the largest", Unit::Order),
        ],
    );
    Ok([errors, orders])
}

/// The errors of each estimator on each surface and level, and the orders in
/// which they fall between levels.
///
/// The tables have the ids `analytic` and `orders`.
pub(super) fn study(context: &Context<'_>, estimators: &[Estimator]) -> Result<[Table; 2]> {
    let [mut errors, mut orders] = tables()?;
    for (i, surface) in TestSurface::ALL.into_iter().enumerate() {
        for sampling in Sampling::BOTH {
            context.progress(i as f64 / TestSurface::ALL.len() as f64, surface.name());
            let mut deviations = vec![vec![]; estimators.len()];
            let mut sizes = vec![];
            for level in levels(context) {
                let mesh = surface.mesh(level, sampling, seed(context, surface, level));
                let mass = lumped_mass(&mesh, LumpedArea::Barycentric)?;
                let exact: Vec<_> = mesh
                    .positions()
                    .iter()
                    .map(|&p| surface.exact(p).context("a vertex off the surface"))
                    .collect::<Result<_>>()?;
                sizes.push(mesh.mean_edge_length());
                for (e, found) in estimators.iter().zip(&mut deviations) {
                    let truth: Vec<f64> = exact
                        .iter()
                        .map(|c| match e.quantity {
                            Quantity::Mean => c.mean(),
                            Quantity::Gaussian => c.gaussian(),
                        })
                        .collect();
                    let deviation = Deviation::new(&(e.estimate)(&mesh)?, &truth, &mass);
                    errors.push(row![
                        surface.name(),
                        sampling.name(),
                        e.name,
                        mesh.vertex_count(),
                        mesh.mean_edge_length(),
                        deviation.rms,
                        deviation.max,
                    ]);
                    found.push(deviation);
                }
            }
            for (e, found) in estimators.iter().zip(&deviations) {
                let (n, order) = (sizes.len(), |a: f64, b: f64| {
                    libm::log(a / b) / libm::log(sizes[sizes.len() - 2] / sizes[sizes.len() - 1])
                });
                let (last, before) = (found[n - 1], found[n - 2]);
                orders.push(row![
                    surface.name(),
                    sampling.name(),
                    e.name,
                    order(before.rms, last.rms),
                    order(before.max, last.max),
                ]);
            }
        }
    }
    Ok([errors, orders])
}

/// The errors over h on logarithmic axes, a panel for each surface.
pub(super) fn plot(errors: &Table, estimators: &[Estimator]) -> Result<Picture> {
    let mut figure = Figure { columns: 3, ..Figure::default() };
    for (i, surface) in TestSurface::ALL.into_iter().enumerate() {
        let mut plot = Plot {
            title: surface.name().into(),
            x: Axis::log("mean edge length h"),
            y: Axis::log(if i == 0 { "relative RMS error" } else { "" }),
            legend: if i == 2 { Legend::Lines } else { Legend::None },
            ..Plot::default()
        };
        for e in estimators {
            for sampling in Sampling::BOTH {
                let rows = errors.only(&[
                    ("surface", surface.name().into()),
                    ("sampling", sampling.name().into()),
                    ("estimator", e.name.into()),
                ])?;
                let points = rows.column("h")?.into_iter().zip(rows.column("RMS error")?);
                let points = points.map(|(h, error)| [h, error]).collect();
                let name = format!("{}, {}", e.name, sampling.name());
                plot.series.push(Series::marked(name, points));
            }
        }
        plot.series.extend(second_order(&plot.series));
        figure.panels.push(Panel::drawing(plot.draw(if i == 2 { 540.0 } else { 270.0 }, 235.0)?));
    }
    plotted(&figure, "convergence", &TEXT.say("figure", &[])?, &TEXT.say("figure alt", &[])?)
}

/// A line to compare with: second order, from the largest error of the
/// coarsest mesh down.
pub(super) fn second_order(errors: &[Series]) -> Option<Series> {
    let points = || {
        let of = |s: &Series| match &s.shape {
            Shape::MarkedLine(points) => points.clone(),
            _ => vec![],
        };
        errors.iter().flat_map(of)
    };
    let finest = points().map(|[h, _]| h).reduce(smaller)?;
    let coarsest = points().map(|[h, _]| h).reduce(larger)?;
    // Jittered meshes have slightly longer edges.
    let first = points().filter(|[h, _]| *h > 0.9 * coarsest);
    let error = first.map(|[_, error]| error).reduce(larger)?;
    Some(Series::slope("second order", 2.0, [coarsest, error], [finest, coarsest]))
}

/// The error of the finest mesh.
pub(super) fn finest(
    errors: &Table,
    surface: &str,
    sampling: &str,
    estimator: &str,
) -> Result<f64> {
    let rows = errors.only(&[
        ("surface", surface.into()),
        ("sampling", sampling.into()),
        ("estimator", estimator.into()),
    ])?;
    rows.column("RMS error")?.last().copied().context("an empty table")
}

/// Two orders to two decimals, rounded outwards as deciding numbers are, or one if they do not
/// differ in them.
pub(super) fn between(least: f64, most: f64) -> String {
    let bounds = [(100.0 * least).floor(), (100.0 * most).ceil()];
    let [low, high] = bounds.map(|x| format!("{:.2}", x / 100.0));
    if low == high { low } else { format!("{low} to {high}") }
}
