//! All denoisers on the meshes of the literature, by its protocol.

use std::time::Instant;

use anyhow::{Context as _, Result};
use fairing_denoising::{AutomaticOptions, Denoiser};
use fairing_evaluation::{NoiseKind, NoiseLevel, add_noise, drift, feature_edges, normal_error};
use fairing_figure::{Axis, Figure, Panel as FigurePanel, Plot, Series, Up};
use fairing_mesh::TriMesh;
use fairing_mesh::io::{self, ReadOptions};
use fairing_sparse::larger;

use super::families;
use super::gallery::{VIEWPOINTS, plotted};
use super::grid::{Grid, Row};
use super::models::{CREASES, FEATURE};
use super::restoring::{Body, Method};
use super::seen;
use crate::experiment::inputs::Input;
use crate::experiment::outcome::{Outcome, Picture};
use crate::experiment::{Card, Context, Experiment};
use crate::model::section::{Act, Section};
use crate::model::table::{Cell, Table, Tables, Tolerance, Unit, brief};
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

/// The generated meshes: with creases, smooth, detailed. They are of families on which no result
/// was known when the automatic denoiser was trained and its constants chosen.
const GENERATED: [(&str, &[u8]); 3] = [
    ("bolt", include_bytes!("../../../../data/bolt.ply")),
    ("vase", include_bytes!("../../../../data/vase.ply")),
    ("fluted", include_bytes!("../../../../data/fluted.ply")),
];

/// A quick run leaves out noisy meshes of more faces than this.
const LARGE: usize = 10_000;

/// The section of the article.
fn section() -> Section {
    Section::new(
        Act::Diffusion,
        "Flows smooth creases as well as noise. Denoisers filter normals instead of positions; this \
                last section compares them.",
    )
    .commands(&["fairing denoise noisy.ply -o restored.ply  # no parameters", "fairing denoise noisy.ply -o guided.ply --method guided-normal", "fairing compare restored.ply truth.ply"])
    .edge_lengths_of("the mesh without noise, the truth")
    .sources(&["fleishman2003", "jones2003", "sun2007", "zheng2011", "he2013", "zhang2015", "zhang2015variational", "liu2021", "wang2016"])
    .shows(&["averages"], &[])
    .names(&[("bolt-view", "the bolt, to turn"), ("ratios", "all cases of the benchmark"), ("bolt", "the bolt after every denoiser"), ("vase", "the vase after every denoiser"), ("fluted", "the fluted column after every denoiser"), ("best", "the best published denoiser on each mesh"), ("scores", "each denoiser on each mesh"), ("families", "the families of the benchmark"), ("sets", "the sets of families"), ("lost", "the five worst cases of each set")])
    .playground(
        "denoising",
        "The filter of normals keeps the creases that diffusion rounds off; once the noise is more than about a third \
            of an edge, diffusion is the better of the two. The colours are the angles between the normals and the true \
            ones. The filter is the local bilateral one of Zheng et al. (2011), diffusion has uniform weights. Drag the \
            noise: the numbers under the panels update as you drag.",
        "A turned part three times: noisy, after diffusion, and after a filter of normals, with its errors as numbers.",
    )
}

impl Experiment for Denoisers {
    fn card(&self) -> Card {
        let [low, middle, high] = LEVELS;
        Card {
            id: "denoisers",
            title: "Denoisers compared",
            question: "Which denoiser restores which kind of surface best, with no parameter chosen by hand?".into(),
            method: format!(
                "Every denoiser runs with its default parameters; the automatic one has none. It consists of networks trained on generated meshes: models of twelve families, blocks, creatures, tori and three other simple shapes, and random models. The published methods are implementations of our own, after the papers named below. The meshes of this section are a bolt with creases, a smooth vase and a fluted column with details, all three of families on which nothing was trained or chosen; they have Gaussian noise along the normals of {low}, {middle} and {high} mean edge lengths.\n\nWhere they are found, the noisy machine part of the assignment and the pairs of the literature are added: they were not trained on, but results on them were known while the denoiser was made. Errors are measured as in q7. The benchmark has generated meshes of 34 families with seven combinations of noise and triangulation each. Weights and constants of the automatic denoiser are chosen on the twelve families of the development set. The twelve unseen families were not trained on, but their results were known while the kinds of random models for training were designed. On the ten fresh ones nothing was trained or chosen, either; results of earlier networks on them were known. In each case the normal error of the automatic denoiser is compared with the least that any of eight published methods leaves when its parameters are chosen with the truth."
            ),
            formulas: vec![],
            section: section(),
            inputs: INPUTS,
            parameters: vec![
                ("parameters of the denoisers", "defaults".into()),
                ("levels", LEVELS.map(|l| format!("{l} h")).join(", ")),
            ],
        }
    }

    fn run(&self, context: &Context<'_>) -> Result<Outcome> {
        let mut outcome = Outcome::default();
        let mut scores = scores_table();
        literature(context, &mut scores, &mut outcome)?;
        let read = |(name, bytes): (&'static str, &[u8])| {
            Body::new(name, io::read_bytes(name, bytes, &ReadOptions::default())?.mesh)
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
                    outcome.figures.push(picture(body, &restored)?);
                    let own = scores.value(&own(&label(body.name, level)), "normal error")?;
                    automatic.push((body.name, own));
                    if b == 0 {
                        outcome.views.push(view(body, level, &restored)?);
                    }
                }
            }
        }
        outcome.figures.insert(0, averages(&scores, levels)?);
        outcome.tables = vec![best(&scores)?, scores];
        families::add(&automatic, &mut outcome)?;
        Ok(outcome)
    }

    fn judge(&self, tables: Tables<'_>) -> Result<Vec<Judgement>> {
        let mut judgements: Vec<Judgement> = families::judge(tables)?.into_iter().collect();
        judgements.push(at_defaults(tables)?);
        Ok(judgements)
    }
}

/// Judges the automatic denoiser beside published ones at their default parameters: on the
/// generated meshes of the section, on which nothing was trained or chosen, and on the whole
/// benchmark where its results are there. Meshes of which results were known are counted apart.
fn at_defaults(tables: Tables<'_>) -> Result<Judgement> {
    let best = tables.get("best")?;
    let (least, own) = (best.column("its normal error")?, best.column("automatic")?);
    let names = best.labels("mesh")?;
    let ratios = || names.iter().zip(own.iter().zip(&least).map(|(own, least)| own / least));
    let is_fresh = |name: &str| GENERATED.iter().any(|(body, _)| name.starts_with(body));
    let of = |fresh: bool| ratios().filter(move |(name, _)| is_fresh(name) == fresh).map(|r| r.1);
    let (fresh, known): (Vec<f64>, Vec<f64>) = (of(true).collect(), of(false).collect());
    let wins = |ratios: &[f64]| ratios.iter().filter(|ratio| **ratio <= 1.0).count();
    let on = |ratios: &[f64]| match wins(ratios) {
        n if n == ratios.len() => format!("on all {n}"),
        n => format!("on {n} of the {}", ratios.len()),
    };
    let largest = |ratios: &[f64]| brief(ratios.iter().copied().fold(0.0, larger));
    let [cases, worse] = families::worse_than_defaults(tables)?;
    let lost = fresh.len() + known.len() - wins(&fresh) - wins(&known) + worse;
    let verdict = match (wins(&fresh), lost) {
        (0, _) => Verdict::Refuted,
        (_, 0) => Verdict::Confirmed,
        _ => Verdict::Qualified,
    };
    let mut text = format!(
        "It leaves a smaller normal error than each published method at its default parameters {} generated meshes of this section, on which nothing was trained or chosen; its error is at most {} times the smallest of theirs.",
        on(&fresh),
        largest(&fresh)
    );
    if !known.is_empty() {
        text += &format!(
            " It does so {} other meshes, at most {} times; results on these were known while it was made.",
            on(&known),
            largest(&known)
        );
    }
    if cases > 0 {
        text += &format!(
            " On {worse} of the {cases} cases of the benchmark a published method at its defaults does better."
        );
    }
    let claim = "One denoiser without parameters does as well as every published one at its default parameters";
    let mut judgement = Judgement::new("automatic", claim, verdict, text.clone())
        .finding(text)
        .ours()
        .shown(Shown::figure("denoisers", "averages"));
    if cases > 0 {
        let name = "benchmark cases in which a published default is better";
        judgement = judgement.number(name, worse as f64, Unit::Count);
    }
    let ratio = fresh.iter().copied().fold(0.0, larger);
    Ok(judgement.number("largest ratio to the best published, here", ratio, Unit::One))
}

fn scores_table() -> Table {
    let mut scores = Table::new(
        "scores",
        "Each denoiser on each mesh. Flipped faces oppose the truth; the time is that of one run.",
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
    scores.aside(&["faces"])
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
        outcome.notes.push(format!(
            "Pairs that were not found, and are left out: {names}. They are looked for in the folder of `--meshes`."
        ));
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
        "The normal error of each noisy mesh, of the best published method with its defaults, and of the automatic denoiser.",
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
    let to_see = match &shortest[..] {
        [one] => format!("Shorter bars are better: those of {one} are the shortest on each mesh."),
        several => {
            format!("Shorter bars are better; the shortest are those of {}.", several.join(", "))
        }
    };
    let mut figure = Figure::default();
    figure.panels.push(FigurePanel::drawing(plot.draw(900.0, 230.0)?));
    plotted(
        &figure,
        "averages",
        &format!(
            "{to_see} The mean normal error of each denoiser on three generated meshes that its training, if any, never saw, averaged over the levels of noise; the names of the meshes are beside the last group."
        ),
        "Groups of three bars for each denoiser, one for each kind of mesh.",
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
        caption: format!(
            "The brighter a place, the farther its normal is off. The numbers under the panels say what each denoiser costs in volume and in creases, whose F-score counts lost and false ones alike. The {} with noise of {level} h along its normals, after each denoiser with its defaults.",
            body.name
        ),
        alt: format!(
            "The {} with noise, denoised, and without noise, with a slider over denoisers.",
            body.name
        ),
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
    Grid {
        rows: vec![row(0..half), row(half..restored.len())],
        viewpoint: VIEWPOINTS[0],
        up: Up::Z,
        aspect: 1.0,
    }
    .draw(
        body.name,
        &format!("{} The {} at the highest level of noise, and after every denoiser with its defaults; flat shaded.", seen::best_and_worst(&errors), called(body.name)),
        &format!("Pictures of the {}, the noisy one and {} results.", called(body.name), restored.len() - 1),
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
        assert!(some.finding.contains("On 3 of the 100 cases"), "{}", some.finding);
        let alone = at_defaults(Tables(&[best.clone()])).unwrap();
        assert_eq!(alone.verdict, Verdict::Confirmed);
        assert!(!alone.finding.contains("benchmark"), "{}", alone.finding);
        // A mesh whose results were known is counted apart, and not passed over if it is lost.
        best.push(row!["noisy machine part", 4.0, 6.0]);
        let with_known = at_defaults(Tables(&[best])).unwrap();
        assert_eq!(with_known.verdict, Verdict::Qualified);
        let text = with_known.finding;
        assert!(
            text.contains("on all 1 generated") && text.contains("on 0 of the 1 other"),
            "{text}"
        );
    }
}
