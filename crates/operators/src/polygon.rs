//! Laplacian of polygon meshes with a virtual vertex in each polygon.
//!
//! Each polygon is refined to a fan of triangles about the point that
//! minimises the sum of their squared areas. The point is an affine
//! combination of the corners, x* = Σ wᵢ xᵢ with Σ wᵢ = 1, the one of least
//! norm; with `P` the matrix that takes values at vertices to values at vertices
//! and virtual vertices alike,
//!
//! ```text
//! S = Pᵀ S△ P,    M = Pᵀ M△ P
//! ```
//!
//! with cotangent stiffness S△ and Galerkin mass M△ of the triangles. On
//! triangles S is the cotangent stiffness itself; polygons need not be flat or
//! convex. Source: [bunge2020].
//!
//! [bunge2020]: https://doi.org/10.1111/cgf.13931

use fairing_mesh::PolygonMesh;
use fairing_sparse::SparseMatrix;
use fairing_watch::parallel;
use glam::DVec3;

use crate::assembly::sum_entries;
use crate::corners::FaceCorners;
use crate::error::OperatorError;

/// Stiffness and mass of a polygon mesh.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct PolygonLaplacian {
    /// `n × n`, symmetric, positive semi-definite, zero row sums,
    /// dimensionless; exact for linear functions on flat polygons.
    pub stiffness: SparseMatrix,
    /// The Galerkin mass, `n × n`, symmetric, in squared mesh units.
    pub mass: SparseMatrix,
    /// The row sums of the mass: areas of vertices, summing to the area of
    /// the refined surface. They can be negative at corners of polygons that
    /// are far from convex.
    pub lumped_mass: Vec<f64>,
}

/// Assembles stiffness and mass of a polygon mesh.
///
/// Rows in vertex order; rows of isolated vertices are zero. Boundaries are natural
/// (zero flux). Cost: for each polygon the square of its corners.
///
/// # Errors
///
/// [`OperatorError::DegenerateFace`] for the first polygon whose fan has a
/// triangle too thin for its cotangents; its `area` is that of the fan.
/// [`OperatorError::TooLarge`] beyond 2³² entries.
///
/// Source: [bunge2020].
///
/// [bunge2020]: https://doi.org/10.1111/cgf.13931
pub fn polygon_laplacian(mesh: &PolygonMesh) -> Result<PolygonLaplacian, OperatorError> {
    let local: Vec<Option<Local>> =
        parallel::map(mesh.polygon_count(), 64, |f| Local::new(&corners(mesh, f)));
    let (mut stiffness, mut mass) = (vec![], vec![]);
    for (f, local) in local.iter().enumerate() {
        let polygon = mesh.polygon(f);
        let Some(local) = local else { return Err(degenerate(mesh, f)) };
        let k = polygon.len();
        for i in 0..k {
            for j in 0..k {
                stiffness.push((polygon[i], polygon[j], local.stiffness[i * k + j]));
                mass.push((polygon[i], polygon[j], local.mass[i * k + j]));
            }
        }
    }
    let n = mesh.vertex_count();
    let mass = sum_entries(n, &mass)?;
    let lumped_mass = mass.outer_iterator().map(|row| row.data().iter().sum()).collect();
    Ok(PolygonLaplacian { stiffness: sum_entries(n, &stiffness)?, mass, lumped_mass })
}

/// The corners of a polygon.
fn corners(mesh: &PolygonMesh, f: usize) -> Vec<DVec3> {
    mesh.polygon(f).iter().map(|&v| mesh.positions()[v as usize].into()).collect()
}

fn degenerate(mesh: &PolygonMesh, f: usize) -> OperatorError {
    let corners = corners(mesh, f);
    let edges =
        (0..corners.len()).map(|i| (corners[(i + 1) % corners.len()] - corners[i]).length());
    let twice: DVec3 =
        corners.windows(2).map(|w| (w[0] - corners[0]).cross(w[1] - corners[0])).sum();
    OperatorError::DegenerateFace {
        face: f as u32,
        area: 0.5 * twice.length(),
        edge: edges.fold(0.0, f64::max),
    }
}

/// The matrices of one polygon, row by row.
struct Local {
    stiffness: Vec<f64>,
    mass: Vec<f64>,
}

impl Local {
    /// `None` where a triangle of the fan is too thin.
    fn new(corners: &[DVec3]) -> Option<Self> {
        let k = corners.len();
        // About the mean of the corners, for precision far from the origin.
        let mean = corners.iter().sum::<DVec3>() * (1.0 / k as f64);
        let x: Vec<DVec3> = corners.iter().map(|&p| p - mean).collect();
        let weights = affine_weights(&x, least_squared_areas(&x)?)?;
        let centre: DVec3 = x.iter().zip(&weights).map(|(&p, &w)| w * p).sum();

        // The fan on k + 1 vertices, the virtual one last.
        let m = k + 1;
        let (mut s, mut a) = (vec![0.0; m * m], vec![0.0; m * m]);
        for i in 0..k {
            let triangle = [i, (i + 1) % k, k];
            let face = FaceCorners::new([x[i], x[(i + 1) % k], centre].map(Into::into));
            if face.is_degenerate() {
                return None;
            }
            let halves = face.half_cotangents();
            for c in 0..3 {
                let (p, q) = (triangle[(c + 1) % 3], triangle[(c + 2) % 3]);
                let half = halves[c];
                s[p * m + q] -= half;
                s[q * m + p] -= half;
                s[p * m + p] += half;
                s[q * m + q] += half;
                for d in 0..3 {
                    let divisor = if c == d { 12.0 } else { 24.0 };
                    a[triangle[c] * m + triangle[d]] += face.twice_area / divisor;
                }
            }
        }
        // Pᵀ B P with P the identity and below it the weights.
        let condense = |b: &[f64]| -> Vec<f64> {
            (0..k * k)
                .map(|at| {
                    let (i, j) = (at / k, at % k);
                    let cross = weights[i] * b[k * m + j] + b[i * m + k] * weights[j];
                    b[i * m + j] + cross + weights[i] * weights[j] * b[k * m + k]
                })
                .collect()
        };
        Some(Self { stiffness: condense(&s), mass: condense(&a) })
    }
}

/// The point p that minimises Σ ‖(a − p) × (b − p)‖² over the sides ab of a
/// polygon about the origin.
///
/// (a − p) × (b − p) = a × b + d × p with d = b − a, so that
/// Σ (‖d‖² I − d dᵀ) p = Σ d × (a × b).
fn least_squared_areas(x: &[DVec3]) -> Option<DVec3> {
    let (mut matrix, mut rhs) = ([[0.0; 3]; 3], DVec3::ZERO);
    for (i, &a) in x.iter().enumerate() {
        let b = x[(i + 1) % x.len()];
        let d = b - a;
        rhs += d.cross(a.cross(b));
        for r in 0..3 {
            for c in 0..3 {
                matrix[r][c] -= d[r] * d[c];
            }
            matrix[r][r] += d.dot(d);
        }
    }
    solve_on_range(matrix, rhs)
}

/// The weights of least norm with Σ w = 1 and Σ w x = p, for x about their
/// mean: `1/k + xᵢ · (Σ x xᵀ)⁺ p`.
fn affine_weights(x: &[DVec3], p: DVec3) -> Option<Vec<f64>> {
    let mut matrix = [[0.0; 3]; 3];
    for q in x {
        for r in 0..3 {
            for c in 0..3 {
                matrix[r][c] += q[r] * q[c];
            }
        }
    }
    let y = solve_on_range(matrix, p)?;
    let even = 1.0 / x.len() as f64;
    Some(x.iter().map(|&q| even + q.dot(y)).collect())
}

/// The solution of least norm of a symmetric positive semi-definite system
/// whose right-hand side lies in its range, by Jacobi rotations; eigenvalues
/// below 10⁻¹² of the largest count as zero. `None` for the zero matrix.
fn solve_on_range(mut a: [[f64; 3]; 3], b: DVec3) -> Option<DVec3> {
    let mut v = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    // Quadratically convergent: a handful of sweeps is more than enough.
    for _ in 0..10 {
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            if a[p][q] == 0.0 {
                continue;
            }
            let theta = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
            let t = theta.signum() / (theta.abs() + libm::hypot(theta, 1.0));
            let c = 1.0 / libm::hypot(t, 1.0);
            let s = t * c;
            for row in &mut a {
                (row[p], row[q]) = (c * row[p] - s * row[q], s * row[p] + c * row[q]);
            }
            for j in 0..3 {
                (a[p][j], a[q][j]) = (c * a[p][j] - s * a[q][j], s * a[p][j] + c * a[q][j]);
            }
            for row in &mut v {
                (row[p], row[q]) = (c * row[p] - s * row[q], s * row[p] + c * row[q]);
            }
        }
    }
    let largest = a[0][0].max(a[1][1]).max(a[2][2]);
    if largest.is_nan() || largest <= 0.0 {
        return None;
    }
    let mut x = DVec3::ZERO;
    for k in 0..3 {
        if a[k][k] > 1e-12 * largest {
            let axis = DVec3::new(v[0][k], v[1][k], v[2][k]);
            x += axis * (axis.dot(b) / a[k][k]);
        }
    }
    Some(x)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stiffness::cotan_stiffness;
    use fairing_mesh::TriMesh;
    use fairing_shapes as shapes;

    fn polygons(positions: Vec<[f64; 3]>, faces: &[&[u32]]) -> PolygonMesh {
        PolygonMesh::new(positions, faces.iter().copied()).unwrap()
    }

    fn energy(m: &SparseMatrix, u: &[f64]) -> f64 {
        let image = m * &ndarray::Array1::from(u.to_vec());
        image.iter().zip(u).map(|(a, b)| a * b).sum()
    }

    #[test]
    fn on_triangles_it_is_the_cotangent_stiffness() {
        let mesh: TriMesh = shapes::torus(3.0, 1.0, 7, 5);
        let same = PolygonMesh::new(mesh.positions().to_vec(), mesh.faces()).unwrap();
        let found = polygon_laplacian(&same).unwrap();
        let gap = found.stiffness.to_dense() - cotan_stiffness(&mesh).unwrap().to_dense();
        assert!(gap.iter().all(|d| d.abs() < 1e-13));
        let area: f64 = (0..mesh.face_count()).map(|f| mesh.face_area(f)).sum();
        assert!((found.lumped_mass.iter().sum::<f64>() - area).abs() < 1e-12 * area);
    }

    /// The virtual vertex of a square is its centre.
    #[test]
    fn a_square_by_hand() {
        let square = vec![[5.0, 5.0, 1.0], [6.0, 5.0, 1.0], [6.0, 6.0, 1.0], [5.0, 6.0, 1.0]];
        let found = polygon_laplacian(&polygons(square, &[&[0, 1, 2, 3]])).unwrap();
        let (d, s, o) = (0.75, -0.25, -0.25);
        let expected = [[d, s, o, s], [s, d, s, o], [o, s, d, s], [s, o, s, d]];
        let gap = found.stiffness.to_dense() - ndarray::arr2(&expected);
        assert!(gap.iter().all(|g| g.abs() < 1e-14), "{}", found.stiffness.to_dense());
        assert!(found.lumped_mass.iter().all(|m| (m - 0.25).abs() < 1e-15));
    }

    /// ∫ ‖∇x‖² over a flat non-convex polygon is its area, and linear
    /// functions are harmonic inside.
    #[test]
    fn linear_functions_are_exact_on_flat_polygons() {
        let positions = vec![
            [0.0, 0.0, 0.0],
            [4.0, 0.0, 0.0],
            [4.0, 3.0, 0.0],
            [2.5, 1.0, 0.0],
            [0.0, 3.0, 0.0],
            [2.0, 6.0, 0.0],
        ];
        let mesh = polygons(positions, &[&[0, 1, 2, 3, 4], &[4, 3, 2, 5]]);
        let found = polygon_laplacian(&mesh).unwrap();
        let total: f64 = found.lumped_mass.iter().sum();
        for axis in 0..2 {
            let x: Vec<f64> = mesh.positions().iter().map(|p| p[axis]).collect();
            assert!((energy(&found.stiffness, &x) - total).abs() < 1e-12);
        }
        for row in found.stiffness.outer_iterator() {
            assert!(row.data().iter().sum::<f64>().abs() < 1e-13);
        }
    }

    /// The coordinates have the energy of twice the area of the fan, so that
    /// it tells where the virtual vertex is. Σ A² is quadratic in its place:
    /// differences give its minimum exactly, and far from the mean.
    #[test]
    fn the_virtual_vertex_minimises_squared_areas() {
        let positions = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.5], [5.0, 1.0, 0.0], [0.0, 3.0, 1.0]];
        let corners = positions.map(DVec3::from);
        let areas = |p: DVec3| -> [f64; 4] {
            std::array::from_fn(|i| 0.5 * (corners[i] - p).cross(corners[(i + 1) % 4] - p).length())
        };
        let squares = |p: DVec3| areas(p).map(|a| a * a).iter().sum::<f64>();
        let at = |steps: &[usize]| {
            let mut p = DVec3::ZERO;
            steps.iter().for_each(|&axis| p[axis] += 1.0);
            squares(p)
        };
        let second = |i, j| at(&[i, j]) - at(&[i]) - at(&[j]) + at(&[]);
        let hessian = [0, 1, 2].map(|i| [0, 1, 2].map(|j| second(i, j)));
        let downhill = [0, 1, 2].map(|i| at(&[]) - at(&[i]) + 0.5 * hessian[i][i]);
        let lowest = solve_on_range(hessian, downhill.into()).unwrap();
        let mean = 0.25 * corners.iter().sum::<DVec3>();
        assert!(squares(mean) > 1.05 * squares(lowest));

        let found = polygon_laplacian(&polygons(positions.to_vec(), &[&[0, 1, 2, 3]])).unwrap();
        let area: f64 = areas(lowest).iter().sum();
        let coordinate = |axis| corners.iter().map(|p| p[axis]).collect::<Vec<_>>();
        let twice: f64 = (0..3).map(|axis| energy(&found.stiffness, &coordinate(axis))).sum();
        assert!((twice - 2.0 * area).abs() < 1e-12, "{twice} {area}");
        assert!((found.lumped_mass.iter().sum::<f64>() - area).abs() < 1e-12);
    }

    #[test]
    fn a_flat_polygon_of_no_area_is_refused() {
        let line = vec![[0.0; 3], [1.0, 0.0, 0.0], [3.0, 0.0, 0.0], [2.0, 0.0, 0.0]];
        let error = polygon_laplacian(&polygons(line, &[&[0, 1, 2, 3]])).unwrap_err();
        assert_eq!(error, OperatorError::DegenerateFace { face: 0, area: 0.0, edge: 2.0 });
    }
}
