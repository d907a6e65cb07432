//! Question 5: explicit diffusion.

use anyhow::{Context as _, Result};
use fairing_evaluation::{NoiseKind, NoiseLevel, add_noise};
use fairing_shapes as shapes;
use fairing_smoothing::{Diffusion, largest_eigenvalue};
use fairing_sparse::{larger, smaller};
use rayon::prelude::*;

use super::models::{self, CREASES, Model};
use super::over_lambda::{self, Best, DIVERGED, Favourites, OverLambda, SWEPT};
use super::statistics::least;
use crate::experiment::outcome::Outcome;
use crate::experiment::text::{Text, values};
use crate::experiment::{Card, Context, Experiment};
use crate::model::table::{Table, Tables, Tolerance, Unit, brief};
use crate::model::verdict::{Judgement, Shown, Verdict};
use crate::row;

pub(super) struct ExplicitFlow;

/// The steps of the assignment.
const LAMBDAS: [f64; 4] = [0.01, 0.05, 1.0, 2.0];

/// Its number of iterations.
const ITERATIONS: usize = 50;

/// The step of the assignment that diverges on every mesh.
const DIVERGENT: f64 = LAMBDAS[3];

/// The step of the assignment that the report says loses features.
const STRONG: f64 = LAMBDAS[2];

/// The best of the report.
const CLAIMED: f64 = 0.05;

static TEXT: Text = Text::new("q5", include_str!("../../text/q5.md"));

impl Experiment for ExplicitFlow {
    fn card(&self) -> Card {
        TEXT.card(
            over_lambda::INPUTS,
            over_lambda::parameters(&LAMBDAS, ITERATIONS),
            values! { steps: LAMBDAS.len(), feature: models::FEATURE, divergent: DIVERGENT },
        )
    }

    fn run(&self, context: &Context<'_>) -> Result<Outcome> {
        let mut outcome = Outcome::default();
        let models = Model::all(context)?;
        let flow = OverLambda {
            kind: "explicit",
            lambdas: &LAMBDAS,
            iterations: ITERATIONS,
            viewed: LAMBDAS.len() - 1,
            run: Model::explicit,
        };
        let table = flow.measure(context, &models, &mut outcome)?;
        context.progress(0.5, "sweep");
        let sweep = sweep(context, &models)?;
        let seen = over_lambda::seen_in_plot(&Favourites::of(&sweep)?);
        let caption = TEXT.say("figure sweep", values! { seen, steps: ITERATIONS })?;
        outcome.figures.push(over_lambda::plot(&sweep, over_lambda::EXPLICIT, &caption)?);
        let best = best(context)?;
        context.progress(0.9, "spectra");
        outcome.tables.extend([table, sweep, best, spectra(&models)?]);
        Ok(outcome)
    }

    fn judge(&self, tables: Tables<'_>) -> Result<Vec<Judgement>> {
        let (flows, best) = (tables.get("flows")?, tables.get("best")?);
        let spectra = tables.get("spectra")?;
        let of = |mesh: &str, lambda: f64, column: &str| {
            flows.value(&[("mesh", mesh.into()), ("lambda", lambda.into())], column)
        };
        let favourites = favourites(flows)?;
        // By the surface error: normals do not see a patch shrink.
        let is_best = [favourites[0], favourites[2]].iter().all(|&l| l == CLAIMED);
        let swept = Favourites::of(tables.get("sweep")?)?;
        let creases = [of("machine part", CLAIMED, CREASES)?, of("machine part", STRONG, CREASES)?];
        let loses = creases[1] < creases[0];
        let [growth, _] = extremes(&spectra.column("growth at 2")?);
        let deforms = growth > DIVERGED;
        let [lowest, highest] = extremes(&best.column("best lambda, surface")?);
        let [least, greatest] = extremes(&best.column("best lambda, normals")?);
        let [_, largest] = extremes(&spectra.column("smallest eigenvalue")?);
        let depends = highest > ALIKE * lowest;
        let verdict = match (is_best && !depends, loses, deforms) {
            (true, true, true) => Verdict::Confirmed,
            (false, false, false) => Verdict::Refuted,
            _ => Verdict::Qualified,
        };
        let about_right = right_about_normals(swept.normals[1])?;
        let claimed = values! { claimed: CLAIMED };
        let differs = values! { patch: swept.surface[0].lambda, part: swept.surface[1].lambda };
        let closest = closest(&favourites, of("patch", STRONG, "area")?)?;
        let values = values! {
            depends: if depends { SEVERAL } else { "The best λ changes little from mesh to mesh." },
            swept: swept.words(ITERATIONS), about_right, closest, lowest, highest, least, greatest,
            steps: ITERATIONS, strong: STRONG, divergent: DIVERGENT, claimed: CLAIMED,
            loses: if loses { "loses" } else { "does not lose" },
            creases: creases[1], creases_before: creases[0],
            largest: at_the_largest(growth, largest)?,
            best: if is_best {
                TEXT.say("best is claimed", claimed)?
            } else {
                TEXT.say("best differs", differs)?
            },
            unstable: if deforms { "every mesh" } else { "some meshes" },
        };
        Ok(vec![
            TEXT.judgement("5a", verdict, values)?
                .shown(Shown::playground("diffusion", &[&2, &5]))
                .number(
                    &format!("least growth in {ITERATIONS} steps of λ = {DIVERGENT}"),
                    growth,
                    Unit::One,
                )
                .number("best of the four on the patch", favourites[0], Unit::One)
                .number("best of the four on the machine part", favourites[2], Unit::One)
                .number(
                    "best λ on the machine part, surface error",
                    swept.surface[1].lambda,
                    Unit::One,
                )
                .number("the same, normal error", swept.normals[1].lambda, Unit::One)
                .number("smallest best λ over noise and resolution", lowest, Unit::One)
                .number("largest", highest, Unit::One)
                .number(&format!("F-score of the creases at λ = {STRONG}"), creases[1], Unit::One),
        ])
    }
}

/// The least and the greatest number.
fn extremes(values: &[f64]) -> [f64; 2] {
    let least = values.iter().copied().fold(f64::INFINITY, smaller);
    [least, values.iter().copied().fold(f64::NEG_INFINITY, larger)]
}

/// The effect of the largest step, in words.
fn at_the_largest(growth: f64, eigenvalue: f64) -> Result<String> {
    let values = values! {
        growth, eigenvalue, factor: (1.0 + DIVERGENT * eigenvalue).abs(), steps: ITERATIONS,
        divergent: DIVERGENT,
    };
    TEXT.say(if growth > DIVERGED { "unstable" } else { "stable" }, values)
}

/// Best steps that differ by no more than this factor are alike.
const ALIKE: f64 = 1.5;

/// Words for best steps that differ.
const SEVERAL: &str = "No single λ is best.";

/// A remark if the λ that the report calls best is about the best by normals.
fn right_about_normals(best: Best) -> Result<String> {
    let ratio = (best.lambda / CLAIMED).max(CLAIMED / best.lambda);
    if ratio >= ALIKE {
        return Ok(String::new());
    }
    Ok(format!(" {}", TEXT.say("about right", values! { claimed: CLAIMED })?))
}

/// A change of area above this is visible, in percent.
const SEEN: f64 = 5.0;

/// The step among the four that comes closest on the patch and on the machine part, by surface
/// and by normals.
fn closest(favourites: &[f64], area: f64) -> Result<String> {
    let pair = |patch: f64, part: f64| {
        let [first, second] = [patch, part].map(brief);
        if patch == part {
            return format!("λ = {first} on both meshes");
        }
        format!("λ = {first} on the patch and λ = {second} on the machine part")
    };
    let surfaces = pair(favourites[0], favourites[2]);
    let normals = pair(favourites[1], favourites[3]);
    let mut blind = String::new();
    if favourites[1] == STRONG && area.abs() > SEEN {
        blind = TEXT.say("blind", values! { strong: STRONG, area })?;
    }
    TEXT.say("closest", values! { surfaces, normals, blind })
}

/// The best of the four λ by surfaces and by normals, on the patch, then on the machine part.
fn favourites(flows: &Table) -> Result<Vec<f64>> {
    let mut favourites = vec![];
    for mesh in ["patch", "machine part"] {
        for column in ["surface error", "normal error"] {
            let mut candidates = vec![];
            for lambda in LAMBDAS {
                let row = [("mesh", mesh.into()), ("lambda", lambda.into())];
                candidates.push((flows.value(&row, column)?, lambda));
            }
            favourites.push(least(&candidates).context("no steps")?.1);
        }
    }
    Ok(favourites)
}

/// Errors over a fine range of λ, up to where open meshes stay stable.
fn sweep(context: &Context<'_>, models: &[Model]) -> Result<Table> {
    let mut table =
        Table::new("sweep", &TEXT.say("table sweep", values! { steps: ITERATIONS })?, &SWEPT);
    let lambdas: Vec<f64> = steps(context.choose(34, 8)).collect();
    over_lambda::sweep(&mut table, models, &lambdas, |m, lambda| m.explicit(lambda, ITERATIONS))?;
    Ok(table)
}

/// The least λ of the sweeps: fifty steps of it hardly move a vertex.
const SMALLEST: f64 = 5e-4;

/// λ in equal ratios from [`SMALLEST`] to 8/7.
fn steps(count: usize) -> impl Iterator<Item = f64> + Clone {
    let ratio = libm::log(8.0 / 7.0 / SMALLEST) / (count - 1) as f64;
    (0..count).map(move |i| SMALLEST * libm::exp(ratio * i as f64))
}

/// The best λ of a generated machine part at two resolutions and three levels of noise.
fn best(context: &Context<'_>) -> Result<Table> {
    let mut table = Table::new(
        "best",
        &TEXT.say("table best", values! { steps: ITERATIONS })?,
        &[
            ("spacing", Unit::Length),
            ("vertices", Unit::Count),
            ("noise", Unit::EdgeLengths),
            ("best lambda, normals", Unit::One),
            ("normal error", Unit::Degrees),
            ("best lambda, surface", Unit::One),
            ("surface error", Unit::EdgeLengths),
        ],
    );
    for spacing in context.choose([0.06, 0.03], [0.16, 0.08]) {
        let truth = shapes::cad_block(spacing);
        for sigma in [0.05, 0.1, 0.3] {
            let seed = context.seed("best");
            let level = NoiseLevel::EdgeLengths(sigma);
            let noisy = add_noise(&truth, NoiseKind::GaussianAlongNormals, level, seed)?;
            let model = Model::new("machine part", noisy, truth.clone())?;
            let lambdas: Vec<f64> = steps(context.choose(34, 8)).collect();
            let measure = |&lambda: &f64| -> Result<[(f64, f64); 2]> {
                let m = model.measure(&model.explicit(lambda, ITERATIONS)?.mesh)?;
                let normal = m.normal.context("a smoothed part without normals")?;
                Ok([(normal, lambda), (m.surface, lambda)])
            };
            let measured: Vec<_> = lambdas.par_iter().map(measure).collect::<Result<_>>()?;
            let best = |k: usize| {
                let pairs: Vec<_> = measured.iter().map(|m| m[k]).collect();
                least(&pairs).context("no steps")
            };
            let (normals, surface) = (best(0)?, best(1)?);
            table.push(row![
                spacing,
                truth.vertex_count(),
                sigma,
                normals.1,
                normals.0,
                surface.1,
                surface.0,
            ]);
        }
    }
    Ok(table)
}

/// The smallest eigenvalues beside their bounds, and the consequences for λ = 2.
fn spectra(models: &[Model]) -> Result<Table> {
    let mut table = Table::new(
        "spectra",
        &TEXT.say("table spectra", values! { steps: ITERATIONS, divergent: DIVERGENT })?,
        &[
            ("mesh", Unit::Label),
            ("vertices", Unit::Count),
            ("closed", Unit::Label),
            ("bound below", Unit::One),
            ("smallest eigenvalue", Unit::One),
            ("bound above", Unit::One),
            ("stable limit", Unit::One),
            ("growth of the mode", Unit::One),
            ("growth at 2", Unit::One),
        ],
    )
    .aside(&["vertices", "growth of the mode"])
    .tolerance("smallest eigenvalue", Some(Tolerance::LOOSE))
    .tolerance("stable limit", Some(Tolerance::LOOSE))
    .tolerance("growth of the mode", None)
    .tolerance("growth at 2", None);
    let octahedron = shapes::octahedron();
    let sphere = Model::new("icosphere", shapes::icosphere(4), shapes::icosphere(4))?;
    let attained = Model::new("octahedron", octahedron.clone(), octahedron)?;
    for model in models.iter().chain([&sphere, &attained]) {
        let mesh = &model.noisy;
        let closed = mesh.topology().is_closed();
        let mu = -largest_eigenvalue(mesh, Diffusion::uniform(1.0))?;
        // Symmetric positions hold nothing of the roughest modes: some noise brings all of them in.
        let level = NoiseLevel::EdgeLengths(0.01);
        let noisy = add_noise(mesh, NoiseKind::GaussianPerAxis, level, 1)?;
        let model = Model::new(model.name, noisy, model.truth.clone())?;
        let after = model.explicit(DIVERGENT, ITERATIONS)?.mesh;
        let n = mesh.vertex_count() as f64;
        table.push(row![
            model.name,
            mesh.vertex_count(),
            if closed { "yes" } else { "no" },
            if closed { -1.5 } else { -1.75 },
            mu,
            -n / (n - 1.0),
            2.0 / mu.abs(),
            (1.0 + DIVERGENT * mu).abs().powi(ITERATIONS as i32),
            after.diagonal() / model.noisy.diagonal(),
        ]);
    }
    Ok(table)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sweep_ends_at_the_limit_of_open_meshes() {
        let all: Vec<f64> = steps(8).collect();
        assert_eq!(all.len(), 8);
        assert!((all[0] - SMALLEST).abs() < 1e-15 && (all[7] - 8.0 / 7.0).abs() < 1e-12);
    }
}
