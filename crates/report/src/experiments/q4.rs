//! Question 4: a mesh from its k smoothest modes.

mod pictures;

use anyhow::{Context as _, Result};
use fairing_evaluation::{normal_error, observed_orders, surface_distance};
use fairing_figure::Series;
use fairing_mesh::TriMesh;
use fairing_operators::Laplacian;
use fairing_shapes as shapes;
use fairing_sparse::{larger, smaller};
use fairing_spectral::{Spectrum, SpectrumOptions, reconstruct, reconstruction_errors, spectrum};
use ndarray::ArrayView2;

use self::pictures::{BALL, decay, eigenvalues, modes_picture, picture, view};
use super::gap;
use super::mode_sums;
use super::mode_sums::TEXT;
use super::refinement::between;
use super::seen;
use super::surfaces::{Sampling, TestSurface};
use super::torus;
use crate::experiment::inputs::Input;
use crate::experiment::outcome::{Attachment, Content, MeshOutput, Outcome};
use crate::experiment::text::values;
use crate::experiment::{Card, Context, Experiment};
use crate::model::table::{Table, Tables, Tolerance, Unit};
use crate::model::verdict::{Judgement, Shown, Verdict, ViewState};
use crate::model::view::View;
use crate::row;

pub(super) struct Reconstruction;

/// Numbers of modes; those beyond the size of a mesh become all of its modes.
const STOPS: [usize; 7] = [5, 15, 50, 100, 300, 600, 1000];

/// Above this many vertices the full spectrum is not computed.
const FULL: usize = 1500;

/// The figure of the first mesh from k modes.
const FIRST: &str = "rebuilt";

/// An error of all modes below this, over the diagonal, is rounding.
const ROUNDING: f64 = 1e-9;

/// Predicted errors below this are rounding, over the diagonal.
const FLOOR: f64 = 1e-12;

/// Tolerance left by the angle of the kept space.
const TRUNCATED: Tolerance = Tolerance { relative: gap::ANGLE, absolute: 1e-9 };

impl Experiment for Reconstruction {
    fn card(&self) -> Card {
        let stops = STOPS.map(|k| k.to_string()).join(", ");
        let stops = TEXT.words("stops", values! { stops });
        let parameters = vec![("k", stops), ("mass", "barycentric".into())];
        TEXT.card(&[Input::Armadillo, Input::ArmadilloLarge], parameters, &[])
    }

    fn run(&self, context: &Context<'_>) -> Result<Outcome> {
        let mut outcome = Outcome::default();
        let (mut errors, mut weyl, mut curves) = (errors_table()?, weyl_table()?, vec![]);
        let meshes = meshes(context)?;
        for (i, (name, mesh)) in meshes.iter().enumerate() {
            context.progress(i as f64 / 4.0, name);
            let rebuilt = Rebuilt::new(context, name, mesh)?;
            rebuilt.tabulate(&mut errors)?;
            rebuilt.tabulate_weyl(&mut weyl);
            curves.push(rebuilt.curve());
            rebuilt.show(&mut outcome, !context.is_quick(), i == 0)?;
        }
        outcome.views.insert(0, mode_sums::view(context)?);
        outcome.figures.push(decay(curves)?);
        context.progress(0.8, "sphere");
        let sphere = sphere(context, context.choose(5, 4))?;
        context.progress(0.9, "torus");
        let torus = torus::table(context, context.choose(4, 3))?;
        outcome.figures.push(eigenvalues(&sphere, &torus)?);
        outcome.tables.extend([errors, weyl, sphere, torus]);
        Ok(outcome)
    }

    fn judge(&self, tables: Tables<'_>) -> Result<Vec<Judgement>> {
        Ok(vec![reconstruction(tables)?, eigenvalue_orders(tables)?])
    }
}

/// Claim 4a.
fn reconstruction(tables: Tables<'_>) -> Result<Judgement> {
    let errors = tables.get("reconstruction")?;
    let (mut falling, mut mismatch, mut steps) = (true, 0.0_f64, vec![]);
    let names = errors.labels("mesh")?;
    for name in &names {
        let rows = errors.only(&[("mesh", name.as_str().into())])?;
        let measured = rows.column("measured RMS")?;
        falling &= measured.windows(2).all(|w| w[1] < w[0]);
        for (a, b) in measured.iter().zip(rows.column("predicted RMS")?) {
            mismatch = mismatch.max((a - b).abs());
        }
        steps.push(100.0 * (1.0 - measured[1] / measured[0]));
    }
    let all = errors.only(&[("mesh", names[0].as_str().into())])?;
    let ks = all.column("k")?;
    let last = all.column("measured RMS")?.last().copied().unwrap_or(f64::NAN);
    let complete = all.column("share of modes")?.last().is_some_and(|s| *s == 1.0);
    let verdict = match (falling, complete) {
        (true, true) if last < ROUNDING => Verdict::Confirmed,
        (true, false) => Verdict::Confirmed,
        _ => Verdict::Refuted,
    };
    let heading = if mismatch < ROUNDING { "rounding" } else { "of the diagonal" };
    let mismatch = TEXT.say(heading, values! { error: mismatch })?;
    let percent = |x: f64| format!("{x:.0}");
    let values = values! {
        mismatch, few: ks[0].to_string(), more: ks[1].to_string(), name: names[0].as_str(),
        step: percent(steps[0]), left: what_is_left(ks[ks.len() - 1], complete, last)?,
        least: percent(steps.iter().copied().fold(f64::INFINITY, smaller)),
        most: percent(steps.iter().copied().fold(0.0, larger)),
    };
    Ok(TEXT
        .judgement("4a", verdict, values)?
        .shown(Shown::view("q4", mode_sums::VIEW, &ViewState::modes(ks[1] as usize)))
        .number(
            &format!("the error falls from {} to {} modes by", ks[0], ks[1]),
            steps[0],
            Unit::Percent,
        )
        .number("error with all modes", last, Unit::Diagonals))
}

/// Claim 4b.
fn eigenvalue_orders(tables: Tables<'_>) -> Result<Judgement> {
    let [[least, most], [low, high]] =
        [orders(tables, Sampling::Regular)?, orders(tables, Sampling::Jittered)?];
    let is_second = |least: f64, most: f64| least > 1.9 && most < 2.1;
    let second = match (is_second(least, most), is_second(low, high)) {
        (true, true) => Verdict::Confirmed,
        (true, false) => Verdict::Qualified,
        _ => Verdict::Refuted,
    };
    let values = values! { regular: between(least, most), jittered: between(low, high) };
    Ok(TEXT
        .judgement("4b", second, values)?
        .ours()
        .shown(Shown::line("q4", "eigenvalues", "sphere"))
        .number("least order", least, Unit::Order)
        .number("greatest order", most, Unit::Order)
        .number("least order, jittered", low, Unit::Order)
        .number("greatest order, jittered", high, Unit::Order))
}

/// The least and the greatest observed order of eigenvalues, on the sphere and on the torus.
fn orders(tables: Tables<'_>, sampling: Sampling) -> Result<[f64; 2]> {
    let mut orders = vec![];
    for surface in ["sphere", "torus"] {
        let rows = tables.get(surface)?.only(&[("sampling", sampling.name().into())])?;
        orders.extend(rows.numbers("order")?);
    }
    let least = orders.iter().copied().fold(f64::INFINITY, smaller);
    Ok([least, orders.iter().copied().fold(f64::NEG_INFINITY, larger)])
}

/// The error at the last stop, in words.
fn what_is_left(modes: f64, complete: bool, last: f64) -> Result<String> {
    let heading = if !complete {
        "left at the last"
    } else if last < ROUNDING {
        "left rounding"
    } else {
        "left"
    };
    TEXT.say(heading, values! { modes: modes as usize, last })
}

/// The stops for a mesh, the last of them all modes where that is cheap.
fn stops(vertices: usize, most: usize) -> Vec<usize> {
    let mut stops: Vec<usize> = STOPS.into_iter().filter(|&k| k < vertices && k <= most).collect();
    if vertices <= FULL {
        stops.push(vertices);
    }
    stops
}

fn errors_table() -> Result<Table> {
    let table = Table::new(
        "reconstruction",
        &TEXT.say("table reconstruction", &[])?,
        &[
            ("mesh", Unit::Label),
            ("k", Unit::Count),
            ("share of modes", Unit::Relative),
            ("predicted RMS", Unit::Diagonals),
            ("measured RMS", Unit::Diagonals),
            ("largest distance", Unit::Diagonals),
            ("normal error", Unit::Degrees),
        ],
    );
    Ok(table
        .tolerance("predicted RMS", Some(TRUNCATED))
        .tolerance("measured RMS", Some(TRUNCATED))
        .tolerance("largest distance", Some(Tolerance::LOOSE))
        .tolerance("normal error", Some(Tolerance::LOOSE)))
}

fn weyl_table() -> Result<Table> {
    let table = Table::new(
        "weyl",
        &TEXT.say("table weyl", &[])?,
        &[
            ("mesh", Unit::Label),
            ("k", Unit::Count),
            ("eigenvalue", Unit::InverseArea),
            ("over Weyl", Unit::One),
            ("worst residual", Unit::Relative),
        ],
    );
    Ok(table.tolerance("worst residual", None))
}

/// The meshes by their names: those of the assignment are named after what they are, stand-ins too.
fn meshes(context: &Context<'_>) -> Result<[(&'static str, TriMesh); 3]> {
    let named = |input, real, stand_in| if context.is_stand_in(input) { stand_in } else { real };
    let small = named(Input::Armadillo, "armadillo", "small creature");
    // A quick run is to be quick.
    let (large, mesh) = if context.is_quick() {
        ("large creature", shapes::creature(64))
    } else {
        (
            named(Input::ArmadilloLarge, "large armadillo", "large creature"),
            context.mesh(Input::ArmadilloLarge)?,
        )
    };
    let generated = shapes::bumpy_sphere(context.choose(4, 3), 0.15, 4.0);
    Ok([(small, context.mesh(Input::Armadillo)?), (large, mesh), (BALL, generated)])
}

/// A mesh, its smoothest modes, and the meshes reconstructed from them.
struct Rebuilt<'a> {
    name: &'a str,
    /// The name in ids.
    id: String,
    mesh: &'a TriMesh,
    modes: Spectrum,
    /// Predicted errors over the number of modes.
    predicted: Vec<f64>,
    /// Numbers of modes that end at a gap.
    stops: Vec<usize>,
    /// The mesh at each stop.
    meshes: Vec<TriMesh>,
}

impl<'a> Rebuilt<'a> {
    fn new(context: &Context<'_>, name: &'a str, mesh: &'a TriMesh) -> Result<Self> {
        let n = mesh.vertex_count();
        // Up to a tenth of its modes the generated mesh shows what the others show.
        let most = if name == BALL { 300 } else { 600 };
        let wanted = stops(n, context.choose(most, 100));
        let last = wanted.last().copied().context("no stops")?;
        let laplacian = Laplacian::cotangent(mesh)?;
        let modes = gap::modes(n, last, |k| spectrum(&laplacian, k, &SpectrumOptions::default()))?;
        let mut stops: Vec<usize> = wanted.iter().filter_map(|&k| gap::next(&modes, k)).collect();
        stops.dedup();
        let rebuilt = stops.iter().map(|&k| Ok(reconstruct(mesh, &modes, k)?.mesh));
        let meshes = rebuilt.collect::<Result<_>>()?;
        let predicted = reconstruction_errors(mesh, &modes)?;
        Ok(Self { name, id: name.replace(' ', "-"), mesh, modes, predicted, stops, meshes })
    }

    /// Errors over the number of modes.
    fn curve(&self) -> Series {
        let most = self.stops.last().copied().unwrap_or_default();
        let diagonal = self.mesh.diagonal();
        let ends = (1..most).filter(|&k| gap::next(&self.modes, k) == Some(k));
        let points = ends.map(|k| [k as f64, self.predicted[k] / diagonal]);
        // Values below rounding are not drawn on the logarithmic axis.
        Series::line(self.name, points.filter(|p| p[1] > FLOOR).collect())
    }

    fn tabulate(&self, table: &mut Table) -> Result<()> {
        let Self { name, mesh, modes, .. } = self;
        let diagonal = mesh.diagonal();
        let mass = modes.mass.as_mass().diagonal();
        for (&k, moved) in self.stops.iter().zip(&self.meshes) {
            let square: f64 = mesh
                .positions()
                .iter()
                .zip(moved.positions())
                .zip(&mass)
                .map(|((a, b), m)| m * (0..3).map(|i| (a[i] - b[i]).powi(2)).sum::<f64>())
                .sum();
            let distance = surface_distance(mesh, moved)?.max();
            table.push(row![
                *name,
                k,
                k as f64 / mesh.vertex_count() as f64,
                self.predicted[k] / diagonal,
                (square / modes.area()).sqrt() / diagonal,
                distance / diagonal,
                normal_error(moved, mesh)?.mean,
            ]);
        }
        Ok(())
    }

    fn tabulate_weyl(&self, table: &mut Table) {
        let modes = &self.modes;
        for &k in &self.stops {
            let omega = modes.values[k - 1];
            let law = 4.0 * std::f64::consts::PI * (k - 1) as f64 / modes.area();
            let worst = modes.residuals[..k].iter().fold(0.0, |m, r| larger(m, *r));
            table.push(row![self.name, k, omega, omega / law, worst / omega]);
        }
    }

    /// Pictures, the view, and files.
    fn show(self, outcome: &mut Outcome, occlusion: bool, with_modes: bool) -> Result<()> {
        let Self { name, id, mesh, modes, stops, meshes, predicted } = self;
        let diagonal = mesh.diagonal();
        let errors: Vec<(usize, f64)> =
            stops.iter().map(|&k| (k, predicted[k] / diagonal)).collect();
        let to_see = seen::reconstructions(name, &errors)?;
        // The section shows the first of them by a name that does not depend on the mesh.
        let figure = if with_modes { FIRST } else { &id };
        outcome.figures.push(picture(figure, name, &to_see, mesh, &stops, &meshes, occlusion)?);
        let shown = view(&id, name, &to_see, mesh, &stops, &meshes)?;
        outcome.views.push(View { fallback: figure.into(), ..shown });
        if with_modes {
            outcome.figures.push(modes_picture(&id, name, mesh, &modes, occlusion)?);
        }
        outcome.attachments.push(energies(&id, name, mesh, &modes)?);
        for (k, mesh) in stops.iter().zip(meshes) {
            let about = TEXT.say("mesh", values! { name, k: *k })?;
            outcome.attachments.push(Attachment {
                name: format!("{id}-{k}.obj"),
                about: about.clone(),
                content: Content::Mesh(mesh.clone()),
            });
            let id = format!("{id}-{k}");
            outcome.meshes.push(MeshOutput { id, caption: about, mesh, fields: vec![] });
        }
        Ok(())
    }
}

/// Errors of the eigenvalues 6 and 12 of the unit sphere under refinement.
fn sphere(context: &Context<'_>, finest: u32) -> Result<Table> {
    let mut table = Table::new(
        "sphere",
        &TEXT.say("table sphere", &[])?,
        &[
            ("sampling", Unit::Label),
            ("h", Unit::Length),
            ("near 6", Unit::InverseArea),
            ("near 12", Unit::InverseArea),
            ("error", Unit::Relative),
            ("order", Unit::Order),
        ],
    );
    for sampling in Sampling::BOTH {
        let (mut h, mut error, mut means) = (vec![], vec![], vec![]);
        for level in 2..=finest {
            let mesh = TestSurface::Sphere.mesh(level, sampling, context.seed("eigenvalues"));
            let values =
                spectrum(&Laplacian::cotangent(&mesh)?, 16, &SpectrumOptions::default())?.values;
            let mean = |r: std::ops::Range<usize>| {
                let n = r.len() as f64;
                values[r].iter().sum::<f64>() / n
            };
            let (six, twelve) = (mean(4..9), mean(9..16));
            h.push(mesh.mean_edge_length());
            error.push((six / 6.0 - 1.0).abs() + (twelve / 12.0 - 1.0).abs());
            means.push((six, twelve));
        }
        let orders = observed_orders(&h, &error);
        for i in 0..h.len() {
            // The coarsest mesh has nothing to be compared with.
            let order = (i > 0).then(|| orders[i - 1]);
            table.push(row![sampling.name(), h[i], means[i].0, means[i].1, error[i], order]);
        }
    }
    Ok(table)
}

/// Eigenvalues and the energies of the positions in each cluster of them. The coefficients of
/// single modes depend on signs, and within a cluster on the basis, which are the solver's choice;
/// their squares, summed over a cluster, are not.
fn energies(id: &str, name: &str, mesh: &TriMesh, modes: &Spectrum) -> Result<Attachment> {
    let c = modes.transform(ArrayView2::from(mesh.positions()))?;
    let mut csv = String::from("first mode,last mode,least eigenvalue,greatest eigenvalue,x,y,z\n");
    // The last is left out: some of its modes may be missing.
    for cluster in modes.clusters().into_iter().filter(|c| c.end < modes.len()) {
        let (first, last) = (cluster.start, cluster.end - 1);
        let [x, y, z] = [0, 1, 2].map(|d| cluster.clone().map(|i| c[[i, d]].powi(2)).sum::<f64>());
        let (low, high) = (modes.values[first], modes.values[last]);
        csv.push_str(&format!("{first},{last},{low:e},{high:e},{x:e},{y:e},{z:e}\n"));
    }
    Ok(Attachment {
        name: format!("{id}-energies.csv"),
        about: TEXT.say("energies", values! { name })?,
        content: Content::Text(csv),
    })
}
