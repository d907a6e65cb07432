//! Geodesic distance by the heat method.

use fairing_mesh::TriMesh;
use fairing_operators::{Intrinsic, Laplacian, LaplacianKind, MassKind};
use fairing_parameters::{ParameterError, Range};
use fairing_sparse::{
    Cholesky, GraphSystem, Mass, Ordering, SparseMatrix, SymbolicCholesky, combine,
};
use glam::DVec3;

use crate::error::SpectralError;
use crate::poisson::FlatFace;
use crate::surface_point::SurfacePoint;

/// Factorised heat method for any sources: heat diffuses for a short time, its gradient is
/// normalised, and the distance is the function whose gradient is closest to the result.
///
/// Smooth approximation of the geodesic distance, in mesh units: never negative, and exactly zero
/// at every source. The solution is determined up to a constant on each component, chosen so that
/// its mean over the sources there is zero; at single sources it differs from zero by some tenths
/// of an edge length. The error is about an edge length near sources, where distances are too
/// large, and of first order in h elsewhere. Natural boundaries. Source: [crane2013].
///
/// [crane2013]: https://doi.org/10.1145/2516971.2516977
#[doc(alias("compute_geodesic_f", "heat_geodesic", "heat_method", "HeatMethodDistanceSolver"))]
#[derive(Debug)]
pub struct HeatGeodesics {
    kind: LaplacianKind,
    heat: Cholesky,
    /// The time of each component, in the unit of the masses.
    times: Vec<f64>,
    poisson: GraphSystem,
    corners: Vec<u32>,
    flat: Vec<FlatFace>,
    components: usize,
    /// The component of each vertex.
    component: Vec<u32>,
    used: Vec<bool>,
}

/// The binary exponent of the heat at the sources: it falls by a factor of about 2.6 per edge
/// length, and reaches twice as far as heat 1 before it underflows.
const HEAT: i32 = 900;

/// The binary exponent of the heat below which it is computed again from the vertices above: well
/// within the range in which it has all its digits.
const FAINT: i32 = -600;

/// The binary exponent by which heat computed again is larger, so that it reaches as far again.
const AGAIN: i32 = 1300;

/// Heat over more than the range of floats: the values times 2 to the power `−AGAIN · stage`.
struct Heat {
    values: Vec<f64>,
    stages: Vec<i32>,
}

impl Heat {
    /// The heat at a vertex in the unit of another stage.
    fn at(&self, v: usize, stage: i32) -> f64 {
        let half = 2f64.powi((stage - self.stages[v]) * AGAIN / 2);
        self.values[v] * half * half
    }

    fn is_below(&self, v: usize, bound: f64) -> bool {
        self.values[v].abs() < bound
    }
}

impl HeatGeodesics {
    /// Factorises with [`LaplacianKind::NonNegative`] for the time t = h², h the mean edge length
    /// of each component, as in the source.
    ///
    /// If no edge weight is negative, heat is positive and decreases with the distance. On other
    /// meshes the robust operator guarantees the same, since its intrinsic triangulation is
    /// Delaunay: slivers, on which the cotangent operator has several times the error, do no harm.
    /// [`HeatGeodesics::kind`] is the kind chosen.
    ///
    /// # Errors
    ///
    /// Errors of assembly and factorisation.
    ///
    /// # Examples
    ///
    /// ```
    /// use fairing_shapes as shapes;
    /// use fairing_spectral::HeatGeodesics;
    ///
    /// let sphere = shapes::icosphere(4);
    /// let distance = HeatGeodesics::new(&sphere)?.distance(&[0])?;
    /// let farthest = distance.iter().flatten().fold(0.0, |m: f64, d| m.max(*d));
    /// assert!((farthest - std::f64::consts::PI).abs() < 0.1);
    /// # Ok::<(), fairing_spectral::SpectralError>(())
    /// ```
    pub fn new(mesh: &TriMesh) -> Result<Self, SpectralError> {
        let laplacian = Laplacian::new(mesh, LaplacianKind::NonNegative, MassKind::Barycentric)?;
        Self::with(mesh, &laplacian, None)
    }

    /// Factorises with a cotangent or robust Laplacian of the mesh, for one time on all components
    /// in squared mesh units, or for the times of [`HeatGeodesics::new`] if `None`. Longer times
    /// smooth the distance more.
    ///
    /// # Errors
    ///
    /// [`SpectralError::Option`] for a negative time; [`SpectralError::Kind`] for another kind of
    /// Laplacian, whose gradients are not those of faces; [`SpectralError::Rows`] for the Laplacian
    /// of another mesh; a mass that is not positive; errors of the factorisation.
    pub fn with(
        mesh: &TriMesh,
        laplacian: &Laplacian,
        time: Option<f64>,
    ) -> Result<Self, SpectralError> {
        if let Some(time) = time {
            Range::NOT_NEGATIVE.check("time", time)?;
        }
        let (found, expected) = (laplacian.vertex_count(), mesh.vertex_count());
        if found != expected {
            return Err(SpectralError::Rows { found, expected });
        }
        let (corners, flat) = match (laplacian.kind(), laplacian.intrinsic()) {
            (_, Some(Intrinsic { faces, .. })) => {
                let sides = faces.lengths.as_chunks::<3>().0.iter();
                // They cover the surface twice.
                let flat = sides.map(|&sides| FlatFace::new(sides, 0.5)).collect();
                (faces.corners.clone(), flat)
            }
            (LaplacianKind::Cotangent, None) => {
                let flat = sides(mesh).map(|sides| FlatFace::new(sides, 1.0)).collect();
                (mesh.faces().as_flattened().to_vec(), flat)
            }
            (kind, None) => return Err(SpectralError::Kind { kind }),
        };
        let (components, component) = components(mesh);
        let mass = laplacian.positive_mass()?;
        // Masses and times in a unit that makes the mean mass about one, so that heat does not
        // overflow. A power of four is exact, even in square roots.
        let mean = mass.lumped().iter().sum::<f64>() / mesh.vertex_count().max(1) as f64;
        let unit = libm::exp2(2.0 * (0.5 * libm::log2(mean.max(f64::MIN_POSITIVE))).floor());
        let times = match time {
            Some(time) => vec![time / unit; components],
            None => {
                mean_squares(mesh, components, &component).map(|square| square / unit).collect()
            }
        };
        let mass: Vec<f64> = mass.lumped().iter().map(|m| m / unit).collect();
        let mut isolated = vec![false; mesh.vertex_count()];
        for &v in laplacian.isolated() {
            isolated[v as usize] = true;
        }
        // One analysis serves both systems, since they share their pattern.
        let stiffness = laplacian.stiffness();
        let heat = heat(stiffness, &mass, &times, &component)?;
        let none = vec![0.0; mass.len()];
        let like = heat.symbolic();
        let poisson = GraphSystem::new(stiffness, none, &mass, &isolated, Some(&like))?;
        let used = isolated.iter().map(|isolated| !isolated).collect();
        let kind = laplacian.kind();
        Ok(Self { kind, heat, times, poisson, corners, flat, components, component, used })
    }

    /// The kind of the Laplacian in use.
    pub fn kind(&self) -> LaplacianKind {
        self.kind
    }

    /// The distance of every vertex to the nearest source; `None` on components without a source.
    ///
    /// # Errors
    ///
    /// [`SpectralError::NoSuchVertex`]; [`SpectralError::Option`] without a source;
    /// [`SpectralError::NoHeat`] for a vertex at which no heat arrives because the given time is
    /// too short; [`SpectralError::Sparse`] if rounding leaves too few digits of the distances.
    #[doc(alias = "heat_geodesics_solve")]
    pub fn distance(&self, sources: &[u32]) -> Result<Vec<Option<f64>>, SpectralError> {
        let sources: Vec<SurfacePoint> = sources.iter().map(|&v| SurfacePoint::vertex(v)).collect();
        self.distance_from(&sources)
    }

    /// [`distance`](Self::distance) from points on faces: their heat starts at the corners in
    /// proportion to the barycentric coordinates, and the corners get their straight distances.
    ///
    /// # Errors
    ///
    /// As for [`distance`](Self::distance).
    ///
    /// # Examples
    ///
    /// ```
    /// use fairing_shapes::{self as shapes, Diagonals};
    /// use fairing_spectral::{HeatGeodesics, SurfacePoint};
    ///
    /// let plane = shapes::plane(40, 40, Diagonals::Alternating);
    /// let middle = SurfacePoint::on_face(&plane, 1500, [0.2, 0.3, 0.5])?;
    /// let distance = HeatGeodesics::new(&plane)?.distance_from(&[middle])?;
    /// assert!(distance.iter().all(|d| d.is_some_and(|d| d > 0.0)));
    /// # Ok::<(), fairing_spectral::SpectralError>(())
    /// ```
    pub fn distance_from(
        &self,
        sources: &[SurfacePoint],
    ) -> Result<Vec<Option<f64>>, SpectralError> {
        let n = self.component.len();
        if sources.is_empty() {
            return Err(ParameterError::range("number of sources", 0.0, "at least 1").into());
        }
        let mut heat = vec![0.0; n];
        let mut reached = vec![false; self.components];
        let mut sources = sources.to_vec();
        sources.sort_by(SurfacePoint::order);
        sources.dedup();
        for source in &sources {
            for (vertex, weight) in source.corners() {
                let at = heat.get_mut(vertex as usize);
                *at.ok_or(SpectralError::NoSuchVertex { vertex, vertices: n })? +=
                    weight * 2f64.powi(HEAT);
                reached[self.component[vertex as usize] as usize] = true;
            }
        }
        let is_reached = |v: usize| reached[self.component[v] as usize];
        let heat = self.diffused(heat, |v| self.used[v] && is_reached(v))?;
        // S φ = −div X, for X = −∇u / |∇u|.
        let mut phi = vec![0.0; n];
        for (corners, flat) in self.corners.as_chunks::<3>().0.iter().zip(&self.flat) {
            let corners = corners.map(|v| v as usize);
            if is_reached(corners[0]) {
                let first = corners.map(|v| heat.stages[v]).into_iter().fold(i32::MAX, i32::min);
                let flux = flat.unit_flux(corners.map(|v| heat.at(v, first)));
                for (v, flux) in corners.into_iter().zip(flux) {
                    phi[v] += flux;
                }
            }
        }
        let divergence = phi;
        let mut phi = vec![0.0; n];
        self.poisson.solve(|v| [divergence[v]], phi.as_chunks_mut().0)?;
        let mut at_sources = vec![(0.0, 0.0); self.components];
        for source in &sources {
            for (v, weight) in source.corners() {
                let (sum, count) = &mut at_sources[self.component[v as usize] as usize];
                *sum += weight * phi[v as usize];
                *count += weight;
            }
        }
        let distance = |(v, phi): (usize, &f64)| {
            let (sum, count) = at_sources[self.component[v] as usize];
            is_reached(v).then(|| (phi - sum / count).max(0.0))
        };
        let mut distances: Vec<Option<f64>> = phi.iter().enumerate().map(distance).collect();
        let mut around: Vec<(u32, f64)> =
            sources.iter().flat_map(SurfacePoint::corner_distances).collect();
        around.sort_by(|x, y| x.0.cmp(&y.0).then(x.1.total_cmp(&y.1)));
        around.dedup_by_key(|(v, _)| *v);
        for (v, straight) in around {
            distances[v as usize] = Some(straight);
        }
        Ok(distances)
    }
}

impl HeatGeodesics {
    /// The heat that arrives at the vertices from the given amounts.
    ///
    /// Where heat becomes faint it is computed again, larger by a power of two. With `A = M + tS`,
    /// the solution u of `A u = f`, and w equal to u at the warm vertices and zero at the faint
    /// ones, `A w − f` is zero but at the front between both, and `u = −A⁻¹ (A w − f)` at the faint
    /// ones: the front takes the place of the sources.
    fn diffused(
        &self,
        mut amounts: Vec<f64>,
        is_reached: impl Fn(usize) -> bool,
    ) -> Result<Heat, SpectralError> {
        let n = amounts.len();
        self.heat.solve_in_place(&mut amounts);
        let mut heat = Heat { values: amounts, stages: vec![0; n] };
        for stage in 1.. {
            let none = |v: &usize| is_reached(*v) && heat.is_below(*v, f64::MIN_POSITIVE);
            let Some(vertex) = (0..n).find(none) else { break };
            let faint = 2f64.powi(FAINT);
            let is_faint: Vec<bool> =
                (0..n).map(|v| is_reached(v) && heat.is_below(v, faint)).collect();
            let mut front: Vec<f64> = (0..n)
                .map(|i| {
                    let others = self.poisson.laplacian().stiffness_row(i);
                    let across = others.filter(|(j, _)| is_faint[*j as usize] != is_faint[i]);
                    let flow: f64 = across.map(|(j, s)| s * heat.at(j as usize, stage)).sum();
                    let sign = if is_faint[i] { -1.0 } else { 1.0 };
                    sign * self.times[self.component[i] as usize] * flow
                })
                .collect();
            self.heat.solve_in_place(&mut front);
            let mut gained = false;
            for v in (0..n).filter(|v| is_faint[*v]) {
                (heat.values[v], heat.stages[v]) = (front[v], stage);
                gained |= !heat.is_below(v, faint);
            }
            if !gained || front.iter().any(|heat| !heat.is_finite()) {
                return Err(SpectralError::NoHeat { vertex: vertex as u32 });
            }
        }
        Ok(heat)
    }
}

/// The side lengths of the faces in space, from corner k to corner k + 1.
fn sides(mesh: &TriMesh) -> impl Iterator<Item = [f64; 3]> + '_ {
    let p = mesh.positions();
    let side = |a: u32, b: u32| DVec3::from(p[a as usize]).distance(p[b as usize].into());
    mesh.faces().iter().map(move |&[a, b, c]| [side(a, b), side(b, c), side(c, a)])
}

/// The factorised system M + tS, with the time t of each component.
fn heat(
    stiffness: &SparseMatrix,
    mass: &[f64],
    times: &[f64],
    component: &[u32],
) -> Result<Cholesky, SpectralError> {
    let mut timed = stiffness.clone();
    for (i, mut row) in timed.outer_iterator_mut().enumerate() {
        for (_, value) in row.iter_mut() {
            *value *= times[component[i] as usize];
        }
    }
    let matrix = combine(1.0, Mass::Lumped(mass), 1.0, &timed);
    Ok(SymbolicCholesky::new(&matrix, Ordering::default())?.factorize(&matrix)?)
}

/// The squared mean side length of the faces of each component.
fn mean_squares(mesh: &TriMesh, components: usize, component: &[u32]) -> impl Iterator<Item = f64> {
    let mut sums = vec![(0.0, 0.0); components];
    for (face, sides) in mesh.faces().iter().zip(sides(mesh)) {
        let (sum, count) = &mut sums[component[face[0] as usize] as usize];
        for side in sides {
            *sum += side;
            *count += 1.0;
        }
    }
    sums.into_iter().map(|(sum, count): (f64, f64)| (sum / count.max(1.0)).powi(2))
}

/// The number of components and the component of each vertex; a vertex without faces is a component
/// of its own.
fn components(mesh: &TriMesh) -> (usize, Vec<u32>) {
    let components = mesh.topology().components();
    let mut count = components.count();
    let of_vertex = |v| {
        components.label(v).unwrap_or_else(|| {
            count += 1;
            count as u32 - 1
        })
    };
    let numbers = (0..mesh.vertex_count() as u32).map(of_vertex).collect();
    (count, numbers)
}
