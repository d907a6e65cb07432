//! All flows behind one type, for programs.

use fairing_mesh::TriMesh;
use fairing_parameters::old::{Algorithm, Values};
use fairing_parameters::{ParameterError, UnknownName};

use crate::engine::error::FlowError;
use crate::engine::flow::Flow;
use crate::engine::outcome::Smoothed;
use crate::engine::step::Observer;
use crate::flows::conformal::ConformalizedMcf;
use crate::flows::explicit::Explicit;
use crate::flows::hc::Hc;
use crate::flows::implicit::Implicit;
use crate::flows::low_pass::LowPass;
use crate::flows::region::FairRegion;
use crate::flows::scale_dependent::ScaleDependent;
use crate::flows::taubin::Taubin;
use crate::flows::windowed_sinc::WindowedSinc;

/// Makes [`Method`] of the types of options; each line adds a flow.
macro_rules! methods {
    ($($(#[$doc:meta])* $name:ident($options:ty),)*) => {
        /// A flow with its options.
        ///
        /// # Examples
        ///
        /// ```
        /// use fairing_shapes as shapes;
        /// use fairing_smoothing::Method;
        ///
        /// let sphere = shapes::icosphere(4);
        /// for method in Method::defaults() {
        ///     let smoothed = method.run(&sphere, None)?;
        ///     println!("{}: {} steps", method.name(), smoothed.report.iterations);
        /// }
        /// let taubin = Method::with("taubin", &[("lambda", "0.3"), ("iterations", "5")], &sphere)?;
        /// assert_eq!(taubin.run(&sphere, None)?.report.iterations, 10);
        /// # Ok::<(), Box<dyn std::error::Error>>(())
        /// ```
        #[derive(Debug, Clone, PartialEq)]
        #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
        #[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
        #[non_exhaustive]
        pub enum Method {
            $($(#[$doc])* $name($options),)*
        }

        impl Method {
            /// The algorithms of all methods: names, descriptions and parameters.
            pub fn algorithms() -> Vec<&'static Algorithm> {
                [$(<$options>::ALGORITHMS),*].into_iter().flatten().collect()
            }

            /// Its algorithm.
            pub fn algorithm(&self) -> &'static Algorithm {
                match self {
                    $(Self::$name(options) => options.algorithm(),)*
                }
            }

            /// Runs it. An observer sees every step of those methods that take steps; filters and fairing do all at
            /// once and are not observed.
            ///
            /// # Errors
            ///
            /// As the function of the method.
            pub fn run(
                &self,
                mesh: &TriMesh,
                observer: Option<&mut Observer<'_>>,
            ) -> Result<Smoothed, FlowError> {
                match self {
                    $(Self::$name(options) => (<$options>::RUN)(mesh, options, observer),)*
                }
            }

            /// The method with these values.
            fn from_values(
                values: &Values<'_>,
                positions: &[[f64; 3]],
            ) -> Result<Self, ParameterError> {
                let algorithm = values.algorithm();
                $(if <$options>::ALGORITHMS.contains(algorithm) {
                    return <$options>::with(values, positions).map(Self::$name);
                })*
                Err(UnknownName::new("method", algorithm.name, names()).into())
            }
        }
    };
}

methods! {
    /// [`explicit`](crate::explicit).
    Explicit(Explicit),
    /// [`implicit`](crate::implicit); mean curvature flow if the operator is updated.
    Implicit(Implicit),
    /// [`conformalized_mean_curvature_flow`](crate::conformalized_mean_curvature_flow).
    ConformalizedMcf(ConformalizedMcf),
    /// [`taubin`](crate::taubin).
    Taubin(Taubin),
    /// [`windowed_sinc`](crate::windowed_sinc).
    WindowedSinc(WindowedSinc),
    /// [`hc`](crate::hc).
    Hc(Hc),
    /// [`scale_dependent`](crate::scale_dependent).
    ScaleDependent(ScaleDependent),
    /// [`low_pass`](crate::low_pass).
    LowPass(LowPass),
    /// [`fair_region`](crate::fair_region).
    FairRegion(FairRegion),
}

/// The names of the methods.
fn names() -> Vec<&'static str> {
    Method::algorithms().iter().map(|algorithm| algorithm.name).collect()
}

impl Method {
    /// Every method once, with options that suit most meshes.
    pub fn defaults() -> Vec<Self> {
        let all = Method::algorithms();
        all.iter().filter_map(|of| Self::from_values(&Values::none(of), &[]).ok()).collect()
    }

    /// The method of that name, with options that suit most meshes.
    ///
    /// # Errors
    ///
    /// [`ParameterError::UnknownName`] with the names that there are.
    pub fn by_name(name: &str) -> Result<Self, ParameterError> {
        Self::from_values(&Values::none(Self::algorithm_of(name)?), &[])
    }

    /// The method of that name with values for some of its [parameters](Algorithm::parameters), to run on `mesh`:
    /// soft constraints without a target draw vertices to where they are in it.
    ///
    /// # Errors
    ///
    /// [`ParameterError`] for unknown names and for values that do not fit. Whether numbers are in their range is
    /// checked when the method runs.
    pub fn with(
        name: &str,
        values: &[(&str, &str)],
        mesh: &TriMesh,
    ) -> Result<Self, ParameterError> {
        let values = Values::new(Self::algorithm_of(name)?, values)?;
        Self::from_values(&values, mesh.positions())
    }

    fn algorithm_of(name: &str) -> Result<&'static Algorithm, ParameterError> {
        let mut all = Self::algorithms().into_iter();
        let found = all.find(|algorithm| algorithm.name.eq_ignore_ascii_case(name));
        found.ok_or_else(|| UnknownName::new("method", name, names()).into())
    }

    /// The name in programs.
    pub fn name(&self) -> &'static str {
        self.algorithm().name
    }

    /// When to take it, in a line.
    pub fn description(&self) -> &'static str {
        self.algorithm().description
    }
}

#[cfg(test)]
mod tests {
    use fairing_shapes as shapes;

    use super::*;

    /// Sums are formed in fixed units of rows: the number of threads cannot show.
    #[test]
    fn results_do_not_depend_on_the_number_of_threads() {
        // More vertices than one unit of parallel work holds.
        let mesh = shapes::bumpy_sphere(5, 0.1, 7.0);
        assert!(mesh.vertex_count() > 2 * fairing_sparse::parallel::CHUNK);
        for method in Method::defaults() {
            let run = |threads: usize| {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
                let method = match method.clone() {
                    // A few steps are enough to tell.
                    Method::ConformalizedMcf(options) => {
                        Method::ConformalizedMcf(ConformalizedMcf { iterations: 3, ..options })
                    }
                    other => other,
                };
                pool.install(|| method.run(&mesh, None).unwrap().mesh)
            };
            assert_eq!(run(1), run(3), "{}", method.name());
        }
    }

    #[test]
    fn every_method_has_a_name_and_a_description_of_its_own() {
        let methods = Method::defaults();
        assert_eq!(methods.len(), Method::algorithms().len());
        for (method, algorithm) in methods.iter().zip(Method::algorithms()) {
            assert_eq!(method.algorithm(), algorithm);
            assert_eq!(Method::by_name(method.name()).as_ref(), Ok(method));
            assert!(!method.description().is_empty(), "{}", method.name());
        }
        for (i, a) in methods.iter().enumerate() {
            assert!(methods[i + 1..].iter().all(|b| a.name() != b.name()), "{}", a.name());
        }
        let error = Method::by_name("umbrella").unwrap_err().to_string();
        assert!(error.contains("\"umbrella\"") && error.contains("mean-curvature"), "{error}");
    }

    /// The options of the functions and those of the names are the same.
    #[test]
    fn defaults_are_those_of_the_options() {
        use crate::{Diffusion, Time, Transfer};
        let mean_curvature = Implicit::mean_curvature_flow(1.0);
        let expected = [
            Method::Explicit(Explicit::new(Diffusion::uniform(0.5))),
            Method::Implicit(Implicit::new(Diffusion::uniform(5.0))),
            Method::Implicit(mean_curvature),
            Method::ConformalizedMcf(ConformalizedMcf::default()),
            Method::Taubin(Taubin::default()),
            Method::WindowedSinc(WindowedSinc::default()),
            Method::Hc(Hc::default()),
            Method::ScaleDependent(ScaleDependent::default()),
            Method::LowPass(LowPass::new(Transfer::Heat(Time::SquaredEdges(5.0)))),
            Method::FairRegion(FairRegion::new(Vec::new())),
        ];
        assert_eq!(Method::defaults(), expected);
    }

    /// Values without which another parameter has no effect.
    fn context(algorithm: &Algorithm, parameter: &str) -> Vec<(&'static str, &'static str)> {
        let mut given = Vec::new();
        if algorithm.name == "region" && parameter != "vertices" {
            given.push(("vertices", "0"));
        }
        if algorithm.parameter("weights").is_some() && ["area", "operator"].contains(&parameter) {
            given.push(("weights", "cotangent"));
        }
        if algorithm.name == "low-pass" && parameter == "order" {
            given.push(("cutoff", "1"));
        }
        given
    }

    /// The defaults of the tables are those of the options, and each parameter of a table is read.
    #[test]
    fn tables_agree_with_the_options() {
        use fairing_parameters::old::Kind;
        let mesh = shapes::icosphere(0);
        for algorithm in Method::algorithms() {
            for parameter in algorithm.parameters {
                let name = format!("{} --{}", algorithm.name, parameter.name);
                let context = context(algorithm, parameter.name);
                let with = |value: &str| {
                    let given = [&context[..], &[(parameter.name, value)]].concat();
                    Method::with(algorithm.name, &given, &mesh).unwrap()
                };
                let without = match parameter.required {
                    true => Method::by_name(algorithm.name).unwrap(),
                    false => Method::with(algorithm.name, &context, &mesh).unwrap(),
                };
                if !parameter.default.is_empty() {
                    assert_eq!(with(parameter.default), without, "{name}");
                }
                let others: Vec<&str> = match parameter.kind {
                    Kind::Number => vec!["0.037"],
                    Kind::Count => vec!["3"],
                    Kind::Vertices => vec!["5,7"],
                    Kind::Choice(choices) => {
                        let names = choices.iter().map(|choice| choice.name);
                        names.filter(|&name| name != parameter.default).collect()
                    }
                    _ => vec!["5:1,7:2:0:0:1"],
                };
                for other in others {
                    assert_ne!(with(other), without, "{name} {other}");
                }
            }
        }
    }

    #[test]
    fn values_that_do_not_fit_are_refused() {
        let mesh = shapes::icosphere(0);
        for (name, given, said) in [
            ("hc", &[("lambda", "2")][..], "hc has no parameter \"lambda\"; it has alpha"),
            ("taubin", &[("mu", "-0.6"), ("pass-band", "0.1")], "give mu or pass-band"),
            ("implicit", &[("weights", "uniform"), ("time", "2")], "left out with weights uniform"),
            ("explicit", &[("area", "mixed")], "left out with weights uniform"),
            ("region", &[("vertices", "1"), ("weights", "uniform"), ("area", "mixed")], "uniform"),
            ("conformal", &[("operator", "newest")], "one of auto, cotangent, robust"),
            ("low-pass", &[("operator", "robust"), ("area", "mixed")], "with operator robust"),
            ("low-pass", &[("order", "3")], "left out without cutoff"),
            ("implicit", &[("soft", "12:1")], "vertex 12 of 12 does not"),
            ("region", &[], "region needs vertices"),
            ("low-pass", &[("cutoff", "1"), ("order", "9999999999")], "order is \"9999999999\""),
        ] {
            let error = Method::with(name, given, &mesh).unwrap_err().to_string();
            assert!(error.contains(said), "{error}");
        }
        let soft = Method::with("hc", &[("soft", "3:2")], &mesh).unwrap();
        let Method::Hc(options) = soft else { panic!("another method") };
        assert_eq!(options.constraints.soft[0].target, mesh.positions()[3]);
    }
}
