//! Verbs that compute values at vertices, `curvature`, `distance`, `spectrum` and `mode`, and that
//! describe meshes, `info` and `compare`.

use std::sync::Arc;

use anyhow::{Context as _, Result};
use fairing::task::{self, fields, undefined_because};
use fairing_evaluation::{ScoreOptions, Scores};
use fairing_mesh::{Diagnosis, TriMesh};
use fairing_operators::curvature::{CurvatureField, Estimator, angle_defect};
use fairing_operators::{Laplacian, LaplacianKind, MassKind};
use fairing_parameters::Options as _;
use fairing_smoothing::{Diffusion, largest_eigenvalue};
use fairing_spectral::{self as spectral, HeatGeodesics, Spectrum, SpectrumOptions};
use fairing_watch as watch;

use crate::answer::{Answer, Array};
use crate::meshes::{Held, Meshes, names};
use crate::request::Request;
use crate::tasks::{BoundaryCondition, CompareOptions, DistanceOptions, SpectrumTask};

/// Curvature of `mesh` by the estimator `method`: its fields mean, gaussian, kappa1, kappa2,
/// defined and boundary, and the principal directions and the standard errors mean_error and
/// gaussian_error with their scale if the estimator has them.
pub(crate) fn curvature(meshes: &mut Meshes, request: &Request<'_>) -> Result<Answer> {
    let name = request.text_or("method", Estimator::RECOMMENDED.name());
    let estimator = Estimator::with(name, &request.values()?)?;
    let held = meshes.held(request, "mesh")?;
    let field = estimator.estimate(&*held.surface()?)?;
    let replaced = keep_curvature(held, &field);
    let mut value = held.listed(&replaced);
    value["method"] = estimator.name().into();
    value["undefined_because"] = undefined_because(&field).into();
    value["too_thin_face"] = field.too_thin.into();
    value["narrowed"] = field.narrowed.into();
    Ok(value.into())
}

/// Sets the fields of a curvature. Returns the names of those that replace fields of the file.
fn keep_curvature(held: &mut Held, field: &CurvatureField) -> Vec<&'static str> {
    let (mut scalars, vectors) = fields(field);
    // Pages list the flags before the curvatures.
    scalars.rotate_right(2);
    let scalars = scalars.into_iter().filter_map(|(name, x)| held.set(name, x).then_some(name));
    let mut replaced: Vec<_> = scalars.collect();
    let vectors = vectors.into_iter();
    replaced.extend(vectors.filter_map(|(name, x)| held.set_vectors(name, x).then_some(name)));
    replaced
}

/// Geodesic distance to the vertices `sources` of `mesh`, its field distance; −1 on components
/// without a source.
pub(crate) fn distance(meshes: &mut Meshes, request: &Request<'_>) -> Result<Answer> {
    let options = DistanceOptions::with("distance", &request.values()?)?.unwrap_or_default();
    let held = meshes.held(request, "mesh")?;
    let key = options.operator.to_string();
    let geodesics = match &held.geodesics {
        Some((known, geodesics)) if *known == key => Arc::clone(geodesics),
        _ => {
            watch::stage("factorising", 2);
            let mesh = held.surface()?;
            let laplacian = Laplacian::new(&mesh, options.operator, MassKind::Barycentric)?;
            Arc::new(HeatGeodesics::with(&mesh, &laplacian, None)?)
        }
    };
    held.geodesics = Some((key, Arc::clone(&geodesics)));
    let found = geodesics.distance(&options.sources)?;
    let unreached = found.iter().filter(|d| d.is_none()).count();
    let distance = found.into_iter().map(|d| d.unwrap_or(-1.0)).collect();
    let replaced = held.set("distance", distance).then_some("distance");
    let mut value = held.listed(replaced.as_slice());
    value["unreached"] = unreached.into();
    Ok(value.into())
}

/// The smallest eigenvalues of `mesh`; later requests for modes and reconstructions use them.
pub(crate) fn spectrum(meshes: &mut Meshes, request: &Request<'_>) -> Result<Answer> {
    let options = SpectrumTask::with("spectrum", &request.values()?)?.unwrap_or_default();
    let held = meshes.held(request, "mesh")?;
    let modes = modes(held, &options)?;
    Ok(Answer::from(task::modes(&modes))
        .with("values", Array::Numbers(modes.values.to_vec()))
        .with("residuals", Array::Numbers(modes.residuals.to_vec()))
        .with("sizes", Array::Numbers(sizes(&held.mesh, &modes)?)))
}

/// The size of each mode in the positions, the length of its three coefficients.
fn sizes(mesh: &TriMesh, modes: &Spectrum) -> Result<Vec<f64>> {
    let coefficients = modes.transform(ndarray::ArrayView2::from(mesh.positions()))?;
    let squares = Spectrum::energies(coefficients.view());
    Ok(squares.into_iter().map(f64::sqrt).collect())
}

/// Mode number `mode` of the last spectrum of `mesh`, its field mode.
pub(crate) fn mode(meshes: &mut Meshes, request: &Request<'_>) -> Result<Answer> {
    let number = request.number("mode")? as usize;
    let held = meshes.held(request, "mesh")?;
    let (_, modes) = held.spectrum.as_ref().context("the mesh has no spectrum yet")?;
    if number >= modes.len() {
        anyhow::bail!("there is no mode {number}: the spectrum has {}, from 0", modes.len());
    }
    let mode = modes.modes.column(number).to_vec();
    let replaced = held.set("mode", mode).then_some("mode");
    Ok(held.listed(replaced.as_slice()).into())
}

/// The modes for these options: those of the last request if they are enough.
pub(crate) fn modes(held: &mut Held, options: &SpectrumTask) -> Result<Arc<Spectrum>> {
    let key = format!("{} {}", options.operator, options.boundary);
    if let Some((known, modes)) = &held.spectrum
        && *known == key
        && modes.len() >= options.k
    {
        let enough = modes.len() == options.k;
        return Ok(if enough { modes.clone() } else { Arc::new(modes.truncated(options.k)?) });
    }
    let mesh: Arc<TriMesh> = held.surface()?;
    let mass = match options.operator {
        LaplacianKind::Uniform => MassKind::Degree,
        _ => MassKind::Barycentric,
    };
    let laplacian = Laplacian::new(&mesh, options.operator, mass)?;
    let conditions = match options.boundary {
        BoundaryCondition::Neumann => SpectrumOptions::default(),
        BoundaryCondition::Dirichlet => SpectrumOptions::dirichlet(&mesh),
    };
    let modes = Arc::new(spectral::spectrum(&laplacian, options.k, &conditions)?);
    held.spectrum = Some((key, Arc::clone(&modes)));
    Ok(modes)
}

/// Counts, topology, defects and measures of `mesh`, and the sum of its angle defects; with
/// `roughest` also the largest eigenvalue of −L with uniform weights, null if there is none.
pub(crate) fn info(meshes: &mut Meshes, request: &Request<'_>) -> Result<Answer> {
    let held = meshes.held(request, "mesh")?;
    let mut value = serde_json::to_value(Diagnosis::new(&held.mesh))?;
    value["fields"] = names(&held.fields).into();
    value["total_curvature"] = angle_defect(&held.mesh).iter().sum::<f64>().into();
    if request.flag("roughest") {
        let roughest = largest_eigenvalue(&held.mesh, Diffusion::uniform(1.0));
        value["roughest_eigenvalue"] = roughest.ok().into();
    }
    Ok(value.into())
}

/// Scores of `mesh` against `reference`; with `matching` only those that compare elements of the
/// same number: angles between normals, volume and sharp edges.
pub(crate) fn compare(meshes: &mut Meshes, request: &Request<'_>) -> Result<Answer> {
    let options = CompareOptions::with("compare", &request.values()?)?.unwrap_or_default();
    let reference = meshes.held(request, "reference")?.mesh.clone();
    let mesh = meshes.held(request, "mesh")?.mesh.clone();
    let options = ScoreOptions {
        hausdorff_tolerance: options.hausdorff_tolerance,
        feature_angle: options.feature_angle,
    };
    if request.flag("matching") {
        return Ok(task::matching_scores(&mesh, &reference, options.feature_angle)?.into());
    }
    let scores = Scores::new(&mesh, &reference, &options)?;
    Ok(task::scores(&scores).into())
}
