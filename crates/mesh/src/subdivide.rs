//! Subdivision: each face cut into four.

use glam::DVec3;

use crate::build::BuildError;
use crate::topology::Topology;
use crate::trimesh::TriMesh;

/// Cuts each face into four at the midpoints of its edges; the surface does not change.
///
/// Vertices: the old ones in their order, then the midpoints in the order
/// of [`Topology::edges`]. Faces: four children for each face in turn, the three
/// at its corners first.
///
/// # Errors
///
/// [`BuildError::TooLarge`] if the new corners outnumber `u32`.
#[doc(alias = "upsample")]
pub fn subdivide_midpoint(mesh: &TriMesh) -> Result<TriMesh, BuildError> {
    let x = mesh.positions();
    let mut positions = x.to_vec();
    positions.extend(mesh.topology().edges().iter().map(|e| middle(x, *e).to_array()));
    TriMesh::new(positions, quartered(mesh)?)
}

/// One step of Loop's scheme, whose limit is smooth (C², and C¹ where other
/// than six edges meet).
///
/// In the interior, a new vertex is ⅜ of each end of its edge plus ⅛ of each
/// opposite corner; an old vertex with n neighbours has the weight 1 − nβ, and
/// each neighbour β, with
///
/// ```text
/// β = (⅝ − (⅜ + ¼ cos 2π/n)²) / n
/// ```
///
/// Edges with one face or more than two are creases: new vertices are their
/// midpoints, old vertices take the weights ⅛, ¾, ⅛ along the crease, and a vertex
/// where other than two creases meet stays. Numbering as in [`subdivide_midpoint`].
/// Source: [loop1987], boundary rules of [hoppe1994].
///
/// # Errors
///
/// [`BuildError::TooLarge`] if the new corners outnumber `u32`.
///
/// [loop1987]: https://www.microsoft.com/en-us/research/wp-content/uploads/2016/02/thesis-10.pdf
/// [hoppe1994]: https://doi.org/10.1145/192161.192233
#[doc(alias("loop", "loop_subdivision"))]
pub fn subdivide_loop(mesh: &TriMesh) -> Result<TriMesh, BuildError> {
    let x = mesh.positions();
    let topology = mesh.topology();
    let mut creases: Vec<Vec<u32>> = vec![vec![]; mesh.vertex_count()];
    for (e, &[a, b]) in topology.edges().iter().enumerate() {
        if topology.edge_faces(e as u32).len() != 2 {
            creases[a as usize].push(b);
            creases[b as usize].push(a);
        }
    }
    let mut positions: Vec<[f64; 3]> = (0..mesh.vertex_count())
        .map(|v| match creases[v][..] {
            [] => smoothed(x, topology, v),
            [a, b] => (0.75 * DVec3::from(x[v]) + 0.25 * middle(x, [a, b])).to_array(),
            _ => x[v],
        })
        .collect();
    positions.extend(topology.edges().iter().enumerate().map(|(e, &ends)| {
        match *topology.edge_faces(e as u32) {
            [f, g] => {
                let opposite = [f, g].map(|f| {
                    let place =
                        topology.face_edges()[f as usize].iter().position(|&i| i == e as u32);
                    // The face is one of the edge's, so the edge one of its.
                    mesh.faces()[f as usize][place.unwrap_or(0)]
                });
                (0.75 * middle(x, ends) + 0.25 * middle(x, opposite)).to_array()
            }
            _ => middle(x, ends).to_array(),
        }
    }));
    TriMesh::new(positions, quartered(mesh)?)
}

/// The new position of an old vertex away from creases; isolated vertices stay.
fn smoothed(x: &[[f64; 3]], topology: &Topology, v: usize) -> [f64; 3] {
    let neighbors = topology.neighbors(v as u32);
    let n = neighbors.len() as f64;
    if neighbors.is_empty() {
        return x[v];
    }
    let c = 0.375 + 0.25 * libm::cos(std::f64::consts::TAU / n);
    let beta = (0.625 - c * c) / n;
    let sum: DVec3 = neighbors.iter().map(|&w| DVec3::from(x[w as usize])).sum();
    ((1.0 - n * beta) * DVec3::from(x[v]) + beta * sum).to_array()
}

/// The faces of `mesh`, each cut into four; vertex `V + e` is on edge `e`.
pub(crate) fn quartered(mesh: &TriMesh) -> Result<Vec<[u32; 3]>, BuildError> {
    let count = 12 * mesh.face_count();
    if u32::try_from(count).is_err() {
        return Err(BuildError::TooLarge { what: "corners", count });
    }
    let base = mesh.vertex_count() as u32;
    let mut faces = Vec::with_capacity(4 * mesh.face_count());
    for (&[a, b, c], edges) in mesh.faces().iter().zip(mesh.topology().face_edges()) {
        let [bc, ca, ab] = edges.map(|e| base + e);
        faces.extend([[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]);
    }
    Ok(faces)
}

fn middle(x: &[[f64; 3]], ends: [u32; 2]) -> DVec3 {
    let [a, b] = ends.map(|v| DVec3::from(x[v as usize]));
    0.5 * (a + b)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An octahedron with vertices at ±1: n = 4, β = 31/256 · … by hand.
    #[test]
    fn loop_on_an_octahedron() {
        let x =
            [[1., 0., 0.], [0., 1., 0.], [0., 0., 1.], [-1., 0., 0.], [0., -1., 0.], [0., 0., -1.]];
        let f = vec![
            [0, 1, 2],
            [1, 3, 2],
            [3, 4, 2],
            [4, 0, 2],
            [1, 0, 5],
            [3, 1, 5],
            [4, 3, 5],
            [0, 4, 5],
        ];
        let fine = subdivide_loop(&TriMesh::new(x.to_vec(), f).unwrap()).unwrap();
        // β = (5/8 − 9/64) / 4 and the four neighbours sum to zero.
        assert!((fine.positions()[0][0] - (1.0 - (0.625 - 9.0 / 64.0))).abs() < 1e-15);
        // Edge 0-1: ⅜ (1, 1, 0), the opposite corners ±z cancel.
        assert_eq!(fine.positions()[6], [0.375, 0.375, 0.0]);
    }
}
