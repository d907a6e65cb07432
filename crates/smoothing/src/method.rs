//! All flows in one type.

use fairing_mesh::TriMesh;

use crate::engine::error::FlowError;
use crate::engine::outcome::Smoothed;
use crate::engine::run::Observer;
use crate::flows::conformal::{ConformalizedMcf, conformalized_mean_curvature_flow};
use crate::flows::explicit::{Explicit, explicit};
use crate::flows::hc::{Hc, hc};
use crate::flows::implicit::{Implicit, implicit};
use crate::flows::low_pass::{LowPass, low_pass};
use crate::flows::region::{FairRegion, fair_region};
use crate::flows::scale_dependent::{ScaleDependent, scale_dependent};
use crate::flows::taubin::{Taubin, taubin};
use crate::flows::windowed_sinc::{WindowedSinc, windowed_sinc};

fairing_parameters::algorithms! {
    /// A flow, with its options.
    ///
    /// # Examples
    ///
    /// ```
    /// use fairing_shapes as shapes;
    /// use fairing_smoothing::Method;
    ///
    /// let sphere = shapes::icosphere(4);
    /// for method in Method::all() {
    ///     let smoothed = method.run(&sphere, None)?;
    ///     println!("{}: {} steps", method.name(), smoothed.report.iterations);
    /// }
    /// let taubin = Method::with("taubin", &[("lambda", "0.3"), ("iterations", "5")])?;
    /// assert_eq!(taubin.run(&sphere, None)?.report.iterations, 10);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[derive(Debug, Clone, PartialEq)]
    #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
    #[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
    #[non_exhaustive]
    pub enum Method("method") {
        /// [`explicit`]
        Explicit(Explicit) => explicit,
        /// [`implicit`]; mean curvature flow if the operator is updated.
        Implicit(Implicit) => implicit,
        /// [`conformalized_mean_curvature_flow`]
        ConformalizedMcf(ConformalizedMcf) => conformalized_mean_curvature_flow,
        /// [`taubin`]
        Taubin(Taubin) => taubin,
        /// [`windowed_sinc`]
        WindowedSinc(WindowedSinc) => |mesh, options, _| windowed_sinc(mesh, options),
        /// [`hc`]
        Hc(Hc) => hc,
        /// [`scale_dependent`]
        ScaleDependent(ScaleDependent) => scale_dependent,
        /// [`low_pass`]
        LowPass(LowPass) => |mesh, options, _| low_pass(mesh, options),
        /// [`fair_region`]
        FairRegion(FairRegion) => |mesh, options, _| fair_region(mesh, options),
    }

    /// Runs the flow. An observer sees every step of flows that take steps; filters and region
    /// fairing take none and are not observed.
    ///
    /// # Errors
    ///
    /// The errors of the function of the flow.
    pub fn run(
        mesh: &TriMesh,
        observer: Option<&mut Observer<'_>>
    ) -> Result<Smoothed, FlowError>;
}

#[cfg(test)]
mod tests {
    use fairing_shapes as shapes;

    use super::*;

    /// Sums are formed over fixed chunks of rows, whatever the number of threads.
    #[test]
    fn results_do_not_depend_on_the_number_of_threads() {
        // More vertices than two chunks.
        let mesh = shapes::bumpy_sphere(5, 0.1, 7.0);
        assert!(mesh.vertex_count() > 2 * fairing_sparse::parallel::CHUNK);
        for method in Method::all() {
            let run = |threads: usize| {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
                let method = match method.clone() {
                    // A few steps suffice.
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
        let methods = Method::all();
        for method in &methods {
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
        for expected in [
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
        ] {
            assert!(Method::all().contains(&expected), "{expected:?}");
        }
    }

    #[test]
    fn defaults_are_shown() {
        let shown = |name: &str, parameter: &str| {
            let algorithm = Method::by_name(name).unwrap().algorithm();
            algorithm.parameter(parameter).map(|parameter| parameter.default_text())
        };
        for (name, parameter, default) in [
            ("explicit", "lambda", "0.5"),
            ("implicit", "lambda", "5"),
            ("mean-curvature", "lambda", "1"),
            ("implicit", "weights", "uniform"),
            ("region", "weights", "cotangent"),
            ("implicit", "tolerance", "1e-8"),
            ("taubin", "iterations", "10"),
            ("low-pass", "order", "2"),
            ("low-pass", "time", ""),
        ] {
            assert_eq!(shown(name, parameter).as_deref(), Some(default), "{name} {parameter}");
        }
        for (name, parameter) in
            [("mean-curvature", "weights"), ("mean-curvature", "update"), ("low-pass", "soft")]
        {
            assert_eq!(shown(name, parameter), None);
        }
    }

    #[test]
    fn values_are_read() {
        use crate::{Diffusion, Time, Transfer};
        let with = |name: &str, given: &[(&str, &str)]| Method::with(name, given).unwrap();
        let explicit = |diffusion| Method::Explicit(Explicit::new(diffusion));
        assert_eq!(
            with("explicit", &[("weights", "cotangent")]),
            explicit(Diffusion::cotangent(0.1))
        );
        assert_eq!(with("explicit", &[("lambda", "0.3")]), explicit(Diffusion::uniform(0.3)));
        let Method::Implicit(timed) = with("implicit", &[("time", "2")]) else { panic!() };
        assert!(matches!(
            timed.diffusion,
            Diffusion::Cotangent { time: Time::SquaredUnits(2.0), .. }
        ));
        let mean = Implicit { iterations: 3, ..Implicit::mean_curvature_flow(2.0) };
        let given = [("lambda", "2"), ("iterations", "3")];
        assert_eq!(with("mean-curvature", &given), Method::Implicit(mean));
        let steps = Taubin { pairs: 4, ..Taubin::from_steps(0.4, -0.45) };
        let given = [("mu", "-0.45"), ("lambda", "0.4"), ("iterations", "4")];
        assert_eq!(with("taubin", &given), Method::Taubin(steps));
        let modes = LowPass::new(Transfer::Modes(4));
        assert_eq!(with("low-pass", &[("modes", "4")]), Method::LowPass(modes));
    }

    #[test]
    fn values_that_do_not_fit_are_refused() {
        for (name, given, said) in [
            ("hc", &[("lambda", "2")][..], "hc has no parameter \"lambda\"; it has alpha"),
            ("taubin", &[("mu", "-0.6"), ("pass-band", "0.1")], "give mu or pass-band"),
            ("implicit", &[("weights", "uniform"), ("time", "2")], "left out with weights uniform"),
            ("explicit", &[("area", "mixed")], "left out with weights uniform"),
            ("region", &[("vertices", "1"), ("weights", "uniform"), ("area", "mixed")], "uniform"),
            ("conformal", &[("operator", "newest")], "one of auto, cotangent, robust"),
            ("low-pass", &[("operator", "robust"), ("area", "mixed")], "with operator robust"),
            ("low-pass", &[("order", "3")], "left out without cutoff"),
            ("region", &[], "region needs vertices"),
            (
                "low-pass",
                &[("cutoff", "1"), ("order", "9999999999")],
                "order is 9999999999, but must be between 1 and 16",
            ),
        ] {
            let error = Method::with(name, given).unwrap_err().to_string();
            assert!(error.contains(said), "{error}");
        }
        let soft = Method::with("hc", &[("soft", "3:2")]).unwrap();
        let Method::Hc(options) = soft else { panic!("another method") };
        assert_eq!(options.constraints.soft[0].target, None);
    }
}
