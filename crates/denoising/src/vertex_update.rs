//! Moving vertices until the faces have given normals.

use fairing_mesh::TriMesh;
use fairing_parameters::ParameterError;
use fairing_watch::parallel;
use glam::DVec3;

use super::error::DenoiseError;
use super::masked::{Masked, on_oriented};

/// Moves the vertices of `mesh` so that the face normals approach `normals` (unit vectors, one per
/// face; zero for a face to ignore).
///
/// Each of the `steps` moves every vertex towards the planes through the centroids c of
/// its faces F, all at once:
///
/// ```text
/// x ← x + 1/|F| Σ n (n · (c − x))
/// ```
///
/// The update is a step of gradient descent on Σ (n · edge)², with a step length that never needs
/// tuning; volume changes little. A move that would turn a face from agreeing with its normal
/// (positive inner product) to opposing it is halved until it does not, up to three times, and then
/// left out. Faces that oppose their normal already may turn freely. Border vertices move with
/// their faces; isolated and [fixed](Masked) vertices do not move.
///
/// # Errors
///
/// [`DenoiseError::Option`] if there is not one normal per face;
/// [`DenoiseError::Build`] if a normal is not finite.
///
/// Source: [sun2007].
///
/// [sun2007]: https://doi.org/10.1109/TVCG.2007.1065
pub fn update_vertices<'a>(
    mesh: impl Into<Masked<'a>>,
    normals: &[[f64; 3]],
    steps: usize,
) -> Result<TriMesh, DenoiseError> {
    let input = mesh.into();
    let one_each = normals.len() == input.mesh().face_count();
    let (count, expected) = (normals.len() as f64, "the number of faces");
    ParameterError::require(one_each, "number of normals", count, expected)?;
    let normals: Vec<DVec3> = normals.iter().map(|&n| n.into()).collect();
    follow_normals(input, &normals, steps)
}

/// [`update_vertices`] for one normal per face.
pub(crate) fn follow_normals(
    input: Masked<'_>,
    normals: &[DVec3],
    steps: usize,
) -> Result<TriMesh, DenoiseError> {
    on_oriented(input, |input| {
        let mesh = input.mesh();
        let mut positions = mesh.positions().to_vec();
        for _ in 0..steps {
            fairing_watch::check();
            positions = step(input, normals, &positions);
        }
        Ok(mesh.with_positions(positions)?)
    })
}

/// The data of a face in a step.
#[derive(Clone, Copy)]
struct Aim {
    normal: DVec3,
    centroid: DVec3,
    /// A corner that moves less than this alone does not turn the face against
    /// its normal; infinite where the face may turn freely.
    slack: f64,
}

impl Aim {
    fn new([a, b, c]: [DVec3; 3], normal: DVec3) -> Self {
        let sides = [b - a, c - b, a - c];
        let agreement = sides[0].cross(sides[1]).dot(normal);
        // The agreement is linear in a corner, and its gradient at most as long
        // as the side opposite; a margin for rounding.
        let longest = sides.map(DVec3::length).into_iter().fold(0.0, f64::max);
        let slack = if agreement > 0.0 { 0.999 * agreement / longest } else { f64::INFINITY };
        Self { normal, centroid: (a + b + c) * (1.0 / 3.0), slack }
    }
}

/// One step of all vertices from `current`.
fn step(input: Masked<'_>, normals: &[DVec3], current: &[[f64; 3]]) -> Vec<[f64; 3]> {
    let (incidence, faces) = (input.mesh().incidence(), input.mesh().faces());
    let aims: Vec<Aim> = parallel::map(faces.len(), 64, |f| {
        Aim::new(faces[f].map(|v| current[v as usize].into()), normals[f])
    });
    parallel::map(current.len(), 64, |v| {
        if input.is_fixed(v) {
            return current[v];
        }
        let x = DVec3::from(current[v]);
        let corners = incidence.corners(v as u32);
        let (mut sum, mut count, mut slack) = (DVec3::ZERO, 0u32, f64::INFINITY);
        for &c in corners {
            let aim = &aims[c as usize / 3];
            if aim.normal == DVec3::ZERO {
                continue;
            }
            sum += aim.normal.dot(aim.centroid - x) * aim.normal;
            slack = slack.min(aim.slack);
            count += 1;
        }
        let mut y = x + sum * (1.0 / f64::from(count.max(1)));
        if (y - x).length() < slack {
            return y.to_array();
        }
        // A vertex that alone turns a face against its normal goes back
        // part of the way; the neighbours are fixed where they were, so
        // that vertices do not depend on the order they are visited in.
        let turns = |y: DVec3| {
            corners.iter().any(|&c| {
                let (f, k) = (c as usize / 3, c as usize % 3);
                let corner = |i: usize| DVec3::from(current[faces[f][(k + i) % 3] as usize]);
                let (p, q, normal) = (corner(1), corner(2), normals[f]);
                let side = |x: DVec3| (p - x).cross(q - x).dot(normal);
                side(x) > 0.0 && side(y) <= 0.0
            })
        };
        for _ in 0..3 {
            if !turns(y) {
                return y.to_array();
            }
            y = 0.5 * (y + x);
        }
        (if turns(y) { x } else { y }).to_array()
    })
}

#[cfg(test)]
mod tests {
    use fairing_shapes::{Diagonals, plane};

    use super::*;

    /// No vertex that moves alone turns a face against its normal, which plain averages would do.
    #[test]
    fn no_vertex_turns_a_face_alone() {
        let mesh = plane(40, 4, Diagonals::Regular);
        // Steep normals in all directions, from a multiplicative hash.
        let number = |k: usize| ((k * 2_654_435_761) % 65_536) as f64 / 32_768.0 - 1.0;
        let normals: Vec<DVec3> = (0..mesh.face_count())
            .map(|f| DVec3::new(number(2 * f + 1), number(2 * f + 2), 0.2).normalize())
            .collect();
        let x = mesh.positions();
        let moved = step((&mesh).into(), &normals, x);
        let (mut plain, mut kept) = (0, 0);
        for v in 0..x.len() {
            let corners = mesh.incidence().corners(v as u32);
            let here = DVec3::from(x[v]);
            let pulls = corners.iter().map(|&c| {
                let n = normals[c as usize / 3];
                let [p, q, r] = mesh.triangle(c as usize / 3).map(DVec3::from);
                n.dot((p + q + r) * (1.0 / 3.0) - here) * n
            });
            let average = here + pulls.sum::<DVec3>() * (1.0 / corners.len() as f64);
            for &c in corners {
                let (f, k) = (c as usize / 3, c as usize % 3);
                let [p, q] = [1, 2].map(|i| DVec3::from(x[mesh.faces()[f][(k + i) % 3] as usize]));
                let side = |y: DVec3| (p - y).cross(q - y).dot(normals[f]);
                assert!(side(here) > 0.0);
                plain += usize::from(side(average) <= 0.0);
                kept += usize::from(side(moved[v].into()) <= 0.0);
            }
        }
        assert!(plain > 0 && kept == 0, "{plain} {kept}");
    }
}
