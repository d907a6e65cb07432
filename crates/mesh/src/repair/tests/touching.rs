//! Holes that touch, and holes that stay open.

use super::*;

/// A sphere without some of its faces.
fn without(sphere: &TriMesh, gone: impl Fn(u32) -> bool) -> TriMesh {
    let faces = sphere.faces().iter().zip(0..).filter(|(_, f)| !gone(*f)).map(|(face, _)| *face);
    with_faces(sphere, faces)
}

/// Every other face around a vertex, so that two or three holes meet there; with and without the
/// faces across, so that the holes have three edges or more.
#[test]
fn holes_that_touch_in_a_vertex_are_filled_one_by_one() {
    let sphere = own!(shapes::icosphere(2));
    let v = sphere.vertex_count() as u32 - 1;
    let topology = sphere.topology();
    let around: Vec<u32> = {
        let at = |f: u32| sphere.faces()[f as usize].contains(&v);
        let mut ring: Vec<u32> = vec![(0..sphere.face_count() as u32).find(|&f| at(f)).unwrap()];
        loop {
            let last = *ring.last().unwrap();
            let next =
                topology.face_edges()[last as usize].iter().flat_map(|&e| topology.edge_faces(e));
            match next.copied().find(|&g| at(g) && !ring.contains(&g)) {
                Some(g) => ring.push(g),
                None => break ring,
            }
        }
    };
    assert_eq!(around.len(), 6);
    for holes in [vec![around[0], around[3]], vec![around[0], around[2], around[4]]] {
        let open = without(&sphere, |f| holes.contains(&f));
        for split in [true, false] {
            let options = RepairOptions { holes: 3, split, ..Default::default() };
            let result = checked(&open, &options);
            assert!(result.mesh.topology().is_closed() && result.mesh.topology().is_manifold());
            assert_eq!(result.mesh.vertex_count(), sphere.vertex_count());
            assert!((result.mesh.signed_volume() - sphere.signed_volume()).abs() < 1e-12);
            assert_eq!(result.changed(RepairStep::FilledHoles).len(), holes.len());
            assert!(result.open_holes.is_empty(), "{:?}", result.open_holes);
        }
    }
}

/// An island in a hole that touches its rim in two vertices: the hole is two, one on each side.
#[test]
fn an_island_that_touches_its_rim_twice_stays_in_the_surface() {
    let plane = own!(shapes::plane(6, 6, shapes::Diagonals::Regular));
    let [low, high] = plane.bounding_box().unwrap();
    let square = |f: u32| {
        let corners = plane.triangle(f as usize);
        [0, 1].map(|k| {
            let center = corners.iter().map(|p| p[k]).sum::<f64>() / 3.0;
            (6.0 * (center - low[k]) / (high[k] - low[k])).floor() as i32
        })
    };
    // Four by four squares without two opposite corners around two by two.
    let gone = |f: u32| {
        let [x, y] = square(f);
        let within = |range: std::ops::Range<i32>| range.contains(&x) && range.contains(&y);
        within(1..5) && !within(2..4) && ![[1, 1], [4, 4]].contains(&[x, y])
    };
    let open = without(&plane, gone);
    let rim = plane.topology().boundary_edges().count();
    for holes in [12, 16] {
        let result = checked(&open, &RepairOptions { holes, ..Default::default() });
        assert_eq!(result.mesh.topology().boundary_edges().count(), rim);
        assert_eq!(result.mesh.topology().components().count(), 1);
        assert!((result.mesh.area() / plane.area() - 1.0).abs() < 1e-12);
    }
}

/// Two corners of a rim at one place: a null edge, and a pair that are not neighbours.
#[test]
fn a_rim_with_two_corners_at_one_place_is_filled() {
    let sphere = own!(shapes::icosphere(2));
    let open = without(&sphere, |f| f < 8);
    let rim = repaired(&open).mesh;
    let before = &rim.topology().boundary_loops()[0];
    for apart in [1, 2, 3] {
        let mut positions = rim.positions().to_vec();
        positions[before[apart] as usize] = positions[before[0] as usize];
        let pinched = TriMesh::new(positions, rim.faces().to_vec()).unwrap();
        let result = checked(&pinched, &RepairOptions { holes: 20, ..Default::default() });
        assert!(result.mesh.topology().is_closed(), "{apart}: {:?}", result.open_holes);
    }
}

/// Each boundary that is left is named with its edges and the reason.
#[test]
fn what_stays_open_is_named_with_the_reason() {
    let sphere = own!(shapes::icosphere(3));
    let bowl =
        without(&sphere, |f| sphere.triangle(f as usize).iter().all(|p| p[2] > 0.5) || f == 1000);
    let crumb = mesh(&[[5.0; 3], [6.0, 5.0, 5.0], [5.0, 6.0, 5.0]], &[[0, 1, 2]]);
    let all = together(&[&repaired(&bowl).mesh, &crumb]);
    let loops = all.topology().boundary_loops();
    let large = loops.iter().find(|boundary| boundary.len() > 3).unwrap();
    let result = checked(&all, &RepairOptions { holes: 10, ..Default::default() });
    assert_eq!(result.changed(RepairStep::FilledHoles).len(), 1);
    let named = |hole: &OpenHole| (hole.vertex, hole.edges, hole.reason);
    let mut expected = [
        (*large.iter().min().unwrap(), large.len(), OpenReason::TooLarge),
        (all.vertex_count() as u32 - 3, 3, OpenReason::LoneFace),
    ];
    expected.sort();
    assert_eq!(result.open_holes.iter().map(named).collect::<Vec<_>>(), expected);
    assert_eq!(result.changed(RepairStep::OpenHoles), expected.map(|hole| hole.0));
    // Nothing was to be filled, and nothing is named.
    assert!(repaired(&all).open_holes.is_empty());
}
