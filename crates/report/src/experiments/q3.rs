//! Question 3: mean curvature from the cotangent Laplace–Beltrami operator.

use anyhow::{Context as _, Result};
use fairing_figure::{ScaleOptions, Up};
use fairing_mesh::TriMesh;
use fairing_operators::curvature::{
    MeanCurvature, ScalarCurvature, mean_curvature, scaled_umbrella_mean_curvature,
};
use fairing_operators::{LumpedArea, OperatorError, lumped_mass};
use fairing_shapes as shapes;
use fairing_sparse::larger;

use super::gallery::{self, Coloring, FLAT, Gallery, Look, Range, VIEWPOINTS};
use super::refinement::{self, Deviation, Estimator, Quantity, finest};
use super::seen;
use super::spread;
use super::statistics::extremes;
use super::surfaces::{Sampling, TestSurface};
use crate::experiment::inputs::Input;
use crate::experiment::outcome::{MeshOutput, Outcome, Picture};
use crate::experiment::text::{Text, values};
use crate::experiment::{Card, Context, Experiment};
use crate::model::table::{Cell, Table, Tables, Unit};
use crate::model::verdict::{Judgement, Shown, Verdict, ViewState};
use crate::model::view::{Panel, View};
use crate::row;

pub(super) struct CotangentCurvature;

const UNIFORM: &str = "uniform, scaled";
const COTANGENT: &str = "cotangent, mixed area";
const BARYCENTRIC: &str = "cotangent, barycentric area";

/// Mean curvature by one operator.
type Estimate = fn(&TriMesh) -> Result<MeanCurvature, OperatorError>;

const MIXED: Estimate = |mesh| mean_curvature(mesh, LumpedArea::Mixed);
const SCALED: Estimate = |mesh| Ok(scaled_umbrella_mean_curvature(mesh));

const ESTIMATORS: [Estimator; 3] = [
    Estimator {
        name: UNIFORM,
        quantity: Quantity::Mean,
        estimate: |mesh| Ok(scaled_umbrella_mean_curvature(mesh).signed),
    },
    Estimator {
        name: COTANGENT,
        quantity: Quantity::Mean,
        estimate: |mesh| Ok(MIXED(mesh)?.signed),
    },
    Estimator {
        name: BARYCENTRIC,
        quantity: Quantity::Mean,
        estimate: |mesh| Ok(mean_curvature(mesh, LumpedArea::Barycentric)?.signed),
    },
];

/// Largest value taken for zero on a plane, as a multiple of 1 / mean edge length.
const ZERO: f64 = 1e-9;

static TEXT: Text = Text::new("q3", include_str!("../../text/q3.md"));

impl Experiment for CotangentCurvature {
    fn card(&self) -> Card {
        let area = ("area of a vertex", "mixed (Voronoi where no angle is obtuse)".into());
        let parameters = std::iter::once(area).chain(TestSurface::parameters()).collect();
        TEXT.card(&[Input::Flower, Input::Plane], parameters, &[])
    }

    fn run(&self, context: &Context<'_>) -> Result<Outcome> {
        let mut outcome = Outcome::default();
        let mut fields = spread::table("fields", &TEXT.say("table fields", &[])?);
        for (name, input) in [("flower", Input::Flower), ("plane", Input::Plane)] {
            let mesh = context.mesh(input)?;
            let uniform = scaled_umbrella_mean_curvature(&mesh);
            let cotangent = MIXED(&mesh)?;
            let norms = cotangent.norms();
            for (field, values) in [
                ("|H|, uniform", sizes(&uniform)),
                ("|H|, cotangent", sizes(&cotangent)),
                ("H, uniform", uniform.clone().into_signed()),
                ("H, cotangent", cotangent.clone().into_signed()),
            ] {
                spread::push(&mut fields, name, field, "1/mesh units", &values);
            }
            outcome.figures.extend(pictures(name, &mesh, &uniform, &cotangent)?);
            outcome.views.push(view(name, &mesh, &uniform, &cotangent)?);
            outcome.meshes.push(MeshOutput {
                id: format!("{name}-cotangent"),
                caption: TEXT.say("mesh", values! { name })?,
                mesh,
                fields: vec![
                    ("mean".into(), cotangent.signed),
                    ("mean_norm".into(), norms),
                    ("mean_uniform".into(), uniform.signed),
                ],
            });
        }
        let (view, picture) = torus_view(context)?;
        outcome.views.insert(0, view);
        outcome.figures.push(picture);
        outcome.tables.push(fields);
        let [errors, orders] = refinement::study(context, &ESTIMATORS)?;
        outcome.figures.push(refinement::plot(&errors, &ESTIMATORS)?);
        outcome.tables.extend([errors, orders]);
        outcome.tables.push(planes(context)?);
        Ok(outcome)
    }

    fn judge(&self, tables: Tables<'_>) -> Result<Vec<Judgement>> {
        let errors = tables.get("analytic")?;
        let (barycentric, mesh) = ratios(errors, BARYCENTRIC)?
            .into_iter()
            .reduce(|a, b| if b.0 > a.0 { b } else { a })
            .context("no meshes")?;
        let ratios = ratios(errors, COTANGENT)?.into_iter().map(|r| r.0);
        let [best, worst] = extremes(ratios);
        let [inside, border, uniform] = on_planes(tables.get("planes")?)?;
        let [order, largest] = jittered_orders(tables.get("orders")?)?;
        let verdict = match (worst < 1.0, inside < ZERO, border > ZERO) {
            (true, false, _) => Verdict::Confirmed,
            (false, true, false) => Verdict::Refuted,
            _ => Verdict::Qualified,
        };
        let values = values! {
            least: 1.0 / worst, most: 1.0 / best, barycentric, mesh, order, largest,
            left: left_on_jittered(errors)?, zero: ZERO, inside, uniform, border,
        };
        Ok(vec![
            TEXT.judgement("3a", verdict, values)?
                .shown(Shown::view(
                    "q3",
                    "torus-view",
                    &ViewState::at(&[]).field("error of mean curvature"),
                ))
                .number("largest ratio of errors, cotangent to uniform", worst, Unit::One)
                .number("the same with barycentric areas", barycentric, Unit::One)
                .number("highest order of cotangents on jittered meshes", order, Unit::Order)
                .number("largest, cotangent, inside planes", inside, Unit::One)
                .number("largest, uniform, inside planes", uniform, Unit::One)
                .number("largest, cotangent, on boundaries of planes", border, Unit::One),
        ])
    }
}

/// The highest observed orders of the cotangent operator on jittered meshes: in the root mean
/// square, and of the largest error.
fn jittered_orders(orders: &Table) -> Result<[f64; 2]> {
    let jittered = orders
        .only(&[("sampling", Sampling::Jittered.name().into()), ("estimator", COTANGENT.into())])?;
    let [_, order] = extremes(jittered.column("order in RMS")?);
    let [_, largest] = extremes(jittered.column("order of the largest")?);
    Ok([order, largest])
}

/// The largest error of the cotangent operator on the finest jittered meshes.
fn left_on_jittered(errors: &Table) -> Result<f64> {
    let mut left = 0.0_f64;
    for surface in TestSurface::ALL {
        left = left.max(finest(errors, surface.name(), Sampling::Jittered.name(), COTANGENT)?);
    }
    Ok(left)
}

/// The errors of a cotangent operator over those of the uniform one, on the finest meshes, and the
/// names of the meshes.
fn ratios(errors: &Table, estimator: &str) -> Result<Vec<(f64, String)>> {
    let mut ratios = vec![];
    for surface in TestSurface::ALL {
        for sampling in Sampling::BOTH {
            let [uniform, cotangent] =
                [UNIFORM, estimator].map(|e| finest(errors, surface.name(), sampling.name(), e));
            let name = format!("{} {}", sampling.name(), surface.name());
            ratios.push((cotangent? / uniform?, name));
        }
    }
    Ok(ratios)
}

/// The largest values on planes: of the cotangent operator inside and on boundaries, and of the
/// uniform one inside.
fn on_planes(planes: &Table) -> Result<[f64; 3]> {
    let largest = |operator: &str, column: &str| -> Result<f64> {
        let rows = planes.only(&[("operator", operator.into())])?;
        Ok(rows.column(column)?.into_iter().fold(0.0, larger))
    };
    Ok([
        largest(COTANGENT, "inside")?,
        largest(COTANGENT, "boundary")?,
        largest(UNIFORM, "inside")?,
    ])
}

/// The figure of the original report that shows this mesh.
fn counterpart(name: &str) -> &'static str {
    if name == "plane" { "Figure 3" } else { "Figure 2" }
}

/// The cotangent estimate in the assignment's colours beside the original, and
/// both estimates with sign in diverging colours.
fn pictures(
    name: &str,
    mesh: &TriMesh,
    uniform: &MeanCurvature,
    cotangent: &MeanCurvature,
) -> Result<[Picture; 2]> {
    let norms = sizes(cotangent);
    let mut seen = seen::equalised(&[("‖Δx‖/2", &norms)])?;
    if is_flat(mesh, uniform, cotangent) {
        seen = format!("{seen} {}", TEXT.say("border", &[])?);
    }
    let (uniform, cotangent) = (uniform.clone().into_signed(), cotangent.clone().into_signed());
    let gallery =
        |looks| Gallery { looks, viewpoints: &VIEWPOINTS, up: Up::Z, aspect: 1.5, occlusion: true };
    let assignment = gallery(vec![
        Look { title: "plain", mesh, coloring: None },
        Look {
            title: "mean curvature",
            mesh,
            coloring: Some(Coloring {
                field: &norms,
                range: Range::All,
                options: ScaleOptions::EQUALIZED_HUE,
                quantity: "‖Δx‖/2, cotangent",
                unit: "1/mesh units",
            }),
        },
    ])
    .draw(
        name,
        &TEXT.say("figure equalised", values! { seen, counterpart: counterpart(name), name })?,
        &TEXT.say("figure equalised alt", values! { name })?,
    )?;
    let options = ScaleOptions { resolution: FLAT, ..ScaleOptions::SIGNED };
    let limits = gallery::common_limits(&[&uniform, &cotangent], &options)?;
    let signed = |title: &'static str, field| Look {
        title,
        mesh,
        coloring: Some(Coloring {
            field,
            range: Range::Inside,
            options: ScaleOptions { limits, ..options },
            quantity: if title == "uniform" { "H, uniform, scaled" } else { "H, cotangent" },
            unit: "1/mesh units",
        }),
    };
    let seen = seen::agreement(&uniform, &cotangent)?;
    let range = seen::range(&[&uniform, &cotangent])?;
    let diverging = gallery(vec![
        Look { title: "plain", mesh, coloring: None },
        signed("uniform", &uniform),
        signed("cotangent", &cotangent),
    ])
    .draw(
        &format!("{name}-signed"),
        &TEXT.say("figure signed", values! { seen, name, range })?,
        &TEXT.say("figure signed alt", values! { name })?,
    )?;
    Ok([assignment, diverging])
}

/// Returns true if both operators give zero at all vertices, as on a plane.
fn is_flat(mesh: &TriMesh, uniform: &MeanCurvature, cotangent: &MeanCurvature) -> bool {
    let h = mesh.mean_edge_length();
    let is_zero = |mean: &MeanCurvature| mean.signed.iter().all(|x| h * x.abs() < ZERO);
    is_zero(uniform) && is_zero(cotangent)
}

/// Both estimates on one mesh to turn.
fn view(
    name: &str,
    mesh: &TriMesh,
    uniform: &MeanCurvature,
    cotangent: &MeanCurvature,
) -> Result<View> {
    let flat = is_flat(mesh, uniform, cotangent);
    let panel = |title: &str, mean: &MeanCurvature| {
        let plain = Panel::still(title, mesh);
        let signed =
            |panel: Panel| panel.with_field("mean curvature", "1/mesh units", true, &mean.signed);
        let size = |panel: Panel| panel.with_field("‖Δx‖/2", "1/mesh units", false, &mean.norms());
        // The view opens with the first field.
        let zeros = vec![0.0; mesh.vertex_count()];
        if flat {
            signed(size(plain).exactly(zeros.clone())).exactly(zeros)
        } else {
            size(signed(plain))
        }
    };
    let seen = if flat {
        TEXT.say("view flat", &[])?
    } else {
        seen::agreement(&uniform.clone().into_signed(), &cotangent.clone().into_signed())?
    };
    Ok(View {
        id: format!("{name}-view"),
        mesh: name.into(),
        caption: TEXT.say("view", values! { seen, counterpart: counterpart(name), name })?,
        alt: TEXT.say("view alt", values! { name })?,
        fallback: format!("{name}-signed"),
        z_up: true,
        sliders: vec![],
        panels: vec![panel("uniform", uniform), panel("cotangent", cotangent)],
        ..View::default()
    })
}

/// Both estimates on a jittered torus, where the exact curvature is known.
fn torus_view(context: &Context<'_>) -> Result<(View, Picture)> {
    let surface = TestSurface::Torus;
    let level = context.choose(4, 3);
    // The mesh of the table, and its measure of the error.
    let mesh = surface.mesh(level, Sampling::Jittered, refinement::seed(context, surface, level));
    let mass = lumped_mass(&mesh, LumpedArea::Barycentric)?;
    let exact: Option<Vec<f64>> =
        mesh.positions().iter().map(|&p| surface.exact(p).map(|c| c.mean())).collect();
    let exact = exact.context("a vertex off the torus")?;
    let panel = |title: &str, operator: Estimate| -> Result<(Panel, f64, ScalarCurvature)> {
        let mean = operator(&mesh)?;
        let error = Deviation::new(&mean.signed, &exact, &mass).rms;
        let gaps = mean.signed.iter().zip(&exact).map(|(x, y)| x - y).collect();
        let gaps = ScalarCurvature::new(gaps, mean.status.clone(), mean.boundary.clone());
        let panel = Panel::still(title, &mesh)
            .with_field("mean curvature", "1/mesh units", true, &mean.signed)
            .exactly(exact.clone())
            .with_fact("RMS error", "%", vec![Some(100.0 * error)]);
        Ok((panel, error, gaps))
    };
    let (uniform, first, theirs) = panel("uniform", SCALED)?;
    let (cotangent, second, ours) = panel("cotangent", MIXED)?;
    let values = values! { uniform: first, cotangent: second };
    let picture = gallery::errors(
        "torus",
        &TEXT.say("figure torus", values)?,
        &TEXT.say("figure torus alt", &[])?,
        &mesh,
        &[("uniform", theirs), ("cotangent", ours)],
        !context.is_quick(),
    )?;
    let view = View {
        id: "torus-view".into(),
        mesh: "coarse jittered torus".into(),
        caption: TEXT.say("view torus", values)?,
        alt: TEXT.say("view torus alt", &[])?,
        fallback: "torus".into(),
        color: Some("error of mean curvature".into()),
        z_up: true,
        sliders: vec![],
        panels: vec![uniform, cotangent],
        ..View::default()
    };
    Ok((view, picture))
}

/// `½ ‖Δx‖` with the flags.
fn sizes(mean: &MeanCurvature) -> ScalarCurvature {
    ScalarCurvature::new(mean.norms(), mean.status.clone(), mean.boundary.clone())
}

/// Results of the operators on planes, where any curvature is an error.
fn planes(context: &Context<'_>) -> Result<Table> {
    let mut table = Table::new(
        "planes",
        &TEXT.say("table planes", &[])?,
        &[
            ("mesh", Unit::Label),
            ("operator", Unit::Label),
            ("inside", Unit::One),
            ("boundary", Unit::One),
            ("with sign", Unit::One),
        ],
    );
    let seed = context.seed("planes");
    let meshes: [(&str, TriMesh); 4] = [
        ("the assignment's grid", context.mesh(Input::Plane)?),
        ("alternating grid", shapes::plane(24, 24, shapes::Diagonals::Alternating)),
        ("jittered grid", shapes::jittered_plane(24, 24, 0.2, seed)),
        ("irregular Delaunay", shapes::irregular_plane(1.0 / 24.0, seed)),
    ];
    for (name, mesh) in &meshes {
        let h = mesh.mean_edge_length();
        for (operator, label) in [(SCALED, UNIFORM), (MIXED, COTANGENT)] {
            let mean = operator(mesh)?;
            let norms = mean.norms();
            let largest = |values: &[f64], keep: &dyn Fn(bool) -> bool| -> Cell {
                let kept = values.iter().zip(&mean.boundary).filter(|(_, b)| keep(**b));
                let found = h * kept.fold(0.0, |a, (x, _)| larger(a, x.abs()));
                // Rounding differs between machines; zero does not.
                Cell::from(if found < ZERO { 0.0 } else { found })
            };
            table.push(row![
                *name,
                label,
                largest(&norms, &|b| !b),
                largest(&norms, &|b| b),
                largest(&mean.signed, &|_| true),
            ]);
        }
    }
    Ok(table)
}
