//! What questions 5 and 6 share: noisy meshes with a ground truth, how far from it a flow ends, and the same flow at
//! several λ in numbers, meshes and views.

use anyhow::{Context as _, Result};
use fairing_evaluation::{SurfaceTree, drift, feature_edges, normal_error, vertex_displacement};
use fairing_mesh::TriMesh;
use fairing_mesh::vec3::{add, cross, dot, norm, normalize, scale, sub};
use fairing_smoothing::{
    Diffusion, Explicit, FlowError, Implicit, Smoothed, Stability, explicit, implicit,
};
use rayon::prelude::*;

use super::statistics::least;
use crate::experiment::Context;
use crate::inputs::Input;
use crate::outcome::{MeshOutput, Outcome, Picture};
use crate::row;
use crate::table::{Cell, Table, Tolerance, Unit, short};
use crate::view::{Panel, Slider, View};

/// The numbers of steps that views show, up to those of the flow.
const VIEWED_STEPS: [usize; 1] = [10];

/// Edges that turn by at least this many degrees are features.
pub(super) const FEATURE: f64 = 30.0;

/// A mesh to smooth and what it ought to become.
pub(super) struct Model {
    pub(super) name: &'static str,
    pub(super) noisy: TriMesh,
    pub(super) truth: TriMesh,
    /// The surface of the truth.
    surface: SurfaceTree,
    /// Whether its pictures have occlusion.
    pub(super) occlusion: bool,
}

/// Distances between surfaces are measured at no more than about so many vertices of each, every mth: a root mean
/// square over n independent values is known to 1/√(2n), here 1.6 %, and comparisons over λ use the same vertices.
const SAMPLES: usize = 2000;

/// Every mth vertex, from as many as there are to half of [`SAMPLES`] at least.
fn sampled(mesh: &TriMesh) -> Vec<[f64; 3]> {
    let step = mesh.vertex_count().div_ceil(SAMPLES).max(1);
    mesh.positions().iter().copied().step_by(step).collect()
}

/// The root mean square distance of points from a surface.
fn rms_distance(points: &[[f64; 3]], surface: &SurfaceTree) -> f64 {
    let squares: f64 = surface.distances(points).iter().map(|d| d * d).sum();
    (squares / points.len() as f64).sqrt()
}

impl Model {
    /// A model of this name.
    pub(super) fn new(name: &'static str, noisy: TriMesh, truth: TriMesh) -> Result<Self> {
        let surface = SurfaceTree::new(&truth)?;
        Ok(Self { name, noisy, truth, surface, occlusion: true })
    }

    /// The three meshes of the questions: the patch, the machine part and the cube.
    pub(super) fn all(context: &Context<'_>) -> Result<[Self; 3]> {
        let patch = context.mesh(Input::NoisyPlane)?;
        let cube = context.mesh(Input::Cube)?;
        let models = [
            Self::new("patch", patch.clone(), flattened(&patch)?)?,
            Self::new(
                "machine part",
                context.mesh(Input::NoisyFandisk)?,
                context.mesh(Input::Fandisk)?,
            )?,
            Self::new("cube", cube.clone(), cube)?,
        ];
        Ok(models.map(|model| Self { occlusion: !context.is_quick(), ..model }))
    }

    /// Its name in ids.
    pub(super) fn slug(&self) -> String {
        slug(self.name)
    }

    /// Mean edge length of the truth.
    pub(super) fn h(&self) -> f64 {
        self.truth.mean_edge_length()
    }

    /// Explicit steps, unstable ones too.
    pub(super) fn explicit(&self, lambda: f64, iterations: usize) -> Result<Smoothed, FlowError> {
        let options = Explicit {
            iterations,
            stability: Stability::Allow,
            ..Explicit::new(Diffusion::uniform(lambda))
        };
        explicit(&self.noisy, &options, None)
    }

    /// Implicit steps.
    pub(super) fn implicit(&self, lambda: f64, iterations: usize) -> Result<Smoothed, FlowError> {
        let options = Implicit { iterations, ..Implicit::new(Diffusion::uniform(lambda)) };
        implicit(&self.noisy, &options, None)
    }

    /// How `mesh` compares with the truth and with the input.
    pub(super) fn measure(&self, mesh: &TriMesh) -> Result<Measures> {
        let change = drift(mesh, &self.truth);
        let moved = vertex_displacement(mesh, &self.noisy)?;
        let boundary = mesh.topology().boundary_vertices();
        let part = |border: bool| {
            let squares: Vec<f64> = (0..mesh.vertex_count())
                .filter(|&v| boundary[v] == border)
                .map(|v| {
                    let d = sub(mesh.positions()[v], self.noisy.positions()[v]);
                    dot(d, d)
                })
                .collect();
            let n = squares.len() as f64;
            (n > 0.0).then(|| (squares.iter().sum::<f64>() / n).sqrt() / self.h())
        };
        let growth = mesh.diagonal() / self.noisy.diagonal();
        // A mesh that has collapsed to a point has no normals but those of rounding, and one without creases no
        // recall.
        let is_shape = growth > POINT;
        let forward = rms_distance(&sampled(mesh), &self.surface) / self.h();
        let backward = rms_distance(&sampled(&self.truth), &SurfaceTree::new(mesh)?) / self.h();
        let recall = feature_edges(mesh, &self.truth, FEATURE)?.recall();
        Ok(Measures {
            normal: normal_error(mesh, &self.truth).ok().filter(|_| is_shape).map(|e| e.mean),
            vertex: forward,
            surface: libm::hypot(forward, backward) / 2f64.sqrt(),
            volume: change.volume.map(|v| 100.0 * v),
            area: change.area.map(|a| 100.0 * a),
            recall: recall.filter(|_| is_shape),
            rms: moved.rms / self.h(),
            largest: moved.max / self.h(),
            inside: part(false),
            border: part(true),
            growth,
        })
    }
}

/// How a flow ended.
#[derive(Debug, Clone, Copy)]
pub(super) struct Measures {
    /// Mean angle between normals of faces and of the truth, in degrees.
    pub(super) normal: Option<f64>,
    /// Root mean square distance of the vertices from the surface of the truth, in h.
    pub(super) vertex: f64,
    /// Root mean square distance between the surfaces both ways, from the vertices of each to the other, in h: what has
    /// shrunk within the truth leaves vertices of the truth behind.
    pub(super) surface: f64,
    /// Change of volume against the truth in per cent; `None` if open.
    pub(super) volume: Option<f64>,
    /// Change of area against the truth in per cent.
    pub(super) area: Option<f64>,
    /// The share of the truth's features that are found; `None` if it has none.
    pub(super) recall: Option<f64>,
    /// Root mean square displacement from the input, in h.
    pub(super) rms: f64,
    /// Largest displacement from the input, in h.
    pub(super) largest: f64,
    /// Root mean square displacement of inner vertices, in h.
    pub(super) inside: Option<f64>,
    /// Root mean square displacement of boundary vertices, in h.
    pub(super) border: Option<f64>,
    /// Diagonal over that of the input.
    pub(super) growth: f64,
}

/// The columns that [`Measures::cells`] fills.
const COLUMNS: [(&str, Unit); 11] = [
    ("normal error", Unit::Degrees),
    ("vertex error", Unit::EdgeLengths),
    ("surface error", Unit::EdgeLengths),
    ("volume", Unit::Percent),
    ("area", Unit::Percent),
    ("feature recall", Unit::One),
    ("displacement", Unit::EdgeLengths),
    ("largest displacement", Unit::EdgeLengths),
    ("displacement inside", Unit::EdgeLengths),
    ("displacement of the border", Unit::EdgeLengths),
    ("growth", Unit::One),
];

impl Measures {
    pub(super) fn cells(&self) -> [Cell; 11] {
        [
            self.normal.into(),
            self.vertex.into(),
            self.surface.into(),
            self.volume.into(),
            self.area.into(),
            self.recall.into(),
            self.rms.into(),
            self.largest.into(),
            self.inside.into(),
            self.border.into(),
            self.growth.into(),
        ]
    }
}

/// The columns of a sweep over λ.
pub(super) const SWEPT: [(&str, Unit); 7] = [
    ("mesh", Unit::Label),
    ("lambda", Unit::One),
    ("normal error", Unit::Degrees),
    ("vertex error", Unit::EdgeLengths),
    ("surface error", Unit::EdgeLengths),
    ("feature recall", Unit::One),
    ("volume", Unit::Percent),
];

/// A flow over many λ: a row of [`SWEPT`] for each of them, on each model with a truth of its own.
pub(super) fn sweep(
    table: &mut Table,
    models: &[Model],
    lambdas: &[f64],
    run: impl Fn(&Model, f64) -> Result<Smoothed, FlowError> + Sync,
) -> Result<()> {
    for model in models.iter().filter(|m| m.name != "cube") {
        let measure = |&lambda: &f64| model.measure(&run(model, lambda)?.mesh);
        let measured: Vec<Measures> = lambdas.par_iter().map(measure).collect::<Result<_>>()?;
        for (lambda, m) in lambdas.iter().zip(measured) {
            table
                .push(row![model.name, *lambda, m.normal, m.vertex, m.surface, m.recall, m.volume]);
        }
    }
    Ok(())
}

/// The λ of a sweep with the least error in this column.
pub(super) fn best_lambda(sweep: &Table, mesh: &str, column: &str) -> Result<f64> {
    let rows = sweep.only(&[("mesh", mesh.into())])?;
    let pairs: Vec<(f64, f64)> =
        rows.column(column)?.into_iter().zip(rows.column("lambda")?).collect();
    Ok(least(&pairs).context("an empty sweep")?.1)
}

/// One flow at several λ.
pub(super) struct OverLambda<'a> {
    /// `explicit` or `implicit`.
    pub(super) kind: &'static str,
    pub(super) lambdas: &'a [f64],
    /// Steps at each λ.
    pub(super) iterations: usize,
    /// How many of the λ views show: what diverges cannot be shown beside the rest.
    pub(super) viewed: usize,
    /// The flow.
    pub(super) run: fn(&Model, f64, usize) -> Result<Smoothed, FlowError>,
    /// The figure of the input and the results.
    pub(super) draw: fn(&Model, &[TriMesh]) -> Result<Picture>,
}

impl OverLambda<'_> {
    /// Runs the flow on all models: fills in figures, views and meshes, and returns the table.
    pub(super) fn measure(
        &self,
        context: &Context<'_>,
        models: &[Model],
        outcome: &mut Outcome,
    ) -> Result<Table> {
        let Self { kind, lambdas, iterations, .. } = *self;
        let columns: Vec<(&str, Unit)> =
            [("mesh", Unit::Label), ("lambda", Unit::One)].into_iter().chain(COLUMNS).collect();
        let caption = format!(
            "After {iterations} {kind} steps; λ = 0 is the input. Volume and area against the truth; growth is the diagonal over that of the input. The vertex error is the distance of the vertices from the true surface, the surface error the root mean square of that distance and of the distance back: only the latter sees that a patch has shrunk. Distances are measured at up to {SAMPLES} vertices spread over each mesh."
        );
        let mut table = Table::new("flows", &caption, &columns)
            // What has diverged is mostly its roughest mode, what has collapsed is a point: rounding has its say.
            .tolerance("normal error", Some(Tolerance::LOOSE));
        for (i, model) in models.iter().enumerate() {
            context.progress(0.15 * i as f64, model.name);
            let run = |&lambda: &f64| Ok((self.run)(model, lambda, iterations)?.mesh);
            let after: Vec<TriMesh> = lambdas.par_iter().map(run).collect::<Result<_>>()?;
            let smoothed: Vec<TriMesh> = [model.noisy.clone()].into_iter().chain(after).collect();
            let with_input = || [0.0].into_iter().chain(lambdas.iter().copied());
            let measured: Vec<Measures> =
                smoothed.par_iter().map(|mesh| model.measure(mesh)).collect::<Result<_>>()?;
            for (lambda, measures) in with_input().zip(&measured) {
                let leading = row![model.name, lambda];
                table.push(leading.into_iter().chain(measures.cells()));
            }
            outcome.figures.push((self.draw)(model, &smoothed)?);
            outcome.views.push(self.view(model, &smoothed)?);
            for (lambda, mesh) in with_input().zip(smoothed).skip(1) {
                outcome.meshes.push(MeshOutput {
                    id: format!("{}-{}", model.slug(), slug(&lambda.to_string())),
                    caption: format!(
                        "The {} after {iterations} {kind} steps with λ = {lambda}.",
                        model.name
                    ),
                    mesh,
                    fields: vec![],
                });
            }
        }
        Ok(table)
    }

    /// The input, which the page can smooth, beside the flow at each λ on its way.
    fn view(&self, model: &Model, smoothed: &[TriMesh]) -> Result<View> {
        let Self { kind, lambdas, iterations, viewed, .. } = *self;
        let left_out = if viewed < lambdas.len() { " (what diverges is left out)" } else { "" };
        let counts: Vec<usize> =
            VIEWED_STEPS.into_iter().filter(|&n| n < iterations).chain([iterations]).collect();
        let mut stops: Vec<TriMesh> = vec![];
        for (&lambda, last) in lambdas[..viewed].iter().zip(&smoothed[1..]) {
            for &count in &counts[..counts.len() - 1] {
                stops.push((self.run)(model, lambda, count)?.mesh);
            }
            stops.push(last.clone());
        }
        Ok(View {
            id: format!("{}-view", model.slug()),
            caption: format!(
                "The {} before and after {kind} steps, over λ and their number{left_out}. The page can take implicit steps of any λ from the input on the left.",
                model.name
            ),
            alt: format!("The {} twice, to turn, with sliders over λ and iterations.", model.name),
            fallback: model.slug(),
            z_up: true,
            sliders: vec![Slider::new("λ", &lambdas[..viewed]), Slider::new("iterations", &counts)],
            panels: vec![
                Panel::still("input", &model.noisy).with_live_smoothing(&model.noisy),
                Panel::moving(kind, &model.noisy, stops.iter().map(TriMesh::positions)),
            ],
        })
    }
}

/// Lower-case words joined by hyphens.
pub(super) fn slug(text: &str) -> String {
    text.replace([' ', '.'], "-")
}

/// The mesh with every vertex on its plane of least squared distances.
fn flattened(mesh: &TriMesh) -> Result<TriMesh> {
    let x = mesh.positions();
    let centre = scale(x.iter().fold([0.0; 3], |s, &p| add(s, p)), 1.0 / x.len() as f64);
    let vectors = (0..mesh.face_count()).map(|f| mesh.area_vector(f));
    let mut normal =
        normalize(vectors.fold([0.0; 3], add)).context("the patch has no mean normal")?;
    // The height over the plane is fitted by au + bv; the best plane is where a = b = 0.
    for _ in 0..20 {
        let axis = if normal[0].abs() < 0.6 { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] };
        let e1 = normalize(cross(normal, axis)).context("a normal without length")?;
        let e2 = cross(normal, e1);
        let mut s = [0.0; 5];
        for &p in x {
            let d = sub(p, centre);
            let (u, v, w) = (dot(d, e1), dot(d, e2), dot(d, normal));
            for (s, term) in s.iter_mut().zip([u * u, u * v, v * v, u * w, v * w]) {
                *s += term;
            }
        }
        let determinant = s[0] * s[2] - s[1] * s[1];
        let a = (s[3] * s[2] - s[4] * s[1]) / determinant;
        let b = (s[4] * s[0] - s[3] * s[1]) / determinant;
        let tilted = sub(normal, add(scale(e1, a), scale(e2, b)));
        normal = normalize(tilted).context("the patch is a line")?;
    }
    let flat = x.iter().map(|&p| sub(p, scale(normal, dot(sub(p, centre), normal))));
    Ok(mesh.with_positions(flat.collect())?)
}

/// Beyond this growth of the diagonal a mesh is said to diverge.
pub(super) const DIVERGED: f64 = 2.0;
/// Below this share of its diagonal a mesh is drawn enlarged.
const SMALL: f64 = 0.15;
/// Below this share hardly a digit of the shape is left.
const POINT: f64 = 1e-9;
/// Below this share of the squared diagonal there is no area to be seen.
const LINE: f64 = 1e-3;

/// A smoothed mesh as it is drawn beside its input, and what its title says of that: meshes that have diverged or
/// shrunk are drawn at the size of the input.
pub(super) fn drawn(mesh: &TriMesh, input: &TriMesh) -> Result<(TriMesh, String)> {
    let growth = mesh.diagonal() / input.diagonal();
    if growth < POINT {
        return Ok((mesh.clone(), " (a point)".into()));
    }
    let area: f64 = (0..mesh.face_count()).map(|f| norm(mesh.area_vector(f))).sum();
    let is_line = area < LINE * mesh.diagonal().powi(2);
    if (SMALL..=DIVERGED).contains(&growth) {
        return Ok((mesh.clone(), String::new()));
    }
    let title = match growth > 1.0 {
        _ if is_line => " (a line)".into(),
        true => format!(" (1 : {})", short(growth)),
        false => format!(" (×{})", short((1.0 / growth).round())),
    };
    Ok((fitted(mesh, input)?, title))
}

/// The mesh scaled about its mean to the size of another, so that both fit in one picture.
fn fitted(mesh: &TriMesh, like: &TriMesh) -> Result<TriMesh> {
    let mean = |m: &TriMesh| {
        let n = m.vertex_count() as f64;
        scale(m.positions().iter().fold([0.0; 3], |s, &p| add(s, p)), 1.0 / n)
    };
    let factor = like.diagonal() / mesh.diagonal();
    let (from, to) = (mean(mesh), mean(like));
    let moved = mesh.positions().iter().map(|&p| add(to, scale(sub(p, from), factor)));
    Ok(mesh.with_positions(moved.collect())?)
}

#[cfg(test)]
mod tests {
    use fairing_shapes as shapes;

    use super::*;

    /// Towards a corner of the unit square.
    fn scaled(mesh: &TriMesh, factor: f64) -> TriMesh {
        let moved = mesh.positions().iter().map(|p| p.map(|x| factor * x));
        mesh.with_positions(moved.collect()).unwrap()
    }

    /// Inside its own plane a patch can shrink without a trace in its normals or in the distance of its vertices
    /// from the truth. What it leaves behind is found by the distance back.
    #[test]
    fn the_surface_error_sees_a_patch_shrink() {
        let patch = shapes::plane(16, 16, shapes::Diagonals::Alternating);
        let model = Model::new("patch", patch.clone(), patch.clone()).unwrap();
        let m = model.measure(&scaled(&patch, 0.5)).unwrap();
        assert!(m.normal.unwrap() < 1e-9 && m.vertex < 1e-9, "{m:?}");
        // Half of the diagonal at the far corner, 0 in a quarter of the square.
        assert!(m.surface * model.h() > 0.1, "{m:?}");
        assert!(model.measure(&patch).unwrap().surface < 1e-9);
    }

    /// The normals of a point are those of its rounding.
    #[test]
    fn a_point_has_no_normals() {
        let cube = shapes::icosphere(1);
        let model = Model::new("ball", cube.clone(), cube.clone()).unwrap();
        let m = model.measure(&scaled(&cube, 1e-12)).unwrap();
        assert_eq!((m.normal, m.recall), (None, None));
        assert!(model.measure(&scaled(&cube, 1e-3)).unwrap().normal.is_some());
    }

    /// Of a sweep whose error falls to a plateau, the first λ on it.
    #[test]
    fn the_best_lambda_is_the_first_of_equal_ones() {
        let mut sweep = Table::new("s", "S.", &SWEPT);
        for (lambda, error) in [(0.1, 2.0), (1.0, 1.0), (10.0, 1.0 - f64::EPSILON)] {
            sweep.push(row!["patch", lambda, 0.0, 0.0, error, 0.0, 0.0]);
        }
        assert_eq!(best_lambda(&sweep, "patch", "surface error").unwrap(), 1.0);
    }
}
