//! Question 3: mean curvature from the cotangent Laplace–Beltrami operator.

use anyhow::{Context as _, Result};
use fairing_figure::{ScaleOptions, Up};
use fairing_mesh::TriMesh;
use fairing_operators::curvature::{
    MeanCurvature, ScalarCurvature, mean_curvature, scaled_umbrella_mean_curvature,
};
use fairing_operators::{LumpedArea, OperatorError};
use fairing_shapes as shapes;
use fairing_sparse::{larger, smaller};

use super::gallery::{self, Coloring, FLAT, Gallery, Look, Range, VIEWPOINTS};
use super::refinement::{self, Estimator, Quantity, finest};
use super::seen;
use super::spread;
use super::surfaces::{Sampling, TestSurface};
use crate::experiment::inputs::Input;
use crate::experiment::outcome::{MeshOutput, Outcome, Picture};
use crate::experiment::{Card, Context, Experiment};
use crate::model::section::{Act, Section};
use crate::model::table::{Cell, Table, Tables, Unit, brief};
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

/// An order above this is convergence.
const CONVERGES: f64 = 0.5;

/// Largest value taken for zero on a plane, as a multiple of 1 / mean edge length.
const ZERO: f64 = 1e-9;

/// The section of the article.
fn section() -> Section {
    Section::new(
        Act::Curvature,
        "Uniform weights mistake the shape of triangles for the shape of the surface. Cotangents weigh \
                edges by angles; does that help?",
    )
    .commands(&["fairing curvature mesh.ply -o curved.ply --estimator cotangent --area mixed", "fairing render curved.ply -o mean.png --field mean --map coolwarm"])
    .edge_lengths_of("each mesh")
    .sources(&["pinkall1993", "meyer2003", "desbrun1999"])
    .notation(&["x", "X", "i", "j", "A", "\\alpha", "\\beta", "H", "K", "n", "\\Delta", "M", "S"])
    .shows(&["torus-view", "convergence", "flower-signed"], &[])
    .names(&[("flower-view", "the flower"), ("plane-view", "the plane"), ("flower", "the flower in equalised colours"), ("plane", "the plane in equalised colours"), ("fields", "spread of the fields"), ("analytic", "errors under refinement"), ("orders", "orders of convergence"), ("planes", "what is left on planes")])
}

impl Experiment for CotangentCurvature {
    fn card(&self) -> Card {
        Card {
            id: "q3",
            title: "Mean curvature from the cotangent Laplacian",
            question: "Does the discrete Laplace–Beltrami operator with cotangent weights improve the estimate of mean curvature?".into(),
            method: "The cotangent stiffness S applied to the positions, over the mixed area of each vertex, gives the mean curvature vector: Δx = −M⁻¹Sx = −2Hn. It is the gradient of the area: only moving a vertex off the plane of its neighbours changes the area, so that on a plane, however uneven the triangles, nothing tangential is left. The sign of H comes from the normal.\n\nBoth meshes of the assignment are shown. The error is then compared with that of the uniform operator scaled by edge lengths (see q1), on surfaces whose curvature is known. Planes come last: their curvature is zero, so whatever an operator returns there is an error. They are regular, jittered and irregular, and vertices inside and on the boundary are counted apart.".into(),
            formulas: FORMULAS.map(String::from).to_vec(),
            section: section(),
            inputs: &[Input::Flower, Input::Plane],
            parameters: [("area of a vertex", "mixed (Voronoi where no angle is obtuse)".into())]
                .into_iter()
                .chain(TestSurface::parameters())
                .collect(),
        }
    }

    fn run(&self, context: &Context<'_>) -> Result<Outcome> {
        let mut outcome = Outcome::default();
        let mut fields = spread::table(
            "fields",
            "How mean curvature is spread over the two meshes, from either operator; inside and on the boundary apart.",
        );
        for (name, input) in [("flower", Input::Flower), ("plane", Input::Plane)] {
            let mesh = context.mesh(input)?;
            let uniform = scaled_umbrella_mean_curvature(&mesh);
            let cotangent = MIXED(&mesh)?;
            let norms = cotangent.norms();
            spread::push(&mut fields, name, "|H|, uniform", "1/mesh units", &sizes(&uniform));
            spread::push(&mut fields, name, "|H|, cotangent", "1/mesh units", &sizes(&cotangent));
            spread::push(
                &mut fields,
                name,
                "H, uniform",
                "1/mesh units",
                &uniform.clone().into_signed(),
            );
            spread::push(
                &mut fields,
                name,
                "H, cotangent",
                "1/mesh units",
                &cotangent.clone().into_signed(),
            );
            outcome.figures.extend(pictures(name, &mesh, &uniform, &cotangent)?);
            outcome.views.push(view(name, &mesh, &uniform, &cotangent));
            outcome.meshes.push(MeshOutput {
                id: format!("{name}-cotangent"),
                caption: format!("The {name} with the mean curvature of the cotangent operator, with and without sign, and of the uniform one."),
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
        let others = ratios(errors, BARYCENTRIC)?;
        let ratios: Vec<f64> = ratios(errors, COTANGENT)?.into_iter().map(|r| r.0).collect();
        let worst = ratios.iter().copied().fold(0.0, larger);
        let best = ratios.iter().copied().fold(f64::INFINITY, smaller);
        let [inside, border, uniform] = on_planes(tables.get("planes")?)?;
        let [mean, largest_order] = jittered_orders(tables.get("orders")?)?;
        let converges = mean > CONVERGES;
        let left = left_on_jittered(errors)?;
        let improves = worst < 1.0;
        let (clean, artefacts) = (inside < ZERO, border > ZERO);
        let verdict = match (improves, clean, artefacts) {
            (true, false, _) => Verdict::Confirmed,
            (false, true, false) => Verdict::Refuted,
            _ => Verdict::Qualified,
        };
        let first = if improves {
            "With mixed areas the cotangent operator is better on every surface and sampling"
        } else {
            "The cotangent operator is not better everywhere"
        };
        let reason = format!(
            "{first}: on the finest meshes its RMS error is at least {} times smaller than that of the uniform one. (On the regular sphere it is {} times smaller: the symmetry of an icosphere cancels its leading error.) {} But better is not convergent: on jittered meshes cotangents {} (order at most {} in the root mean square and {} in the largest error; the error is up to {} % of H on the finest meshes). Inside a plane they give {} on every triangulation tried; values below {}/h are rounding and count as zero. The uniform operator reaches {}/h. Only boundary vertices show, up to {}/h: there either operator is one-sided and points inwards along the plane. The signed value, the part along the normal, is zero there as well.",
            brief(1.0 / worst),
            two_digits(1.0 / best),
            with_barycentric(&others),
            if converges { "converge on some surface" } else { "do not converge either" },
            brief(mean),
            brief(largest_order),
            brief(100.0 * left),
            if clean { "zero".to_string() } else { format!("up to {}/h", brief(inside)) },
            brief(ZERO),
            brief(uniform),
            brief(border),
        );
        Ok(vec![
            Judgement::new(
                "3a",
                "Cotangents reveal detail on a complex mesh but create artefacts on the plane",
                verdict,
                reason,
            )
            .finding(format!(
                "With cotangents and mixed areas the error on the finest meshes is at least {} times smaller than with uniform weights. On a plane they {} inside, to rounding, and reach {}/h on the boundary.",
                brief(1.0 / worst),
                if clean { "are zero".to_string() } else { format!("reach {}/h", brief(inside)) },
                brief(border)
            ))
            .shown(Shown::view("q3", "torus-view", &ViewState::at(&[]).field("error of mean curvature")))
            .number("largest ratio of errors, cotangent to uniform", worst, Unit::One)
            .number("the same with barycentric areas", others.iter().map(|r| r.0).fold(0.0, larger), Unit::One)
            .number("highest order of cotangents on jittered meshes", mean, Unit::Order)
            .number("cotangent inside planes", inside, Unit::One)
            .number("uniform inside planes", uniform, Unit::One)
            .number("cotangent on boundaries of planes", border, Unit::One),
        ])
    }
}

/// The highest observed orders of the cotangent operator on jittered meshes: in the root mean
/// square, and of the largest error.
fn jittered_orders(orders: &Table) -> Result<[f64; 2]> {
    let jittered = orders
        .only(&[("sampling", Sampling::Jittered.name().into()), ("estimator", COTANGENT.into())])?;
    let highest = |column: &str| -> Result<f64> {
        Ok(jittered.column(column)?.into_iter().fold(f64::NEG_INFINITY, larger))
    };
    Ok([highest("order in RMS")?, highest("order of the largest")?])
}

/// The largest error of the cotangent operator on the finest jittered meshes.
fn left_on_jittered(errors: &Table) -> Result<f64> {
    let mut left = 0.0_f64;
    for surface in TestSurface::ALL {
        left = left.max(finest(errors, surface.name(), Sampling::Jittered.name(), COTANGENT)?);
    }
    Ok(left)
}

/// A number of two significant digits.
fn two_digits(x: f64) -> String {
    let unit = libm::pow(10.0, libm::log10(x).floor() - 1.0);
    brief((x / unit).round() * unit)
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

/// The meshes on which barycentric areas lose the advantage, as a sentence.
fn with_barycentric(ratios: &[(f64, String)]) -> String {
    let worse = ratios.iter().filter(|r| r.0 >= 1.0);
    let worse: Vec<String> = worse
        .map(|(ratio, name)| format!("{} times larger on the {name}", brief(*ratio)))
        .collect();
    match worse.is_empty() {
        true => "With barycentric areas it is the better one everywhere, too.".into(),
        false => format!("With barycentric areas its error is {}.", worse.join(", ")),
    }
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
    let counterpart = counterpart(name);
    let flat = match is_flat(mesh, uniform, cotangent) {
        true => " What looks like an artefact of cotangents is the border.",
        false => "",
    };
    let to_see = seen::equalised(&[("‖Δx‖/2", &norms)]) + flat;
    let (uniform, cotangent) = (uniform.clone().into_signed(), cotangent.clone().into_signed());
    let gallery =
        |looks| Gallery { looks, viewpoints: &VIEWPOINTS, up: Up::Z, aspect: 1.5, occlusion: true };
    let assignment = gallery(vec![
        Look { title: "original", mesh, coloring: None },
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
        &format!("{to_see} Counterpart of {counterpart} of the original report, in its colours: the {name} plain and with mean curvature from the cotangent Laplacian, from two viewpoints."),
        &format!("Four pictures of the {name}: plain and coloured by mean curvature, from two sides."),
    )?;
    let signed = |title: &'static str, field| Look {
        title,
        mesh,
        coloring: Some(Coloring {
            field,
            range: Range::Inside,
            options: ScaleOptions { resolution: FLAT, ..ScaleOptions::SIGNED },
            quantity: if title == "uniform" { "H, uniform, scaled" } else { "H, cotangent" },
            unit: "1/mesh units",
        }),
    };
    let diverging = gallery(vec![
        Look { title: "original", mesh, coloring: None },
        signed("uniform", &uniform),
        signed("cotangent", &cotangent),
    ])
    .draw(
        &format!("{name}-signed"),
        &format!("{} Signed mean curvature of the {name}; {}.", seen::agreement(&uniform, &cotangent), seen::range(&[&uniform, &cotangent])),
        &format!("Six pictures of the {name}: plain, coloured by the uniform and by the cotangent mean curvature, from two sides."),
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
fn view(name: &str, mesh: &TriMesh, uniform: &MeanCurvature, cotangent: &MeanCurvature) -> View {
    let flat = is_flat(mesh, uniform, cotangent);
    let panel = |title: &str, mean: &MeanCurvature| {
        let plain = Panel::still(title, mesh);
        let signed =
            |panel: Panel| panel.with_field("mean curvature", "1/mesh units", true, &mean.signed);
        let size = |panel: Panel| panel.with_field("‖Δx‖/2", "1/mesh units", false, &mean.norms());
        // What is shown first is to show something.
        let zeros = vec![0.0; mesh.vertex_count()];
        if flat {
            signed(size(plain).exactly(zeros.clone())).exactly(zeros)
        } else {
            size(signed(plain))
        }
    };
    let to_see = match flat {
        true => {
            "Only the border has colours: inside, both operators give zero, and the signed value is zero everywhere.".to_string()
        }
        false => seen::agreement(
            &uniform.clone().into_signed(),
            &cotangent.clone().into_signed(),
        ),
    };
    View {
        id: format!("{name}-view"),
        mesh: name.into(),
        caption: format!(
            "{to_see} Counterpart of {} of the original report: mean curvature of the {name} from either operator.",
            counterpart(name)
        ),
        alt: format!("The {name} twice, to turn, coloured by either mean curvature."),
        fallback: format!("{name}-signed"),
        z_up: true,
        sliders: vec![],
        panels: vec![panel("uniform", uniform), panel("cotangent", cotangent)],
        ..View::default()
    }
}

/// The mean of these values on the outer and on the inner half of a torus.
fn around_the_hole(torus: &TriMesh, values: &[f64]) -> [f64; 2] {
    [true, false].map(|outer| {
        let own = values
            .iter()
            .zip(torus.positions())
            .filter(|(_, p)| (libm::hypot(p[0], p[1]) > 1.0) == outer);
        let (sum, count) = own.fold((0.0, 0.0), |(s, n), (value, _)| (s + value, n + 1.0));
        sum / count
    })
}

/// A mean error of H, in words.
fn signed_gap(gap: f64) -> String {
    format!("{} {}", brief(gap.abs()), if gap < 0.0 { "too low" } else { "too high" })
}

/// Both estimates on a jittered torus, where the exact curvature is known.
fn torus_view(context: &Context<'_>) -> Result<(View, Picture)> {
    let surface = TestSurface::Torus;
    let seed = context.seed("torus");
    let mesh = surface.mesh(context.choose(4, 3), Sampling::Jittered, seed);
    let exact: Option<Vec<f64>> =
        mesh.positions().iter().map(|&p| surface.exact(p).map(|c| c.mean())).collect();
    let exact = exact.context("a vertex off the torus")?;
    let squares = |values: &mut dyn Iterator<Item = f64>| values.map(|x| x * x).sum::<f64>();
    let panel =
        |title: &str, operator: Estimate| -> Result<(Panel, f64, ScalarCurvature, [f64; 2])> {
            let mean = operator(&mesh)?;
            let gaps: Vec<f64> = mean.signed.iter().zip(&exact).map(|(x, y)| x - y).collect();
            let error = 100.0
                * (squares(&mut gaps.iter().copied()) / squares(&mut exact.iter().copied())).sqrt();
            let halves = around_the_hole(&mesh, &gaps);
            let gaps = ScalarCurvature::new(gaps, mean.status.clone(), mean.boundary.clone());
            let panel = Panel::still(title, &mesh)
                .with_field("mean curvature", "1/mesh units", true, &mean.signed)
                .exactly(exact.clone())
                .with_fact("RMS error", "%", vec![Some(error)]);
            Ok((panel, error, gaps, halves))
        };
    let (uniform, first, theirs, [outer, inner]) = panel("uniform", SCALED)?;
    let (cotangent, second, ours, _) = panel("cotangent", MIXED)?;
    let picture = gallery::errors(
        "torus",
        &format!(
            "Uniform weights are wrong on the whole torus, on average {} outside and {} around the hole; cotangents are off in spots only. In the root mean square that is {} % of H against {} %. The error of H on a jittered torus; grey is zero.",
            signed_gap(outer),
            signed_gap(inner),
            brief(first),
            brief(second)
        ),
        "A torus twice, coloured by errors: far more on the left.",
        &mesh,
        &[("uniform", theirs), ("cotangent", ours)],
        !context.is_quick(),
    )?;
    let view = View {
        id: "torus-view".into(),
        mesh: "coarse jittered torus".into(),
        caption: format!(
            "Colour is error: on a torus with jittered vertices uniform weights are off by {} % in the root mean square, cotangents by {} %. A click shows the exact value, the estimate and the error at a vertex.",
            brief(first),
            brief(second)
        ),
        alt: "A torus twice, to turn, coloured by the mean curvature of either operator.".into(),
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
        "The largest ‖Δx‖/2 and the largest signed |H| on planes, as multiples of 1/h. The exact value is zero.",
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

const FORMULAS: [&str; 1] = [
    r"(\Delta x)_i = \frac{1}{2 A_i} \sum_{j \sim i} (\cot\alpha_{ij} + \cot\beta_{ij})(x_j - x_i) = -2 H_i\, n_i",
];
