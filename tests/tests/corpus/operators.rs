//! Operators and estimators on every file of the corpus.

use std::path::Path;

use fairing_mesh::{TriMesh, io};
use fairing_operators::curvature::{Estimator, angle_defect, gaussian_curvature};
use fairing_operators::intrinsic::robust_laplacian;
use fairing_operators::{
    LumpedArea, OperatorError, cotan_stiffness, lumped_mass, polygon_laplacian,
};
use glam::DVec3;
use libtest_mimic::Failed;

use crate::{Test, verbs};

/// The largest file that every estimator runs on, in bytes: one of them takes 40 µs for a vertex.
const MAX_BYTES: u64 = 2 << 20;

/// The tests of this area.
pub(crate) fn trials() -> Vec<(&'static str, Test)> {
    vec![
        ("gauss_bonnet_holds_on_every_file", gauss_bonnet),
        ("every_estimator_is_finite_on_ordinary_files", estimators),
        ("robust_laplacians_exist_on_every_file", robust),
        ("plain_operators_exist_or_name_a_face", plain),
        ("polygon_laplacians_of_polygon_files", polygons),
    ]
}

/// Checks every file up to a size, in bytes.
fn each(
    folder: &Path,
    max_bytes: u64,
    check: impl Fn(&TriMesh) -> Result<(), String>,
) -> Result<(), Failed> {
    let files = verbs::files(folder, max_bytes)?;
    assert!(files.len() >= 40, "{} files are not the corpus", files.len());
    for path in files {
        let mesh = io::read(&path)?.mesh;
        check(&mesh).map_err(|e| format!("{}: {e}", path.display()))?;
    }
    Ok(())
}

fn require(holds: bool, what: impl FnOnce() -> String) -> Result<(), String> {
    if holds { Ok(()) } else { Err(what()) }
}

fn gauss_bonnet(folder: &Path) -> Result<(), Failed> {
    each(folder, u64::MAX, |mesh| {
        let total: f64 = angle_defect(mesh).iter().sum();
        let expected = std::f64::consts::TAU * mesh.topology().euler_characteristic() as f64;
        // Several roundings of 2π for each vertex, not all of one sign.
        let allowed = 1e-14 * (1000.0 + mesh.vertex_count() as f64);
        require((total - expected).abs() < allowed, || format!("{total} is not {expected}"))
    })
}

fn estimators(folder: &Path) -> Result<(), Failed> {
    each(folder, MAX_BYTES, |mesh| {
        for estimator in Estimator::all() {
            let field = match estimator.estimate(mesh) {
                Ok(field) => field,
                Err(OperatorError::NoLength) if mesh.diagonal() == 0.0 => continue,
                Err(error) => return Err(format!("{estimator}: {error}")),
            };
            let mut numbers =
                [&field.kappa1, &field.kappa2, &field.mean, &field.gaussian].into_iter().flatten();
            require(numbers.all(|x| x.is_finite()), || format!("{estimator} is not finite"))?;
            for v in 0..field.len() {
                let (a, b) = (field.kappa1[v], field.kappa2[v]);
                require(a >= b, || format!("{estimator}: κ₁ = {a} < κ₂ = {b} at {v}"))?;
                let isolated = mesh.incidence().corners(v as u32).is_empty();
                let defined = field.status[v].is_defined();
                require(!(isolated && defined), || format!("{estimator}: isolated {v} defined"))?;
                if let (true, Some(directions)) = (defined, &field.directions) {
                    for d in directions {
                        let length = DVec3::from(d[v]).length();
                        require((length - 1.0).abs() < 1e-9, || {
                            format!("{estimator}: direction {:?} at {v}", d[v])
                        })?;
                    }
                }
            }
        }
        Ok(())
    })
}

fn robust(folder: &Path) -> Result<(), Failed> {
    each(folder, u64::MAX, |mesh| {
        let robust = match robust_laplacian(mesh) {
            Ok(robust) => robust,
            Err(OperatorError::NoLength) if mesh.diagonal() == 0.0 => return Ok(()),
            Err(error) => return Err(error.to_string()),
        };
        require(robust.stiffness.data().iter().all(|x| x.is_finite()), || "not finite".into())?;
        require(robust.stuck == 0, || format!("{} edges are stuck", robust.stuck))?;
        for (i, row) in robust.stiffness.outer_iterator().enumerate() {
            let largest = row.data().iter().fold(0.0, |m: f64, x| m.max(x.abs()));
            for (j, &s) in row.iter() {
                // Rounding of cotangents, in units of the largest.
                require(i == j || s <= 1e-9 * (1.0 + largest), || {
                    format!("weight {s} at {i} {j}")
                })?;
            }
        }
        for (v, &m) in robust.mass.iter().enumerate() {
            let isolated = mesh.incidence().corners(v as u32).is_empty();
            require(m.is_finite() && (m > 0.0) != isolated, || format!("mass {m} at {v}"))?;
        }
        Ok(())
    })
}

fn plain(folder: &Path) -> Result<(), Failed> {
    each(folder, u64::MAX, |mesh| {
        let named = |error: OperatorError| match error {
            OperatorError::DegenerateFace { face, .. } if (face as usize) < mesh.face_count() => {
                Ok(())
            }
            error => Err(error.to_string()),
        };
        match cotan_stiffness(mesh) {
            Ok(s) => require(s.data().iter().all(|x| x.is_finite()), || "S".into())?,
            Err(error) => named(error)?,
        }
        for area in [LumpedArea::Barycentric, LumpedArea::Voronoi, LumpedArea::Mixed] {
            match lumped_mass(mesh, area) {
                Ok(m) => require(m.iter().all(|x| x.is_finite()), || format!("{area:?}"))?,
                Err(error) => named(error)?,
            }
        }
        let k = gaussian_curvature(mesh, LumpedArea::Barycentric).map_err(|e| e.to_string())?;
        require(k.values.iter().all(|x| x.is_finite()), || "K".into())
    })
}

fn polygons(folder: &Path) -> Result<(), Failed> {
    for name in ["horse_quad.obj", "bunny_poly.ply", "dodecahedron_poly.obj"] {
        let mesh = io::read(folder.join("standard").join(name))?.mesh.to_polygon_mesh();
        let found = polygon_laplacian(&mesh).map_err(|e| format!("{name}: {e}"))?;
        let area: f64 = found.lumped_mass.iter().sum();
        let triangles = mesh.triangulate();
        let expected: f64 = (0..triangles.face_count()).map(|f| triangles.face_area(f)).sum();
        // Polygons that are not flat have a slightly different surface.
        if (area / expected - 1.0).abs() > 2e-2 {
            return Err(format!("{name}: area {area}, triangulated {expected}").into());
        }
        if found.stiffness.data().iter().any(|x| !x.is_finite()) {
            return Err(format!("{name}: not finite").into());
        }
    }
    Ok(())
}
