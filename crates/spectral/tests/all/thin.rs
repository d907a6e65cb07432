//! Strips, wires and thin tubes: surfaces on which the answer is known, and weights that differ by
//! many digits.

use fairing_mesh::TriMesh;
use fairing_operators::{Laplacian, LaplacianKind, MassKind};
use fairing_shapes as shapes;
use fairing_spectral::{HeatDiffusion, HeatGeodesics, Poisson};
use glam::DVec3;

use crate::meshes::{scaled, sheet, union};

/// A tube of `cells` rings of unit length, with `sides` sides of width `side`.
fn tube(cells: usize, sides: usize, side: f64) -> TriMesh {
    let turn = std::f64::consts::TAU / sides as f64;
    let radius = 0.5 * side / (0.5 * turn).sin();
    let at = |i: usize, j: usize| {
        let angle = turn * j as f64;
        [i as f64, radius * angle.cos(), radius * angle.sin()]
    };
    let positions = (0..=cells).flat_map(|i| (0..sides).map(move |j| at(i, j)));
    let cell = |i: usize, j: usize| {
        let (a, b) = (i * sides + j, i * sides + (j + 1) % sides);
        [[a, b, b + sides], [a, b + sides, a + sides]].map(|f| f.map(|v| v as u32))
    };
    let faces = (0..cells).flat_map(|i| (0..sides).flat_map(move |j| cell(i, j)));
    TriMesh::new(positions.collect(), faces.collect()).unwrap()
}

/// Distances on a strip are those in the plane, from the end and from the middle, however thin it
/// is.
#[test]
fn distances_along_strips() {
    for (kind, m) in
        [(LaplacianKind::Auto, 10), (LaplacianKind::Auto, 300), (LaplacianKind::Robust, 300)]
    {
        for h in [1.0, 0.1, 0.01, 1e-3, 1e-4, 1e-5] {
            let mesh = sheet(m, 1, [1.0, h], 0.0);
            let laplacian = Laplacian::new(&mesh, kind, MassKind::Barycentric).unwrap();
            let heat = HeatGeodesics::with(&mesh, &laplacian, None).unwrap();
            for source in [0, m / 3, m / 2, m + 1 + m / 3] {
                let found = heat.distance(&[source as u32]).unwrap();
                for (found, &p) in found.iter().zip(mesh.positions()) {
                    let exact = DVec3::from(p).distance(mesh.positions()[source].into());
                    // Some tenths of the width near the source; mollification moves lengths by 10⁻⁵
                    // of it.
                    let tolerance = h.min(0.4) + 1e-6 * exact;
                    let found = found.unwrap();
                    assert!((found - exact).abs() < tolerance, "{kind} {m} × {h}: {found} {exact}");
                }
            }
        }
    }
}

/// A tube is a rolled-up strip.
#[test]
fn distances_along_tubes() {
    for kind in [LaplacianKind::Auto, LaplacianKind::Robust] {
        for sides in [3, 5, 12, 40] {
            for side in [1.0, 0.1, 0.01, 1e-3, 1e-5] {
                let mesh = tube(200, sides, side);
                let laplacian = Laplacian::new(&mesh, kind, MassKind::Barycentric).unwrap();
                let heat = HeatGeodesics::with(&mesh, &laplacian, None).unwrap();
                for ring in [0, 70] {
                    let found = heat.distance(&[(ring * sides) as u32]).unwrap();
                    for (v, found) in found.iter().enumerate() {
                        let (along, around) = ((v / sides).abs_diff(ring), v % sides);
                        let around = side * around.min(sides - around) as f64;
                        let exact = libm::hypot(along as f64, around);
                        // Half of the circumference is lost where a tube is thin beside its edges.
                        let tolerance = f64::min(1.0, 0.6 * sides as f64 * side) + 1e-6 * exact;
                        let found = found.unwrap();
                        assert!(
                            (found - exact).abs() < tolerance,
                            "{kind} {sides} × {side}: {found} {exact}"
                        );
                    }
                }
            }
        }
    }
}

/// A function that is harmonic between the ends of a strip is linear: to rounding, for any width,
/// and for values of any size. The condition is that of the strip.
#[test]
fn harmonic_functions_on_strips() {
    for (kind, mass) in [
        (LaplacianKind::Cotangent, MassKind::Barycentric),
        (LaplacianKind::Cotangent, MassKind::Consistent),
        (LaplacianKind::Robust, MassKind::Barycentric),
    ] {
        for m in [300, 1000, 5000] {
            for h in [1.0, 1e-3, 1e-4, 1e-5, 1e-6, 1e-8] {
                let mesh = sheet(m, 1, [1.0, h], 0.0);
                let laplacian = Laplacian::new(&mesh, kind, mass).unwrap();
                let ends = [0, m + 1, m, 2 * m + 1].map(|v| v as u32);
                let problem = Poisson::new(&laplacian, &ends).unwrap();
                let none = vec![0.0; mesh.vertex_count()];
                for low in [0.0, 1e6] {
                    let u = problem.solve(&none, &[low, low, low + 1.0, low + 1.0]).unwrap();
                    for (u, p) in u.iter().zip(mesh.positions()) {
                        let exact = low + p[0] / m as f64;
                        assert!((u - exact).abs() < 1e-9, "{kind} {mass} {m} × {h}: {u} {exact}");
                    }
                }
                let condition = problem.condition();
                let expected = 0.5 * (m as f64 / h).powi(2);
                // Mollification makes the thinnest strips wider.
                let thin = kind == LaplacianKind::Robust && h < 1e-5;
                assert!(
                    h == 1.0 || thin || (condition / expected - 1.0).abs() < 0.01,
                    "{condition:e}"
                );
            }
        }
    }
}

/// The unit of lengths does not matter: means are weighted by shares of an area, not by areas.
#[test]
fn problems_without_fixed_vertices_in_any_unit() {
    let solve = |mesh: &TriMesh, unit: f64| {
        let laplacian = Laplacian::cotangent(mesh).unwrap();
        let f: Vec<f64> =
            (0..mesh.vertex_count()).map(|v| (v as f64).sin() / unit / unit).collect();
        Poisson::new(&laplacian, &[]).unwrap().solve(&f, &[]).unwrap()
    };
    let sphere = shapes::icosphere(2);
    let expected = solve(&sphere, 1.0);
    for exponent in [-98, -40, 40, 98] {
        let unit = 2f64.powi(exponent);
        assert_eq!(solve(&scaled(&sphere, unit), unit), expected, "2^{exponent}");
    }
}

/// The heat of each component is kept, for any time and after many steps, and in the end its mean
/// is everywhere.
#[test]
fn heat_is_kept() {
    let sphere = shapes::icosphere(3);
    let n = sphere.vertex_count();
    let two = union(&sphere, &scaled(&sphere, 1e-3));
    let strip = sheet(100_000, 1, [1.0, 1.0], 0.0);
    let thin = sheet(1000, 1, [1.0, 1e-5], 0.0);
    for (mesh, steps, mass) in [
        (&sphere, 1000, MassKind::Barycentric),
        (&sphere, 100, MassKind::Consistent),
        (&two, 100, MassKind::Barycentric),
        (&strip, 2, MassKind::Barycentric),
        (&thin, 100, MassKind::Barycentric),
    ] {
        let laplacian = Laplacian::new(mesh, LaplacianKind::Cotangent, mass).unwrap();
        let areas = laplacian.mass().lumped();
        let h = mesh.mean_edge_length();
        let at_first: Vec<f64> = (0..areas.len()).map(|v| (v as f64).sin() + 1.0).collect();
        let first = if mesh.vertex_count() == 2 * n { n } else { areas.len() };
        let means = |u: &[f64]| {
            [0..first, first..areas.len()].map(|part| {
                let heat: f64 = part.clone().map(|v| areas[v] * (u[v] - 1.0)).sum();
                1.0 + heat / areas[part].iter().sum::<f64>().max(f64::MIN_POSITIVE)
            })
        };
        let expected = means(&at_first);
        for time in [1e-2, 1.0, 1e4, 1e8, 1e12, 1e13, 1e15, 1e100] {
            let heat = HeatDiffusion::new(&laplacian, time * h * h).unwrap();
            let mut u = at_first.clone();
            for _ in 0..steps {
                u = heat.step(&u).unwrap();
            }
            for (found, expected) in means(&u).iter().zip(&expected) {
                // Rounding of a thousand steps.
                assert!((found - expected).abs() < 1e-13, "{time:e} h²: {found} {expected}");
            }
            for (v, u) in u.iter().enumerate().filter(|_| time > 1e15) {
                let mean = expected[usize::from(v >= first)];
                assert!((u - mean).abs() < 1e-13, "{time:e} h²: {u} {mean}");
            }
        }
    }
}
