//! Beyond the questions: a comparison of curvature estimators.

use std::time::Instant;

use anyhow::{Context as _, Result};
use fairing_figure::{Axis, Figure, Panel, Plot, Series};
use fairing_operators::curvature::Estimator;
use fairing_sparse::smaller;
use rayon::prelude::*;

use super::every_estimator::EveryEstimator;
use super::gallery::plotted;
use super::ordinary::{self, Refined};
use super::refinement::second_order;
use super::samples::{Layout, Sample};
use super::seen;
use super::study::{MEASURES, Study, exact_values};
use super::surfaces::TestSurface;
use crate::experiment::outcome::{Outcome, Picture};
use crate::experiment::text::{Text, values};
use crate::experiment::{Card, Context, Experiment};
use crate::model::table::{Cell, Table, Tables, Tolerance, Unit};
use crate::model::verdict::{Judgement, Shown, Verdict};
use crate::row;

pub(super) struct Estimators;

/// The order in the largest error that counts as convergence.
const BAR: f64 = 1.7;

/// An order above this is convergence.
const CONVERGES: f64 = 0.5;

/// The estimator of fixed size with the highest order.
const EXACT: &str = "jet4";

/// Errors below this are rounding, and not drawn.
const ROUNDING: f64 = 1e-8;

static TEXT: Text = Text::new("estimators", include_str!("../../text/estimators.md"));

impl Experiment for Estimators {
    fn card(&self) -> Card {
        let parameters = Estimator::all().into_iter().map(|e| (e.name(), e.description().into()));
        TEXT.card(&[], parameters.collect(), &[])
    }

    fn run(&self, context: &Context<'_>) -> Result<Outcome> {
        let levels: Vec<u32> = context.choose(2..=6, 2..=4).collect();
        let (mut errors, mut orders) = (errors_table()?, orders_table()?);
        for (s, sample) in Sample::ALL.into_iter().enumerate() {
            context.progress(s as f64 / Sample::ALL.len() as f64, sample.name());
            let meshes: Vec<(Layout, u32, u64)> = Layout::ALL
                .into_iter()
                .flat_map(|layout| levels.iter().map(move |&level| (layout, level)))
                .map(|(l, i)| (l, i, context.seed(&format!("{} {i}", sample.name()))))
                .collect();
            // The largest first: they take most of the time, each on one thread for the most part.
            let of = |&(layout, level, seed)| Refinement::new(sample, layout, level, seed);
            let mut largest_first: Vec<usize> = (0..meshes.len()).collect();
            largest_first.sort_by_key(|&i| std::cmp::Reverse(meshes[i].1));
            let mut found: Vec<(usize, Refinement)> = largest_first
                .into_par_iter()
                .with_max_len(1)
                .map(|i| anyhow::Ok((i, of(&meshes[i])?)))
                .collect::<Result<_>>()?;
            found.sort_by_key(|f| f.0);
            let found: Vec<Refinement> = found.into_iter().map(|f| f.1).collect();
            for (layout, found) in Layout::ALL.into_iter().zip(found.chunks(levels.len())) {
                for refinement in found {
                    refinement.push(&mut errors, sample, layout);
                }
                for i in 0..Estimator::all().len() {
                    orders.push(order_row(sample, layout, i, found)?);
                }
            }
        }
        let middle = levels.iter().rev().nth(2).copied().context("no levels")?;
        let times = times(middle, context)?;
        let mut figures = vec![plot(&errors, "max H", "H")?, plot(&errors, "max K", "K")?];
        let torus = EveryEstimator::on_torus(context, BASELINE)?;
        figures.push(torus.picture(!context.is_quick())?);
        let refined = refined(&orders, &times)?;
        let [ordinary, choice, normals] = ordinary::tables(context, &refined)?;
        figures.push(ordinary::plot(&ordinary)?);
        let tables = vec![errors, orders, times, ordinary, choice, normals];
        Ok(Outcome { tables, figures, views: vec![torus.view()?], ..Outcome::default() })
    }

    fn judge(&self, tables: Tables<'_>) -> Result<Vec<Judgement>> {
        let orders = tables.get("orders")?;
        let mut worst = least_orders(orders)?;
        let reaching = worst.iter().filter(|(_, order)| *order >= BAR);
        let reaching = reaching.map(|(name, _)| in_words(name)).collect::<Result<Vec<_>>>()?;
        let slower = worst.iter().filter(|(_, order)| (CONVERGES..BAR).contains(order));
        let slow = slower.clone().map(|(_, order)| *order).fold(f64::INFINITY, smaller);
        let slower = slower.map(|(name, _)| in_words(name)).collect::<Result<Vec<_>>>()?;
        let (best, order) = worst
            .iter()
            .copied()
            .fold(("", f64::NEG_INFINITY), |a, b| if b.1 > a.1 { b } else { a });
        let baseline = worst.iter().find(|(name, _)| *name == BASELINE);
        let (_, baseline) = *baseline.context("the baseline is no estimator")?;
        let is_reached = !reaching.is_empty();
        let verdict = if is_reached { Verdict::Confirmed } else { Verdict::Refuted };
        let times = tables.get("times")?;
        let time = |name: &str| times.value(&[("estimator", name.into())], "time per vertex");
        let recommended = Estimator::RECOMMENDED.name();
        let [exact_time, recommended_time] =
            [EXACT, recommended].map(|name| anyhow::Ok(time(name)? / time(BASELINE)?));
        let values = values! {
            bar: BAR, count: reaching.len(), all: worst.len(), reaching: seen::list(&reaching),
            best: in_words(best)?, order, baseline, slower: seen::list(&slower), slow,
            converges: CONVERGES, exact: in_words(EXACT)?, exact_time: exact_time?,
            recommended: in_words(recommended)?, recommended_time: recommended_time?,
        };
        let mut judgement = TEXT
            .judgement("estimators", verdict, values)?
            .ours()
            .shown(Shown::line("estimators", "largest-mean", best));
        // The best one first: tables of claims show it.
        worst.sort_by(|a, b| b.1.total_cmp(&a.1));
        for (name, order) in worst {
            judgement = judgement.number(&format!("least order of {name}"), order, Unit::Order);
        }
        Ok(vec![judgement, ordinary::judge(&tables)?])
    }
}

/// Each estimator with its least order over the jittered surfaces, in H and K.
fn least_orders(orders: &Table) -> Result<Vec<(&'static str, f64)>> {
    let mut worst = vec![];
    for estimator in Estimator::all() {
        let mut least = f64::INFINITY;
        for surface in ["sphere", "torus", "ellipsoid"] {
            let rows = orders.only(&[
                ("surface", surface.into()),
                ("sampling", Layout::Jittered.name().into()),
                ("estimator", estimator.name().into()),
            ])?;
            for column in ["max H", "max K"] {
                let c = rows.index(column)?;
                // No order where the error is rounding alone.
                let orders = rows.rows.iter().filter_map(|row| row[c].number());
                least = orders.fold(least, smaller);
            }
        }
        worst.push((estimator.name(), least));
    }
    Ok(worst)
}

/// Order and time of each estimator.
fn refined(orders: &Table, times: &Table) -> Result<Vec<Refined>> {
    let (orders, times) = (least_orders(orders)?, times.column("time per vertex")?);
    Ok(orders.into_iter().zip(times).map(|((_, order), time)| Refined { order, time }).collect())
}

/// An estimator in words, where its name is short for them.
fn in_words(name: &str) -> Result<String> {
    match name {
        "adaptive" | "jet2" | "jet3" | "jet4" => TEXT.say(&format!("name {name}"), &[]),
        other => Ok(other.into()),
    }
}

/// All estimators on one mesh.
struct Refinement {
    vertices: usize,
    h: f64,
    /// In the order of [`Estimator::all()`].
    studies: Vec<Study>,
}

impl Refinement {
    fn new(sample: Sample, layout: Layout, level: u32, seed: u64) -> Result<Self> {
        let mesh = sample.mesh(level, layout, seed);
        let exact = exact_values(sample, &mesh)?;
        let study = |e: &Estimator| anyhow::Ok(Study::new(&e.estimate(&mesh)?, &exact));
        Ok(Self {
            vertices: mesh.vertex_count(),
            h: mesh.mean_edge_length(),
            studies: Estimator::all().iter().map(study).collect::<Result<_>>()?,
        })
    }

    /// Adds a row for each estimator.
    fn push(&self, errors: &mut Table, sample: Sample, layout: Layout) {
        for (estimator, study) in Estimator::all().iter().zip(&self.studies) {
            let mut row = vec![
                Cell::from(sample.name()),
                Cell::from(layout.name()),
                Cell::from(estimator.name()),
                Cell::from(self.vertices),
                Cell::from(self.h),
            ];
            row.extend(study.errors.map(Cell::from));
            row.push(Cell::from(study.angle));
            row.push(Cell::from(study.undefined));
            errors.push(row);
        }
    }
}

fn errors_table() -> Result<Table> {
    let mut errors = Table::new(
        "errors",
        &TEXT.say("table errors", &[])?,
        &[
            ("surface", Unit::Label),
            ("sampling", Unit::Label),
            ("estimator", Unit::Label),
            ("vertices", Unit::Count),
            ("h", Unit::Length),
            ("RMS H", Unit::Relative),
            ("max H", Unit::Relative),
            ("RMS K", Unit::Relative),
            ("max K", Unit::Relative),
            ("RMS κ₁", Unit::Relative),
            ("max κ₁", Unit::Relative),
            ("RMS κ₂", Unit::Relative),
            ("max κ₂", Unit::Relative),
            ("directions", Unit::Degrees),
            ("undefined", Unit::Count),
        ],
    );
    for name in MEASURES.iter().chain(&["directions"]) {
        // Values where estimators are exact up to rounding amplify it.
        errors = errors.tolerance(name, Some(Tolerance { relative: 1e-4, absolute: 1e-7 }));
    }
    Ok(errors)
}

fn orders_table() -> Result<Table> {
    let columns: Vec<(&str, Unit)> = ["surface", "sampling", "estimator"]
        .map(|c| (c, Unit::Label))
        .into_iter()
        .chain(MEASURES.map(|c| (c, Unit::Order)))
        .collect();
    let mut table = Table::new("orders", &TEXT.say("table orders", &[])?, &columns);
    for name in MEASURES {
        table = table.tolerance(name, Some(Tolerance { relative: 0.0, absolute: 0.02 }));
    }
    Ok(table)
}

fn order_row(
    sample: Sample,
    layout: Layout,
    estimator: usize,
    found: &[Refinement],
) -> Result<Vec<Cell>> {
    let [from, _, to] = found.last_chunk::<3>().context("three refinements at least")?;
    let name = Estimator::all()[estimator].name();
    let mut row = vec![sample.name().into(), layout.name().into(), Cell::from(name)];
    for i in 0..MEASURES.len() {
        let [e, f] = [from, to].map(|r| r.studies[estimator].errors[i]);
        // Exact up to rounding: there is no order to observe.
        let order = (f > ROUNDING).then(|| libm::log(e / f) / libm::log(from.h / to.h));
        row.push(order.into());
    }
    Ok(row)
}

/// The time of each estimator on one thread, on a jittered torus.
fn times(level: u32, context: &Context<'_>) -> Result<Table> {
    let mut times = Table::new(
        "times",
        &TEXT.say("table times", &[])?,
        &[("estimator", Unit::Label), ("time per vertex", Unit::Seconds)],
    );
    let torus = Sample::Closed(TestSurface::Torus);
    let mesh = torus.mesh(level, Layout::Jittered, context.seed("times"));
    mesh.topology();
    let one_thread = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
    for estimator in Estimator::all() {
        let mut least = f64::INFINITY;
        for _ in 0..3 {
            let start = Instant::now();
            one_thread.install(|| estimator.estimate(&mesh))?;
            least = least.min(start.elapsed().as_secs_f64());
        }
        times.push(row![estimator.name(), least / mesh.vertex_count() as f64]);
    }
    Ok(times)
}

/// The largest error over h on jittered meshes, a panel for each surface.
fn plot(errors: &Table, column: &str, what: &str) -> Result<Picture> {
    let mut figure = Figure { columns: 2, ..Figure::default() };
    // An estimator has one colour in all panels.
    let mut colored = vec![Estimator::RECOMMENDED.name(), BASELINE];
    for sample in Sample::ALL {
        let mut plot = Plot {
            title: sample.name().into(),
            x: Axis::log("mean edge length h"),
            y: Axis::log("largest relative error"),
            ..Plot::default()
        };
        let mut lines = vec![];
        for estimator in Estimator::all() {
            let rows = errors.only(&[
                ("surface", sample.name().into()),
                ("sampling", Layout::Jittered.name().into()),
                ("estimator", estimator.name().into()),
            ])?;
            let points = rows.column("h")?.into_iter().zip(rows.column(column)?);
            // A value below rounding is no error of the estimator.
            let points: Vec<_> = points.map(<[f64; 2]>::from).filter(|p| p[1] > ROUNDING).collect();
            lines.push((estimator, points));
        }
        lines.retain(|(_, points)| !points.is_empty());
        let best = least_at_the_end(&lines);
        for (estimator, points) in lines {
            let name = estimator.name();
            let line = Series::marked(name, points);
            plot.series.push(if best.contains(&name) || name == BASELINE {
                let style = colored.iter().position(|known| *known == name).unwrap_or_else(|| {
                    colored.push(name);
                    colored.len() - 1
                });
                Series { style: Some(style), ..line }
            } else {
                line.quiet()
            });
        }
        plot.series.extend(second_order(&plot.series));
        figure.panels.push(Panel::drawing(plot.draw(450.0, 215.0)?));
    }
    let values = values! { quantity: what, baseline: BASELINE };
    plotted(
        &figure,
        if what == "H" { "largest-mean" } else { "largest-gaussian" },
        &TEXT.say("figure", values)?,
        &TEXT.say("figure alt", values)?,
    )
}

/// Number of estimators that stand out in a plot for their small errors.
const WINNERS: usize = 2;

/// The estimator that the others are compared with.
const BASELINE: &str = "cotangent";

/// The names of those with the least errors on the finest mesh.
fn least_at_the_end(lines: &[(Estimator, Vec<[f64; 2]>)]) -> Vec<&'static str> {
    let last = |points: &Vec<[f64; 2]>| {
        let finest = points.iter().copied().min_by(|a, b| a[0].total_cmp(&b[0]));
        finest.map_or(f64::INFINITY, |p| p[1])
    };
    let mut sorted: Vec<_> = lines.iter().map(|(e, points)| (last(points), e.name())).collect();
    sorted.sort_by(|a, b| a.0.total_cmp(&b.0));
    sorted.into_iter().map(|(_, name)| name).take(WINNERS).collect()
}
