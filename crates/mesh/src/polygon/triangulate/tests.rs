use proptest::collection::vec;
use proptest::prelude::*;

use super::*;
use crate::trimesh::TriMesh;

/// The triangles of one polygon.
fn triangulated(points: &[[f64; 3]]) -> TriMesh {
    let corners: Vec<u32> = (0..points.len() as u32).collect();
    PolygonMesh::new(points.to_vec(), [corners]).unwrap().triangulate()
}

fn area_of(points: &[DVec3]) -> f64 {
    area_vector(points).length() / 2.0
}

#[test]
fn convex_polygons_are_fans_around_the_first_corner() {
    let square = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
    assert_eq!(triangulated(&square).faces(), [[0, 1, 2], [0, 2, 3]]);
    let hexagon: Vec<[f64; 3]> = (0..6)
        .map(|k| f64::from(k).mul_add(std::f64::consts::FRAC_PI_3, 0.1))
        .map(|t| [0.0, t.cos(), t.sin()])
        .collect();
    let fan = [[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 5]];
    assert_eq!(triangulated(&hexagon).faces(), fan);
}

/// A corner that turns by a millionth is one, to the left or to the right.
#[test]
fn blunt_corners_are_corners() {
    let with_depth =
        |y: f64| triangulated(&[[0.0, 0.0, 0.0], [1.0, y, 0.0], [2.0, 0.0, 0.0], [1.0, 1.0, 0.0]]);
    assert_eq!(with_depth(-1e-6).faces(), [[0, 1, 2], [0, 2, 3]]);
    let dart = with_depth(1e-6);
    assert!(dart.faces().iter().all(|face| face.contains(&1)), "{:?}", dart.faces());
}

/// The diagonal of a dart runs from its inner corner, wherever that stands; a
/// fan around any other corner would cover the outside.
#[test]
fn concave_quadrilaterals_are_cut_at_the_inner_corner() {
    let dart = [[0.0, 0.0, 2.0], [4.0, 0.0, 2.0], [1.0, 1.0, 2.0], [0.0, 4.0, 2.0]];
    for start in 0..4 {
        let points: Vec<[f64; 3]> = (0..4).map(|k| dart[(k + start) % 4]).collect();
        let mesh = triangulated(&points);
        let inner = ((2 + 4 - start) % 4) as u32;
        assert!(mesh.faces().iter().all(|face| face.contains(&inner)), "{start}");
        assert!((0..2).all(|f| mesh.area_vector(f)[2] > 0.0), "{start}");
    }
}

/// A square with a vertex on each side: a fan around the vertex of a side has
/// triangles without area.
#[test]
fn straight_corners_do_not_yield_triangles_without_area() {
    let mut ring = Vec::new();
    for [x, y] in [
        [0.0, 0.0],
        [1.0, 0.0],
        [2.0, 0.0],
        [2.0, 1.0],
        [2.0, 2.0],
        [1.0, 2.0],
        [0.0, 2.0],
        [0.0, 1.0],
    ] {
        ring.push([x, y, 0.0]);
    }
    for start in 0..8 {
        ring.rotate_left(1);
        let mesh = triangulated(&ring);
        let areas: Vec<f64> = (0..6).map(|f| mesh.area_vector(f)[2]).collect();
        assert!(areas.iter().all(|&a| a > 0.0), "{start}: {areas:?}");
        assert!((areas.iter().sum::<f64>() - 4.0).abs() < 1e-12);
    }
}

#[test]
fn polygons_without_area_still_yield_their_triangles() {
    let line: Vec<[f64; 3]> = (0..5).map(|k| [f64::from(k), 0.0, 0.0]).collect();
    assert_eq!(triangulated(&line).face_count(), 3);
    assert_eq!(triangulated(&[[1.0; 3]; 6]).face_count(), 4);
    let bow_tie = [[0.0, 0.0, 0.0], [1.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    assert_eq!(triangulated(&bow_tie).face_count(), 2);
    let huge = [4e29, -4e29].map(|x| [[x, x, 0.0], [-x, x, 0.0]]).concat();
    assert_eq!(triangulated(&huge).face_count(), 2);
}

/// Checks n − 2 triangles that turn like the polygon and have its area.
fn check_cover(points: &[[f64; 3]]) {
    let mesh = triangulated(points);
    assert_eq!(mesh.face_count(), points.len() - 2);
    let points: Vec<DVec3> = points.iter().map(|&p| p.into()).collect();
    let normal = area_vector(&points);
    let area = normal.length() / 2.0;
    let turned = |f: usize| DVec3::from(mesh.area_vector(f)).dot(normal.normalize());
    // Of the size of rounding in a triangle within an extent of 1 to 10.
    assert!((0..mesh.face_count()).all(|f| turned(f) > -1e-14));
    let total: f64 = (0..mesh.face_count()).map(|f| mesh.face_area(f)).sum();
    let rounding = 1e-15 * points.len() as f64;
    assert!((total / area - 1.0).abs() < rounding, "{total} of {area}");
}

/// Long arms in each other, teeth on a back, and both far from convex: a fan has a multiple of
/// the area.
#[test]
fn large_concave_polygons_are_covered_once() {
    for n in [1_100, 5_000, 20_000] {
        let arm = |k: u32, r: f64| {
            let t = f64::from(k) / f64::from(n / 2) * 20.0 * std::f64::consts::TAU;
            let r = r + t / 126.0;
            [r * t.cos(), 0.8 * r * t.sin(), 0.6 * r * t.sin()]
        };
        let mut spiral: Vec<[f64; 3]> = (0..n / 2).map(|k| arm(k, 0.23)).collect();
        spiral.extend((0..n / 2).rev().map(|k| arm(k, 0.2)));
        spiral.reverse();
        check_cover(&spiral);
        let mut comb = vec![[1.0, 0.0, 2.0], [0.0, 0.0, 2.0]];
        let teeth = n / 4;
        for tooth in 0..teeth {
            for (side, y) in [(0.0, 0.1), (0.0, 1.0), (0.5, 1.0), (0.5, 0.1)] {
                comb.push([(f64::from(tooth) + side) / f64::from(teeth), y, 2.0]);
            }
        }
        check_cover(&comb);
    }
}

/// Bridges to a hole pass twice through the same points.
#[test]
fn bridged_holes_stay_open() {
    let circle = |n: u32, r: f64| {
        (0..=n).map(move |k| {
            let t = f64::from(k % n) / f64::from(n) * std::f64::consts::TAU;
            [r * t.cos(), r * t.sin(), 0.0]
        })
    };
    let inner: Vec<[f64; 3]> = circle(1_000, 0.5).collect();
    let ring: Vec<[f64; 3]> = circle(1_000, 1.0).chain(inner.into_iter().rev()).collect();
    check_cover(&ring);
}

#[test]
fn polygons_that_cross_themselves_are_found() {
    let crossing = |points: &[[f64; 3]]| {
        let corners: Vec<u32> = (0..points.len() as u32).collect();
        PolygonMesh::new(points.to_vec(), [corners]).unwrap().split().2
    };
    let five_pointed: Vec<[f64; 3]> = (0..5)
        .map(|k| f64::from(2 * k) * std::f64::consts::TAU / 5.0)
        .map(|t| [t.cos(), t.sin(), 0.0])
        .collect();
    let bow_tie = [[0.0, 0.0, 0.0], [2.0, 1.0, 0.0], [2.0, 0.0, 0.0], [0.0, 1.5, 0.0]];
    let dart = [[0.0, 0.0, 2.0], [4.0, 0.0, 2.0], [1.0, 1.0, 2.0], [0.0, 4.0, 2.0]];
    assert_eq!(crossing(&bow_tie), [0]);
    assert!(crossing(&dart).is_empty());
    // All corners turn alike, and the sides go round twice.
    assert_eq!(crossing(&five_pointed), [0]);
    let ten = (0..10).map(|k| f64::from(k) * std::f64::consts::TAU / 10.0);
    assert!(crossing(&ten.map(|t| [t.cos(), t.sin(), 0.0]).collect::<Vec<_>>()).is_empty());
}

#[test]
fn large_polygons_end_soon() {
    let star: Vec<[f64; 3]> = (0..100_000)
        .map(|k| {
            let (t, r) = (f64::from(k) / 1e5 * std::f64::consts::TAU, 1.0 + f64::from(k % 2));
            [r * t.cos(), r * t.sin(), 0.0]
        })
        .collect();
    assert_eq!(triangulated(&star).face_count(), 99_998);
}

proptest! {
    /// A polygon that a centre sees whole, in a tilted plane far away: the
    /// triangles turn like the polygon and cover it exactly once.
    #[test]
    fn star_shaped_polygons_are_covered_once(
        radii in vec(0.2f64..2.0, 4..40),
        tilt in -1.0f64..1.0,
        shift in -1e4f64..1e4,
        start in 0usize..40,
    ) {
        let n = radii.len();
        let mut points: Vec<[f64; 3]> = radii.iter().enumerate().map(|(k, r)| {
            let t = k as f64 / n as f64 * std::f64::consts::TAU;
            let (x, y) = (r * t.cos(), r * t.sin());
            [x + shift, y * tilt.cos() - shift, y * tilt.sin() + 2.0 * shift]
        }).collect();
        points.rotate_left(start % n);
        let mesh = triangulated(&points);
        prop_assert_eq!(mesh.face_count(), n - 2);
        let points: Vec<DVec3> = points.into_iter().map(DVec3::from).collect();
        let normal = area_vector(&centered(&points));
        let total: f64 = (0..n - 2).map(|f| mesh.face_area(f)).sum();
        for f in 0..n - 2 {
            // Triangles of nearly straight corners may lie at rounding.
            let turned = DVec3::from(mesh.area_vector(f)).dot(normal) / normal.length();
            prop_assert!(turned > -1e-9 * total, "{} of {}", turned, total);
        }
        // Coordinates of 1e4 carry the area of 1 to about 1e-11.
        let local: Vec<DVec3> = points.iter().map(|&p| p - points[0]).collect();
        prop_assert!((total - area_of(&local)).abs() < 1e-8 * total);
    }
}
