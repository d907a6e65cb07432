//! A quadric through the vertex.
//!
//! ```text
//! z = a x + b y + ½ (c x² + 2 d xy + e y²)
//! ```
//!
//! in the frame of the area-weighted normal, by least squares over the neighbours with equal
//! weights. The quadric passes through the vertex, so the noise of the vertex is not reduced; a jet
//! of degree 2 need not pass through it. Where the surface is strongly bent, `x² + z²/2` and `y² +
//! z²/2` stand for the squares, as in jets. Source: \[panozzo2010\].

use fairing_mesh::TriMesh;

use fairing_parameters::Options;

use super::field::CurvatureField;
use super::fit::fit_each;
use super::neighborhood::Neighborhood;
use crate::error::OperatorError;
use crate::normal_equations::NormalEquations;

fairing_parameters::options! {
    /// Options of [`quadric_curvature`].
    #[derive(Debug, Clone, Copy, PartialEq)]
    #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
    #[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
    pub struct QuadricOptions {
        /// The vertices that the quadric is fitted to.
        pub neighborhood: Neighborhood = Neighborhood::Rings(2);
    }
    "quadric": "over two rings, as in libigl; passes through the vertex, so its noise stays", ["panozzo2010"];
}

/// Principal curvatures of a quadric fitted at each vertex.
///
/// Undefined at isolated vertices, without a normal, with fewer than five
/// other vertices connected, and where these do not determine a quadric (all
/// on a line, say).
///
/// # Errors
///
/// [`OperatorError::Option`] for a number of rings or a radius outside its range.
#[doc(alias = "principal_curvature")]
pub fn quadric_curvature(
    mesh: &TriMesh,
    options: QuadricOptions,
) -> Result<CurvatureField, OperatorError> {
    options.check()?;
    fit_each(mesh, options.neighborhood, 5, |field| {
        let ([p, q], mut equations) = (field.bends(), NormalEquations::<5>::default());
        for [x, y, z] in field.neighbors() {
            let (xx, yy) = (x * x + p * z * z, y * y + q * z * z);
            equations.add(&[x, y, 0.5 * xx, x * y, 0.5 * yy], z, 1.0);
        }
        let [a, b, c, d, e] = equations.solve()?;
        let bend = p * c + q * e;
        field.curvature([a, b], [c + bend * a * a, d + bend * a * b, e + bend * b * b])
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::curvature::fit::tests::dome;

    /// κ of `z = −⅒ (3 x² + x y + y²)` at the origin: eigenvalues of its matrix.
    #[test]
    fn exact_on_a_paraboloid() {
        let (mesh, centre) = dome(|x, y| -0.1 * (3.0 * x * x + x * y + y * y));
        let field = quadric_curvature(&mesh, QuadricOptions::default()).unwrap();
        let root = 0.2 * 1.25f64.sqrt();
        assert!((field.kappa1[centre] - 0.4 - root).abs() < 1e-11, "{}", field.kappa1[centre]);
        assert!((field.kappa2[centre] - 0.4 + root).abs() < 1e-11, "{}", field.kappa2[centre]);
    }
}
