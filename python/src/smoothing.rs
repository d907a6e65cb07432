//! Flows, filters and the fairing of regions.

use fairing_mesh::TriMesh;
use fairing_operators::LumpedArea;
use fairing_smoothing::{
    Approach, Boundary, ConformalizedMcf, Constraints, Diffusion, Explicit, FairRegion,
    FairingWeights, Hc, Implicit, LowPass, Method, Operator, Report, ScaleDependent, Smoothed,
    SoftConstraint, Stability, Taubin, Time, Transfer, Update, Volume, Window, WindowedSinc,
};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::error::{Error, Result};
use crate::mesh::Mesh;
use crate::options::choose;
use crate::run::Call;

/// A vertex, its weight, and the position that it is drawn to if it is not its own.
type SoftVertex = (u32, f64, Option<[f64; 3]>);

/// The options of all methods; those that are not given are `None`.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
struct Options {
    weights: Option<String>,
    lam: Option<f64>,
    time: Option<f64>,
    iterations: Option<usize>,
    area: Option<String>,
    kind: Option<String>,
    boundary: Option<String>,
    pin: Option<Vec<u32>>,
    soft: Option<Vec<SoftVertex>>,
    volume: Option<String>,
    unstable: Option<String>,
    mu: Option<f64>,
    pass_band: Option<f64>,
    degree: Option<usize>,
    window: Option<String>,
    alpha: Option<f64>,
    beta: Option<f64>,
    fraction: Option<f64>,
    cutoff: Option<f64>,
    order: Option<u32>,
    modes: Option<usize>,
    update: Option<String>,
    tolerance: Option<f64>,
    settled: Option<f64>,
    vertices: Option<Vec<u32>>,
}

/// Which methods take which option.
fn takers(option: &str) -> &'static [&'static str] {
    match option {
        "weights" => &["explicit", "implicit", "region"],
        "lam" => &["explicit", "implicit", "mean-curvature", "taubin"],
        "time" => &["explicit", "implicit", "mean-curvature", "low-pass", "conformal"],
        "iterations" => &[
            "explicit",
            "implicit",
            "mean-curvature",
            "taubin",
            "hc",
            "scale-dependent",
            "conformal",
        ],
        "area" => &["explicit", "implicit", "mean-curvature", "low-pass", "region"],
        "kind" => &["explicit", "implicit", "mean-curvature", "conformal", "low-pass", "region"],
        "boundary" | "pin" => &[
            "explicit",
            "implicit",
            "mean-curvature",
            "taubin",
            "hc",
            "scale-dependent",
            "low-pass",
            "windowed-sinc",
        ],
        "soft" => &["explicit", "implicit", "mean-curvature", "taubin", "hc", "scale-dependent"],
        "volume" => &["explicit", "implicit", "mean-curvature"],
        "unstable" => &["explicit", "taubin"],
        "mu" => &["taubin"],
        "pass_band" => &["taubin", "windowed-sinc"],
        "degree" | "window" => &["windowed-sinc"],
        "alpha" | "beta" => &["hc"],
        "fraction" => &["scale-dependent"],
        "cutoff" | "modes" => &["low-pass"],
        "order" => &["region", "low-pass"],
        "update" => &["implicit"],
        "tolerance" => &["implicit", "mean-curvature", "conformal"],
        "settled" => &["conformal"],
        "vertices" => &["region"],
        _ => &[],
    }
}

impl Options {
    /// Refuses options that the method does not have, and those that exclude each other.
    fn check(&self, method: &str, given: &[String]) -> Result<()> {
        for option in given {
            let takers = takers(option);
            if !takers.contains(&method) {
                let names = takers.join(", ");
                return Err(Error::option(format!(
                    "the method {method} has no option {option}; those that have it are {names}"
                )));
            }
        }
        let both = |a: &str, b: &str| given.iter().any(|g| g == a) && given.iter().any(|g| g == b);
        for (a, b) in [("lam", "time"), ("mu", "pass_band"), ("area", "kind"), ("time", "cutoff")] {
            if both(a, b) {
                return Err(Error::option(format!("give {a} or {b}, not both")));
            }
        }
        Ok(())
    }

    fn operator(&self) -> Result<Operator> {
        let kinds = [("cotangent", false), ("robust", true)];
        if let Some(kind) = &self.kind
            && choose("kind", kind, &kinds)?
        {
            return Ok(Operator::Robust);
        }
        let areas = [
            ("barycentric", LumpedArea::Barycentric),
            ("mixed", LumpedArea::Mixed),
            ("voronoi", LumpedArea::Voronoi),
        ];
        let area = self.area.as_deref().map(|name| choose("area", name, &areas)).transpose()?;
        Ok(Operator::Plain(area.unwrap_or(LumpedArea::Barycentric)))
    }

    fn cotangents(&self, lambda: f64) -> Result<Diffusion> {
        let time = match self.time {
            Some(time) => Time::SquaredUnits(time),
            None => Time::SquaredEdges(self.lam.unwrap_or(lambda)),
        };
        Ok(Diffusion::Cotangent { time, operator: self.operator()? })
    }

    /// Whether weights are cotangents; uniform unless said, or unless a time is given.
    fn by_cotangents(&self) -> Result<bool> {
        let weights = [("uniform", false), ("cotangent", true)];
        let said = self.weights.as_deref().map(|name| choose("weights", name, &weights));
        Ok(said.transpose()?.unwrap_or(self.time.is_some()))
    }

    /// The diffusion with its default steps for either weights.
    fn diffusion(&self, uniform: f64, cotangent: f64) -> Result<Diffusion> {
        if self.by_cotangents()? {
            return self.cotangents(cotangent);
        }
        if self.time.is_some() {
            return Err(Error::option("uniform weights have no time, only lam"));
        }
        Ok(Diffusion::uniform(self.lam.unwrap_or(uniform)))
    }

    fn stability(&self) -> Result<Stability> {
        let all =
            [("refuse", Stability::Refuse), ("warn", Stability::Warn), ("allow", Stability::Allow)];
        let said = self.unstable.as_deref().map(|name| choose("unstable", name, &all));
        Ok(said.transpose()?.unwrap_or_default())
    }

    fn volume(&self) -> Result<Volume> {
        let all =
            [("drift", Volume::Drifts), ("rescale", Volume::Rescaled), ("offset", Volume::Offset)];
        let said = self.volume.as_deref().map(|name| choose("volume", name, &all));
        Ok(said.transpose()?.unwrap_or_default())
    }

    fn update(&self) -> Result<Update> {
        let all = [("never", Update::Never), ("mass", Update::Mass), ("both", Update::Both)];
        let said = self.update.as_deref().map(|name| choose("update", name, &all));
        Ok(said.transpose()?.unwrap_or_default())
    }

    fn constraints(&self, mesh: &TriMesh) -> Result<Constraints> {
        let all = [
            ("free", Boundary::Free),
            ("pinned", Boundary::Pinned),
            ("sliding", Boundary::Sliding),
        ];
        let said = self.boundary.as_deref().map(|name| choose("boundary", name, &all));
        let boundary = said.transpose()?.unwrap_or_default();
        let soft = self.soft.iter().flatten().map(|&(vertex, weight, target)| {
            let here = mesh.positions().get(vertex as usize).copied().ok_or_else(|| {
                let n = mesh.vertex_count();
                Error::option(format!("soft names vertex {vertex}, but there are {n} vertices"))
            })?;
            Ok(SoftConstraint { vertex, target: target.unwrap_or(here), weight })
        });
        let soft = soft.collect::<Result<_>>()?;
        Ok(Constraints { boundary, pinned: self.pin.clone().unwrap_or_default(), soft })
    }

    fn method(&self, name: &str, mesh: &TriMesh) -> Result<Method> {
        let constraints = self.constraints(mesh)?;
        Ok(match name {
            "explicit" => Method::Explicit(Explicit {
                iterations: self.iterations.unwrap_or(10),
                stability: self.stability()?,
                constraints,
                volume: self.volume()?,
                ..Explicit::new(self.diffusion(0.5, 0.1)?)
            }),
            "implicit" | "mean-curvature" => {
                self.implicit(name == "mean-curvature", constraints)?
            }
            "conformal" => self.conformal()?,
            "taubin" => self.taubin(constraints)?,
            "windowed-sinc" => self.windowed_sinc(constraints)?,
            "hc" => {
                let options = Hc::default();
                Method::Hc(Hc {
                    alpha: self.alpha.unwrap_or(options.alpha),
                    beta: self.beta.unwrap_or(options.beta),
                    iterations: self.iterations.unwrap_or(options.iterations),
                    constraints,
                })
            }
            "scale-dependent" => {
                let options = ScaleDependent::default();
                Method::ScaleDependent(ScaleDependent {
                    fraction: self.fraction.unwrap_or(options.fraction),
                    iterations: self.iterations.unwrap_or(options.iterations),
                    constraints,
                })
            }
            "low-pass" => Method::LowPass(LowPass {
                operator: self.operator()?,
                constraints,
                ..LowPass::new(self.transfer())
            }),
            "region" => self.region()?,
            other => {
                let names: Vec<_> = Method::defaults().iter().map(Method::name).collect();
                return Err(Error::option(format!(
                    "there is no method {other:?}; there are {}",
                    names.join(", ")
                )));
            }
        })
    }

    fn implicit(&self, flows: bool, constraints: Constraints) -> Result<Method> {
        let diffusion = if flows { self.cotangents(1.0)? } else { self.diffusion(5.0, 5.0)? };
        let options = Implicit::new(diffusion);
        Ok(Method::Implicit(Implicit {
            iterations: self.iterations.unwrap_or(10),
            update: if flows { Update::Both } else { self.update()? },
            tolerance: self.tolerance.unwrap_or(options.tolerance),
            constraints,
            volume: self.volume()?,
            ..options
        }))
    }

    fn conformal(&self) -> Result<Method> {
        let options = ConformalizedMcf::default();
        Ok(Method::ConformalizedMcf(ConformalizedMcf {
            time: self.time.unwrap_or(options.time),
            iterations: self.iterations.unwrap_or(options.iterations),
            tolerance: self.tolerance.unwrap_or(options.tolerance),
            settled: self.settled.unwrap_or(options.settled),
            operator: self.operator()?,
        }))
    }

    fn taubin(&self, constraints: Constraints) -> Result<Method> {
        let options = Taubin::default();
        let lambda = self.lam.unwrap_or(options.lambda);
        let options = match (self.mu, self.pass_band) {
            (Some(mu), _) => Taubin::from_steps(lambda, mu),
            (None, band) => Taubin::new(lambda, band.unwrap_or(options.pass_band)),
        };
        let (pairs, stability) = (self.iterations.unwrap_or(10), self.stability()?);
        Ok(Method::Taubin(Taubin { pairs, stability, constraints, ..options }))
    }

    fn windowed_sinc(&self, constraints: Constraints) -> Result<Method> {
        let options = WindowedSinc::default();
        let all = [
            ("hanning", Window::Hanning),
            ("hamming", Window::Hamming),
            ("blackman", Window::Blackman),
        ];
        let window = self.window.as_deref().map(|name| choose("window", name, &all)).transpose()?;
        Ok(Method::WindowedSinc(WindowedSinc {
            pass_band: self.pass_band.unwrap_or(options.pass_band),
            degree: self.degree.unwrap_or(options.degree),
            window: window.unwrap_or_default(),
            constraints,
        }))
    }

    fn transfer(&self) -> Transfer {
        match (self.modes, self.time, self.cutoff) {
            (Some(modes), ..) => Transfer::Modes(modes),
            (_, Some(time), _) => Transfer::Heat(Time::SquaredUnits(time)),
            (_, _, Some(wavelength)) => Transfer::Butterworth {
                cutoff: (2.0 * std::f64::consts::PI / wavelength).powi(2),
                order: self.order.unwrap_or(2),
            },
            _ => Transfer::Heat(Time::SquaredEdges(5.0)),
        }
    }

    fn region(&self) -> Result<Method> {
        let Some(region) = self.vertices.clone().filter(|v| !v.is_empty()) else {
            return Err(Error::option("the method region needs vertices, the region to replace"));
        };
        let weights = match self.weights.as_deref() {
            Some("uniform") => FairingWeights::Uniform,
            None | Some("cotangent") => FairingWeights::Cotangent(self.operator()?),
            Some(other) => {
                return Err(Error::option(format!(
                    "weights is {other:?}, but must be one of uniform, cotangent"
                )));
            }
        };
        Ok(Method::FairRegion(FairRegion { region, order: self.order.unwrap_or(2), weights }))
    }
}

fn report_dict<'py>(py: Python<'py>, report: &Report) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    dict.set_item("iterations", report.iterations)?;
    dict.set_item("stable_limit", report.stable_limit)?;
    dict.set_item("unstable", report.unstable)?;
    dict.set_item("degenerate_faces", report.degenerate_faces)?;
    dict.set_item("worst_residual", report.worst_residual)?;
    dict.set_item("approach", approach(report.approach))?;
    dict.set_item("split", report.split.map(|s| (s.below, s.above)))?;
    Ok(dict)
}

fn approach(approach: Approach) -> String {
    match approach {
        Approach::Stepping => "stepping".to_owned(),
        Approach::Series { degree } => format!("Chebyshev series of degree {degree}"),
        Approach::Resolvent { degree } => format!("resolvent series of degree {degree}"),
        Approach::Modes { count } => format!("projection on {count} modes"),
        Approach::ConjugateGradients { iterations } => {
            format!("conjugate gradients, {iterations} iterations")
        }
        Approach::Cholesky { factorisations } => format!("{factorisations} factorisations"),
        other => format!("{other:?}"),
    }
}

/// The mesh, and how it came about.
#[pyfunction]
fn smooth<'py>(
    py: Python<'py>,
    mesh: &Mesh,
    method: String,
    options: Options,
    given: Vec<String>,
    call: Call,
) -> PyResult<(Mesh, Bound<'py, PyDict>)> {
    options.method(&method, &mesh.share())?;
    options.check(&method, &given)?;
    let mesh = mesh.share();
    let Smoothed { mesh, report, .. } = call.run(py, move || {
        let method = options.method(&method, &mesh)?;
        Ok(method.run(&mesh, None)?)
    })?;
    Ok((mesh.into(), report_dict(py, &report)?))
}

/// The names of the options, for the signature in Python.
#[pyfunction]
fn smooth_takers(option: &str) -> Vec<&'static str> {
    takers(option).to_vec()
}

pub(crate) fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_function(wrap_pyfunction!(smooth, module)?)?;
    module.add_function(wrap_pyfunction!(smooth_takers, module)?)
}
