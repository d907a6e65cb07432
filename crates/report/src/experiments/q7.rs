//! Question 7: denoising under growing noise.

use anyhow::{Context as _, Result};
use fairing_evaluation::NoiseLevel;
use fairing_mesh::io::Reader;
use fairing_shapes as shapes;

use super::restoring::{
    Body, EXPLICIT, IMPLICIT, MODES, Method, REPORT_EXPLICIT, REPORT_IMPLICIT, Trials,
};
use crate::experiment::inputs::Input;
use crate::experiment::outcome::Outcome;
use crate::experiment::text::values;
use crate::experiment::{Card, Context, Experiment};
use crate::model::table::{Cell, Table, Tables, Tolerance, Unit};
use crate::model::verdict::Judgement;
use crate::row;

mod levels;
mod limits;
mod methods;
mod pictures;

use limits::ERRORS;
use methods::{ASSIGNMENT, KEPT, METHODS, SHRUNK, STRICT, TEXT};
use pictures::Restored;

pub(super) struct GrowingNoise;

/// The levels of the sweep, in mean edge lengths.
const SWEEP: [f64; 9] = [0.05, 0.1, 0.2, 0.3, 0.45, 0.7, 1.4, 2.0, 3.0];

/// The same for a quick run.
const QUICK: [f64; 3] = [0.3, 0.7, 2.0];

/// Numbers of seeds: of most methods, and of those that take several times as long as all others
/// together. The standard error of the normal error is then well below a degree where a method is
/// near the limit of a kept shape.
const SEEDS: [usize; 2] = [5, 3];

/// Seeds of the trained denoiser, which decides nothing here and takes half of the time.
const TRAINED_SEEDS: usize = 2;

/// A denoiser that leaves more than this at one level of noise, in degrees, is not run at higher
/// ones.
const HOPELESS: f64 = 20.0;

impl Experiment for GrowingNoise {
    fn card(&self) -> Card {
        let [lowest, .., highest] = SWEEP;
        let ours = format!("uniform, {EXPLICIT}; {REPORT_EXPLICIT}");
        let seeds = values! { most: SEEDS[0], slow: SEEDS[1], trained: TRAINED_SEEDS };
        let parameters = vec![
            ("explicit", ours),
            ("implicit", format!("uniform, {IMPLICIT}; {REPORT_IMPLICIT}")),
            ("spectral", format!("one mode in {MODES} up to a gap, random-walk weights")),
            ("Taubin and denoisers", TEXT.words("parameter denoisers", &[])),
            ("seeds", TEXT.words("parameter seeds", seeds)),
        ];
        let values = values! {
            lowest, highest, modes: MODES, hopeless: HOPELESS, kept: KEPT, shrunk: SHRUNK,
            sharp: 2.0 * KEPT, errors: ERRORS, strict: STRICT,
        };
        TEXT.card(&[Input::Fandisk, Input::Scan], parameters, values)
    }

    fn run(&self, context: &Context<'_>) -> Result<Outcome> {
        let (part, bodies) = bodies(context)?;
        let detailed = bodies.last().context("no meshes")?;
        let (mut of_part, mut of_detailed) = (Restored::default(), Restored::default());
        let model = model(context, &part, &mut of_part)?;
        let sweep = sweep(context, &bodies, &mut of_detailed)?;
        context.progress(0.8, "resolutions");
        let resolutions = levels::resolutions(context)?;
        let modes = modes([&part].into_iter().chain(&bodies))?;
        let limits = limits::table(&sweep)?;
        let kept = limits::kept(&sweep)?;
        context.progress(0.9, "pictures");
        let (levels, levels_view) = pictures::levels(context, &part, &of_part)?;
        let (scan, scan_view) = pictures::scan(context, detailed, &of_detailed)?;
        let mut figures = vec![levels];
        let drawn: Vec<&Body> = bodies.iter().chain([&part]).collect();
        figures.extend(pictures::curves(&sweep, &model, &drawn)?);
        figures.push(scan);
        let views = vec![levels_view, scan_view];
        let tables = vec![kept, model, limits, resolutions, modes, sweep];
        Ok(Outcome { tables, figures, views, ..Outcome::default() })
    }

    fn judge(&self, tables: Tables<'_>) -> Result<Vec<Judgement>> {
        Ok(vec![levels::judge(tables)?, limits::judge(tables)?])
    }
}

/// The model with creases of a family on which nothing was trained.
const BOLT: &[u8] = include_bytes!("../../../../data/bolt.ply");

/// The machine part, and the meshes of the sweep: three with creases, a smooth one, and at last one
/// with details, each under the name of what it is.
fn bodies(context: &Context<'_>) -> Result<(Body, Vec<Body>)> {
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
    let coarse = if context.is_stand_in(Input::Fandisk) || quick {
        "coarse machine part"
    } else {
        "generated machine part"
    };
    let is_scan = name == "bunny";
    let detailed = Body::new(name, detailed)?.with_modes()?;
    let cube = shapes::cube(context.choose(16, 8), shapes::Diagonals::Alternating);
    let mut bodies = vec![
        Body::new(coarse, shapes::cad_block(context.choose(0.25, 0.3)))?.with_modes()?.trained_on(),
        Body::new("divided cube", cube)?.with_modes()?,
        Body::new("torus", shapes::torus(1.0, 0.4, rings[0], rings[1]))?.with_modes()?.trained_on(),
        if is_scan { detailed } else { detailed.trained_on() },
    ];
    if !quick {
        let bolt = Reader::default().read_bytes("bolt.ply", BOLT)?.mesh;
        bodies.insert(2, Body::new("bolt", bolt)?.with_modes()?);
    }
    let part = Body::new("machine part", part)?.with_modes()?;
    let is_generated = quick || context.is_stand_in(Input::Fandisk);
    Ok((if is_generated { part.trained_on() } else { part }, bodies))
}

/// Errors of all methods under the levels of the assignment.
fn model(context: &Context<'_>, part: &Body, restored: &mut Restored) -> Result<Table> {
    let mut model = table(
        "model",
        &TEXT.say("table model", &[])?,
        &[
            ("mesh", Unit::Label),
            ("σ", Unit::Length),
            ("σ/h", Unit::EdgeLengths),
            ("σ/diagonal", Unit::Diagonals),
        ],
    )?;
    let mut running = Running::all(context);
    for (k, &sigma) in ASSIGNMENT.iter().enumerate() {
        context.progress(0.1 * k as f64, "model units");
        let h = part.truth.mean_edge_length();
        let leading = row![part.name, sigma, sigma / h, sigma / part.truth.diagonal()];
        let level = NoiseLevel::Model(sigma);
        let trials = running.trials(context, part, level)?;
        push(&mut model, &leading, &trials, part.truth.face_count());
        restored.keep(level, trials);
    }
    Ok(model)
}

/// Errors of all methods over the noise in mean edge lengths; results on the last mesh are kept.
fn sweep(context: &Context<'_>, bodies: &[Body], restored: &mut Restored) -> Result<Table> {
    let levels = context.choose(&SWEEP[..], &QUICK);
    let mut sweep = table(
        "sweep",
        &TEXT.say("table sweep", &[])?,
        &[("mesh", Unit::Label), ("σ/h", Unit::EdgeLengths)],
    )?;
    for (b, body) in bodies.iter().enumerate() {
        let mut running = Running::all(context);
        for (k, &sigma) in levels.iter().enumerate() {
            let done = (b * levels.len() + k) as f64 / (bodies.len() * levels.len()) as f64;
            context.progress(0.3 + 0.5 * done, body.name);
            let level = NoiseLevel::EdgeLengths(sigma);
            let trials = running.trials(context, body, level)?;
            push(&mut sweep, &row![body.name, sigma], &trials, body.truth.face_count());
            if b + 1 == bodies.len() {
                restored.keep(level, trials);
            }
        }
    }
    Ok(sweep)
}

/// The methods that are still run as the noise of a model grows, with their numbers of seeds.
struct Running(Vec<(Method, usize)>);

impl Running {
    fn all(context: &Context<'_>) -> Self {
        let seeds = context.choose(SEEDS, [2, 2]);
        let of = |(method, quick): (Method, bool)| {
            let slow = if method.is_trained() { TRAINED_SEEDS } else { seeds[1] };
            (method, if quick { seeds[0] } else { slow })
        };
        Self(METHODS.map(of).to_vec())
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
        &TEXT.say("table modes", &[])?,
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

fn table(id: &str, caption: &str, leading: &[(&str, Unit)]) -> Result<Table> {
    let caption = format!("{caption} {}", TEXT.say("table means", &[])?);
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
    let mut table = Table::new(id, &caption, &columns).aside(&aside);
    for column in
        ["normal error", "± normal error", "vertex error", "± vertex error", "flipped", "volume"]
    {
        let absolute = if column == "flipped" || column == "volume" { 0.05 } else { 1e-3 };
        table = table.tolerance(column, Some(Tolerance { relative: 0.02, absolute }));
    }
    Ok(table)
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
