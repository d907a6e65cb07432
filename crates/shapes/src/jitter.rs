//! Irregular meshes of the same surface.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use fairing_mesh::TriMesh;
use glam::DVec3;

/// The mesh with each inner vertex moved at random and projected back `onto` its surface: an
/// irregular sampling of the same surface, for convergence studies.
///
/// The displacement is uniform in the ball of radius `amount` × the least height of the faces at
/// the vertex: below ½, no corner can meet the side opposite it, so that on a flat mesh no face
/// turns over, nor on a curved one fine enough. Boundary vertices do not move, so the border is
/// unchanged.
///
/// # Panics
///
/// Unless 0 ≤ `amount` < ½; if `onto` gives a point that is not finite.
pub fn jittered(
    mesh: &TriMesh,
    amount: f64,
    seed: u64,
    onto: impl Fn([f64; 3]) -> [f64; 3],
) -> TriMesh {
    assert!((0.0..0.5).contains(&amount), "amount {amount} is not in [0, 1/2)");
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let x = mesh.positions();
    let topology = mesh.topology();
    let positions = (0..mesh.vertex_count())
        .map(|v| {
            let shift = in_unit_ball(&mut rng);
            let faces = mesh.incidence().corners(v as u32).iter().map(|c| c / 3);
            let height = faces.map(|f| least_height(mesh, f as usize)).reduce(f64::min);
            match height {
                Some(height) if !topology.is_boundary_vertex(v as u32) => {
                    onto((DVec3::from(x[v]) + amount * height * shift).to_array())
                }
                _ => x[v],
            }
        })
        .collect();
    match mesh.with_positions(positions) {
        Ok(moved) => moved,
        Err(error) => panic!("the projection left the surface: {error}"),
    }
}

/// Twice the area over the longest side.
fn least_height(mesh: &TriMesh, f: usize) -> f64 {
    let [a, b, c] = mesh.triangle(f).map(DVec3::from);
    2.0 * mesh.face_area(f) / a.distance(b).max(b.distance(c)).max(c.distance(a))
}

/// A point of the unit ball, all equally likely.
fn in_unit_ball(rng: &mut ChaCha8Rng) -> DVec3 {
    loop {
        let p = DVec3::from(std::array::from_fn(|_| rng.random_range(-1.0..=1.0)));
        if p.length() <= 1.0 {
            return p;
        }
    }
}

/// The closest point of the unit sphere; the centre goes to (0, 0, 1).
pub fn onto_sphere(p: [f64; 3]) -> [f64; 3] {
    DVec3::from(p).normalize_or(DVec3::Z).to_array()
}

/// A point of the ellipsoid with these half-axes near `p`, for `p` near the surface: three Newton
/// steps along the gradient of x²/a² + y²/b² + z²/c² come closer to the closest point than the
/// length of the jitter; a final central projection puts the point on the surface. The centre goes
/// to (0, 0, c).
pub fn onto_ellipsoid(axes: [f64; 3]) -> impl Fn([f64; 3]) -> [f64; 3] {
    let axes = DVec3::from(axes);
    move |p| {
        let mut p = DVec3::from(p);
        for _ in 0..3 {
            let g = 2.0 * p / (axes * axes);
            let f = (p / axes).length_squared() - 1.0;
            let square = g.dot(g);
            if square > 0.0 {
                p -= g * (f / square);
            }
        }
        (axes * DVec3::from(onto_sphere((p / axes).to_array()))).to_array()
    }
}

/// The closest point of [`torus`](super::torus)`(major, minor, …)`. Points of
/// the axis and of the centre line have no closest one and go towards +x and
/// outwards.
pub fn onto_torus(major: f64, minor: f64) -> impl Fn([f64; 3]) -> [f64; 3] {
    move |[x, y, z]| {
        let r = libm::hypot(x, y);
        let [cu, su] = if r > 0.0 { [x / r, y / r] } else { [1.0, 0.0] };
        let (a, length) = (r - major, libm::hypot(r - major, z));
        let [cv, sv] = if length > 0.0 { [a / length, z / length] } else { [1.0, 0.0] };
        let s = major + minor * cv;
        [s * cu, s * su, minor * sv]
    }
}
