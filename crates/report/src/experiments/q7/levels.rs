//! The levels of the assignment, in model units and relative to the size of the faces.

use anyhow::{Context as _, Result};
use fairing_denoising::{AutomaticOptions, Denoiser};
use fairing_evaluation::NoiseLevel;
use fairing_shapes as shapes;
use fairing_sparse::{larger, smaller};

use super::methods::{ASSIGNMENT, KEPT, METHODS, SHRUNK, TEXT};
use crate::experiment::Context;
use crate::experiment::text::values;
use crate::experiments::restoring::{Body, Method, Trials};
use crate::experiments::seen;
use crate::model::table::{Cell, Table, Tables, Tolerance, Unit, brief};
use crate::model::verdict::{Judgement, Shown, Verdict, ViewState};
use crate::row;

/// Spacings of the block: a factor of eight in h.
const SPACINGS: [f64; 5] = [0.3, 0.178, 0.106, 0.063, 0.0375];

/// The same for a quick run.
const QUICK: [f64; 3] = [0.3, 0.25, 0.2];

/// The methods that are run at each resolution: the flows, and for comparison the best filter
/// without creases and the best denoiser at high noise.
const COMPARED: [Method; 6] = [
    Method::FLOWS[0],
    Method::FLOWS[1],
    Method::FLOWS[2],
    Method::FLOWS[3],
    Method::Taubin,
    Method::Denoiser(Denoiser::Automatic(AutomaticOptions::DEFAULT)),
];

/// Returns true if a shape is kept.
fn is_kept(angle: f64, volume: Option<f64>) -> bool {
    angle < KEPT && volume.is_none_or(|v| v > -SHRUNK)
}

/// The same block and the same noise in model units over the size of the faces.
pub(super) fn resolutions(context: &Context<'_>) -> Result<Table> {
    let mut table = Table::new(
        "resolution",
        &TEXT.say("table resolution", values! { kept: KEPT, shrunk: SHRUNK })?,
        &[
            ("vertices", Unit::Count),
            ("h", Unit::Length),
            ("σ", Unit::Length),
            ("σ/h", Unit::EdgeLengths),
            ("diagonal", Unit::EdgeLengths),
            ("seeds", Unit::Count),
            ("noisy", Unit::Degrees),
            (COMPARED[0].name(), Unit::Degrees),
            (COMPARED[1].name(), Unit::Degrees),
            (COMPARED[2].name(), Unit::Degrees),
            (COMPARED[3].name(), Unit::Degrees),
            (COMPARED[4].name(), Unit::Degrees),
            (COMPARED[5].name(), Unit::Degrees),
            ("standard error", Unit::Degrees),
            ("kept by", Unit::Label),
        ],
    )
    .aside(&[
        "vertices",
        "seeds",
        "diagonal",
        "standard error",
        COMPARED[2].name(),
        COMPARED[3].name(),
        COMPARED[4].name(),
    ]);
    for method in COMPARED {
        table = table.tolerance(method.name(), Some(Tolerance::LOOSE));
    }
    table = table.tolerance("standard error", Some(Tolerance { relative: 0.05, absolute: 1e-3 }));
    for &spacing in context.choose(&SPACINGS[..], &QUICK) {
        let body = Body::new("machine part", shapes::cad_block(spacing))?;
        let (n, h) = (body.truth.vertex_count(), body.truth.mean_edge_length());
        // The mean over a mesh of many faces varies little from seed to seed.
        let seeds = if n < 2000 { context.choose(5, 2) } else { 2 };
        let methods: Vec<(Method, usize)> =
            [Method::Nothing].into_iter().chain(COMPARED).map(|m| (m, seeds)).collect();
        for sigma in ASSIGNMENT {
            let level = NoiseLevel::Model(sigma);
            let trials = body.trials(level, context.seed("resolution"), &methods)?;
            let error = |t: &Trials| t.angle.error(seeds).unwrap_or(0.0);
            let error = trials.iter().map(error).fold(0.0, larger);
            let size = body.truth.diagonal() / h;
            let mut row = row![n, h, sigma, sigma / h, size, seeds].to_vec();
            row.extend(trials.iter().map(|t| Cell::from(t.angle.mean)));
            row.push(error.into());
            row.push(keepers(&trials).into());
            table.push(row);
        }
    }
    Ok(table)
}

/// The flows that keep the shape, by name.
fn keepers(trials: &[Trials]) -> String {
    let kept = |t: &&Trials| {
        Method::FLOWS.contains(&t.method) && is_kept(t.angle.mean, t.volume.map(|v| v.mean))
    };
    let names: Vec<&str> = trials.iter().filter(kept).map(|t| t.method.name()).collect();
    match names.len() {
        0 => "none".into(),
        4 => "all".into(),
        _ => names.join("; "),
    }
}

/// The machine part after smoothing at one noise level.
struct Level {
    /// σ/h.
    share: f64,
    /// Normal error of each flow.
    flows: Vec<f64>,
    /// Number of them that keep the shape.
    kept: usize,
    /// The smallest normal error of all other methods, the trained one aside.
    others: f64,
}

impl Level {
    fn new(model: &Table, sigma: f64) -> Result<Self> {
        let rows = model.only(&[("σ", sigma.into())])?;
        let value =
            |method: Method, column: &str| rows.value(&[("method", method.name().into())], column);
        let (mut flows, mut kept) = (vec![], 0);
        for method in Method::FLOWS {
            let angle = value(method, "normal error")?;
            kept += usize::from(is_kept(angle, value(method, "volume").ok()));
            flows.push(angle);
        }
        let others = METHODS
            .iter()
            .map(|m| m.0)
            .filter(|m| *m != Method::Nothing && !Method::FLOWS.contains(m) && !m.is_trained());
        // Some are not run at high noise.
        let others =
            others.filter_map(|m| value(m, "normal error").ok()).fold(f64::INFINITY, smaller);
        Ok(Self { share: rows.column("σ/h")?[0], flows, kept, others })
    }
}

/// Effect of a flow at one level on the block, where it depends on the size of the faces.
struct Dependence {
    sigma: f64,
    flow: &'static str,
    /// The σ/h at which it keeps the shape.
    kept: Vec<f64>,
}

/// The flows and levels that are kept at one resolution and lost at another.
fn depending(resolution: &Table) -> Result<Vec<Dependence>> {
    let column = resolution.index("kept by")?;
    let mut found = vec![];
    for sigma in ASSIGNMENT {
        let rows = resolution.only(&[("σ", sigma.into())])?;
        let shares = rows.column("σ/h")?;
        for flow in Method::FLOWS.map(Method::name) {
            let keeps = |row: &Vec<Cell>| match &row[column] {
                Cell::Text(t) => t == "all" || t.split("; ").any(|name| name == flow),
                _ => false,
            };
            let kept: Vec<f64> =
                rows.rows.iter().zip(&shares).filter(|(r, _)| keeps(r)).map(|(_, s)| *s).collect();
            if !kept.is_empty() && kept.len() < shares.len() {
                found.push(Dependence { sigma, flow, kept });
            }
        }
    }
    Ok(found)
}

/// The explicit flow on the coarsest faces at the lowest level, and on those finer ones where it
/// does best: σ/h, the diagonal over h, and the normal error of each.
fn coarse_and_best(resolution: &Table) -> Result<[[f64; 3]; 2]> {
    let rows = resolution.only(&[("σ", ASSIGNMENT[0].into())])?;
    let (shares, sizes) = (rows.column("σ/h")?, rows.column("diagonal")?);
    let errors = rows.column(Method::Explicit.name())?;
    let all: Vec<[f64; 3]> =
        shares.iter().zip(&sizes).zip(&errors).map(|((a, b), c)| [*a, *b, *c]).collect();
    let coarse = all.iter().min_by(|a, b| a[0].total_cmp(&b[0])).context("no resolutions")?;
    let best = all.iter().min_by(|a, b| a[2].total_cmp(&b[2])).context("no resolutions")?;
    Ok([*coarse, *best])
}

/// A sentence on the size of features, if more noise for each edge leaves less error; empty
/// otherwise.
fn features([coarse, best]: [[f64; 3]; 2]) -> Result<String> {
    if best[0] <= coarse[0] {
        return Ok(String::new());
    }
    let values = values! {
        sigma: ASSIGNMENT[0], coarse_error: coarse[2], coarse_share: coarse[0],
        best_error: best[2], best_share: best[0], coarse_edges: coarse[1].round(),
        best_edges: best[1].round(),
    };
    Ok(format!(" {}", TEXT.say("features", values)?))
}

/// Flows that depend on the size of the faces, as a sentence.
fn resolved(depends: &[Dependence]) -> Result<String> {
    let Some(first) = depends.first() else {
        return Ok("no level is kept at one size and lost at another".into());
    };
    let counts = ASSIGNMENT.map(|sigma| {
        let flows = depends.iter().filter(|d| d.sigma == sigma).count();
        format!("{flows} at σ = {}", brief(sigma))
    });
    let (counts, kept) = (counts.join(", "), list(&first.kept));
    TEXT.say("resolved", values! { counts, flow: first.flow, sigma: first.sigma, kept })
}

fn list(values: &[f64]) -> String {
    seen::list(&values.iter().map(|x| brief(*x)).collect::<Vec<_>>())
}

/// Claim 7a.
pub(super) fn judge(tables: Tables<'_>) -> Result<Judgement> {
    let model = tables.get("model")?;
    let levels = ASSIGNMENT.iter().map(|s| Level::new(model, *s)).collect::<Result<Vec<_>>>()?;
    let resolution = tables.get("resolution")?;
    let depends = depending(resolution)?;
    let all = Method::FLOWS.len();
    let kept: Vec<usize> = levels.iter().map(|l| l.kept).collect();
    let verdict = match (&kept[..], depends.is_empty()) {
        ([a, b, 0], true) if *a == all && *b == all => Verdict::Confirmed,
        ([0, 0, c], _) if *c == all => Verdict::Refuted,
        _ => Verdict::Qualified,
    };
    let h = resolution.column("h")?;
    let (coarse, fine) =
        (h.iter().copied().fold(0.0, larger), h.iter().copied().fold(f64::INFINITY, smaller));
    let each = |value: &dyn Fn(&Level) -> String| {
        seen::list(&levels.iter().map(value).collect::<Vec<_>>())
    };
    let spread = |l: &Level| {
        let least = l.flows.iter().copied().fold(f64::INFINITY, smaller);
        let most = l.flows.iter().copied().fold(0.0, larger);
        format!("{} to {}°", brief(least), brief(most))
    };
    let values = values! {
        shares: list(&levels.iter().map(|l| l.share).collect::<Vec<_>>()),
        report_explicit: Method::ReportExplicit.name(),
        report_implicit: Method::ReportImplicit.name(),
        explicit: Method::Explicit.name(), implicit: Method::Implicit.name(),
        spread: each(&spread), all, keep: each(&|l| l.kept.to_string()),
        kept: KEPT, shrunk: SHRUNK,
        others: list(&levels.iter().map(|l| l.others).collect::<Vec<_>>()),
        sizes: h.len() / ASSIGNMENT.len(), coarse, fine, resolved: resolved(&depends)?,
        features: features(coarse_and_best(resolution)?)?,
    };
    let judgement = TEXT
        .judgement("7a", verdict, values)?
        .shown(Shown::view("q7", "levels-view", &ViewState::at(&[2, 0]).field("normal error")))
        .number("the levels over h, lowest", levels[0].share, Unit::EdgeLengths)
        .number("highest", levels[2].share, Unit::EdgeLengths);
    with_errors(judgement, &levels)
}

/// Adds the least and the largest normal error of the flows at each level.
fn with_errors(mut judgement: Judgement, levels: &[Level]) -> Result<Judgement> {
    for (level, sigma) in levels.iter().zip(ASSIGNMENT) {
        let least = level.flows.iter().copied().reduce(smaller).context("no flows")?;
        let most = level.flows.iter().copied().reduce(larger).context("no flows")?;
        judgement = judgement
            .number(
                &format!("least normal error of the four flows at σ = {sigma}"),
                least,
                Unit::Degrees,
            )
            .number("largest", most, Unit::Degrees);
    }
    Ok(judgement)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Tables with these normal errors of all flows, and what keeps the block at two
    /// resolutions.
    fn tables(angles: [[f64; 4]; 3], kept: [[&str; 2]; 3]) -> [Table; 2] {
        let mut model = Table::new(
            "model",
            "M.",
            &[
                ("σ", Unit::Length),
                ("σ/h", Unit::EdgeLengths),
                ("method", Unit::Label),
                ("normal error", Unit::Degrees),
                ("volume", Unit::Percent),
            ],
        );
        let mut resolution = Table::new(
            "resolution",
            "R.",
            &[
                ("h", Unit::Length),
                ("σ", Unit::Length),
                ("σ/h", Unit::EdgeLengths),
                ("diagonal", Unit::EdgeLengths),
                ("explicit", Unit::Degrees),
                ("kept by", Unit::Label),
            ],
        );
        for (k, sigma) in ASSIGNMENT.into_iter().enumerate() {
            for (method, angle) in Method::FLOWS.into_iter().zip(angles[k]) {
                model.push(row![sigma, sigma, method.name(), angle, -1.0]);
            }
            model.push(row![sigma, sigma, Method::Taubin.name(), 1.0, 0.0]);
            for (h, kept) in [1.0, 0.1].into_iter().zip(kept[k]) {
                resolution.push(row![h, sigma, sigma / h, 10.0 / h, angles[k][0] * h, kept]);
            }
        }
        [model, resolution]
    }

    fn verdict(angles: [[f64; 4]; 3], kept: [[&str; 2]; 3]) -> Verdict {
        judge(Tables(&tables(angles, kept))).unwrap().verdict
    }

    /// The best of the other methods, which leaves a degree at every level, has no say; nor has the
    /// best flow.
    #[test]
    fn the_flows_decide() {
        let (good, bad) = ([5.0; 4], [40.0; 4]);
        let same = [["all"; 2], ["all"; 2], ["none"; 2]];
        assert_eq!(verdict([good, good, bad], same), Verdict::Confirmed);
        let one = [5.0, 27.0, 5.0, 5.0];
        assert_eq!(verdict([good, one, bad], same), Verdict::Qualified);
        assert_eq!(verdict([good, good, good], same), Verdict::Qualified);
        assert_eq!(verdict([bad, bad, good], same), Verdict::Refuted);
    }

    /// Finer faces have more noise for each edge and more edges for each feature.
    #[test]
    fn features_are_mentioned_where_they_count() {
        let text = features([[0.2, 16.0, 22.0], [0.8, 80.0, 9.0]]).unwrap();
        assert!(text.contains("22° at 0.2 h and 9° at 0.8 h"), "{text}");
        assert!(features([[0.2, 16.0, 5.0], [0.2, 16.0, 5.0]]).unwrap().is_empty());
    }

    #[test]
    fn a_level_that_depends_on_the_resolution_is_no_level() {
        let depends = [["all"; 2], ["all", "implicit"], ["none"; 2]];
        assert_eq!(verdict([[5.0; 4], [5.0; 4], [40.0; 4]], depends), Verdict::Qualified);
    }
}
