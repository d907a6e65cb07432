//! The levels of the assignment, in model units and relative to the size of the faces.

use anyhow::{Context as _, Result};
use fairing_evaluation::NoiseLevel;
use fairing_shapes as shapes;
use fairing_sparse::{larger, smaller};

use super::methods::{ASSIGNMENT, KEPT, SHRUNK, TEXT};
use crate::experiment::Context;
use crate::experiment::text::values;
use crate::experiments::restoring::{Body, Method, Trials};
use crate::experiments::seen;
use crate::model::table::{Cell, Table, Tables, Tolerance, Unit, brief, brief_above, brief_below};
use crate::model::verdict::{Judgement, Shown, Verdict, ViewState};
use crate::row;

/// Spacings of the block: a factor of eight in h.
const SPACINGS: [f64; 5] = [0.3, 0.178, 0.106, 0.063, 0.0375];

/// The same for a quick run.
const QUICK: [f64; 3] = [0.3, 0.25, 0.2];

/// The methods that are run at each resolution: the flows, and for comparison a filter that keeps
/// the volume.
const COMPARED: [Method; 5] =
    [Method::FLOWS[0], Method::FLOWS[1], Method::FLOWS[2], Method::FLOWS[3], Method::Taubin];

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
            ("standard error", Unit::Degrees),
            ("kept by", Unit::Label),
        ],
    )
    .aside(&[
        "vertices",
        "seeds",
        "diagonal",
        "standard error",
        COMPARED[1].name(),
        COMPARED[2].name(),
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
    /// The loss of volume by the implicit steps of the original report, in per cent.
    lost: f64,
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
        let lost = -value(Method::ReportImplicit, "volume")?;
        Ok(Self { share: rows.column("σ/h")?[0], flows, kept, lost })
    }
}

/// The level of each flow that keeps the block at one resolution of it and not at another.
fn depending(resolution: &Table) -> Result<Vec<f64>> {
    let column = resolution.index("kept by")?;
    let mut found = vec![];
    for sigma in ASSIGNMENT {
        let rows = resolution.only(&[("σ", sigma.into())])?;
        for flow in Method::FLOWS.map(Method::name) {
            let keeps = |row: &Vec<Cell>| match &row[column] {
                Cell::Text(t) => t == "all" || t.split("; ").any(|name| name == flow),
                _ => false,
            };
            let kept = rows.rows.iter().filter(|row| keeps(row)).count();
            if (1..rows.rows.len()).contains(&kept) {
                found.push(sigma);
            }
        }
    }
    Ok(found)
}

/// The explicit flow on the coarsest faces at the lowest level, and on those finer ones where it
/// does best: σ/h and the normal error of each.
fn coarse_and_best(resolution: &Table) -> Result<[[f64; 2]; 2]> {
    let rows = resolution.only(&[("σ", ASSIGNMENT[0].into())])?;
    let (shares, errors) = (rows.column("σ/h")?, rows.column(Method::Explicit.name())?);
    let all: Vec<[f64; 2]> = shares.iter().zip(&errors).map(|(a, b)| [*a, *b]).collect();
    let coarse = all.iter().min_by(|a, b| a[0].total_cmp(&b[0])).context("no resolutions")?;
    let best = all.iter().min_by(|a, b| a[1].total_cmp(&b[1])).context("no resolutions")?;
    Ok([*coarse, *best])
}

/// A sentence on the size of features, if more noise for each edge leaves less error; empty
/// otherwise.
fn features([coarse, best]: [[f64; 2]; 2]) -> Result<String> {
    if best[0] <= coarse[0] {
        return Ok(String::new());
    }
    let values = values! {
        sigma: ASSIGNMENT[0], coarse_error: coarse[1], coarse_share: coarse[0],
        best_error: best[1], best_share: best[0],
    };
    TEXT.say("features", values)
}

/// Flows that depend on the size of the faces, as a sentence.
fn resolved(depends: &[f64], h: &[f64]) -> Result<String> {
    let coarse = h.iter().copied().fold(0.0, larger);
    let fine = h.iter().copied().fold(f64::INFINITY, smaller);
    let counts = ASSIGNMENT.map(|sigma| {
        let flows = depends.iter().filter(|level| **level == sigma).count();
        TEXT.say("flows at a level", values! { flows, sigma })
    });
    let counts = seen::list(&counts.into_iter().collect::<Result<Vec<_>>>()?);
    let values = values! { counts, sizes: h.len() / ASSIGNMENT.len(), coarse, fine };
    TEXT.say(if depends.is_empty() { "resolved nowhere" } else { "resolved" }, values)
}

/// Errors of a flow at all levels that hardly differ, as a sentence; empty if they do.
fn indifferent(levels: &[Level]) -> Result<String> {
    let Some(flow) = Method::FLOWS.iter().position(|m| *m == Method::ReportImplicit) else {
        return Ok(String::new());
    };
    let errors: Vec<f64> = levels.iter().map(|level| level.flows[flow]).collect();
    let least = errors.iter().copied().fold(f64::INFINITY, smaller);
    if errors.iter().any(|error| *error > INDIFFERENT * least) {
        return Ok(String::new());
    }
    let errors: Vec<String> = errors.iter().map(|error| format!("{error:.1}")).collect();
    TEXT.say("indifferent", values! { errors: seen::list(&errors), shrunk: levels[0].lost })
}

/// Errors at all levels that differ by no more than this factor are nearly the same.
const INDIFFERENT: f64 = 1.2;

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
    let each = |value: &dyn Fn(&Level) -> String| {
        seen::list(&levels.iter().map(value).collect::<Vec<_>>())
    };
    let spread = |l: &Level| {
        let least = l.flows.iter().copied().fold(f64::INFINITY, smaller);
        let most = l.flows.iter().copied().fold(0.0, larger);
        format!("{} to {}°", brief_below(least), brief_above(most))
    };
    let bullets = [
        indifferent(&levels)?,
        features(coarse_and_best(resolution)?)?,
        resolved(&depends, &resolution.column("h")?)?,
    ];
    let bullets = bullets.iter().filter(|bullet| !bullet.is_empty());
    let values = values! {
        shares: list(&levels.iter().map(|l| l.share).collect::<Vec<_>>()),
        spread: each(&spread), all, keep: each(&|l| l.kept.to_string()),
        kept: KEPT, shrunk: SHRUNK,
        others: bullets.map(|bullet| format!("\n\n- {bullet}")).collect::<String>(),
    };
    let judgement = TEXT
        .judgement("7a", verdict, values)?
        .shown(Shown::view("q7", "levels-view", &ViewState::at(&[2, 0]).field("normal error")))
        .number("first level over h", levels[0].share, Unit::EdgeLengths)
        .number("last level over h", levels[2].share, Unit::EdgeLengths);
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
                resolution.push(row![h, sigma, sigma / h, angles[k][0] * h, kept]);
            }
        }
        [model, resolution]
    }

    fn verdict(angles: [[f64; 4]; 3], kept: [[&str; 2]; 3]) -> Verdict {
        judge(Tables(&tables(angles, kept))).unwrap().verdict
    }

    /// The best of the other methods, which leaves a degree at every level, does not count; nor
    /// does the best flow.
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
        let text = features([[0.2, 22.0], [0.8, 9.0]]).unwrap();
        assert!(text.contains("22° on the coarsest faces (0.2 h)"), "{text}");
        assert!(features([[0.2, 5.0]; 2]).unwrap().is_empty());
    }

    #[test]
    fn a_level_that_depends_on_the_resolution_is_no_level() {
        let depends = [["all"; 2], ["all", "implicit"], ["none"; 2]];
        assert_eq!(verdict([[5.0; 4], [5.0; 4], [40.0; 4]], depends), Verdict::Qualified);
    }
}
