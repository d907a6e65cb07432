use std::collections::{BTreeMap, BTreeSet};

use proptest::prelude::*;

use super::{Fan, Topology};
use crate::trimesh::TriMesh;

fn mesh(vertex_count: usize, faces: &[[u32; 3]]) -> TriMesh {
    let positions = (0..vertex_count).map(|i| [i as f64, (i * i) as f64, 0.0]).collect();
    TriMesh::new(positions, faces.to_vec()).unwrap()
}

fn tetrahedron() -> TriMesh {
    mesh(4, &[[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
}

#[test]
fn a_tetrahedron_by_hand() {
    let mesh = tetrahedron();
    let t = mesh.topology();
    assert_eq!(t.edges(), [[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]]);
    assert_eq!(t.face_edges()[1], [4, 2, 0]);
    assert_eq!(t.edge_faces(0), [0, 1]);
    assert_eq!(t.face_neighbors()[1], [2, 3, 0].map(Some));
    assert_eq!(t.edge_between(3, 1), Some(4));
    assert_eq!(t.neighbors(2), [0, 1, 3]);
    assert_eq!(t.euler_characteristic(), 2);
    assert_eq!(t.genus(), Some(0));
    assert!(t.is_closed() && t.is_manifold() && t.orientation().is_consistent());
    assert_eq!(t.components().count(), 1);
    let ring = t.ring(3);
    assert_eq!(ring.len(), 1);
    assert!(ring[0].closed);
    assert_eq!(ring[0].faces, [1, 2, 3]);
    assert_eq!(ring[0].vertices, [0, 1, 2]);
}

#[test]
fn an_open_ring_starts_at_its_end() {
    // A square around vertex 4 with the side 3-0 missing; faces shuffled.
    let mesh = mesh(5, &[[4, 1, 2], [3, 4, 2], [0, 1, 4]]);
    let t = mesh.topology();
    let ring = t.ring(4);
    assert_eq!(ring.len(), 1);
    assert!(!ring[0].closed);
    assert_eq!(ring[0].vertices, [0, 1, 2, 3]);
    assert_eq!(ring[0].faces, [2, 0, 1]);
    assert_eq!(t.boundary_loops(), [vec![0, 1, 2, 3, 4]]);
    assert_eq!(t.genus(), Some(0));
    assert!(t.boundary_vertices().iter().all(|&b| b));
}

#[test]
fn three_faces_on_an_edge() {
    let mesh = mesh(6, &[[0, 1, 2], [1, 0, 3], [0, 1, 4]]);
    let t = mesh.topology();
    assert_eq!(t.nonmanifold_edges().collect::<Vec<_>>(), [0]);
    assert_eq!(t.edge_faces(0), [0, 1, 2]);
    assert_eq!(t.face_neighbors(), [[None; 3]; 3]);
    assert!(t.nonmanifold_vertices().is_empty());
    assert!(!t.is_manifold());
    assert_eq!(t.genus(), None);
    assert_eq!(t.ring(0).len(), 3);
    assert_eq!(t.boundary_loops().len(), 1);
    let mut vertices = t.boundary_loops()[0].clone();
    vertices.sort_unstable();
    assert_eq!(vertices, [0, 1, 2, 3, 4]);
    assert_eq!(t.isolated_vertices().collect::<Vec<_>>(), [5]);
    assert_eq!(t.components().label(5), None);
}

#[test]
fn sheets_that_touch_in_a_vertex() {
    let mesh = mesh(5, &[[0, 1, 2], [0, 3, 4]]);
    let t = mesh.topology();
    assert_eq!(t.nonmanifold_vertices(), [0]);
    assert_eq!(t.boundary_loops(), [vec![0, 1, 2], vec![0, 3, 4]]);
    assert_eq!(t.components().count(), 1);
    assert_eq!(t.ring(0).len(), 2);
    assert_eq!(t.genus(), None);
}

#[test]
fn a_moebius_band_is_not_orientable() {
    // Five triangles in a strip, the ends joined with a twist.
    let faces: Vec<[u32; 3]> = (0..5).map(|i| [i, (i + 1) % 5, (i + 2) % 5]).collect();
    let mesh = mesh(5, &faces);
    let t = mesh.topology();
    assert!(t.is_manifold() && !t.is_closed());
    assert!(!t.orientation().is_orientable());
    assert_eq!(t.orientation().flips(), None);
    assert_eq!(t.boundary_loops().len(), 1);
    assert_eq!(t.boundary_loops()[0].len(), 5);
    assert_eq!(t.euler_characteristic(), 0);
    assert_eq!(t.genus(), None);
}

#[test]
fn flips_make_orientation_consistent() {
    let mut faces = tetrahedron().faces().to_vec();
    faces[2].swap(0, 1);
    let mesh = mesh(4, &faces);
    let orientation = mesh.topology().orientation();
    assert_eq!(orientation.inconsistent_edges().len(), 3);
    assert_eq!(orientation.flips(), Some(&[false, false, true, false][..]));
    assert_eq!(mesh.topology().genus(), Some(0));
}

#[test]
fn nothing_at_all() {
    for count in [0, 3] {
        let mesh = mesh(count, &[]);
        let t = mesh.topology();
        assert!(t.edges().is_empty() && t.boundary_loops().is_empty());
        assert!(!t.is_closed());
        assert_eq!((t.components().count(), t.genus()), (0, None));
    }
}

#[test]
fn two_faces_with_the_same_corners() {
    let mesh = mesh(3, &[[0, 1, 2], [0, 2, 1]]);
    let t = mesh.topology();
    assert!(t.is_closed() && t.is_manifold());
    assert_eq!(t.genus(), Some(0));
    assert_eq!(t.ring(0), [Fan { vertices: vec![1, 2], faces: vec![0, 1], closed: true }]);
}

/// Faces over a dozen vertices at random: every kind of defect at once.
fn soups() -> impl Strategy<Value = Vec<[u32; 3]>> {
    let face = (0u32..12, 1u32..12, 1u32..11).prop_map(|(a, b, c)| {
        let b = (a + b) % 12;
        let c = (0..12).filter(|&x| x != a && x != b).nth(c as usize % 10).unwrap();
        [a, b, c]
    });
    prop::collection::vec(face, 0..24)
}

/// Edges and their faces by an ordered map.
fn edge_map(faces: &[[u32; 3]]) -> BTreeMap<[u32; 2], Vec<u32>> {
    let mut map: BTreeMap<[u32; 2], Vec<u32>> = BTreeMap::new();
    for (f, face) in faces.iter().enumerate() {
        for k in 0..3 {
            let (a, b) = (face[k], face[(k + 1) % 3]);
            map.entry([a.min(b), a.max(b)]).or_default().push(f as u32);
        }
    }
    map
}

/// The number of classes of `0..count` under the pairs, by flooding.
fn classes(count: usize, pairs: &[(usize, usize)]) -> usize {
    let mut label: Vec<usize> = (0..count).collect();
    while let Some(&(a, b)) = pairs.iter().find(|p| label[p.0] != label[p.1]) {
        let (from, to) = (label[a], label[b]);
        label.iter_mut().for_each(|l| *l = if *l == from { to } else { *l });
    }
    label.sort_unstable();
    label.dedup();
    label.len()
}

proptest! {
    #[test]
    fn soups_against_naive_counts(faces in soups()) {
        let mesh = mesh(12, &faces);
        let t = mesh.topology();
        let map = edge_map(&faces);
        prop_assert!(t.edges().iter().eq(map.keys()));
        for (e, (ends, around)) in map.iter().enumerate() {
            prop_assert_eq!(t.edge_faces(e as u32), &around[..]);
            prop_assert_eq!(t.edge_between(ends[1], ends[0]), Some(e as u32));
        }
        for (f, face) in faces.iter().enumerate() {
            for k in 0..3 {
                let mut ends = [face[(k + 1) % 3], face[(k + 2) % 3]];
                ends.sort_unstable();
                prop_assert_eq!(t.edges()[t.face_edges()[f][k] as usize], ends);
            }
        }
        for v in 0..12u32 {
            let at: Vec<usize> = (0..faces.len()).filter(|&f| faces[f].contains(&v)).collect();
            let expected: Vec<u32> =
                (0..12).filter(|&w| map.contains_key(&[v.min(w), v.max(w)])).collect();
            prop_assert_eq!(t.neighbors(v), &expected[..]);
            // Sheets: faces at v, joined where they share an edge at v.
            let share = |f: usize, g: usize| faces[f].iter().filter(|x| faces[g].contains(x)).count() > 1;
            let pairs: Vec<_> = (0..at.len())
                .flat_map(|i| (0..i).map(move |j| (i, j)))
                .filter(|&(i, j)| share(at[i], at[j]))
                .collect();
            let sheets = classes(at.len(), &pairs);
            prop_assert_eq!(t.nonmanifold_vertices().contains(&v), sheets > 1);
            prop_assert_eq!(t.is_boundary_vertex(v), map.iter().any(|(e, f)| e.contains(&v) && f.len() == 1));
            check_ring(&faces, t, v, &at)?;
        }
        let corners: Vec<_> = faces
            .iter()
            .flat_map(|f| [(f[0] as usize, f[1] as usize), (f[0] as usize, f[2] as usize)])
            .collect();
        let isolated = t.isolated_vertices().count();
        prop_assert_eq!(t.components().count(), classes(12, &corners) - isolated);
        for &[a, b, c] in &faces {
            prop_assert_eq!(t.components().label(a), t.components().label(b));
            prop_assert_eq!(t.components().label(a), t.components().label(c));
        }
        let on_loops: BTreeSet<u32> = t.boundary_loops().iter().flatten().copied().collect();
        prop_assert!(on_loops.iter().all(|&v| t.is_boundary_vertex(v)));
        prop_assert_eq!(on_loops.len(), t.boundary_vertices().iter().filter(|b| **b).count());
        if let Some(flips) = t.orientation().flips() {
            let turned: Vec<[u32; 3]> = faces
                .iter()
                .zip(flips)
                .map(|(&[a, b, c], &flip)| if flip { [a, c, b] } else { [a, b, c] })
                .collect();
            let turned = self::mesh(12, &turned);
            prop_assert!(turned.topology().orientation().is_consistent());
            if t.is_manifold() && !faces.is_empty() {
                // The parity of χ + b and its bound make g a whole number.
                let g = t.genus().expect("defined");
                let (c, b) = (t.components().count() as i64, t.boundary_loops().len() as i64);
                prop_assert_eq!(t.euler_characteristic(), 2 * c - 2 * i64::from(g) - b);
            }
        }
    }
}

/// Fans hold each face at `v` once, and their vertices are the sides between.
fn check_ring(faces: &[[u32; 3]], t: &Topology, v: u32, at: &[usize]) -> Result<(), TestCaseError> {
    let fans = t.ring(v);
    let mut all: Vec<usize> = fans.iter().flat_map(|f| &f.faces).map(|&f| f as usize).collect();
    all.sort_unstable();
    prop_assert_eq!(&all[..], at);
    for fan in &fans {
        prop_assert_eq!(fan.vertices.len(), fan.faces.len() + usize::from(!fan.closed));
        for (i, &f) in fan.faces.iter().enumerate() {
            let mut sides = [fan.vertices[i], fan.vertices[(i + 1) % fan.vertices.len()], v];
            let mut face = faces[f as usize];
            sides.sort_unstable();
            face.sort_unstable();
            prop_assert_eq!(sides, face);
        }
        let inner = if fan.closed { 0..fan.faces.len() } else { 1..fan.faces.len() };
        for i in inner {
            let edge = t.edge_between(v, fan.vertices[i]).expect("a side");
            prop_assert_eq!(t.edge_faces(edge).len(), 2);
        }
        if !fan.closed {
            for end in [fan.vertices[0], fan.vertices[fan.faces.len()]] {
                let edge = t.edge_between(v, end).expect("a side");
                prop_assert_ne!(t.edge_faces(edge).len(), 2);
            }
        }
    }
    Ok(())
}
