//! Geodesic distance by the heat method.

use fairing_mesh::TriMesh;
use fairing_operators::{cotan_stiffness, divergence, gradient};
use fairing_sparse::{Cholesky, SparseMatrix, multiply};

use crate::diffusion::{check_time, factor_pair, solvable_mass};
use crate::error::SpectralError;

/// The heat method, ready for any sources: heat diffuses for a short time, its gradient is normalised, and the
/// function that best has this gradient is the distance.
///
/// Smooth approximation of the geodesic distance, in mesh units: zero at the sources, too large by the order of
/// an edge length near them, of first order in h elsewhere; never exact. Source: \[crane2013\].
#[derive(Debug)]
pub struct HeatGeodesics {
    heat: Cholesky,
    poisson: Cholesky,
    gradient: SparseMatrix,
    divergence: SparseMatrix,
    components: usize,
    /// The component of each vertex.
    component: Vec<u32>,
}

/// S + εM in place of the singular S: ε is this share of the mean eigenvalue divided by n, the smallest
/// eigenvalue there may be on a compact surface.
const REGULARISATION: f64 = 1e-6;

impl HeatGeodesics {
    /// Factorises for the time t = h², h the mean edge length: the choice of the source.
    ///
    /// # Errors
    ///
    /// What assembling and factorising report.
    pub fn new(mesh: &TriMesh) -> Result<Self, SpectralError> {
        Self::with_time(mesh, mesh.mean_edge_length().powi(2))
    }

    /// Factorises for a time in squared mesh units: longer times smooth the distance more.
    ///
    /// # Errors
    ///
    /// [`SpectralError::Parameter`] for a negative time; what assembling and factorising report.
    pub fn with_time(mesh: &TriMesh, time: f64) -> Result<Self, SpectralError> {
        check_time(time)?;
        let stiffness = cotan_stiffness(mesh)?;
        let mass = solvable_mass(mesh)?;
        let n = mesh.vertex_count();
        let trace: f64 = (0..n).filter_map(|i| stiffness.get(i, i)).sum();
        let epsilon = REGULARISATION * trace / (mass.iter().sum::<f64>() * n as f64);
        let (heat, poisson) = factor_pair(&stiffness, &mass, time, epsilon.max(f64::MIN_POSITIVE))?;
        let (components, component) = components(mesh);
        Ok(Self {
            heat,
            poisson,
            gradient: gradient(mesh)?,
            divergence: divergence(mesh)?,
            components,
            component,
        })
    }

    /// The distance of every vertex to the nearest source; `None` on components without a source.
    ///
    /// # Errors
    ///
    /// [`SpectralError::NoSuchVertex`]; [`SpectralError::Parameter`] without a source.
    pub fn distance(&self, sources: &[u32]) -> Result<Vec<Option<f64>>, SpectralError> {
        let n = self.component.len();
        if sources.is_empty() {
            let (name, value) = ("number of sources", 0.0);
            return Err(SpectralError::Parameter { name, value, must: "at least 1" });
        }
        let mut heat = vec![0.0; n];
        for &vertex in sources {
            let at = heat.get_mut(vertex as usize);
            *at.ok_or(SpectralError::NoSuchVertex { vertex, vertices: n })? = 1.0;
        }
        self.heat.solve_in_place(&mut heat);
        let mut flow = multiply(&self.gradient, &heat);
        for g in flow.chunks_exact_mut(3) {
            let norm = (g[0] * g[0] + g[1] * g[1] + g[2] * g[2]).sqrt();
            // Far away the heat underflows to an exact zero, and so does its gradient.
            let scale = if norm > 0.0 { -1.0 / norm } else { 0.0 };
            g.iter_mut().for_each(|g| *g *= scale);
        }
        // S φ = −div X, for X = −∇u / |∇u|.
        let mut phi: Vec<f64> = multiply(&self.divergence, &flow).iter().map(|d| -d).collect();
        self.poisson.solve_in_place(&mut phi);
        let mut reached = vec![false; self.components];
        for &v in sources {
            reached[self.component[v as usize] as usize] = true;
        }
        let mut least = vec![f64::INFINITY; self.components];
        for (phi, &c) in phi.iter().zip(&self.component) {
            least[c as usize] = least[c as usize].min(*phi);
        }
        let distance =
            |(phi, &c): (&f64, &u32)| reached[c as usize].then(|| phi - least[c as usize]);
        Ok(phi.iter().zip(&self.component).map(distance).collect())
    }
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
