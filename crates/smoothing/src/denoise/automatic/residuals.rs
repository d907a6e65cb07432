//! What is left of the noise once a result is taken away.

use fairing_mesh::TriMesh;
use fairing_mesh::vec3::{dot, sub};
use rayon::prelude::*;

use super::smooth::vertex_normals;

/// Products beyond this are held there, so that a few outliers do not decide.
const LARGEST: f64 = 3.0;

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
/// mean over the edges ij of rᵢ rⱼ / σ²
/// ```
///
/// with each product held between −3 and 3. Independent noise gives zero, and
/// a little less since it leaks into the result; a result of another shape than
/// the surface, facets in the place of a curved part for one, leaves residuals
/// that are alike on neighbours. Zero without edges.
pub(super) fn neighbour_correlation(noisy: &TriMesh, result: &TriMesh, sigma: f64) -> f64 {
    let r = residuals(noisy, result);
    let edges = noisy.topology().edges();
    let products = edges
        .iter()
        .map(|&[a, b]| (r[a as usize] * r[b as usize] / (sigma * sigma)).clamp(-LARGEST, LARGEST));
    products.sum::<f64>() / edges.len().max(1) as f64
}

#[cfg(test)]
mod tests {
    use fairing_mesh::shapes;

    use super::*;

    /// A sphere blown up by σ has equal residuals everywhere; alternating ones
    /// on a strip of equal faces cancel.
    #[test]
    fn a_shift_correlates_fully() {
        let sphere = shapes::icosphere(3);
        let blown = sphere.positions().iter().map(|p| p.map(|x| 1.1 * x)).collect();
        let blown = sphere.with_positions(blown).unwrap();
        let found = neighbour_correlation(&blown, &sphere, 0.1);
        // Vertex normals of an icosphere are radial to O(h²).
        assert!((found - 1.0).abs() < 1e-2, "{found}");
        assert!(residuals(&blown, &sphere).iter().all(|r| *r > 0.09));
        assert_eq!(neighbour_correlation(&sphere, &sphere, 0.1), 0.0);
    }
}
