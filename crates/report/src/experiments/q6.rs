//! Question 6: implicit diffusion.

use std::time::Instant;

use anyhow::Result;
use fairing_evaluation::vertex_displacement;
use fairing_mesh::TriMesh;
use fairing_shapes as shapes;
use fairing_smoothing::{Approach, Diffusion, Implicit, implicit};
use fairing_sparse::larger;
use glam::DVec3;

use super::models::{Model, unless_diverged};
use super::over_lambda::{self, Favourites, OverLambda, SWEPT, SWEPT_MESHES};
use crate::experiment::outcome::{Outcome, Picture};
use crate::experiment::text::{Text, Values, values};
use crate::experiment::{Card, Context, Experiment};
use crate::model::table::{Cell, Table, Tables, Tolerance, Unit};
use crate::model::verdict::{Judgement, Shown, Verdict, ViewState};
use crate::row;

pub(super) struct ImplicitFlow;

/// The steps of the assignment.
const LAMBDAS: [f64; 6] = [0.01, 0.05, 0.1, 2.0, 10.0, 100.0];

/// Its number of iterations.
const ITERATIONS: usize = 50;

/// The best λ of the report, and the one it compares iterations with.
const CLAIMED: f64 = 5.0;

/// The explicit step that the report calls best in its question 5. It gives none for this question:
/// that it took the same is our assumption.
const REPORT: f64 = 0.05;

/// The numbers of iterations that the report compares.
const COMPARED: [usize; 2] = [10, ITERATIONS];

/// The explicit step that is taken for comparisons at equal time.
const EXPLICIT: f64 = 0.5;

/// The λ at which displacements are examined.
const MOVED: f64 = LAMBDAS[4];

/// The number of explicit steps that take as long as the smaller of the two numbers of implicit
/// steps compared.
const EQUAL: usize = (COMPARED[0] as f64 * CLAIMED / EXPLICIT) as usize;

/// A growth of the diagonal above one by more than this is an instability, not rounding.
const ROUNDING: f64 = 1e-9;

/// An RMS displacement below this, in mean edge lengths, is invisible.
const INVISIBLE: f64 = 0.05;

static TEXT: Text = Text::new("q6", include_str!("../../text/q6.md"));

impl Experiment for ImplicitFlow {
    fn card(&self) -> Card {
        let [few, many] = COMPARED;
        TEXT.card(
            over_lambda::INPUTS,
            over_lambda::parameters(&LAMBDAS, ITERATIONS),
            values! {
                values: LAMBDAS.len(), steps: ITERATIONS, claimed: CLAIMED, few, many,
                explicit: EXPLICIT,
            },
        )
    }

    fn run(&self, context: &Context<'_>) -> Result<Outcome> {
        let mut outcome = Outcome::default();
        let models = Model::all(context)?;
        let flow = OverLambda {
            kind: "implicit",
            lambdas: &LAMBDAS,
            iterations: ITERATIONS,
            viewed: LAMBDAS.len(),
            run: Model::implicit,
        };
        let table = flow.measure(context, &models, &mut outcome)?;
        context.progress(0.5, "sweep");
        let sweep = sweep(context, &models)?;
        let best = Favourites::of(&sweep)?;
        let mut rises = String::new();
        if best.surface.iter().all(|best| best.lambda < CLAIMED) {
            rises = format!(" {}", TEXT.say("rises", values! { claimed: CLAIMED })?);
        }
        let seen = over_lambda::seen_in_plot(&best)?;
        let caption = TEXT.say("figure sweep", values! { seen, rises, steps: ITERATIONS })?;
        outcome.figures.push(over_lambda::plot(&sweep, over_lambda::IMPLICIT, &caption)?);
        context.progress(0.7, "iterations");
        for model in models.iter().filter(|m| m.name == "machine part") {
            outcome.figures.push(over_iterations(model)?);
        }
        outcome.tables.extend([
            table,
            sweep,
            iterations(&models)?,
            limit(&models)?,
            spheres(context)?,
            cost(&models)?,
        ]);
        Ok(outcome)
    }

    fn judge(&self, tables: Tables<'_>) -> Result<Vec<Judgement>> {
        Ok(vec![stability(tables)?, convergence(tables)?])
    }
}

/// Claim 6a.
fn stability(tables: Tables<'_>) -> Result<Judgement> {
    let flows = tables.get("flows")?;
    let of = |mesh: &str, lambda: f64, column: &str| {
        flows.value(&[("mesh", mesh.into()), ("lambda", lambda.into())], column)
    };
    // Without a step nothing grows or shrinks.
    let growths = flows.column("lambda")?.into_iter().zip(flows.column("growth")?);
    let growth = growths.filter(|(lambda, _)| *lambda > 0.0).map(|(_, g)| g).fold(0.0, larger);
    let stable = growth <= 1.0 + ROUNDING;
    let inside = of("patch", MOVED, "displacement inside")?;
    let border = of("patch", MOVED, "displacement of the border")?;
    let closed = of("machine part", MOVED, "displacement")?;
    let volume = of("machine part", MOVED, "volume")?;
    let only_edges = inside < INVISIBLE && closed < INVISIBLE;
    let swept = Favourites::of(tables.get("sweep")?)?;
    let best = swept.surface.map(|best| best.lambda);
    // Within a factor of two of the claim on both meshes.
    let about = best.iter().all(|l| (0.5..=2.0).contains(&(l / CLAIMED)));
    let verdict = match (stable, only_edges, about) {
        (true, true, true) => Verdict::Confirmed,
        (false, false, false) => Verdict::Refuted,
        _ => Verdict::Qualified,
    };
    let [patch, part] = best;
    let normals = swept.normals[1].lambda;
    let say = |is: bool, [yes, no]: [&str; 2], values: Values<'_>| {
        TEXT.say(if is { yes } else { no }, values)
    };
    let moves = values! { moved: MOVED, border, inside, closed, loss: -volume };
    let bests = values! {
        claimed: CLAIMED, patch, part, normals, patch_time: patch * ITERATIONS as f64,
        part_time: part * ITERATIONS as f64,
    };
    let values = values! {
        stable: say(stable, ["stable", "unstable"], values! { growth })?,
        edges: say(only_edges, ["only edges", "all moves"], moves)?,
        best: say(about, ["best about", "best elsewhere"], bests)?,
        short_stable: say(stable, ["short stable", "short unstable"], &[])?,
        whole: say(only_edges, ["short edges", "short whole"], &[])?,
        patch, part, claimed: CLAIMED,
    };
    let state = ViewState::at(&[4, 1]).field("displacement");
    Ok(TEXT
        .judgement("6a", verdict, values)?
        .shown(Shown::view("q6", "machine-part-view", &state))
        .number(&format!("volume of the machine part at λ = {MOVED}"), volume, Unit::Percent)
        .number("largest growth", growth, Unit::One)
        .number(&format!("border of the patch at λ = {MOVED}"), border, Unit::EdgeLengths)
        .number(&format!("inside of the patch at λ = {MOVED}"), inside, Unit::EdgeLengths)
        .number(&format!("machine part at λ = {MOVED}"), closed, Unit::EdgeLengths)
        .number("best λ on the patch, surface error", best[0], Unit::One)
        .number("on the machine part", best[1], Unit::One)
        .number("on the machine part, normal error", normals, Unit::One))
}

/// Claim 6b.
fn convergence(tables: Tables<'_>) -> Result<Judgement> {
    let table = tables.get("iterations")?;
    let [few, many] = COMPARED;
    let (mut least, mut apart, mut ratio) = (f64::INFINITY, 0.0f64, 0.0f64);
    for mesh in SWEPT_MESHES {
        let of = |flow: &str, n: usize, lambda: f64, column: &str| {
            let row = [
                ("mesh", Cell::from(mesh)),
                ("flow", flow.into()),
                ("iterations", n.into()),
                ("lambda", lambda.into()),
            ];
            table.value(&row, column)
        };
        let still = of("implicit", many, CLAIMED, "from 10 implicit steps")?;
        let gap = of("explicit", EQUAL, EXPLICIT, "from 10 implicit steps")?;
        least = least.min(still);
        apart = apart.max(gap);
        ratio = ratio.max(gap / still);
    }
    let converged = least < INVISIBLE;
    let explains = ratio < 0.5;
    let verdict = match (converged, explains) {
        (true, false) => Verdict::Confirmed,
        (false, true) => Verdict::Refuted,
        _ => Verdict::Qualified,
    };
    let values = values! {
        few, many, least, claimed: CLAIMED, equal: EQUAL, explicit: EXPLICIT, apart, ratio,
        long: few as f64 * CLAIMED, short: few as f64 * REPORT, report: REPORT,
    };
    Ok(TEXT
        .judgement("6b", verdict, values)?
        .shown(Shown::playground("diffusion", &[&0.5, &50]))
        .number(
            &format!("movement from {few} to {many} implicit steps, at least"),
            least,
            Unit::EdgeLengths,
        )
        .number("implicit against explicit at equal time, at most", apart, Unit::EdgeLengths)
        .number("the largest ratio of the two", ratio, Unit::One))
}

/// Errors over a fine range of λ.
fn sweep(context: &Context<'_>, models: &[Model]) -> Result<Table> {
    let mut table =
        Table::new("sweep", &TEXT.say("table sweep", values! { steps: ITERATIONS })?, &SWEPT);
    let count = context.choose(49, 13);
    let lambda = |i: usize| 1e-4 * libm::pow(1e8, i as f64 / (count - 1) as f64);
    let lambdas: Vec<f64> = (0..count).map(lambda).collect();
    over_lambda::sweep(&mut table, models, &lambdas, |m, lambda| m.implicit(lambda, ITERATIONS))?;
    Ok(table)
}

/// The runs that are compared: flow, step and number.
const RUNS: [(&str, f64, usize); 10] = [
    ("implicit", CLAIMED, COMPARED[0]),
    ("implicit", CLAIMED, COMPARED[1]),
    ("implicit", CLAIMED, 500),
    // Diverges: after many steps no mesh has the extent.
    ("explicit", CLAIMED, COMPARED[0]),
    ("explicit", REPORT, COMPARED[0]),
    ("explicit", REPORT, COMPARED[1]),
    ("explicit", EXPLICIT, COMPARED[0]),
    ("explicit", EXPLICIT, COMPARED[1]),
    ("explicit", EXPLICIT, EQUAL),
    ("explicit", EXPLICIT, 500),
];

/// Implicit beside explicit, at equal counts and at equal time.
fn iterations(models: &[Model]) -> Result<Table> {
    let mut table = Table::new(
        "iterations",
        &TEXT.say(
            "table iterations",
            values! {
                claimed: CLAIMED, report: REPORT, explicit: EXPLICIT, few: COMPARED[0],
                many: COMPARED[1],
            },
        )?,
        &[
            ("mesh", Unit::Label),
            ("flow", Unit::Label),
            ("lambda", Unit::One),
            ("iterations", Unit::Count),
            ("time", Unit::One),
            ("normal error", Unit::Degrees),
            ("vertex error", Unit::EdgeLengths),
            ("growth", Unit::One),
            ("from 10 implicit steps", Unit::EdgeLengths),
            ("from 50 implicit steps", Unit::EdgeLengths),
        ],
    )
    .tolerance("normal error", Some(Tolerance::LOOSE))
    .tolerance("vertex error", Some(Tolerance::LOOSE))
    .tolerance("growth", Some(Tolerance::LOOSE))
    .tolerance("from 10 implicit steps", Some(Tolerance::LOOSE))
    .tolerance("from 50 implicit steps", Some(Tolerance::LOOSE))
    .aside(&["normal error", "vertex error", "growth"]);
    let [few, many] = COMPARED;
    for model in models {
        let references = [model.implicit(CLAIMED, few)?.mesh, model.implicit(CLAIMED, many)?.mesh];
        for (flow, lambda, n) in RUNS {
            let mesh = match flow {
                "implicit" => model.implicit(lambda, n)?.mesh,
                _ => model.explicit(lambda, n)?.mesh,
            };
            let m = model.measure(&mesh)?;
            let [a, b] = [0, 1].map(|i| vertex_displacement(&mesh, &references[i]));
            table.push(row![
                model.name,
                flow,
                lambda,
                n,
                lambda * n as f64,
                unless_diverged(m.growth, m.normal),
                unless_diverged(m.growth, m.vertex),
                m.growth,
                unless_diverged(m.growth, a?.rms / model.h()),
                unless_diverged(m.growth, b?.rms / model.h()),
            ]);
        }
    }
    Ok(table)
}

/// Result of a single step of growing λ.
fn limit(models: &[Model]) -> Result<Table> {
    let mut table = Table::new(
        "limit",
        &TEXT.say("table limit", &[])?,
        &[("mesh", Unit::Label), ("lambda", Unit::One), ("left", Unit::Relative)],
    );
    for model in models {
        let topology = model.noisy.topology();
        let degree: Vec<f64> = (0..model.noisy.vertex_count() as u32)
            .map(|v| topology.neighbors(v).len() as f64)
            .collect();
        let total: f64 = degree.iter().sum();
        let weighted =
            model.noisy.positions().iter().zip(&degree).map(|(&p, &d)| d * DVec3::from(p));
        let centre = weighted.sum::<DVec3>() * (1.0 / total);
        let spread = |mesh: &TriMesh| {
            let squares = mesh.positions().iter().map(|&p| centre.distance_squared(p.into()));
            (squares.sum::<f64>() / degree.len() as f64).sqrt()
        };
        for exponent in [2, 4, 6, 8] {
            let lambda = 10f64.powi(exponent);
            let mesh = model.implicit(lambda, 1)?.mesh;
            table.push(row![model.name, lambda, spread(&mesh) / spread(&model.noisy)]);
        }
    }
    Ok(table.tolerance("left", Some(Tolerance::LOOSE)))
}

/// Shrinking spheres, beside theory.
fn spheres(context: &Context<'_>) -> Result<Table> {
    let mut table = Table::new(
        "spheres",
        &TEXT.say("table spheres", &[])?,
        &[
            ("level", Unit::Count),
            ("lambda", Unit::One),
            ("iterations", Unit::Count),
            ("volume left", Unit::Relative),
            ("predicted", Unit::Relative),
        ],
    );
    for level in context.choose([3u32, 4, 5], [2, 3, 4]) {
        let sphere = shapes::icosphere(level);
        let x = sphere.positions();
        let edges = sphere.topology().edges();
        let squares = edges.iter().map(|edge| {
            let [a, b] = edge.map(|v| DVec3::from(x[v as usize]));
            a.distance_squared(b)
        });
        let h2 = squares.sum::<f64>() / edges.len() as f64;
        for (lambda, n) in [(5.0, 10), (5.0, 50), (100.0, 10)] {
            let options = Implicit { iterations: n, ..Implicit::new(Diffusion::uniform(lambda)) };
            let after = implicit(&sphere, &options, None)?.mesh;
            // μ = −q²/2 for the coordinates of a unit sphere.
            let predicted = (1.0 + lambda * h2 / 2.0).powi(-3 * n as i32);
            let left = after.signed_volume() / sphere.signed_volume();
            table.push(row![level as usize, lambda, n, left, predicted]);
        }
    }
    Ok(table)
}

/// Time and work.
fn cost(models: &[Model]) -> Result<Table> {
    let mut table = Table::new(
        "cost",
        &TEXT.say("table cost", values! { steps: ITERATIONS })?,
        &[
            ("mesh", Unit::Label),
            ("vertices", Unit::Count),
            ("flow", Unit::Label),
            ("lambda", Unit::One),
            ("products", Unit::Count),
            ("time for each step", Unit::Seconds),
        ],
    );
    for model in models {
        for (flow, lambda) in [
            ("explicit", 0.05),
            ("explicit", EXPLICIT),
            ("implicit", 0.05),
            ("implicit", CLAIMED),
            ("implicit", 100.0),
        ] {
            let start = Instant::now();
            let smoothed = match flow {
                "explicit" => model.explicit(lambda, ITERATIONS)?,
                _ => model.implicit(lambda, ITERATIONS)?,
            };
            let seconds = start.elapsed().as_secs_f64() / ITERATIONS as f64;
            let products = match smoothed.report.approach {
                Approach::Series { degree } => degree,
                Approach::ConjugateGradients { iterations } => iterations,
                _ => ITERATIONS,
            };
            let n = model.noisy.vertex_count();
            table.push(row![model.name, n, flow, lambda, products, seconds]);
        }
    }
    Ok(table)
}

/// Implicit steps beside explicit steps: of the same number, and of the same time.
fn over_iterations(model: &Model) -> Result<Picture> {
    // As many explicit steps as take the same diffusion time.
    let equal = COMPARED.map(|n| (n as f64 * CLAIMED / EXPLICIT).round() as usize);
    let mut meshes = vec![];
    for n in COMPARED {
        let title = format!("implicit {CLAIMED} × {n}");
        meshes.push((title, model.implicit(CLAIMED, n)?.mesh));
    }
    for (lambda, n) in equal.map(|n| (EXPLICIT, n)).into_iter().chain(COMPARED.map(|n| (REPORT, n)))
    {
        let title = format!("explicit {lambda} × {n}");
        meshes.push((title, model.explicit(lambda, n)?.mesh));
    }
    let mut apart = 0.0_f64;
    for (implicit, explicit) in meshes.iter().take(2).zip(&meshes[2..]) {
        apart = apart.max(vertex_displacement(&implicit.1, &explicit.1)?.rms / model.h());
    }
    let heading = if apart < INVISIBLE { "figure iterations alike" } else { "figure iterations" };
    let values = values! { apart, ratio: CLAIMED / REPORT, name: model.name, report: REPORT };
    let caption = TEXT.say(heading, values)?;
    let count = 2 * meshes.len();
    let alt = TEXT.say("figure iterations alt", values! { count, name: model.name })?;
    let id = format!("{}-iterations", model.slug());
    over_lambda::side_by_side(model, &id, &meshes, &caption, &alt)
}
