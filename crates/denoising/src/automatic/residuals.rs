//! The residuals: the input minus a result.

use fairing_mesh::TriMesh;
use fairing_mesh::vec3::{dot, sub};
use rayon::prelude::*;

use super::smooth::vertex_normals;

/// The distances of the noisy vertices from a result along its normals, in
/// mesh units, positive outside.
pub(super) fn residuals(noisy: &TriMesh, result: &TriMesh) -> Vec<f64> {
    let normals = vertex_normals(result);
    (noisy.positions().par_iter().zip(result.positions()))
        .zip(&normals)
        .map(|((&p, &x), &n)| dot(n, sub(p, x)))
        .collect()
}

/// How alike the residuals r of neighbouring vertices are,
///
/// ```text
/// mean over the edges ij of rᵢ rⱼ  /  mean over the vertices of r²
/// ```
///
/// (Moran's coefficient). Independent noise gives zero, and less where a result
/// follows the noise, which takes from each vertex what its neighbours have. A
/// result of another shape than the surface, facets in the place of a curved
/// part or rounded creases, leaves residuals that are alike on neighbours. Zero
/// without edges or residuals.
///
/// Source: \[moran1950\].
pub(super) fn neighbour_correlation(noisy: &TriMesh, result: &TriMesh) -> f64 {
    let r = residuals(noisy, result);
    let edges = noisy.topology().edges();
    let products: f64 = edges.iter().map(|&[a, b]| r[a as usize] * r[b as usize]).sum();
    let squares: f64 = r.iter().map(|r| r * r).sum();
    let correlation = products / edges.len() as f64 * r.len() as f64 / squares;
    if correlation.is_finite() { correlation } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use fairing_shapes as shapes;

    use super::*;

    /// A sphere blown up has equal residuals everywhere. Of six around a vertex
    /// of a grid, raised in turn, two are alike and four are not.
    #[test]
    fn a_shift_correlates_fully() {
        let sphere = shapes::icosphere(3);
        let blown = sphere.positions().iter().map(|p| p.map(|x| 1.1 * x)).collect();
        let blown = sphere.with_positions(blown).unwrap();
        let found = neighbour_correlation(&blown, &sphere);
        // Vertex normals of an icosphere are radial to O(h²).
        assert!((found - 1.0).abs() < 1e-2, "{found}");
        assert!(residuals(&blown, &sphere).iter().all(|r| *r > 0.09));
        assert_eq!(neighbour_correlation(&sphere, &sphere), 0.0);
        let plane = shapes::plane(40, 40, shapes::Diagonals::Regular);
        let raised = plane.positions().iter().enumerate().map(|(v, &[x, y, _])| {
            let (i, j) = (v % 41, v / 41);
            [x, y, if (i + j) % 2 == 0 { 1e-3 } else { -1e-3 }]
        });
        let raised = plane.with_positions(raised.collect()).unwrap();
        let found = neighbour_correlation(&raised, &plane);
        // Up to the border, where diagonals are missing.
        assert!((found + 1.0 / 3.0).abs() < 0.02, "{found}");
    }
}
