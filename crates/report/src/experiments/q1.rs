//! Question 1: curvature from the uniform Laplacian and the angle defect.

use anyhow::Result;
use fairing_figure::{ScaleOptions, Up};
use fairing_mesh::TriMesh;
use fairing_operators::LumpedArea;
use fairing_operators::curvature::{
    ScalarCurvature, gaussian_curvature, scaled_umbrella_mean_curvature, umbrella_mean_curvature,
};

use super::gallery::{Coloring, FLAT, Gallery, Look, Range, VIEWPOINTS};
use super::refinement::{self, Estimator, Quantity};
use super::seen;
use super::spread;
use super::statistics::extremes;
use super::surfaces::{Sampling, TestSurface};
use crate::experiment::inputs::Input;
use crate::experiment::outcome::{MeshOutput, Outcome, Picture};
use crate::experiment::text::{Text, values};
use crate::experiment::{Card, Context, Experiment};
use crate::model::table::Table;
use crate::model::view::{Panel, View};

pub(super) struct UniformCurvature;

const UMBRELLA: &str = "uniform ‖Δx‖/2";
const SCALED: &str = "uniform, scaled";
const DEFECT: &str = "angle defect / barycentric area";

/// ‖Δx‖/2 is left out: a length has no error against a curvature.
const ESTIMATORS: [Estimator; 2] = [
    Estimator {
        name: SCALED,
        quantity: Quantity::Mean,
        estimate: |mesh| Ok(scaled_umbrella_mean_curvature(mesh).signed),
    },
    Estimator {
        name: DEFECT,
        quantity: Quantity::Gaussian,
        estimate: |mesh| Ok(gaussian_curvature(mesh, LumpedArea::Barycentric)?.values),
    },
];

/// An order above this is convergence.
const CONVERGES: f64 = 0.5;

/// A largest error that gains more than this from the coarsest mesh to the finest has grown.
const GROWS: f64 = 0.02;

/// `½ ‖L x‖` with `L = D⁻¹A − I`, as in the assignment.
fn umbrella(mesh: &TriMesh) -> Result<ScalarCurvature> {
    let mean = umbrella_mean_curvature(mesh);
    Ok(ScalarCurvature::new(mean.norms(), mean.status, mean.boundary))
}

static TEXT: Text = Text::new("q1", include_str!("../../text/q1.md"));

impl Experiment for UniformCurvature {
    fn card(&self) -> Card {
        let area = ("area of a vertex", "barycentric".into());
        let parameters = std::iter::once(area).chain(TestSurface::parameters()).collect();
        TEXT.card(&[Input::Flower, Input::Plane], parameters, &[])
    }

    fn run(&self, context: &Context<'_>) -> Result<Outcome> {
        let mut outcome = Outcome::default();
        let mut fields = spread::table("fields", &TEXT.say("table fields", &[])?);
        for (name, input) in [("flower", Input::Flower), ("plane", Input::Plane)] {
            let mesh = context.mesh(input)?;
            let length = umbrella(&mesh)?;
            let scaled = scaled_umbrella_mean_curvature(&mesh).into_signed();
            let gaussian = gaussian_curvature(&mesh, LumpedArea::Barycentric)?;
            spread::push(&mut fields, name, UMBRELLA, "mesh units", &length);
            spread::push(&mut fields, name, SCALED, "1/mesh units", &scaled);
            spread::push(&mut fields, name, DEFECT, "1/mesh units²", &gaussian);
            let pictures = Pictures {
                name,
                mesh: &mesh,
                length: &length,
                scaled: &scaled,
                gaussian: &gaussian,
            };
            outcome.figures.push(pictures.assignment()?);
            outcome.figures.push(pictures.diverging()?);
            outcome.views.push(pictures.view()?);
            let border = gaussian.boundary.iter().map(|&b| f64::from(u8::from(b))).collect();
            outcome.meshes.push(MeshOutput {
                id: format!("{name}-uniform"),
                caption: TEXT.say("mesh", values! { name })?,
                mesh,
                fields: vec![
                    ("mean_length".into(), length.values),
                    ("mean".into(), scaled.values),
                    ("gaussian".into(), gaussian.values),
                    ("boundary".into(), border),
                ],
            });
        }
        let [errors, orders] = refinement::study(context, &ESTIMATORS)?;
        outcome.figures.push(refinement::plot(&errors, &ESTIMATORS)?);
        outcome.notes.extend(answer(&errors, &orders)?);
        outcome.tables.extend([fields, errors, orders]);
        Ok(outcome)
    }
}

/// Pictures of a mesh.
struct Pictures<'a> {
    name: &'a str,
    mesh: &'a TriMesh,
    length: &'a ScalarCurvature,
    scaled: &'a ScalarCurvature,
    gaussian: &'a ScalarCurvature,
}

impl<'a> Pictures<'a> {
    /// The original and both curvatures by the recipe of the assignment.
    fn assignment(&self) -> Result<Picture> {
        let coloring = |field: &'a ScalarCurvature, quantity: &'a str, unit: &'a str| Coloring {
            field,
            range: Range::All,
            options: ScaleOptions::EQUALIZED_HUE,
            quantity,
            unit,
        };
        let seen = seen::equalised(&[("‖Δx‖/2", self.length), ("K", self.gaussian)])?;
        // Zero and one high value are far apart on the hue circle.
        let is_flat = seen::is_flat(self.scaled);
        let blended =
            if is_flat { format!(" {}", TEXT.say("blended", &[])?) } else { String::new() };
        self.gallery(
            coloring(self.length, "‖Δx‖/2, uniform", "mesh units"),
            coloring(self.gaussian, "K, angle defect", "1/mesh units²"),
        )
        .draw(
            self.name,
            &TEXT.say("figure equalised", values! { seen, name: self.name, blended })?,
            &TEXT.say("figure equalised alt", values! { name: self.name })?,
        )
    }

    /// The same in diverging colours about zero.
    fn diverging(&self) -> Result<Picture> {
        let coloring = |field: &'a ScalarCurvature, quantity: &'a str, unit: &'a str| Coloring {
            field,
            range: Range::Inside,
            options: ScaleOptions { resolution: FLAT, ..ScaleOptions::SIGNED },
            quantity,
            unit,
        };
        let seen = seen::signed(self.scaled, self.gaussian)?;
        let range = seen::range(&[self.scaled, self.gaussian])?;
        self.gallery(
            coloring(self.scaled, "H, uniform, scaled", "1/mesh units"),
            coloring(self.gaussian, "K, angle defect", "1/mesh units²"),
        )
        .draw(
            &format!("{}-signed", self.name),
            &TEXT.say("figure signed", values! { seen, name: self.name, range })?,
            &TEXT.say("figure signed alt", values! { name: self.name })?,
        )
    }

    fn gallery(&self, mean: Coloring<'a>, gaussian: Coloring<'a>) -> Gallery<'a> {
        let mesh = self.mesh;
        Gallery {
            looks: vec![
                Look { title: "plain", mesh, coloring: None },
                Look { title: "mean curvature", mesh, coloring: Some(mean) },
                Look { title: "Gaussian curvature", mesh, coloring: Some(gaussian) },
            ],
            viewpoints: &VIEWPOINTS,
            up: Up::Z,
            aspect: 1.5,
            occlusion: true,
        }
    }

    /// All fields on one mesh to turn, beside the plain mesh.
    fn view(&self) -> Result<View> {
        let colored = Panel::still("curvature", self.mesh)
            .with_field("mean curvature, scaled", "1/mesh units", true, &self.scaled.values)
            .with_field("Gaussian curvature", "1/mesh units²", true, &self.gaussian.values)
            .with_field("‖Δx‖/2", "mesh units", false, &self.length.values);
        let seen = seen::signed(self.scaled, self.gaussian)?;
        Ok(View {
            id: format!("{}-view", self.name),
            mesh: self.name.into(),
            caption: TEXT.say("view", values! { seen, name: self.name })?,
            alt: TEXT.say("view alt", values! { name: self.name })?,
            fallback: format!("{}-signed", self.name),
            // On a plane only the angle defect has colours, those of the corners.
            color: seen::is_flat(self.scaled).then(|| "Gaussian curvature".into()),
            z_up: true,
            sliders: vec![],
            panels: vec![Panel::still("plain", self.mesh), colored],
            ..View::default()
        })
    }
}

/// The answer to the question, and the numbers of the tables behind it.
fn answer(errors: &Table, orders: &Table) -> Result<[String; 2]> {
    let worst = |sampling: &str, estimator: &str| -> Result<[f64; 2]> {
        let rows =
            orders.only(&[("sampling", sampling.into()), ("estimator", estimator.into())])?;
        Ok(extremes(rows.column("order in RMS")?))
    };
    let [_, regular] = worst("regular", SCALED)?;
    let [_, jittered] = worst("jittered", SCALED)?;
    let torus = refinement::finest(errors, "torus", "regular", SCALED)?;
    let [least, _] = worst("regular", DEFECT)?;
    let [_, irregular] = worst("jittered", DEFECT)?;
    let left = refinement::finest(errors, "torus", "jittered", DEFECT)?;
    let largest = TestSurface::ALL
        .map(|surface| -> Result<String> {
            let rows = [
                ("surface", surface.name().into()),
                ("sampling", Sampling::Regular.name().into()),
                ("estimator", DEFECT.into()),
            ];
            let order = orders.value(&rows, "order of the largest")?;
            let error = errors.only(&rows)?.column("largest error")?;
            let [first, last] = [error[0], error[error.len() - 1]];
            let heading = if order > CONVERGES {
                "falls"
            } else if last > first * (1.0 + GROWS) {
                "grows"
            } else {
                "stays"
            };
            let falls = TEXT.say(heading, &[])?;
            TEXT.say("note largest", values! { falls, surface: surface.name(), order })
        })
        .into_iter()
        .collect::<Result<Vec<_>>>()?;
    Ok([
        TEXT.say("note answer", values! { torus, left })?,
        TEXT.say(
            "note numbers",
            values! {
                regular, jittered, least, irregular, largest: seen::list(&largest),
            },
        )?,
    ])
}
