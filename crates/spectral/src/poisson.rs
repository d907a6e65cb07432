//! Poisson problems on a mesh, by faces laid out in the plane.

use fairing_operators::{Laplacian, OperatorError};
use fairing_parameters::ParameterError;
use fairing_sparse::GraphSystem;

use crate::error::SpectralError;

/// The Poisson equation −Δu = f with u prescribed at fixed vertices, factorised once for any f and
/// any prescribed values.
///
/// Weak form: `S u = M f` at the free vertices. Boundaries are natural (zero flux) at free
/// vertices. On a component without a fixed vertex a solution exists only for f of mean zero, and
/// only up to a constant: the mean of f over the component is subtracted, and the solution is the u
/// of mean zero. Means are weighted by area. Isolated vertices have no equation: u is 0 there
/// unless they are fixed.
///
/// The system is solved from its edge weights, which may differ by any factor ([`GraphSystem`]); if
/// rounding leaves fewer than half of the digits, the solve fails.
///
/// # Examples
///
/// ```
/// use fairing_shapes as shapes;
/// use fairing_operators::Laplacian;
/// use fairing_spectral::Poisson;
///
/// // On the unit sphere −Δz = 2z.
/// let sphere = shapes::icosphere(4);
/// let laplacian = Laplacian::auto(&sphere)?;
/// let f: Vec<f64> = sphere.positions().iter().map(|p| 2.0 * p[2]).collect();
/// let u = Poisson::new(&laplacian, &[])?.solve(&f, &[])?;
/// assert!(u.iter().zip(sphere.positions()).all(|(u, p)| (u - p[2]).abs() < 0.01));
///
/// // Harmonic between 0 at one vertex and 1 at another.
/// let u = Poisson::new(&laplacian, &[0, 3])?.solve(&vec![0.0; u.len()], &[0.0, 1.0])?;
/// assert!((u[0], u[3]) == (0.0, 1.0) && u.iter().all(|u| (-1e-9..=1.0 + 1e-9).contains(u)));
/// # Ok::<(), fairing_spectral::SpectralError>(())
/// ```
#[doc(alias("harmonic", "min_quad_with_fixed"))]
#[derive(Debug)]
pub struct Poisson<'a> {
    laplacian: &'a Laplacian,
    fixed: Vec<u32>,
    system: GraphSystem,
}

impl<'a> Poisson<'a> {
    /// Factorises the stiffness without the fixed vertices.
    ///
    /// # Errors
    ///
    /// [`OperatorError::NoSuchVertex`] and [`OperatorError::Mass`]; [`SpectralError::Repeated`] for
    /// a vertex that is fixed twice; [`SpectralError::Sparse`] for a stiffness that cannot be
    /// factorised, because of negative weights of polygons or extreme shapes.
    pub fn new(laplacian: &'a Laplacian, fixed: &[u32]) -> Result<Self, SpectralError> {
        let n = laplacian.vertex_count();
        let mut is_fixed = vec![false; n];
        for &vertex in fixed {
            let no = OperatorError::NoSuchVertex { vertex, vertices: n };
            let slot = is_fixed.get_mut(vertex as usize).ok_or(no)?;
            if std::mem::replace(slot, true) {
                return Err(SpectralError::Repeated { vertex });
            }
        }
        for &v in laplacian.isolated() {
            is_fixed[v as usize] = true;
        }
        let masses = laplacian.mass().as_mass().diagonal();
        for (v, &mass) in masses.iter().enumerate() {
            if !is_fixed[v] && (mass <= 0.0 || mass.is_nan()) {
                return Err(OperatorError::Mass { vertex: v as u32, mass }.into());
            }
        }
        let areas = laplacian.mass().lumped();
        let system =
            GraphSystem::new(laplacian.stiffness(), vec![0.0; n], &areas, &is_fixed, None)?;
        Ok(Self { laplacian, fixed: fixed.to_vec(), system })
    }

    /// Estimates the condition number of the system scaled to a unit diagonal
    /// ([`GraphSystem::condition`]).
    pub fn condition(&self) -> f64 {
        self.system.condition()
    }

    /// The solution u at each vertex, from pointwise f at each vertex (unit of u per squared mesh
    /// unit) and the values at the fixed vertices, in the order given to [`new`](Self::new).
    ///
    /// # Errors
    ///
    /// [`SpectralError::Rows`] for a wrong number of values; [`SpectralError::Option`] for a value
    /// that is not finite; [`SpectralError::Sparse`] if rounding leaves too few digits of the
    /// solution.
    pub fn solve(&self, f: &[f64], values: &[f64]) -> Result<Vec<f64>, SpectralError> {
        let n = self.laplacian.vertex_count();
        for (found, expected) in [(f.len(), n), (values.len(), self.fixed.len())] {
            if found != expected {
                return Err(SpectralError::Rows { found, expected });
            }
        }
        for (name, numbers) in [("right-hand side", f), ("fixed value", values)] {
            if let Some(&value) = numbers.iter().find(|x| !x.is_finite()) {
                return Err(ParameterError::range(name, value, "finite").into());
            }
        }
        let right = self.laplacian.mass().as_mass().times(f);
        let mut u = vec![0.0; n];
        for (&v, &value) in self.fixed.iter().zip(values) {
            u[v as usize] = value;
        }
        self.system.solve(|v| [right[v]], u.as_chunks_mut().0)?;
        Ok(u)
    }
}

/// The gradients of the three hat functions of a face, and its area.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct FlatFace {
    /// In the plane, in 1/(mesh unit); zero if the lengths form no triangle.
    hats: [[f64; 2]; 3],
    /// In squared mesh units, times the fraction at which the face counts.
    area: f64,
}

impl FlatFace {
    /// Builds the face from the lengths of its sides 0 → 1, 1 → 2 and 2 → 0.
    pub(crate) fn new([a, b, c]: [f64; 3], fraction: f64) -> Self {
        let area = heron([a, b, c]);
        if a == 0.0 || area == 0.0 {
            return Self { hats: [[0.0; 2]; 3], area: 0.0 };
        }
        // Corner 0 in the origin, corner 1 on the x axis, corner 2 above it.
        let x = 0.5 * (a + (c - b) * ((c + b) / a));
        let y = 2.0 * area / a;
        let twice = 2.0 * area;
        let hats = [[-y, x - a], [y, -x], [0.0, a]].map(|hat| hat.map(|v| v / twice));
        Self { hats, area: area * fraction }
    }

    /// ∫ X · ∇φᵢ over the face for the hat function φᵢ of each corner, X = −∇u / |∇u|, from u at
    /// the corners. The scale of u does not matter, down to the smallest normal number.
    pub(crate) fn unit_flux(&self, u: [f64; 3]) -> [f64; 3] {
        let largest = u.iter().fold(0.0, |m: f64, u| m.max(u.abs()));
        if largest == 0.0 {
            return [0.0; 3];
        }
        let scaled = u.map(|u| u / largest);
        // Differences from the first corner: the gradient of a constant is exactly zero.
        let d = [scaled[1] - scaled[0], scaled[2] - scaled[0]];
        let g: [f64; 2] = std::array::from_fn(|k| self.hats[1][k] * d[0] + self.hats[2][k] * d[1]);
        let norm = libm::hypot(g[0], g[1]);
        if norm == 0.0 {
            return [0.0; 3];
        }
        self.hats.map(|hat| -self.area * (hat[0] * (g[0] / norm) + hat[1] * (g[1] / norm)))
    }
}

/// The area from the side lengths by Kahan's form of Heron's formula; zero if they form no
/// triangle.
fn heron(mut sides: [f64; 3]) -> f64 {
    sides.sort_unstable_by(|x, y| y.total_cmp(x));
    let [a, b, c] = sides;
    let product = ((a + (b + c)) * (c - (a - b))) * ((c + (a - b)) * (a + (b - c)));
    0.25 * product.max(0.0).sqrt()
}

#[cfg(test)]
mod tests {
    use fairing_mesh::TriMesh;
    use fairing_operators::{LaplacianKind, MassKind};
    use fairing_shapes as shapes;

    use super::*;

    /// Two spheres of different sizes, and an isolated vertex.
    fn pair() -> (TriMesh, usize) {
        let sphere = shapes::icosphere(2);
        let n = sphere.vertex_count();
        let mut positions = sphere.positions().to_vec();
        positions.extend(sphere.positions().iter().map(|p| p.map(|x| 9.0 + 3.0 * x)));
        positions.push([50.0; 3]);
        let mut faces = sphere.faces().to_vec();
        faces.extend(sphere.faces().iter().map(|f| f.map(|v| v + n as u32)));
        (TriMesh::new(positions, faces).unwrap(), n)
    }

    /// The solution solves the equation at free vertices, and has the required means and values.
    #[test]
    fn solutions_solve() {
        let (mesh, n) = pair();
        let f: Vec<f64> = (0..2 * n + 1).map(|v| (v as f64).sin() + 0.3).collect();
        for kind in [LaplacianKind::Cotangent, LaplacianKind::Robust, LaplacianKind::Uniform] {
            for mass in [MassKind::Barycentric, MassKind::Consistent] {
                let Ok(laplacian) = Laplacian::new(&mesh, kind, mass) else { continue };
                let areas = laplacian.mass().lumped();
                let fixed = [7u32, 3];
                let u = Poisson::new(&laplacian, &fixed).unwrap().solve(&f, &[2.0, -1.0]).unwrap();
                assert_eq!((u[7], u[3], u[2 * n]), (2.0, -1.0, 0.0));
                let second = n..2 * n;
                let total: f64 = areas[second.clone()].iter().sum();
                let load = laplacian.mass().as_mass().times(&f);
                let mean = load[second.clone()].iter().sum::<f64>() / total;
                let image = laplacian.apply(&u).unwrap();
                for v in (0..2 * n).filter(|v| ![3, 7].contains(v)) {
                    let expected = load[v] - if v < n { 0.0 } else { mean * areas[v] };
                    assert!((image[v] - expected).abs() < 1e-11, "{kind} {mass} {v}");
                }
                let middle: f64 = second.map(|v| areas[v] * u[v]).sum();
                assert!(middle.abs() < 1e-12 * total, "{middle}");
            }
        }
    }

    #[test]
    fn bad_input_is_named() {
        let mesh = shapes::icosphere(0);
        let laplacian = Laplacian::cotangent(&mesh).unwrap();
        assert!(matches!(
            Poisson::new(&laplacian, &[4, 1, 4]),
            Err(SpectralError::Repeated { vertex: 4 })
        ));
        assert!(matches!(
            Poisson::new(&laplacian, &[12]),
            Err(SpectralError::Operator(OperatorError::NoSuchVertex { vertex: 12, vertices: 12 }))
        ));
        let problem = Poisson::new(&laplacian, &[4]).unwrap();
        assert!(matches!(
            problem.solve(&[0.0; 12], &[]),
            Err(SpectralError::Rows { found: 0, expected: 1 })
        ));
        assert!(matches!(
            problem.solve(&[0.0; 12], &[f64::NAN]),
            Err(SpectralError::Option(ParameterError::Range { option: "fixed value", .. }))
        ));
        // Nothing is left to solve if all vertices are fixed.
        let all: Vec<u32> = (0..12).collect();
        let values: Vec<f64> = all.iter().map(|&v| f64::from(v)).collect();
        let found = Poisson::new(&laplacian, &all).unwrap().solve(&[1.0; 12], &values).unwrap();
        assert_eq!(found, values);
    }

    /// Legs of 1 and 2, u = x: X = −e₁, and ∇φ are (−1, −½), (1, 0), (0, ½).
    #[test]
    fn flux_of_a_right_triangle() {
        let face = FlatFace::new([1.0, 5f64.sqrt(), 2.0], 0.5);
        for unit in [1.0, 1e-290, 1e290] {
            let flux = face.unit_flux([0.0, unit, 0.0]);
            let expected = [0.5, -0.5, 0.0];
            assert!((0..3).all(|i| (flux[i] - expected[i]).abs() < 1e-15), "{flux:?}");
        }
        assert_eq!(face.unit_flux([3.0; 3]), [0.0; 3]);
        assert_eq!(FlatFace::new([1.0, 2.0, 3.0], 1.0).unit_flux([0.0, 1.0, 2.0]), [0.0; 3]);
    }
}
