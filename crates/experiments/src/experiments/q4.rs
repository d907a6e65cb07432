//! Question 4: a mesh from its k smoothest modes.

mod section;

use anyhow::{Context as _, Result};
use fairing_evaluation::{normal_error, observed_orders, surface_distance};
use fairing_figure::{
    Axis, Figure, Legend, Limits, Panel as FigurePanel, Plot, ScaleOptions, Series, Shape, Up,
    Viewpoint,
};
use fairing_mesh::TriMesh;
use fairing_operators::Laplacian;
use fairing_operators::curvature::{ScalarCurvature, VertexStatus};
use fairing_shapes as shapes;
use fairing_spectral::{Spectrum, SpectrumOptions, reconstruct, reconstruction_errors, spectrum};
use ndarray::ArrayView2;

use super::gallery::{Coloring, Gallery, Look, Range, plotted};
use super::gap;
use super::mode_sums;
use super::models::slug;
use super::refinement::second_order;
use super::seen;
use super::surfaces::{Sampling, TestSurface};
use super::torus;
use crate::experiment::{Card, Context, Experiment};
use crate::inputs::Input;
use crate::outcome::{Attachment, Content, MeshOutput, Outcome, Picture};
use crate::row;
use crate::table::{Table, Tables, Tolerance, Unit, brief};
use crate::verdict::{Judgement, Shown, Verdict, ViewState};
use crate::view::{Panel, Slider, View};

pub(super) struct Reconstruction;

/// Numbers of modes; those beyond the size of a mesh become all of its modes.
const STOPS: [usize; 7] = [5, 15, 50, 100, 300, 600, 1000];

/// Above this many vertices the full spectrum is not computed.
const FULL: usize = 1500;

/// The name of the generated mesh, which both kinds of runs have.
const BALL: &str = "bumpy ball";

/// An error of all modes below this, over the diagonal, is rounding.
const ROUNDING: f64 = 1e-9;

/// Predicted errors below this are rounding, over the diagonal.
const FLOOR: f64 = 1e-12;

/// Tolerance left by the angle of the kept space.
const TRUNCATED: Tolerance = Tolerance { relative: gap::ANGLE, absolute: 1e-9 };

const VIEWS: [Viewpoint; 2] = [
    Viewpoint::Angles { azimuth: 20.0, elevation: 10.0 },
    Viewpoint::Angles { azimuth: 140.0, elevation: 20.0 },
];

impl Experiment for Reconstruction {
    fn card(&self) -> Card {
        Card {
            id: "q4",
            title: "Reconstruction from the smoothest modes",
            question: "How well do the eigenvectors of the k smallest eigenvalues of the Laplace–Beltrami operator reconstruct a mesh, and does a larger k help?",
            method: "The modes φ solve S φ = ω M φ, with cotangent stiffness S and barycentric mass M; ω is a squared frequency. The positions X are projected onto the first k modes, in the inner product of M.\n\nThe number of eigenvalues below the last one is certified by the inertia of a factorisation. Where eigenvalue k + 1 is equal to eigenvalue k or nearly so, the basis of their eigenspace is arbitrary, and k moves on to the next gap.\n\nThe error is predicted from the coefficients (Parseval); it is measured as well, with the distance between the surfaces and the angle between their normals. Eigenvalues are compared with those of the unit sphere, ℓ(ℓ + 1), and with Weyl's law, ω_k ≈ 4πk over the area.".into(),
            formulas: FORMULAS.map(String::from).to_vec(),
            section: section::section(),
            inputs: &[Input::Armadillo, Input::ArmadilloLarge],
            parameters: vec![
                (
                    "k",
                    STOPS.map(|k| k.to_string()).join(", ")
                        + ", all (small meshes); each up to the next gap between eigenvalues",
                ),
                ("mass", "barycentric".into()),
            ],
        }
    }

    fn run(&self, context: &Context<'_>) -> Result<Outcome> {
        let mut outcome = Outcome::default();
        let (mut errors, mut weyl, mut curves) = (errors_table(), weyl_table(), vec![]);
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
            steps.push(measured[1] / measured[0]);
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
        let reason = format!(
            "{}, and Parseval's identity predicts it to {} of the diagonal. From {} to {} modes the error of the {} goes to {} of what it was; {}.",
            if falling { FALLS } else { RISES },
            brief(mismatch),
            ks[0],
            ks[1],
            names[0],
            brief(steps[0]),
            what_is_left(ks[ks.len() - 1], complete, last),
        );
        let [[least, most], [low, high]] =
            [orders(tables, Sampling::Regular)?, orders(tables, Sampling::Jittered)?];
        let is_second = |least: f64, most: f64| least > 1.9 && most < 2.1;
        let second = match (is_second(least, most), is_second(low, high)) {
            (true, true) => Verdict::Confirmed,
            (true, false) => Verdict::Qualified,
            _ => Verdict::Refuted,
        };
        Ok(vec![
            Judgement::new("4a", "A larger k approaches the original", verdict, reason)
                .finding(format!(
                    "How much the first modes help depends on the shape: going from {} to {} of them leaves between {} and {} of the error.",
                    ks[0],
                    ks[1],
                    brief(steps.iter().copied().fold(f64::INFINITY, f64::min)),
                    brief(steps.iter().copied().fold(0.0, f64::max)),
                ))
                .shown(Shown::view("q4", mode_sums::VIEW, &ViewState::modes(ks[1] as usize)))
                .number(&format!("error at {} over error at {}", ks[1], ks[0]), steps[0], Unit::One)
                .number("error with all modes", last, Unit::Diagonals),
            Judgement::new(
                "4b",
                "The eigenvalues converge to those of the surface with second order",
                second,
                format!(
                    "On the unit sphere (ω = 6 and 12) and on a torus of revolution (its first dozen) the errors fall with order {} on regular meshes and {} on meshes with jittered vertices.",
                    between(least, most),
                    between(low, high)
                ),
            )
            .finding(format!("The observed order is {} on regular and {} on jittered meshes; at order 2 half the edge length leaves a quarter of the error.", between(least, most), between(low, high)))
            .ours()
            .shown(Shown::line("q4", "eigenvalues", "sphere"))
            .number("least order", least, Unit::Order)
            .number("greatest order", most, Unit::Order)
            .number("least order, jittered", low, Unit::Order)
            .number("greatest order, jittered", high, Unit::Order),
        ])
    }
}

/// The least and the greatest observed order of eigenvalues, on the sphere and on the torus.
fn orders(tables: Tables<'_>, sampling: Sampling) -> Result<[f64; 2]> {
    let mut orders = vec![];
    for surface in ["sphere", "torus"] {
        let rows = tables.get(surface)?.only(&[("sampling", sampling.name().into())])?;
        orders.extend(rows.numbers("order")?);
    }
    let least = orders.iter().copied().fold(f64::INFINITY, f64::min);
    Ok([least, orders.iter().copied().fold(f64::NEG_INFINITY, f64::max)])
}

/// Words for an error that falls with every step.
const FALLS: &str =
    "The error falls with every step of k, as it must for modes that are orthonormal in the mass";

/// And of one that does not.
const RISES: &str = "The error does not fall with every step of k";

/// The error at the last stop, in words.
fn what_is_left(modes: f64, complete: bool, last: f64) -> String {
    match complete {
        true if last < ROUNDING => format!("with all {modes} modes only rounding error remains"),
        true => format!("all {modes} modes leave {} of the diagonal", brief(last)),
        false => format!("the last stop, {modes} modes, leaves {} of the diagonal", brief(last)),
    }
}

/// The stops for a mesh, the last of them all modes where that is cheap.
fn stops(vertices: usize, most: usize) -> Vec<usize> {
    let mut stops: Vec<usize> = STOPS.into_iter().filter(|&k| k < vertices && k <= most).collect();
    if vertices <= FULL {
        stops.push(vertices);
    }
    stops
}

fn errors_table() -> Table {
    Table::new(
        "reconstruction",
        "Error of the mesh rebuilt from k modes: root mean square displacement weighted by area, predicted from the coefficients and measured; largest distance between the surfaces at their vertices; normal error.",
        &[
            ("mesh", Unit::Label),
            ("k", Unit::Count),
            ("share of modes", Unit::Relative),
            ("predicted RMS", Unit::Diagonals),
            ("measured RMS", Unit::Diagonals),
            ("largest distance", Unit::Diagonals),
            ("normal error", Unit::Degrees),
        ],
    )
    .tolerance("predicted RMS", Some(TRUNCATED))
    .tolerance("measured RMS", Some(TRUNCATED))
    .tolerance("largest distance", Some(Tolerance::LOOSE))
    .tolerance("normal error", Some(Tolerance::LOOSE))
}

fn weyl_table() -> Table {
    Table::new(
        "weyl",
        "Eigenvalues against Weyl's law, ω × area / 4πk: it tends to one while k is small beside the number of vertices.",
        &[
            ("mesh", Unit::Label),
            ("k", Unit::Count),
            ("eigenvalue", Unit::InverseArea),
            ("over Weyl", Unit::One),
            ("worst residual", Unit::Relative),
        ],
    )
    .tolerance("worst residual", None)
}

/// The meshes by their names: those of the assignment are named after what they are, stand-ins too.
fn meshes(context: &Context<'_>) -> Result<[(&'static str, TriMesh); 3]> {
    let named = |input, real, stand_in| if context.is_stand_in(input) { stand_in } else { real };
    let small = named(Input::Armadillo, "armadillo", "small creature");
    // A quick run is to be quick.
    let (large, mesh) = match context.is_quick() {
        true => ("large creature", shapes::creature(64)),
        false => (
            named(Input::ArmadilloLarge, "large armadillo", "large creature"),
            context.mesh(Input::ArmadilloLarge)?,
        ),
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
        // What is below rounding has no place on a logarithmic axis.
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
            let lambda = modes.values[k - 1];
            let law = 4.0 * std::f64::consts::PI * (k - 1) as f64 / modes.area();
            let worst = modes.residuals[..k].iter().fold(0.0, |m: f64, r| m.max(*r));
            table.push(row![self.name, k, lambda, lambda / law, worst / lambda]);
        }
    }

    /// Pictures, the view, and files.
    fn show(self, outcome: &mut Outcome, occlusion: bool, with_modes: bool) -> Result<()> {
        let Self { name, id, mesh, modes, stops, meshes, predicted } = self;
        let diagonal = mesh.diagonal();
        let errors: Vec<(usize, f64)> =
            stops.iter().map(|&k| (k, predicted[k] / diagonal)).collect();
        let to_see = seen::reconstructions(name, &errors);
        outcome.figures.push(picture(&id, name, &to_see, mesh, &stops, &meshes, occlusion)?);
        outcome.views.push(view(&id, name, &to_see, mesh, &stops, &meshes));
        if with_modes {
            outcome.figures.push(modes_picture(&id, name, mesh, &modes, occlusion)?);
        }
        outcome.attachments.push(energies(&id, name, mesh, &modes)?);
        for (k, mesh) in stops.iter().zip(meshes) {
            let about = format!("The {name} from {k} modes.");
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
        "Eigenvalues of the unit sphere: the mean of those that tend to 6 (five) and 12 (seven), their relative errors together, and the observed order.",
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

fn picture(
    id: &str,
    name: &str,
    to_see: &str,
    mesh: &TriMesh,
    stops: &[usize],
    rebuilt: &[TriMesh],
    occlusion: bool,
) -> Result<Picture> {
    let titles: Vec<String> = stops.iter().map(|k| format!("k = {k}")).collect();
    let mut looks = vec![];
    for i in [0, 1, 3, stops.len() - 1] {
        if let (Some(title), Some(mesh)) = (titles.get(i), rebuilt.get(i)) {
            looks.push((title.as_str(), mesh));
        }
    }
    looks.push(("original", mesh));
    looks.dedup_by_key(|l| l.0);
    let looks =
        looks.into_iter().map(|(title, mesh)| Look { title, mesh, coloring: None }).collect();
    Gallery { looks, viewpoints: &VIEWS, up: Up::Y, aspect: 0.9, occlusion }.draw(
        id,
        &format!("{to_see} The {name} from k modes, and the original, from two viewpoints (Figure 4 of the original report)."),
        &format!("Pictures of the {name}: the more modes, the closer it comes to the original."),
    )
}

/// The modes drawn, by number.
const DRAWN: [usize; 5] = [1, 2, 4, 9, 29];

fn modes_picture(
    id: &str,
    name: &str,
    mesh: &TriMesh,
    modes: &Spectrum,
    occlusion: bool,
) -> Result<Picture> {
    let fields: Vec<(String, ScalarCurvature)> = DRAWN
        .iter()
        .filter(|&&i| i < modes.len())
        .map(|&i| {
            let mode = modes.modes.column(i);
            let largest = mode.iter().fold(f64::MIN_POSITIVE, |m: f64, x| m.max(x.abs()));
            let n = mesh.vertex_count();
            let field = ScalarCurvature::new(
                mode.iter().map(|x| x / largest).collect(),
                vec![VertexStatus::Defined; n],
                vec![false; n],
            );
            (format!("mode {i}, ω = {}", brief(modes.values[i])), field)
        })
        .collect();
    let changes: Vec<usize> =
        fields.iter().map(|(_, field)| sign_changes(mesh, &field.values)).collect();
    let rising = changes.windows(2).all(|w| w[0] < w[1]);
    let to_see = match (rising, changes.first(), changes.last()) {
        (true, Some(first), Some(last)) => format!(
            "The larger the eigenvalue, the more often the sign changes: across {first} edges in the first mode drawn, across {last} in the last."
        ),
        _ => "Each mode divides the surface in its own way.".into(),
    };
    let options =
        ScaleOptions { limits: Limits::Fixed { low: -1.0, high: 1.0 }, ..ScaleOptions::SIGNED };
    let looks = fields
        .iter()
        .map(|(title, field)| Look {
            title,
            mesh,
            coloring: Some(Coloring {
                field,
                range: Range::All,
                options,
                quantity: "mode over its largest value",
                unit: "",
            }),
        })
        .collect();
    Gallery { looks, viewpoints: &VIEWS, up: Up::Y, aspect: 0.9, occlusion }.draw(
        &format!("{id}-modes"),
        &format!("{to_see} Modes of the {name}, from two viewpoints; signs are arbitrary, and so is the basis where eigenvalues are equal."),
        &format!("The {name} five times from two sides, coloured from blue to red by one mode each."),
    )
}

/// The number of edges across which a field changes its sign.
fn sign_changes(mesh: &TriMesh, values: &[f64]) -> usize {
    let changes = |edge: &&[u32; 2]| values[edge[0] as usize] * values[edge[1] as usize] < 0.0;
    mesh.topology().edges().iter().filter(changes).count()
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
        about: format!(
            "Eigenvalues of the {name} and the energy of its positions in each cluster of equal or nearly equal ones, Σ (φᵀMX)²."
        ),
        content: Content::Text(csv),
    })
}

fn view(
    id: &str,
    name: &str,
    to_see: &str,
    mesh: &TriMesh,
    stops: &[usize],
    rebuilt: &[TriMesh],
) -> View {
    View {
        id: format!("{id}-view"),
        mesh: name.into(),
        caption: format!(
            "{to_see} The {name} from k modes (Figure 4 of the original report), beside the whole mesh."
        ),
        alt: format!("The {name} twice, to turn; a slider changes the number of modes."),
        fallback: id.into(),
        color: None,
        z_up: false,
        sliders: vec![Slider::new("k", stops)],
        start: vec![2.min(stops.len() - 1)],
        panels: vec![
            Panel::moving("k modes", mesh, rebuilt.iter().map(TriMesh::positions)),
            Panel::still("original", mesh),
        ],
        from: Some(1),
        truth: Some(mesh.positions().to_vec()),
    }
}

/// The number of modes at which meshes are compared in words.
const COMPARED: usize = 50;

/// The names of the curves with the least and the greatest error at [`COMPARED`] modes.
fn extremes(curves: &[Series]) -> Option<[&str; 2]> {
    let at = |series: &Series| {
        let Shape::Line(points) = &series.shape else { return None };
        points.iter().rev().find(|p| p[0] <= COMPARED as f64).map(|p| p[1])
    };
    let known = || curves.iter().filter_map(|c| Some((at(c)?, c.name.as_str())));
    let least = known().min_by(|a, b| a.0.total_cmp(&b.0))?;
    let most = known().max_by(|a, b| a.0.total_cmp(&b.0))?;
    (least.1 != most.1).then_some([least.1, most.1])
}

/// Two orders to two digits, or one if they do not differ in them.
fn between(least: f64, most: f64) -> String {
    let [low, high] = [least, most].map(|x| format!("{x:.2}"));
    if low == high { low } else { format!("{low} to {high}") }
}

fn decay(curves: Vec<Series>) -> Result<Picture> {
    let plot = Plot {
        x: Axis::log("modes k"),
        y: Axis::log("RMS displacement / diagonal"),
        legend: Legend::Lines,
        series: curves,
        ..Plot::default()
    };
    let mut figure = Figure::default();
    let to_see = extremes(&plot.series).map_or(String::new(), |[least, most]| {
        format!("The smoother the shape, the fewer modes it needs: at {COMPARED} modes the {least} is the closest to its original, the {most} the farthest. ")
    });
    let names: Vec<String> = plot.series.iter().map(|s| s.name.clone()).collect();
    figure.panels.push(FigurePanel::drawing(plot.draw(560.0, 280.0)?));
    let picture = plotted(
        &figure,
        "decay",
        &format!(
            "{to_see}The error of the mesh from k modes over k: the root mean square displacement weighted by area, over the diagonal of the bounding box."
        ),
        "Curves that fall from a few per cent at one mode, fast where k reaches the number of vertices.",
    )?;
    Ok(names.iter().fold(picture, |picture, name| {
        picture.linked("", name, &format!("{}-view", slug(name)), "k")
    }))
}

/// Errors of eigenvalues over h.
fn eigenvalues(sphere: &Table, torus: &Table) -> Result<Picture> {
    let mut plot = Plot {
        x: Axis::log("mean edge length h"),
        y: Axis::log("relative error"),
        legend: Legend::Lines,
        ..Plot::default()
    };
    let mut steepness = vec![];
    for (name, table) in [("sphere", sphere), ("torus", torus)] {
        for sampling in Sampling::BOTH {
            let rows = table.only(&[("sampling", sampling.name().into())])?;
            let points = rows.column("h")?.into_iter().zip(rows.column("error")?);
            let name = match sampling {
                Sampling::Regular => name.to_string(),
                Sampling::Jittered => format!("{name}, {}", sampling.name()),
            };
            plot.series.push(Series::marked(name, points.map(<[f64; 2]>::from).collect()));
            steepness.extend(rows.numbers("order")?);
        }
    }
    let is_second = steepness.iter().all(|order| (1.8..2.2).contains(order));
    let to_see = match is_second {
        true => {
            "All lines are as steep as the dashed one: half the edge length leaves a quarter of the error"
        }
        false => {
            "Not all lines are as steep as the dashed one, at which half the edge length leaves a quarter of the error"
        }
    };
    plot.series.extend(second_order(&plot.series));
    let mut figure = Figure::default();
    figure.panels.push(FigurePanel::drawing(plot.draw(450.0, 215.0)?));
    plotted(
        &figure,
        "eigenvalues",
        &format!(
            "{to_see}. Eigenvalues of the unit sphere and of a torus against the exact ones, under refinement, on regular and on jittered meshes."
        ),
        "Four falling lines of error over mean edge length on logarithmic axes, with a dashed line of second order.",
    )
}

const FORMULAS: [&str; 1] = [
    r"S\varphi_i = \omega_i M\varphi_i,\quad \varphi_i^\top M \varphi_j = \delta_{ij},\quad X_k = \sum_{i<k} \varphi_i \varphi_i^\top M X",
];
