//! A flow at several λ, in numbers, pictures, meshes and views, for questions 5 and 6.

use std::cmp::Ordering;

use anyhow::{Context as _, Result};
use fairing_figure::{Axis, Figure, Panel as FigurePanel, Plot, Series, Up, Viewpoint};
use fairing_mesh::TriMesh;
use fairing_smoothing::{FlowError, Smoothed};
use glam::DVec3;
use rayon::prelude::*;

use super::gallery::{Gallery, Look, VIEWPOINTS, plotted};
use super::models::{COLUMNS, CREASES, DIVERGED, FEATURE, Measures, Model, POINT, SAMPLES, slug};
use super::statistics::least;
use crate::experiment::Context;
use crate::experiment::inputs::Input;
use crate::experiment::outcome::{MeshOutput, Outcome, Picture};
use crate::experiment::text::{Text, values};
use crate::model::table::{Cell, Table, Tolerance, Unit, brief};
use crate::model::view::{Panel, Slider, View};
use crate::row;

/// The words of both questions.
static TEXT: Text = Text::new("over_lambda", include_str!("../../text/over_lambda.md"));

/// The numbers of steps that views show, up to those of the flow.
const VIEWED_STEPS: [usize; 1] = [10];

/// The columns of a sweep over λ.
pub(super) const SWEPT: [(&str, Unit); 8] = [
    ("mesh", Unit::Label),
    ("lambda", Unit::One),
    ("normal error", Unit::Degrees),
    ("vertex error", Unit::EdgeLengths),
    ("surface error", Unit::EdgeLengths),
    (CREASES, Unit::One),
    ("volume", Unit::Percent),
    ("area", Unit::Percent),
];

/// A flow over many λ: a row of [`SWEPT`] for each of them, on each model with a truth of its own.
pub(super) fn sweep(
    table: &mut Table,
    models: &[Model],
    lambdas: &[f64],
    run: impl Fn(&Model, f64) -> Result<Smoothed, FlowError> + Sync,
) -> Result<()> {
    for model in models.iter().filter(|m| m.name != "cube") {
        let measure = |&lambda: &f64| model.measure(&run(model, lambda)?.mesh);
        let measured: Vec<Measures> = lambdas.par_iter().map(measure).collect::<Result<_>>()?;
        for (lambda, m) in lambdas.iter().zip(measured) {
            table.push(row![
                model.name,
                *lambda,
                m.normal,
                m.vertex,
                m.surface,
                m.creases[0],
                m.volume,
                m.area,
            ]);
        }
    }
    Ok(())
}

/// The λ of a sweep with the least error of a kind.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Best {
    pub(super) lambda: f64,
    pub(super) error: f64,
    /// True at the largest λ at which there is an error: a longer step might do better.
    pub(super) is_last: bool,
}

impl Best {
    /// The least error in this column. Meshes that are points have no normals and are passed over.
    pub(super) fn of(sweep: &Table, mesh: &str, column: &str) -> Result<Self> {
        let rows = sweep.only(&[("mesh", mesh.into())])?;
        let errors = rows.index(column)?;
        let lambdas = rows.column("lambda")?;
        let cells = rows.rows.iter().map(|row| row[errors].number());
        let pairs: Vec<(f64, f64)> =
            cells.zip(lambdas).filter_map(|(error, lambda)| Some((error?, lambda))).collect();
        let (error, lambda) = least(&pairs).context("an empty sweep")?;
        Ok(Self { lambda, error, is_last: pairs.last().is_some_and(|last| last.1 == lambda) })
    }
}

/// The best λ of both meshes by both errors: the surface error is the criterion, since normals do
/// not see a mesh shrink.
pub(super) struct Favourites {
    /// On the patch and on the machine part, by the surface error.
    pub(super) surface: [Best; 2],
    /// The same by the normal error.
    pub(super) normals: [Best; 2],
}

/// The meshes of the sweeps.
pub(super) const SWEPT_MESHES: [&str; 2] = ["patch", "machine part"];

impl Favourites {
    pub(super) fn of(sweep: &Table) -> Result<Self> {
        let both = |column: &str| -> Result<[Best; 2]> {
            let [patch, part] = SWEPT_MESHES.map(|mesh| Best::of(sweep, mesh, column));
            Ok([patch?, part?])
        };
        Ok(Self { surface: both("surface error")?, normals: both("normal error")? })
    }
}

/// The meshes of both questions.
pub(super) const INPUTS: &[Input] =
    &[Input::NoisyPlane, Input::NoisyFandisk, Input::Fandisk, Input::Cube];

/// The parameters of both questions.
pub(super) fn parameters(lambdas: &[f64], iterations: usize) -> Vec<(&'static str, String)> {
    let lambdas: Vec<String> = lambdas.iter().map(f64::to_string).collect();
    vec![
        ("λ", lambdas.join(", ")),
        ("iterations", iterations.to_string()),
        ("weights", TEXT.words("weights", &[])),
    ]
}

/// Effect visible in the plots of both questions, from the best λ by both errors.
pub(super) fn seen_in_plot(best: &Favourites) -> Result<String> {
    let of = |(normals, surface): (&Best, &Best)| normals.lambda.total_cmp(&surface.lambda);
    let orders: Vec<Ordering> = best.normals.iter().zip(&best.surface).map(of).collect();
    let words = |order: Ordering| match order {
        Ordering::Greater => TEXT.say("longer", &[]),
        Ordering::Less => TEXT.say("shorter", &[]),
        Ordering::Equal => TEXT.say("same", &[]),
    };
    let (patch, part) = (words(orders[0])?, words(orders[1])?);
    let heading = if orders[0] == orders[1] { "plot of both" } else { "plot of each" };
    let end = if best.normals[0].is_last { "falls to the end" } else { "ends" };
    TEXT.say(heading, values! { patch, part, end: TEXT.say(end, &[])? })
}

/// The style of implicit steps in plots.
pub(super) const IMPLICIT: usize = 0;
/// The style of explicit steps.
pub(super) const EXPLICIT: usize = 1;

/// Errors over λ, by normals and by the distance of the surfaces; the first mesh has the colour of
/// the method.
pub(super) fn plot(sweep: &Table, method: usize, caption: &str) -> Result<Picture> {
    let mut figure = Figure { columns: 2, ..Figure::default() };
    for (column, unit) in [("normal error", "degrees"), ("surface error", "h")] {
        let mut plot =
            Plot {
                title: column.into(), x: Axis::log("λ"), y: Axis::log(unit), ..Plot::default()
            };
        for (k, mesh) in SWEPT_MESHES.into_iter().enumerate() {
            let rows = sweep.only(&[("mesh", mesh.into())])?;
            let errors = rows.index(column)?;
            let area = rows.index("area")?;
            // Without area there is no shape, and normals are rounding.
            let is_left = |row: &&Vec<Cell>| row[area].number().is_none_or(|a| a >= VANISHED);
            let errors = rows.rows.iter().map(|row| row[errors].number().filter(|_| is_left(&row)));
            let points = rows.column("lambda")?.into_iter().zip(errors);
            let points = points.filter_map(|(x, y)| Some([x, y?])).collect();
            let style = Some(method + (Series::COLORS + 2) * k);
            plot.series.push(Series { style, ..Series::marked(mesh, points) });
        }
        figure.panels.push(FigurePanel::drawing(plot.draw(450.0, 205.0)?));
    }
    let picture = plotted(&figure, "sweep", caption, &TEXT.say("plot alt", &[])?)?;
    Ok(SWEPT_MESHES.iter().fold(picture, |picture, mesh| {
        picture.linked("", mesh, &format!("{}-view", slug(mesh)), "λ")
    }))
}

/// One flow at several λ.
pub(super) struct OverLambda<'a> {
    /// `explicit` or `implicit`.
    pub(super) kind: &'static str,
    pub(super) lambdas: &'a [f64],
    /// Steps at each λ.
    pub(super) iterations: usize,
    /// Number of λ shown by the views: a diverging flow cannot be shown beside the others.
    pub(super) viewed: usize,
    /// The flow.
    pub(super) run: fn(&Model, f64, usize) -> Result<Smoothed, FlowError>,
}

impl OverLambda<'_> {
    /// Runs the flow on all models: fills in figures, views and meshes, and returns the table.
    pub(super) fn measure(
        &self,
        context: &Context<'_>,
        models: &[Model],
        outcome: &mut Outcome,
    ) -> Result<Table> {
        let Self { kind, lambdas, iterations, .. } = *self;
        let columns: Vec<(&str, Unit)> =
            [("mesh", Unit::Label), ("lambda", Unit::One)].into_iter().chain(COLUMNS).collect();
        let values = values! { iterations, kind, samples: SAMPLES };
        let caption = TEXT.say("table flows", values)?;
        let mut table = Table::new("flows", &caption, &columns)
            .aside(&["vertex error", "crease precision", "crease recall"])
            .aside(&["displacement", "largest displacement", "growth"])
            // A diverged mesh is mostly its roughest mode, and a collapsed one is a point: rounding
            // affects the numbers.
            .tolerance("normal error", Some(Tolerance::LOOSE));
        for (i, model) in models.iter().enumerate() {
            context.progress(0.15 * i as f64, model.name);
            let run = |&lambda: &f64| Ok((self.run)(model, lambda, iterations)?.mesh);
            let after: Vec<TriMesh> = lambdas.par_iter().map(run).collect::<Result<_>>()?;
            let smoothed: Vec<TriMesh> = [model.noisy.clone()].into_iter().chain(after).collect();
            let with_input = || [0.0].into_iter().chain(lambdas.iter().copied());
            let measured: Vec<Measures> =
                smoothed.par_iter().map(|mesh| model.measure(mesh)).collect::<Result<_>>()?;
            for (lambda, measures) in with_input().zip(&measured) {
                let leading = row![model.name, lambda];
                table.push(leading.into_iter().chain(measures.cells()));
            }
            outcome.figures.push(self.picture(model, &smoothed, &measured)?);
            outcome.views.push(self.view(model, &smoothed, &measured)?);
            for (lambda, mesh) in with_input().zip(smoothed).skip(1) {
                let values = values! { name: model.name, iterations, kind, lambda };
                outcome.meshes.push(MeshOutput {
                    id: format!("{}-{}", model.slug(), slug(&lambda.to_string())),
                    caption: TEXT.say("mesh", values)?,
                    mesh,
                    fields: vec![],
                });
            }
        }
        Ok(table)
    }

    /// The figures of the original report that show the same, in brackets; empty without any.
    fn counterpart(&self, mesh: &str) -> Result<String> {
        let heading = match (self.kind, mesh) {
            ("explicit", "patch") => "counterpart of explicit patch",
            ("explicit", "machine part") => "counterpart of explicit machine part",
            ("implicit", "patch" | "machine part") => "counterpart of implicit",
            _ => return Ok(String::new()),
        };
        Ok(format!(" {}", TEXT.say(heading, &[])?))
    }

    /// The input and the results from two viewpoints; what has diverged or shrunk is scaled to fit.
    fn picture(
        &self,
        model: &Model,
        smoothed: &[TriMesh],
        measured: &[Measures],
    ) -> Result<Picture> {
        let Self { kind, lambdas, iterations, .. } = *self;
        let titles =
            ["input".to_string()].into_iter().chain(lambdas.iter().map(|l| format!("λ = {l}")));
        let mut shown = vec![];
        for (title, mesh) in titles.zip(smoothed) {
            if let Some((mesh, scale)) = drawn(mesh, &model.noisy)? {
                shown.push((title + &scale, mesh));
            }
        }
        let scaled = shown.iter().any(|(title, _)| title.contains('('));
        let values = values! {
            name: model.name, iterations, kind,
            scaled: if scaled { TEXT.say("scaled", &[])? } else { String::new() },
            counterpart: self.counterpart(model.name)?,
            seen: seen(model.name, lambdas, measured)?,
        };
        let caption = TEXT.say("figure", values)?;
        let count = VIEWPOINTS.len() * shown.len();
        let values = values! { count, name: model.name, steps: shown.len() - 1 };
        let alt = TEXT.say("figure alt", values)?;
        side_by_side(model, &model.slug(), &shown, &caption, &alt)
    }

    /// The initial stops of the sliders: the middle λ, and the largest number of steps after which
    /// the mesh has a third of its size; the least of both if there is none.
    fn start(&self, model: &Model, counts: &[usize], stops: &[(TriMesh, Measures)]) -> Vec<usize> {
        let middle = self.viewed / 2;
        let is_seen = |&count: &usize| {
            let (mesh, _) = &stops[middle * counts.len() + count];
            3.0 * mesh.diagonal() > model.noisy.diagonal()
        };
        match (0..counts.len()).rev().find(is_seen) {
            Some(count) => vec![middle, count],
            None => vec![0, 0],
        }
    }

    /// The input, which the page can smooth, beside the flow at each λ on its way.
    fn view(&self, model: &Model, smoothed: &[TriMesh], measured: &[Measures]) -> Result<View> {
        let Self { kind, lambdas, iterations, viewed, .. } = *self;
        let left_out = if viewed < lambdas.len() { "left out" } else { "nothing left out" };
        let values = values! {
            name: model.name, kind, left_out: TEXT.say(left_out, &[])?,
            counterpart: self.counterpart(model.name)?,
            seen: seen(model.name, &lambdas[..viewed], &measured[..=viewed])?,
        };
        let counts: Vec<usize> =
            VIEWED_STEPS.into_iter().filter(|&n| n < iterations).chain([iterations]).collect();
        let mut stops: Vec<(TriMesh, Measures)> = vec![];
        for (k, &lambda) in lambdas[..viewed].iter().enumerate() {
            for &count in &counts[..counts.len() - 1] {
                let mesh = (self.run)(model, lambda, count)?.mesh;
                let measures = model.measure(&mesh)?;
                stops.push((mesh, measures));
            }
            stops.push((smoothed[k + 1].clone(), measured[k + 1]));
        }
        let of_stops: Vec<Measures> = stops.iter().map(|(_, measures)| *measures).collect();
        let input = Panel::still("input", &model.noisy).with_live_smoothing();
        let moving = stops.iter().map(|(mesh, _)| mesh.positions());
        Ok(View {
            id: format!("{}-view", model.slug()),
            mesh: model.name.into(),
            caption: TEXT.say("view", values)?,
            alt: TEXT.say("view alt", values)?,
            fallback: model.slug(),
            color: None,
            z_up: directions(&model.noisy).0 == Up::Z,
            sliders: vec![Slider::new("λ", &lambdas[..viewed]), Slider::new("iterations", &counts)],
            start: self.start(model, &counts, &stops),
            panels: vec![
                with_facts(input, &measured[..1]),
                with_facts(Panel::moving(kind, &model.noisy, moving), &of_stops),
            ],
            from: Some(0),
            truth: Some(model.truth.positions().to_vec()),
        })
    }
}

/// A panel with what was measured at each of its stops.
fn with_facts(panel: Panel, measures: &[Measures]) -> Panel {
    let of = |f: fn(&Measures) -> Option<f64>| measures.iter().map(f).collect();
    let percent = |m: &Measures| m.creases[0].map(|score| 100.0 * score);
    panel
        .with_fact("normal error", "°", of(|m| m.normal))
        .with_fact("volume", "%", of(|m| m.volume))
        .with_fact(CREASES, "%", of(percent))
}

/// Below this share of its diagonal along z a mesh is nearly flat.
const FLAT: f64 = 0.05;

/// Viewpoints, with y up, from which the light of the camera grazes the xy-plane, so that noise is
/// seen.
const GRAZED: [Viewpoint; 2] = [
    Viewpoint::Angles { azimuth: -30.0, elevation: 20.0 },
    Viewpoint::Angles { azimuth: 25.0, elevation: 40.0 },
];

/// The axis that points upward in pictures of a mesh, and their viewpoints.
fn directions(mesh: &TriMesh) -> (Up, &'static [Viewpoint; 2]) {
    let height = mesh.bounding_box().map_or(0.0, |[low, high]| high[2] - low[2]);
    if height < FLAT * mesh.diagonal() { (Up::Y, &GRAZED) } else { (Up::Z, &VIEWPOINTS) }
}

/// Meshes in columns, from two viewpoints in rows.
pub(super) fn side_by_side(
    model: &Model,
    id: &str,
    shown: &[(String, TriMesh)],
    caption: &str,
    alt: &str,
) -> Result<Picture> {
    let looks = shown.iter().map(|(title, mesh)| Look { title, mesh, coloring: None }).collect();
    let (up, viewpoints) = directions(&model.noisy);
    let gallery = Gallery { looks, viewpoints, up, aspect: 1.0, occlusion: model.occlusion };
    gallery.draw(id, caption, alt)
}

/// Below this share of its diagonal a mesh is drawn enlarged.
const SMALL: f64 = 0.15;
/// Below this share of the squared diagonal there is no area to be seen.
const LINE: f64 = 1e-3;

/// A smoothed mesh as drawn beside its input, and the scale for its title: meshes that have
/// diverged or shrunk are drawn at the size of the input. `None` if no surface is left to draw.
fn drawn(mesh: &TriMesh, input: &TriMesh) -> Result<Option<(TriMesh, String)>> {
    let growth = mesh.diagonal() / input.diagonal();
    let area: f64 = (0..mesh.face_count()).map(|f| DVec3::from(mesh.area_vector(f)).length()).sum();
    if growth < POINT || area < LINE * mesh.diagonal().powi(2) {
        return Ok(None);
    }
    if (SMALL..=DIVERGED).contains(&growth) {
        return Ok(Some((mesh.clone(), String::new())));
    }
    let title = if growth > 1.0 {
        format!(" (1 : {})", brief(growth))
    } else {
        format!(" (×{})", brief((1.0 / growth).round()))
    };
    Ok(Some((fitted(mesh, input)?, title)))
}

/// A normal error above this is visible noise, in degrees.
const NOISY: f64 = 1.0;

/// Creases of which a smaller share is found are lost.
const LOST: f64 = 0.5;

/// A loss of area above this is visible, in percent.
const SHRUNK: f64 = 20.0;

/// A change of area below this leaves nothing to see, in percent.
const VANISHED: f64 = -99.5;

/// The effect visible in pictures of a mesh after steps of these λ, from what was measured on the
/// input and after each of them: a sentence.
fn seen(name: &str, lambdas: &[f64], measured: &[Measures]) -> Result<String> {
    let Some((input, after)) = measured.split_first() else { return Ok(String::new()) };
    let runs: Vec<(f64, &Measures)> = lambdas.iter().copied().zip(after).collect();
    let is_shape = |m: &Measures| (POINT..=DIVERGED).contains(&m.growth);
    let shapes: Vec<(f64, &Measures)> = runs.iter().copied().filter(|r| is_shape(r.1)).collect();
    let mut clauses = vec![smoothest(name, input, &shapes)?];
    clauses.extend(lost(&shapes)?);
    clauses.extend(not_drawn(&runs)?);
    Ok(format!("{}.", clauses.join("; ")))
}

/// The step with the smallest normal error, as the beginning of a sentence.
fn smoothest(name: &str, input: &Measures, shapes: &[(f64, &Measures)]) -> Result<String> {
    let normal = |m: &Measures| m.normal.unwrap_or(f64::INFINITY);
    let noise = normal(input);
    let best = shapes.iter().min_by(|a, b| normal(a.1).total_cmp(&normal(b.1)));
    match best {
        _ if noise < NOISY => TEXT.say("no noise", values! { name }),
        Some((lambda, m)) if noise.is_finite() && normal(m) < noise => {
            TEXT.say("smoothest", values! { lambda: *lambda, error: normal(m), noise })
        }
        _ => TEXT.say("never below", values! { noise }),
    }
}

/// From where on creases are lost, and the loss of area at the longest step, as clauses.
fn lost(shapes: &[(f64, &Measures)]) -> Result<Vec<String>> {
    let mut clauses = vec![];
    let has_creases = |m: &Measures| m.creases[2].is_none_or(|recall| recall >= LOST);
    let kept = shapes.iter().rposition(|(_, m)| has_creases(m)).map_or(0, |last| last + 1);
    if let Some((lambda, _)) = shapes.get(kept).filter(|_| kept > 0) {
        clauses.push(TEXT.say("creases lost", values! { lambda: *lambda, turn: FEATURE })?);
    }
    let area = |m: &Measures| m.area.unwrap_or(0.0);
    if let Some((lambda, m)) = shapes.last().filter(|(_, m)| area(m) < -SHRUNK) {
        let heading = if area(m) < VANISHED { "vanished" } else { "shrunk" };
        clauses.push(TEXT.say(heading, values! { lambda: *lambda, loss: -area(m) })?);
    }
    Ok(clauses)
}

/// Steps after which no surface is left to draw, as clauses.
fn not_drawn(runs: &[(f64, &Measures)]) -> Result<Vec<String>> {
    let mut clauses = vec![];
    let points: Vec<f64> = runs.iter().filter(|r| r.1.growth < POINT).map(|r| r.0).collect();
    if let [first, others @ ..] = &points[..] {
        let heading = if others.is_empty() { "point" } else { "points" };
        clauses.push(TEXT.say(heading, values! { lambda: *first })?);
    }
    if let Some((lambda, m)) = runs.iter().find(|r| r.1.growth > DIVERGED) {
        let heading = if m.area.unwrap_or(0.0) < 0.0 { "line" } else { "diverged" };
        clauses.push(TEXT.say(heading, values! { lambda: *lambda })?);
    }
    Ok(clauses)
}

/// The mesh scaled about its mean to the size of another, so that both fit in one picture.
fn fitted(mesh: &TriMesh, like: &TriMesh) -> Result<TriMesh> {
    let mean = |m: &TriMesh| {
        let sum: DVec3 = m.positions().iter().map(|&p| DVec3::from(p)).sum();
        sum * (1.0 / m.vertex_count() as f64)
    };
    let factor = like.diagonal() / mesh.diagonal();
    let (from, to) = (mean(mesh), mean(like));
    let moved =
        mesh.positions().iter().map(|&p| (to + factor * (DVec3::from(p) - from)).to_array());
    Ok(mesh.with_positions(moved.collect())?)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of a sweep whose error falls to a plateau, the first λ on it.
    #[test]
    fn the_best_lambda_is_the_first_of_equal_ones() {
        let mut sweep = Table::new("s", "S.", &SWEPT);
        for (lambda, error) in [(0.1, 2.0), (1.0, 1.0), (10.0, 1.0 - f64::EPSILON)] {
            sweep.push(row!["patch", lambda, 0.0, 0.0, error, 0.0, 0.0, 0.0]);
        }
        let best = Best::of(&sweep, "patch", "surface error").unwrap();
        assert_eq!((best.lambda, best.is_last), (1.0, false));
    }

    /// The caption of the plot compares the two minima of each mesh.
    #[test]
    fn the_caption_of_a_sweep_tells_the_meshes_apart() {
        let at = |lambda: f64, is_last: bool| Best { lambda, error: 1.0, is_last };
        let surface = [at(0.1, false); 2];
        let text = |normals: [Best; 2]| seen_in_plot(&Favourites { surface, normals }).unwrap();
        let both = text([at(1.0, false); 2]);
        assert_eq!(
            both,
            "On both meshes the normal error is smallest at longer steps than the surface error."
        );
        let one = text([at(1.0, true), at(0.1, false)]);
        assert!(one.contains("on the machine part at the same step as the surface error; on the"));
    }

    /// A mesh that has become a point has no normals; the longest step before it is the last.
    #[test]
    fn the_end_of_a_sweep_is_noticed() {
        let mut sweep = Table::new("s", "S.", &SWEPT);
        for (lambda, error) in [(0.1, Some(2.0)), (1.0, Some(1.0)), (10.0, None)] {
            sweep.push(row!["patch", lambda, error, 0.0, 1.0, 0.0, 0.0, 0.0]);
        }
        let best = Best::of(&sweep, "patch", "normal error").unwrap();
        assert_eq!(best, Best { lambda: 1.0, error: 1.0, is_last: true });
    }

    const SHAPE: Measures = Measures {
        normal: Some(20.0),
        vertex: 0.1,
        surface: 0.1,
        volume: Some(0.0),
        area: Some(0.0),
        creases: [Some(0.9); 3],
        rms: 0.0,
        largest: 0.0,
        inside: None,
        border: None,
        growth: 1.0,
    };

    /// A caption says only what was measured on its mesh: no noise on a cube without any, no
    /// explosion where none is shown, no loss of creases that are kept.
    #[test]
    fn captions_say_what_was_measured() {
        let smooth = Measures { normal: Some(5.0), ..SHAPE };
        let round = Measures { normal: Some(9.0), creases: [Some(0.1); 3], ..SHAPE };
        let exploded = Measures { growth: 1e12, ..SHAPE };
        let point = Measures { normal: None, creases: [None; 3], growth: 1e-12, ..SHAPE };
        let seen = |name: &str, lambdas: &[f64], measured: &[Measures]| {
            super::seen(name, lambdas, measured).unwrap()
        };
        let text = seen("part", &[0.1, 1.0, 2.0], &[SHAPE, smooth, round, exploded]);
        let expected = "The normal error is smallest at λ = 0.1, 5° instead of 20°; from λ = 1 on \
             most creases turn by less than 30°; at λ = 2 the mesh has diverged.";
        assert_eq!(text, expected);
        assert!(!seen("part", &[0.1, 1.0], &[SHAPE, smooth, round]).contains("diverged"));
        let worse = Measures { normal: Some(30.0), ..SHAPE };
        let text = seen("part", &[1.0], &[SHAPE, worse]);
        assert_eq!(text, "No λ brings the normal error below 20°, that of the input.");
        let clean = Measures { normal: Some(0.0), ..SHAPE };
        let shrunk = Measures { area: Some(-60.0), growth: 0.5, ..SHAPE };
        let text = seen("cube", &[0.1, 1.0, 2.0], &[clean, shrunk, point, point]);
        let expected = "The cube has no noise; at λ = 0.1 the area has shrunk by 60 %; from λ = 1 \
             on the mesh has collapsed to a point and is not drawn.";
        assert_eq!(text, expected);
    }
}
