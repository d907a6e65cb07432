use fairing_shapes as shapes;
use glam::DVec3;
use proptest::prelude::*;

use super::*;
use crate::diagnosis::Diagnosis;

fn mesh(positions: &[[f64; 3]], faces: &[[u32; 3]]) -> TriMesh {
    TriMesh::new(positions.to_vec(), faces.to_vec()).unwrap()
}

/// A shape as a mesh of the crate under test, which is not the one that shapes are made of.
macro_rules! own {
    ($shape:expr) => {{
        let shape = $shape;
        mesh(shape.positions(), shape.faces())
    }};
}

mod rounded;
mod touching;

/// Meshes side by side in one.
fn together(meshes: &[&TriMesh]) -> TriMesh {
    let (mut positions, mut faces) = (vec![], vec![]);
    for mesh in meshes {
        let first = positions.len() as u32;
        positions.extend_from_slice(mesh.positions());
        faces.extend(mesh.faces().iter().map(|face| face.map(|v| v + first)));
    }
    TriMesh::new(positions, faces).unwrap()
}

fn moved(mesh: &TriMesh, scale: f64, by: [f64; 3]) -> TriMesh {
    let place = |p: &[f64; 3]| std::array::from_fn(|k| scale * p[k] + by[k]);
    mesh.with_positions(mesh.positions().iter().map(place).collect()).unwrap()
}

fn with_faces(mesh: &TriMesh, faces: impl IntoIterator<Item = [u32; 3]>) -> TriMesh {
    TriMesh::new(mesh.positions().to_vec(), faces.into_iter().collect()).unwrap()
}

fn soup(mesh: &TriMesh) -> TriMesh {
    let positions = mesh.faces().iter().flatten().map(|&v| mesh.positions()[v as usize]).collect();
    let faces = (0..mesh.face_count() as u32).map(|f| [3 * f, 3 * f + 1, 3 * f + 2]).collect();
    TriMesh::new(positions, faces).unwrap()
}

fn cube() -> TriMesh {
    let corner = |v: u32| [0, 1, 2].map(|k| f64::from(v >> k & 1));
    let quads =
        [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let faces = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]);
    TriMesh::new((0..8).map(corner).collect(), faces.collect()).unwrap()
}

/// Options for a second repair: merging within the distance of the first one.
fn at_the_same_distance(options: &RepairOptions, input: &TriMesh) -> RepairOptions {
    let tolerance = match options.tolerance {
        Tolerance::Rounding => Tolerance::Rounding,
        given => Tolerance::Model(given.distance(input)),
    };
    RepairOptions { tolerance, ..options.clone() }
}

fn repaired(mesh: &TriMesh) -> Repaired {
    checked(mesh, &RepairOptions::default())
}

/// Repairs a mesh, and checks all that holds for every repair.
fn checked(input: &TriMesh, options: &RepairOptions) -> Repaired {
    let result = repair(input, options).unwrap();
    let again = repair(&result.mesh, &at_the_same_distance(options, input)).unwrap();
    assert!(again.is_unchanged(), "{:?}", again.changes);
    assert_eq!(again.mesh, result.mesh);
    assert_eq!(result.vertex_sources.len(), result.mesh.vertex_count());
    assert_eq!(result.face_sources.len(), result.mesh.face_count());
    assert_eq!(result.vertices.len(), input.vertex_count());
    for (v, w) in result.vertices.iter().enumerate() {
        if let Some(w) = w
            && options.thin == 0.0
            && result.changed(RepairStep::MovedVertices).binary_search(&(v as u32)).is_err()
        {
            assert_eq!(result.mesh.positions()[*w as usize], input.positions()[v]);
        }
    }
    if options.split {
        assert!(result.mesh.topology().is_manifold());
    }
    if options.split && options.holes > 0 {
        let edges: usize = result.open_holes.iter().map(|hole| hole.edges).sum();
        assert_eq!(edges, result.mesh.topology().boundary_edges().count());
    }
    if options.orient {
        assert_eq!(result.mesh.turned_faces(), [] as [u32; 0]);
    }
    result
}

#[test]
fn a_clean_mesh_stays_as_it_is() {
    let cloud = mesh(&[[0.0; 3], [1.0; 3]], &[]);
    for mesh in [own!(shapes::icosphere(2)), cube(), mesh(&[], &[]), cloud] {
        let result = repaired(&mesh);
        assert!(result.is_unchanged() && result.changes.is_empty());
        assert_eq!(result.mesh, mesh);
    }
}

#[test]
fn a_soup_of_turned_faces_becomes_the_solid() {
    let solid = cube();
    let turned =
        |(f, &[a, b, c]): (usize, &[u32; 3])| if f % 3 == 1 { [a, c, b] } else { [a, b, c] };
    let soup = soup(&with_faces(&solid, solid.faces().iter().enumerate().map(turned)));
    let result = repaired(&soup);
    assert_eq!((result.mesh.vertex_count(), result.mesh.face_count()), (8, 12));
    assert_eq!(result.mesh.signed_volume(), 1.0);
    assert_eq!(result.changed(RepairStep::TurnedFaces), [1, 4, 7, 10]);
    assert_eq!(result.changed(RepairStep::MergedVertices).len(), 28);
    assert!(result.vertices.iter().all(Option::is_some));
}

/// With `cavities` normals of solids point outwards, those of cavities inwards, whatever they did
/// before. Without, all that stands in an outermost part is turned with it, or stays and is named.
#[test]
fn parts_within_others_keep_their_winding_unless_they_are_cavities() {
    let solid = own!(shapes::icosphere(1));
    let inside_out = with_faces(&solid, solid.faces().iter().map(|&[a, b, c]| [a, c, b]));
    let sheet = mesh(&[[0.0; 3], [0.1, 0.0, 0.0], [0.0, 0.1, 0.0]], &[[0, 1, 2]]);
    let of_solids = |result: &Repaired| {
        with_faces(&result.mesh, result.mesh.faces()[..320].iter().copied()).signed_volume()
    };
    for (outer, sign) in [(&solid, 1.0), (&inside_out, -1.0)] {
        for inner in [&solid, &inside_out] {
            let within = moved(inner, 0.5, [0.1, 0.0, 0.0]);
            let kernel = moved(outer, 0.1, [0.1, 0.0, 0.0]);
            let beside = moved(inner, 0.3, [0.95, 0.95, 0.95]);
            let all = together(&[outer, &within, &kernel, &beside, &sheet]);
            let result = checked(&all, &RepairOptions { cavities: true, ..Default::default() });
            let volume = solid.signed_volume() * (1.0 - 0.125 + 0.001 + 0.027);
            assert!((of_solids(&result) - volume).abs() < 1e-12);
            assert_eq!(result.changed(RepairStep::NestedParts), [] as [u32; 0]);

            let result = repaired(&all);
            let volume = sign
                * (outer.signed_volume() + within.signed_volume() + kernel.signed_volume())
                + beside.signed_volume().abs();
            assert!((of_solids(&result) - volume).abs() < 1e-12);
            let solid_within = sign * within.signed_volume() > 0.0;
            assert_eq!(
                result.changed(RepairStep::NestedParts).first().copied(),
                solid_within.then_some(80)
            );
            // The parts inside an outermost part are flipped with it.
            let turned = result.changed(RepairStep::TurnedFaces);
            assert_eq!((turned.contains(&80), turned.contains(&320)), (sign < 0.0, sign < 0.0));
        }
    }
}

/// Two cubes along an edge, and two at a corner: four closed solids with their own vertices.
#[test]
fn solids_that_touch_are_separated() {
    for by in [[1.0, 1.0, 0.0], [1.0, 1.0, 1.0]] {
        let both = together(&[&cube(), &moved(&cube(), 1.0, by)]);
        let result = repaired(&both);
        assert!(result.is_unchanged() && result.mesh.topology().is_closed());
        // Joined, as a program that merges all vertices writes them.
        let joined = both.welded().mesh;
        assert!(!joined.topology().is_manifold());
        let result = repaired(&joined);
        assert_eq!(result.mesh.vertex_count(), 16);
        assert_eq!(result.mesh.topology().components().count(), 2);
        assert!(result.mesh.topology().is_closed());
        assert_eq!(result.mesh.signed_volume(), 2.0);
        let shared = joined.positions().iter().enumerate();
        let shared: Vec<u32> = shared
            .filter(|(_, p)| (0..3).all(|k| if by[k] == 1.0 { p[k] == 1.0 } else { true }))
            .map(|(v, _)| v as u32)
            .collect();
        assert_eq!(result.changed(RepairStep::SplitVertices), shared);
    }
}

#[test]
fn a_fin_is_cut_off_the_surface() {
    let solid = cube();
    let mut positions = solid.positions().to_vec();
    positions.push([0.5, -1.0, 2.0]);
    let [a, b, _] = solid.faces()[5];
    for fin in [[a, b, 8], [b, a, 8]] {
        let faces = [solid.faces(), &[fin]].concat();
        let result = repaired(&mesh(&positions, &faces));
        assert_eq!(result.mesh.face_count(), 13);
        assert_eq!(result.mesh.topology().components().count(), 2);
        assert_eq!(result.changed(RepairStep::SplitVertices).len(), 2);
        assert_eq!(result.mesh.faces()[..12], *solid.faces());
    }
}

/// One face of the fin would leave the cube open.
#[test]
fn a_fin_of_doubled_faces_goes() {
    let solid = cube();
    let mut positions = solid.positions().to_vec();
    positions.extend([[0.5, -1.0, 2.0], [0.7, -2.0, 2.0]]);
    let [a, b, _] = solid.faces()[5];
    for second in [[b, a, 8], [a, b, 8]] {
        let faces = [solid.faces(), &[[a, b, 8], second, [a, 8, 9], [9, a, 8]]].concat();
        let result = repaired(&mesh(&positions, &faces));
        assert_eq!(result.mesh, solid);
        assert_eq!(result.changed(RepairStep::DuplicateFaces), [12, 13, 14, 15]);
        assert_eq!(result.changed(RepairStep::IsolatedVertices), [8, 9]);
    }
    // A sheet of doubled faces alone keeps one of each.
    let sheet = mesh(&positions, &[[0, 1, 8], [1, 0, 8], [0, 8, 9], [8, 0, 9]]);
    assert_eq!(repaired(&sheet).mesh.faces(), [[0, 1, 2], [0, 2, 3]]);
}

#[test]
fn a_wall_between_two_solids_stays() {
    let both = together(&[&cube(), &moved(&cube(), 1.0, [1.0, 0.0, 0.0])]).welded().mesh;
    assert_eq!((both.vertex_count(), Diagnosis::new(&both).duplicate_faces.count), (12, 2));
    let result = repaired(&both);
    assert!(result.mesh.topology().is_closed());
    assert_eq!(result.mesh.topology().components().count(), 2);
    assert_eq!(result.mesh.vertex_count(), 16);
    assert!((result.mesh.signed_volume() - 2.0).abs() < 1e-14);
    assert_eq!(result.changed(RepairStep::DuplicateFaces), [] as [u32; 0]);
}

/// Two sheets that share an edge, and are connected around both of its ends.
#[test]
fn a_pinched_edge_is_cut_where_pairs_cannot_be_kept() {
    let torus = own!(shapes::torus(1.0, 0.4, 12, 8));
    // Two vertices next to each other become those on the opposite side of the tube.
    let place = |v: u32| if v == 48 || v == 49 { v - 48 } else { v };
    let pinched = with_faces(&torus, torus.faces().iter().map(|face| face.map(place)));
    assert_eq!(pinched.topology().nonmanifold_edges().count(), 1);
    assert!(repaired(&pinched).mesh.topology().is_manifold());
}

#[test]
fn faces_that_occur_twice_and_components_that_are_small_go() {
    let solid = cube();
    let crumb = mesh(&[[5.0; 3], [6.0, 5.0, 5.0], [5.0, 6.0, 5.0]], &[[0, 1, 2]]);
    let both = together(&[&crumb, &solid]);
    let faces = [both.faces(), &[[1, 2, 0], [3, 6, 5]]].concat();
    let doubled = with_faces(&both, faces);
    let result = checked(&doubled, &RepairOptions { smallest_component: 2, ..Default::default() });
    assert_eq!(result.changed(RepairStep::DuplicateFaces)[0], 13);
    assert_eq!(result.changed(RepairStep::SmallComponents), [0]);
    assert_eq!(result.vertices[..4], [None, None, None, Some(0)]);
    assert_eq!(result.face_sources[0], Some(1));
}

/// Vertices within the tolerance are merged into the first, without chains.
#[test]
fn vertices_are_merged_within_a_tolerance() {
    let solid = cube();
    let shaken = soup(&solid);
    let shift = |v: usize, k: usize| 1e-3 * ((7 * v + 3 * k) % 5) as f64;
    let positions = shaken.positions().iter().enumerate();
    let positions = positions.map(|(v, p)| [0, 1, 2].map(|k| p[k] + shift(v, k))).collect();
    let shaken = shaken.with_positions(positions).unwrap();
    assert_eq!(repaired(&shaken).mesh.vertex_count(), 36);
    let result = checked(
        &shaken,
        &RepairOptions { tolerance: Tolerance::EdgeLengths(0.01), ..Default::default() },
    );
    assert_eq!(result.mesh.vertex_count(), 8);
    assert!((result.mesh.signed_volume() - 1.0).abs() < 0.02);
    let line: Vec<_> = (0..30).map(|i| [0.1 * f64::from(i), 0.0, 0.0]).collect();
    assert_eq!(merge_within(&line, 0.25), 10);
}

/// The distance is a part of the mean edge of the input, which is a sixth of the longest here.
/// In mean edges of what is left, each merge would allow a longer one, until nothing is left.
#[test]
fn a_tolerance_is_a_part_of_the_mean_edge_of_the_input() {
    let column = |i: i32| 1.3f64.powi(i);
    let positions: Vec<_> =
        (0..30).map(|v| [column(v / 2), f64::from(v % 2) * column(v / 2), 0.0]).collect();
    let square = |i: u32| [[2 * i, 2 * i + 2, 2 * i + 3], [2 * i, 2 * i + 3, 2 * i + 1]];
    let faces: Vec<_> = (0..14).flat_map(square).collect();
    let strip = mesh(&positions, &faces);
    let result = checked(
        &strip,
        &RepairOptions { tolerance: Tolerance::EdgeLengths(0.3), ..Default::default() },
    );
    let distance = 0.3 * strip.mean_edge_length();
    for (v, w) in result.vertices.iter().enumerate() {
        let Some(w) = w else { continue };
        let [p, q] = [strip.positions()[v], result.mesh.positions()[*w as usize]];
        assert!(DVec3::from(p).distance(q.into()) <= distance);
    }
    let shorter = strip.edge_lengths().iter().filter(|l| **l <= distance).count();
    let lost = strip.vertex_count() - result.mesh.vertex_count();
    assert!(lost > 0 && lost <= shorter, "{lost} of {shorter}");
}

/// Faces that all run the same way along an edge bound no inside between them, so that no two
/// belong together; one that runs against them finds its partner.
#[test]
fn faces_along_an_edge_belong_together_if_they_run_against_each_other() {
    let corners =
        [[0.0, 0.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [-0.5, 0.9, 0.0], [-0.5, -0.9, 0.0]];
    let same_way = mesh(&corners, &[[0, 1, 2], [0, 1, 3], [0, 1, 4]]);
    assert_eq!(repaired(&same_way).mesh.topology().components().count(), 3);
    let against = mesh(&corners, &[[0, 1, 2], [1, 0, 3], [0, 1, 4]]);
    assert_eq!(repaired(&against).mesh.topology().components().count(), 2);
}

fn merge_within(positions: &[[f64; 3]], distance: f64) -> usize {
    let all: Vec<u32> = (0..positions.len() as u32).collect();
    let first = super::rounding::within(positions, &all, distance, |_| distance);
    first.iter().enumerate().filter(|(v, first)| *v == **first as usize).count()
}

#[test]
fn needles_collapse_and_caps_are_flipped() {
    // A grid with a point close to a vertex, and one close to the middle of an edge.
    for (point, faces) in [([1.0 + 1e-5, 1.0, 0.0], 8), ([1.5, 1.0 + 1e-5, 0.0], 10)] {
        let grid = (0..9).map(|v| [f64::from(v % 3), f64::from(v / 3), 0.0]);
        let positions: Vec<_> = grid.chain([point]).collect();
        let square = |v: u32| [[v, v + 1, v + 4], [v, v + 4, v + 3]];
        let all: Vec<[u32; 3]> = [0, 1, 3, 4].into_iter().flat_map(square).collect();
        // The point replaces the face that it lies in by three.
        let [a, b, c] = [4, 8, 7];
        let [a, b, c] = if point[0] > 1.2 { [4, 5, 8] } else { [a, b, c] };
        let mut all: Vec<_> = all.into_iter().filter(|face| *face != [a, b, c]).collect();
        all.extend([[a, b, 9], [b, c, 9], [c, a, 9]]);
        let input = mesh(&positions, &all);
        assert!(Diagnosis::new(&input).sliver_faces.count > 0);
        let options = RepairOptions { thin: 2e-3, ..Default::default() };
        let result = checked(&input, &options);
        let diagnosis = Diagnosis::new(&result.mesh);
        assert_eq!((diagnosis.sliver_faces.count, diagnosis.degenerate_faces.count), (0, 0));
        assert_eq!(result.mesh.face_count(), faces);
        assert!((result.mesh.area() - 4.0).abs() < 1e-4);
        assert!(!result.changed(RepairStep::ThinFaces).is_empty());
    }
}

/// Holes in a sphere are filled as finely as the mesh around them; larger ones stay.
#[test]
fn holes_are_filled_up_to_a_size() {
    let sphere = own!(shapes::icosphere(3));
    let low = |face: &[u32; 3], z: f64| {
        face.iter().map(|&v| sphere.positions()[v as usize][2]).sum::<f64>() < 3.0 * z
    };
    let side = |face: &[u32; 3]| {
        face.iter().map(|&v| sphere.positions()[v as usize][0]).sum::<f64>() < 2.7
    };
    let faces = sphere.faces().iter().copied().filter(|f| low(f, 0.8) && side(f));
    let open = with_faces(&sphere, faces);
    let open = repaired(&open).mesh;
    let loops: Vec<usize> = open.topology().boundary_loops().iter().map(Vec::len).collect();
    assert_eq!(loops.len(), 2);
    let (small, large) = (loops[0].min(loops[1]), loops[0].max(loops[1]));
    for (holes, filled) in [(small - 1, 0), (small, 1), (large, 2)] {
        let result = checked(&open, &RepairOptions { holes, ..Default::default() });
        assert_eq!(result.changed(RepairStep::FilledHoles).len(), filled);
        assert_eq!(result.mesh.topology().boundary_loops().len(), 2 - filled);
        if filled == 2 {
            assert!(result.mesh.topology().is_closed());
            let volume = result.mesh.signed_volume() / sphere.signed_volume();
            assert!(volume > 0.9 && volume < 1.0, "{volume}");
            let lengths = result.mesh.edge_lengths();
            let longest = lengths.iter().copied().fold(0.0, f64::max);
            assert!(longest < 2.5 * sphere.mean_edge_length(), "{longest}");
            assert!(!result.patch_vertices().is_empty());
        }
    }
}

/// The rim of a face is no hole, and no patch repeats an edge or a face.
#[test]
fn what_cannot_be_filled_stays_open() {
    let options = RepairOptions { holes: 9, ..Default::default() };
    let triangle = mesh(&[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], &[[0, 1, 2]]);
    assert!(checked(&triangle, &options).is_unchanged());
    for n in 4..8 {
        let fan = (0..n).map(|i| f64::from(i).mul_add(0.7, 0.0)).map(|t| [t.cos(), t.sin(), 0.0]);
        let fan: Vec<_> = fan.collect();
        let faces: Vec<[u32; 3]> = (1..n as u32 - 1).map(|i| [0, i, i + 1]).collect();
        checked(&mesh(&fan, &faces), &options);
    }
}

/// Sheets that pass through each other, with rims that pass places more than once.
#[test]
fn tangled_rims_are_filled() {
    let positions = [
        [1.0, 3.0, 0.0],
        [3.0, -3.0, 2.0],
        [-1.0, -2.0, 4.0],
        [1.0, -2.0, -1.0],
        [4.0, -2.0, 3.0],
        [-1.0, 4.0, -3.0],
        [-2.0, -1.0, 3.0],
        [0.0, -2.0, -3.0],
        [3.0, 0.0, 2.0],
        [0.0, 0.0, 3.0],
        [0.0, 4.0, 3.0],
        [1.0, -3.0, 0.0],
    ];
    let faces = [
        [11, 2, 5],
        [11, 6, 0],
        [4, 9, 7],
        [3, 8, 2],
        [0, 9, 3],
        [10, 5, 3],
        [9, 3, 5],
        [11, 0, 2],
        [1, 0, 3],
        [3, 0, 2],
        [8, 2, 0],
        [0, 4, 9],
        [5, 3, 2],
    ];
    let options = RepairOptions { smallest_component: 3, holes: 12, ..Default::default() };
    let result = checked(&mesh(&positions, &faces), &options);
    assert!(!result.changed(RepairStep::FilledHoles).is_empty());
}

#[test]
fn limits_are_checked() {
    for options in [
        RepairOptions { tolerance: Tolerance::EdgeLengths(f64::NAN), ..Default::default() },
        RepairOptions { tolerance: Tolerance::EdgeLengths(1.5), ..Default::default() },
        RepairOptions { thin: 0.2, ..Default::default() },
        RepairOptions { holes: 2001, ..Default::default() },
    ] {
        assert!(repair(&cube(), &options).is_err());
    }
}

/// The isolated vertex alone gives this mesh an extent that a mesh may have.
#[test]
fn what_is_left_is_a_valid_mesh() {
    let tiny =
        mesh(&[[0.0; 3], [1e-40, 0.0, 0.0], [0.0, 1e-40, 0.0], [1e-20, 0.0, 0.0]], &[[0, 1, 2]]);
    let error = repair(&tiny, &RepairOptions::default()).unwrap_err();
    assert!(matches!(error, RepairError::Positions(_)), "{error}");
    assert!(repair(&tiny, &RepairOptions { isolated: false, ..Default::default() }).is_ok());
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(3000))]

    /// Tiny soups on few places, with everything that can be wrong.
    #[test]
    fn any_soup_is_repaired_once(
        places in prop::collection::vec([0..3_i8, 0..3_i8, 0..2_i8], 3..9),
        corners in prop::collection::vec([0..9_u32, 0..9_u32, 0..9_u32], 0..14),
        tolerance in prop_oneof![Just(Tolerance::Rounding), Just(Tolerance::EdgeLengths(0.3))],
        thin in prop_oneof![Just(0.0), Just(0.05)],
        holes in 0..8_usize,
        smallest_component in 0..3_usize,
    ) {
        let positions: Vec<_> = places.iter().map(|p| p.map(f64::from)).collect();
        let n = positions.len() as u32;
        let faces: Vec<_> = corners.iter().map(|face| face.map(|v| v % n))
            .filter(|[a, b, c]| a != b && b != c && c != a).collect();
        let options = RepairOptions { tolerance, thin, holes, smallest_component, ..Default::default() };
        checked(&mesh(&positions, &faces), &options);
        checked(&mesh(&positions, &faces), &RepairOptions::NONE);
    }
}
