//! Question 7: denoising under growing noise.

use anyhow::{Context as _, Result};
use fairing_evaluation::NoiseLevel;
use fairing_shapes as shapes;

use super::restoring::{
    Body, EXPLICIT, IMPLICIT, MODES, Method, REPORT_EXPLICIT, REPORT_IMPLICIT, Trials,
};
use crate::experiment::inputs::Input;
use crate::experiment::outcome::Outcome;
use crate::experiment::{Card, Context, Experiment};
use crate::model::section::{Act, Section};
use crate::model::table::{Cell, Table, Tables, Tolerance, Unit};
use crate::model::verdict::Judgement;
use crate::row;

mod levels;
mod limits;
mod methods;
mod pictures;

use limits::ERRORS;
use methods::{ASSIGNMENT, KEPT, METHODS, SHRUNK};

pub(super) struct GrowingNoise;

/// The levels of the sweep, in mean edge lengths.
const SWEEP: [f64; 9] = [0.05, 0.1, 0.2, 0.3, 0.45, 0.7, 1.4, 2.0, 3.0];

/// The same for a quick run.
const QUICK: [f64; 3] = [0.3, 0.7, 2.0];

/// Numbers of seeds: of most methods, and of those that take several times as long as all others
/// together. The standard error of the normal error is then well below a degree where a method is
/// near the limit of a kept shape.
const SEEDS: [usize; 2] = [5, 3];

/// A denoiser that leaves more than this at one level of noise, in degrees, is not run at higher
/// ones.
const HOPELESS: f64 = 20.0;

/// The section of the article.
fn section() -> Section {
    Section::new(
        Act::Diffusion,
        "Now noise is added on purpose, so that the error is known. When does smoothing bring a shape \
                closer to the truth?",
    )
    .commands(&["fairing noise truth.ply -o noisy.ply --sigma 0.3 --kind axes", "fairing smooth noisy.ply -o smooth.ply --method explicit --lambda 0.5 --iterations 10", "fairing compare smooth.ply truth.ply"])
    .edge_lengths_of("the mesh without noise, the truth")
    .sources(&["desbrun1999", "taubin1995", "zheng2011", "zhang2015"])
    .notation(&["T", "n", "E_a", "E_v"])
    .shows(&["levels-view", "normals", "levels"], &[])
    .names(&[("scan-view", "the shape with details"), ("distances", "distances over the noise"), ("model", "the machine part under the assignment's noise"), ("limits", "where each method helps"), ("resolution", "one part with faces of five sizes"), ("modes", "modes of the spectral method"), ("sweep", "three meshes under noise")])
}

impl Experiment for GrowingNoise {
    fn card(&self) -> Card {
        let [lowest, .., highest] = SWEEP;
        Card {
            id: "q7",
            title: "Denoising under growing noise",
            question: "When does smoothing remove noise, and when does it fail? What works instead?".into(),
            method: format!(
                "Gaussian noise is added along each axis: to the machine part with the assignment's levels in model units; to a generated machine part with coarse faces, a smooth torus and a shape with details, with {lowest} to {highest} mean edge lengths h. All methods get the same noisy meshes and keep the same parameters at every level; the automatic denoiser has none. Its networks are trained on generated meshes, among them machine parts, tori and creatures: on such shapes its results are no test of it. The section on denoisers has meshes that it has not seen.\n\nFour flows are run. Two have the steps that the original report recommends in its other answers, since it does not say what it used here: {} explicit ones of {}, {} implicit ones of {}. Two are our choice and cover the same diffusion time: {EXPLICIT}; and {IMPLICIT}. The spectral method projects onto the smoothest of the modes of the edge graph, one in {MODES}, which does not depend on the noise, and up to the next gap between eigenvalues; in a cluster of equal ones the result would depend on the solver. A denoiser that leaves more than {HOPELESS}° at one level is not run at higher ones.\n\nMeasured are the normal error E_a, the mean angle between the normals of matching faces of the result and of the truth, and the vertex error E_v, the mean distance of the vertices from the true surface. A method helps where an error falls below that of the noisy input: smoothing also removes shape, so that at low noise it can do more harm than the noise. A shape is called kept while the normal error stays below {KEPT}° and no more than {SHRUNK} % of the volume is lost: two faces that are off by {KEPT}° each are {}° apart, the angle at which we call an edge sharp. The standard error of a mean is its standard deviation from seed to seed over the square root of the number of seeds; a level at which a shape is lost is found by interpolation, and its uncertainty is that of {ERRORS} standard errors.",
                REPORT_EXPLICIT.count,
                REPORT_EXPLICIT.lambda,
                REPORT_IMPLICIT.count,
                REPORT_IMPLICIT.lambda,
                2.0 * KEPT
            ),
            formulas: FORMULAS.map(String::from).to_vec(),
            section: section(),
            inputs: &[Input::Fandisk, Input::Scan],
            parameters: vec![
                ("explicit", format!("uniform, {EXPLICIT}; {REPORT_EXPLICIT}")),
                ("implicit", format!("uniform, {IMPLICIT}; {REPORT_IMPLICIT}")),
                ("spectral", format!("one mode in {MODES} up to a gap, random-walk weights")),
                (
                    "Taubin and denoisers",
                    "defaults; non-iterative denoising is left out, because its radius widens with the noise"
                        .into(),
                ),
                (
                    "seeds",
                    format!(
                        "{}; {} for bilateral, L0, total variation and guided filtering, which take longer than all others together",
                        SEEDS[0], SEEDS[1]
                    ),
                ),
            ],
        }
    }

    fn run(&self, context: &Context<'_>) -> Result<Outcome> {
        let (part, bodies) = bodies(context)?;
        let model = model(context, &part)?;
        let sweep = sweep(context, &bodies)?;
        context.progress(0.7, "resolutions");
        let resolutions = levels::resolutions(context)?;
        let modes = modes([&part].into_iter().chain(&bodies))?;
        let limits = limits::table(&sweep)?;
        context.progress(0.85, "pictures");
        let (levels, levels_view) = pictures::levels(context, &part)?;
        let (scan, scan_view) = pictures::scan(context, &bodies[2])?;
        let mut figures = vec![levels];
        let drawn: Vec<&Body> = bodies.iter().chain([&part]).collect();
        figures.extend(pictures::curves(&sweep, &model, &drawn)?);
        figures.push(scan);
        let views = vec![levels_view, scan_view];
        let tables = vec![model, limits, resolutions, modes, sweep];
        Ok(Outcome { tables, figures, views, ..Outcome::default() })
    }

    fn judge(&self, tables: Tables<'_>) -> Result<Vec<Judgement>> {
        Ok(vec![levels::judge(tables)?, limits::judge(tables)?])
    }
}

/// The machine part, and the meshes of the sweep: one with creases, a smooth one, and one with
/// details, each under the name of what it is.
fn bodies(context: &Context<'_>) -> Result<(Body, [Body; 3])> {
    // A quick run is to be quick.
    let quick = context.is_quick();
    let part = if quick { shapes::cad_block(0.25) } else { context.mesh(Input::Fandisk)? };
    let rings = context.choose([48, 20], [40, 16]);
    let (name, detailed) = match context.mesh_if_present(Input::Scan)? {
        _ if quick => ("bumpy ball", shapes::bumpy_sphere(3, 0.12, 4.0)),
        Some(scan) => ("bunny", scan),
        None => ("creature", shapes::creature(48)),
    };
    // The stand-in is the same part with finer faces.
    let coarse = match context.is_stand_in(Input::Fandisk) || quick {
        true => "coarse machine part",
        false => "generated machine part",
    };
    let is_scan = name == "bunny";
    let detailed = Body::new(name, detailed)?.with_modes()?;
    let bodies = [
        Body::new(coarse, shapes::cad_block(context.choose(0.25, 0.3)))?.with_modes()?.trained_on(),
        Body::new("torus", shapes::torus(1.0, 0.4, rings[0], rings[1]))?.with_modes()?.trained_on(),
        if is_scan { detailed } else { detailed.trained_on() },
    ];
    let part = Body::new("machine part", part)?.with_modes()?;
    let is_generated = quick || context.is_stand_in(Input::Fandisk);
    Ok((if is_generated { part.trained_on() } else { part }, bodies))
}

/// Errors of all methods under the levels of the assignment.
fn model(context: &Context<'_>, part: &Body) -> Result<Table> {
    let mut model = table(
        "model",
        "The machine part under the assignment's noise, σ in model units.",
        &[
            ("mesh", Unit::Label),
            ("σ", Unit::Length),
            ("σ/h", Unit::EdgeLengths),
            ("σ/diagonal", Unit::Diagonals),
        ],
    );
    let mut running = Running::all(context);
    for (k, &sigma) in ASSIGNMENT.iter().enumerate() {
        context.progress(0.1 * k as f64, "model units");
        let h = part.truth.mean_edge_length();
        let leading = row![part.name, sigma, sigma / h, sigma / part.truth.diagonal()];
        let trials = running.trials(context, part, NoiseLevel::Model(sigma))?;
        push(&mut model, &leading, &trials, part.truth.face_count());
    }
    Ok(model)
}

/// Errors of all methods over the noise in mean edge lengths.
fn sweep(context: &Context<'_>, bodies: &[Body; 3]) -> Result<Table> {
    let levels = context.choose(&SWEEP[..], &QUICK);
    let mut sweep = table(
        "sweep",
        "Three meshes under noise in mean edge lengths.",
        &[("mesh", Unit::Label), ("σ/h", Unit::EdgeLengths)],
    );
    for (b, body) in bodies.iter().enumerate() {
        let mut running = Running::all(context);
        for (k, &sigma) in levels.iter().enumerate() {
            let done = (b * levels.len() + k) as f64 / (bodies.len() * levels.len()) as f64;
            context.progress(0.3 + 0.4 * done, body.name);
            let trials = running.trials(context, body, NoiseLevel::EdgeLengths(sigma))?;
            push(&mut sweep, &row![body.name, sigma], &trials, body.truth.face_count());
        }
    }
    Ok(sweep)
}

/// The methods that are still run as the noise of a model grows, with their numbers of seeds.
struct Running(Vec<(Method, usize)>);

impl Running {
    fn all(context: &Context<'_>) -> Self {
        let seeds = context.choose(SEEDS, [2, 2]);
        Self(METHODS.map(|(method, quick)| (method, seeds[usize::from(!quick)])).to_vec())
    }

    /// All of them at one level; those that leave too much are not run again.
    fn trials(
        &mut self,
        context: &Context<'_>,
        body: &Body,
        level: NoiseLevel,
    ) -> Result<Vec<Trials>> {
        let trials = body.trials(level, context.seed("noise"), &self.0)?;
        let is_denoiser = |method: Method| method != Method::Nothing && !method.is_linear();
        let lost = |t: &&Trials| is_denoiser(t.method) && t.angle.mean > HOPELESS;
        let lost: Vec<Method> = trials.iter().filter(lost).map(|t| t.method).collect();
        self.0.retain(|(method, _)| !lost.contains(method));
        Ok(trials)
    }
}

/// Number of modes kept by the spectral method on each model.
fn modes<'a>(bodies: impl Iterator<Item = &'a Body>) -> Result<Table> {
    let mut table = Table::new(
        "modes",
        "A twentieth of the modes, the number that the spectral method keeps to end at a gap between eigenvalues, and this gap over the eigenvalue behind it. Without a gap the result would depend on the basis of an eigenspace.",
        &[
            ("mesh", Unit::Label),
            ("vertices", Unit::Count),
            ("a twentieth", Unit::Count),
            ("kept", Unit::Count),
            ("gap", Unit::Relative),
        ],
    );
    for body in bodies {
        let kept = body.kept_modes().context("a model without modes")?;
        let n = body.truth.vertex_count();
        table.push(row![body.name, n, kept.wanted, kept.modes, kept.gap]);
    }
    Ok(table)
}

fn table(id: &str, caption: &str, leading: &[(&str, Unit)]) -> Table {
    let caption = format!(
        "{caption} Means over the seeds, each followed by the standard deviation from seed to seed; flipped faces are those that oppose the truth."
    );
    let columns = [
        ("method", Unit::Label),
        ("seeds", Unit::Count),
        ("normal error", Unit::Degrees),
        ("± normal error", Unit::Degrees),
        ("vertex error", Unit::EdgeLengths),
        ("± vertex error", Unit::EdgeLengths),
        ("flipped", Unit::Percent),
        ("volume", Unit::Percent),
    ];
    let columns: Vec<_> = leading.iter().copied().chain(columns).collect();
    let aside = ["σ/diagonal", "seeds", "± vertex error"];
    let aside: Vec<&str> =
        aside.into_iter().filter(|name| columns.iter().any(|(known, _)| known == name)).collect();
    // Thresholds on noisy normals amplify the last digits.
    ["normal error", "± normal error", "vertex error", "± vertex error", "flipped", "volume"]
        .into_iter()
        .fold(Table::new(id, &caption, &columns).aside(&aside), |table, column| {
            let absolute = if column == "flipped" || column == "volume" { 0.05 } else { 1e-3 };
            table.tolerance(column, Some(Tolerance { relative: 0.02, absolute }))
        })
}

fn push(table: &mut Table, leading: &[Cell], trials: &[Trials], faces: usize) {
    for t in trials {
        let measured = row![
            t.method.name(),
            t.seeds,
            t.angle.mean,
            t.angle.deviation,
            t.distance.mean,
            t.distance.deviation,
            100.0 * t.flipped.mean / faces as f64,
            t.volume.map(|v| v.mean),
        ];
        table.push(leading.iter().cloned().chain(measured));
    }
}

const FORMULAS: [&str; 1] =
    [r"E_a = \text{mean over the triangles } T \text{ of } \arccos(n_T \cdot \hat n_T)"];
