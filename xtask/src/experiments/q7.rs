//! Question 7: denoising under growing noise.

use anyhow::Result;
use fairing_evaluation::NoiseLevel;
use fairing_mesh::shapes;
use fairing_smoothing::denoise::Denoiser;

use super::restoring::{Body, MODES, Method, Trials};
use crate::experiment::{Card, Context, Experiment, Formula};
use crate::inputs::Input;
use crate::outcome::Outcome;
use crate::row;
use crate::table::{Cell, Table, Tables, Tolerance, Unit, short};
use crate::verdict::{Judgement, Verdict};

mod limits;
mod pictures;

pub(super) struct GrowingNoise;

/// The assignment's levels, in model units.
const ASSIGNMENT: [f64; 3] = [0.05, 0.1, 0.5];

/// The levels of the sweep, in mean edge lengths.
const SWEEP: [f64; 5] = [0.05, 0.1, 0.3, 0.7, 2.0];

/// Seeds of the methods, and of those that take several times as long as all others together.
const SEEDS: [usize; 2] = [20, 2];

/// A shape counts as kept if less than this is left of the mean normal error, in degrees: two faces that
/// are off by as much each are 30° apart, from where on an edge counts as sharp.
const KEPT: f64 = 15.0;

/// The methods, and whether they are quick enough for all seeds. Non-iterative denoising is left to the
/// comparison of denoisers: its radius grows with the noisy edges, at high noise to the size of the mesh.
const METHODS: [(Method, bool); 13] = [
    (Method::Nothing, true),
    (Method::Explicit, true),
    (Method::Implicit, true),
    (Method::Taubin, true),
    (Method::Spectral, true),
    (Method::Denoiser(Denoiser::Bilateral), false),
    (Method::Denoiser(Denoiser::FastEffective), true),
    (Method::Denoiser(Denoiser::BilateralNormal), true),
    (Method::Denoiser(Denoiser::BilateralNormalGlobal), true),
    (Method::Denoiser(Denoiser::L0), false),
    (Method::Denoiser(Denoiser::TotalVariation), false),
    (Method::Denoiser(Denoiser::GuidedNormal), false),
    (Method::Denoiser(Denoiser::Automatic), true),
];

impl Experiment for GrowingNoise {
    fn card(&self) -> Card {
        Card {
            id: "q7",
            title: "Denoising under growing noise",
            question: "When does smoothing remove noise, and when does it fail? What works instead?",
            method: "Gaussian noise is added along each axis: to the machine part with the assignment's levels in model units; to a machine part, a smooth body and a scan with 0.05 to 2 mean edge lengths h. All methods get the same noisy meshes and keep the same parameters at every level; the automatic denoiser has none. Explicit and implicit smoothing cover the same diffusion time; the spectral method projects onto the smoothest twentieth of the modes of the edge graph, which does not depend on the noise.\n\nMeasured are E_a, the mean angle between the normals of matching faces of the result and of the truth, and E_v, the mean distance of the vertices from the true surface. A method helps where an error falls below that of the noisy input: smoothing also removes shape, so that at little noise it can do harm. A shape is called kept while E_a stays below 15°: two faces that are off by as much each are 30° apart, from where on an edge counts as sharp.",
            formulas: FORMULAS,
            inputs: &[Input::Fandisk, Input::Scan],
            parameters: vec![
                ("explicit", "uniform, λ = 0.5, 10 steps".into()),
                ("implicit", "uniform, λ = 5, 1 step".into()),
                ("spectral", format!("one mode in {MODES}, random-walk weights")),
                (
                    "Taubin and denoisers",
                    "defaults; all but non-iterative denoising, whose radius grows with the noise"
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
        // A quick run is to be quick.
        let part = match context.is_quick() {
            true => shapes::cad_block(0.25),
            false => context.mesh(Input::Fandisk)?,
        };
        let (torus, scan) = match (context.is_quick(), context.mesh_if_present(Input::Scan)?) {
            (true, _) => (shapes::torus(1.0, 0.4, 40, 16), shapes::bumpy_sphere(3, 0.12, 4.0)),
            (false, Some(scan)) => (shapes::torus(1.0, 0.4, 48, 20), scan),
            (false, None) => (shapes::torus(1.0, 0.4, 48, 20), shapes::creature(52)),
        };
        let part = Body::new("machine part", part)?.with_modes()?;
        let bodies = [
            Body::new("block", shapes::cad_block(context.choose(0.25, 0.3)))?.with_modes()?,
            Body::new("torus", torus)?.with_modes()?,
            Body::new("scan", scan)?.with_modes()?,
        ];
        let mut notes = vec![];
        if context.is_quick() {
            notes.push("In this quick run a sphere with bumps takes the place of the scan, and a block that of the machine part.".into());
        } else if context.mesh_if_present(Input::Scan)?.is_none() {
            notes.push("No scan was found: a generated animal with limbs and wrinkled skin takes its place.".into());
        }
        let levels = context.choose(&SWEEP[..], &SWEEP[2..5]);
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
        for (k, &sigma) in ASSIGNMENT.iter().enumerate() {
            context.progress(0.1 * k as f64, "model units");
            let h = part.truth.mean_edge_length();
            let leading = row![part.name, sigma, sigma / h, sigma / part.truth.diagonal()];
            let trials = trials(context, &part, NoiseLevel::Model(sigma))?;
            push(&mut model, &leading, &trials, part.truth.face_count());
        }
        let mut sweep = table(
            "sweep",
            "Three meshes under noise in mean edge lengths.",
            &[("mesh", Unit::Label), ("σ/h", Unit::EdgeLengths)],
        );
        for (b, body) in bodies.iter().enumerate() {
            for (k, &sigma) in levels.iter().enumerate() {
                let done = (b * levels.len() + k) as f64 / (bodies.len() * levels.len()) as f64;
                context.progress(0.3 + 0.5 * done, body.name);
                let trials = trials(context, body, NoiseLevel::EdgeLengths(sigma))?;
                push(&mut sweep, &row![body.name, sigma], &trials, body.truth.face_count());
            }
        }
        context.progress(0.8, "resolutions");
        let resolutions = resolutions(context)?;
        let limits = limits::table(&sweep)?;
        context.progress(0.85, "pictures");
        let (levels, levels_view) = pictures::of_levels(context, &part)?;
        let (scan, scan_view) = pictures::of_scan(context, &bodies[2])?;
        let mut figures = vec![levels];
        figures.extend(pictures::curves(&sweep)?);
        figures.push(scan);
        let views = vec![levels_view, scan_view];
        let tables = vec![model, limits, resolutions, sweep];
        Ok(Outcome { tables, figures, views, notes, ..Outcome::default() })
    }

    fn judge(&self, tables: Tables<'_>) -> Result<Vec<Judgement>> {
        Ok(vec![judge_levels(tables)?, limits::judge(tables)?])
    }
}

/// Each method on its number of seeds.
fn trials(context: &Context<'_>, body: &Body, level: NoiseLevel) -> Result<Vec<Trials>> {
    let seeds = context.choose(SEEDS, [2, 1]);
    let methods = METHODS.map(|(method, quick)| (method, seeds[usize::from(!quick)]));
    body.trials(level, context.seed("noise"), &methods)
}

fn table(id: &str, caption: &str, leading: &[(&str, Unit)]) -> Table {
    let caption = format!(
        "{caption} Means over the seeds, each followed by the standard deviation from seed to seed; flipped faces are those that oppose the truth."
    );
    let columns = [
        ("method", Unit::Label),
        ("seeds", Unit::Count),
        ("E_a", Unit::Degrees),
        ("± E_a", Unit::Degrees),
        ("E_v", Unit::EdgeLengths),
        ("± E_v", Unit::EdgeLengths),
        ("flipped", Unit::Percent),
        ("volume", Unit::Percent),
    ];
    let columns: Vec<_> = leading.iter().copied().chain(columns).collect();
    // Thresholds on noisy normals amplify the last digits.
    ["E_a", "± E_a", "E_v", "± E_v", "flipped", "volume"].into_iter().fold(
        Table::new(id, &caption, &columns),
        |table, column| {
            let absolute = if column == "flipped" || column == "volume" { 0.05 } else { 1e-3 };
            table.tolerance(column, Some(Tolerance { relative: 0.02, absolute }))
        },
    )
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

/// The same block and the same noise in model units over the size of the faces.
fn resolutions(context: &Context<'_>) -> Result<Table> {
    let mut table = Table::new(
        "resolution",
        "One block, the same noise in model units, faces of two sizes: what the best flow or filter that knows nothing of creases leaves, and what the best of all methods leaves. The shape is kept where E_a falls below 15°.",
        &[
            ("vertices", Unit::Count),
            ("h", Unit::Length),
            ("σ", Unit::Length),
            ("σ/h", Unit::EdgeLengths),
            ("noisy E_a", Unit::Degrees),
            ("best flow", Unit::Label),
            ("E_a of the flow", Unit::Degrees),
            ("best method", Unit::Label),
            ("best E_a", Unit::Degrees),
            ("kept", Unit::Label),
        ],
    )
    .tolerance("E_a of the flow", Some(Tolerance::LOOSE))
    .tolerance("best E_a", Some(Tolerance::LOOSE));
    let methods = METHODS.map(|(method, _)| (method, 1));
    for spacing in context.choose(&[0.3, 0.15][..], &[0.3, 0.25]) {
        let body = Body::new("block", shapes::cad_block(*spacing))?.with_modes()?;
        let h = body.truth.mean_edge_length();
        for sigma in ASSIGNMENT {
            let level = NoiseLevel::Model(sigma);
            let trials = body.trials(level, context.seed("resolution"), &methods)?;
            let best = |linear: bool| {
                let all = trials.iter().filter(|t| t.method != Method::Nothing);
                all.filter(|t| !linear || t.method.is_linear())
                    .min_by(|a, b| a.angle.mean.total_cmp(&b.angle.mean))
                    .map(|t| (t.method.name(), t.angle.mean))
            };
            let (Some(flow), Some(best)) = (best(true), best(false)) else { continue };
            table.push(row![
                body.truth.vertex_count(),
                h,
                sigma,
                sigma / h,
                trials[0].angle.mean,
                flow.0,
                flow.1,
                best.0,
                best.1,
                if best.1 < KEPT { "yes" } else { "no" },
            ]);
        }
    }
    Ok(table)
}

fn judge_levels(tables: Tables<'_>) -> Result<Judgement> {
    let model = tables.get("model")?;
    let flows: Vec<&str> = METHODS.iter().filter(|m| m.0.is_linear()).map(|m| m.0.name()).collect();
    let name = model.index("method")?;
    let (mut best_flows, mut bests, mut shares) = (vec![], vec![], vec![]);
    for sigma in ASSIGNMENT {
        let rows = model.only(&[("σ", sigma.into())])?;
        let angles = rows.column("E_a")?;
        let least = |wanted: &dyn Fn(&str) -> bool| {
            let of = rows.rows.iter().zip(&angles);
            of.filter(|(row, _)| matches!(&row[name], Cell::Text(t) if wanted(t)))
                .map(|(_, angle)| *angle)
                .fold(f64::INFINITY, f64::min)
        };
        best_flows.push(least(&|method| flows.contains(&method)));
        bests.push(least(&|method| method != Method::Nothing.name()));
        shares.push(rows.column("σ/h")?[0]);
    }
    let kept: Vec<bool> = bests.iter().map(|angle| *angle < KEPT).collect();
    // Whether the same σ spares one resolution of the block and destroys another.
    let resolution = tables.get("resolution")?;
    let mut depends = vec![];
    for sigma in ASSIGNMENT {
        let rows = resolution.only(&[("σ", sigma.into())])?;
        let angles = rows.column("best E_a")?;
        let spared = angles.iter().any(|a| *a < KEPT);
        let destroyed = angles.iter().any(|a| *a >= KEPT);
        if spared && destroyed {
            depends.push(short(sigma));
        }
    }
    let verdict = match (&kept[..], depends.is_empty()) {
        ([true, true, false], true) => Verdict::Confirmed,
        ([false, false, true], _) => Verdict::Refuted,
        _ => Verdict::Qualified,
    };
    let list = |values: &[f64]| values.iter().map(|x| short(*x)).collect::<Vec<_>>().join(", ");
    let resolved = match depends.is_empty() {
        true => {
            "On the block of two resolutions no level is kept at one and lost at another.".into()
        }
        false => format!(
            "On the block σ = {} is kept at one resolution and lost at another: a level in model units says nothing by itself.",
            depends.join(", "),
        ),
    };
    let reason = format!(
        "On the machine part the three levels are {} h. The best flow or filter leaves {}° there, the best of all methods {}°; below 15° the shape counts as kept. {resolved}",
        list(&shares),
        list(&best_flows),
        list(&bests),
    );
    Ok(Judgement::new("7a", "σ = 0.05 and 0.1 keep the shape, 0.5 destroys it", verdict, reason)
        .number("the levels over h, lowest", shares[0], Unit::EdgeLengths)
        .number("highest", shares[2], Unit::EdgeLengths)
        .number("best E_a at σ = 0.05", bests[0], Unit::Degrees)
        .number("at 0.1", bests[1], Unit::Degrees)
        .number("at 0.5", bests[2], Unit::Degrees))
}

const FORMULAS: &[Formula] = &[Formula {
    tex: r"E_a = \frac{1}{|F|} \sum_{f \in F} \arccos(n_f \cdot \hat n_f)",
    mathml: "<msub><mi>E</mi><mi>a</mi></msub><mo>=</mo><mfrac><mn>1</mn><mrow><mo>|</mo><mi>F</mi><mo>|</mo></mrow></mfrac><munder><mo>∑</mo><mrow><mi>f</mi><mo>∈</mo><mi>F</mi></mrow></munder><mi>arccos</mi><mo>(</mo><msub><mi>n</mi><mi>f</mi></msub><mo>·</mo><msub><mover><mi>n</mi><mo>^</mo></mover><mi>f</mi></msub><mo>)</mo>",
}];
