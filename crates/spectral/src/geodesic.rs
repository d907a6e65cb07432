//! Geodesic distance by the heat method.

use std::ops::ControlFlow;

use fairing_mesh::TriMesh;
use fairing_mesh::vec3::distance;
use fairing_operators::cotan_stiffness;
use fairing_operators::intrinsic::{IntrinsicFaces, RobustOptions, robust_laplacian};
use fairing_sparse::{Cholesky, Mass, Ordering, SparseMatrix, SymbolicCholesky, combine};

use crate::compute::SurfaceOperator;
use crate::diffusion::{check_time, solvable_mass};
use crate::error::SpectralError;
use crate::flat_face::FlatFace;

/// The heat method, ready for any sources: heat diffuses for a short time, its gradient is normalised, and the
/// function that best has this gradient is the distance.
///
/// Smooth approximation of the geodesic distance, in mesh units: never negative and zero at the source, with
/// several of them at the least one (at the others some tenths of an edge length); too large by the order of an
/// edge length near them, of first order in h elsewhere; never exact. Natural boundaries. Source: \[crane2013\].
#[derive(Debug)]
pub struct HeatGeodesics {
    operator: SurfaceOperator,
    heat: Cholesky,
    poisson: Cholesky,
    corners: Vec<u32>,
    flat: Vec<FlatFace>,
    components: usize,
    /// The component of each vertex.
    component: Vec<u32>,
    used: Vec<bool>,
}

/// S + D in place of the singular S: D is the mass of a vertex as a share of that of its component, times this
/// share of the mean diagonal of S there, divided by the vertices: the smallest eigenvalue there may be on a compact
/// surface, and a millionth of that.
const REGULARISATION: f64 = 1e-6;
/// Heat at the sources, 2⁹⁰⁰: it falls by a factor of about 2.6 in each edge length, and reaches twice as far as
/// heat of 1 before it underflows.
const HEAT: i32 = 900;
/// Weights above zero by more than this share of the diagonal are not Delaunay.
const DELAUNAY: f64 = 1e-10;

impl HeatGeodesics {
    /// Factorises for the time t = h², h the mean edge length of each component: the choice of the source.
    ///
    /// Takes the cotangent operator where the mesh is Delaunay, that is, where no weight of an edge is negative: heat
    /// is positive and falls with the distance then. Else it takes the robust operator, whose
    /// intrinsic triangulation is Delaunay on any mesh; slivers, which cost the other one several times the
    /// error and more, do no harm there. [`HeatGeodesics::operator`] tells.
    ///
    /// # Errors
    ///
    /// What assembling and factorising report.
    pub fn new(mesh: &TriMesh) -> Result<Self, SpectralError> {
        Self::with_operator(mesh, None, None)
    }

    /// Factorises for a time in squared mesh units, the same on all components: longer times smooth the distance
    /// more.
    ///
    /// # Errors
    ///
    /// [`SpectralError::Parameter`] for a negative time; what assembling and factorising report.
    pub fn with_time(mesh: &TriMesh, time: f64) -> Result<Self, SpectralError> {
        Self::with_operator(mesh, None, Some(time))
    }

    /// Factorises with the given operator and time, or the defaults of [`HeatGeodesics::new`] for `None`.
    ///
    /// # Errors
    ///
    /// As [`HeatGeodesics::with_time`]; the cotangent operator refuses faces without area.
    pub fn with_operator(
        mesh: &TriMesh,
        operator: Option<SurfaceOperator>,
        time: Option<f64>,
    ) -> Result<Self, SpectralError> {
        if let Some(time) = time {
            check_time(time)?;
        }
        let plain = match operator {
            Some(SurfaceOperator::Robust) => None,
            Some(SurfaceOperator::Cotangent) => Some(cotan_stiffness(mesh)?),
            None => cotan_stiffness(mesh).ok().filter(is_delaunay),
        };
        let (operator, stiffness, mass, faces) = match plain {
            Some(stiffness) => {
                let faces = extrinsic(mesh);
                (SurfaceOperator::Cotangent, stiffness, solvable_mass(mesh)?, faces)
            }
            None => {
                let robust = robust_laplacian(mesh, RobustOptions::default())?;
                let mass = with_isolated(robust.mass);
                (SurfaceOperator::Robust, robust.stiffness, mass, robust.faces)
            }
        };
        let (components, component) = components(mesh);
        let times = match time {
            Some(time) => vec![time; components],
            None => mean_squares(mesh, components, &component),
        };
        let (heat, poisson) = factor_pair(&stiffness, &mass, &times, &component)?;
        let mut used = vec![false; mesh.vertex_count()];
        for &v in mesh.faces().as_flattened() {
            used[v as usize] = true;
        }
        let flat = faces
            .lengths
            .as_chunks::<3>()
            .0
            .iter()
            .map(|sides| FlatFace::new(*sides, faces.share))
            .collect();
        let corners = faces.corners;
        Ok(Self { operator, heat, poisson, corners, flat, components, component, used })
    }

    /// The operator it was made with.
    pub fn operator(&self) -> SurfaceOperator {
        self.operator
    }

    /// The distance of every vertex to the nearest source; `None` on components without a source.
    ///
    /// # Errors
    ///
    /// [`SpectralError::NoSuchVertex`]; [`SpectralError::Parameter`] without a source;
    /// [`SpectralError::NoHeat`] for a vertex so far from the sources that no heat arrives in the time: more than
    /// some 1300 edges with that of [`HeatGeodesics::new`].
    pub fn distance(&self, sources: &[u32]) -> Result<Vec<Option<f64>>, SpectralError> {
        let n = self.component.len();
        if sources.is_empty() {
            let (name, value) = ("number of sources", 0.0);
            return Err(SpectralError::Parameter { name, value, must: "at least 1" });
        }
        let mut heat = vec![0.0; n];
        let mut reached = vec![false; self.components];
        for &vertex in sources {
            let at = heat.get_mut(vertex as usize);
            *at.ok_or(SpectralError::NoSuchVertex { vertex, vertices: n })? = 2f64.powi(HEAT);
            reached[self.component[vertex as usize] as usize] = true;
        }
        let is_reached = |v: usize| reached[self.component[v] as usize];
        self.heat.solve_in_place(&mut heat);
        let cold =
            |v: &usize| self.used[*v] && is_reached(*v) && heat[*v].abs() < f64::MIN_POSITIVE;
        if let Some(vertex) = (0..n).find(cold) {
            return Err(SpectralError::NoHeat { vertex: vertex as u32 });
        }
        // S φ = −div X, for X = −∇u / |∇u|.
        let mut phi = vec![0.0; n];
        for (corners, flat) in self.corners.as_chunks::<3>().0.iter().zip(&self.flat) {
            let corners = corners.map(|v| v as usize);
            if is_reached(corners[0]) {
                let flux = flat.unit_flux(corners.map(|v| heat[v]));
                for (v, flux) in corners.into_iter().zip(flux) {
                    phi[v] += flux;
                }
            }
        }
        self.poisson.solve_in_place(&mut phi);
        let mut least = vec![f64::INFINITY; self.components];
        for (phi, &c) in phi.iter().zip(&self.component) {
            least[c as usize] = least[c as usize].min(*phi);
        }
        let distance = |(v, phi): (usize, &f64)| {
            is_reached(v).then(|| phi - least[self.component[v] as usize])
        };
        Ok(phi.iter().enumerate().map(distance).collect())
    }
}

/// Whether no weight of an edge is negative.
fn is_delaunay(stiffness: &SparseMatrix) -> bool {
    let rows = stiffness.outer_iterator().enumerate();
    let bad = rows.into_iter().try_for_each(|(i, row)| {
        let limit = DELAUNAY * row.get(i).copied().unwrap_or(0.0).abs();
        let bad = row.iter().any(|(j, &s)| j != i && s > limit);
        if bad { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    });
    bad.is_continue()
}

/// The faces as they are in space.
fn extrinsic(mesh: &TriMesh) -> IntrinsicFaces {
    let p = mesh.positions();
    let side = |a: u32, b: u32| distance(p[a as usize], p[b as usize]);
    let sides = |&[a, b, c]: &[u32; 3]| [side(a, b), side(b, c), side(c, a)];
    IntrinsicFaces {
        corners: mesh.faces().as_flattened().to_vec(),
        lengths: mesh.faces().iter().flat_map(sides).collect(),
        share: 1.0,
    }
}

/// Vertices without mass have no faces: any positive number keeps them apart from everything else.
fn with_isolated(mut mass: Vec<f64>) -> Vec<f64> {
    let mean = mass.iter().sum::<f64>() / mass.len().max(1) as f64;
    for mass in &mut mass {
        if *mass == 0.0 {
            *mass = if mean > 0.0 { mean } else { 1.0 };
        }
    }
    mass
}

/// M + tS, t that of the component, and the regular S: they share their pattern, and one analysis serves both.
fn factor_pair(
    stiffness: &SparseMatrix,
    mass: &[f64],
    times: &[f64],
    component: &[u32],
) -> Result<(Cholesky, Cholesky), SpectralError> {
    let mut timed = stiffness.clone();
    let mut sums = vec![(0.0, 0.0, 0.0); times.len()];
    for (i, mut row) in timed.outer_iterator_mut().enumerate() {
        let c = component[i] as usize;
        let (trace, total, count) = &mut sums[c];
        *trace += row.get(i).copied().unwrap_or(0.0);
        *total += mass[i];
        *count += 1.0;
        for (_, value) in row.iter_mut() {
            *value *= times[c];
        }
    }
    let heat = combine(1.0, Mass::Lumped(mass), 1.0, &timed);
    let symbolic = SymbolicCholesky::new(&heat, Ordering::default())?;
    let heat = symbolic.factorize(&heat)?;
    let regular: Vec<f64> = mass
        .iter()
        .zip(component)
        .map(|(m, &c)| {
            let (trace, total, count) = sums[c as usize];
            // A vertex of its own has no trace.
            let mean = if trace > 0.0 { trace / count } else { 1.0 };
            REGULARISATION * mean * (m / total)
        })
        .collect();
    let poisson = combine(1.0, Mass::Lumped(&regular), 1.0, stiffness);
    Ok((heat, symbolic.factorize(&poisson)?))
}

/// The square of the mean length of the sides of the faces of each component.
fn mean_squares(mesh: &TriMesh, components: usize, component: &[u32]) -> Vec<f64> {
    let mut sums = vec![(0.0, 0.0); components];
    let p = mesh.positions();
    for face in mesh.faces() {
        let (sum, count) = &mut sums[component[face[0] as usize] as usize];
        for k in 0..3 {
            *sum += distance(p[face[k] as usize], p[face[(k + 1) % 3] as usize]);
            *count += 1.0;
        }
    }
    sums.iter().map(|(sum, count): &(f64, f64)| (sum / count.max(1.0)).powi(2)).collect()
}

/// How many components there are and which one each vertex is in; every vertex without faces is one of its own.
fn components(mesh: &TriMesh) -> (usize, Vec<u32>) {
    let components = mesh.topology().components();
    let mut count = components.count();
    let of_vertex = |v| {
        components.of_vertex(v).unwrap_or_else(|| {
            count += 1;
            count as u32 - 1
        })
    };
    let numbers = (0..mesh.vertex_count() as u32).map(of_vertex).collect();
    (count, numbers)
}
