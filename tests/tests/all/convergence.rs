//! Observed orders of convergence against exact solutions on sphere, torus and
//! ellipsoid, regular and jittered.

use fairing_evaluation::observed_orders;
use fairing_mesh::TriMesh;
use fairing_operators::curvature::{
    CorrectedMeasures, CurvatureField, Estimator, JetOptions, gaussian_curvature, mean_curvature,
    scaled_umbrella_mean_curvature,
};
use fairing_operators::surface::{
    Ellipsoid, ImplicitSurface, ParametricSurface, PointCurvature, Sphere, Torus,
};
use fairing_operators::{LumpedArea, SparseMatrix, consistent_mass, cotan_stiffness, lumped_mass};
use fairing_shapes as shapes;
use glam::DVec3;

const TORUS: Torus = Torus { major: 3.0, minor: 1.0 };
const ELLIPSOID: Ellipsoid = Ellipsoid { a: 1.0, b: 1.5, c: 2.0 };

/// The largest jitter, as a fraction of the least height of the adjacent faces.
const JITTER: f64 = 0.3;

type Exact = fn([f64; 3]) -> PointCurvature;

/// A surface with exact curvature, and a mesh for each refinement.
struct Case {
    name: &'static str,
    exact: Exact,
    mesh: fn(u32) -> TriMesh,
}

const REGULAR: [Case; 3] = [
    Case {
        name: "sphere",
        exact: |p| Sphere { radius: 1.0 }.curvature(p).unwrap(),
        mesh: shapes::icosphere,
    },
    Case {
        name: "torus",
        exact: |p| TORUS.curvature(p).unwrap(),
        mesh: |level| shapes::torus(3.0, 1.0, 9 << level, 4 << level),
    },
    Case {
        name: "ellipsoid",
        exact: |p| ELLIPSOID.curvature(p).unwrap(),
        mesh: |level| shapes::ellipsoid([1.0, 1.5, 2.0], level),
    },
];

const JITTERED: [Case; 3] = [
    Case {
        mesh: |level| shapes::jittered(&(REGULAR[0].mesh)(level), JITTER, 11, shapes::onto_sphere),
        ..REGULAR[0]
    },
    Case {
        mesh: |level| {
            let onto = shapes::onto_torus(3.0, 1.0);
            shapes::jittered(&(REGULAR[1].mesh)(level), JITTER, 12, onto)
        },
        ..REGULAR[1]
    },
    Case {
        mesh: |level| {
            let onto = shapes::onto_ellipsoid([1.0, 1.5, 2.0]);
            shapes::jittered(&(REGULAR[2].mesh)(level), JITTER, 13, onto)
        },
        ..REGULAR[2]
    },
];

/// Mean edge lengths and largest errors of H and K for each refinement.
fn largest_errors(case: &Case, levels: &[u32], estimator: &Estimator) -> [Vec<f64>; 3] {
    let (mut h, mut mean, mut gaussian) = (vec![], vec![], vec![]);
    for &level in levels {
        let mesh = (case.mesh)(level);
        let field = estimator.estimate(&mesh).unwrap();
        let (mut e, mut f) = (0.0f64, 0.0f64);
        for (v, &p) in mesh.positions().iter().enumerate() {
            assert!(field.is_interior(v as u32), "{} {v}", case.name);
            let exact = (case.exact)(p);
            e = e.max((field.mean[v] - exact.mean()).abs());
            f = f.max((field.gaussian[v] - exact.gaussian()).abs());
        }
        h.push(mesh.mean_edge_length());
        mean.push(e);
        gaussian.push(f);
    }
    [h, mean, gaussian]
}

fn energy(s: &SparseMatrix, u: &[f64]) -> f64 {
    let image = s * &ndarray::Array1::from(u.to_vec());
    image.iter().zip(u).map(|(a, b)| a * b).sum()
}

/// On the unit sphere Δ(xy) = −6xy, so its Rayleigh quotient tends to 6. (Plain x is no test:
/// symmetry makes it exact at every level.)
#[test]
fn rayleigh_quotient_converges_quadratically() {
    let masses: [fn(&TriMesh, &[f64]) -> f64; 4] = [
        |m, u| energy(&consistent_mass(m).unwrap(), u),
        |m, u| square(&lumped_mass(m, LumpedArea::Barycentric).unwrap(), u),
        |m, u| square(&lumped_mass(m, LumpedArea::Voronoi).unwrap(), u),
        |m, u| square(&lumped_mass(m, LumpedArea::Mixed).unwrap(), u),
    ];
    for mass in masses {
        let (mut h, mut error) = (vec![], vec![]);
        for level in 2..=5 {
            let sphere = shapes::icosphere(level);
            let u: Vec<f64> = sphere.positions().iter().map(|p| p[0] * p[1]).collect();
            let s = cotan_stiffness(&sphere).unwrap();
            h.push(sphere.mean_edge_length());
            error.push((energy(&s, &u) / mass(&sphere, &u) - 6.0).abs());
        }
        // Theory gives 2; the margin covers the pre-asymptotic levels.
        for order in observed_orders(&h, &error) {
            assert!((1.96..2.04).contains(&order), "{order}, {error:?}");
        }
    }
}

fn square(mass: &[f64], u: &[f64]) -> f64 {
    mass.iter().zip(u).map(|(m, u)| m * u * u).sum()
}

/// The Dirichlet energy of z on the jittered ellipsoid: integrals converge on irregular meshes.
#[test]
fn dirichlet_energy_converges_on_irregular_meshes() {
    // ∫ |∇z|² = ∫ 1 − n_z², by the midpoint rule in the chart, which is spectrally accurate in the
    // periodic direction and accurate enough in the other.
    let (nu, nv) = (400, 400);
    let mut exact = 0.0;
    for i in 0..nu {
        for j in 0..nv {
            let u = (f64::from(i) + 0.5) / f64::from(nu) * std::f64::consts::TAU;
            let v = (f64::from(j) + 0.5) / f64::from(nv) * std::f64::consts::PI;
            let jet = ELLIPSOID.jet(u, v);
            let area = DVec3::from(jet.du).cross(jet.dv.into());
            let length = area.length();
            exact += length - area.z * area.z / length;
        }
    }
    exact *= std::f64::consts::TAU * std::f64::consts::PI / f64::from(nu * nv);
    let (mut h, mut error) = (vec![], vec![]);
    for level in 2..=5 {
        let mesh = (JITTERED[2].mesh)(level);
        let z: Vec<f64> = mesh.positions().iter().map(|p| p[2]).collect();
        h.push(mesh.mean_edge_length());
        error.push((energy(&cotan_stiffness(&mesh).unwrap(), &z) - exact).abs());
    }
    for order in observed_orders(&h, &error) {
        assert!((1.8..2.2).contains(&order), "{order}, {error:?}");
    }
}

/// H and K with mixed areas on the icosphere are second order in the root mean square.
#[test]
fn plain_curvature_converges_on_the_icosphere() {
    let (mut h, mut mean, mut gaussian) = (vec![], vec![], vec![]);
    for level in 2..=5 {
        let mesh = shapes::icosphere(level);
        let operator = LumpedArea::Mixed;
        let rms =
            |x: &[f64]| (x.iter().map(|x| (x - 1.0).powi(2)).sum::<f64>() / x.len() as f64).sqrt();
        h.push(mesh.mean_edge_length());
        mean.push(rms(&mean_curvature(&mesh, operator).unwrap().signed));
        gaussian.push(rms(&gaussian_curvature(&mesh, LumpedArea::Mixed).unwrap().values));
    }
    for order in observed_orders(&h, &mean).into_iter().chain(observed_orders(&h, &gaussian)) {
        assert!((1.8..3.1).contains(&order), "{order}, {mean:?} {gaussian:?}");
    }
}

/// For points on a unit sphere (xⱼ − xᵢ)·xᵢ = −½ ‖xⱼ − xᵢ‖², so the scaled umbrella is exact
/// along the true normal on any mesh.
#[test]
fn the_scaled_umbrella_is_exact_on_a_sphere() {
    let mesh = (JITTERED[0].mesh)(2);
    let mean = scaled_umbrella_mean_curvature(&mesh);
    for (d, &p) in mean.vectors.iter().zip(mesh.positions()) {
        assert!((DVec3::from(*d).dot(p.into()) + 2.0).abs() < 1e-12, "{d:?}");
    }
}

/// The known weakness of the plain estimators: jitter prevents pointwise convergence. If this
/// fails, the convergence of the jets proves nothing.
#[test]
fn plain_curvature_does_not_converge_on_jittered_meshes() {
    let plain: Estimator = "cotangent".parse().unwrap();
    for case in &JITTERED {
        let [h, mean, gaussian] = largest_errors(case, &[2, 3, 4, 5], &plain);
        for error in [mean, gaussian] {
            let overall = (error[0] / error[3]).ln() / (h[0] / h[3]).ln();
            assert!(overall < 0.7, "{} {overall} {error:?}", case.name);
        }
    }
}

/// The required order: H and K of order at least 1.7 in the maximum norm on jittered sphere, torus
/// and ellipsoid.
#[test]
fn cubic_jets_converge_in_the_maximum_norm() {
    let jets = Estimator::Jet(JetOptions::default());
    for case in REGULAR.iter().chain(&JITTERED) {
        let [h, mean, gaussian] = largest_errors(case, &[4, 5, 6], &jets);
        for error in [mean, gaussian] {
            for order in observed_orders(&h, &error) {
                assert!(order > 1.7, "{} {order} {error:?}", case.name);
            }
        }
    }
}

/// Every estimator is accurate on a fine regular torus, including the signs and the order of the
/// two curvatures.
#[test]
fn every_estimator_knows_the_torus() {
    let mesh = shapes::torus(3.0, 1.0, 120, 60);
    for estimator in Estimator::all() {
        let field = estimator.estimate(&mesh).unwrap();
        for (v, &p) in mesh.positions().iter().enumerate() {
            let exact = TORUS.curvature(p).unwrap();
            let found = [field.kappa1[v], field.kappa2[v]];
            for k in 0..2 {
                // The tensors of one ring have a bias of several per cent, since the directions of
                // the edges are not evenly distributed.
                let gap = (found[k] - exact.values[k]).abs();
                assert!(gap < 0.12, "{estimator} {v} {found:?} {:?}", exact.values);
            }
            if let Some([first, second]) = &field.directions {
                let [first, second] = [first, second].map(|all| DVec3::from(all[v]));
                assert!(first.dot(second).abs() < 1e-12);
                let frame = first.cross(second);
                assert!(frame.dot(exact.normal.into()) > 0.99, "{estimator} {v}");
                let cosine = first.dot(exact.directions[0].into()).abs();
                assert!(cosine > 0.97, "{estimator} {v} {cosine}");
            }
        }
    }
}

/// Corrected measures of the faces of a 20 × 20 torus (R = 3, r = 1) with the true normals at its
/// vertices: the range of principal curvatures printed in the documentation of DGtal, to all its
/// digits (`curvature-measures-icnc-XY-3d torus 20 20 0`).
#[test]
fn corrected_measures_agree_with_dgtal() {
    let mesh = shapes::torus(3.0, 1.0, 20, 20);
    let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
    for f in 0..mesh.face_count() {
        let x = mesh.triangle(f);
        let measures =
            CorrectedMeasures::from_triangle(x, x.map(|p| TORUS.curvature(p).unwrap().normal));
        let (values, _) =
            measures.principal(DVec3::from(mesh.area_vector(f)).normalize().to_array()).unwrap();
        for k in 0..2 {
            low[k] = low[k].min(values[k]);
            high[k] = high[k].max(values[k]);
        }
    }
    let found = [low[1], high[1], low[0], high[0]];
    for (found, published) in found.into_iter().zip([-0.500225, 0.249888, 1.00011, 1.00678]) {
        // Half of the last digit printed.
        let last = if published > 1.0 { 0.5e-5 } else { 0.5e-6 };
        assert!((found - published).abs() < last * 1.01, "{found} {published}");
    }
}

/// On a sphere with its exact normals the measures are exact for any triangle.
#[test]
fn corrected_measures_are_exact_on_a_sphere() {
    let mesh = shapes::jittered(&shapes::icosphere(1), 0.4, 5, shapes::onto_sphere);
    for f in 0..mesh.face_count() {
        let u = mesh.triangle(f);
        let measures = CorrectedMeasures::from_triangle(u.map(|p| p.map(|x| 2.5 * x)), u);
        assert!((measures.mean_curvature().unwrap() - 0.4).abs() < 1e-14);
        assert!((measures.gaussian_curvature().unwrap() - 0.16).abs() < 1e-14);
        let (values, _) = measures
            .principal(u.map(DVec3::from).iter().sum::<DVec3>().normalize().to_array())
            .unwrap();
        assert!(values.iter().all(|k| (k - 0.4).abs() < 1e-14), "{values:?}");
    }
}

/// A cylinder distinguishes H from K and one direction from the other.
#[test]
fn every_estimator_knows_the_cylinder() {
    let mesh = shapes::cylinder(2.0, 4.0, 120, 40, shapes::Ends::Open);
    for estimator in Estimator::all() {
        let field: CurvatureField = estimator.estimate(&mesh).unwrap();
        assert_eq!(field.boundary.iter().filter(|&&b| b).count(), 240);
        // The edges that a ball cuts vary at random, by a few per cent.
        let tolerance = if estimator.name() == "normal-cycle" { 0.04 } else { 0.01 };
        for (v, p) in mesh.positions().iter().enumerate() {
            // At least four rings from the boundary.
            if (p[2] - 2.0).abs() > 1.2 {
                continue;
            }
            let (a, b) = (field.kappa1[v], field.kappa2[v]);
            assert!((a - 0.5).abs() < tolerance && b.abs() < tolerance, "{estimator} {a} {b}");
        }
    }
}
