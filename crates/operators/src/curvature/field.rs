//! The result of every estimator, and principal curvatures from mean and Gaussian curvature.

use fairing_mesh::TriMesh;
use fairing_watch::parallel;
use glam::DVec3;

use super::status::{Undefined, VertexStatus};
use crate::fan::Fan;
use crate::tangent::Symmetric2;

/// Pointwise curvature at each vertex, in vertex order.
///
/// All values are zero where the status is undefined; no value is NaN.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct CurvatureField {
    /// κ₁ ≥ κ₂, in 1 / mesh units, positive on a sphere.
    pub kappa1: Vec<f64>,
    /// The smaller principal curvature.
    pub kappa2: Vec<f64>,
    /// H, in 1 / mesh units: (κ₁ + κ₂)/2, or the estimator's own measure.
    pub mean: Vec<f64>,
    /// K, in 1 / squared mesh units: κ₁ κ₂, or the estimator's own measure.
    pub gaussian: Vec<f64>,
    /// Unit tangents of κ₁ and κ₂; arbitrary at an umbilic. `None` if the estimator provides no
    /// directions.
    pub directions: Option<[Vec<[f64; 3]>; 2]>,
    /// The status of each vertex: defined, or the reason why it is not.
    pub status: Vec<VertexStatus>,
    /// True for vertices on the boundary, where values are one-sided.
    pub boundary: Vec<bool>,
    /// The first face too thin for the plain operator, where the estimator used
    /// the intrinsic one instead ([`cotangent_curvature`]); else `None`.
    ///
    /// [`cotangent_curvature`]: super::cotangent_curvature
    pub too_thin: Option<u32>,
    /// The vertices whose neighbourhood turns by more than 60°, so that a fit took fewer rings or a
    /// lower degree there; zero for estimators that fit no polynomial.
    pub narrowed: usize,
    /// Standard errors and scales, from the estimator that provides them ([`adaptive_curvature`]).
    ///
    /// [`adaptive_curvature`]: super::adaptive_curvature
    pub accuracy: Option<Accuracy>,
}

/// The trust in curvature at each vertex, in vertex order; zero where undefined.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Accuracy {
    /// The standard error of H, in 1 / mesh units.
    pub mean_error: Vec<f64>,
    /// The standard error of K, in 1 / squared mesh units.
    pub gaussian_error: Vec<f64>,
    /// The radius of the neighbourhood with the largest weight in H, in mesh units.
    pub scale: Vec<f64>,
    /// The standard deviation of the noise along the normal, in mesh units: one number for each
    /// connected component.
    pub noise: Vec<f64>,
    /// The unit normals of the fits, smoother than those of one ring.
    pub normals: Vec<[f64; 3]>,
}

/// The curvature at a vertex.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct AtVertex {
    pub(crate) values: [f64; 2],
    pub(crate) mean: f64,
    pub(crate) gaussian: f64,
    pub(crate) directions: [[f64; 3]; 2],
}

impl AtVertex {
    /// The eigenvalues and eigenvectors of the second form in a frame.
    pub(crate) fn from_form(form: Symmetric2, frame: [DVec3; 2], normal: DVec3) -> Self {
        let (values, [x, y]) = form.eigen();
        let first = x * frame[0] + y * frame[1];
        Self::new(values, [first, normal.cross(first)])
    }

    pub(crate) fn new(values: [f64; 2], directions: [DVec3; 2]) -> Self {
        let [a, b] = values;
        Self {
            values,
            mean: 0.5 * (a + b),
            gaussian: a * b,
            directions: directions.map(Into::into),
        }
    }

    /// H and K without directions, and the principal values that follow.
    pub(crate) fn from_mean_and_gaussian(mean: f64, gaussian: f64) -> Self {
        let (values, _) = principal_values(mean, gaussian);
        Self { values, mean, gaussian, directions: [[0.0; 3]; 2] }
    }

    fn is_finite(&self) -> bool {
        let numbers = [self.values[0], self.values[1], self.mean, self.gaussian];
        numbers.iter().chain(self.directions.as_flattened()).all(|x| x.is_finite())
    }
}

/// Progress is reported after this many vertices.
const REPORT: u32 = 256;

/// The values of a vertex, whether they are defined, and whether the vertex is on the boundary.
type Settled = (AtVertex, VertexStatus, bool);

fn settled(at: Result<AtVertex, Undefined>, boundary: bool) -> Settled {
    match at {
        Ok(at) if at.is_finite() => (at, VertexStatus::Defined, boundary),
        Ok(_) => (NOTHING, VertexStatus::Undefined(Undefined::IllConditioned), boundary),
        Err(reason) => (NOTHING, VertexStatus::Undefined(reason), boundary),
    }
}

impl CurvatureField {
    /// The number of vertices.
    pub fn len(&self) -> usize {
        self.status.len()
    }

    /// Returns true if there are no vertices.
    pub fn is_empty(&self) -> bool {
        self.status.is_empty()
    }

    /// Returns true if vertex `v` is defined and not on the boundary, so that its
    /// values are not one-sided: the vertices for colour ranges and statistics.
    ///
    /// # Panics
    ///
    /// If there is no vertex `v`.
    pub fn is_interior(&self, v: u32) -> bool {
        self.status[v as usize].is_defined() && !self.boundary[v as usize]
    }

    /// True at each vertex without a value, where the zero means nothing: the flags for colours.
    pub fn undefined(&self) -> Vec<bool> {
        self.status.iter().map(|status| !status.is_defined()).collect()
    }

    /// The shape index `s = 2/π arctan((κ₁ + κ₂) / (κ₁ − κ₂))` of each vertex:
    /// 1 for a cap, ½ for a ridge, 0 for a saddle, −½ for a rut, −1 for a cup.
    /// `None` where undefined or flat (κ₁ = κ₂ = 0). Source: [koenderink1992].
    ///
    /// [koenderink1992]: https://doi.org/10.1016/0262-8856(92)90076-F
    pub fn shape_index(&self) -> Vec<Option<f64>> {
        (0..self.len())
            .map(|v| {
                let (a, b) = (self.kappa1[v], self.kappa2[v]);
                let bent = self.status[v].is_defined() && (a != 0.0 || b != 0.0);
                bent.then(|| libm::atan2(a + b, a - b) * std::f64::consts::FRAC_2_PI)
            })
            .collect()
    }

    /// The curvedness `√((κ₁² + κ₂²) / 2)` of each vertex, in 1 / mesh units;
    /// zero where undefined. Source: [koenderink1992].
    ///
    /// [koenderink1992]: https://doi.org/10.1016/0262-8856(92)90076-F
    pub fn curvedness(&self) -> Vec<f64> {
        self.kappa1
            .iter()
            .zip(&self.kappa2)
            .map(|(a, b)| libm::hypot(*a, *b) / 2f64.sqrt())
            .collect()
    }

    /// Each vertex by itself, in parallel. `W` is memory that vertices share.
    pub(crate) fn at_each_vertex<W: Default>(
        mesh: &TriMesh,
        at_vertex: impl Fn(&mut W, u32) -> Result<AtVertex, Undefined> + Sync,
    ) -> Self {
        let topology = mesh.topology();
        let watch = fairing_watch::current();
        watch.stage("vertices", mesh.vertex_count() as u64);
        let found = parallel::map_with(mesh.vertex_count(), 1024, W::default, |work, v| {
            let v = v as u32;
            if v.is_multiple_of(REPORT) {
                watch.advance(REPORT.into());
            }
            watch.check();
            settled(at_vertex(work, v), topology.is_boundary_vertex(v))
        });
        Self::split(found, true)
    }

    /// The values and boundary flags of all vertices. Values that are not
    /// finite are [`Undefined::IllConditioned`].
    pub(crate) fn collect(
        found: Vec<(Result<AtVertex, Undefined>, bool)>,
        with_directions: bool,
    ) -> Self {
        Self::split(found.into_iter().map(|(at, b)| settled(at, b)).collect(), with_directions)
    }

    fn split(found: Vec<Settled>, with_directions: bool) -> Self {
        let number =
            |of: fn(&AtVertex) -> f64| parallel::map(found.len(), 4096, |i| of(&found[i].0));
        let direction = |k: usize| parallel::map(found.len(), 4096, |i| found[i].0.directions[k]);
        Self {
            kappa1: number(|at| at.values[0]),
            kappa2: number(|at| at.values[1]),
            mean: number(|at| at.mean),
            gaussian: number(|at| at.gaussian),
            directions: with_directions.then(|| [direction(0), direction(1)]),
            status: found.iter().map(|(_, status, _)| *status).collect(),
            boundary: found.iter().map(|(.., boundary)| *boundary).collect(),
            too_thin: None,
            narrowed: 0,
            accuracy: None,
        }
    }
}

const NOTHING: AtVertex =
    AtVertex { values: [0.0; 2], mean: 0.0, gaussian: 0.0, directions: [[0.0; 3]; 2] };

/// Flags of the boundary vertices, from the incidence alone.
pub(crate) fn boundary_flags(mesh: &TriMesh) -> Vec<bool> {
    let incidence = mesh.incidence();
    let on_boundary = |fan: &mut Fan, v: u32| {
        fan.gather(incidence.sides(v).iter().copied());
        fan.has_boundary_edge()
    };
    let at = |fan: &mut Fan, v: usize| on_boundary(fan, v as u32);
    parallel::map_with(mesh.vertex_count(), 4096, Fan::default, at)
}

/// κ₁ ≥ κ₂ with κ₁ + κ₂ = 2H and κ₁ κ₂ = K.
///
/// ```text
/// κ = H ± √(H² − K)
/// ```
///
/// On a smooth surface H² ≥ K. Separate estimates of H and K may violate this; then both values are
/// H, as at an umbilic, so that their mean is still H and only K changes. The second value returned
/// is this change, `K − H² > 0`, and zero otherwise. Finite for finite input.
pub fn principal_values(mean: f64, gaussian: f64) -> ([f64; 2], f64) {
    let discriminant = mean * mean - gaussian;
    if discriminant >= 0.0 {
        let root = discriminant.sqrt();
        return ([mean + root, mean - root], 0.0);
    }
    ([mean, mean], if discriminant.is_finite() { -discriminant } else { 0.0 })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shape_index_of_the_five_shapes() {
        let pairs = [[2.0, 2.0], [2.0, 0.0], [2.0, -2.0], [0.0, -2.0], [-2.0, -2.0], [0.0, 0.0]];
        let found =
            pairs.iter().map(|&k| (Ok(AtVertex::new(k, [DVec3::ZERO; 2])), false)).collect();
        let field = CurvatureField::collect(found, false);
        let index = field.shape_index();
        for (found, expected) in index.iter().zip([1.0, 0.5, 0.0, -0.5, -1.0]) {
            assert!((found.unwrap() - expected).abs() < 1e-15);
        }
        assert_eq!(index[5], None);
        assert!((field.curvedness()[2] - 2.0).abs() < 1e-15);
    }

    #[test]
    fn what_is_not_finite_is_undefined() {
        let bad = AtVertex::new([f64::INFINITY, 0.0], [DVec3::ZERO; 2]);
        let field = CurvatureField::collect(vec![(Ok(bad), false)], true);
        assert_eq!(field.status[0], VertexStatus::Undefined(Undefined::IllConditioned));
        assert_eq!((field.kappa1[0], field.mean[0]), (0.0, 0.0));
    }

    #[test]
    fn both_values_come_back() {
        assert_eq!(principal_values(0.5, -2.0), ([2.0, -1.0], 0.0));
        assert_eq!(principal_values(-1.5, 2.0), ([-1.0, -2.0], 0.0));
    }

    #[test]
    fn an_impossible_pair_is_umbilic_and_says_so() {
        assert_eq!(principal_values(1.0, 1.25), ([1.0, 1.0], 0.25));
    }
}
