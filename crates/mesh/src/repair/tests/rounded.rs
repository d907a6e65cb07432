//! Corners that differ by rounding.

use super::*;

/// A mesh as soup with coordinates off by some units in the last place of single precision.
fn rounded(mesh: &TriMesh, units: f64, single: bool) -> TriMesh {
    let soup = soup(mesh);
    let largest = soup.positions().as_flattened().iter().fold(0.0, |max: f64, x| max.max(x.abs()));
    let ulp = largest * f64::from(f32::EPSILON);
    let mut state = 1_u64;
    let mut off = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        units * ulp * (((state >> 33) % 3) as f64 - 1.0)
    };
    let number = |x: f64| if single { f64::from(x as f32) } else { x };
    let positions = soup.positions().iter().map(|p| p.map(|x| number(x + off()))).collect();
    TriMesh::new(positions, soup.faces().to_vec()).unwrap()
}

/// Zeros of a CAD program, and coordinates one unit off, in single and in double precision.
#[test]
fn cracks_of_rounding_are_closed_and_counted() {
    let torus = own!(shapes::torus(2.0, 0.5, 24, 12));
    for solid in [cube(), torus] {
        for (units, single) in [(1e-9, true), (1e-9, false), (0.5, true), (0.5, false)] {
            let input = rounded(&solid, units, single);
            let count = Diagnosis::new(&input).rounded_vertices.count;
            assert!(count > 0);
            let result = repaired(&input);
            assert_eq!(result.mesh.vertex_count(), solid.vertex_count());
            assert_eq!(result.mesh.topology().genus(), solid.topology().genus());
            assert!((result.mesh.signed_volume() / solid.signed_volume() - 1.0).abs() < 1e-5);
            assert_eq!(result.changed(RepairStep::MovedVertices).len(), count);
            let left = Diagnosis::new(&result.mesh);
            assert_eq!(left.rounded_vertices.count, 0);
            // Equal positions alone leave the cracks.
            let exact =
                RepairOptions { tolerance: Tolerance::EdgeLengths(0.0), ..Default::default() };
            assert!(!checked(&input, &exact).mesh.topology().is_closed());
        }
    }
}

/// Open sheets whose edges are as short as the rounding, or that are as close to each other,
/// in double precision.
#[test]
fn features_of_the_size_of_rounding_stay() {
    let grid = own!(shapes::plane(6, 6, shapes::Diagonals::Regular));
    let far = mesh(&[[10.0; 3], [11.0, 10.0, 10.0], [10.0, 11.0, 10.0]], &[[0, 1, 2]]);
    for scale in [1e-7, 5e-7, 2e-6, 5e-6] {
        let tiny = moved(&grid, scale, [1.0 / 3.0; 3]);
        let input = together(&[&far, &tiny]);
        let result = repaired(&input);
        assert!(result.is_unchanged(), "{scale}: {:?}", result.changes);
    }
    let gap = 1e-7;
    let third = moved(&grid, 1.0 / 3.0, [0.0; 3]);
    let pair = together(&[&third, &moved(&third, 1.0, [0.0, 0.0, gap])]);
    for input in [pair.clone(), soup(&pair)] {
        let result = repaired(&input);
        assert_eq!(result.mesh.vertex_count(), pair.vertex_count(), "{:?}", result.changes);
        assert_eq!(result.changed(RepairStep::MovedVertices), [] as [u32; 0]);
    }
}

/// A fin whose foot is off by rounding stays loose: joined, its edge would have three faces.
#[test]
fn no_edge_gets_a_third_face() {
    let open = with_faces(&cube(), cube().faces()[2..].iter().copied());
    let loops = &open.topology().boundary_loops()[0];
    let [p, q] = [0, 1].map(|k| open.positions()[loops[k] as usize]);
    let near = p.map(|x| x + 1e-8);
    let sheet = |z| mesh(&[near, q.map(|x| x - 1e-8), [3.0, 3.0, z]], &[[0, 1, 2]]);
    let both = together(&[&open, &sheet(3.0), &sheet(2.5)]);
    let twice = both.welded().mesh;
    let result = repaired(&twice);
    assert_eq!(result.changed(RepairStep::MovedVertices), [] as [u32; 0]);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    /// Tiny soups whose places are spread over a few units of rounding: no face is lost that an
    /// exact repair keeps, no vertex moves farther than the distance.
    #[test]
    fn rounding_costs_no_face(
        places in prop::collection::vec([0..3_i8, 0..3_i8, 0..2_i8], 3..9),
        off in prop::collection::vec([-2..3_i8, -2..3_i8, -2..3_i8], 30),
        corners in prop::collection::vec([0..9_usize, 0..9_usize, 0..9_usize], 0..10),
        tiny in any::<bool>(),
    ) {
        let unit = if tiny { 1.0 } else { 1e-7 };
        let mut positions = vec![[0.0; 3], [3.0; 3]];
        let mut faces = vec![];
        for (f, face) in corners.iter().enumerate() {
            let at: Vec<[f64; 3]> = (0..3).map(|k| {
                let place = places[face[k] % places.len()];
                [0, 1, 2].map(|i| f64::from(place[i]) * if tiny { 1e-6 } else { 1.0 }
                    + 1e-7 * unit * f64::from(off[(3 * f + k) % off.len()][i]))
            }).collect();
            let first = positions.len() as u32;
            positions.extend(at);
            faces.push([first, first + 1, first + 2]);
        }
        let input = mesh(&positions, &faces);
        let exact = RepairOptions { tolerance: Tolerance::EdgeLengths(0.0), ..Default::default() };
        let exact = repair(&input, &exact).unwrap();
        let result = checked(&input, &RepairOptions::default());
        let distance = Tolerance::Rounding.distance(&input);
        for (v, w) in result.vertices.iter().enumerate() {
            let Some(w) = w else { continue };
            let [p, q] = [input.positions()[v], result.mesh.positions()[*w as usize]];
            // A vertex may move once more where the first one to which it moved is merged.
            prop_assert!(DVec3::from(p).distance(q.into()) <= 3.0 * distance);
        }
        let collapsed = |repaired: &Repaired| repaired.changed(RepairStep::CollapsedFaces).len();
        prop_assert_eq!(collapsed(&result), collapsed(&exact));
    }
}
