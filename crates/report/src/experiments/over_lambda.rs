//! A flow at several λ, in numbers, pictures, meshes and views, for questions 5 and 6.

use std::cmp::Ordering;

use anyhow::{Context as _, Result};
use fairing_figure::{Axis, Figure, Panel as FigurePanel, Plot, Series, Up};
use fairing_mesh::TriMesh;
use fairing_smoothing::{FlowError, Smoothed};
use glam::DVec3;
use rayon::prelude::*;

use super::gallery::{Gallery, Look, VIEWPOINTS, plotted};
use super::models::{COLUMNS, CREASES, Measures, Model, POINT, SAMPLES, slug};
use super::statistics::least;
use crate::experiment::Context;
use crate::experiment::inputs::Input;
use crate::experiment::outcome::{MeshOutput, Outcome, Picture};
use crate::model::table::{Table, Tolerance, Unit, brief};
use crate::model::view::{Panel, Slider, View};
use crate::row;

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

    /// Both in a sentence, each with its error.
    pub(super) fn words(&self, iterations: usize) -> String {
        let [a, b] = self.surface;
        let [c, d] = self.normals;
        format!(
            "After {iterations} steps the surface error is least at λ = {} on the patch ({} h) and {} on the machine part ({} h), the normal error at {} ({}°) and {} ({}°).",
            brief(a.lambda),
            brief(a.error),
            brief(b.lambda),
            brief(b.error),
            brief(c.lambda),
            brief(c.error),
            brief(d.lambda),
            brief(d.error),
        )
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
        ("weights", "uniform; boundaries free".into()),
    ]
}

/// Effect visible in the plots of both questions, from the best λ by both errors.
pub(super) fn seen_in_plot(best: &Favourites) -> String {
    let of = |(normals, surface): (&Best, &Best)| normals.lambda.total_cmp(&surface.lambda);
    let orders: Vec<Ordering> = best.normals.iter().zip(&best.surface).map(of).collect();
    let words = |order: Ordering| match order {
        Ordering::Greater => "at longer steps than the surface error",
        Ordering::Less => "at shorter steps than the surface error",
        Ordering::Equal => "at the same step as the surface error",
    };
    let first = if orders[0] == orders[1] {
        format!("On both meshes the normal error is smallest {}", words(orders[0]))
    } else {
        format!(
            "On the patch the normal error is smallest {}, on the machine part {}",
            words(orders[0]),
            words(orders[1])
        )
    };
    let end = if best.normals[0].is_last {
        "; on the patch it falls up to the last step, because normals do not see a mesh shrink"
    } else {
        ""
    };
    format!("{first}{end}.")
}

/// The style of implicit steps in plots.
pub(super) const IMPLICIT: usize = 0;
/// The style of explicit steps.
pub(super) const EXPLICIT: usize = 1;

/// Errors over λ, by normals and by the distance of the surfaces, in the colour of a method.
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
            let errors = rows.rows.iter().map(|row| row[errors].number());
            let points = rows.column("lambda")?.into_iter().zip(errors);
            let points = points.filter_map(|(x, y)| Some([x, y?])).collect();
            let style = Some(method + Series::COLORS * k);
            plot.series.push(Series { style, ..Series::marked(mesh, points) });
        }
        figure.panels.push(FigurePanel::drawing(plot.draw(450.0, 205.0)?));
    }
    let picture =
        plotted(&figure, "sweep", caption, "Two plots of error over λ on logarithmic axes.")?;
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
        let caption = format!(
            "After {iterations} {kind} steps. λ = 0 is the input; volume and area are compared with the truth. The vertex error is the mean distance of the vertices from the true surface, the surface error the mean of this distance and of that from the truth back to the mesh, each at up to {SAMPLES} vertices; the second shows that a patch has shrunk. The CSV also has the vertex error, precision and recall of the creases, displacements, and the growth of the diagonal."
        );
        let mut table = Table::new("flows", &caption, &columns)
            .aside(&["vertex error", "crease precision", "crease recall"])
            .aside(&["displacement", "largest displacement", "growth"])
            // What has diverged is mostly its roughest mode, what has collapsed is a point:
            // rounding has its say.
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
                outcome.meshes.push(MeshOutput {
                    id: format!("{}-{}", model.slug(), slug(&lambda.to_string())),
                    caption: format!(
                        "The {} after {iterations} {kind} steps with λ = {lambda}.",
                        model.name
                    ),
                    mesh,
                    fields: vec![],
                });
            }
        }
        Ok(table)
    }

    /// The figures of the original report that show the same, as a sentence.
    fn counterpart(&self, mesh: &str) -> &'static str {
        match (self.kind, mesh) {
            ("explicit", "patch") => " Counterpart of Figures 5 to 7 of the original report.",
            ("explicit", "machine part") => {
                " Counterpart of Figures 8 and 9 of the original report."
            }
            ("implicit", "patch" | "machine part") => {
                " Counterpart of Figure 10 of the original report."
            }
            _ => "",
        }
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
        let caption = format!(
            "{} The {} before and after {iterations} {kind} steps, from two viewpoints{}.{}",
            seen(model.name, lambdas, measured),
            model.name,
            if scaled { "; a title in brackets gives the scale of its picture" } else { "" },
            self.counterpart(model.name)
        );
        let alt = format!(
            "{} pictures of the {}: the input and {} steps, from two sides.",
            VIEWPOINTS.len() * shown.len(),
            model.name,
            shown.len() - 1
        );
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
        let left_out =
            if viewed < lambdas.len() { " (the view leaves out what diverges)" } else { "" };
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
            caption: format!(
                "{} The {} before and after {kind} steps, over λ and their number{left_out}.{} The page smooths the input itself, too: explicit beside implicit steps of any λ, at equal diffusion time.",
                seen(model.name, &lambdas[..viewed], &measured[..=viewed]),
                model.name,
                self.counterpart(model.name)
            ),
            alt: format!("The {} twice, to turn, with sliders over λ and iterations.", model.name),
            fallback: model.slug(),
            color: None,
            z_up: true,
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

/// Meshes in columns, from the two viewpoints in rows.
pub(super) fn side_by_side(
    model: &Model,
    id: &str,
    shown: &[(String, TriMesh)],
    caption: &str,
    alt: &str,
) -> Result<Picture> {
    let looks = shown.iter().map(|(title, mesh)| Look { title, mesh, coloring: None }).collect();
    let gallery = Gallery {
        looks,
        viewpoints: &VIEWPOINTS,
        up: Up::Z,
        aspect: 1.0,
        occlusion: model.occlusion,
    };
    gallery.draw(id, caption, alt)
}

/// Beyond this growth of the diagonal a mesh is said to diverge.
pub(super) const DIVERGED: f64 = 2.0;
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

/// Creases whose F-score is below this are lost.
const LOST: f64 = 0.5;

/// A loss of area above this is visible, in percent.
const SHRUNK: f64 = 20.0;

/// A change of area below this leaves nothing to see, in percent.
const VANISHED: f64 = -99.5;

/// The effect visible in pictures of a mesh after steps of these λ, from what was measured on the
/// input and after each of them.
fn seen(name: &str, lambdas: &[f64], measured: &[Measures]) -> String {
    let Some((input, after)) = measured.split_first() else { return String::new() };
    let runs = || lambdas.iter().copied().zip(after);
    let points: Vec<f64> = runs().filter(|r| r.1.growth < POINT).map(|r| r.0).collect();
    let shapes: Vec<(f64, &Measures)> =
        runs().filter(|r| (POINT..=DIVERGED).contains(&r.1.growth)).collect();
    let mut sentences = vec![];
    let normal = |m: &Measures| m.normal.unwrap_or(f64::INFINITY);
    let noise = normal(input);
    let smoothest = shapes.iter().min_by(|a, b| normal(a.1).total_cmp(&normal(b.1)));
    match smoothest {
        Some((lambda, m)) if (NOISY..f64::INFINITY).contains(&noise) && normal(m) < noise => {
            sentences.push(format!(
                "Among these λ, {} leaves the smallest normal error, {}° instead of {}°.",
                brief(*lambda),
                brief(normal(m)),
                brief(noise)
            ));
        }
        _ if noise < NOISY => sentences.push(format!("The {name} has no noise to lose.")),
        _ => {
            let noise = brief(noise);
            sentences
                .push(format!("No λ brings the normal error below {noise}°, that of the input."));
        }
    }
    let has_creases = |m: &Measures| m.creases[0].is_none_or(|score| score >= LOST);
    let kept = shapes.iter().rposition(|(_, m)| has_creases(m)).map_or(0, |last| last + 1);
    if let Some((lambda, _)) = shapes.get(kept).filter(|_| kept > 0) {
        sentences.push(format!("From λ = {} on its creases are lost.", brief(*lambda)));
    }
    let area = |m: &Measures| m.area.unwrap_or(0.0);
    if let Some((lambda, m)) = shapes.last().filter(|(_, m)| area(m) < -SHRUNK) {
        let words = if area(m) < VANISHED {
            "all but vanished".to_string()
        } else {
            format!("shrunk by {} %", brief(-area(m)))
        };
        sentences.push(format!("At λ = {} its area has {words}.", brief(*lambda)));
    }
    if let [first, others @ ..] = &points[..] {
        let more = if others.is_empty() { "" } else { " and more" };
        sentences
            .push(format!("At λ = {}{more} it is a point, with nothing to draw.", brief(*first)));
    }
    if let Some((lambda, m)) = runs().find(|r| r.1.growth > DIVERGED) {
        let line = if area(m) < 0.0 { " into a line, with nothing to draw" } else { "" };
        sentences.push(format!("At λ = {} it explodes{line}.", brief(lambda)));
    }
    sentences.join(" ")
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
        let text = |normals: [Best; 2]| seen_in_plot(&Favourites { surface, normals });
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
        let text = seen("part", &[0.1, 1.0, 2.0], &[SHAPE, smooth, round, exploded]);
        let expected = [
            "Among these λ, 0.1 leaves the smallest normal error, 5° instead of 20°.",
            "From λ = 1 on its creases are lost.",
            "At λ = 2 it explodes.",
        ];
        assert_eq!(text, expected.join(" "));
        assert!(!seen("part", &[0.1, 1.0], &[SHAPE, smooth, round]).contains("explodes"));
        let worse = Measures { normal: Some(30.0), ..SHAPE };
        let text = seen("part", &[1.0], &[SHAPE, worse]);
        assert_eq!(text, "No λ brings the normal error below 20°, that of the input.");
        let clean = Measures { normal: Some(0.0), ..SHAPE };
        let shrunk = Measures { area: Some(-60.0), growth: 0.5, ..SHAPE };
        let text = seen("cube", &[0.1, 1.0, 2.0], &[clean, shrunk, point, point]);
        let expected = [
            "The cube has no noise to lose.",
            "At λ = 0.1 its area has shrunk by 60 %.",
            "At λ = 1 and more it is a point, with nothing to draw.",
        ];
        assert_eq!(text, expected.join(" "));
    }
}
