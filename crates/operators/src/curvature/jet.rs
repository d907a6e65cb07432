//! Osculating jets: polynomials of degree 2 to 4 fitted as height fields.
//!
//! ```text
//! z = Σ c(i, j) xⁱ yʲ,    i + j ≤ d
//! ```
//!
//! in the frame of the area-weighted normal, by least squares over the vertex and its neighbours,
//! each weighted by a Gaussian of its distance, or all with the same weight. Gradient and second
//! derivatives at the vertex give its curvature; the frame need not be exact. With a neighbourhood
//! of size h the second derivatives have an error of order h^(d − 1), so jets converge in the
//! maximum norm on irregular meshes. Coordinates are along the principal axes of the neighbours,
//! each scaled to its own unit, so long faces are fitted as well as round ones. Where normals turn
//! by more than 30° from that of the vertex, `x² + z²/2` and `y² + z²/2` stand for `x²` and `y²` up
//! to degree 3, so that spheres are fitted exactly. Source: [cazals2005].
//!
//! [cazals2005]: https://doi.org/10.1016/j.cagd.2004.09.004

use fairing_mesh::TriMesh;
use fairing_parameters::{Field, Kind, Options, Parameter, ParameterError, Range, Value, Values};

use super::field::{AtVertex, CurvatureField};
use super::fit::{HeightField, fit_each, quadratic};
use super::neighborhood::Neighborhood;
use crate::error::OperatorError;

/// The degree of the polynomial.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum JetDegree {
    /// 6 coefficients.
    Two,
    /// 10 coefficients.
    Three,
    /// 15 coefficients.
    Four,
}

/// The degree is part of the name of the jet, so it is no parameter.
impl Field for JetDegree {
    fn parameters(&self, _: Parameter) -> Vec<Parameter> {
        Vec::new()
    }

    fn read(&mut self, _: &'static str, _: &Values) -> Result<(), ParameterError> {
        Ok(())
    }
}

/// The weight of each neighbour in the fit.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum JetWeight {
    /// Equal weights: the smallest variance under noise.
    Uniform,
    /// `exp(−½ (r / (s R))²)` at distance r, with R the mean distance of the
    /// neighbours and s this factor: a smaller error on clean meshes.
    Gaussian(f64),
}

const GAUSSIAN: &str = "gaussian";

impl Field for JetWeight {
    fn parameters(&self, _: Parameter) -> Vec<Parameter> {
        let about = "The width of Gaussian weights, instead of equal weights";
        vec![Parameter {
            unit: "mean distances of the neighbours",
            range: Range::POSITIVE,
            default: match self {
                Self::Uniform => None,
                Self::Gaussian(width) => Some(Value::Number(*width)),
            },
            ..Parameter::new(GAUSSIAN, Kind::Number, about)
        }]
    }

    fn read(&mut self, _: &'static str, values: &Values) -> Result<(), ParameterError> {
        *self = values.number(GAUSSIAN).map_or(*self, Self::Gaussian);
        Ok(())
    }

    fn check(&self, _: &'static str, _: Range) -> Result<(), ParameterError> {
        match self {
            Self::Uniform => Ok(()),
            Self::Gaussian(width) => Range::POSITIVE.check(GAUSSIAN, *width),
        }
    }
}

fairing_parameters::options! {
    /// Options of [`jet_curvature`].
    #[derive(Debug, Clone, Copy, PartialEq)]
    #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
    #[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
    pub struct JetOptions {
        /// The degree of the polynomial.
        pub degree: JetDegree = JetDegree::Three;
        /// The vertices that the polynomial is fitted to.
        pub neighborhood: Neighborhood = Neighborhood::Rings(3);
        /// The weights of the vertices.
        pub weight: JetWeight = JetWeight::Uniform;
    }
    "jet2": "over two rings, as in CGAL; jet4 is better on clean meshes, corrected-ball on noisy ones", ["cazals2005"],
        with Self { degree: JetDegree::Two, neighborhood: Neighborhood::Rings(2), ..Self::DEFAULT },
        if |jet| jet.degree == JetDegree::Two;
    "jet3": "smooth shapes; converges on irregular meshes; jet4 is better on clean meshes", ["cazals2005"],
        with Self::DEFAULT,
        if |jet| jet.degree == JetDegree::Three;
    "jet4": "the best of fixed size on fine, clean meshes of smooth shapes", ["cazals2005"],
        with Self { degree: JetDegree::Four, neighborhood: Neighborhood::Rings(4), ..Self::DEFAULT },
        if |jet| jet.degree == JetDegree::Four;
}

/// Principal curvatures of a jet fitted at each vertex.
///
/// Undefined at isolated vertices, without a normal, with fewer vertices
/// connected than coefficients, and where these do not determine a polynomial.
///
/// # Errors
///
/// [`OperatorError::Option`] for a number of rings, a radius or a Gaussian width
/// outside its range.
#[doc(alias("jet_fitting", "monge_form"))]
pub fn jet_curvature(mesh: &TriMesh, options: JetOptions) -> Result<CurvatureField, OperatorError> {
    options.check()?;
    let at = options.neighborhood;
    match options.degree {
        JetDegree::Two => fit_each(mesh, at, 5, |f| fit::<6>(f, options.weight, quadratic)),
        JetDegree::Three => fit_each(mesh, at, 9, |f| fit::<10>(f, options.weight, monomials3)),
        JetDegree::Four => fit_each(mesh, at, 14, |f| fit::<15>(f, options.weight, monomials4)),
    }
}

#[inline]
fn fit<const N: usize>(
    field: &HeightField<'_>,
    weight: JetWeight,
    monomials: impl Fn(f64, f64) -> [f64; N],
) -> Option<AtVertex> {
    field.fit(monomials, |point| match weight {
        JetWeight::Uniform => 1.0,
        // Distances are in units of their mean.
        JetWeight::Gaussian(s) => libm::exp(-0.5 * field.squared_distance(point) / (s * s)),
    })
}

#[inline]
fn monomials3(x: f64, y: f64) -> [f64; 10] {
    let (xx, xy, yy) = (x * x, x * y, y * y);
    [1.0, x, y, xx, xy, yy, xx * x, xx * y, x * yy, yy * y]
}

#[inline]
fn monomials4(x: f64, y: f64) -> [f64; 15] {
    let (xx, xy, yy) = (x * x, x * y, y * y);
    let mut all = [0.0; 15];
    all[..10].copy_from_slice(&monomials3(x, y));
    all[10..].copy_from_slice(&[xx * xx, xx * xy, xx * yy, xy * yy, yy * yy]);
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::curvature::fit::tests::dome;

    /// Each degree is exact on its own polynomials, and on no higher ones.
    #[test]
    fn exact_on_polynomials_of_their_degree() {
        let quadratic = |x: f64, y: f64| -0.1 * (3.0 * x * x + x * y + y * y);
        // Even, so that the normal at the origin stays upright.
        let quartic = |x: f64, y: f64| quadratic(x, y) + x.powi(4) - 2.0 * x * y.powi(3);
        let largest_error = |height: &dyn Fn(f64, f64) -> f64, degree| {
            let (mesh, v) = dome(height);
            let options =
                JetOptions { degree, neighborhood: Neighborhood::Rings(4), ..Default::default() };
            let field = jet_curvature(&mesh, options).unwrap();
            let root = 0.2 * 1.25f64.sqrt();
            let gaps = [field.kappa1[v] - 0.4 - root, field.kappa2[v] - 0.4 + root];
            gaps[0].abs().max(gaps[1].abs())
        };
        for degree in [JetDegree::Two, JetDegree::Three, JetDegree::Four] {
            assert!(largest_error(&quadratic, degree) < 1e-10, "{degree:?}");
        }
        assert!(largest_error(&quartic, JetDegree::Three) > 1e-2);
        assert!(largest_error(&quartic, JetDegree::Four) < 1e-9);
    }

    /// Where a polynomial fits exactly, weights do not matter.
    #[test]
    fn weights_keep_what_fits() {
        let (mesh, v) = dome(|x, y| -0.2 * x * x - 0.4 * y * y);
        let weight = JetWeight::Gaussian(0.7);
        let field = jet_curvature(&mesh, JetOptions { weight, ..Default::default() }).unwrap();
        assert!((field.kappa1[v] - 0.8).abs() < 1e-10);
        assert!((field.kappa2[v] - 0.4).abs() < 1e-10);
    }
}
