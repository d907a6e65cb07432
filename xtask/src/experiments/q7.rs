//! Question 7: denoising under growing noise.

use anyhow::Result;
use fairing_evaluation::{NoiseKind, NoiseLevel, add_noise, flipped_faces, normal_error};
use fairing_mesh::{TriMesh, shapes};
use fairing_smoothing::denoise::Denoiser;
use fairing_smoothing::{Diffusion, Explicit, Implicit, Taubin, explicit, implicit, taubin};

use crate::experiment::{Card, Context, Experiment, Formula};
use crate::inputs::Input;
use crate::outcome::Outcome;
use crate::row;
use crate::table::{Table, Tables, Unit, short};
use crate::verdict::{Judgement, Verdict};

pub(super) struct GrowingNoise;

/// The assignment's levels, in model units.
const ASSIGNMENT: [f64; 3] = [0.05, 0.1, 0.5];

/// The levels of the sweep, in mean edge lengths.
const SWEEP: [f64; 8] = [0.05, 0.1, 0.2, 0.3, 0.5, 0.7, 1.0, 2.0];

/// Seeds at each level: enough for the spread to be seen, few enough for minutes.
const SEEDS: u64 = 3;

/// A shape counts as kept if a method leaves less than this mean normal error.
const KEPT: f64 = 15.0;

/// A method and what it returns.
type Method = (&'static str, fn(&TriMesh) -> Result<TriMesh>);

const METHODS: [Method; 6] = [
    ("explicit", |mesh| Ok(explicit(mesh, &Explicit::new(Diffusion::uniform(0.5)), None)?.mesh)),
    ("implicit", |mesh| {
        let options = Implicit { iterations: 1, ..Implicit::new(Diffusion::uniform(5.0)) };
        Ok(implicit(mesh, &options, None)?.mesh)
    }),
    ("Taubin", |mesh| Ok(taubin(mesh, &Taubin::default(), None)?.mesh)),
    ("bilateral normal", |mesh| Ok(Denoiser::BilateralNormal.denoise(mesh)?)),
    ("guided normal", |mesh| Ok(Denoiser::GuidedNormal.denoise(mesh)?)),
    ("automatic", |mesh| Ok(Denoiser::Automatic.denoise(mesh)?)),
];

impl Experiment for GrowingNoise {
    fn card(&self) -> Card {
        Card {
            id: "q7",
            title: "Denoising under growing noise",
            question: "When does smoothing remove noise, and when does it fail? What works instead?",
            method: "Gaussian noise is added along each axis, first with the assignment's levels in model units, then from 0.05 to 2 mean edge lengths h. Each method gets the same noisy meshes, with the same parameters at every level; the automatic denoiser has none.\n\nMeasured is E_a, the mean angle between the normals of matching faces of the result and of the truth, over several seeds. A method helps while E_a falls below that of the noisy mesh; the shape is called kept while E_a stays below 15°.",
            formulas: &[Formula {
                tex: r"E_a = \frac{1}{|F|} \sum_{f \in F} \arccos(n_f \cdot \hat n_f)",
                mathml: "<msub><mi>E</mi><mi>a</mi></msub><mo>=</mo><mfrac><mn>1</mn><mrow><mo>|</mo><mi>F</mi><mo>|</mo></mrow></mfrac><munder><mo>∑</mo><mrow><mi>f</mi><mo>∈</mo><mi>F</mi></mrow></munder><mi>arccos</mi><mo>(</mo><msub><mi>n</mi><mi>f</mi></msub><mo>·</mo><msub><mover><mi>n</mi><mo>^</mo></mover><mi>f</mi></msub><mo>)</mo>",
            }],
            inputs: &[Input::Fandisk],
            parameters: vec![
                ("explicit", "uniform, λ = 0.5, 10 steps".into()),
                ("implicit", "uniform, λ = 5, 1 step".into()),
                ("Taubin, bilateral and guided normal filtering", "defaults".into()),
                ("seeds", SEEDS.to_string()),
            ],
        }
    }

    fn run(&self, context: &Context<'_>) -> Result<Outcome> {
        let part = context.mesh(Input::Fandisk)?;
        let smooth = shapes::icosphere(context.choose(4, 3));
        let mut model = table("model", "E_a on the machine part, σ in model units.");
        let mut sweep = table("sweep", "E_a over the noise level in mean edge lengths.");
        let levels = context.choose(&SWEEP[..], &SWEEP[2..4]);
        let total = (ASSIGNMENT.len() + 2 * levels.len()) as f64;
        for (k, &sigma) in ASSIGNMENT.iter().enumerate() {
            context.progress(k as f64 / total, "model units");
            measure(context, &mut model, "part", &part, NoiseLevel::Model(sigma), sigma)?;
        }
        for (m, (name, mesh)) in [("part", &part), ("sphere", &smooth)].into_iter().enumerate() {
            for (k, &sigma) in levels.iter().enumerate() {
                let done = ASSIGNMENT.len() + m * levels.len() + k;
                context.progress(done as f64 / total, name);
                measure(context, &mut sweep, name, mesh, NoiseLevel::EdgeLengths(sigma), sigma)?;
            }
        }
        Ok(Outcome { tables: vec![model, sweep], ..Outcome::default() })
    }

    fn judge(&self, tables: Tables<'_>) -> Result<Vec<Judgement>> {
        let model = tables.get("model")?;
        let mut best = vec![];
        for sigma in ASSIGNMENT {
            let rows = model.only(&[("σ", sigma.into())])?;
            let least = rows.column("E_a")?.into_iter().fold(f64::INFINITY, f64::min);
            best.push((least, rows.column("σ/h")?[0]));
        }
        let kept = best.iter().map(|(least, _)| *least < KEPT).collect::<Vec<_>>();
        let verdict = match kept[..] {
            [true, true, false] => Verdict::Qualified,
            [_, _, true] => Verdict::Refuted,
            _ => Verdict::Qualified,
        };
        let list = |f: fn(&(f64, f64)) -> f64| {
            best.iter().map(|b| short(f(b))).collect::<Vec<_>>().join(", ")
        };
        let reason = format!(
            "What decides is the noise level over the mean edge length, not in model units: the three levels are {} h on this mesh, and the best method leaves {}° there.",
            list(|b| b.1),
            list(|b| b.0),
        );
        let judgement = Judgement::new(
            "7a",
            "σ = 0.05 and 0.1 keep the shape, 0.5 destroys it",
            verdict,
            reason,
        );
        Ok(vec![
            judgement
                .number("best E_a at the lowest level", best[0].0, Unit::Degrees)
                .number("best E_a at the highest level", best[2].0, Unit::Degrees)
                .number("the highest level", best[2].1, Unit::EdgeLengths),
        ])
    }
}

fn table(id: &str, caption: &str) -> Table {
    let caption = format!(
        "{caption} Mean and standard deviation over the seeds; flipped faces are those that oppose the truth."
    );
    Table::new(
        id,
        &caption,
        &[
            ("mesh", Unit::Label),
            ("σ", Unit::One),
            ("σ/h", Unit::EdgeLengths),
            ("method", Unit::Label),
            ("noisy E_a", Unit::Degrees),
            ("E_a", Unit::Degrees),
            ("spread", Unit::Degrees),
            ("flipped", Unit::Count),
        ],
    )
}

/// A row for each method at one level.
fn measure(
    context: &Context<'_>,
    table: &mut Table,
    name: &str,
    truth: &TriMesh,
    level: NoiseLevel,
    sigma: f64,
) -> Result<()> {
    let seeds = context.choose(SEEDS, 1);
    let first = context.seed("noise");
    let noisy: Vec<TriMesh> = (0..seeds)
        .map(|k| add_noise(truth, NoiseKind::GaussianPerAxis, level, first.wrapping_add(k)))
        .collect::<Result<_, _>>()?;
    let share = level.in_mesh_units(truth) / truth.mean_edge_length();
    let before = spread(noisy.iter().map(|m| Ok(normal_error(m, truth)?.mean)))?.0;
    for (method, run) in METHODS {
        let results: Vec<TriMesh> = noisy.iter().map(run).collect::<Result<_>>()?;
        let (mean, deviation) = spread(results.iter().map(|m| Ok(normal_error(m, truth)?.mean)))?;
        let flipped = spread(results.iter().map(|m| Ok(flipped_faces(m, truth)? as f64)))?.0;
        table.push(row![name, sigma, share, method, before, mean, deviation, flipped]);
    }
    Ok(())
}

/// Mean and standard deviation.
fn spread(values: impl Iterator<Item = Result<f64>>) -> Result<(f64, f64)> {
    let values: Vec<f64> = values.collect::<Result<_>>()?;
    let count = values.len().max(1) as f64;
    let mean = values.iter().sum::<f64>() / count;
    let variance = values.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>() / count;
    Ok((mean, variance.sqrt()))
}
