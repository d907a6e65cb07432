//! A flow at several λ, in numbers, pictures, meshes and views, for questions 5 and 6.

use anyhow::{Context as _, Result};
use fairing_figure::{Axis, Figure, Legend, Panel as FigurePanel, Plot, Series, Up};
use fairing_mesh::TriMesh;
use fairing_smoothing::{FlowError, Smoothed};
use glam::DVec3;
use rayon::prelude::*;

use super::gallery::{Gallery, Look, VIEWPOINTS, plotted};
use super::models::{COLUMNS, Measures, Model, POINT, SAMPLES, slug};
use super::statistics::least;
use crate::experiment::Context;
use crate::inputs::Input;
use crate::outcome::{MeshOutput, Outcome, Picture};
use crate::row;
use crate::table::{Table, Tolerance, Unit, brief};
use crate::view::{Panel, Slider, View};

/// The numbers of steps that views show, up to those of the flow.
const VIEWED_STEPS: [usize; 1] = [10];

/// The columns of a sweep over λ.
pub(super) const SWEPT: [(&str, Unit); 7] = [
    ("mesh", Unit::Label),
    ("lambda", Unit::One),
    ("normal error", Unit::Degrees),
    ("vertex error", Unit::EdgeLengths),
    ("surface error", Unit::EdgeLengths),
    ("feature recall", Unit::One),
    ("volume", Unit::Percent),
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
            table
                .push(row![model.name, *lambda, m.normal, m.vertex, m.surface, m.recall, m.volume]);
        }
    }
    Ok(())
}

/// The λ of a sweep with the least error in this column.
pub(super) fn best_lambda(sweep: &Table, mesh: &str, column: &str) -> Result<f64> {
    let rows = sweep.only(&[("mesh", mesh.into())])?;
    let pairs: Vec<(f64, f64)> =
        rows.column(column)?.into_iter().zip(rows.column("lambda")?).collect();
    Ok(least(&pairs).context("an empty sweep")?.1)
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

/// Errors over λ, by normals and by the distance of the surfaces.
pub(super) fn plot(sweep: &Table, caption: &str) -> Result<Picture> {
    let mut figure = Figure { columns: 2, ..Figure::default() };
    for (column, unit) in [("normal error", "degrees"), ("surface error", "mean edge lengths")] {
        let mut plot = Plot {
            title: column.into(),
            x: Axis::log("λ"),
            y: Axis::log(unit),
            legend: Legend::Lines,
            ..Plot::default()
        };
        for mesh in ["patch", "machine part"] {
            let rows = sweep.only(&[("mesh", mesh.into())])?;
            let points = rows.column("lambda")?.into_iter().zip(rows.column(column)?);
            plot.series.push(Series::marked(mesh, points.map(|(x, y)| [x, y]).collect()));
        }
        figure.panels.push(FigurePanel::drawing(plot.draw(450.0, 230.0)?));
    }
    let picture =
        plotted(&figure, "sweep", caption, "Two plots of error over λ on logarithmic axes.")?;
    Ok(["patch", "machine part"].iter().fold(picture, |picture, mesh| {
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
            "After {iterations} {kind} steps; λ = 0 is the input, and volume and area are compared with the truth. The surface error is the root mean square of the distances from the vertices to the true surface and back, at up to {SAMPLES} vertices: the way back shows that a patch has shrunk. The CSV has the vertex error too, one way only, and the growth of the diagonal."
        );
        let mut table = Table::new("flows", &caption, &columns)
            .aside(&["vertex error", "displacement", "largest displacement", "growth"])
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
            outcome.figures.push(self.picture(model, &smoothed)?);
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

    /// The effect visible in the picture.
    fn to_see(&self) -> &'static str {
        match self.kind {
            "explicit" => "Noise goes first, then the creases; the longest steps make it explode.",
            _ => "No step explodes, but long ones shrink the whole shape, not its edges alone.",
        }
    }

    /// The figures of the original report that show the same.
    fn counterpart(&self, mesh: &str) -> &'static str {
        match (self.kind, mesh) {
            ("explicit", "patch") => " (Figures 5 to 7 of the original report)",
            ("explicit", "machine part") => " (Figures 8 and 9 of the original report)",
            ("implicit", "patch" | "machine part") => " (Figure 10 of the original report)",
            _ => "",
        }
    }

    /// The input and the results from two viewpoints; what has diverged or shrunk is scaled to fit.
    fn picture(&self, model: &Model, smoothed: &[TriMesh]) -> Result<Picture> {
        let Self { kind, lambdas, iterations, .. } = *self;
        let titles =
            ["input".to_string()].into_iter().chain(lambdas.iter().map(|l| format!("λ = {l}")));
        let mut shown = vec![];
        for (title, mesh) in titles.zip(smoothed) {
            let (mesh, scale) = drawn(mesh, &model.noisy)?;
            shown.push((title + &scale, mesh));
        }
        let caption = format!(
            "{} The {} before and after {iterations} {kind} steps{}, from two viewpoints; what has diverged or shrunk is drawn at the size of the input, as its title says.",
            self.to_see(),
            model.name,
            self.counterpart(model.name)
        );
        let alt = format!(
            "{} pictures of the {}: the input and {} steps, from two sides.",
            VIEWPOINTS.len() * shown.len(),
            model.name,
            lambdas.len()
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
        let left_out = if viewed < lambdas.len() { " (what diverges is left out)" } else { "" };
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
        let input = Panel::still("input", &model.noisy).with_live_smoothing(&model.noisy);
        let moving = stops.iter().map(|(mesh, _)| mesh.positions());
        Ok(View {
            id: format!("{}-view", model.slug()),
            mesh: model.name.into(),
            caption: format!(
                "{} The {} before and after {kind} steps{}, over λ and their number{left_out}. The page smooths the input itself, too: explicit beside implicit steps of any λ, at equal diffusion time.",
                self.to_see(),
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
    let percent = |m: &Measures| m.recall.map(|r| 100.0 * r);
    panel
        .with_fact("normal error", "°", of(|m| m.normal))
        .with_fact("volume", "%", of(|m| m.volume))
        .with_fact("creases kept", "%", of(percent))
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

/// A smoothed mesh as drawn beside its input, and a remark for its title: meshes that have diverged
/// or shrunk are drawn at the size of the input.
fn drawn(mesh: &TriMesh, input: &TriMesh) -> Result<(TriMesh, String)> {
    let growth = mesh.diagonal() / input.diagonal();
    if growth < POINT {
        return Ok((mesh.clone(), " (a point)".into()));
    }
    let area: f64 = (0..mesh.face_count()).map(|f| DVec3::from(mesh.area_vector(f)).length()).sum();
    let is_line = area < LINE * mesh.diagonal().powi(2);
    if (SMALL..=DIVERGED).contains(&growth) {
        return Ok((mesh.clone(), String::new()));
    }
    let title = match growth > 1.0 {
        _ if is_line => " (a line)".into(),
        true => format!(" (1 : {})", brief(growth)),
        false => format!(" (×{})", brief((1.0 / growth).round())),
    };
    Ok((fitted(mesh, input)?, title))
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
            sweep.push(row!["patch", lambda, 0.0, 0.0, error, 0.0, 0.0]);
        }
        assert_eq!(best_lambda(&sweep, "patch", "surface error").unwrap(), 1.0);
    }
}
