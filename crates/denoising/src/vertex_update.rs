//! Moving vertices until the faces have given normals.

use fairing_mesh::TriMesh;
use fairing_mesh::vec3::{add, cross, dot, norm, scale, sub};
use fairing_parameters::OptionError;
use rayon::prelude::*;

use super::DenoiseError;
use super::oriented::on_oriented;

/// The rule by which [`update_vertices`] moves vertices.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
pub struct VertexUpdate {
    /// Steps over all vertices.
    pub steps: usize,
    /// The largest distance from the input, in mesh units; vertices are kept
    /// on that sphere. `None`: no limit.
    pub limit: Option<f64>,
}

impl Default for VertexUpdate {
    /// Ten steps without a limit.
    fn default() -> Self {
        Self { steps: 10, limit: None }
    }
}

/// Moves the vertices of `mesh` so that the face normals approach `normals`
/// (unit vectors, one per face; zero for a face that is to have no say).
///
/// Each step moves every vertex towards the planes through the centroids c of
/// its faces F, all at once:
///
/// ```text
/// x ← x + 1/|F| Σ n (n · (c − x))
/// ```
///
/// The update is a step of gradient descent on Σ (n · edge)², with a step length that
/// never needs tuning; volume changes little. A move that would turn a face from
/// agreeing with its normal (positive inner product) to opposing it is halved
/// until it does not, up to three times, and then left out. Faces that oppose
/// their normal already may turn freely. Border vertices move with the faces
/// they have; isolated ones stay.
///
/// # Errors
///
/// [`DenoiseError::Option`] if there is not one normal per face or the
/// limit is not positive; [`DenoiseError::Build`] if a normal is not
/// finite.
///
/// Source: \[sun2007\].
pub fn update_vertices(
    mesh: &TriMesh,
    normals: &[[f64; 3]],
    options: &VertexUpdate,
) -> Result<TriMesh, DenoiseError> {
    let one_each = normals.len() == mesh.face_count();
    let (count, expected) = (normals.len() as f64, "the number of faces");
    OptionError::require(one_each, "number of normals", count, expected)?;
    if let Some(limit) = options.limit {
        OptionError::require_positive("limit", limit)?;
    }
    on_oriented(mesh, |mesh| {
        let start = mesh.positions();
        let mut positions = start.to_vec();
        for _ in 0..options.steps {
            fairing_watch::check();
            positions = step(mesh, normals, start, &positions, options.limit);
        }
        Ok(mesh.with_positions(positions)?)
    })
}

/// The data of a face in a step.
#[derive(Clone, Copy)]
struct Aim {
    normal: [f64; 3],
    centroid: [f64; 3],
    /// A corner that moves less than this alone does not turn the face against
    /// its normal; infinite where the face may turn freely.
    slack: f64,
}

impl Aim {
    fn new([a, b, c]: [[f64; 3]; 3], normal: [f64; 3]) -> Self {
        let sides = [sub(b, a), sub(c, b), sub(a, c)];
        let agreement = dot(cross(sides[0], sides[1]), normal);
        // The agreement is linear in a corner, and its gradient at most as long
        // as the side opposite; a margin for rounding.
        let longest = sides.map(norm).into_iter().fold(0.0, f64::max);
        let slack = if agreement > 0.0 { 0.999 * agreement / longest } else { f64::INFINITY };
        Self { normal, centroid: scale(add(add(a, b), c), 1.0 / 3.0), slack }
    }
}

/// One step of all vertices from `current`.
fn step(
    mesh: &TriMesh,
    normals: &[[f64; 3]],
    start: &[[f64; 3]],
    current: &[[f64; 3]],
    limit: Option<f64>,
) -> Vec<[f64; 3]> {
    let (incidence, faces) = (mesh.incidence(), mesh.faces());
    let aims: Vec<Aim> = faces
        .par_iter()
        .zip(normals)
        .map(|(face, &normal)| Aim::new(face.map(|v| current[v as usize]), normal))
        .collect();
    (0..current.len())
        .into_par_iter()
        .map(|v| {
            let x = current[v];
            let corners = incidence.corners(v as u32);
            let (mut sum, mut count, mut slack) = ([0.0; 3], 0u32, f64::INFINITY);
            for &c in corners {
                let aim = &aims[c as usize / 3];
                if aim.normal == [0.0; 3] {
                    continue;
                }
                sum = add(sum, scale(aim.normal, dot(aim.normal, sub(aim.centroid, x))));
                slack = slack.min(aim.slack);
                count += 1;
            }
            let mut y = add(x, scale(sum, 1.0 / f64::from(count.max(1))));
            if let Some(limit) = limit {
                let offset = sub(y, start[v]);
                let length = norm(offset);
                if length > limit {
                    y = add(start[v], scale(offset, limit / length));
                }
            }
            if norm(sub(y, x)) < slack {
                return y;
            }
            // A vertex that alone turns a face against its normal goes back
            // part of the way; the neighbours are fixed where they were, so
            // that vertices do not depend on the order they are visited in.
            let turns = |y: [f64; 3]| {
                corners.iter().any(|&c| {
                    let (f, k) = (c as usize / 3, c as usize % 3);
                    let p = current[faces[f][(k + 1) % 3] as usize];
                    let q = current[faces[f][(k + 2) % 3] as usize];
                    let side = |x| dot(cross(sub(p, x), sub(q, x)), normals[f]);
                    side(x) > 0.0 && side(y) <= 0.0
                })
            };
            for _ in 0..3 {
                if !turns(y) {
                    return y;
                }
                y = scale(add(y, x), 0.5);
            }
            if turns(y) { x } else { y }
        })
        .collect()
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
        let normals: Vec<[f64; 3]> = (0..mesh.face_count())
            .map(|f| {
                let n = [number(2 * f + 1), number(2 * f + 2), 0.2];
                scale(n, 1.0 / norm(n))
            })
            .collect();
        let x = mesh.positions();
        let moved = step(&mesh, &normals, x, x, None);
        let (mut plain, mut kept) = (0, 0);
        for v in 0..x.len() {
            let corners = mesh.incidence().corners(v as u32);
            let sum = corners.iter().fold([0.0; 3], |sum, &c| {
                let (n, p) = (normals[c as usize / 3], mesh.triangle(c as usize / 3));
                let centroid = scale(add(add(p[0], p[1]), p[2]), 1.0 / 3.0);
                add(sum, scale(n, dot(n, sub(centroid, x[v]))))
            });
            let average = add(x[v], scale(sum, 1.0 / corners.len() as f64));
            for &c in corners {
                let (f, k) = (c as usize / 3, c as usize % 3);
                let [p, q] = [1, 2].map(|i| x[mesh.faces()[f][(k + i) % 3] as usize]);
                let side = |y| dot(cross(sub(p, y), sub(q, y)), normals[f]);
                assert!(side(x[v]) > 0.0);
                plain += usize::from(side(average) <= 0.0);
                kept += usize::from(side(moved[v]) <= 0.0);
            }
        }
        assert!(plain > 0 && kept == 0, "{plain} {kept}");
    }
}
