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
use crate::experiment::{Card, Context, Experiment};
use crate::model::section::{Act, Section};
use crate::model::table::{Table, Tables, Tolerance, Unit, brief, short};
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

/// The section of the article.
fn section() -> Section {
    Section::new(
        Act::Diffusion,
        "In the basis of the last part a step of diffusion multiplies each mode by a number. Explicit steps \
                do so by 1 + λμ, and that number can leave the interval from −1 to 1.",
    )
    .commands(&["fairing smooth noisy.ply -o smooth.ply --method explicit --lambda 0.05 --iterations 50", "fairing compare smooth.ply truth.ply"])
    .edge_lengths_of("the mesh without noise, the truth")
    .sources(&["taubin1995", "desbrun1999"])
    .notation(&["x", "X", "T", "L", "D", "W", "I", "\\mu", "\\lambda", "s"])
    .shows(&["sweep", "patch", "machine-part"], &[])
    .names(&[("patch-view", "the patch"), ("machine-part-view", "the machine part"), ("cube-view", "the cube"), ("flows", "scores of the four steps"), ("sweep", "errors over λ"), ("best", "the best λ over noise and resolution"), ("spectra", "the smallest eigenvalues and the stable limit")])
    .playground(
        "diffusion",
        "Beyond λ = 4/3 explicit steps amplify the roughest mode; implicit steps of the same diffusion time stay \
            calm. This mesh has a mode of μ = −3/2, the least that a closed mesh can have. Below: the factor of one \
            step, and the size of each mode before and after. Drag λ through 4/3.",
        "A noisy ball three times: as it is, after explicit steps and after implicit steps, with the factors and \
            the spectrum as plots.",
    )
}

impl Experiment for ExplicitFlow {
    fn card(&self) -> Card {
        Card {
            id: "q5",
            title: "Explicit smoothing",
            question: "Explicit diffusion x ← x + λLx with the uniform Laplacian, 50 iterations: what λ is good, and what happens beyond?".into(),
            method: format!(
                "The assignment's {} values of λ are run on its two noisy meshes and a cube, and compared with the truth. A step multiplies each mode of L by 1 + λμ, so the smallest eigenvalue μ decides which λ are stable. On a closed mesh it is never below −3/2: for a mode x, add (x₁ + x₂ + x₃)² over all triangles. Each vertex is in as many triangles as it has neighbours and each edge in two, so the sum is (3 + 2μ) xᵀDx, and no sum of squares is negative. It is zero if the three values in each triangle add up to zero, for example −1, 0 and 1: a mesh whose vertices can be coloured in this way has a mode of −3/2, and is stable up to λ = 4/3 and not beyond.\n\nThe ground truth of the machine part is a mesh with the same faces; that of the patch, its vertices projected to the best-fit plane; that of the cube, the cube. Measured are the normal error (the mean angle between the normals of faces and of the truth), the vertex error (the mean distance of the vertices from the true surface), the surface error (the mean distance both ways, which sees that a patch has shrunk), volume, area, creases (edges that turn by {}° or more, found and true ones compared by their F-score: recall alone is perfect where every edge is sharp), and how far vertices moved.\n\nA fine sweep of λ follows, and another one over a generated machine part at two resolutions with three levels of noise, to see whether the best λ is a constant. The best is the one with the least surface error; the one with the least normal error is shown beside it.\n\nThe smallest eigenvalue is measured and compared with its bounds: μ ≥ −3/2 on every closed triangle mesh, μ ≥ −7/4 on every open one, and, since the trace of L is −|V|, μ ≤ −|V|/(|V| − 1) on all of them. So λ = {DIVERGENT} is unstable on every mesh.",
                LAMBDAS.len(),
                models::FEATURE
            ),
            formulas: FORMULAS.map(String::from).to_vec(),
            section: section(),
            inputs: over_lambda::INPUTS,
            parameters: over_lambda::parameters(&LAMBDAS, ITERATIONS),
        }
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
        let caption = format!(
            "{} Errors after {ITERATIONS} explicit steps over λ, up to the longest that is stable on every mesh.",
            over_lambda::seen_in_plot(&Favourites::of(&sweep)?)
        );
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
        let reason = format!(
            "{} The best λ is the one with the least surface error, which sees a mesh shrink; the normal error, which does not, is given beside it. {} {} {} On a generated machine part at two resolutions and three levels of noise the best λ lies between {} and {}, by normals between {} and {}: what counts is the diffusion time {ITERATIONS} λ against the noise and the size of the features. λ = {STRONG} {} the creases of the machine part (F-score {} against {} at {CLAIMED}) but is stable, as every λ up to 4/3 is on a closed mesh. {}",
            if depends { SEVERAL } else { "The best λ changes little from mesh to mesh." },
            swept.words(ITERATIONS),
            right_about_normals(swept.normals[1]),
            closest(&favourites, of("patch", STRONG, "area")?),
            brief(lowest),
            brief(highest),
            brief(least),
            brief(greatest),
            if loses { "loses" } else { "does not lose" },
            brief(creases[1]),
            brief(creases[0]),
            at_the_largest(growth, largest),
        );
        Ok(vec![
            Judgement::new(
                "5a",
                "λ = 0.05 smooths best; λ = 1 loses features, λ = 2 deforms",
                verdict,
                reason,
            )
            .finding(format!(
                "{} On a generated machine part at two resolutions with three levels of noise the best λ lies between {} and {}. λ = {STRONG} is stable; λ = {DIVERGENT} is unstable on {}.",
                no_best(is_best, &swept),
                brief(lowest),
                brief(highest),
                if deforms { "every mesh" } else { "some meshes" }
            ))
            .shown(Shown::playground("diffusion", &[&2, &5]))
            .number(&format!("least growth in {ITERATIONS} steps of λ = {DIVERGENT}"), growth, Unit::One)
            .number("best of the four on the patch", favourites[0], Unit::One)
            .number("best of the four on the machine part", favourites[2], Unit::One)
            .number("best λ on the machine part, surface error", swept.surface[1].lambda, Unit::One)
            .number("the same, normal error", swept.normals[1].lambda, Unit::One)
            .number("smallest best λ over noise and resolution", lowest, Unit::One)
            .number("largest", highest, Unit::One)
            .number(&format!("F-score of the creases at λ = {STRONG}"), creases[1], Unit::One),
        ])
    }
}

/// The best λ of both meshes, in words.
fn no_best(is_claimed: bool, swept: &Favourites) -> String {
    match is_claimed {
        true => format!(
            "Of the four steps λ = {CLAIMED} comes closest to the true surface on both meshes."
        ),
        false => format!(
            "No single λ is best: it is {} on the patch and {} on the machine part.",
            brief(swept.surface[0].lambda),
            brief(swept.surface[1].lambda)
        ),
    }
}

/// The least and the greatest number.
fn extremes(values: &[f64]) -> [f64; 2] {
    let least = values.iter().copied().fold(f64::INFINITY, smaller);
    [least, values.iter().copied().fold(f64::NEG_INFINITY, larger)]
}

/// The effect of the largest step, in words.
fn at_the_largest(growth: f64, eigenvalue: f64) -> String {
    let grown = brief(growth);
    match growth > DIVERGED {
        true => format!(
            "λ = {DIVERGENT} does worse than deform a mesh: it is unstable. The smallest eigenvalue μ is {} or less on these meshes, so each step multiplies the roughest mode by {} or more in size; with a little noise, which brings that mode in, even the slowest-growing mesh is {grown} times as large after {ITERATIONS} steps. (Without noise a regular octahedron only flips from side to side for ever, because its coordinates are modes of μ = −1.)",
            short(eigenvalue),
            short((1.0 + DIVERGENT * eigenvalue).abs())
        ),
        false => format!(
            "λ = {DIVERGENT} does not diverge everywhere: after {ITERATIONS} steps the slowest-growing mesh is {grown} times as large."
        ),
    }
}

/// Best steps that differ by no more than this factor are alike.
const ALIKE: f64 = 1.5;

/// Words for best steps that differ.
const SEVERAL: &str = "No single λ is best.";

/// A remark if the λ that the report calls best is about the best by normals.
fn right_about_normals(best: Best) -> String {
    let ratio = (best.lambda / CLAIMED).max(CLAIMED / best.lambda);
    match ratio < ALIKE {
        true => format!("By the normals of the machine part {CLAIMED} is about right."),
        false => String::new(),
    }
}

/// A change of area above this is visible, in percent.
const SEEN: f64 = 5.0;

/// The step among the four that comes closest on the patch and on the machine part, by surface
/// and by normals.
fn closest(favourites: &[f64], area: f64) -> String {
    let pair = |patch: f64, part: f64| match patch == part {
        true => format!("λ = {} on both meshes", brief(patch)),
        false => {
            format!("λ = {} on the patch and λ = {} on the machine part", brief(patch), brief(part))
        }
    };
    let surfaces = pair(favourites[0], favourites[2]);
    let normals = pair(favourites[1], favourites[3]);
    let blind = match favourites[1] == STRONG && area.abs() > SEEN {
        true => format!(
            "; but normals do not see that λ = {STRONG} changes the area of the patch by {} %",
            brief(area)
        ),
        false => String::new(),
    };
    format!(
        "Of the assignment's four steps, {surfaces} comes closest to the true surface, and {normals} to the true normals{blind}."
    )
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
    let mut table = Table::new(
        "sweep",
        &format!(
            "Errors after {ITERATIONS} explicit steps over λ, up to 8/7, which is stable on every mesh."
        ),
        &SWEPT,
    );
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
        &format!(
            "The λ with the smallest error after {ITERATIONS} steps, by either error, on a generated machine part with Gaussian noise along the normals."
        ),
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
        &format!("The smallest eigenvalue μ of L = D⁻¹W − I as measured, its lower bound (−3/2 if closed, −7/4 if open), and its upper bound −|V|/(|V| − 1) from the trace. The stable limit is 2/|μ|. Growth of the diagonal in {ITERATIONS} steps with λ = {DIVERGENT}, beside |1 + {DIVERGENT}μ| to the power of {ITERATIONS}, the growth of the roughest mode."),
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

const FORMULAS: [&str; 2] = [
    r"0 \le \sum_T (x_1 + x_2 + x_3)^2 = x^\top D x + 2\, x^\top W x = (3 + 2\mu)\, x^\top D x",
    r"x^{s+1} = x^s + \lambda L x^s, \qquad L = D^{-1}W - I, \qquad \text{each mode times } 1 + \lambda\mu",
];

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
