//! The automatic denoiser on the benchmark: the tables that the study stores.

use anyhow::Result;
use fairing_figure::{Axis, Figure, Panel as FigurePanel, Plot, Series};
use fairing_sparse::larger;

use super::gallery::plotted;
use crate::experiment::outcome::{Outcome, Picture};
use crate::experiment::text::{Text, values};
use crate::model::table::{Table, Tables, Unit};
use crate::model::verdict::{Judgement, Shown, Verdict};

/// The words of the experiment.
pub(super) static TEXT: Text = Text::new("denoisers", include_str!("../../text/denoisers.md"));

/// The largest ratio that is wanted on families that nothing was chosen on.
const BAR: f64 = 1.1;

/// The sets of families.
const SETS: [&str; 3] = ["development", "unseen", FRESH];

/// The set on which nothing was trained or chosen.
const FRESH: &str = "fresh";

/// The largest difference of the normal errors on the models of the section, in degrees, at which
/// the stored results count as those of the denoiser; the table has three digits.
const SAME: f64 = 2e-3;

/// Adds the tables of the whole benchmark, from the results that the study keeps in the repository.
///
/// If the errors of the denoiser on the models of the section differ from the stored ones, the
/// tables are left out, with a note that says so.
pub(super) fn add(automatic: &[(&str, f64)], outcome: &mut Outcome) -> Result<()> {
    let models =
        models_table().filled(include_str!("../../../../docs/reference/denoising/models.csv"))?;
    for (mesh, error) in automatic {
        if (models.value(&[("mesh", (*mesh).into())], "normal error")? - error).abs() > SAME {
            outcome.notes.push(TEXT.say("note outdated", &[])?);
            return Ok(());
        }
    }
    let ratios =
        ratios_table().filled(include_str!("../../../../docs/reference/denoising/ratios.csv"))?;
    outcome.figures.push(plot(&ratios)?);
    outcome.tables.extend([
        families_table()?
            .filled(include_str!("../../../../docs/reference/denoising/families.csv"))?,
        sets_table()?.filled(include_str!("../../../../docs/reference/denoising/sets.csv"))?,
        lost_table()?.filled(include_str!("../../../../docs/reference/denoising/lost.csv"))?,
    ]);
    outcome.notes.push(TEXT.say("note stored", &[])?);
    Ok(())
}

fn models_table() -> Table {
    Table::new("models", "", &[("mesh", Unit::Label), ("normal error", Unit::Degrees)])
}

fn ratios_table() -> Table {
    Table::new("ratios", "", &[("set", Unit::Label), ("ratio", Unit::One)])
}

/// The ratios of each set in ascending order.
fn plot(ratios: &Table) -> Result<Picture> {
    let mut plot = Plot {
        x: Axis::linear("share of the cases in %"),
        y: Axis::log("normal error over the best published"),
        ..Plot::default()
    };
    for set in SETS {
        let found = ratios.only(&[("set", set.into())])?.column("ratio")?;
        let share = 100.0 / found.len() as f64;
        let points = found.iter().enumerate().map(|(k, ratio)| [share * (k as f64 + 0.5), *ratio]);
        plot.series.push(Series::marked(set, points.collect()));
    }
    plot.series.push(Series::reference("as good", vec![[0.0, 1.0], [100.0, 1.0]]));
    let mut figure = Figure::default();
    figure.panels.push(FigurePanel::drawing(plot.draw(800.0, 260.0)?));
    plotted(
        &figure,
        "ratios",
        &TEXT.say("figure ratios", &[])?,
        &TEXT.say("figure ratios alt", &[])?,
    )
}

fn families_table() -> Result<Table> {
    Ok(Table::new(
        "families",
        &TEXT.say("table families", &[])?,
        &[
            ("set", Unit::Label),
            ("kind", Unit::Label),
            ("family", Unit::Label),
            ("cases", Unit::Count),
            ("median", Unit::One),
            ("worst", Unit::One),
            ("worst case", Unit::Label),
            ("normal error", Unit::Degrees),
            ("best published", Unit::Degrees),
        ],
    ))
}

fn sets_table() -> Result<Table> {
    Ok(Table::new(
        "sets",
        &TEXT.say("table sets", &[])?,
        &[
            ("set", Unit::Label),
            ("cases", Unit::Count),
            ("compared", Unit::Count),
            ("median ratio", Unit::One),
            ("worst ratio", Unit::One),
            ("above 1.1", Unit::Count),
            ("worse than a default", Unit::Count),
            ("normals worse than noisy", Unit::Count),
            ("positions worse than noisy", Unit::Count),
            ("flipped before", Unit::Count),
            ("flipped", Unit::Count),
            ("more crossings", Unit::Count),
            ("volume from truth", Unit::Percent),
            ("volume from noisy", Unit::Percent),
        ],
    ))
}

fn lost_table() -> Result<Table> {
    Ok(Table::new(
        "lost",
        &TEXT.say("table lost", &[])?,
        &[
            ("set", Unit::Label),
            ("case", Unit::Label),
            ("noisy", Unit::Degrees),
            ("automatic", Unit::Degrees),
            ("best published", Unit::Degrees),
            ("ratio", Unit::One),
            ("method", Unit::Label),
            ("parameters", Unit::Label),
        ],
    ))
}

/// The number of cases of all sets, and of those in which a published method at its default
/// parameters does better; zeros where the results are left out.
pub(super) fn worse_than_defaults(tables: Tables<'_>) -> Result<[usize; 2]> {
    let Ok(sets) = tables.get("sets") else { return Ok([0, 0]) };
    let total = |column: &str| -> Result<usize> {
        Ok(sets.column(column)?.into_iter().sum::<f64>() as usize)
    };
    Ok([total("compared")?, total("worse than a default")?])
}

/// Judges the bar on the families that no choice was based on, the unseen and the
/// fresh ones; `None` where the results are left out.
pub(super) fn judge(tables: Tables<'_>) -> Result<Option<Judgement>> {
    let Ok(sets) = tables.get("sets") else { return Ok(None) };
    let of = |set: &str| -> Result<Standing> {
        let row = sets.only(&[("set", set.into())])?;
        let value = |column: &str| -> Result<f64> { Ok(row.column(column)?[0]) };
        Ok(Standing {
            cases: value("compared")?,
            median: value("median ratio")?,
            worst: value("worst ratio")?,
            above: value("above 1.1")?,
            harmed: [value("normals worse than noisy")?, value("positions worse than noisy")?],
        })
    };
    let (unseen, fresh) = (of("unseen")?, of(FRESH)?);
    let both = [&unseen, &fresh];
    let verdict = match (
        both.iter().all(|s| s.median <= 1.0),
        both.iter().all(|s| s.worst <= BAR && s.harmed == [0.0; 2]),
    ) {
        (true, true) => Verdict::Confirmed,
        (false, false) => Verdict::Refuted,
        _ => Verdict::Qualified,
    };
    let worst = larger(unseen.worst, fresh.worst);
    let reason = values! {
        unseen_cases: unseen.cases, fresh_cases: fresh.cases,
        unseen: unseen.text()?, fresh: fresh.text()?,
    };
    let finding = values! { unseen: unseen.median, fresh: fresh.median, worst };
    let judgement = Judgement::new(
        "unseen",
        &TEXT.say("claim unseen", &[])?,
        verdict,
        TEXT.say("reason unseen", reason)?,
    )
    .finding(TEXT.say("finding unseen", finding)?)
    .ours()
    .shown(Shown::line("denoisers", "ratios", FRESH))
    .number("median ratio, fresh", fresh.median, Unit::One)
    .number("median ratio, unseen", unseen.median, Unit::One)
    .number("worst ratio", worst, Unit::One);
    Ok(Some(judgement))
}

/// Results of the automatic denoiser on a set.
struct Standing {
    cases: f64,
    median: f64,
    worst: f64,
    /// Cases above the bar.
    above: f64,
    /// Cases that are farther from the truth than the noisy mesh, in normals and in positions.
    harmed: [f64; 2],
}

impl Standing {
    fn text(&self) -> Result<String> {
        let Self { median, worst, above, harmed: [normals, _], .. } = *self;
        TEXT.say("standing", values! { median, worst, above, bar: BAR, normals })
    }
}
