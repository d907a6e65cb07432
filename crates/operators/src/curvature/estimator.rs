//! All estimators in one type.

use fairing_mesh::TriMesh;

use super::adaptive::{AdaptiveOptions, adaptive_curvature};
use super::corrected::{CorrectedOptions, corrected_curvature};
use super::cotangent::{CotangentOptions, cotangent_curvature};
use super::face_tensor::{FaceTensorOptions, face_tensor_curvature};
use super::field::CurvatureField;
use super::jet::{JetOptions, jet_curvature};
use super::normal_cycle::{NormalCycleOptions, normal_cycle_curvature};
use super::quadric::{QuadricOptions, quadric_curvature};
use super::steiner::{SteinerOptions, steiner_curvature};
use crate::error::OperatorError;

fairing_parameters::algorithms! {
    /// An estimator of curvature, with its options.
    ///
    /// # Examples
    ///
    /// ```
    /// use fairing_operators::curvature::Estimator;
    /// let wide = Estimator::with("jet3", &[("rings", "5")])?;
    /// assert_ne!(wide, Estimator::RECOMMENDED);
    /// # Ok::<(), fairing_parameters::ParameterError>(())
    /// ```
    #[doc(alias = "principal_curvature")]
    #[derive(Debug, Clone, Copy, PartialEq)]
    #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
    #[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
    #[non_exhaustive]
    pub enum Estimator("estimator") {
        /// [`adaptive_curvature`]
        Adaptive(AdaptiveOptions) => |mesh, &options| adaptive_curvature(mesh, options),
        /// [`cotangent_curvature`]
        Cotangent(CotangentOptions) => |mesh, &options| cotangent_curvature(mesh, options),
        /// [`steiner_curvature`]
        Steiner(SteinerOptions) => |mesh, _| Ok(steiner_curvature(mesh)),
        /// [`normal_cycle_curvature`]
        NormalCycle(NormalCycleOptions) => |mesh, &options| normal_cycle_curvature(mesh, options),
        /// [`corrected_curvature`]
        Corrected(CorrectedOptions) => |mesh, &options| corrected_curvature(mesh, options),
        /// [`face_tensor_curvature`]
        FaceTensor(FaceTensorOptions) => |mesh, &options| Ok(face_tensor_curvature(mesh, options)),
        /// [`quadric_curvature`]
        Quadric(QuadricOptions) => |mesh, &options| quadric_curvature(mesh, options),
        /// [`jet_curvature`]
        Jet(JetOptions) => |mesh, &options| jet_curvature(mesh, options),
    }

    /// Estimates curvature at every vertex; never NaN, undefined vertices are flagged.
    ///
    /// # Errors
    ///
    /// [`OperatorError::Option`] for an option out of its range;
    /// [`OperatorError::NoLength`] for the cotangent estimator on a mesh whose vertices are all in
    /// one place.
    pub fn estimate(mesh: &TriMesh) -> Result<CurvatureField, OperatorError>;
}

impl Estimator {
    /// The recommended estimator for unknown meshes: it chooses its scale at each vertex, on clean
    /// and on noisy meshes, and gives standard errors.
    pub const RECOMMENDED: Self = Self::Adaptive(AdaptiveOptions::DEFAULT);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::curvature::{JetDegree, JetWeight, Length, Neighborhood};

    #[test]
    fn names_are_unique_and_read_back() {
        for (i, estimator) in Estimator::all().iter().enumerate() {
            assert_eq!(estimator.to_string().parse(), Ok(*estimator));
            assert!(Estimator::all()[..i].iter().all(|e| e.name() != estimator.name()));
        }
        let error = "cotan".parse::<Estimator>().unwrap_err();
        assert!(error.to_string().contains("corrected-ball, face-tensor"));
        assert!(Estimator::all().contains(&Estimator::RECOMMENDED));
    }

    #[test]
    fn parameters_are_read_within_their_ranges() {
        let wide = Estimator::with("jet2", &[("radius", 1.5), ("gaussian", 0.7)]).unwrap();
        let expected = JetOptions {
            degree: JetDegree::Two,
            neighborhood: Neighborhood::Ball(Length::MeanEdges(1.5)),
            weight: JetWeight::Gaussian(0.7),
        };
        assert_eq!(wide, Estimator::Jet(expected));
        let ball = Estimator::with("corrected", &[("radius", "3"), ("normals", "angle")]).unwrap();
        assert_eq!(ball.name(), "corrected-ball");
        let defaults = |name| {
            let algorithm = Estimator::by_name(name).unwrap().algorithm();
            algorithm.parameters.iter().map(|p| (p.name, p.default_text())).collect::<Vec<_>>()
        };
        let texts =
            [("rings", "4".to_owned()), ("radius", "".to_owned()), ("gaussian", "".to_owned())];
        assert_eq!(defaults("jet4"), texts);
        for (name, given, said) in [
            ("jet3", &[("rings", "0")][..], "rings is 0, but must be between 1 and 16"),
            ("quadric", &[("rings", "2"), ("radius", "1")], "give rings or radius, not both"),
            ("normal-cycle", &[("radius", "-1")], "radius is -1, but must be positive"),
            ("steiner", &[("radius", "1")], "steiner has no parameter \"radius\""),
            ("cotan", &[], "corrected-ball, face-tensor"),
        ] {
            let error = Estimator::with(name, given).unwrap_err().to_string();
            assert!(error.contains(said), "{error}");
        }
    }

    /// The second ring of a sphere of 42 vertices turns by more than 60°, and one ring determines
    /// no cubic: fits take fewer rings or a lower degree. Three rings of 162 vertices turn by 50°.
    #[test]
    fn coarse_spheres_are_fitted_with_fewer_rings() {
        for (level, limit) in [(1, 0.1), (2, 0.09), (3, 0.06)] {
            let sphere = fairing_shapes::icosphere(level);
            for estimator in Estimator::all() {
                let field = estimator.estimate(&sphere).unwrap();
                let off = field.mean.iter().map(|h| (h - 1.0).abs()).fold(0.0, f64::max);
                // The estimator steiner does not converge at the twelve vertices of valence 5.
                let limit = if estimator.name() == "steiner" { 0.16 } else { limit };
                assert!(off < limit, "{estimator}, {} vertices: {off}", field.len());
            }
        }
        for name in ["quadric", "jet2", "jet3", "jet4"] {
            let narrowed = |level| {
                let estimator: Estimator = name.parse().unwrap();
                estimator.estimate(&fairing_shapes::icosphere(level)).unwrap().narrowed
            };
            assert_eq!([narrowed(1), narrowed(4)], [42, 0], "{name}");
        }
    }

    /// Three rings of a tube with 32 vertices around turn by 34° from the vertex: a cubic height
    /// field over them is 10 % off.
    #[test]
    fn bent_tubes_are_within_six_per_cent() {
        let tube = fairing_shapes::torus(20.0, 0.4, 1500, 32);
        for name in ["quadric", "jet2", "jet3", "jet4"] {
            let field = name.parse::<Estimator>().unwrap().estimate(&tube).unwrap();
            let off = field.kappa1.iter().map(|k| (0.4 * k - 1.0).abs()).fold(0.0, f64::max);
            assert!(off < 0.06, "{name}: {off}");
        }
    }
}
