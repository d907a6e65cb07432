//! Beyond the questions: flows compared with theory, and all of them beside each other.

use anyhow::{Context as _, Result};
use fairing_evaluation::{
    NoiseKind, NoiseLevel, add_noise, drift, normal_error, observed_orders, vertex_distance,
};
use fairing_figure::{Axis, Figure, Panel as FigurePanel, Plot, Series, Up};
use fairing_mesh::TriMesh;
use fairing_operators::{LaplacianKind, LumpedArea};
use fairing_shapes as shapes;
use fairing_smoothing::{Diffusion, Implicit, Method, Time, Update, implicit};
use fairing_sparse::{larger, smaller};
use glam::DVec3;

use super::conformal::{self, TEXT};
use super::gallery::{Gallery, Look, VIEWPOINTS, plotted};
use super::refinement::{between, second_order};
use super::seen;
use crate::experiment::outcome::{Outcome, Picture};
use crate::experiment::text::values;
use crate::experiment::{Card, Context, Experiment};
use crate::model::table::{Cell, Table, Tables, Unit, brief};
use crate::model::verdict::{Judgement, Shown, Verdict, ViewState};
use crate::model::view::{Panel, Slider, View};
use crate::row;

pub(super) struct Flows;

/// The time at which spheres are measured; their radius is then √(1 − 4t).
const END: f64 = 0.1;

/// The noise of the comparison in mean edge lengths.
const SIGMA: f64 = 0.2;

/// Methods that are said to keep the volume.
const KEEPING: [&str; 3] = ["taubin", "windowed-sinc", "hc"];

/// Diffusion for the same time as the steps of Taubin.
const DIFFUSION: &str = "explicit";

/// A change of the volume below this keeps it, in percent.
const KEPT: f64 = 1.0;

impl Experiment for Flows {
    fn card(&self) -> Card {
        let noise = format!("{SIGMA} mean edge lengths, along normals");
        let parameters =
            vec![("time of the spheres", END.to_string()), ("noise of the comparison", noise)];
        TEXT.card(&[], parameters, &[])
    }

    fn run(&self, context: &Context<'_>) -> Result<Outcome> {
        let mut outcome = Outcome::default();
        let spheres = spheres(context.choose(4, 3))?;
        outcome.figures.push(radius(&spheres)?);
        outcome.tables.push(spheres);
        context.progress(0.4, "conformal flow");
        outcome.tables.push(conformal::table(&conformal::bodies(context))?);
        let (round, rounding) = conformal::pictures(context)?;
        outcome.figures.push(round);
        context.progress(0.7, "methods");
        let (table, picture) = methods(context)?;
        outcome.tables.extend([table, volumes(context)?]);
        outcome.figures.push(picture);
        outcome.views.extend([view(context)?, rounding]);
        Ok(outcome)
    }

    fn judge(&self, tables: Tables<'_>) -> Result<Vec<Judgement>> {
        let orders = tables.get("spheres")?.numbers("order")?;
        let least = orders.iter().copied().fold(f64::INFINITY, smaller);
        let most = orders.iter().copied().fold(0.0, larger);
        let second = least > 1.8 && most < 2.2;
        let order = between(least, most);
        let verdict = if second { Verdict::Confirmed } else { Verdict::Refuted };
        let converging = TEXT
            .judgement("mean-curvature", verdict, values! { order })?
            .ours()
            .shown(Shown::line("flows", "radius", "unit sphere"))
            .number("least order", least, Unit::Order)
            .number("greatest order", most, Unit::Order);
        Ok(vec![converging, conformal::judge(tables)?, volume(tables)?])
    }
}

/// Judges whether the methods that are said to keep the volume do so on all meshes.
fn volume(tables: Tables<'_>) -> Result<Judgement> {
    let table = tables.get("volumes")?;
    let (mut worst, mut kept, mut ends) = (0.0f64, 0, vec![]);
    let [mesh, vertices] = [table.index("mesh")?, table.index("vertices")?];
    let mut meshes: Vec<[Cell; 2]> = vec![];
    for row in &table.rows {
        let found = [row[mesh].clone(), row[vertices].clone()];
        if !meshes.contains(&found) {
            meshes.push(found);
        }
    }
    for [mesh, vertices] in &meshes {
        let rows = table.only(&[("mesh", mesh.clone()), ("vertices", vertices.clone())])?;
        let of = |method: &str| rows.value(&[("method", method.into())], "volume");
        let changes: Vec<f64> = KEEPING.iter().map(|m| of(m)).collect::<Result<_>>()?;
        let lost = changes.iter().fold(0.0, |most, change| larger(most, change.abs()));
        let values = values! {
            mesh: mesh.to_string(), count: vertices.to_string(), lost,
            plain: of(DIFFUSION)?.abs(),
        };
        ends.push(TEXT.say("volume on a mesh", values)?);
        worst = larger(worst, lost);
        kept += usize::from(lost < KEPT);
    }
    let verdict = match kept {
        0 => Verdict::Refuted,
        n if n == meshes.len() => Verdict::Confirmed,
        _ => Verdict::Qualified,
    };
    let off_truth = ViewState::at(&[stop("taubin")]).field("distance off the truth");
    let values = values! { worst, kept: KEPT, ends: seen::list(&ends) };
    Ok(TEXT
        .judgement("volume", verdict, values)?
        .ours()
        .shown(Shown::view("flows", "methods-view", &off_truth))
        .number("largest change of the three", worst, Unit::Percent))
}

/// The volume after diffusion and after the methods that are said to keep it, on meshes with noise.
fn volumes(context: &Context<'_>) -> Result<Table> {
    let mut table = Table::new(
        "volumes",
        &TEXT.say("table volumes", values! { sigma: SIGMA })?,
        &[
            ("mesh", Unit::Label),
            ("vertices", Unit::Count),
            ("method", Unit::Label),
            ("volume", Unit::Percent),
        ],
    );
    let fine = shapes::creature(context.choose(138, 60));
    for (name, truth) in
        [("bumpy sphere", bumpy(context)), ("creature", fine), ("creature", shapes::creature(24))]
    {
        let noisy = noisy(context, &truth)?;
        let wanted =
            |method: &Method| method.name() == DIFFUSION || KEEPING.contains(&method.name());
        for method in compared().filter(wanted) {
            let mesh = method.run(&noisy, None)?.mesh;
            let volume = drift(&mesh, &truth).volume.context("a closed mesh without a volume")?;
            table.push(row![name, truth.vertex_count(), method.name(), 100.0 * volume]);
        }
    }
    Ok(table)
}

/// The bumpy sphere of the comparison.
fn bumpy(context: &Context<'_>) -> TriMesh {
    shapes::bumpy_sphere(context.choose(4, 3), 0.1, 5.0)
}

/// The mesh with the noise of the comparison.
fn noisy(context: &Context<'_>, truth: &TriMesh) -> Result<TriMesh> {
    let sigma = NoiseLevel::EdgeLengths(SIGMA);
    Ok(add_noise(truth, NoiseKind::GaussianAlongNormals, sigma, context.seed("methods"))?)
}

/// Mean curvature flow of the unit sphere.
fn spheres(finest: u32) -> Result<Table> {
    let mut table = Table::new(
        "spheres",
        &TEXT.say("table spheres", &[])?,
        &[
            ("h", Unit::Length),
            ("steps", Unit::Count),
            ("radius", Unit::Length),
            ("exact", Unit::Length),
            ("error", Unit::Length),
            ("order", Unit::Order),
        ],
    );
    let exact = (1.0 - 4.0 * END).sqrt();
    let (mut h, mut steps, mut radii) = (vec![], vec![], vec![]);
    for level in 2..=finest {
        let sphere = shapes::icosphere(level);
        let count = 10usize << (2 * (level - 2));
        let options = Implicit {
            iterations: count,
            update: Update::Both,
            tolerance: 1e-11,
            ..Implicit::new(Diffusion::Cotangent {
                time: Time::SquaredUnits(END / count as f64),
                kind: LaplacianKind::Auto,
                area: LumpedArea::Barycentric,
            })
        };
        let shrunk = implicit(&sphere, &options, None)?.mesh;
        let sum: f64 = shrunk.positions().iter().map(|&p| DVec3::from(p).length()).sum();
        h.push(sphere.mean_edge_length());
        steps.push(count);
        radii.push(sum / shrunk.vertex_count() as f64);
    }
    let error: Vec<f64> = radii.iter().map(|r| (r - exact).abs()).collect();
    let orders = observed_orders(&h, &error);
    for i in 0..h.len() {
        // The coarsest mesh has nothing to be compared with.
        let order = (i > 0).then(|| orders[i - 1]);
        table.push(row![h[i], steps[i], radii[i], exact, error[i], order]);
    }
    Ok(table)
}

/// The error of the radius over h.
fn radius(spheres: &Table) -> Result<Picture> {
    let points = spheres.column("h")?.into_iter().zip(spheres.column("error")?);
    let mut plot = Plot {
        x: Axis::log("mean edge length h"),
        y: Axis::log("error of the radius"),
        series: vec![Series::marked("unit sphere", points.map(<[f64; 2]>::from).collect())],
        ..Plot::default()
    };
    plot.series.extend(second_order(&plot.series));
    let orders = spheres.numbers("order")?;
    let least = orders.iter().copied().fold(f64::INFINITY, smaller);
    let order = between(least, orders.iter().copied().fold(0.0, larger));
    let mut figure = Figure::default();
    figure.panels.push(FigurePanel::drawing(plot.draw(450.0, 215.0)?));
    plotted(
        &figure,
        "radius",
        &TEXT.say("figure radius", values! { order })?,
        &TEXT.say("figure radius alt", &[])?,
    )
}

/// A bumpy sphere, and by name the same with noise and after every method with its default options.
fn restored(context: &Context<'_>) -> Result<(TriMesh, Vec<(String, TriMesh)>)> {
    let truth = bumpy(context);
    let noisy = noisy(context, &truth)?;
    let mut results = vec![("input".to_string(), noisy.clone())];
    for method in compared() {
        results.push((method.name().to_string(), method.run(&noisy, None)?.mesh));
    }
    Ok((truth, results))
}

/// The methods that are compared; the others serve other purposes.
fn compared() -> impl Iterator<Item = Method> {
    let others =
        |method: &Method| matches!(method, Method::FairRegion(_) | Method::ConformalizedMcf(_));
    Method::all().into_iter().filter(move |method| !others(method))
}

/// The stop of a method in the view.
fn stop(name: &str) -> usize {
    compared().position(|method| method.name() == name).unwrap_or_default()
}

/// The noisy mesh, the result of each method, and the truth: the meshes of the table.
fn view(context: &Context<'_>) -> Result<View> {
    let (truth, mut results) = restored(context)?;
    let (_, noisy) = results.remove(0);
    let facts = |panel: Panel, meshes: &[&TriMesh]| -> Result<Panel> {
        let (mut angles, mut volumes) = (vec![], vec![]);
        for mesh in meshes {
            angles.push(Some(normal_error(mesh, &truth)?.mean));
            volumes.push(drift(mesh, &truth).volume.map(|volume| 100.0 * volume));
        }
        Ok(panel.with_fact("normal error", "°", angles).with_fact("volume", "%", volumes))
    };
    // The body is star-shaped about the origin.
    let inside = |method: &str| -> Result<f64> {
        let found = results.iter().find(|(name, _)| name == method);
        let (_, mesh) = found.with_context(|| format!("there is no {method}"))?;
        let pairs = mesh.positions().iter().zip(truth.positions());
        let within =
            |(p, q): &(&[f64; 3], &[f64; 3])| DVec3::from(**p).length() < DVec3::from(**q).length();
        Ok((100.0 * pairs.filter(within).count() as f64 / truth.vertex_count() as f64).round())
    };
    let meshes: Vec<&TriMesh> = results.iter().map(|(_, mesh)| mesh).collect();
    let after = Panel::moving("result", &truth, meshes.iter().map(|mesh| mesh.positions()));
    Ok(View {
        id: "methods-view".into(),
        mesh: "bumpy sphere".into(),
        caption: TEXT.say(
            "view",
            values! {
                implicit: inside("implicit")?, taubin: inside("taubin")?,
                vertices: truth.vertex_count(), sigma: SIGMA,
            },
        )?,
        alt: TEXT.say("view alt", &[])?,
        fallback: "methods".into(),
        z_up: true,
        sliders: vec![Slider::new("method", results.iter().map(|(name, _)| name))],
        start: vec![stop("implicit")],
        color: Some("distance off the truth".into()),
        panels: vec![
            facts(Panel::still("noisy input", &noisy), &[&noisy])?,
            facts(after, &meshes)?,
            Panel::still("truth", &truth),
        ],
        from: Some(0),
        truth: Some(truth.positions().to_vec()),
    })
}

/// Every method with its default options on one noisy mesh.
fn methods(context: &Context<'_>) -> Result<(Table, Picture)> {
    let mut table = Table::new(
        "methods",
        &TEXT.say("table methods", &[])?,
        &[
            ("method", Unit::Label),
            ("normal error", Unit::Degrees),
            ("vertex error", Unit::EdgeLengths),
            ("volume", Unit::Percent),
        ],
    );
    let (truth, results) = restored(context)?;
    let h = truth.mean_edge_length();
    for (name, mesh) in &results {
        let volume = drift(mesh, &truth).volume.context("a closed mesh without a volume")?;
        table.push(row![
            name.as_str(),
            normal_error(mesh, &truth)?.mean,
            vertex_distance(mesh, &truth)?.mean / h,
            100.0 * volume,
        ]);
    }
    let shown = ["input", "implicit", "mean-curvature", "taubin", "hc"];
    let looks = results.iter().filter(|(name, _)| shown.contains(&name.as_str()));
    let looks = looks.map(|(title, mesh)| Look { title, mesh, coloring: None }).collect();
    let picture = Gallery {
        looks,
        viewpoints: &VIEWPOINTS[..1],
        up: Up::Z,
        aspect: 1.0,
        occlusion: !context.is_quick(),
    }
    .draw(
        "methods",
        &TEXT.say("figure methods", values! { volumes: changes(&table, &shown)? })?,
        &TEXT.say("figure methods alt", &[])?,
    )?;
    Ok((table, picture))
}

/// The changes of the volume by some methods, as a list.
fn changes(table: &Table, methods: &[&str]) -> Result<String> {
    let methods = methods.iter().filter(|name| **name != "input");
    let changes = methods.map(|&method| {
        let change = table.value(&[("method", method.into())], "volume")?;
        Ok(format!("{method} {} %", brief(change)))
    });
    Ok(seen::list(&changes.collect::<Result<Vec<_>>>()?))
}
