//! `fairing smooth`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use fairing::mesh::TriMesh;
use fairing::operators::LumpedArea;
use fairing::smoothing::{
    Approach, Boundary, ConformalizedMcf, Constraints, Diffusion, Explicit, FairRegion,
    FairingWeights, FlowFailure, Hc, Implicit, LowPass, Method, ScaleDependent, Smoothed,
    Stability, Taubin, Time, Transfer, Update, Volume, Window, WindowedSinc,
};
use serde_json::json;

use super::exit::Failure;
use super::files::{self, Output};
use super::table::{Table, number};
use super::{Context, print};

const HELP: &str = "\
Which method?
  Noise, and the size must stay     taubin (the default), or windowed-sinc: sharper
  The assignment's questions 5, 6   explicit --lambda L, implicit --lambda L
  Very smooth, in few steps         implicit --lambda 50 --iterations 3
  A physical amount of smoothing    low-pass --time T: exact heat diffusion, or --cutoff W
  Triangles of very uneven size     implicit --weights cotangent, or scale-dependent
  Even out the triangles as well    implicit --weights uniform
  A sphere out of a closed blob     conformal
  A dent, a filled hole             region --vertices LIST --order 2
  Sharp edges must survive          none of these: fairing denoise

The step --lambda is, for uniform weights, a fraction of the way to the mean of the
neighbours: explicit steps are stable up to 4/3 (8/7 with a boundary), implicit ones
always. For cotangents it is a diffusion time in squared mean edge lengths; explicit
ones are stable up to about 0.27 on even meshes. Instead, --time gives it in squared
units of the file. n steps of L smooth about as much as one of n L.

Examples:
  fairing smooth scan.ply -o smooth.ply
  fairing smooth scan.ply -o smooth.ply --method implicit --lambda 5 --volume rescale
  fairing smooth patch.obj -o flat.obj --method explicit --lambda 0.5 --boundary pinned
  fairing smooth noisy.off -o worse.off --method explicit --lambda 2 --unstable allow";

/// Smooth a mesh by a flow, a filter or the fairing of a region
///
/// Vertices move, faces stay; other properties of the vertices are kept, normals
/// are not, since they no longer fit. See below for which method to take.
#[derive(Args)]
#[command(after_help = HELP)]
pub(crate) struct Smooth {
    /// The mesh
    #[arg(required_unless_present = "list")]
    input: Option<PathBuf>,
    #[command(flatten)]
    output: MaybeOutput,
    /// The method; --list says what each is for
    #[arg(long, value_enum, default_value = "taubin")]
    method: Name,
    /// The weights of the Laplacian; uniform unless said, for explicit, implicit and region
    #[arg(long, value_enum)]
    weights: Option<Weights>,
    /// The step: dimensionless, or in squared mean edge lengths for cotangents
    #[arg(long, value_name = "L", allow_negative_numbers = true)]
    lambda: Option<f64>,
    /// The step of cotangents in squared units of the file; the time of low-pass
    #[arg(long, value_name = "T", conflicts_with = "lambda", allow_negative_numbers = true)]
    time: Option<f64>,
    /// The number of steps; pairs of steps for taubin
    #[arg(long, value_name = "N")]
    iterations: Option<usize>,
    /// The areas of vertices for cotangents; barycentric unless said
    #[arg(long, value_enum)]
    area: Option<Area>,
    /// What happens at the boundary of an open mesh; free unless said
    #[arg(long, value_enum)]
    boundary: Option<Border>,
    /// Vertices that stay, as numbers from 0 joined by commas
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    pin: Vec<u32>,
    /// What happens to the volume of a closed mesh; it drifts unless said
    #[arg(long, value_enum)]
    volume: Option<Keep>,
    /// What happens to explicit steps beyond the stable limit; refused unless said
    #[arg(long, value_enum)]
    unstable: Option<Unstable>,
    /// The growing step of taubin, below -lambda
    #[arg(long, value_name = "M", allow_negative_numbers = true)]
    mu: Option<f64>,
    /// taubin, windowed-sinc: modes with -eigenvalue below this are kept (0 to 2)
    #[arg(long, value_name = "K", conflicts_with = "mu")]
    pass_band: Option<f64>,
    /// windowed-sinc: the degree of the filter
    #[arg(long, value_name = "N")]
    degree: Option<usize>,
    /// windowed-sinc: the window
    #[arg(long, value_enum)]
    window: Option<WindowName>,
    /// hc: how much differences are taken to the input (0 to 1)
    #[arg(long, value_name = "A")]
    alpha: Option<f64>,
    /// hc: how much of its own difference a vertex is given back (0 to 1)
    #[arg(long, value_name = "B")]
    beta: Option<f64>,
    /// scale-dependent: the fraction of the largest stable step (0 to 1)
    #[arg(long, value_name = "F")]
    fraction: Option<f64>,
    /// low-pass: where a Butterworth filter halves, a wavelength in units of the file
    #[arg(long, value_name = "W", conflicts_with = "time")]
    cutoff: Option<f64>,
    /// region: 1 soap film, 2 thin plate, 3 least variation of curvature; low-pass:
    /// how steeply a Butterworth filter falls
    #[arg(long, value_name = "K")]
    order: Option<u32>,
    /// region: the vertices to replace, as numbers from 0 joined by commas
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    vertices: Vec<u32>,
    /// implicit: when the operator is taken anew; never unless said
    #[arg(long, value_enum)]
    update: Option<When>,
    /// implicit, conformal: the relative residual of the linear systems
    #[arg(long, value_name = "R")]
    tolerance: Option<f64>,
    /// Print what was done as one JSON object
    #[arg(long)]
    json: bool,
    /// List the methods and what each is for
    #[arg(long, exclusive = true)]
    list: bool,
}

/// As [`Output`], but absent with `--list`.
#[derive(Args)]
struct MaybeOutput {
    /// The file to write
    #[arg(short = 'o', long = "output", value_name = "FILE", required_unless_present = "list")]
    path: Option<PathBuf>,
    #[command(flatten)]
    overwrite: files::Overwrite,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Name {
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
enum Weights {
    /// Every neighbour counts the same
    Uniform,
    /// The Laplace–Beltrami operator
    Cotangent,
}

#[derive(Clone, Copy, ValueEnum)]
enum Area {
    /// A third of the faces around
    Barycentric,
    /// Voronoi cells, kept inside obtuse faces
    Mixed,
    /// Voronoi cells; may be negative at obtuse angles, which is refused
    Voronoi,
}

#[derive(Clone, Copy, ValueEnum)]
enum Border {
    /// It moves inward as its neighbours pull
    Free,
    /// It stays
    Pinned,
    /// It moves along its own curve
    Sliding,
}

#[derive(Clone, Copy, ValueEnum)]
enum Keep {
    /// It goes where the flow takes it
    Drift,
    /// Kept by scaling about the centroid in each step
    Rescale,
    /// Kept by an offset along the normals in each step
    Offset,
}

#[derive(Clone, Copy, ValueEnum)]
enum Unstable {
    /// They are an error
    Refuse,
    /// They are taken, with a warning
    Warn,
    /// They are taken
    Allow,
}

#[derive(Clone, Copy, ValueEnum)]
enum WindowName {
    Hanning,
    Hamming,
    Blackman,
}

#[derive(Clone, Copy, ValueEnum)]
enum When {
    /// The operator of the input
    Never,
    /// Areas of the current mesh, stiffness of the input
    Mass,
    /// All of the current mesh
    Both,
}

impl Smooth {
    pub(crate) fn run(&self, context: &Context) -> Result<(), Failure> {
        if self.list {
            return print(list());
        }
        let (Some(input), Some(path)) = (&self.input, &self.output.path) else {
            return Err(Failure::usage("which mesh, and where to?"));
        };
        self.output.overwrite.check(path)?;
        self.check()?;
        let method = self.method()?;
        let file = files::read(input)?;
        files::say_report(context, input, &file.report);
        let smoothed = method.run(&file.mesh, None).map_err(|error| match error.failure {
            FlowFailure::InvalidOption { .. } | FlowFailure::Unsupported { .. } => {
                Failure::usage(error.failure)
            }
            _ => Failure::from(error),
        })?;
        let warns = matches!(self.unstable, Some(Unstable::Warn));
        if let (true, Some(limit)) =
            (smoothed.report.unstable && warns, smoothed.report.stable_limit)
        {
            context.note(format_args!(
                "warning: the step is beyond the stable limit {}; some modes grew",
                number(limit)
            ));
        }
        self.summarise(context, &method, &file.mesh, &smoothed)?;
        let output = Output {
            path: path.clone(),
            overwrite: files::Overwrite { force: self.output.overwrite.force },
        };
        files::write_moved(context, &output, &smoothed.mesh, file.fields)
    }

    /// Refuses options that the method does not have.
    fn check(&self) -> Result<(), Failure> {
        use Name::{
            Conformal, Explicit, Hc, Implicit, LowPass, MeanCurvature, Region, ScaleDependent,
            Taubin, WindowedSinc,
        };
        let stepping = [Explicit, Implicit, MeanCurvature, Taubin, Hc, ScaleDependent];
        let given: [(&str, bool, &[Name]); 19] = [
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
            (
                "--boundary",
                self.boundary.is_some(),
                &[
                    Explicit,
                    Implicit,
                    MeanCurvature,
                    Taubin,
                    Hc,
                    ScaleDependent,
                    LowPass,
                    WindowedSinc,
                ],
            ),
            ("--pin", !self.pin.is_empty(), &stepping),
            ("--volume", self.volume.is_some(), &[Explicit, Implicit, MeanCurvature]),
            ("--unstable", self.unstable.is_some(), &[Explicit]),
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
        if self.update.is_some() && self.method != Implicit {
            return Err(Failure::usage("--update belongs to the method implicit"));
        }
        Ok(())
    }

    /// The method with its options.
    fn method(&self) -> Result<Method, Failure> {
        let constraints = self.constraints();
        let volume = match self.volume {
            None | Some(Keep::Drift) => Volume::Drifts,
            Some(Keep::Rescale) => Volume::Rescaled,
            Some(Keep::Offset) => Volume::Offset,
        };
        let n = self.iterations;
        Ok(match self.method {
            Name::Explicit => Method::Explicit(Explicit {
                iterations: n.unwrap_or(10),
                stability: match self.unstable {
                    None | Some(Unstable::Refuse) => Stability::Refuse,
                    Some(Unstable::Warn) => Stability::Warn,
                    Some(Unstable::Allow) => Stability::Allow,
                },
                constraints,
                volume,
                ..Explicit::new(self.diffusion(0.5, 0.1)?)
            }),
            Name::Implicit | Name::MeanCurvature => {
                let flows = self.method == Name::MeanCurvature;
                let diffusion =
                    if flows { self.cotangents(1.0) } else { self.diffusion(5.0, 5.0)? };
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
                    ..options
                })
            }
            Name::Taubin => {
                let options = Taubin::default();
                let lambda = self.lambda.unwrap_or(options.lambda);
                let options = match (self.mu, self.pass_band) {
                    (Some(mu), _) => Taubin::from_steps(lambda, mu),
                    (None, band) => Taubin::new(lambda, band.unwrap_or(options.pass_band)),
                };
                Method::Taubin(Taubin { pairs: n.unwrap_or(10), constraints, ..options })
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
                    (Some(time), _) => Transfer::Heat(Time::SquaredUnits(time)),
                    (None, Some(wavelength)) => Transfer::Butterworth {
                        cutoff: (2.0 * std::f64::consts::PI / wavelength).powi(2),
                        order: self.order.unwrap_or(2),
                    },
                    (None, None) => Transfer::Heat(Time::SquaredEdges(5.0)),
                };
                Method::LowPass(LowPass {
                    area: self.area(),
                    constraints,
                    ..LowPass::new(transfer)
                })
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
                        _ => FairingWeights::Cotangent(self.area()),
                    },
                })
            }
        })
    }

    fn constraints(&self) -> Constraints {
        let boundary = match self.boundary {
            None | Some(Border::Free) => Boundary::Free,
            Some(Border::Pinned) => Boundary::Pinned,
            Some(Border::Sliding) => Boundary::Sliding,
        };
        Constraints { pinned: self.pin.clone(), ..Constraints::boundary(boundary) }
    }

    /// The diffusion with its default steps for either weights.
    fn diffusion(&self, uniform: f64, cotangent: f64) -> Result<Diffusion, Failure> {
        let weights = self.weights.unwrap_or(match self.time {
            Some(_) => Weights::Cotangent,
            None => Weights::Uniform,
        });
        if weights == Weights::Cotangent {
            return Ok(self.cotangents(cotangent));
        }
        if self.time.is_some() {
            return Err(Failure::usage("uniform weights have no --time, only --lambda"));
        }
        Ok(Diffusion::uniform(self.lambda.unwrap_or(uniform)))
    }

    fn cotangents(&self, lambda: f64) -> Diffusion {
        let time = match self.time {
            Some(time) => Time::SquaredUnits(time),
            None => Time::SquaredEdges(self.lambda.unwrap_or(lambda)),
        };
        Diffusion::Cotangent { time, area: self.area() }
    }

    fn area(&self) -> LumpedArea {
        match self.area {
            None | Some(Area::Barycentric) => LumpedArea::Barycentric,
            Some(Area::Mixed) => LumpedArea::Mixed,
            Some(Area::Voronoi) => LumpedArea::Voronoi,
        }
    }

    /// Says what was done.
    fn summarise(
        &self,
        context: &Context,
        method: &Method,
        before: &TriMesh,
        smoothed: &Smoothed,
    ) -> Result<(), Failure> {
        let (report, after) = (&smoothed.report, &smoothed.mesh);
        let change = |old: f64, new: f64| (old != 0.0).then(|| 100.0 * (new / old - 1.0));
        let closed = before.topology().is_closed();
        let volume =
            if closed { change(before.signed_volume(), after.signed_volume()) } else { None };
        let area = change(before.area(), after.area());
        let farthest = before
            .positions()
            .iter()
            .zip(after.positions())
            .map(|(&p, &q)| fairing::mesh::vec3::distance(p, q))
            .fold(0.0, f64::max);
        if self.json {
            let summary = json!({
                "method": method.name(),
                "iterations": report.iterations,
                "stopped": report.stopped,
                "stable_limit": report.stable_limit,
                "unstable": report.unstable,
                "computed_by": approach(report.approach),
                "worst_residual": report.worst_residual,
                "volume_change_percent": volume,
                "area_change_percent": area,
                "largest_displacement": farthest,
            });
            return print(format_args!("{summary:#}\n"));
        }
        let mut table = Table::new();
        let percent = |x: Option<f64>| x.map_or("-".to_owned(), |x| format!("{} %", number(x)));
        table.row(["method".into(), method.name().into()]);
        table.row(["iterations".into(), report.iterations.to_string()]);
        table.row(["computed by".into(), approach(report.approach)]);
        table.row(["largest displacement".into(), number(farthest)]);
        table.row(["volume".into(), percent(volume)]);
        table.row(["area".into(), percent(area)]);
        context.note(table.to_string().trim_end());
        Ok(())
    }
}

/// How the steps were computed, in words.
fn approach(approach: Approach) -> String {
    match approach {
        Approach::Stepping => "steps".into(),
        Approach::Series { degree } => format!("series of degree {degree}"),
        Approach::ConjugateGradients { iterations } => {
            format!("conjugate gradients, {iterations} iterations")
        }
        Approach::Cholesky { factorisations } => format!("Cholesky, {factorisations} factors"),
    }
}

/// The methods and what each is for.
fn list() -> Table {
    let mut table = Table::new();
    for method in Method::defaults() {
        table.row([format!("{}: {}", method.name(), method.description())]);
    }
    table
}
