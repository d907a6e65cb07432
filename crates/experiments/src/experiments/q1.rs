//! Question 1: curvature from the uniform Laplacian and the angle defect.

use anyhow::Result;
use fairing_figure::{ScaleOptions, Up};
use fairing_mesh::TriMesh;
use fairing_operators::LumpedArea;
use fairing_operators::curvature::{
    ScalarCurvature, gaussian_curvature, scaled_umbrella_mean_curvature, umbrella_mean_curvature,
};
use fairing_sparse::{larger, smaller};

use super::gallery::{Coloring, FLAT, Gallery, Look, Range, VIEWPOINTS};
use super::refinement::{self, Estimator, Quantity};
use super::seen;
use super::spread;
use super::surfaces::{Sampling, TestSurface};
use crate::experiment::{Card, Context, Experiment};
use crate::inputs::Input;
use crate::outcome::{MeshOutput, Outcome, Picture};
use crate::section::{Act, Section};
use crate::table::{Table, brief};
use crate::view::{Panel, View};

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

/// The section of the article.
fn section() -> Section {
    Section::new(
        Act::Curvature,
        "The simplest Laplacian averages neighbours and ignores angles. We begin with what it \
                makes of curvature, because the next sections repair its faults.",
    )
    .commands(&["fairing smooth mesh.ply -o moved.ply --method explicit --lambda 1 --iterations 1  # each vertex moves by Δx", "fairing curvature mesh.ply -o curved.ply --estimator cotangent --area barycentric  # angle defect over area", "fairing render curved.ply -o gaussian.png --field gaussian --map coolwarm"])
    .edge_lengths_of("each mesh")
    .sources(&["taubin1995", "meyer2003", "sullivan2008"])
    .notation(&["x", "X", "i", "j", "D", "T", "A", "\\alpha", "\\beta", "H", "K"])
    .shows(&["flower-view", "convergence"], &[])
    .names(&[("plane-view", "the plane"), ("flower", "the flower in equalised colours"), ("plane", "the plane in equalised colours"), ("fields", "spread of the fields"), ("analytic", "errors under refinement"), ("orders", "orders of convergence")])
}

impl Experiment for UniformCurvature {
    fn card(&self) -> Card {
        Card {
            id: "q1",
            title: "Curvature from the uniform Laplacian",
            question: "What do the mean curvature of the uniform Laplacian and the Gaussian curvature of the angle defect look like, and do they approximate the curvature of the continuous surface?",
            method: "Mean curvature is half the length of the uniform Laplacian of the positions: H = ‖Δx‖/2, where (Δx)ᵢ is the vector from xᵢ to the average of its neighbours. That is a length, not a curvature; the scaled form divides it by a quarter of the mean squared edge length at the vertex and takes the sign from the normal. Gaussian curvature is the angle defect over the barycentric area, a third of the faces around the vertex. Where edges are uneven, Δx also has a part along the surface. It comes from the triangles and not from bending, but its length counts all the same: even on a plane ‖Δx‖ is not zero.\n\nBoth are shown on the two meshes of the assignment: in its colours (normalised and histogram equalised, from blue for low to red for high) and in diverging colours about zero. Both are then compared with the exact curvature of closed surfaces, on regular meshes and on meshes whose vertices are moved at random along the surface.".into(),
            formulas: FORMULAS.map(String::from).to_vec(),
            section: section(),
            inputs: &[Input::Flower, Input::Plane],
            parameters: [("area of a vertex", "barycentric".into())]
                .into_iter()
                .chain(TestSurface::parameters())
                .collect(),
        }
    }

    fn run(&self, context: &Context<'_>) -> Result<Outcome> {
        let mut outcome = Outcome::default();
        let mut fields = spread::table(
            "fields",
            "How the fields are spread over the two meshes; inside and on the boundary apart, where the Laplacian is one-sided and the defect is the turning of the border.",
        );
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
            outcome.views.push(pictures.view());
            let border = gaussian.boundary.iter().map(|&b| f64::from(u8::from(b))).collect();
            outcome.meshes.push(MeshOutput {
                id: format!("{name}-uniform"),
                caption: format!("The {name} with the uniform mean curvature as a length, scaled, and the Gaussian curvature."),
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
            options: ScaleOptions::ASSIGNMENT,
            quantity,
            unit,
        };
        self.gallery(
            coloring(self.length, "‖Δx‖/2, uniform", "mesh units"),
            coloring(self.gaussian, "K, angle defect", "1/mesh units²"),
        )
        .draw(
            self.name,
            &format!("{} Counterpart of Figure 1 of the original report, in its colours: the {} plain, with mean curvature from the uniform Laplacian, and with Gaussian curvature from the angle defect over barycentric areas, from two viewpoints.", seen::equalised(&[("‖Δx‖/2", self.length), ("K", self.gaussian)]), self.name),
            &format!("Six pictures of the {}: plain, coloured by mean and by Gaussian curvature, from two sides.", self.name),
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
        self.gallery(
            coloring(self.scaled, "H, uniform, scaled", "1/mesh units"),
            coloring(self.gaussian, "K, angle defect", "1/mesh units²"),
        )
        .draw(
            &format!("{}-signed", self.name),
            &format!("{} The {} with signed curvature; {}.", seen::signed(self.scaled, self.gaussian), self.name, seen::range(&[self.scaled, self.gaussian])),
            &format!("Six pictures of the {}: plain, coloured by signed mean and by Gaussian curvature, from two sides.", self.name),
        )
    }

    fn gallery(&self, mean: Coloring<'a>, gaussian: Coloring<'a>) -> Gallery<'a> {
        let mesh = self.mesh;
        Gallery {
            looks: vec![
                Look { title: "original", mesh, coloring: None },
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
    fn view(&self) -> View {
        let colored = Panel::still("curvature", self.mesh)
            .with_field("mean curvature, scaled", "1/mesh units", true, &self.scaled.values)
            .with_field("Gaussian curvature", "1/mesh units²", true, &self.gaussian.values)
            .with_field("‖Δx‖/2", "mesh units", false, &self.length.values);
        View {
            id: format!("{}-view", self.name),
            mesh: self.name.into(),
            caption: format!(
                "{} Counterpart of Figure 1 of the original report: the {} with curvature from the uniform Laplacian and the angle defect. The length ‖Δx‖/2 follows the size of the triangles, not the shape.",
                seen::signed(self.scaled, self.gaussian),
                self.name
            ),
            alt: format!("The {} to turn, plain and coloured by curvature.", self.name),
            fallback: format!("{}-signed", self.name),
            // On a plane only the angle defect has colours, those of the corners.
            color: seen::is_flat(self.scaled).then(|| "Gaussian curvature".into()),
            z_up: true,
            sliders: vec![],
            panels: vec![Panel::still("original", self.mesh), colored],
            ..View::default()
        }
    }
}

/// The answer to the question, and the numbers of the tables behind it.
fn answer(errors: &Table, orders: &Table) -> Result<[String; 2]> {
    let worst = |sampling: &str, estimator: &str| -> Result<[f64; 2]> {
        let rows =
            orders.only(&[("sampling", sampling.into()), ("estimator", estimator.into())])?;
        let values = rows.column("order in RMS")?;
        let pick = |f: fn(f64, f64) -> f64, from: f64| values.iter().copied().fold(from, f);
        Ok([pick(smaller, f64::INFINITY), pick(larger, f64::NEG_INFINITY)])
    };
    let [_, regular] = worst("regular", SCALED)?;
    let [_, jittered] = worst("jittered", SCALED)?;
    let torus = refinement::finest(errors, "torus", "regular", SCALED)?;
    let [least, gaussian] = worst("regular", DEFECT)?;
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
            let what = if order > CONVERGES {
                "falls"
            } else if last > first * (1.0 + GROWS) {
                "grows"
            } else {
                "stays"
            };
            Ok(format!(
                "{what} on the {} ({} on the coarsest mesh, {} on the finest, order {})",
                surface.name(),
                brief(first),
                brief(last),
                brief(order)
            ))
        })
        .into_iter()
        .collect::<Result<Vec<_>>>()?;
    let short = format!(
        "Mean curvature is not approximated. ‖Δx‖/2 is a length that goes to zero with the edges, and its distance from a curvature depends on the unit. Scaled by the edges it has the unit of a curvature, but uniform weights mistake uneven edges and tangential shifts for curvature: on the finest regular torus the relative error is still {}. Gaussian curvature converges in the root mean square on regular meshes only; on the finest jittered torus the error is {}. Only its total over the surface is exact (Gauss–Bonnet).",
        brief(torus),
        brief(left),
    );
    let numbers = format!(
        "The order of the scaled form is at most {} on regular and {} on jittered meshes. The order of Gaussian curvature in the root mean square is {} to {} on regular and at most {} on jittered meshes. On regular meshes its largest error {}.",
        brief(regular),
        brief(jittered),
        brief(least),
        brief(gaussian),
        brief(irregular),
        largest.join(", "),
    );
    Ok([short, numbers])
}

const FORMULAS: [&str; 2] = [
    r"H_i = \tfrac12 \Big\| \tfrac{1}{D_{ii}} \sum_{j \sim i} (x_j - x_i) \Big\|",
    r"K_i = \frac{1}{A_i} \Big( 2\pi - \sum_T \alpha_{i,T} \Big), \qquad A_i = \tfrac13 \sum_T A_T",
];
