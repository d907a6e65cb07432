//! Areas and volumes.

use fairing_shapes as shapes;

/// The volume of an inscribed polyhedron differs from that of the sphere by O(h²): each
/// level divides the error by four.
#[test]
fn area_and_volume_of_a_sphere_converge() {
    let errors: Vec<[f64; 2]> = (2..=5)
        .map(|level| {
            let sphere = shapes::icosphere(level);
            let pi = std::f64::consts::PI;
            [4.0 * pi - sphere.area(), 4.0 / 3.0 * pi - sphere.signed_volume()]
        })
        .collect();
    for pair in errors.windows(2) {
        for k in 0..2 {
            let order = (pair[0][k] / pair[1][k]).log2();
            assert!((1.97..2.01).contains(&order), "{order} in {errors:?}");
        }
    }
}

/// The volume of a flat sheet is within rounding of zero; that of a plate a
/// millionth as thick as wide is not.
#[test]
fn volumes_below_their_rounding_are_told_from_thin_bodies() {
    let mut plate = shapes::cube(6, shapes::Diagonals::Alternating);
    for turn in 0..40 {
        let (s, c) = f64::from(turn).sin_cos();
        for (thickness, thin) in [(0.0, true), (1e-6, false), (1.0, false)] {
            let cube = shapes::cube(6, shapes::Diagonals::Alternating);
            let positions = cube.positions().iter().map(|&[x, y, z]| {
                let z = thickness * z;
                let (x, z) = (c * x - s * z, s * x + c * z);
                [c * x - s * y + 3.0, s * x + c * y, z]
            });
            plate = plate.with_positions(positions.collect()).unwrap();
            let (volume, rounding) = (plate.signed_volume().abs(), plate.volume_rounding());
            assert_eq!(volume <= rounding, thin, "{thickness} {volume} {rounding}");
        }
    }
}

/// A surface moved by 10⁷ times its size has 16 − 7 = 9 digits left in each
/// coordinate, and the volume must not lose more.
#[test]
fn volume_far_from_the_origin() {
    let sphere = shapes::icosphere(3);
    let moved = sphere.positions().iter().map(|p| p.map(|x| x + 1e7)).collect();
    let moved = sphere.with_positions(moved).unwrap();
    assert!((moved.signed_volume() - sphere.signed_volume()).abs() < 1e-7);
}

/// Sums over a chunk round once per face, so the bound grows with the number of faces:
/// about 16 times for 16 times as many.
#[test]
fn the_rounding_of_a_volume_grows_with_the_number_of_faces() {
    let bound = |n| shapes::cube(n, shapes::Diagonals::Regular).volume_rounding();
    let ratio = bound(16) / bound(4);
    assert!((10.0..20.0).contains(&ratio), "{ratio}");
}

/// Sums of numbers of very different sizes are bitwise equal for every number of threads.
#[test]
fn measures_do_not_depend_on_threads() {
    let sphere = shapes::icosphere(7);
    let bent = |p: &[f64; 3]| [p[0].exp(), p[1] + p[0] * p[0], (3.0 * p[2]).exp()];
    let mesh = sphere.with_positions(sphere.positions().iter().map(bent).collect()).unwrap();
    assert!(mesh.face_count() > 16 * 4096);
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| [mesh.area(), mesh.signed_volume(), mesh.volume_rounding()])
    };
    let first = run(1);
    for threads in [2, 3, 8] {
        assert_eq!(run(threads), first, "{threads}");
    }
}
