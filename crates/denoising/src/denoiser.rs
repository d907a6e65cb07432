//! All denoisers in one type.

use fairing_mesh::TriMesh;

use crate::automatic::{AutomaticOptions, automatic};
use crate::bilateral::{BilateralOptions, bilateral};
use crate::bilateral_normal::{
    BilateralNormalGlobalOptions, BilateralNormalOptions, bilateral_normal, bilateral_normal_global,
};
use crate::error::DenoiseError;
use crate::fast_effective::{FastEffectiveOptions, fast_effective};
use crate::guided_normal::{GuidedNormalOptions, guided_normal};
use crate::l0::{L0Options, l0};
use crate::masked::Masked;
use crate::non_iterative::{NonIterativeOptions, non_iterative};
use crate::total_generalised_variation::{
    TotalGeneralisedVariationOptions, total_generalised_variation,
};
use crate::total_variation::{TotalVariationOptions, total_variation};

fairing_parameters::algorithms! {
    /// A denoiser, with its options.
    ///
    /// # Examples
    ///
    /// ```
    /// use fairing_denoising::Denoiser;
    /// let noisy = fairing_shapes::jittered(&fairing_shapes::icosphere(2), 0.1, 7, |p| p);
    /// let guided = Denoiser::by_name("guided-normal")?;
    /// for parameter in guided.algorithm().parameters {
    ///     println!("{}: {}, {}", parameter.name, parameter.about, parameter.default_text());
    /// }
    /// let strong = Denoiser::with("guided-normal", &[("iterations", "30")])?;
    /// assert_ne!(strong.denoise(&noisy)?, guided.denoise(&noisy)?);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[derive(Debug, Clone, Copy, PartialEq)]
    #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
    #[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
    #[non_exhaustive]
    pub enum Denoiser("denoiser") {
        /// [`automatic`]
        Automatic(AutomaticOptions) => |mesh, options| Ok(automatic(mesh, options)?.mesh),
        /// [`bilateral`]
        Bilateral(BilateralOptions) => bilateral,
        /// [`non_iterative`]
        NonIterative(NonIterativeOptions) => non_iterative,
        /// [`fast_effective`]
        FastEffective(FastEffectiveOptions) => fast_effective,
        /// [`bilateral_normal`]
        BilateralNormal(BilateralNormalOptions) => bilateral_normal,
        /// [`bilateral_normal_global`]
        BilateralNormalGlobal(BilateralNormalGlobalOptions) => bilateral_normal_global,
        /// [`l0`]
        L0(L0Options) => l0,
        /// [`total_variation`]
        TotalVariation(TotalVariationOptions) => total_variation,
        /// [`guided_normal`]
        GuidedNormal(GuidedNormalOptions) => guided_normal,
        /// [`total_generalised_variation`]
        TotalGeneralisedVariation(TotalGeneralisedVariationOptions) => total_generalised_variation,
    }

    /// Denoises a mesh; the result has the same faces. [Fixed](Masked) vertices do not move.
    ///
    /// # Errors
    ///
    /// The errors of the function of the denoiser.
    pub fn denoise<'a>(mesh: impl Into<Masked<'a>>) -> Result<TriMesh, DenoiseError>;
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_read_back() {
        for denoiser in Denoiser::all() {
            assert_eq!(denoiser.name().parse(), Ok(denoiser));
        }
        let error = "laplace".parse::<Denoiser>().unwrap_err().to_string();
        assert!(error.contains("laplace") && error.contains("guided-normal"), "{error}");
    }

    #[test]
    fn parameters_are_read_within_their_ranges() {
        let few = Denoiser::with("guided-normal", &[("vertex-steps", "3"), ("range", "0.4")]);
        let expected = GuidedNormalOptions { vertex_steps: 3, range: 0.4, ..Default::default() };
        assert_eq!(few, Ok(Denoiser::GuidedNormal(expected)));
        for (name, given, said) in [
            ("l0", ("lambda", "1"), "no parameter \"lambda\""),
            ("l0", ("growth", "1"), "growth is 1, but must be above 1"),
            ("l0", ("last-beta", "-1"), "last-beta is -1, but must be positive"),
            ("bilateral-normal-global", ("fidelity", "2"), "above 0 and at most 1"),
            ("fast-effective", ("threshold", "1"), "at least -1 and below 1"),
        ] {
            let error = Denoiser::with(name, &[given]).unwrap_err().to_string();
            assert!(error.contains(said), "{error}");
        }
        let mesh = fairing_shapes::icosphere(0);
        let error = crate::l0(&mesh, &crate::L0Options { last_beta: 0.0, ..Default::default() });
        let error = error.unwrap_err().to_string();
        assert_eq!(error, "last-beta is 0, but must be positive and finite");
    }
}
