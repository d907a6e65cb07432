//! Distances by the heat method against known ones.

use fairing_mesh::TriMesh;
use fairing_operators::{Laplacian, LaplacianKind, MassKind};
use fairing_shapes as shapes;
use fairing_spectral::{HeatGeodesics, SpectralError};

use crate::meshes::{capsule, mapped, relabelled, scaled, sheet, turned, union};

fn distances(mesh: &TriMesh, sources: &[u32]) -> Vec<f64> {
    let found = HeatGeodesics::new(mesh).unwrap().distance(sources).unwrap();
    found.into_iter().map(|d| d.unwrap()).collect()
}

fn with(mesh: &TriMesh, kind: LaplacianKind, time: Option<f64>) -> HeatGeodesics {
    let laplacian = Laplacian::new(mesh, kind, MassKind::Barycentric).unwrap();
    HeatGeodesics::with(mesh, &laplacian, time).unwrap()
}

/// Mean and largest error against the distance in the plane, as shares of the largest distance.
fn errors(mesh: &TriMesh, source: u32, kind: LaplacianKind) -> (f64, f64) {
    let heat = with(mesh, kind, None);
    let found = heat.distance(&[source]).unwrap();
    let p = mesh.positions();
    let from = p[source as usize];
    let exact = |v: usize| ((p[v][0] - from[0]).powi(2) + (p[v][1] - from[1]).powi(2)).sqrt();
    let largest = (0..p.len()).map(exact).fold(0.0, f64::max);
    let off = |v: usize| (found[v].unwrap() - exact(v)).abs() / largest;
    let worst = (0..p.len()).map(off).fold(0.0, f64::max);
    ((0..p.len()).map(off).sum::<f64>() / p.len() as f64, worst)
}

/// A flat sheet of slivers, sheared by `shear` and more: its intrinsic Delaunay triangulation has
/// none.
#[test]
fn slivers_do_no_harm() {
    for shear in [3.0, 6.0] {
        let mesh = sheet(40, 40, [0.025, 0.025], shear);
        let heat = HeatGeodesics::new(&mesh).unwrap();
        assert_eq!(heat.kind(), LaplacianKind::Robust);
        let source = 20 * 41 + 20;
        let (mean, worst) = errors(&mesh, source, LaplacianKind::NonNegative);
        let (plain, _) = errors(&mesh, source, LaplacianKind::Cotangent);
        assert!(mean < 0.02 && worst < 0.05, "{shear}: {mean} {worst}");
        assert!(plain > 2.0 * mean, "{shear}: {plain} {mean}");
    }
    let good = HeatGeodesics::new(&shapes::icosphere(3)).unwrap();
    assert_eq!(good.kind(), LaplacianKind::Cotangent);
}

/// On a good mesh both operators are the same, and so are the distances.
#[test]
fn operators_agree_on_delaunay_meshes() {
    let mesh = shapes::icosphere(3);
    let [a, b] = [LaplacianKind::Cotangent, LaplacianKind::Robust].map(|kind| {
        let heat = with(&mesh, kind, None);
        assert_eq!(heat.kind(), kind);
        heat.distance(&[3, 77]).unwrap()
    });
    for (a, b) in a.iter().zip(&b) {
        assert!((a.unwrap() - b.unwrap()).abs() < 1e-9);
    }
}

/// Gradients belong to faces: a Laplacian without them, or of another mesh, is refused.
#[test]
fn laplacians_that_do_not_serve_are_refused() {
    let mesh = shapes::icosphere(1);
    let uniform = Laplacian::new(&mesh, LaplacianKind::Uniform, MassKind::Barycentric).unwrap();
    let refused = HeatGeodesics::with(&mesh, &uniform, None);
    assert!(matches!(refused, Err(SpectralError::Kind { kind: LaplacianKind::Uniform })));
    let other = Laplacian::cotangent(&shapes::icosphere(2)).unwrap();
    let refused = HeatGeodesics::with(&mesh, &other, None);
    assert!(matches!(refused, Err(SpectralError::Rows { found: 162, expected: 42 })));
}

/// Every source has distance 0, to the last bit, and nothing is nearer; on every component that has
/// sources. Neither their order nor repetitions matter.
#[test]
fn sources_have_no_distance() {
    let (sphere, slivers) = (shapes::icosphere(4), sheet(20, 20, [0.05, 0.05], 3.0));
    let n = sphere.vertex_count() as u32;
    let mesh = union(&sphere, &slivers);
    let heat = HeatGeodesics::new(&mesh).unwrap();
    let curve: Vec<u32> = (0..21).map(|i| n + 21 * i + 10).collect();
    for sources in [vec![3, 77, 1000, 2000, n + 5, n + 300], vec![0, 1, 2, 3, 4, 5], curve] {
        let found = heat.distance(&sources).unwrap();
        assert!(sources.iter().all(|&v| found[v as usize] == Some(0.0)));
        assert!(found.iter().flatten().all(|d| *d >= 0.0));
        let mut again = [&sources[..], &sources[..2]].concat();
        again.reverse();
        assert_eq!(heat.distance(&again).unwrap(), found);
    }
    // The distance to the nearest of two poles, within some hundredths.
    let p = sphere.positions();
    let pole = (0..p.len()).find(|&v| p[v].iter().zip(p[0]).all(|(a, b)| (a + b).abs() < 1e-9));
    let found = distances(&sphere, &[0, pole.unwrap() as u32]);
    for (found, q) in found.iter().zip(p) {
        let cosine = (0..3).map(|k| q[k] * p[0][k]).sum::<f64>().abs();
        let exact = cosine.min(1.0).acos();
        assert!((found - exact).abs() < 0.08, "{found} {exact}");
    }
}

/// Strips of unit squares: heat falls by a factor of 2.6 an edge, far below what floats can hold.
#[test]
fn distances_do_not_stop_growing() {
    for n in [300, 700, 1200, 1800, 6000] {
        let found = distances(&sheet(n, 1, [1.0, 1.0], 0.0), &[0]);
        let end = found[n];
        assert!((end - n as f64).abs() < 1.0 + 0.01 * n as f64, "{n}: {end}");
        assert!((1..=n).all(|v| found[v] > found[v - 1]));
    }
    let none = with(&sheet(1800, 1, [1.0, 1.0], 0.0), LaplacianKind::NonNegative, Some(0.0));
    assert!(matches!(none.distance(&[0]), Err(SpectralError::NoHeat { vertex: 1.. })));
    // A longer time reaches farther.
    let long = with(&sheet(1800, 1, [1.0, 1.0], 0.0), LaplacianKind::NonNegative, Some(16.0));
    let end = long.distance(&[0]).unwrap()[1800].unwrap();
    assert!((end - 1800.0).abs() < 20.0, "{end}");
}

/// A long sheared strip: the slope of the distance is the same where heat is computed again.
#[test]
fn distances_across_stages_are_as_accurate_as_before() {
    let mesh = sheet(4000, 4, [1.0, 1.0], 0.3);
    let found = distances(&mesh, &[0]);
    let p = mesh.positions();
    let exact = |v: usize| (p[v][0] - p[0][0]).hypot(p[v][1] - p[0][1]);
    let slope = |from: usize, to: usize| {
        let ends = [from, to].map(|v| (exact(v), found[v]));
        (ends[1].1 - ends[0].1) / (ends[1].0 - ends[0].0)
    };
    // Heat from the source ends near vertex 1300 of a row, and later stages every 1600.
    let before = slope(200, 900);
    for from in [900, 1400, 2100, 2800, 3200] {
        let after = slope(from, from + 700);
        assert!((after / before - 1.0).abs() < 2e-3, "{from}: {after} {before}");
    }
}

/// Along the axis a capsule is 2 + π long; faces without area at the poles do not matter.
#[test]
fn fans_without_area_have_distances() {
    let mesh = capsule(40, 12, true);
    let heat = HeatGeodesics::new(&mesh).unwrap();
    assert_eq!(heat.kind(), LaplacianKind::Robust);
    let last = mesh.vertex_count() - 1;
    let found = heat.distance(&[0]).unwrap()[last].unwrap();
    let length = 2.0 + std::f64::consts::PI;
    assert!((found / length - 1.0).abs() < 0.05, "{found}");
}

/// Units, frames and numbers do not matter, nor do other components of any size; those have no
/// distance, and their own sources.
#[test]
fn distances_belong_to_the_surface() {
    let body = shapes::bumpy_sphere(3, 0.15, 4.0);
    let slivers = sheet(20, 20, [0.05, 0.05], 3.0);
    for mesh in [body, slivers] {
        let n = mesh.vertex_count();
        let one = distances(&mesh, &[7]);
        let largest = one.iter().fold(0.0, |m: f64, d| m.max(*d));
        let compare = |found: &[f64], unit: f64, tolerance: f64| {
            for (a, b) in found.iter().zip(&one) {
                assert!((a / unit - b).abs() < tolerance * largest, "{a} {b}");
            }
        };
        for s in [1e-9, 1e-8, 1e8, 1e9] {
            compare(&distances(&scaled(&mesh, s), &[7]), s, 1e-8);
        }
        compare(&distances(&turned(&mesh), &[7]), 1.0, 1e-8);
        // Positions keep ten digits.
        compare(&distances(&mapped(&mesh, |p| p.map(|x| x + 1e6)), &[7]), 1.0, 1e-6);
        let (other, place) = relabelled(&mesh);
        let found = distances(&other, &[place[7] as u32]);
        compare(&place.iter().map(|&v| found[v]).collect::<Vec<_>>(), 1.0, 1e-8);
        for size in [1e-4, 1.0, 1e4] {
            let both = union(&mesh, &scaled(&mesh, size));
            let heat = HeatGeodesics::new(&both).unwrap();
            let first = heat.distance(&[7]).unwrap();
            assert!(first[n..].iter().all(|d| d.is_none()));
            let found: Vec<f64> = first[..n].iter().map(|d| d.unwrap()).collect();
            let tolerance = 1e-8;
            compare(&found, 1.0, tolerance);
            let second: Vec<f64> =
                heat.distance(&[n as u32 + 7]).unwrap()[n..].iter().map(|d| d.unwrap()).collect();
            compare(&second, size, tolerance);
        }
    }
}

/// Distances along the faces by Dijkstra's algorithm over the vertices and `cuts` points on each
/// edge, joined across every face: never too small, and too large by the square of the share of an
/// edge that a path is moved by.
fn along_faces(mesh: &TriMesh, source: u32, cuts: usize) -> Vec<f64> {
    let (topology, n) = (mesh.topology(), mesh.vertex_count());
    let mut points = mesh.positions().to_vec();
    for &[a, b] in topology.edges() {
        let [a, b] = [a, b].map(|v| mesh.positions()[v as usize]);
        for k in 1..=cuts {
            let t = k as f64 / (cuts + 1) as f64;
            points.push([0, 1, 2].map(|i| a[i] + t * (b[i] - a[i])));
        }
    }
    let on_face = |f: usize| -> Vec<usize> {
        let corners = mesh.faces()[f].into_iter().map(|v| v as usize);
        let sides = topology.face_edges()[f].into_iter();
        let cut = sides.flat_map(|e| (0..cuts).map(move |k| n + e as usize * cuts + k));
        corners.chain(cut).collect()
    };
    let mut faces_of = vec![vec![]; points.len()];
    for f in 0..mesh.face_count() {
        for p in on_face(f) {
            faces_of[p].push(f);
        }
    }
    let mut found = vec![f64::INFINITY; points.len()];
    // Lengths that are not negative are ordered as their bits are.
    let mut queue = std::collections::BTreeSet::from([(0u64, source as usize)]);
    found[source as usize] = 0.0;
    while let Some((bits, p)) = queue.pop_first() {
        let so_far = f64::from_bits(bits);
        if so_far > found[p] {
            continue;
        }
        for q in faces_of[p].iter().flat_map(|&f| on_face(f)) {
            let length = so_far + glam::DVec3::from(points[p]).distance(points[q].into());
            if length < found[q] {
                found[q] = length;
                queue.insert((length.to_bits(), q));
            }
        }
    }
    found.truncate(n);
    found
}

/// Mean and largest error against distances along the faces, as shares of the largest.
fn errors_along_faces(mesh: &TriMesh, exact: &[f64], kind: LaplacianKind) -> (f64, f64) {
    let largest = exact.iter().fold(0.0, |m: f64, d| m.max(*d));
    let found = with(mesh, kind, None).distance(&[0]).unwrap();
    let off = found.iter().zip(exact).map(|(d, e)| (d.unwrap() - e).abs() / largest);
    (off.clone().sum::<f64>() / exact.len() as f64, off.fold(0.0, f64::max))
}

/// An animal with thin limbs, as it is and stretched to faces with angles of nearly 180° all over:
/// the robust operator, which the default takes for all of them, is within 1.2 % of the largest
/// distance in the mean and 3.6 % at worst.
#[test]
fn limbs_of_slivers() {
    let plain = shapes::creature(48);
    for stretch in [1.0, 4.0, 8.0] {
        let mesh = mapped(&plain, |[x, y, z]| [x + 0.5 * (stretch - 1.0) * y, stretch * y, z]);
        let exact = along_faces(&mesh, 0, 3);
        let [found, cotangent] = [LaplacianKind::NonNegative, LaplacianKind::Cotangent]
            .map(|kind| errors_along_faces(&mesh, &exact, kind));
        assert!(found.0 < 0.012 && found.1 < 0.036, "{stretch}: {found:?}");
        // Half of the largest distance in the mean, where the robust operator is off by a
        // hundredth.
        assert!(
            stretch == 1.0 || cotangent.0 > 10.0 * found.0,
            "{stretch}: {found:?} {cotangent:?}"
        );
    }
}

/// Without a time the square of the mean edge length is taken, however much lengths differ: not the
/// mean of squares.
#[test]
fn the_time_is_the_square_of_the_mean_edge_length() {
    let torus = shapes::torus(1.0, 0.3, 60, 60);
    let laplacian = Laplacian::cotangent(&torus).unwrap();
    let h = torus.mean_edge_length();
    let found =
        |time| HeatGeodesics::with(&torus, &laplacian, time).unwrap().distance(&[0]).unwrap();
    let (own, given) = (found(None), found(Some(h * h)));
    for (own, given) in own.iter().zip(&given) {
        let (own, given) = (own.unwrap(), given.unwrap());
        assert!((own - given).abs() < 1e-9, "{own} {given}");
    }
}
