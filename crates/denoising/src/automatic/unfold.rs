//! Faces that lie folded over their neighbours are evened out.

use fairing_mesh::TriMesh;
use fairing_mesh::vec3::{add, dot, norm, scale, sub};
use rayon::prelude::*;

use crate::DenoiseError;
use crate::vertex_update::{VertexUpdate, rebuild, update_vertices};

/// Rounds of moving vertices within the surface; most folds open in three.
const ROUNDS: usize = 12;

/// Vertex steps that follow each round, which undo what it did across the
/// surface.
const STEPS: usize = 4;

/// How much more a move across the faces costs than one within them.
const STIFFNESS: f64 = 4.0;

/// Opens the faces of `mesh` that oppose their label in `normals`.
///
/// Vertex updates move vertices across the surface only and cannot open a fold.
/// The vertices of folded faces move towards the mean o of their neighbours
/// (seen from the vertex), by the half of
///
/// ```text
/// arg min ‖d − o‖² + 4 Σ_faces (n · d)²
/// ```
///
/// over the labels n around the vertex: freely within a smooth part, along a
/// crease, and hardly at all at a corner. A few vertex updates follow. Border
/// vertices stay, and none ends further than `limit` from `noisy`.
///
/// # Errors
///
/// [`DenoiseError::NonFinite`] if coordinates overflow.
pub(super) fn unfold(
    noisy: &TriMesh,
    mesh: TriMesh,
    normals: &[[f64; 3]],
    limit: f64,
) -> Result<TriMesh, DenoiseError> {
    let (topology, incidence) = (mesh.topology(), mesh.incidence());
    let update = VertexUpdate { steps: STEPS, limit: None };
    let mut current = mesh.clone();
    let mut fewest = opposing(&current, normals).len();
    let mut best = current.clone();
    for _ in 0..ROUNDS {
        fairing_watch::check();
        let folds = opposing(&current, normals);
        if folds.is_empty() {
            break;
        }
        let mut folded = vec![false; current.vertex_count()];
        for f in folds {
            current.faces()[f].iter().for_each(|&v| folded[v as usize] = true);
        }
        let x = current.positions();
        let next = (0..x.len())
            .into_par_iter()
            .map(|v| {
                let ring = topology.neighbors(v as u32);
                if !folded[v] || topology.is_boundary_vertex(v as u32) || ring.is_empty() {
                    return x[v];
                }
                let sum = ring.iter().fold([0.0; 3], |s, &w| add(s, x[w as usize]));
                let offset = sub(scale(sum, 1.0 / ring.len() as f64), x[v]);
                let around = incidence.corners(v as u32).iter().map(|&c| normals[c as usize / 3]);
                let moved = add(x[v], scale(within(around, offset), 0.5));
                hold(noisy.positions()[v], moved, limit)
            })
            .collect();
        let moved = update_vertices(&rebuild(&current, next)?, normals, &update)?;
        let held = (moved.positions().iter().zip(noisy.positions()))
            .map(|(&x, &p)| hold(p, x, limit))
            .collect();
        current = rebuild(&current, held)?;
        let left = opposing(&current, normals).len();
        if left < fewest {
            (fewest, best) = (left, current.clone());
        }
    }
    Ok(best)
}

/// The faces that oppose their labels.
fn opposing(mesh: &TriMesh, normals: &[[f64; 3]]) -> Vec<usize> {
    (0..mesh.face_count())
        .into_par_iter()
        .filter(|&f| dot(mesh.area_vector(f), normals[f]) < 0.0)
        .collect()
}

/// The minimiser of `‖d − o‖² + 4 Σ (n · d)²`: the solution of
/// `(I + 4 Σ n nᵀ) d = o`.
fn within(normals: impl Iterator<Item = [f64; 3]>, o: [f64; 3]) -> [f64; 3] {
    let mut rows = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    for n in normals {
        for (row, x) in rows.iter_mut().zip(n) {
            *row = add(*row, scale(n, STIFFNESS * x));
        }
    }
    // Positive definite with eigenvalues of at least one: elimination needs no
    // pivots.
    let [a, mut b, mut c] = rows;
    let mut o = o;
    let t = b[0] / a[0];
    (b, o[1]) = (sub(b, scale(a, t)), o[1] - t * o[0]);
    let t = c[0] / a[0];
    (c, o[2]) = (sub(c, scale(a, t)), o[2] - t * o[0]);
    let t = c[1] / b[1];
    (c, o[2]) = (sub(c, scale(b, t)), o[2] - t * o[1]);
    let z = o[2] / c[2];
    let y = (o[1] - b[2] * z) / b[1];
    [(o[0] - a[1] * y - a[2] * z) / a[0], y, z]
}

/// `x`, or the point towards it at the distance `limit` from `p`.
pub(super) fn hold(p: [f64; 3], x: [f64; 3], limit: f64) -> [f64; 3] {
    let offset = sub(x, p);
    let length = norm(offset);
    if length > limit { add(p, scale(offset, limit / length)) } else { x }
}

#[cfg(test)]
mod tests {
    use fairing_shapes as shapes;

    use super::*;

    /// On a plane moves are free within and a twenty-fifth across; at a
    /// corner of three planes they are small in all directions.
    #[test]
    fn moves_stay_within_the_faces() {
        let flat = within([[0.0, 0.0, 1.0]; 6].into_iter(), [1.0, 2.0, 5.0]);
        for (x, expected) in flat.into_iter().zip([1.0, 2.0, 5.0 / 25.0]) {
            assert!((x - expected).abs() < 1e-14, "{flat:?}");
        }
        let s = 0.5f64.sqrt();
        let tilted = [[s, s, 0.0], [s, s, 0.0], [0.0, s, s]];
        let d = within(tilted.into_iter(), [0.3, -0.2, 0.9]);
        let residual = tilted.iter().fold(d, |r, &n| add(r, scale(n, STIFFNESS * dot(n, d))));
        for (x, o) in residual.into_iter().zip([0.3, -0.2, 0.9]) {
            assert!((x - o).abs() < 1e-14, "{residual:?}");
        }
    }

    /// Two inner vertices of a plane that have changed places fold the faces
    /// around them; all open, and the plane stays flat.
    #[test]
    fn a_fold_opens() {
        let plane = shapes::plane(8, 8, shapes::Diagonals::Regular);
        let mut positions = plane.positions().to_vec();
        positions.swap(40, 41);
        let folded = plane.with_positions(positions).unwrap();
        let normals = vec![[0.0, 0.0, 1.0]; plane.face_count()];
        assert!(opposing(&folded, &normals).len() >= 2);
        let opened = unfold(&folded, folded.clone(), &normals, 1.0).unwrap();
        assert!(opposing(&opened, &normals).is_empty());
        assert!(opened.positions().iter().all(|p| p[2] == 0.0));
        // A limit is kept even where it leaves a fold.
        let held = unfold(&folded, folded.clone(), &normals, 1e-3).unwrap();
        for (p, q) in held.positions().iter().zip(folded.positions()) {
            assert!(norm(sub(*p, *q)) <= 1e-3 * (1.0 + 1e-12));
        }
    }
}
