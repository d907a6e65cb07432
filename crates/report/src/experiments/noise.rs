//! Beyond the questions: claim 1a, curvature under noise.

use anyhow::{Context as _, Result};
use fairing_evaluation::{NoiseKind, NoiseLevel, add_noise};
use fairing_figure::{Axis, Figure, Legend, Panel, Plot, Series};
use fairing_mesh::TriMesh;
use fairing_operators::curvature::{CurvatureField, Estimator, angle_defect};
use fairing_sparse::{larger, median};
use rayon::prelude::*;

use super::gallery::plotted;
use super::statistics::extremes;
use super::surfaces::{Sampling, TestSurface};
use crate::experiment::outcome::{Outcome, Picture};
use crate::experiment::text::{Text, values};
use crate::experiment::{Card, Context, Experiment};
use crate::model::table::{Table, Tables, Tolerance, Unit};
use crate::model::verdict::{Judgement, Shown, Verdict};
use crate::row;

pub(super) struct Noise;

/// Standard deviations over the mean edge length.
const LEVELS: [f64; 4] = [0.01, 0.03, 0.1, 0.3];

/// A relative change above this is a disturbance.
const DISTURBED: f64 = 0.05;

const SURFACES: [TestSurface; 2] = [TestSurface::Sphere, TestSurface::Torus];

static TEXT: Text = Text::new("noise", include_str!("../../text/noise.md"));

impl Experiment for Noise {
    fn card(&self) -> Card {
        let parameters = vec![
            ("σ / h", LEVELS.map(|l| l.to_string()).join(", ")),
            ("noise", "Gaussian, independent in each coordinate".into()),
        ];
        TEXT.card(&[], parameters, &[])
    }

    fn run(&self, context: &Context<'_>) -> Result<Outcome> {
        let seeds = context.choose(4, 2);
        let levels = context.choose(3..=5, 2..=4);
        let steps = SURFACES.len() * levels.clone().count();
        let (mut changes, mut totals) = (changes_table()?, totals_table()?);
        let mut step = 0;
        for surface in SURFACES {
            for level in levels.clone() {
                context.progress(f64::from(step) / steps as f64, surface.name());
                step += 1;
                let mesh = surface.mesh(level, Sampling::Regular, 0);
                mesh.topology();
                let clean: Vec<CurvatureField> =
                    Estimator::all().iter().map(|e| e.estimate(&mesh)).collect::<Result<_, _>>()?;
                for sigma in LEVELS {
                    let seeds: Vec<u64> = (0..seeds)
                        .map(|s| context.seed(&format!("{} {level} {sigma} {s}", surface.name())))
                        .collect();
                    let runs: Vec<Run> = seeds
                        .into_par_iter()
                        .map(|seed| Run::new(&mesh, &clean, surface, sigma, seed))
                        .collect::<Result<_>>()?;
                    push(&mut changes, surface, mesh.vertex_count(), sigma, &runs);
                    let distance = runs.iter().map(|run| run.gap_of_the_total).fold(0.0, larger);
                    totals.push(row![surface.name(), mesh.vertex_count(), sigma, distance]);
                }
            }
        }
        let figures = vec![plot(&changes)?];
        Ok(Outcome { tables: vec![changes, totals], figures, ..Outcome::default() })
    }

    fn judge(&self, tables: Tables<'_>) -> Result<Vec<Judgement>> {
        let changes = tables.get("changes")?;
        let plain = changes.only(&[("estimator", "cotangent".into())])?;
        let range = |table: &Table| -> Result<[f64; 3]> {
            let mut ratios = table.column("√|K| over H")?;
            ratios.sort_by(f64::total_cmp);
            let middle = median(&ratios).context("no changes")?;
            Ok([ratios[0], middle, ratios[ratios.len() - 1]])
        };
        let ([low, middle, high], [all_low, all_middle, _]) = (range(&plain)?, range(changes)?);
        let total = tables.get("totals")?.column("largest distance")?;
        let total = total.into_iter().fold(0.0, larger);
        let ratios = changes.column("√|K| over H")?;
        let errors = changes.column("standard error")?.into_iter().zip(ratios);
        let error = errors.map(|(error, ratio)| error / ratio).fold(0.0, larger);
        let faint = plain.only(&[("σ/h", LEVELS[0].into())])?;
        let [k_low, k_high] = extremes(faint.column("change of K")?);
        let [h_low, h_high] = extremes(faint.column("change of H")?);
        let [step_low, step_high] = steps(&faint)?;
        let verdict = match (k_low > DISTURBED, k_high < DISTURBED) {
            (true, _) => Verdict::Refuted,
            (_, true) if high < DISTURBED => Verdict::Confirmed,
            _ => Verdict::Qualified,
        };
        let values = values! {
            level: LEVELS[0], k_low, k_high, h_low, h_high, step_low, step_high, low, high, middle,
            all_middle, all_low, error, total,
        };
        Ok(vec![
            TEXT.judgement("1a", verdict, values)?
                .shown(Shown::playground("noise", &[&0.1, &14, &"torus", &"error"]))
                .number(
                    &format!("least change of K at {} h", LEVELS[0]),
                    100.0 * k_low,
                    Unit::Percent,
                )
                .number("median change of √|K| over that of H", middle, Unit::One)
                .number("least", low, Unit::One)
                .number("median over all estimators", all_middle, Unit::One)
                .number("largest distance of the total from 2πχ", total, Unit::Radians),
        ])
    }
}

/// The least and the largest growth of a change, of H or of K, from a mesh to that of half the edge
/// length, where the noise is the same part of it.
fn steps(changes: &Table) -> Result<[f64; 2]> {
    let mut steps = vec![];
    for surface in SURFACES {
        let rows = changes.only(&[("surface", surface.name().into())])?;
        for column in ["change of H", "change of K"] {
            steps.extend(rows.column(column)?.windows(2).map(|pair| pair[1] / pair[0]));
        }
    }
    Ok(extremes(steps))
}

fn changes_table() -> Result<Table> {
    let columns = [
        ("surface", Unit::Label),
        ("vertices", Unit::Count),
        ("σ/h", Unit::EdgeLengths),
        ("estimator", Unit::Label),
        ("change of H", Unit::Relative),
        ("change of K", Unit::Relative),
        ("change of √|K|", Unit::Relative),
        ("√|K| over H", Unit::One),
        ("standard error", Unit::One),
        ("ranks of H", Unit::One),
        ("ranks of K", Unit::One),
    ];
    let mut changes = Table::new("changes", &TEXT.say("table changes", &[])?, &columns);
    for (column, _) in &columns[4..] {
        changes = changes.tolerance(column, Some(Tolerance { relative: 1e-3, absolute: 1e-4 }));
    }
    Ok(changes.aside(&["standard error", "ranks of H", "ranks of K"]))
}

fn totals_table() -> Result<Table> {
    let totals = Table::new(
        "totals",
        &TEXT.say("table totals", &[])?,
        &[
            ("surface", Unit::Label),
            ("vertices", Unit::Count),
            ("σ/h", Unit::EdgeLengths),
            ("largest distance", Unit::Radians),
        ],
    );
    Ok(totals.tolerance("largest distance", Some(Tolerance { relative: 0.0, absolute: 1e-8 })))
}

/// A row for each estimator.
fn push(changes: &mut Table, surface: TestSurface, vertices: usize, sigma: f64, runs: &[Run]) {
    for (i, estimator) in Estimator::all().iter().enumerate() {
        let all: Vec<&Change> = runs.iter().map(|run| &run.changes[i]).collect();
        let [h, k, root] = changes_over(&all);
        let ranks = |j: usize| -> Option<f64> {
            let sum: Option<f64> = all.iter().map(|c| Some(c.ranks?[j])).sum();
            Some(sum? / all.len() as f64)
        };
        changes.push(row![
            surface.name(),
            vertices,
            sigma,
            estimator.name(),
            h,
            k,
            root,
            root / h,
            standard_error(&all),
            ranks(0),
            ranks(1),
        ]);
    }
}

fn gap_of_the_total(mesh: &TriMesh) -> f64 {
    let euler = mesh.topology().euler_characteristic() as f64;
    (angle_defect(mesh).iter().sum::<f64>() - std::f64::consts::TAU * euler).abs()
}

/// All estimators on one noisy mesh.
struct Run {
    /// In the order of [`Estimator::all()`].
    changes: Vec<Change>,
    gap_of_the_total: f64,
}

impl Run {
    fn new(
        mesh: &TriMesh,
        clean: &[CurvatureField],
        surface: TestSurface,
        sigma: f64,
        seed: u64,
    ) -> Result<Self> {
        let level = NoiseLevel::EdgeLengths(sigma);
        let noisy = add_noise(mesh, NoiseKind::GaussianPerAxis, level, seed)?;
        let ranked = surface != TestSurface::Sphere;
        let change = |(e, clean): (&Estimator, &CurvatureField)| {
            anyhow::Ok(Change::between(clean, &e.estimate(&noisy)?, ranked))
        };
        Ok(Self {
            changes: Estimator::all().iter().zip(clean).map(change).collect::<Result<_>>()?,
            gap_of_the_total: gap_of_the_total(&noisy),
        })
    }
}

/// Of H first, of K second, of √|K| third.
struct Change {
    /// Sums of squared changes.
    squares: [f64; 3],
    /// Sums of squared clean values.
    sizes: [f64; 3],
    /// Rank correlations, where clean values differ.
    ranks: Option<[f64; 2]>,
}

impl Change {
    fn between(clean: &CurvatureField, noisy: &CurvatureField, ranked: bool) -> Self {
        let fields = [(&clean.mean, &noisy.mean), (&clean.gaussian, &noisy.gaussian)];
        let roots = [&clean.gaussian, &noisy.gaussian]
            .map(|k| k.iter().map(|k| k.signum() * k.abs().sqrt()).collect::<Vec<f64>>());
        let compared = [fields[0], fields[1], (&roots[0], &roots[1])];
        Self {
            squares: compared
                .map(|(clean, noisy)| clean.iter().zip(noisy).map(|(a, b)| (a - b).powi(2)).sum()),
            sizes: compared.map(|(clean, _)| clean.iter().map(|a| a * a).sum()),
            ranks: ranked.then(|| fields.map(|(clean, noisy)| rank_correlation(clean, noisy))),
        }
    }
}

/// The root mean square change over runs, relative to the clean values.
fn changes_over(runs: &[&Change]) -> [f64; 3] {
    std::array::from_fn(|i| {
        let square: f64 = runs.iter().map(|c| c.squares[i]).sum();
        let size: f64 = runs.iter().map(|c| c.sizes[i]).sum();
        (square / size).sqrt()
    })
}

/// The standard error of the change of √|K| over that of H, from run to run; zero of a single run.
fn standard_error(runs: &[&Change]) -> f64 {
    let ratio = |run: &&Change| {
        let [h, _, root] = changes_over(&[*run]);
        root / h
    };
    let ratios: Vec<f64> = runs.iter().map(ratio).collect();
    let n = ratios.len() as f64;
    let mean = ratios.iter().sum::<f64>() / n;
    let squares: f64 = ratios.iter().map(|r| (r - mean).powi(2)).sum();
    (squares / (n - 1.0).max(1.0) / n).sqrt()
}

/// Spearman's rank correlation; zero where one side has equal values only.
fn rank_correlation(a: &[f64], b: &[f64]) -> f64 {
    let (a, b) = (ranks(a), ranks(b));
    let mean = (a.len() as f64 - 1.0) / 2.0;
    let product = |x: &[f64], y: &[f64]| -> f64 {
        x.iter().zip(y).map(|(x, y)| (x - mean) * (y - mean)).sum()
    };
    let size = (product(&a, &a) * product(&b, &b)).sqrt();
    if size > 0.0 { product(&a, &b) / size } else { 0.0 }
}

/// Values nearer than this fraction of the median magnitude are equal: rounding
/// decides which of them is larger, as at the vertices of one ring of a torus.
/// Distinct values are ten thousand at most, and further apart than that.
const SAME: f64 = 1e-9;

/// The rank of each value from 0 on, the mean of them where values are equal.
fn ranks(values: &[f64]) -> Vec<f64> {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|&i, &j| values[i].total_cmp(&values[j]));
    let mut sizes: Vec<f64> = values.iter().map(|x| x.abs()).collect();
    sizes.sort_by(f64::total_cmp);
    let near = SAME * sizes.get(sizes.len() / 2).copied().unwrap_or_default();
    let mut ranks = vec![0.0; values.len()];
    let mut start = 0;
    for same in order.chunk_by(|&i, &j| values[j] - values[i] <= near) {
        for &i in same {
            ranks[i] = start as f64 + (same.len() as f64 - 1.0) / 2.0;
        }
        start += same.len();
    }
    ranks
}

/// The estimators of the plot.
const PLOTTED: [&str; 3] = ["cotangent", "corrected", "adaptive"];

/// The effect visible in the plot, from the changes of √|K| over those of H.
fn seen(ratios: &[f64]) -> Result<String> {
    let [least, most] = extremes(ratios.iter().copied());
    let heading = match (least > 1.0, most < 1.0) {
        (true, _) => "lines above",
        (_, true) => "lines below",
        _ => "lines",
    };
    TEXT.say(heading, values! { least, most })
}

/// The changes of H and of √|K| over σ/h, on the finest meshes.
fn plot(changes: &Table) -> Result<Picture> {
    let mut figure = Figure { columns: 2, ..Figure::default() };
    let mut ratios = vec![];
    for (i, surface) in SURFACES.into_iter().enumerate() {
        let mut plot = Plot {
            title: surface.name().into(),
            x: Axis::log("noise σ/h"),
            y: Axis::log(if i == 0 { "relative change" } else { "" }),
            legend: if i == 1 { Legend::Lines } else { Legend::None },
            ..Plot::default()
        };
        let rows = changes.only(&[("surface", surface.name().into())])?;
        let [_, finest] = extremes(rows.column("vertices")?);
        let rows = rows.only(&[("vertices", (finest as usize).into())])?;
        for name in PLOTTED {
            let rows = rows.only(&[("estimator", name.into())])?;
            ratios.extend(rows.column("√|K| over H")?);
            for (column, what) in [("change of H", "H"), ("change of √|K|", "√|K|")] {
                let points = rows.column("σ/h")?.into_iter().zip(rows.column(column)?);
                let points = points.map(<[f64; 2]>::from).collect();
                plot.series.push(Series::marked(format!("{what}, {name}"), points));
            }
        }
        figure.panels.push(Panel::drawing(plot.draw(if i == 1 { 500.0 } else { 340.0 }, 240.0)?));
    }
    let seen = seen(&ratios)?;
    plotted(
        &figure,
        "changes",
        &TEXT.say("figure", values! { seen })?,
        &TEXT.say("figure alt", &[])?,
    )
    .context("the plot of changes")
}

#[cfg(test)]
mod tests {
    use std::collections::HashMap;

    use super::*;

    #[test]
    fn ranks_share_ties() {
        assert_eq!(ranks(&[3.0, 1.0, 3.0, 2.0]), [2.5, 0.0, 2.5, 1.0]);
        assert!((rank_correlation(&[1.0, 2.0, 3.0], &[1.0, 8.0, 9.0]) - 1.0).abs() < 1e-15);
        assert!((rank_correlation(&[1.0, 2.0, 3.0], &[3.0, 2.0, 1.0]) + 1.0).abs() < 1e-15);
        assert_eq!(rank_correlation(&[1.0, 1.0], &[1.0, 2.0]), 0.0);
    }

    /// The caption says "above" only where all of the line is.
    #[test]
    fn the_caption_follows_the_lines() {
        assert!(seen(&[1.1, 2.0]).unwrap().contains("above that of H, 1.1 to 2 times"));
        assert!(seen(&[0.4, 0.9]).unwrap().contains("below that of H"));
        assert!(seen(&[0.9, 1.1]).unwrap().starts_with("Noise disturbs both"));
    }

    /// Equal values that differ by rounding.
    #[test]
    fn rounding_decides_no_rank() {
        let exact = [3.0, 1.0, 3.0, 2.0, 1.0];
        let rounded = [3.0, 1.0 + 1e-15, 3.0 - 4e-15, 2.0, 1.0 - 2e-16];
        assert_eq!(ranks(&rounded), ranks(&exact));
    }

    /// All vertices of a ring have the same curvature.
    #[test]
    fn a_ring_of_a_torus_shares_its_rank() {
        let mesh = TestSurface::Torus.mesh(1, Sampling::Regular, 0);
        for estimator in Estimator::all() {
            let field = estimator.estimate(&mesh).unwrap();
            for (values, name) in [(&field.mean, "H"), (&field.gaussian, "K")] {
                let mut rings = HashMap::new();
                for (p, rank) in mesh.positions().iter().zip(ranks(values)) {
                    let ring = [libm::hypot(p[0], p[1]), p[2]].map(|x| (x * 1e9).round() as i64);
                    let first = *rings.entry(ring).or_insert(rank);
                    assert_eq!(rank, first, "{name} of {}", estimator.name());
                }
                assert!(rings.len() > 2 && rings.len() < mesh.vertex_count() / 2);
            }
        }
    }
}
