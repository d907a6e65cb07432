//! Noisy meshes with a ground truth for questions 5 and 6, and scores of flows.

use anyhow::{Context as _, Result};
use fairing_evaluation::{SurfaceTree, drift, feature_edges, normal_error, vertex_displacement};
use fairing_mesh::TriMesh;
use fairing_smoothing::{
    Diffusion, Explicit, FlowError, Implicit, Smoothed, Stability, explicit, implicit,
};
use glam::DVec3;

use crate::experiment::Context;
use crate::experiment::inputs::Input;
use crate::model::table::{Cell, Unit};

/// Below this share hardly a digit of the shape is left.
pub(super) const POINT: f64 = 1e-9;

/// Beyond this growth of the diagonal a mesh has diverged: its errors are numbers of its roughest
/// mode, which tables do not show.
pub(super) const DIVERGED: f64 = 2.0;

/// A cell of a table for a number of a mesh, which has none if it has diverged.
pub(super) fn unless_diverged(growth: f64, number: impl Into<Cell>) -> Cell {
    if growth > DIVERGED { "diverged".into() } else { number.into() }
}

/// Edges that turn by at least this many degrees are features.
pub(super) const FEATURE: f64 = 30.0;

/// A mesh to smooth, and the truth.
pub(super) struct Model {
    pub(super) name: &'static str,
    pub(super) noisy: TriMesh,
    pub(super) truth: TriMesh,
    /// The surface of the truth.
    surface: SurfaceTree,
    /// True if its pictures have occlusion.
    pub(super) occlusion: bool,
}

/// Distances between surfaces are measured at about this many vertices of each at most, every
/// mth: the mean of n independent distances is known to about 1/√n, here 2 %, and comparisons over
/// λ use the same vertices.
pub(super) const SAMPLES: usize = 2000;

/// Every mth vertex, from as many as there are to half of [`SAMPLES`] at least.
fn sampled(mesh: &TriMesh) -> Vec<[f64; 3]> {
    let step = mesh.vertex_count().div_ceil(SAMPLES).max(1);
    mesh.positions().iter().copied().step_by(step).collect()
}

/// The mean distance of points from a surface.
fn mean_distance(points: &[[f64; 3]], surface: &SurfaceTree) -> f64 {
    surface.distances(points).iter().sum::<f64>() / points.len() as f64
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

    /// Compares `mesh` with the truth and with the input.
    pub(super) fn measure(&self, mesh: &TriMesh) -> Result<Measures> {
        let change = drift(mesh, &self.truth);
        let moved = vertex_displacement(mesh, &self.noisy)?;
        let boundary = mesh.topology().boundary_vertices();
        let part = |border: bool| {
            let squares: Vec<f64> = (0..mesh.vertex_count())
                .filter(|&v| boundary[v] == border)
                .map(|v| {
                    let [p, q] = [mesh, &self.noisy].map(|m| DVec3::from(m.positions()[v]));
                    p.distance_squared(q)
                })
                .collect();
            let n = squares.len() as f64;
            (n > 0.0).then(|| (squares.iter().sum::<f64>() / n).sqrt() / self.h())
        };
        let growth = mesh.diagonal() / self.noisy.diagonal();
        // A mesh that has collapsed to a point has no normals but those of rounding, and where the
        // truth has no creases none can be kept.
        let is_shape = growth > POINT;
        let forward = mean_distance(&sampled(mesh), &self.surface) / self.h();
        let backward = mean_distance(&sampled(&self.truth), &SurfaceTree::new(mesh)?) / self.h();
        let features = feature_edges(mesh, &self.truth, FEATURE)?;
        let creases = [features.f_score(), features.precision(), features.recall()];
        Ok(Measures {
            normal: normal_error(mesh, &self.truth).ok().filter(|_| is_shape).map(|e| e.mean),
            vertex: forward,
            surface: (forward + backward) / 2.0,
            volume: change.volume.map(|v| 100.0 * v),
            area: change.area.map(|a| 100.0 * a),
            creases: creases.map(|share| share.filter(|_| is_shape && features.expected > 0)),
            rms: moved.rms / self.h(),
            largest: moved.max / self.h(),
            inside: part(false),
            border: part(true),
            growth,
        })
    }
}

/// The end of a flow.
#[derive(Debug, Clone, Copy)]
pub(super) struct Measures {
    /// Mean angle between normals of faces and of the truth, in degrees.
    pub(super) normal: Option<f64>,
    /// Mean distance of the vertices from the surface of the truth, in h.
    pub(super) vertex: f64,
    /// Mean distance between the surfaces both ways, from the vertices of each to the other, in h:
    /// a mesh that has shrunk inside the truth leaves vertices of the truth far away.
    pub(super) surface: f64,
    /// Change of volume relative to the truth in percent; `None` if open.
    pub(super) volume: Option<f64>,
    /// Change of area relative to the truth in percent.
    pub(super) area: Option<f64>,
    /// F-score, precision and recall of the creases; `None` if the truth has none.
    pub(super) creases: [Option<f64>; 3],
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

/// The column of the F-score of the creases.
pub(super) const CREASES: &str = "creases, F-score";

/// The columns that [`Measures::cells`] fills.
pub(super) const COLUMNS: [(&str, Unit); 13] = [
    ("normal error", Unit::Degrees),
    ("vertex error", Unit::EdgeLengths),
    ("surface error", Unit::EdgeLengths),
    ("volume", Unit::Percent),
    ("area", Unit::Percent),
    (CREASES, Unit::One),
    ("crease precision", Unit::One),
    ("crease recall", Unit::One),
    ("displacement", Unit::EdgeLengths),
    ("largest displacement", Unit::EdgeLengths),
    ("displacement inside", Unit::EdgeLengths),
    ("displacement of the border", Unit::EdgeLengths),
    ("growth", Unit::One),
];

impl Measures {
    pub(super) fn cells(&self) -> [Cell; 13] {
        let [f_score, precision, recall] = self.creases;
        let mut cells: [Cell; 13] = [
            self.normal.into(),
            self.vertex.into(),
            self.surface.into(),
            self.volume.into(),
            self.area.into(),
            f_score.into(),
            precision.into(),
            recall.into(),
            self.rms.into(),
            self.largest.into(),
            self.inside.into(),
            self.border.into(),
            self.growth.into(),
        ];
        for cell in &mut cells[..12] {
            *cell = unless_diverged(self.growth, cell.clone());
        }
        cells
    }
}

/// Lower-case words joined by hyphens.
pub(super) fn slug(text: &str) -> String {
    text.replace([' ', '.'], "-")
}

/// The mesh with every vertex on its plane of least squared distances.
fn flattened(mesh: &TriMesh) -> Result<TriMesh> {
    let x: Vec<DVec3> = mesh.positions().iter().map(|&p| p.into()).collect();
    let centre = x.iter().sum::<DVec3>() * (1.0 / x.len() as f64);
    let vectors = (0..mesh.face_count()).map(|f| DVec3::from(mesh.area_vector(f)));
    let mut normal =
        vectors.sum::<DVec3>().try_normalize().context("the patch has no mean normal")?;
    // The height over the plane is fitted by au + bv; the best plane is where a = b = 0.
    for _ in 0..20 {
        let axis = if normal.x.abs() < 0.6 { DVec3::X } else { DVec3::Y };
        let e1 = normal.cross(axis).try_normalize().context("a normal without length")?;
        let e2 = normal.cross(e1);
        let mut s = [0.0; 5];
        for &p in &x {
            let d = p - centre;
            let (u, v, w) = (d.dot(e1), d.dot(e2), d.dot(normal));
            for (s, term) in s.iter_mut().zip([u * u, u * v, v * v, u * w, v * w]) {
                *s += term;
            }
        }
        let determinant = s[0] * s[2] - s[1] * s[1];
        let a = (s[3] * s[2] - s[4] * s[1]) / determinant;
        let b = (s[4] * s[0] - s[3] * s[1]) / determinant;
        let tilted = normal - (a * e1 + b * e2);
        normal = tilted.try_normalize().context("the patch is a line")?;
    }
    let flat = x.iter().map(|&p| (p - (p - centre).dot(normal) * normal).to_array());
    Ok(mesh.with_positions(flat.collect())?)
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

    /// Inside its own plane a patch can shrink without a trace in its normals or in the distance of
    /// its vertices from the truth. What it leaves behind is found by the distance back.
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
        assert_eq!((m.normal, m.creases), (None, [None; 3]));
        assert!(model.measure(&scaled(&cube, 1e-3)).unwrap().normal.is_some());
    }
}
