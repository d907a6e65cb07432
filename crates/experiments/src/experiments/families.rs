//! The automatic denoiser on the test bed: tables of families and halves, the
//! worst case, and what is still lost.

use anyhow::{Context as _, Result};
use fairing_denoising::Denoiser;
use fairing_figure::{Axis, Figure, Legend, Panel as FigurePanel, Plot, Series};
use fairing_mesh::TriMesh;

use super::gallery::{VIEWPOINTS, plotted};
use super::grid::{Grid, Row};
use crate::bed::{self, Case, Found, Half, Method, Published, cases, committed, found, summary};
use crate::experiment::Context;
use crate::outcome::{Outcome, Picture};
use crate::row;
use crate::table::{Cell, Table, Tables, Unit, brief};
use crate::verdict::{Judgement, Verdict};

/// The largest ratio that is wanted on families that nothing was chosen on.
const BAR: f64 = 1.1;

/// How many of the worst cases of each half are named.
const NAMED: usize = 5;

/// Adds the tables of the whole bed, from the results that the repository
/// keeps, and pictures of the worst case.
///
/// The worst case of each half is measured again: results that are no longer
/// those of the denoiser are left out, with a note that says so.
pub(super) fn add(context: &Context<'_>, outcome: &mut Outcome) -> Result<()> {
    let published = Published::committed()?;
    let results = committed(&published)?;
    let all = cases();
    let mine = |half: Half| -> Vec<(&Case, &Found)> {
        let of = |c: &Case| results.iter().find(|f| f.case == c.name());
        all.iter().filter(|c| c.half() == half).filter_map(|c| Some((c, of(c)?))).collect()
    };
    let mut pictures = vec![];
    let mut current = all.len() == results.len();
    for (k, half) in Half::ALL.into_iter().enumerate() {
        if !current {
            break;
        }
        context.progress(0.9 + 0.05 * k as f64, half.name());
        let mine = mine(half);
        let worst = mine.iter().max_by(|a, b| ratio(a.1).total_cmp(&ratio(b.1)));
        let &(case, found) = worst.context("no results")?;
        let (now, picture) = again(case, &published)?;
        // The table has three digits.
        current &= (now.angle - found.angle).abs() < 1e-3;
        pictures.push(picture);
    }
    if !current {
        outcome.notes.push("The kept results on the test bed are not those of this denoiser, and are left out: `cargo xtask bed measure --accept` makes them.".into());
        return Ok(());
    }
    outcome.figures.push(ratios(&mine)?);
    outcome.figures.extend(pictures);
    let (mut families, mut halves, mut lost) = (families_table(), halves_table(), lost_table());
    for half in Half::ALL {
        let mine = mine(half);
        rows_of(&mut families, half, &mine);
        halves.push(row_of(half, &mine)?);
        let mut worst: Vec<(&Case, &Found)> = mine;
        worst.sort_by(|a, b| ratio(b.1).total_cmp(&ratio(a.1)));
        for (_, f) in worst.iter().take(NAMED) {
            let entry = published.best(&f.case).context("a case without published results")?;
            lost.push(row![
                half.name(),
                f.case.clone(),
                f.noisy,
                f.angle,
                entry.tuned,
                ratio(f),
                entry.method.clone(),
                entry.parameters.clone(),
            ]);
        }
    }
    outcome.tables.extend([families, halves, lost]);
    outcome.notes.push(
        "The tables of the test bed are those that `cargo xtask bed measure --accept` keeps; this run has measured the worst case of each half again.".into(),
    );
    Ok(())
}

/// The ratio to the best published result; zero where none is known.
fn ratio(found: &Found) -> f64 {
    found.ratio().unwrap_or(0.0)
}

/// The ratios of each half in ascending order.
fn ratios<'a>(mine: &impl Fn(Half) -> Vec<(&'a Case, &'a Found)>) -> Result<Picture> {
    let mut plot = Plot {
        x: Axis::linear("share of the cases in %"),
        y: Axis::log("E_a over the best published"),
        legend: Legend::Lines,
        ..Plot::default()
    };
    for half in Half::ALL {
        let mut found: Vec<f64> = mine(half).iter().filter_map(|(_, f)| f.ratio()).collect();
        found.sort_by(f64::total_cmp);
        let share = 100.0 / found.len() as f64;
        let points = found.iter().enumerate().map(|(k, ratio)| [share * (k as f64 + 0.5), *ratio]);
        plot.series.push(Series::marked(half.name(), points.collect()));
    }
    plot.series.push(Series::reference("as good", vec![[0.0, 1.0], [100.0, 1.0]]));
    let mut figure = Figure::default();
    figure.panels.push(FigurePanel::drawing(plot.draw(800.0, 260.0)?));
    plotted(
        &figure,
        "ratios",
        "Below the dashed line the automatic denoiser is better than the best published method, whose parameters were tuned with the truth; above it, worse. E_a of the automatic denoiser over that of the other on each case of the test bed, in ascending order.",
        "Two rising lines, one for each half of the families, that cross the dashed line of equal errors.",
    )
}

fn families_table() -> Table {
    Table::new(
        "families",
        "The families of the test bed: E_a of the automatic denoiser over that of the best published method, its parameters tuned with the truth on that very case; the median and the worst case.",
        &[
            ("half", Unit::Label),
            ("kind", Unit::Label),
            ("family", Unit::Label),
            ("cases", Unit::Count),
            ("median", Unit::One),
            ("worst", Unit::One),
            ("worst case", Unit::Label),
            ("E_a", Unit::Degrees),
            ("best published", Unit::Degrees),
        ],
    )
}

fn rows_of(table: &mut Table, half: Half, mine: &[(&Case, &Found)]) {
    let mut families: Vec<_> = mine.iter().map(|(c, _)| c.family).collect();
    families.sort();
    families.dedup();
    for family in families {
        let found: Vec<Found> =
            mine.iter().filter(|(c, _)| c.family == family).map(|(_, f)| (*f).clone()).collect();
        let sum = summary(&found);
        let worst = found.iter().max_by(|a, b| ratio(a).total_cmp(&ratio(b)));
        let Some(worst) = worst else { continue };
        table.push(row![
            half.name(),
            family.kind().name(),
            family.name(),
            sum.cases,
            sum.median,
            sum.worst,
            worst.case.strip_prefix(family.name()).unwrap_or(&worst.case).trim(),
            worst.angle,
            worst.best.as_ref().map(|b| b.0),
        ]);
    }
}

fn halves_table() -> Table {
    Table::new(
        "halves",
        "Both halves of the families. Constants are chosen on the first half alone. Flipped faces oppose the truth. Volumes are compared with that of the truth, and with that of the noisy mesh, which noise alone changes.",
        &[
            ("half", Unit::Label),
            ("cases", Unit::Count),
            ("compared", Unit::Count),
            ("median ratio", Unit::One),
            ("worst ratio", Unit::One),
            ("above 1.1", Unit::Count),
            ("worse than a default", Unit::Count),
            ("normals worse than noisy", Unit::Count),
            ("positions worse than noisy", Unit::Count),
            ("flipped, noisy", Unit::Count),
            ("flipped", Unit::Count),
            ("more crossings", Unit::Count),
            ("volume from truth", Unit::Percent),
            ("volume from noisy", Unit::Percent),
        ],
    )
}

fn row_of(half: Half, mine: &[(&Case, &Found)]) -> Result<[Cell; 14]> {
    let found: Vec<Found> = mine.iter().map(|(_, f)| (*f).clone()).collect();
    let s = summary(&found);
    Ok(row![
        half.name(),
        s.cases,
        s.compared,
        s.median.context("no published results")?,
        s.worst.context("no published results")?,
        s.beyond_bar,
        s.worse_than_default,
        s.worse_normals,
        s.worse_positions,
        s.flipped[0],
        s.flipped[1],
        s.more_intersections,
        100.0 * s.volume[0],
        100.0 * s.volume[1],
    ])
}

fn lost_table() -> Table {
    Table::new(
        "lost",
        "What is still lost: the five cases of each half with the largest ratio, and the published method that does better with the parameters found with the truth.",
        &[
            ("half", Unit::Label),
            ("case", Unit::Label),
            ("noisy", Unit::Degrees),
            ("automatic", Unit::Degrees),
            ("best published", Unit::Degrees),
            ("ratio", Unit::One),
            ("method", Unit::Label),
            ("parameters", Unit::Label),
        ],
    )
}

/// Measures a case again and draws it: the truth, the noisy mesh, ours, and
/// the best published result.
fn again(case: &Case, published: &Published) -> Result<(Found, Picture)> {
    let (truth, noisy) = case.meshes()?;
    let name = case.name();
    let denoise = bed::denoiser(Denoiser::Automatic.name())?;
    let (now, ours) = found(&name, &truth, &noisy, published, |mesh| Ok(denoise(mesh)?))?;
    let entry = published.best(&name).context("a case without published results")?;
    let method = Method::named(&entry.method)?;
    let theirs = method.run(&noisy, &method.parsed(&entry.parameters)?)?;
    let meshes: [&TriMesh; 4] = [&truth, &noisy, &ours, &theirs];
    let titles = [
        "truth".to_string(),
        format!("noisy, {}°", brief(now.noisy)),
        format!("automatic, {}°", brief(now.angle)),
        format!("{}, {}°", entry.method, brief(entry.tuned)),
    ];
    let half = case.half();
    let picture = Grid {
        rows: vec![Row {
            title: String::new(),
            frame: &truth,
            meshes: meshes.to_vec(),
            titles: titles.to_vec(),
        }],
        viewpoint: VIEWPOINTS[0],
        up: fairing_figure::Up::Z,
        aspect: 1.0,
    }
    .draw(
        &format!("worst-{half}"),
        &format!(
            "Of the last two pictures the left one is worse: here the automatic denoiser loses most against the best published method, whose parameters were tuned with the truth. The worst case of the {half} half, “{name}”: the truth, the noisy mesh and both results, flat shaded, with E_a."
        ),
        "Four pictures of one body: without noise, noisy, and denoised by two methods.",
    )?;
    Ok((now, picture))
}

/// Whether the bar is met on the families that no choice was based on; `None`
/// where the results are left out.
pub(super) fn judge(tables: Tables<'_>) -> Result<Option<Judgement>> {
    let Ok(halves) = tables.get("halves") else { return Ok(None) };
    let unseen = halves.only(&[("half", Half::Unseen.name().into())])?;
    let value = |column: &str| -> Result<f64> { Ok(unseen.column(column)?[0]) };
    let (median, worst) = (value("median ratio")?, value("worst ratio")?);
    let (cases, above) = (value("compared")?, value("above 1.1")?);
    let harmed = value("normals worse than noisy")? + value("positions worse than noisy")?;
    let verdict = match (median <= 1.0, worst <= BAR && harmed == 0.0) {
        (true, true) => Verdict::Confirmed,
        (false, false) => Verdict::Refuted,
        _ => Verdict::Qualified,
    };
    let reason = format!(
        "On {cases} cases of families that no constant was chosen on, E_a is in the median {median:.2} times that of the best published method tuned with the truth, at worst {} times, and above {BAR} times on {above}; the result is farther from the truth than the noisy mesh, in normals or in positions, on {harmed}.",
        brief(worst),
    );
    let finding = format!(
        "The median of its error is {median:.2} times that of the best published method tuned with the truth; at worst it is {} times as large.",
        brief(worst)
    );
    let judgement = Judgement::new(
        "unseen",
        "On kinds of bodies that it was not made with, the automatic denoiser does as well as the best published method whose parameters are chosen with the truth",
        verdict,
        reason,
    )
    .finding(finding)
    .ours()
    .shown("figure-denoisers-ratios", Half::Unseen.name())
    .number("median ratio", median, Unit::One)
    .number("worst ratio", worst, Unit::One);
    Ok(Some(judgement))
}
