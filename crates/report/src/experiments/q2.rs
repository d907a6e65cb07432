//! Question 2: the fundamental forms of the ellipsoid.

use std::f64::consts::{FRAC_PI_2, PI};

use anyhow::{Context as _, Result, ensure};
use fairing_figure::{Axis, Figure, Panel, Plot, Series};
use fairing_operators::LumpedArea;
use fairing_operators::curvature::{CotangentOptions, Estimator};
use fairing_operators::surface::{ClosedForms, Ellipsoid, ParametricSurface};
use fairing_shapes as shapes;
use fairing_sparse::smaller;
use glam::DVec3;

use super::gallery::plotted;
use crate::experiment::outcome::{Outcome, Picture};
use crate::experiment::text::{Text, values};
use crate::experiment::{Card, Context, Experiment};
use crate::model::table::{Table, Tables, Tolerance, Unit};
use crate::model::verdict::{Judgement, Shown, Verdict};
use crate::row;

/// Half axes under study; the first is a sphere, on which the original report's
/// answer looks right.
const AXES: [[f64; 3]; 6] = [
    [1.0, 1.0, 1.0],
    [2.0, 1.0, 1.0],
    [1.0, 2.0, 1.0],
    [1.0, 1.0, 2.0],
    [1.0, 1.5, 2.0],
    [3.0, 2.0, 1.0],
];

/// The step of central differences: the cube root of the rounding unit, where
/// truncation and rounding are alike; second differences are good to 1e-5.
const STEP: f64 = 1e-3;

pub(super) struct EllipsoidForms;

static TEXT: Text = Text::new("q2", include_str!("../../text/q2.md"));

impl Experiment for EllipsoidForms {
    fn card(&self) -> Card {
        let axes = ("half axes (a, b, c)", AXES.map(axes_name).join(", "));
        TEXT.card(&[], vec![axes], &[])
    }

    fn run(&self, context: &Context<'_>) -> Result<Outcome> {
        let mut outcome = Outcome::default();
        outcome.tables.push(forms()?);
        let directions = directions()?;
        outcome.figures.push(plot(&directions)?);
        outcome.tables.push(directions);
        outcome.tables.push(meshes(context)?);
        Ok(outcome)
    }

    fn judge(&self, tables: Tables<'_>) -> Result<Vec<Judgement>> {
        let forms = tables.get("forms")?;
        let ours = forms.column("κ along y")?;
        let theirs = forms.column("κ along y, original")?;
        let differences = forms.column("κ along y, differences")?;
        let check = gap(&ours, &differences);
        // The sign is a matter of the normal: compare sizes alone.
        let sizes: Vec<f64> = theirs.iter().map(|k| k.abs()).collect();
        let error = gap(&ours, &sizes);
        let e = forms.column("e")?.iter().fold(f64::INFINITY, |a, b| smaller(a, b.abs()));
        let mesh = tables.get("meshes")?.column("error of κ₁")?;
        let wrong = error > 1e-3 && check < 1e-4;
        let verdict = if wrong { Verdict::Refuted } else { Verdict::Confirmed };
        let right = ours.iter().zip(&sizes).filter(|(a, b)| (*a - *b).abs() < 1e-9).count();
        let values = values! { check, e, error, right, all: ours.len() };
        Ok(vec![
            TEXT.judgement("2a", verdict, values)?
                .shown(Shown::playground("ellipsoid", &[&2, &1, &0.7, &0]))
                .number("largest error of |−1/c|", error, Unit::Relative)
                .number("gap between closed form and differences", check, Unit::Relative)
                .number(
                    "error of κ₁ on the finest mesh",
                    mesh.last().copied().context("no meshes")?,
                    Unit::Relative,
                ),
        ])
    }
}

/// The largest relative gap.
fn gap(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).fold(0.0, |worst, (x, y)| worst.max((x - y).abs() / x.abs()))
}

fn axes_name([a, b, c]: [f64; 3]) -> String {
    format!("({a}, {b}, {c})")
}

/// The coefficients at (a, 0, 0) and the curvature along y, each in more than
/// one way.
fn forms() -> Result<Table> {
    let mut table = Table::new(
        "forms",
        &TEXT.say("table forms", &[])?,
        &[
            ("(a, b, c)", Unit::Label),
            ("E", Unit::Area),
            ("F", Unit::Area),
            ("G", Unit::Area),
            ("e", Unit::Length),
            ("f", Unit::Length),
            ("g", Unit::Length),
            ("κ along y", Unit::Curvature),
            ("κ along y, differences", Unit::Curvature),
            ("κ along y, original", Unit::Curvature),
            ("κ along z", Unit::Curvature),
        ],
    )
    .tolerance("κ along y, differences", Some(Tolerance { relative: 1e-4, absolute: 0.0 }))
    .aside(&["E", "F", "G", "f", "κ along z"]);
    for axes in AXES {
        let [a, b, c] = axes;
        let ellipsoid = Ellipsoid { a, b, c };
        let [e, f, g] = ellipsoid.first_form(0.0, FRAC_PI_2);
        let [l, m, n] = ellipsoid.second_form(0.0, FRAC_PI_2);
        let forms = ellipsoid.forms(0.0, FRAC_PI_2)?;
        let along = |d| forms.normal_curvature(d).context("a direction of no length");
        table.push(row![
            axes_name(axes),
            e,
            // Rounding of cos π/2 is no coefficient.
            if f.abs() < 1e-12 { 0.0 } else { f },
            g,
            l,
            m,
            n,
            along([1.0, 0.0])?,
            difference_curvature(axes),
            -1.0 / c,
            along([0.0, 1.0])?,
        ]);
    }
    Ok(table)
}

/// κₙ along y at (a, 0, 0) from values of p alone.
fn difference_curvature([a, b, c]: [f64; 3]) -> f64 {
    let p = |u: f64, v: f64| {
        DVec3::new(
            a * libm::cos(u) * libm::sin(v),
            b * libm::sin(u) * libm::sin(v),
            c * libm::cos(v),
        )
    };
    let (u, v, h) = (0.0, FRAC_PI_2, STEP);
    let difference = |x: DVec3, y: DVec3| (x - y) / (2.0 * h);
    let pu = difference(p(u + h, v), p(u - h, v));
    let pv = difference(p(u, v + h), p(u, v - h));
    let (plus, here, minus) = (p(u + h, v), p(u, v), p(u - h, v));
    let puu = (plus - 2.0 * here + minus) / (h * h);
    let normal = pu.cross(pv);
    puu.dot(normal * (1.0 / normal.length())) / pu.dot(pu)
}

/// κₙ over θ.
fn directions() -> Result<Table> {
    let mut table = Table::new(
        "directions",
        &TEXT.say("table directions", &[])?,
        &[
            ("(a, b, c)", Unit::Label),
            ("θ", Unit::Degrees),
            ("κ", Unit::Curvature),
            ("κ, original", Unit::Curvature),
        ],
    );
    for axes in AXES {
        let [a, b, c] = axes;
        let forms = Ellipsoid { a, b, c }.forms(0.0, FRAC_PI_2)?;
        for step in 0..=36 {
            let theta = PI * f64::from(step) / 36.0;
            // The report takes dv for y: at θ = 0 it has du = 0.
            let (s, co) = libm::sincos(theta);
            let kappa = forms.normal_curvature([co / b, -s / c]).context("no direction")?;
            let stated = -c * (co / c).powi(2);
            table.push(row![axes_name(axes), theta.to_degrees(), kappa, stated]);
        }
    }
    Ok(table)
}

/// κₙ(θ), ours and the original report's, a panel for each ellipsoid.
fn plot(directions: &Table) -> Result<Picture> {
    let mut figure = Figure { columns: 3, ..Figure::default() };
    for axes in AXES {
        let rows = directions.only(&[("(a, b, c)", axes_name(axes).into())])?;
        let line = |column: &str| -> Result<Vec<[f64; 2]>> {
            let points = rows.column("θ")?.into_iter().zip(rows.column(column)?);
            Ok(points.map(|(theta, kappa)| [theta, kappa]).collect())
        };
        let plot = Plot {
            title: format!("(a, b, c) = {}", axes_name(axes)),
            x: Axis::linear("θ in degrees, +y at 0, +z at 90").from_to(0.0, 180.0),
            y: Axis::linear("κₙ in 1/mesh units"),
            series: vec![
                Series::line("forms", line("κ")?),
                Series::line("original", line("κ, original")?),
            ],
            ..Plot::default()
        };
        figure.panels.push(Panel::drawing(plot.draw(300.0, 270.0)?));
    }
    let equal: Vec<String> = AXES
        .into_iter()
        .filter_map(|axes| {
            Some(format!("{:.0}° on {}", equal_sizes(axes)?.to_degrees(), axes_name(axes)))
        })
        .collect();
    let caption = TEXT.say("figure", values! { equal: equal.join(", ") })?;
    plotted(&figure, "directions", &caption, &TEXT.say("figure alt", &[])?)
}

/// The direction from y at which cos²θ/c is a (cos²θ/b² + sin²θ/c²), if there is one: there
/// tan²θ = c/a − c²/b².
fn equal_sizes([a, b, c]: [f64; 3]) -> Option<f64> {
    let square = c / a - (c / b).powi(2);
    (square >= 0.0).then(|| libm::atan(square.sqrt()))
}

/// The same on meshes.
fn meshes(context: &Context<'_>) -> Result<Table> {
    let axes = AXES[AXES.len() - 1];
    let mut table = Table::new(
        "meshes",
        &TEXT.say("table meshes", values! { axes: axes_name(axes) })?,
        &[
            ("estimator", Unit::Label),
            ("vertices", Unit::Count),
            ("h", Unit::Length),
            ("κ₁", Unit::Curvature),
            ("κ₂", Unit::Curvature),
            ("error of κ₁", Unit::Relative),
            ("error of κ₂", Unit::Relative),
            ("angle", Unit::Degrees),
        ],
    )
    .aside(&["κ₁", "κ₂"]);
    let [a, b, c] = axes;
    let (along_z, along_y) = (a / (c * c), a / (b * b));
    for estimator in [COTANGENT, Estimator::RECOMMENDED] {
        for level in 3..=context.choose(6, 4) {
            context.progress(f64::from(level - 3) / 4.0, "meshes");
            let mesh = shapes::ellipsoid([a, b, c], level);
            let tip = mesh
                .positions()
                .iter()
                .position(|p| (p[0] - a).abs() < 1e-12 * a)
                .context("no vertex at (a, 0, 0)")?;
            let field = estimator.estimate(&mesh)?;
            ensure!(field.status[tip].is_defined(), "{estimator} is undefined at the tip");
            let (k1, k2) = (field.kappa1[tip], field.kappa2[tip]);
            // A direction has no sense: an angle is at most 90°.
            let angle = field.directions.map(|[first, _]| libm::acos(first[tip][2].abs().min(1.0)));
            table.push(row![
                estimator.name(),
                mesh.vertex_count(),
                mesh.mean_edge_length(),
                k1,
                k2,
                (k1 - along_z).abs() / along_z,
                (k2 - along_y).abs() / along_y,
                angle.map(f64::to_degrees),
            ]);
        }
    }
    Ok(table.tolerance("angle", Some(Tolerance { relative: 0.0, absolute: 1e-4 })))
}

/// H and K of the plain operators; no directions.
const COTANGENT: Estimator = Estimator::Cotangent(CotangentOptions { area: LumpedArea::Mixed });

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_agree_where_the_caption_says() {
        let mut found = 0;
        for axes in AXES {
            let [a, b, c] = axes;
            let Some(theta) = equal_sizes(axes) else { continue };
            let forms = Ellipsoid { a, b, c }.forms(0.0, FRAC_PI_2).unwrap();
            let (s, co) = libm::sincos(theta);
            let kappa = forms.normal_curvature([co / b, -s / c]).unwrap();
            assert!((kappa.abs() - co * co / c).abs() < 1e-12, "{axes:?}");
            found += 1;
        }
        assert_eq!(found, 4);
        assert!(equal_sizes([1.6, 1.2, 0.9]).unwrap_or(0.0) < 1e-7);
    }
}
