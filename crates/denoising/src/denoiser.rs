//! The denoisers by name.

use fairing_mesh::TriMesh;
use fairing_parameters::{Algorithm, ParameterError, Values};

use super::method::Method;
use super::{
    BilateralNormalGlobalOptions, BilateralNormalOptions, BilateralOptions, DenoiseError,
    FastEffectiveOptions, GuidedNormalOptions, L0Options, NonIterativeOptions,
    TotalVariationOptions, automatic,
};

/// The automatic denoiser has no options.
#[derive(Default)]
struct NoOptions;

impl Method for NoOptions {
    const ALGORITHM: &'static Algorithm = &Algorithm::new(
        "automatic",
        "all estimated from the mesh; creases kept where there are any",
        &[],
        &[],
    );

    fn read(&mut self, _: &Values<'_>) -> Result<(), ParameterError> {
        Ok(())
    }

    fn run(&self, mesh: &TriMesh) -> Result<TriMesh, DenoiseError> {
        Ok(automatic(mesh)?.mesh)
    }
}

/// Makes [`Denoiser`] of the types of options; each line adds a denoiser.
macro_rules! denoisers {
    ($($(#[$doc:meta])* $name:ident: $options:ty;)*) => {
        /// A denoiser by name.
        ///
        /// Written as its name (`Display`), and read from it (`FromStr`).
        ///
        /// # Examples
        ///
        /// ```
        /// use fairing_denoising::Denoiser;
        /// let noisy = fairing_shapes::jittered(&fairing_shapes::icosphere(2), 0.1, 7, |p| p);
        /// for parameter in Denoiser::GuidedNormal.algorithm().parameters {
        ///     println!("{}: {}, {}", parameter.name, parameter.about, parameter.default);
        /// }
        /// let strong = Denoiser::GuidedNormal.denoise_with(&noisy, &[("iterations", "30")])?;
        /// assert_ne!(strong, Denoiser::GuidedNormal.denoise(&noisy)?);
        /// # Ok::<(), fairing_denoising::DenoiseError>(())
        /// ```
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
        #[non_exhaustive]
        pub enum Denoiser {
            $($(#[$doc])* $name,)*
        }

        impl Denoiser {
            /// All denoisers: ours, then the others in the order they were published.
            pub const ALL: [Self; [$(stringify!($name)),*].len()] = [$(Self::$name),*];

            /// Its name, description, sources and parameters.
            pub fn algorithm(self) -> &'static Algorithm {
                match self {
                    $(Self::$name => <$options>::ALGORITHM,)*
                }
            }

            fn run(self, mesh: &TriMesh, values: &Values<'_>) -> Result<TriMesh, DenoiseError> {
                match self {
                    $(Self::$name => {
                        let mut options = <$options>::default();
                        options.read(values)?;
                        options.run(mesh)
                    })*
                }
            }
        }
    };
}

denoisers! {
    /// [`automatic`].
    Automatic: NoOptions;
    /// [`bilateral`](crate::bilateral).
    Bilateral: BilateralOptions;
    /// [`non_iterative`](crate::non_iterative).
    NonIterative: NonIterativeOptions;
    /// [`fast_effective`](crate::fast_effective).
    FastEffective: FastEffectiveOptions;
    /// [`bilateral_normal`](crate::bilateral_normal).
    BilateralNormal: BilateralNormalOptions;
    /// [`bilateral_normal_global`](crate::bilateral_normal_global).
    BilateralNormalGlobal: BilateralNormalGlobalOptions;
    /// [`l0`](crate::l0).
    L0: L0Options;
    /// [`total_variation`](crate::total_variation).
    TotalVariation: TotalVariationOptions;
    /// [`guided_normal`](crate::guided_normal).
    GuidedNormal: GuidedNormalOptions;
}

impl Denoiser {
    /// The name on the command line and in reports.
    pub fn name(self) -> &'static str {
        self.algorithm().name
    }

    /// What it does, in a line, with its source.
    pub fn description(self) -> &'static str {
        self.algorithm().description
    }

    /// Denoises with the default options; the result has the same faces.
    ///
    /// # Errors
    ///
    /// Those of the function of the same name.
    pub fn denoise(self, mesh: &TriMesh) -> Result<TriMesh, DenoiseError> {
        self.run(mesh, &Values::none(self.algorithm()))
    }

    /// Denoises with values for some of the [parameters](Algorithm::parameters) of the denoiser.
    ///
    /// # Errors
    ///
    /// [`DenoiseError::Parameter`] for a parameter that it does not have and a value that does not fit; those of the
    /// function of the same name.
    pub fn denoise_with(
        self,
        mesh: &TriMesh,
        values: &[(&str, &str)],
    ) -> Result<TriMesh, DenoiseError> {
        self.run(mesh, &Values::new(self.algorithm(), values)?)
    }
}

fairing_parameters::named!(Denoiser, "denoiser");
#[cfg(feature = "serde")]
fairing_parameters::serde_by_name!(Denoiser);

#[cfg(test)]
mod tests {
    use fairing_parameters::Kind;
    use fairing_shapes as shapes;

    use super::*;

    #[test]
    fn names_are_read_back() {
        for denoiser in Denoiser::ALL {
            assert_eq!(denoiser.name().parse(), Ok(denoiser));
        }
        let error = "laplace".parse::<Denoiser>().unwrap_err().to_string();
        assert!(error.contains("laplace") && error.contains("guided-normal"), "{error}");
    }

    /// The defaults of the tables are those of the options, and each parameter of a table is read.
    #[test]
    fn tables_agree_with_the_options() {
        let block = shapes::cad_block(0.3);
        let noisy = shapes::jittered(&block, 0.1, 3, |p| p);
        for denoiser in Denoiser::ALL {
            let without = denoiser.denoise(&noisy).unwrap();
            for parameter in denoiser.algorithm().parameters {
                let name = format!("{denoiser} --{}", parameter.name);
                let with = |value| denoiser.denoise_with(&noisy, &[(parameter.name, value)]);
                assert_eq!(with(parameter.default).unwrap(), without, "{name}");
                let other = match parameter.kind {
                    Kind::Count => "1",
                    // A mean edge on a coarse block has few neighbours within half of it.
                    _ if parameter.name == "spatial" => "3",
                    _ => "0.73",
                };
                // Read, if it changes the result or is refused by its range.
                assert_ne!(with(other).ok(), Some(without.clone()), "{name}");
            }
            let error = denoiser.denoise_with(&noisy, &[("lambda", "1")]).unwrap_err();
            assert!(error.to_string().contains("no parameter \"lambda\""), "{error}");
        }
    }
}
