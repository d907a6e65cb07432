//! Distances from points on faces, paths and isolines against known ones.

use fairing_mesh::TriMesh;
use fairing_shapes::{self as shapes, Diagonals};
use fairing_spectral::{HeatGeodesics, SpectralError, SurfacePoint, geodesic_path, isolines};

fn sub(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|k| a[k] - b[k])
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|k| a[k] * b[k]).sum()
}

/// Largest error of distances from a point on a face of the unit square.
fn plane_error(n: u32) -> f64 {
    let plane = shapes::irregular_plane(1.0 / f64::from(n), 3);
    let f = plane.face_count() as u32 / 2 + 7;
    let source = SurfacePoint::on_face(&plane, f, [1.0, 2.0, 3.0]).unwrap();
    let from = source.position(&plane);
    let found = HeatGeodesics::new(&plane).unwrap().distance_from(&[source]).unwrap();
    let exact = |p: &[f64; 3]| dot(sub(*p, from), sub(*p, from)).sqrt();
    for v in plane.faces()[f as usize] {
        let straight = exact(&plane.positions()[v as usize]);
        assert!((found[v as usize].unwrap() - straight).abs() < 1e-14);
    }
    let errors = found.iter().zip(plane.positions()).map(|(d, p)| (d.unwrap() - exact(p)).abs());
    errors.fold(0.0, f64::max)
}

#[test]
fn distances_from_a_point_on_a_face_converge() {
    let errors = [20, 40, 80].map(plane_error);
    let orders = [errors[0] / errors[1], errors[1] / errors[2]].map(f64::log2);
    assert!(errors[2] < 0.015 && orders.iter().all(|order| *order > 0.9), "{errors:?}");
}

#[test]
fn a_vertex_is_a_point_on_each_of_its_faces() {
    let sphere = shapes::icosphere(3);
    let heat = HeatGeodesics::new(&sphere).unwrap();
    let [a, _, _] = sphere.faces()[33];
    let corner = SurfacePoint::on_face(&sphere, 33, [5.0, 0.0, 0.0]).unwrap();
    assert_eq!(corner, SurfacePoint::vertex(a));
    assert_eq!(heat.distance(&[a]).unwrap(), heat.distance_from(&[corner, corner]).unwrap());
    let near = sphere.positions()[a as usize].map(|x| 1.5 * x);
    let nearest = SurfacePoint::projected(&sphere, 33, near).unwrap().position(&sphere);
    assert!(dot(sub(nearest, sphere.positions()[a as usize]), [1.0; 3]).abs() < 0.05);
    for weights in [[-1.0, 2.0, 0.0], [0.0; 3], [f64::NAN, 1.0, 1.0]] {
        assert!(SurfacePoint::on_face(&sphere, 0, weights).is_err());
    }
    let outside = SurfacePoint::on_face(&sphere, 5000, [1.0; 3]).unwrap_err();
    assert_eq!(outside, SpectralError::NoSuchFace { face: 5000, faces: 1280 });
}

/// Excess of the lengths of paths over the great circles, and the largest distance of their points
/// from these, on a sphere.
fn sphere_excess(mesh: &TriMesh, from: u32) -> (f64, f64) {
    let distance = HeatGeodesics::new(mesh).unwrap().distance(&[from]).unwrap();
    let source = [SurfacePoint::vertex(from)];
    let p = mesh.positions();
    let (mut excess, mut off) = (0.0_f64, 0.0_f64);
    for start in (0..mesh.vertex_count() as u32).step_by(37) {
        let exact = dot(p[from as usize], p[start as usize]).clamp(-1.0, 1.0).acos();
        if !(0.3..2.8).contains(&exact) {
            continue;
        }
        let path = geodesic_path(mesh, &distance, &source, start).unwrap();
        assert_eq!((path.end, path.points[0]), (Some(from), p[start as usize]));
        excess = excess.max(path.length() / exact - 1.0);
        let [a, b] = [from, start].map(|v| p[v as usize]);
        let normal =
            [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
        let length = dot(normal, normal).sqrt();
        let points = path.points.iter().map(|q| dot(*q, normal).abs() / length);
        off = points.fold(off, f64::max);
    }
    (excess, off)
}

#[test]
fn paths_follow_great_circles() {
    let coarse = sphere_excess(&shapes::icosphere(3), 17);
    let fine = sphere_excess(&shapes::icosphere(5), 17);
    assert!(fine.0 < 0.01 && fine.1 < 0.05, "{fine:?}");
    assert!(fine.1 < coarse.1, "{fine:?} {coarse:?}");
    let irregular = shapes::jittered(&shapes::icosphere(4), 0.4, 5, shapes::onto_sphere);
    let (excess, off) = sphere_excess(&irregular, 99);
    assert!(excess < 0.03 && off < 0.1, "{excess} {off}");
}

#[test]
fn paths_end_at_points_on_faces_and_stay_on_their_component() {
    let plane = shapes::plane(20, 20, Diagonals::Alternating);
    let source = SurfacePoint::on_face(&plane, 211, [1.0, 1.0, 1.0]).unwrap();
    let distance = HeatGeodesics::new(&plane).unwrap().distance_from(&[source]).unwrap();
    for start in [0, 20, 440, 200] {
        let path = geodesic_path(&plane, &distance, &[source], start).unwrap();
        assert_eq!(path.end, None);
        let ends = sub(*path.points.last().unwrap(), plane.positions()[start as usize]);
        let straight = dot(ends, ends).sqrt();
        // In edges: near the source the gradient of the distance is at its worst.
        let excess = (path.length() - straight) / 0.05;
        assert!((-1e-12..1.0).contains(&excess), "{start}: {excess} {path:?}");
    }
    let unreached: Vec<Option<f64>> = vec![None; plane.vertex_count()];
    let error = geodesic_path(&plane, &unreached, &[source], 3).unwrap_err();
    assert_eq!(error, SpectralError::Unreached { vertex: 3 });
    assert!(geodesic_path(&plane, &distance[1..], &[source], 3).is_err());
}

/// Any values at all: paths fall and end.
#[test]
fn paths_end_on_any_field() {
    let mesh = shapes::jittered(&shapes::torus(2.0, 0.7, 24, 12), 0.3, 2, |p| p);
    for seed in 0..40_u64 {
        let noise = |v: u64| (v + 1).wrapping_mul(0x9E37_79B9_7F4A_7C15 ^ (seed << 17)) >> 60;
        let field: Vec<Option<f64>> =
            (0..mesh.vertex_count() as u64).map(|v| Some(noise(v) as f64)).collect();
        for start in (0..mesh.vertex_count() as u32).step_by(7) {
            let path = geodesic_path(&mesh, &field, &[], start).unwrap();
            let end = field[path.end.unwrap() as usize].unwrap();
            assert!(end <= field[start as usize].unwrap());
            assert!(path.points.iter().flatten().all(|x| x.is_finite()));
        }
    }
}

/// Isolines of the height of a sphere are circles, each one closed piece.
#[test]
fn isolines_of_a_height_are_circles() {
    let sphere = shapes::icosphere(4);
    let height: Vec<Option<f64>> = sphere.positions().iter().map(|p| Some(p[2])).collect();
    for level in [0.0, 0.3, -0.77] {
        let pieces = isolines(&sphere, &height, level).unwrap();
        let [line] = &pieces[..] else { panic!("{} pieces", pieces.len()) };
        let circle = std::f64::consts::TAU * (1.0 - level * level).sqrt();
        let length = line.length();
        assert!(line.closed && (length / circle - 1.0).abs() < 5e-3, "{level}: {length} {circle}");
        assert!(line.points.iter().all(|p| (p[2] - level).abs() < 1e-15));
        for ([a, b], p) in line.edges.iter().zip(&line.points) {
            let ends = [a, b].map(|v| sphere.positions()[*v as usize]);
            let along = sub(ends[1], ends[0]);
            let reach = dot(sub(*p, ends[0]), along) / dot(along, along).max(f64::MIN_POSITIVE);
            let nearest: [f64; 3] = std::array::from_fn(|k| ends[0][k] + reach * along[k]);
            assert!(dot(sub(nearest, *p), sub(nearest, *p)).sqrt() < 1e-15);
        }
    }
    assert!(isolines(&sphere, &height[1..], 0.0).is_err());
    assert!(isolines(&sphere, &vec![None; sphere.vertex_count()], 0.0).unwrap().is_empty());
}

/// Levels through vertices, along edges and borders: each segment once, none of length zero.
#[test]
fn isolines_along_edges_and_borders() {
    let plane = shapes::plane(8, 8, Diagonals::Alternating);
    let x: Vec<Option<f64>> = plane.positions().iter().map(|p| Some(p[0])).collect();
    for level in [0.0, 0.5, 1.0] {
        let pieces = isolines(&plane, &x, level).unwrap();
        let [line] = &pieces[..] else { panic!("{} pieces at {level}", pieces.len()) };
        assert!(!line.closed && (line.length() - 1.0).abs() < 1e-12);
        assert!(line.segments().all(|[p, q]| p != q));
    }
    // A plateau has an outline, and so has a field that is level everywhere.
    let roof = |p: &[f64; 3]| 1.0 - ((p[0] - 0.5).abs().max((p[1] - 0.5).abs()) - 0.25).max(0.0);
    let roof: Vec<Option<f64>> = plane.positions().iter().map(|p| Some(roof(p))).collect();
    for (field, side) in [(roof, 0.5), (vec![Some(1.0); x.len()], 1.0)] {
        let pieces = isolines(&plane, &field, 1.0).unwrap();
        let [line] = &pieces[..] else { panic!("{} pieces", pieces.len()) };
        assert!(line.closed && (line.length() - 4.0 * side).abs() < 1e-12, "{}", line.length());
    }
}

/// Any values, among them huge, tiny, infinite and missing ones, give finite pieces whose segments
/// differ and have a length.
#[test]
fn isolines_of_any_field_are_pieces() {
    let mesh = shapes::jittered(&shapes::torus(2.0, 0.7, 24, 12), 0.3, 2, |p| p);
    let values = [-1.0, 0.0, -0.0, 1.0, f64::MAX, f64::MIN, 5e-324, 1e-17, f64::INFINITY, f64::NAN];
    for seed in 0..60_u64 {
        let pick = |v: u64| (v + 1).wrapping_mul(0x9E37_79B9_7F4A_7C15 ^ (seed << 17)) >> 33;
        let few = if seed % 2 == 0 { 4 } else { 11 };
        let field: Vec<Option<f64>> = (0..mesh.vertex_count() as u64)
            .map(|v| values.get((pick(v) % few) as usize).copied())
            .collect();
        for level in [0.0, 1.0, 1e-20, f64::MAX] {
            let pieces = isolines(&mesh, &field, level).unwrap();
            let mut segments: Vec<[[u64; 3]; 2]> = vec![];
            for [p, q] in pieces.iter().flat_map(|piece| piece.segments().collect::<Vec<_>>()) {
                assert!(p != q && p.iter().chain(&q).all(|x| x.is_finite()));
                let mut ends = [p, q].map(|p| p.map(|x| (x + 0.0).to_bits()));
                ends.sort_unstable();
                segments.push(ends);
            }
            let count = segments.len();
            segments.sort_unstable();
            segments.dedup();
            assert_eq!(segments.len(), count, "seed {seed}, level {level}");
        }
    }
}
