//! The diagnosis of every file of the corpus, compared with the figures of its manifest, which were
//! computed by other means.

use std::path::Path;

use fairing_mesh::{Diagnosis, io};
use libtest_mimic::Failed;

use crate::Test;

/// The tests of this area.
pub(crate) fn trials() -> Vec<(&'static str, Test)> {
    vec![
        ("topology_and_defects", topology_and_defects),
        ("points_without_faces", points_without_faces),
    ]
}

/// Manifoldness of a file.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Manifold {
    Yes,
    /// Every edge has at most two faces, but sheets touch in some vertex.
    EdgesOnly,
    No,
}

/// Defects that the manifest counts.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Defect {
    Isolated,
    DuplicatePositions,
    DuplicateFaces,
    NonmanifoldEdges,
    NonmanifoldVertices,
    InconsistentEdges,
    Slivers,
    Degenerate,
}

use Defect::*;
use Manifold::*;

struct Row {
    file: &'static str,
    components: usize,
    loops: usize,
    manifold: Manifold,
    genus: Option<u32>,
    closed: bool,
    defects: &'static [(Defect, usize)],
}

const fn row(
    file: &'static str,
    components: usize,
    loops: usize,
    manifold: Manifold,
    genus: Option<u32>,
    closed: bool,
    defects: &'static [(Defect, usize)],
) -> Row {
    Row { file, components, loops, manifold, genus, closed, defects }
}

/// File, components, boundary loops, manifold, genus, closed, defects.
#[rustfmt::skip]
const ROWS: [Row; 64] = [
    row("assignment/curvatures/lilium_s.obj", 1, 1, Yes, Some(0), false, &[]),
    row("assignment/curvatures/plane.obj", 1, 1, Yes, Some(0), false, &[]),
    row("assignment/decompose/armadillo.obj", 1, 0, Yes, Some(0), true, &[]),
    row("assignment/smoothing/fandisk_ns.obj", 1, 0, Yes, Some(0), true, &[]),
    row("assignment/smoothing/plane_ns.obj", 1, 1, Yes, Some(0), false, &[]),
    row("assignment/other-years/armadillo_25k.obj", 1, 0, Yes, Some(0), true, &[]),
    row("assignment/other-years/cow_small_manifold2.obj", 1, 1, Yes, Some(0), false, &[]),
    row("assignment/other-years/cow_manifold2.obj", 1, 1, Yes, Some(0), false, &[]),
    row("assignment/other-years/bumpy-cube.obj", 1, 0, Yes, Some(0), true, &[]),
    row("assignment/other-years/bunny.obj", 1, 0, Yes, Some(0), true, &[]),
    row("assignment/other-years/cube.obj", 1, 0, Yes, Some(0), true, &[]),
    row("assignment/course-lab/sphere4.off", 1, 0, Yes, Some(0), true, &[]),
    row("assignment/course-lab/torus.obj", 1, 0, Yes, Some(1), true, &[]),
    row("assignment/course-lab/igea11706.off", 1, 0, Yes, Some(0), true, &[]),
    row("reference/fandisk.off", 1, 0, Yes, Some(0), true, &[]),
    row("reference/lilium.obj", 1, 1, Yes, Some(0), false, &[]),
    row("standard/bunny70k.ply", 1, 5, Yes, Some(0), false, &[]),
    row("standard/stanford-bunny.obj", 1, 5, Yes, Some(0), false, &[(Isolated, 1113)]),
    row("standard/bunny_binary.stl", 1, 5, Yes, Some(0), false, &[]),
    row("standard/armadillo_43k.obj", 1, 0, Yes, Some(0), true, &[]),
    row("standard/dragon_vrip_res2.ply.gz", 7, 0, No, None, true, &[(Isolated, 43), (DuplicateFaces, 1489),
        (NonmanifoldEdges, 2534), (NonmanifoldVertices, 16), (Slivers, 5)]),
    row("standard/igea_tristrips.ply", 1, 0, Yes, Some(0), true, &[]),
    row("standard/spot.obj", 1, 0, Yes, Some(0), true, &[]),
    row("standard/rocker-arm.obj", 1, 0, Yes, Some(1), true, &[]),
    row("standard/3holes.off", 1, 0, Yes, Some(3), true, &[]),
    row("standard/fertility.off", 1, 0, Yes, Some(4), true, &[]),
    row("standard/decimated-max.obj", 1, 0, Yes, Some(0), true, &[(Slivers, 1)]),
    row("standard/elephant.obj", 1, 0, Yes, Some(0), true, &[]),
    row("standard/camelhead.off", 1, 1, Yes, Some(0), false, &[]),
    row("standard/beetle_11loops.off", 1, 11, Yes, Some(0), false, &[(DuplicatePositions, 2)]),
    row("standard/horse_quad.obj", 1, 0, Yes, Some(0), true, &[]),
    row("standard/bunny_poly.ply", 1, 0, Yes, Some(0), true, &[]),
    row("standard/dodecahedron_poly.obj", 1, 0, Yes, Some(0), true, &[]),
    row("standard/fuze_ascii.ply", 1, 0, Yes, Some(0), true, &[]),
    row("standard/colored_airplane.ply", 1, 0, Yes, Some(0), true, &[(Isolated, 1617)]),
    row("standard/cube_vertexcolor.off", 7, 7, Yes, Some(0), false, &[(DuplicatePositions, 18)]),
    row("standard/torus_solidheader.stl", 1, 0, Yes, Some(1), true, &[]),
    row("standard/adis16480_ascii.stl", 1, 0, Yes, Some(24), true, &[(Slivers, 74)]),
    row("scan/iron.ply", 1, 2, Yes, Some(0), false, &[(Slivers, 236)]),
    row("scan/lato000_rangemap.ply", 9, 19, EdgesOnly, None, false, &[(Isolated, 192), (NonmanifoldVertices, 2)]),
    row("broken/cow_nmvertex.obj", 1, 0, EdgesOnly, None, true, &[(NonmanifoldVertices, 1)]),
    row("broken/truck.obj", 50, 153, No, None, false, &[(NonmanifoldEdges, 54), (NonmanifoldVertices, 55),
        (InconsistentEdges, 64), (Slivers, 4)]),
    row("broken/conrod_binary.stl", 1, 0, No, None, true, &[(DuplicateFaces, 3), (NonmanifoldEdges, 3),
        (InconsistentEdges, 5149), (Slivers, 27)]),
    row("broken/many_small_holes.ply", 1, 32, EdgesOnly, None, false, &[(NonmanifoldVertices, 6)]),
    row("broken/non_manif_hole.ply", 1, 2, EdgesOnly, None, false, &[(NonmanifoldVertices, 5)]),
    row("broken/moebius_quads.obj", 1, 1, Yes, None, false, &[(InconsistentEdges, 4)]),
    row("broken/fan3.obj", 1, 1, No, None, false, &[(NonmanifoldEdges, 1)]),
    row("broken/negative_indices.obj", 1, 0, Yes, Some(0), true, &[]),
    row("broken/non_manifold_face_graph.off", 3, 3, Yes, Some(0), false, &[(DuplicatePositions, 3)]),
    row("broken/degtri_four.off", 1, 1, Yes, Some(0), false, &[(Degenerate, 1)]),
    row("broken/all_degen.off", 1, 1, EdgesOnly, None, false, &[(DuplicatePositions, 3), (NonmanifoldVertices, 1),
        (Degenerate, 7)]),
    row("denoising/Fandisk0.3_noisy.obj", 1, 0, Yes, Some(0), true, &[]),
    row("denoising/Fandisk0.3_original.obj", 1, 0, Yes, Some(0), true, &[]),
    row("denoising/Fandisk0.7_noisy.obj", 1, 0, Yes, Some(0), true, &[]),
    row("denoising/Block0.4_noisy.obj", 1, 0, Yes, Some(3), true, &[]),
    row("denoising/Block0.4_original.obj", 1, 0, Yes, Some(3), true, &[]),
    row("denoising/Julius0.2_noisy.obj", 1, 1, Yes, Some(0), false, &[]),
    row("denoising/Julius0.2_original.obj", 1, 1, Yes, Some(0), false, &[]),
    row("denoising/Twelve0.5Impulsive_noisy.obj", 1, 0, Yes, Some(0), true, &[]),
    row("denoising/Twelve0.5Impulsive_original.obj", 1, 0, Yes, Some(0), true, &[]),
    row("derived/igea_134k.ply", 1, 0, Yes, Some(0), true, &[]),
    row("derived/armadillo_loop_173k.ply", 1, 0, Yes, Some(0), true, &[]),
    row("derived/igea_sqrt3_403k.ply", 1, 0, Yes, Some(0), true, &[]),
    row("derived/fandisk_utm.obj", 1, 0, Yes, Some(0), true, &[]),
];

fn topology_and_defects(folder: &Path) -> Result<(), Failed> {
    let mut wrong = String::new();
    for row in &ROWS {
        let mesh = io::read(folder.join(row.file))?.mesh;
        let d = Diagnosis::new(&mesh);
        let mut check = |what: &str, found: String, expected: String| {
            if found != expected {
                wrong += &format!("{}: {what} {found}, not {expected}\n", row.file);
            }
        };
        let text = |x: &dyn std::fmt::Debug| format!("{x:?}");
        check("components", text(&d.components), text(&row.components));
        check("boundary loops", text(&d.boundary_loops), text(&row.loops));
        check("genus", text(&d.genus), text(&row.genus));
        check("closed", text(&d.closed), text(&row.closed));
        let manifold = match (d.manifold, d.nonmanifold_edges.count) {
            (true, _) => Yes,
            (false, 0) => EdgesOnly,
            (false, _) => No,
        };
        check("manifold", text(&manifold), text(&row.manifold));
        for (defect, found) in [
            (Isolated, d.isolated_vertices),
            (DuplicatePositions, d.duplicate_positions),
            (DuplicateFaces, d.duplicate_faces),
            (NonmanifoldEdges, d.nonmanifold_edges),
            (NonmanifoldVertices, d.nonmanifold_vertices),
            (InconsistentEdges, d.inconsistent_edges),
            (Slivers, d.sliver_faces),
            (Degenerate, d.degenerate_faces),
        ] {
            let expected = row.defects.iter().find(|r| r.0 == defect).map_or(0, |r| r.1);
            check(&text(&defect), text(&found.count), text(&expected));
        }
        let moebius = row.file == "broken/moebius_quads.obj";
        check("orientable", text(&d.orientable), text(&!moebius));
    }
    if wrong.is_empty() { Ok(()) } else { Err(wrong.into()) }
}

fn points_without_faces(folder: &Path) -> Result<(), Failed> {
    let d = Diagnosis::new(&io::read(folder.join("broken/points_only.ply"))?.mesh);
    assert_eq!((d.vertices, d.faces, d.components), (1024, 0, 0));
    assert_eq!((d.closed, d.genus, d.isolated_vertices.count), (false, None, 1024));
    Ok(())
}
