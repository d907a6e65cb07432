//! Question 5: explicit diffusion.

use anyhow::{Context as _, Result};
use fairing_evaluation::{NoiseKind, NoiseLevel, add_noise};
use fairing_shapes as shapes;
use fairing_smoothing::{Diffusion, largest_eigenvalue};
use fairing_sparse::{larger, smaller};
use rayon::prelude::*;

use super::models::{self, CREASES, DIVERGED, Model};
use super::over_lambda::{self, Favourites, OverLambda, SWEPT};
use super::statistics::least;
use crate::experiment::outcome::Outcome;
use crate::experiment::text::{Text, values};
use crate::experiment::{Card, Context, Experiment};
use crate::model::table::{Table, Tables, Tolerance, Unit};
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
        let seen = over_lambda::seen_in_plot(&Favourites::of(&sweep)?)?;
        let caption = TEXT.say("figure sweep", values! { seen, steps: ITERATIONS })?;
        outcome.figures.push(over_lambda::plot(&sweep, over_lambda::EXPLICIT, &caption)?);
        let best = best(context)?;
        context.progress(0.9, "spectra");
        outcome.tables.extend([table, sweep, best, spectra(&models)?]);
        Ok(outcome)
    }

    fn judge(&self, tables: Tables<'_>) -> Result<Vec<Judgement>> {
        Ok(vec![Found::new(tables)?.judgement()?])
    }
}

/// Numbers that decide on claim 5a.
struct Found {
    /// The best of the four λ by the surface error, on the patch and on the machine part: normals
    /// do not see a patch shrink.
    favourites: [f64; 2],
    swept: Favourites,
    /// The smallest and the greatest best λ of the generated part by the surface error.
    best: [f64; 2],
    /// The F-scores of the creases at the λ of the claim and at the strong one.
    creases: [f64; 2],
    /// The least growth of a mesh by the divergent λ.
    growth: f64,
    /// The largest of the smallest eigenvalues.
    eigenvalue: f64,
}

impl Found {
    fn new(tables: Tables<'_>) -> Result<Self> {
        let (flows, best) = (tables.get("flows")?, tables.get("best")?);
        let spectra = tables.get("spectra")?;
        let creases = |lambda: f64| {
            flows.value(&[("mesh", "machine part".into()), ("lambda", lambda.into())], CREASES)
        };
        Ok(Self {
            favourites: [favourite(flows, "patch")?, favourite(flows, "machine part")?],
            swept: Favourites::of(tables.get("sweep")?)?,
            best: extremes(&best.column("best lambda, surface")?),
            creases: [creases(CLAIMED)?, creases(STRONG)?],
            growth: extremes(&spectra.column("growth at 2")?)[0],
            eigenvalue: extremes(&spectra.column("smallest eigenvalue")?)[1],
        })
    }

    fn verdict(&self) -> Verdict {
        let is_best = self.favourites.iter().all(|&l| l == CLAIMED) && !self.depends();
        let loses = self.creases[1] < self.creases[0];
        match (is_best, loses, self.growth > DIVERGED) {
            (true, true, true) => Verdict::Confirmed,
            (false, false, false) => Verdict::Refuted,
            _ => Verdict::Qualified,
        }
    }

    /// Returns true if the best λ of the generated part depends on noise and resolution.
    fn depends(&self) -> bool {
        self.best[1] > ALIKE * self.best[0]
    }

    fn judgement(&self) -> Result<Judgement> {
        let Self { swept, creases, growth, eigenvalue, .. } = self;
        let [[patch, part], [lowest, highest]] = [self.favourites, self.best];
        let depends = TEXT.say(if self.depends() { "depends" } else { "alike" }, &[])?;
        let favourite = if patch == part { "one favourite" } else { "two favourites" };
        let deforms = *growth > DIVERGED;
        let largest = values! {
            growth: *growth, eigenvalue: *eigenvalue, steps: ITERATIONS, divergent: DIVERGENT,
            factor: (1.0 + DIVERGENT * eigenvalue).abs(),
        };
        let values = values! {
            depends, lowest, highest, steps: ITERATIONS, strong: STRONG, divergent: DIVERGENT,
            favourite: TEXT.say(favourite, values! { patch, part })?,
            swept_patch: swept.surface[0].lambda, swept_part: swept.surface[1].lambda,
            normals_patch: swept.normals[0].lambda, normals_part: swept.normals[1].lambda,
            loses: if creases[1] < creases[0] { "loses" } else { "does not lose" },
            claimed: CLAIMED, creases: creases[1], creases_before: creases[0],
            largest: TEXT.say(if deforms { "unstable" } else { "stable" }, largest)?,
            unstable: if deforms { "every mesh" } else { "some meshes" },
        };
        let (surface, normals) = (swept.surface[1].lambda, swept.normals[1].lambda);
        let growing = format!("least growth in {ITERATIONS} steps of λ = {DIVERGENT}");
        Ok(TEXT
            .judgement("5a", self.verdict(), values)?
            .shown(Shown::playground("diffusion", &[&2, &5]))
            .number(&growing, *growth, Unit::One)
            .number("best of the four on the patch", patch, Unit::One)
            .number("best of the four on the machine part", part, Unit::One)
            .number("best λ on the machine part, surface error", surface, Unit::One)
            .number("the same, normal error", normals, Unit::One)
            .number("smallest best λ over noise and resolution", lowest, Unit::One)
            .number("largest", highest, Unit::One)
            .number(&format!("F-score of the creases at λ = {STRONG}"), creases[1], Unit::One))
    }
}

/// The least and the greatest number.
fn extremes(values: &[f64]) -> [f64; 2] {
    let least = values.iter().copied().fold(f64::INFINITY, smaller);
    [least, values.iter().copied().fold(f64::NEG_INFINITY, larger)]
}

/// Best steps that differ by no more than this factor are alike.
const ALIKE: f64 = 1.5;

/// The λ of the assignment with the least surface error on a mesh.
fn favourite(flows: &Table, mesh: &str) -> Result<f64> {
    let rows = flows.only(&[("mesh", mesh.into())])?;
    let errors = rows.index("surface error")?;
    let errors = rows.rows.iter().map(|row| row[errors].number());
    // A mesh that has diverged has no error, and the input has no λ.
    let candidates = errors.zip(rows.column("lambda")?).filter(|(_, lambda)| *lambda > 0.0);
    let candidates: Vec<_> = candidates.filter_map(|(error, l)| Some((error?, l))).collect();
    Ok(least(&candidates).context("no steps")?.1)
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
            ("below −1 by at least", Unit::One),
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
            1.0 / (n - 1.0),
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
