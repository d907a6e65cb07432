//! All denoisers on public pairs, on generated meshes and on the benchmark.

use std::time::Instant;

use anyhow::{Context as _, Result};
use fairing_denoising::{AutomaticOptions, Denoiser};
use fairing_evaluation::{NoiseKind, NoiseLevel, add_noise, drift, feature_edges, normal_error};
use fairing_figure::{Axis, Figure, Panel as FigurePanel, Plot, Series, Up};
use fairing_mesh::TriMesh;
use fairing_mesh::io::Reader;
use fairing_sparse::larger;

use super::families::{self, TEXT};
use super::gallery::{VIEWPOINTS, plotted};
use super::grid::{Grid, Row};
use super::models::{CREASES, FEATURE};
use super::pairs;
use super::restoring::{Body, Method};
use super::seen;
use crate::experiment::inputs::Input;
use crate::experiment::outcome::{Outcome, Picture};
use crate::experiment::text::values;
use crate::experiment::{Card, Context, Experiment};
use crate::model::table::{Cell, Table, Tables, Tolerance, Unit};
use crate::model::verdict::{Judgement, Shown, Verdict};
use crate::model::view::{Panel, Slider, View};
use crate::row;

pub(super) struct Denoisers;

/// The levels of the literature, in mean edge lengths.
const LEVELS: [f64; 3] = [0.1, 0.2, 0.3];

/// The pairs of the literature, by their names there.
const PAIRS: [(&str, Input, Input); 6] = [
    ("Fandisk 0.3", Input::FandiskLowNoisy, Input::FandiskLowTrue),
    ("Fandisk 0.7", Input::FandiskHighNoisy, Input::FandiskHighTrue),
    ("Block 0.4", Input::BlockNoisy, Input::BlockTrue),
    ("Twelve 0.5, impulsive", Input::TwelveNoisy, Input::TwelveTrue),
    ("Julius 0.2", Input::JuliusNoisy, Input::JuliusTrue),
    ("noisy machine part", Input::NoisyFandisk, Input::Fandisk),
];

/// The generated meshes: with creases, smooth, detailed. They are of fresh families, on which
/// nothing was trained or chosen.
const GENERATED: [(&str, &[u8]); 3] = [
    ("bolt", include_bytes!("../../../../data/bolt.ply")),
    ("vase", include_bytes!("../../../../data/vase.ply")),
    ("fluted", include_bytes!("../../../../data/fluted.ply")),
];

/// A quick run leaves out noisy meshes of more faces than this.
const LARGE: usize = 10_000;

impl Experiment for Denoisers {
    fn card(&self) -> Card {
        let [low, middle, high] = LEVELS;
        let parameters = vec![
            ("parameters of the denoisers", TEXT.words("parameters", &[])),
            ("levels", LEVELS.map(|l| format!("{l} h")).join(", ")),
        ];
        let published = pairs::published();
        TEXT.card(INPUTS, parameters, values! { low, middle, high, published })
    }

    fn run(&self, context: &Context<'_>) -> Result<Outcome> {
        let mut outcome = Outcome::default();
        let mut scores = scores_table()?;
        literature(context, &mut scores, &mut outcome)?;
        let read = |(name, bytes): (&'static str, &[u8])| {
            Body::new(name, Reader::default().read_bytes(name, bytes)?.mesh)
        };
        let bodies: Vec<Body> = GENERATED.into_iter().map(read).collect::<Result<_>>()?;
        let levels = context.choose(&LEVELS[..], &LEVELS[2..]);
        let mut automatic = vec![];
        for (b, body) in bodies.iter().enumerate() {
            for (k, &level) in levels.iter().enumerate() {
                let done = (b * levels.len() + k) as f64 / (bodies.len() * levels.len()) as f64;
                context.progress(0.4 + 0.5 * done, body.name);
                let noise = NoiseLevel::EdgeLengths(level);
                let kind = NoiseKind::GaussianAlongNormals;
                // The study that stores the results of the benchmark uses the same seed.
                let noisy = add_noise(&body.truth, kind, noise, (10.0 * level).round() as u64)?;
                let restored = measure(&mut scores, &label(body.name, level), body, &noisy)?;
                if Some(&level) == levels.last() {
                    let own = scores.value(&own(&label(body.name, level)), "normal error")?;
                    automatic.push((body.name, own));
                    if b == 0 {
                        outcome.figures.push(picture(body, &restored)?);
                        outcome.views.push(view(body, level, &restored)?);
                    }
                }
            }
        }
        outcome.figures.insert(0, averages(&scores, levels)?);
        outcome.tables = vec![pairs::table()?, best(&scores)?, scores];
        families::add(&automatic, &mut outcome)?;
        Ok(outcome)
    }

    fn judge(&self, tables: Tables<'_>) -> Result<Vec<Judgement>> {
        Ok([at_defaults(tables)?].into_iter().chain(families::judge(tables)?).collect())
    }
}

/// Ratios of the normal error of the automatic denoiser to the least of the published methods.
struct Ratios(Vec<f64>);

impl Ratios {
    /// The ratios of the table on meshes of this section, or on the others.
    fn of(best: &Table, of_section: bool) -> Result<Self> {
        let (least, own) = (best.column("its normal error")?, best.column("automatic")?);
        let names = best.labels("mesh")?;
        let is_ours = |name: &str| GENERATED.iter().any(|(body, _)| name.starts_with(body));
        let ratios = names.iter().zip(own.iter().zip(&least).map(|(own, least)| own / least));
        Ok(Self(ratios.filter(|(name, _)| is_ours(name) == of_section).map(|r| r.1).collect()))
    }

    fn wins(&self) -> usize {
        self.0.iter().filter(|ratio| **ratio <= 1.0).count()
    }

    fn losses(&self) -> usize {
        self.0.len() - self.wins()
    }

    fn largest(&self) -> f64 {
        self.0.iter().copied().fold(0.0, larger)
    }

    /// The number of meshes on which the automatic denoiser is better, in words.
    fn on(&self) -> Result<String> {
        let values = values! { wins: self.wins(), count: self.0.len() };
        TEXT.say(if self.losses() == 0 { "on all" } else { "on some" }, values)
    }
}

/// Judges the automatic denoiser beside published ones at their default parameters: on the public
/// pairs, on the generated meshes of the section, and on the whole benchmark where its results are
/// there. Pairs that were measured in this run are counted apart.
fn at_defaults(tables: Tables<'_>) -> Result<Judgement> {
    let best = tables.get("best")?;
    let (fresh, known) = (Ratios::of(best, true)?, Ratios::of(best, false)?);
    let public = pairs::standing(tables)?;
    let [cases, worse] = families::worse_than_defaults(tables)?;
    let of_public = public.as_ref().map_or(0, |public| public.lost);
    let verdict = match (fresh.wins(), fresh.losses() + known.losses() + worse + of_public) {
        (0, _) => Verdict::Refuted,
        (_, 0) => Verdict::Confirmed,
        _ => Verdict::Qualified,
    };
    let mut bullets: Vec<String> = public.iter().map(|public| public.words.clone()).collect();
    let values = values! { fresh: fresh.on()?, largest: fresh.largest() };
    bullets.push(TEXT.say("automatic on this section", values)?);
    if !known.0.is_empty() {
        let values = values! { known: known.on()?, largest: known.largest() };
        bullets.push(TEXT.say("automatic on known", values)?);
    }
    // One sentence: the benchmark has most of the cases.
    let mut finding = bullets.join(" ");
    if cases > 0 {
        finding = TEXT.say("automatic on the benchmark", values! { worse, cases })?;
        bullets.push(finding.clone());
    }
    let reason = format!("- {}", bullets.join("\n\n- "));
    let mut judgement = TEXT
        .judgement("automatic", verdict, values! { reason, finding })?
        .ours()
        .shown(Shown::figure("denoisers", "averages"));
    if let Some(public) = public {
        let name = "mean normal error on the public pairs";
        judgement = judgement.number(name, public.mean, Unit::Degrees);
    }
    if cases > 0 {
        let name = "benchmark cases in which a published default is better";
        judgement = judgement.number(name, worse as f64, Unit::Count);
    }
    let name = "largest ratio to the best published, here";
    Ok(judgement.number(name, fresh.largest(), Unit::One))
}

fn scores_table() -> Result<Table> {
    let mut scores = Table::new(
        "scores",
        &TEXT.say("table scores", &[])?,
        &[
            ("mesh", Unit::Label),
            ("faces", Unit::Count),
            ("method", Unit::Label),
            ("normal error", Unit::Degrees),
            ("vertex error", Unit::EdgeLengths),
            ("flipped", Unit::Count),
            ("volume", Unit::Percent),
            ("time", Unit::Seconds),
        ],
    );
    // Thresholds on noisy normals amplify the last digits.
    for (column, absolute) in
        [("normal error", 1e-3), ("vertex error", 1e-3), ("flipped", 2.0), ("volume", 0.01)]
    {
        scores = scores.tolerance(column, Some(Tolerance { relative: 0.02, absolute }));
    }
    Ok(scores.aside(&["faces"]))
}

/// The pairs of the literature, those that are found.
fn literature(context: &Context<'_>, scores: &mut Table, outcome: &mut Outcome) -> Result<()> {
    let mut absent = vec![];
    for (k, (name, noisy, truth)) in PAIRS.into_iter().enumerate() {
        context.progress(0.4 * k as f64 / PAIRS.len() as f64, name);
        // A stand-in is a block of the kind that the networks are trained on.
        if context.is_stand_in(truth) {
            absent.push(name);
            continue;
        }
        let (Some(noisy), Some(truth)) =
            (context.mesh_if_present(noisy)?, context.mesh_if_present(truth)?)
        else {
            absent.push(name);
            continue;
        };
        if context.is_quick() && noisy.face_count() > LARGE {
            continue;
        }
        // Originals may list their faces with other attributes, in the same order.
        let truth = noisy.with_positions(truth.positions().to_vec())?;
        measure(scores, name, &Body::new(name, truth)?, &noisy)?;
    }
    if !absent.is_empty() {
        let names = absent.join(", ");
        outcome.notes.push(TEXT.say("note absent", values! { names })?);
    }
    Ok(())
}

const INPUTS: &[Input] = &[
    Input::NoisyFandisk,
    Input::Fandisk,
    Input::FandiskLowNoisy,
    Input::FandiskLowTrue,
    Input::FandiskHighNoisy,
    Input::FandiskHighTrue,
    Input::BlockNoisy,
    Input::BlockTrue,
    Input::TwelveNoisy,
    Input::TwelveTrue,
    Input::JuliusNoisy,
    Input::JuliusTrue,
];

/// The noisy input, then every denoiser.
fn methods() -> impl Iterator<Item = Method> {
    std::iter::once(Method::Nothing).chain(Denoiser::all().into_iter().map(Method::Denoiser))
}

/// The row of the automatic denoiser on a mesh.
fn own(mesh: &str) -> [(&'static str, Cell); 2] {
    let name = Denoiser::Automatic(AutomaticOptions::DEFAULT).name();
    [("mesh", mesh.into()), ("method", name.into())]
}

/// A name that fits below a group of bars.
fn short_name(method: Method) -> &'static str {
    match method {
        Method::Nothing => "noisy",
        Method::Denoiser(Denoiser::NonIterative(_)) => "non-\niterative",
        Method::Denoiser(Denoiser::FastEffective(_)) => "fast,\neffective",
        Method::Denoiser(Denoiser::BilateralNormal(_)) => "bilateral\nnormal",
        Method::Denoiser(Denoiser::BilateralNormalGlobal(_)) => "bilateral\nnormal,\nglobal",
        Method::Denoiser(Denoiser::TotalVariation(_)) => "total\nvariation",
        Method::Denoiser(Denoiser::GuidedNormal(_)) => "guided\nnormal",
        Method::Denoiser(Denoiser::TotalGeneralisedVariation(_)) => "total\ngeneralised\nvariation",
        other => other.name(),
    }
}

fn label(name: &str, level: f64) -> String {
    format!("{name}, {level} h")
}

/// A row for each method; the restored meshes.
fn measure(table: &mut Table, name: &str, body: &Body, noisy: &TriMesh) -> Result<Vec<TriMesh>> {
    let mut restored = vec![];
    for method in methods() {
        let start = Instant::now();
        let mesh =
            body.restore(method, noisy).with_context(|| format!("{name}, {}", method.name()))?;
        let seconds = (method != Method::Nothing).then(|| start.elapsed().as_secs_f64());
        let score = body.score(&mesh)?;
        table.push(row![
            name,
            noisy.face_count(),
            method.name(),
            score.angle,
            score.distance,
            score.flipped,
            score.volume,
            seconds,
        ]);
        restored.push(mesh);
    }
    Ok(restored)
}

/// The best method on each mesh, beside ours.
fn best(scores: &Table) -> Result<Table> {
    let mut table = Table::new(
        "best",
        &TEXT.say("table best", &[])?,
        &[
            ("mesh", Unit::Label),
            ("noisy", Unit::Degrees),
            ("best published", Unit::Label),
            ("its normal error", Unit::Degrees),
            ("automatic", Unit::Degrees),
        ],
    );
    for column in ["noisy", "its normal error", "automatic"] {
        table = table.tolerance(column, Some(Tolerance { relative: 0.02, absolute: 1e-3 }));
    }
    let own = Denoiser::Automatic(AutomaticOptions::DEFAULT).name();
    let mesh = scores.index("mesh")?;
    let mut names: Vec<_> = scores.rows.iter().map(|row| row[mesh].clone()).collect();
    names.dedup();
    for name in names {
        let rows = scores.only(&[("mesh", name.clone())])?;
        let angle = |method: &str| rows.value(&[("method", method.into())], "normal error");
        let mut published = (f64::INFINITY, "");
        for denoiser in Denoiser::all().into_iter().filter(|d| !matches!(d, Denoiser::Automatic(_)))
        {
            let found = angle(denoiser.name())?;
            if found < published.0 {
                published = (found, denoiser.name());
            }
        }
        let automatic = angle(own)?;
        let noisy = angle(Method::Nothing.name())?;
        table.push(row![name.to_string(), noisy, published.1, published.0, automatic]);
    }
    Ok(table)
}

/// E_a of every method, the mean over the levels, a bar for each kind of mesh.
fn averages(scores: &Table, levels: &[f64]) -> Result<Picture> {
    let mut plot = Plot {
        y: Axis::linear("normal error in degrees"),
        categories: methods().map(|m| short_name(m).into()).collect(),
        ..Plot::default()
    };
    let mut shortest = vec![];
    for (name, _) in GENERATED {
        let mut bars = vec![];
        for method in methods() {
            let mut sum = 0.0;
            for &level in levels {
                let row = [("mesh", label(name, level).into()), ("method", method.name().into())];
                sum += scores.value(&row, "normal error")?;
            }
            bars.push(sum / levels.len() as f64);
        }
        let results = methods().map(Method::name).zip(bars.iter().copied()).skip(1);
        if let Some((name, _)) = results.min_by(|a, b| a.1.total_cmp(&b.1)) {
            shortest.push(name);
        }
        plot.series.push(Series::bars(called(name), bars));
    }
    shortest.dedup();
    let mut figure = Figure::default();
    figure.panels.push(FigurePanel::drawing(plot.draw(900.0, 230.0)?));
    plotted(
        &figure,
        "averages",
        &TEXT.say("figure averages", values! { best: shortest.join(", ") })?,
        &TEXT.say("figure averages alt", &[])?,
    )
}

/// An interactive view of the model at the highest level: noisy, after the denoiser of a slider,
/// and without noise.
fn view(body: &Body, level: f64, restored: &[TriMesh]) -> Result<View> {
    let truth = &body.truth;
    let (noisy, results) = restored.split_first().context("no noisy mesh")?;
    let names: Vec<&str> = Denoiser::all().iter().map(|d| d.name()).collect();
    let facts = |panel: Panel, meshes: &[TriMesh]| -> Result<Panel> {
        let mut columns = [vec![], vec![], vec![]];
        for mesh in meshes {
            let creases = feature_edges(mesh, truth, FEATURE)?.f_score();
            columns[0].push(Some(normal_error(mesh, truth)?.mean));
            columns[1].push(drift(mesh, truth).volume.map(|volume| 100.0 * volume));
            columns[2].push(creases.map(|score| 100.0 * score));
        }
        let [angles, volumes, creases] = columns;
        let panel = panel.with_fact("normal error", "°", angles).with_fact("volume", "%", volumes);
        Ok(panel.with_fact(CREASES, "%", creases))
    };
    let moving = Panel::moving("result", truth, results.iter().map(|mesh| mesh.positions()));
    let own = names
        .iter()
        .position(|name| *name == Denoiser::Automatic(AutomaticOptions::DEFAULT).name());
    Ok(View {
        id: format!("{}-view", body.name),
        mesh: body.name.into(),
        caption: TEXT.say("view", values! { body: body.name, level })?,
        alt: TEXT.say("view alt", values! { body: body.name })?,
        fallback: body.name.into(),
        z_up: true,
        sliders: vec![Slider::new("denoiser", names)],
        start: vec![own.unwrap_or_default()],
        color: Some("normal error".into()),
        panels: vec![
            facts(Panel::still("noisy input", noisy), std::slice::from_ref(noisy))?,
            facts(moving, results)?,
            Panel::still("truth", truth),
        ],
        from: Some(0),
        truth: Some(truth.positions().to_vec()),
    })
}

/// A family as the text calls its body.
fn called(family: &str) -> &str {
    match family {
        "fluted" => "fluted column",
        other => other,
    }
}

/// The model at the highest level: noisy, and after every method.
fn picture(body: &Body, restored: &[TriMesh]) -> Result<Picture> {
    let half = restored.len().div_ceil(2);
    let mut errors = vec![];
    for (method, mesh) in methods().zip(restored).skip(1) {
        errors.push((method.name(), normal_error(mesh, &body.truth)?.mean));
    }
    let names: Vec<&str> = methods().map(Method::name).collect();
    let row = |range: std::ops::Range<usize>| Row {
        title: String::new(),
        frame: &body.truth,
        meshes: restored[range.clone()].iter().collect(),
        titles: names[range].iter().map(ToString::to_string).collect(),
    };
    let name = called(body.name);
    Grid {
        rows: vec![row(0..half), row(half..restored.len())],
        viewpoint: VIEWPOINTS[0],
        up: Up::Z,
        aspect: 1.0,
    }
    .draw(
        body.name,
        &TEXT.say("figure body", values! { best: seen::best_and_worst(&errors)?, body: name })?,
        &TEXT.say("figure body alt", values! { body: name, count: restored.len() - 1 })?,
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One case of the benchmark in which a published default is better is enough to qualify the
    /// claim, however good the results of this section are.
    #[test]
    fn a_case_that_a_default_wins_counts() {
        let mut best = Table::new(
            "best",
            "B.",
            &[
                ("mesh", Unit::Label),
                ("its normal error", Unit::Degrees),
                ("automatic", Unit::Degrees),
            ],
        );
        best.push(row!["bolt, 0.1 h", 4.0, 3.0]);
        let with = |worse: usize| {
            let columns = [("compared", Unit::Count), ("worse than a default", Unit::Count)];
            let mut sets = Table::new("sets", "S.", &columns);
            sets.push(row![60usize, worse]);
            sets.push(row![40usize, 0usize]);
            at_defaults(Tables(&[best.clone(), sets])).unwrap()
        };
        assert_eq!(with(0).verdict, Verdict::Confirmed);
        let some = with(3);
        assert_eq!(some.verdict, Verdict::Qualified);
        assert!(some.finding.contains("3 of the 100 cases"), "{}", some.finding);
        let alone = at_defaults(Tables(&[best.clone()])).unwrap();
        assert_eq!(alone.verdict, Verdict::Confirmed);
        assert!(!alone.finding.contains("benchmark"), "{}", alone.finding);
        // A pair of this run is counted separately, also if the denoiser is not the best on it.
        best.push(row!["noisy machine part", 4.0, 6.0]);
        let with_known = at_defaults(Tables(&[best])).unwrap();
        assert_eq!(with_known.verdict, Verdict::Qualified);
        let text = with_known.finding;
        assert!(text.contains("all 1 generated") && text.contains("0 of the 1 pairs"), "{text}");
    }
}
