//! An animal with limbs, a stand-in for scanned figures.

use super::grid::made;
use super::implicit::implicit;
use fairing_mesh::TriMesh;
use glam::DVec3;

/// A limb: the points closer to the segment than a radius that goes from
/// `radii[0]` to `radii[1]` along it.
struct Limb {
    ends: [[f64; 3]; 2],
    radii: [f64; 2],
}

const fn limb(ends: [[f64; 3]; 2], radii: [f64; 2]) -> Limb {
    Limb { ends, radii }
}

/// Standing on z, looking along −y, the left half (x > 0) of it; the rest is
/// its mirror image.
const LIMBS: [Limb; 12] = [
    limb([[0.0, 0.02, 0.12], [0.0, 0.06, -0.18]], [0.24, 0.28]), // trunk
    limb([[0.0, -0.02, 0.42], [0.0, -0.10, 0.50]], [0.13, 0.14]), // head
    limb([[0.0, -0.16, 0.47], [0.0, -0.36, 0.42]], [0.09, 0.045]), // snout
    limb([[0.08, -0.04, 0.58], [0.14, 0.00, 0.76]], [0.035, 0.05]), // ear
    limb([[0.20, 0.00, 0.22], [0.42, -0.06, 0.16]], [0.10, 0.08]), // arm
    limb([[0.42, -0.06, 0.16], [0.52, -0.26, 0.34]], [0.08, 0.065]),
    limb([[0.52, -0.26, 0.34], [0.50, -0.36, 0.44]], [0.05, 0.03]), // fingers
    limb([[0.54, -0.26, 0.36], [0.66, -0.26, 0.46]], [0.05, 0.035]),
    limb([[0.15, 0.04, -0.32], [0.24, -0.06, -0.56]], [0.14, 0.10]), // leg
    limb([[0.24, -0.06, -0.56], [0.26, 0.02, -0.80]], [0.10, 0.08]),
    limb([[0.26, 0.00, -0.84], [0.28, -0.20, -0.86]], [0.075, 0.06]), // foot
    limb([[0.0, 0.22, -0.30], [0.0, 0.62, -0.62]], [0.14, 0.05]),     // tail
];

/// An upright animal about 1.8 high with head, ears, limbs, fingers, a tail, a grooved back and
/// wrinkled skin: smooth, closed, genus 0, in nearly equal triangles of about `2 / resolution`,
/// vertices on the analytic surface. It stands along y and looks along +z, as scanned figures do.
/// Below a resolution of 48 the limbs are thickened to the triangle size, and the animal has paws
/// instead of fingers.
///
/// The field is a smooth union of tapered limbs with waves of small amplitude
/// added; the surface is its zero set. Numbering follows the grid that found
/// the surface, from the feet up. A resolution of 100 gives about 13
/// thousand vertices.
///
/// # Panics
///
/// Unless 24 ≤ `resolution` ≤ 320: a coarser grid tears the thin parts.
pub fn creature(resolution: u32) -> TriMesh {
    assert!((24..=320).contains(&resolution), "resolution {resolution} is not in [24, 320]");
    // The thinnest limb has a radius of 0.03, which is enough for 48; thick soles need some room
    // below.
    let (least, half) = match resolution {
        ..48 => (1.58 / f64::from(resolution), 1.1),
        _ => (0.0, 1.0),
    };
    let mesh = implicit(|p| field(p, least), half, resolution as usize);
    let standing_on_y = mesh.positions().iter().map(|&[x, y, z]| [x, z, -y]).collect();
    made(standing_on_y, mesh.faces().to_vec())
}

/// Negative inside; limbs have radii of at least `least`.
fn field([x, y, z]: [f64; 3], least: f64) -> f64 {
    let p = [x, y, z];
    // −log Σ exp(−k dᵢ) / k: a union that rounds its inner corners.
    const SHARPNESS: f64 = 32.0;
    let sum: f64 = LIMBS
        .iter()
        .flat_map(|limb| {
            let middle = limb.ends.iter().all(|e| e[0] == 0.0);
            let left = limb.distance(p, least);
            let right = (!middle).then(|| limb.distance([-x, y, z], least));
            [Some(left), right]
        })
        .flatten()
        .map(|d| libm::exp(-SHARPNESS * d))
        .sum();
    let skin = 0.004 * libm::sin(31.0 * x) * libm::sin(29.0 * y + 1.0) * libm::sin(27.0 * z);
    // Grooves across the back, fading to the front.
    let back = 1.0 / (1.0 + libm::exp(-30.0 * (y - 0.12)));
    -libm::log(sum) / SHARPNESS + skin + 0.010 * back * libm::sin(34.0 * z)
}

impl Limb {
    /// About the signed distance: exact where the radius is constant. The
    /// radius levels off at both ends, which keeps the gradient continuous
    /// there; second derivatives jump, as at the ends of a capsule.
    fn distance(&self, p: [f64; 3], least: f64) -> f64 {
        let (p, [a, b]) = (DVec3::from(p), self.ends.map(DVec3::from));
        let d = b - a;
        let t = ((p - a).dot(d) / d.dot(d)).clamp(0.0, 1.0);
        let level = t * t * (3.0 - 2.0 * t);
        let radius = self.radii[0] + level * (self.radii[1] - self.radii[0]);
        p.distance(a + t * d) - radius.max(least)
    }
}
