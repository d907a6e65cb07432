//! Estimators on meshes of ordinary size: coarse and fine, clean, jittered and noisy.

use anyhow::{Context as _, Result};
use fairing_evaluation::{NoiseKind, NoiseLevel, add_noise};
use fairing_figure::{Axis, Figure, Panel, Plot, Series};
use fairing_operators::curvature::{CurvatureField, Estimator};
use fairing_operators::surface::PointCurvature;
use fairing_operators::{NormalWeight, weighted_vertex_normals};
use fairing_sparse::{larger, median, smaller};
use glam::DVec3;
use rayon::prelude::*;

use super::gallery::plotted;
use super::samples::{Layout, Sample};
use super::study::{Study, exact_values};
use super::surfaces::TestSurface;
use crate::experiment::Context;
use crate::experiment::outcome::Picture;
use crate::experiment::text::{Text, values};
use crate::model::table::{Cell, Table, Tables, Tolerance, Unit};
use crate::model::verdict::{Judgement, Shown, Verdict};
use crate::row;

static TEXT: Text = Text::new("ordinary", include_str!("../../text/ordinary.md"));

/// The surfaces: on a sphere a mean over everything would be best.
const SURFACES: [Sample; 3] =
    [Sample::Closed(TestSurface::Torus), Sample::Closed(TestSurface::Ellipsoid), Sample::Graph];

/// Standard deviations of the noise along normals, in mean edge lengths.
const NOISE: [f64; 3] = [0.0, 0.03, 0.12];

/// One mesh of the table.
type Case = (Sample, Layout, u32, f64);

/// Root mean square angles of vertex normals to the exact ones, in the order of
/// [`NormalWeight::ALL`].
type Angles = [f64; NormalWeight::ALL.len()];

/// An estimator under refinement.
pub(super) struct Refined {
    /// The least order of its largest errors of H and K on jittered surfaces.
    pub(super) order: f64,
    /// Seconds per vertex.
    pub(super) time: f64,
}

/// The errors of all estimators, their comparison with the best of the others on each mesh beside
/// what refinement has shown of each, and the comparison of each weight of vertex normals with the
/// best.
pub(super) fn tables(context: &Context<'_>, refined: &[Refined]) -> Result<[Table; 3]> {
    let mut cases: Vec<Case> = vec![];
    for sample in SURFACES {
        for layout in [Layout::Regular, Layout::Jittered] {
            for level in context.choose(2..=5, 2..=3) {
                cases.extend(NOISE.map(|noise| (sample, layout, level, noise)));
            }
        }
    }
    let found: Vec<(Vec<Vec<Cell>>, Angles)> =
        cases.par_iter().with_max_len(1).map(|case| rows(context, *case)).collect::<Result<_>>()?;
    let (rows, angles): (Vec<_>, Vec<_>) = found.into_iter().unzip();
    let mut errors = errors_table()?;
    rows.into_iter().flatten().for_each(|row| errors.push(row));
    let choice = choice(&errors, refined)?;
    Ok([errors, choice, normals(&cases, &angles)?])
}

/// A row for each estimator, and the angles of normals.
fn rows(
    context: &Context<'_>,
    (sample, layout, level, noise): Case,
) -> Result<(Vec<Vec<Cell>>, Angles)> {
    let seed = context.seed(&format!("ordinary {} {level} {noise}", sample.name()));
    let clean = sample.mesh(level, layout, seed);
    let exact = exact_values(sample, &clean)?;
    let kind = NoiseKind::GaussianAlongNormals;
    let mesh = if noise > 0.0 {
        add_noise(&clean, kind, NoiseLevel::EdgeLengths(noise), seed)?
    } else {
        clean
    };
    let fields: Vec<CurvatureField> =
        Estimator::all().iter().map(|e| e.estimate(&mesh)).collect::<Result<_, _>>()?;
    let errors: Vec<[f64; 2]> = fields
        .iter()
        .map(|field| Study::new(field, &exact).errors)
        .map(|errors| [errors[0], errors[2]])
        .collect();
    // The least error of H (0) or K (1) of all estimators but one.
    let best_other = |i: usize, q: usize| {
        let others = errors.iter().enumerate().filter(|(j, _)| *j != i);
        others.map(|(_, error)| error[q]).fold(f64::INFINITY, smaller)
    };
    let mut rows = vec![];
    for (i, (estimator, field)) in Estimator::all().iter().zip(&fields).enumerate() {
        let [h, k] = errors[i];
        let within = field.accuracy.as_ref().map(|trust| {
            let inner = || exact.iter().enumerate().filter_map(|(v, c)| Some((v, (*c)?)));
            let is_within = |(v, c): &(usize, PointCurvature)| {
                (field.mean[*v] - c.mean()).abs() <= trust.mean_error[*v]
            };
            100.0 * inner().filter(is_within).count() as f64 / inner().count() as f64
        });
        let row = row![
            sample.name(),
            layout.name(),
            mesh.vertex_count(),
            noise,
            estimator.name(),
            h,
            k,
            h / best_other(i, 0),
            k / best_other(i, 1),
            within
        ];
        rows.push(row.into());
    }
    let angles = NormalWeight::ALL.map(|weight| {
        let normals = weighted_vertex_normals(&mesh, weight);
        let inner = normals.iter().zip(&exact).filter_map(|(n, c)| Some((n, (*c)?.normal)));
        let squares = inner.map(|(n, m)| DVec3::from(*n).angle_between(m.into()).powi(2));
        let squares: Vec<f64> = squares.collect();
        (squares.iter().sum::<f64>() / squares.len() as f64).sqrt()
    });
    Ok((rows, angles))
}

/// The weights of vertex normals beside the best on each mesh.
fn normals(cases: &[Case], angles: &[Angles]) -> Result<Table> {
    let mut table = Table::new(
        "normals",
        &TEXT.say("table normals", &[])?,
        &[("weight", Unit::Label), ("clean", Unit::One), ("noisy", Unit::One)],
    );
    for name in ["clean", "noisy"] {
        table = table.tolerance(name, Some(Tolerance { relative: 1e-3, absolute: 1e-6 }));
    }
    for (k, weight) in NormalWeight::ALL.into_iter().enumerate() {
        let ratio = |a: &Angles| a[k] / a.iter().copied().fold(f64::INFINITY, smaller);
        let over = |is_noisy: bool| {
            let meshes = cases.iter().zip(angles).filter(|(case, _)| (case.3 > 0.0) == is_noisy);
            let mut ratios: Vec<f64> = meshes.map(|(_, a)| ratio(a)).collect();
            ratios.sort_by(f64::total_cmp);
            median(&ratios).context("no meshes")
        };
        table.push(row![weight.name(), over(false)?, over(true)?]);
    }
    Ok(table)
}

fn errors_table() -> Result<Table> {
    let table = Table::new(
        "ordinary",
        &TEXT.say("table ordinary", &[])?,
        &[
            ("surface", Unit::Label),
            ("sampling", Unit::Label),
            ("vertices", Unit::Count),
            ("noise", Unit::EdgeLengths),
            ("estimator", Unit::Label),
            ("RMS H", Unit::Relative),
            ("RMS K", Unit::Relative),
            ("H over the best other", Unit::One),
            ("K over the best other", Unit::One),
            ("within", Unit::Percent),
        ],
    );
    let columns = ["RMS H", "RMS K", "H over the best other", "K over the best other", "within"];
    Ok(columns.into_iter().fold(table, |table, name| {
        table.tolerance(name, Some(Tolerance { relative: 1e-3, absolute: 1e-6 }))
    }))
}

/// The median and the largest ratio to the best of the others over all meshes, H and K together;
/// order and time.
fn choice(errors: &Table, refined: &[Refined]) -> Result<Table> {
    let mut table = Table::new(
        "choice",
        &TEXT.say("table choice", &[])?,
        &[
            ("estimator", Unit::Label),
            ("clean", Unit::One),
            ("noisy", Unit::One),
            ("all", Unit::One),
            ("largest", Unit::One),
            ("least order", Unit::Order),
            ("time", Unit::Seconds),
        ],
    )
    .tolerance("least order", Some(Tolerance { relative: 0.0, absolute: 0.02 }));
    for name in ["clean", "noisy", "all", "largest"] {
        table = table.tolerance(name, Some(Tolerance { relative: 1e-3, absolute: 1e-6 }));
    }
    for (estimator, refined) in Estimator::all().iter().zip(refined) {
        let rows = errors.only(&[("estimator", estimator.name().into())])?;
        let noise = rows.column("noise")?;
        let mut ratios = vec![];
        for column in ["H over the best other", "K over the best other"] {
            ratios.extend(noise.iter().copied().zip(rows.column(column)?));
        }
        let over = |keep: &dyn Fn(f64) -> bool| {
            let kept = ratios.iter().filter(|(noise, _)| keep(*noise)).map(|(_, ratio)| *ratio);
            let mut kept: Vec<f64> = kept.collect();
            kept.sort_by(f64::total_cmp);
            median(&kept).context("no meshes")
        };
        let largest = ratios.iter().map(|(_, ratio)| *ratio).fold(0.0, larger);
        table.push(row![
            estimator.name(),
            over(&|noise| noise == 0.0)?,
            over(&|noise| noise > 0.0)?,
            over(&|_| true)?,
            largest,
            refined.order,
            refined.time
        ]);
    }
    Ok(table)
}

/// The error of H over the number of vertices on the jittered torus, a panel for each noise.
pub(super) fn plot(errors: &Table) -> Result<Picture> {
    // In colour: the recommended one, and what most programs compute.
    let marked = [Estimator::RECOMMENDED.name(), "cotangent"];
    let mut figure = Figure { columns: 3, ..Figure::default() };
    for (i, noise) in NOISE.into_iter().enumerate() {
        let mut plot = Plot {
            title: if noise > 0.0 { format!("noise {noise} h") } else { "clean".into() },
            x: Axis::log("vertices"),
            y: Axis::log(if i == 0 { "relative error of H" } else { "" }),
            ..Plot::default()
        };
        for estimator in Estimator::all() {
            let rows = errors.only(&[
                ("surface", "torus".into()),
                ("sampling", "jittered".into()),
                ("noise", noise.into()),
                ("estimator", estimator.name().into()),
            ])?;
            let points = rows.column("vertices")?.into_iter().zip(rows.column("RMS H")?);
            let line = Series::marked(estimator.name(), points.map(<[f64; 2]>::from).collect());
            let is_marked = marked.contains(&estimator.name());
            plot.series.push(if is_marked { line } else { line.quiet() });
        }
        figure.panels.push(Panel::drawing(plot.draw(350.0, 235.0)?));
    }
    plotted(
        &figure,
        "ordinary-mean",
        &TEXT.say("figure", values! { recommended: marked[0], baseline: marked[1] })?,
        &TEXT.say("figure alt", &[])?,
    )
}

/// Decides if the recommended estimator is the one that the table recommends.
pub(super) fn judge(tables: &Tables<'_>) -> Result<Judgement> {
    let choice = tables.get("choice")?;
    let recommended = Estimator::RECOMMENDED.name();
    let names: Vec<&str> = Estimator::all().iter().map(|e| e.name()).collect();
    let all = choice.column("all")?;
    let place = names.iter().position(|name| *name == recommended).context("no such estimator")?;
    let others = names.iter().zip(&all).filter(|(name, _)| **name != recommended);
    let (next, least) =
        others.fold(("", f64::INFINITY), |a, (n, x)| if *x < a.1 { (*n, *x) } else { a });
    let verdict = if all[place] < least { Verdict::Confirmed } else { Verdict::Refuted };
    let column = |name: &str| anyhow::Ok(choice.column(name)?[place]);
    let rows = tables.get("ordinary")?.only(&[("estimator", recommended.into())])?;
    let [h, k] = ["H over the best other", "K over the best other"].map(|name| rows.column(name));
    let ratios: Vec<f64> = h?.into_iter().zip(k?).map(|(h, k)| larger(h, k)).collect();
    let vertices = ratios.iter().zip(rows.column("vertices")?);
    let (_, vertices) = vertices.fold((0.0, 0.0), |a, (r, n)| if *r > a.0 { (*r, n) } else { a });
    let values = values! {
        recommended, median: all[place], next, next_median: least, clean: column("clean")?,
        noisy: column("noisy")?, largest: column("largest")?, meshes: ratios.len(), vertices,
    };
    let judgement = TEXT.judgement("recommended", verdict, values)?;
    Ok(judgement
        .ours()
        .shown(Shown::line("estimators", "ordinary-mean", recommended))
        .number("median of the recommended", all[place], Unit::One)
        .number("median of the next", least, Unit::One))
}
