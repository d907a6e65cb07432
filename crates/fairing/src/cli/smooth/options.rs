//! The options of `fairing smooth` by name, and the methods that they make.

use clap::ValueEnum;
use fairing::mesh::TriMesh;
use fairing::operators::LumpedArea;
use fairing::smoothing::{
    Boundary, ConformalizedMcf, Constraints, Diffusion, Explicit, FairRegion, FairingWeights, Hc,
    Implicit, LowPass, Method, Operator, ScaleDependent, SoftConstraint, Stability, Taubin, Time,
    Transfer, Update, Volume, Window, WindowedSinc,
};

use super::Smooth;
use crate::cli::exit::Failure;

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(super) enum Name {
    Explicit,
    Implicit,
    MeanCurvature,
    Conformal,
    Taubin,
    WindowedSinc,
    Hc,
    ScaleDependent,
    LowPass,
    Region,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(super) enum Weights {
    /// Every neighbour counts the same
    Uniform,
    /// The Laplace–Beltrami operator
    Cotangent,
}

#[derive(Clone, Copy, ValueEnum)]
pub(super) enum Area {
    /// A third of the faces around
    Barycentric,
    /// Voronoi cells, kept inside obtuse faces
    Mixed,
    /// Voronoi cells; may be negative at obtuse angles, which is refused
    Voronoi,
}

#[derive(Clone, Copy, ValueEnum)]
pub(super) enum Border {
    /// It moves inward as its neighbours pull
    Free,
    /// It stays
    Pinned,
    /// It moves along its own curve
    Sliding,
}

#[derive(Clone, Copy, ValueEnum)]
pub(super) enum Keep {
    /// It goes where the flow takes it
    Drift,
    /// Kept by scaling about the centroid in each step
    Rescale,
    /// Kept by an offset along the normals in each step
    Offset,
}

#[derive(Clone, Copy, ValueEnum)]
pub(super) enum Unstable {
    /// They are an error
    Refuse,
    /// They are taken, with a warning
    Warn,
    /// They are taken
    Allow,
}

#[derive(Clone, Copy, ValueEnum)]
pub(super) enum WindowName {
    Hanning,
    Hamming,
    Blackman,
}

#[derive(Clone, Copy, ValueEnum)]
pub(super) enum When {
    /// The operator of the input
    Never,
    /// Areas of the current mesh, stiffness of the input
    Mass,
    /// All of the current mesh
    Both,
}

impl Smooth {
    /// Refuses options that the method does not have.
    pub(super) fn check(&self) -> Result<(), Failure> {
        use Name::{
            Conformal, Explicit, Hc, Implicit, LowPass, MeanCurvature, Region, ScaleDependent,
            Taubin, WindowedSinc,
        };
        let stepping = [Explicit, Implicit, MeanCurvature, Taubin, Hc, ScaleDependent];
        let constrained =
            [Explicit, Implicit, MeanCurvature, Taubin, Hc, ScaleDependent, LowPass, WindowedSinc];
        let given: [(&str, bool, &[Name]); 25] = [
            ("--weights", self.weights.is_some(), &[Explicit, Implicit, Region]),
            ("--lambda", self.lambda.is_some(), &[Explicit, Implicit, MeanCurvature, Taubin]),
            (
                "--time",
                self.time.is_some(),
                &[Explicit, Implicit, MeanCurvature, LowPass, Conformal],
            ),
            (
                "--iterations",
                self.iterations.is_some(),
                &[Explicit, Implicit, MeanCurvature, Taubin, Hc, ScaleDependent, Conformal],
            ),
            ("--area", self.area.is_some(), &[Explicit, Implicit, MeanCurvature, LowPass, Region]),
            ("--boundary", self.boundary.is_some(), &constrained),
            ("--pin", !self.pin.is_empty(), &constrained),
            ("--soft", !self.soft.is_empty(), &stepping),
            (
                "--operator",
                self.operator.is_some(),
                &[Explicit, Implicit, MeanCurvature, Conformal, LowPass, Region],
            ),
            ("--modes", self.modes.is_some(), &[LowPass]),
            ("--update", self.update.is_some(), &[Implicit]),
            ("--settled", self.settled.is_some(), &[Conformal]),
            (
                "--until",
                self.until.is_some(),
                &[Explicit, Implicit, MeanCurvature, Taubin, Hc, ScaleDependent, Conformal],
            ),
            ("--volume", self.volume.is_some(), &[Explicit, Implicit, MeanCurvature]),
            ("--unstable", self.unstable.is_some(), &[Explicit, Taubin]),
            ("--mu", self.mu.is_some(), &[Taubin]),
            ("--pass-band", self.pass_band.is_some(), &[Taubin, WindowedSinc]),
            ("--degree", self.degree.is_some(), &[WindowedSinc]),
            ("--window", self.window.is_some(), &[WindowedSinc]),
            ("--alpha or --beta", self.alpha.is_some() || self.beta.is_some(), &[Hc]),
            ("--fraction", self.fraction.is_some(), &[ScaleDependent]),
            ("--cutoff", self.cutoff.is_some(), &[LowPass]),
            ("--order", self.order.is_some(), &[Region, LowPass]),
            ("--vertices", !self.vertices.is_empty(), &[Region]),
            ("--tolerance", self.tolerance.is_some(), &[Implicit, MeanCurvature, Conformal]),
        ];
        let foreign =
            given.iter().find(|(_, given, methods)| *given && !methods.contains(&self.method));
        if let Some((option, ..)) = foreign {
            let method = self.method.to_possible_value();
            let method = method.as_ref().map_or("", |value| value.get_name());
            return Err(Failure::usage(format_args!("the method {method} has no {option}")));
        }
        Ok(())
    }

    /// The method with its options, over this operator where it takes cotangents.
    pub(super) fn method(&self, mesh: &TriMesh, operator: Operator) -> Result<Method, Failure> {
        let constraints = self.constraints(mesh)?;
        let volume = match self.volume {
            None | Some(Keep::Drift) => Volume::Drifts,
            Some(Keep::Rescale) => Volume::Rescaled,
            Some(Keep::Offset) => Volume::Offset,
        };
        let n = self.iterations;
        Ok(match self.method {
            Name::Explicit => Method::Explicit(Explicit {
                iterations: n.unwrap_or(10),
                stability: self.stability(),
                constraints,
                volume,
                ..Explicit::new(self.diffusion(0.5, 0.1, operator)?)
            }),
            Name::Implicit | Name::MeanCurvature => {
                let flows = self.method == Name::MeanCurvature;
                let diffusion = match flows {
                    true => self.cotangents(1.0, operator),
                    false => self.diffusion(5.0, 5.0, operator)?,
                };
                let options = Implicit::new(diffusion);
                Method::Implicit(Implicit {
                    iterations: n.unwrap_or(10),
                    update: match self.update {
                        _ if flows => Update::Both,
                        None | Some(When::Never) => Update::Never,
                        Some(When::Mass) => Update::Mass,
                        Some(When::Both) => Update::Both,
                    },
                    tolerance: self.tolerance.unwrap_or(options.tolerance),
                    constraints,
                    volume,
                    ..options
                })
            }
            Name::Conformal => {
                let options = ConformalizedMcf::default();
                Method::ConformalizedMcf(ConformalizedMcf {
                    time: self.time.unwrap_or(options.time),
                    iterations: n.unwrap_or(options.iterations),
                    tolerance: self.tolerance.unwrap_or(options.tolerance),
                    settled: self.settled.unwrap_or(options.settled),
                    operator,
                })
            }
            Name::Taubin => {
                let options = Taubin::default();
                let lambda = self.lambda.unwrap_or(options.lambda);
                let options = match (self.mu, self.pass_band) {
                    (Some(mu), _) => Taubin::from_steps(lambda, mu),
                    (None, band) => Taubin::new(lambda, band.unwrap_or(options.pass_band)),
                };
                let (pairs, stability) = (n.unwrap_or(10), self.stability());
                Method::Taubin(Taubin { pairs, stability, constraints, ..options })
            }
            Name::WindowedSinc => {
                let options = WindowedSinc::default();
                Method::WindowedSinc(WindowedSinc {
                    pass_band: self.pass_band.unwrap_or(options.pass_band),
                    degree: self.degree.unwrap_or(options.degree),
                    window: match self.window {
                        Some(WindowName::Hanning) => Window::Hanning,
                        None | Some(WindowName::Hamming) => Window::Hamming,
                        Some(WindowName::Blackman) => Window::Blackman,
                    },
                    constraints,
                })
            }
            Name::Hc => {
                let options = Hc::default();
                Method::Hc(Hc {
                    alpha: self.alpha.unwrap_or(options.alpha),
                    beta: self.beta.unwrap_or(options.beta),
                    iterations: n.unwrap_or(options.iterations),
                    constraints,
                })
            }
            Name::ScaleDependent => {
                let options = ScaleDependent::default();
                Method::ScaleDependent(ScaleDependent {
                    fraction: self.fraction.unwrap_or(options.fraction),
                    iterations: n.unwrap_or(options.iterations),
                    constraints,
                })
            }
            Name::LowPass => {
                let transfer = match (self.time, self.cutoff) {
                    _ if self.modes.is_some() => Transfer::Modes(self.modes.unwrap_or(0)),
                    (Some(time), _) => Transfer::Heat(Time::SquaredUnits(time)),
                    (None, Some(wavelength)) => Transfer::Butterworth {
                        cutoff: (2.0 * std::f64::consts::PI / wavelength).powi(2),
                        order: self.order.unwrap_or(2),
                    },
                    (None, None) => Transfer::Heat(Time::SquaredEdges(5.0)),
                };
                Method::LowPass(LowPass { operator, constraints, ..LowPass::new(transfer) })
            }
            Name::Region => {
                if self.vertices.is_empty() {
                    return Err(Failure::usage("which region? say --vertices LIST"));
                }
                Method::FairRegion(FairRegion {
                    region: self.vertices.clone(),
                    order: self.order.unwrap_or(2),
                    weights: match self.weights {
                        Some(Weights::Uniform) => FairingWeights::Uniform,
                        _ => FairingWeights::Cotangent(operator),
                    },
                })
            }
        })
    }

    fn stability(&self) -> Stability {
        match self.unstable {
            None | Some(Unstable::Refuse) => Stability::Refuse,
            Some(Unstable::Warn) => Stability::Warn,
            Some(Unstable::Allow) => Stability::Allow,
        }
    }

    fn constraints(&self, mesh: &TriMesh) -> Result<Constraints, Failure> {
        let boundary = match self.boundary {
            None | Some(Border::Free) => Boundary::Free,
            Some(Border::Pinned) => Boundary::Pinned,
            Some(Border::Sliding) => Boundary::Sliding,
        };
        let soft = self.soft.iter().map(|&Soft { vertex, weight, target }| {
            let here = mesh.positions().get(vertex as usize).copied();
            let Some(here) = here else {
                let n = mesh.vertex_count();
                return Err(Failure::usage(format_args!(
                    "--soft names vertex {vertex}, but there are {n} vertices"
                )));
            };
            Ok(SoftConstraint { vertex, target: target.unwrap_or(here), weight })
        });
        let soft = soft.collect::<Result<_, _>>()?;
        Ok(Constraints { boundary, pinned: self.pin.clone(), soft })
    }

    /// The diffusion with its default steps for either weights.
    fn diffusion(
        &self,
        uniform: f64,
        cotangent: f64,
        operator: Operator,
    ) -> Result<Diffusion, Failure> {
        let weights = self.weights.unwrap_or(match self.time {
            Some(_) => Weights::Cotangent,
            None => Weights::Uniform,
        });
        if weights == Weights::Cotangent {
            return Ok(self.cotangents(cotangent, operator));
        }
        if self.time.is_some() {
            return Err(Failure::usage("uniform weights have no --time, only --lambda"));
        }
        Ok(Diffusion::uniform(self.lambda.unwrap_or(uniform)))
    }

    fn cotangents(&self, lambda: f64, operator: Operator) -> Diffusion {
        let time = match self.time {
            Some(time) => Time::SquaredUnits(time),
            None => Time::SquaredEdges(self.lambda.unwrap_or(lambda)),
        };
        Diffusion::Cotangent { time, operator }
    }

    /// The areas of vertices for cotangents.
    pub(super) fn area(&self) -> LumpedArea {
        match self.area {
            None | Some(Area::Barycentric) => LumpedArea::Barycentric,
            Some(Area::Mixed) => LumpedArea::Mixed,
            Some(Area::Voronoi) => LumpedArea::Voronoi,
        }
    }
}

/// A soft constraint of `--soft`: a vertex, a weight, and where to, if it is not where it is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Soft {
    vertex: u32,
    weight: f64,
    target: Option<[f64; 3]>,
}

impl std::str::FromStr for Soft {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = || format!("{text} is not VERTEX:WEIGHT or VERTEX:WEIGHT:X:Y:Z");
        let mut parts = text.split(':');
        let vertex = parts.next().and_then(|v| v.parse().ok()).ok_or_else(wrong)?;
        let numbers: Vec<f64> =
            parts.map(|x| x.parse().map_err(|_| wrong())).collect::<Result<_, _>>()?;
        match numbers[..] {
            [weight] => Ok(Self { vertex, weight, target: None }),
            [weight, x, y, z] => Ok(Self { vertex, weight, target: Some([x, y, z]) }),
            _ => Err(wrong()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn soft_constraints_are_read() {
        let here: Soft = "7:0.5".parse().unwrap();
        assert_eq!(here, Soft { vertex: 7, weight: 0.5, target: None });
        let there: Soft = "7:2:1:-2:3e-1".parse().unwrap();
        assert_eq!(there, Soft { vertex: 7, weight: 2.0, target: Some([1.0, -2.0, 0.3]) });
        for text in ["", "7", "-1:2", "7:2:1", "7:2:1:2", "7:2:1:2:3:4", "7:x"] {
            assert!(text.parse::<Soft>().is_err(), "{text}");
        }
    }
}
