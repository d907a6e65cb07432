//! Every file of the corpus is read with the vertices and faces of its manifest.

use std::path::Path;

use fairing_mesh::io::{self, Format, Reader, Strictness, WriteOptions};
use libtest_mimic::Failed;

use crate::Test;

/// The tests of this area.
pub(crate) fn trials() -> Vec<(&'static str, Test)> {
    vec![
        ("vertex_and_face_counts", counts),
        ("polygons_are_split_into_triangles", triangles),
        ("strict_reading_accepts_what_is_sound", strict),
        ("coordinates_keep_double_precision", precision),
        ("written_files_read_back", round_trips),
        ("every_format_reads_back", formats),
    ]
}

/// File, vertices, faces (polygons of the file), triangles after splitting.
const FILES: [(&str, usize, usize, usize); 65] = [
    ("assignment/curvatures/lilium_s.obj", 786, 1500, 1500),
    ("assignment/curvatures/plane.obj", 100, 162, 162),
    ("assignment/decompose/armadillo.obj", 361, 718, 718),
    ("assignment/smoothing/fandisk_ns.obj", 7229, 14454, 14454),
    ("assignment/smoothing/plane_ns.obj", 2081, 3975, 3975),
    ("assignment/other-years/armadillo_25k.obj", 25193, 50382, 50382),
    ("assignment/other-years/cow_small_manifold2.obj", 304, 600, 600),
    ("assignment/other-years/cow_manifold2.obj", 2759, 5500, 5500),
    ("assignment/other-years/bumpy-cube.obj", 19970, 39936, 39936),
    ("assignment/other-years/bunny.obj", 3485, 6966, 6966),
    ("assignment/other-years/cube.obj", 8, 12, 12),
    ("assignment/course-lab/sphere4.off", 2562, 5120, 5120),
    ("assignment/course-lab/torus.obj", 288, 576, 576),
    ("assignment/course-lab/igea11706.off", 11706, 23408, 23408),
    ("reference/fandisk.off", 7229, 14454, 14454),
    ("reference/lilium.obj", 3389, 6590, 6590),
    ("standard/bunny70k.ply", 34834, 69451, 69451),
    ("standard/stanford-bunny.obj", 35947, 69451, 69451),
    ("standard/bunny_binary.stl", 34834, 69451, 69451),
    ("standard/armadillo_43k.obj", 43243, 86482, 86482),
    ("standard/dragon_vrip_res2.ply.gz", 100250, 202520, 202520),
    ("standard/igea_tristrips.ply", 134345, 268686, 268686),
    ("standard/spot.obj", 2930, 5856, 5856),
    ("standard/rocker-arm.obj", 10044, 20088, 20088),
    ("standard/3holes.off", 3596, 7200, 7200),
    ("standard/fertility.off", 4494, 9000, 9000),
    ("standard/decimated-max.obj", 5272, 10540, 10540),
    ("standard/elephant.obj", 6034, 12064, 12064),
    ("standard/camelhead.off", 11381, 22704, 22704),
    ("standard/beetle_11loops.off", 19887, 38656, 38656),
    ("standard/horse_quad.obj", 2400, 2398, 4796),
    ("standard/bunny_poly.ply", 1241, 1482, 2478),
    ("standard/dodecahedron_poly.obj", 20, 12, 36),
    ("standard/fuze_ascii.ply", 502, 1000, 1000),
    ("standard/colored_airplane.ply", 7017, 10796, 10796),
    ("standard/cube_vertexcolor.off", 26, 12, 12),
    ("standard/torus_solidheader.stl", 4350, 8700, 8700),
    ("standard/adis16480_ascii.stl", 3672, 7436, 7436),
    ("scan/iron.ply", 85574, 168285, 168285),
    ("scan/lato000_rangemap.ply", 44461, 86766, 86766),
    ("broken/cow_nmvertex.obj", 2903, 5804, 5804),
    ("broken/truck.obj", 2956, 4770, 4770),
    ("broken/conrod_binary.stl", 3223, 6442, 6442),
    ("broken/many_small_holes.ply", 2004, 3524, 3524),
    ("broken/non_manif_hole.ply", 432, 755, 755),
    ("broken/moebius_quads.obj", 280, 224, 448),
    ("broken/fan3.obj", 5, 3, 3),
    ("broken/negative_indices.obj", 8, 6, 12),
    ("broken/non_manifold_face_graph.off", 24, 11, 21),
    ("broken/degtri_four.off", 5, 4, 4),
    ("broken/all_degen.off", 7, 7, 7),
    ("broken/points_only.ply", 1024, 0, 0),
    ("denoising/Fandisk0.3_noisy.obj", 6475, 12946, 12946),
    ("denoising/Fandisk0.3_original.obj", 6475, 12946, 12946),
    ("denoising/Fandisk0.7_noisy.obj", 6475, 12946, 12946),
    ("denoising/Block0.4_noisy.obj", 8771, 17550, 17550),
    ("denoising/Block0.4_original.obj", 8771, 17550, 17550),
    ("denoising/Julius0.2_noisy.obj", 36201, 71912, 71912),
    ("denoising/Julius0.2_original.obj", 36201, 71912, 71912),
    ("denoising/Twelve0.5Impulsive_noisy.obj", 4610, 9216, 9216),
    ("denoising/Twelve0.5Impulsive_original.obj", 4610, 9216, 9216),
    ("derived/igea_134k.ply", 134345, 268686, 268686),
    ("derived/armadillo_loop_173k.ply", 172966, 345928, 345928),
    ("derived/igea_sqrt3_403k.ply", 403031, 806058, 806058),
    ("derived/fandisk_utm.obj", 7229, 14454, 14454),
];

fn failed(file: &str, message: impl std::fmt::Display) -> Failed {
    format!("{file}: {message}").into()
}

fn counts(folder: &Path) -> Result<(), Failed> {
    for (file, vertices, faces, _) in FILES {
        let read = io::read(folder.join(file)).map_err(|e| failed(file, e))?;
        let found = (read.mesh.vertex_count(), read.mesh.to_polygon_mesh().polygon_count());
        if found != (vertices, faces) {
            return Err(failed(file, format!("{found:?} in place of {:?}", (vertices, faces))));
        }
        if read.report.left_out != 0 || read.report.file_faces != faces {
            return Err(failed(file, read.report));
        }
    }
    Ok(())
}

fn triangles(folder: &Path) -> Result<(), Failed> {
    for (file, vertices, faces, triangles) in FILES {
        let read = io::read(folder.join(file)).map_err(|e| failed(file, e))?;
        let found = (read.mesh.vertex_count(), read.mesh.face_count());
        if found != (vertices, triangles) {
            return Err(failed(file, format!("{found:?} in place of {:?}", (vertices, triangles))));
        }
        if (read.report.polygons > 0) != (faces < triangles) {
            return Err(failed(file, format!("{} polygons reported", read.report.polygons)));
        }
    }
    Ok(())
}

fn strict(folder: &Path) -> Result<(), Failed> {
    let reader = Reader::strict();
    assert_eq!(reader.strictness, Strictness::Strict);
    for (file, ..) in FILES {
        let read = reader.read(folder.join(file));
        // The faces of this file have six values more than its header says.
        let refused = file == "standard/fuze_ascii.ply";
        match read {
            Ok(_) if refused => return Err(failed(file, "was read")),
            Err(error) if !refused => return Err(failed(file, error)),
            _ => {}
        }
    }
    Ok(())
}

/// Coordinates like (500000, 4649776, 100) differ from the original mesh by the translation only,
/// up to the rounding of an `f64` near 4.6 million (5e-10).
fn precision(folder: &Path) -> Result<(), Failed> {
    let moved = io::read(folder.join("derived/fandisk_utm.obj"))?.mesh;
    let original = io::read(folder.join("reference/fandisk.off"))?.mesh;
    for (p, q) in moved.positions().iter().zip(original.positions()) {
        for (k, shift) in [500_000.0, 4_649_776.0, 100.0].into_iter().enumerate() {
            let error = (p[k] - shift - q[k]).abs();
            // The file has nine decimals.
            if error > 2e-9 {
                return Err(failed("derived/fandisk_utm.obj", format!("{p:?} for {q:?}")));
            }
        }
    }
    Ok(())
}

/// Polygons, positions, fields and colours survive a round trip bit by bit, in PLY of both
/// encodings and, as far as the formats hold them, in compressed OBJ and OFF.
fn round_trips(folder: &Path) -> Result<(), Failed> {
    let out = tempfile::tempdir()?;
    for (file, vertices, ..) in FILES.into_iter().filter(|&(_, vertices, ..)| vertices < 10_000) {
        let read = io::read(folder.join(file)).map_err(|e| failed(file, e))?;
        for (name, options) in [
            ("a.ply", WriteOptions::default()),
            ("b.ply.gz", WriteOptions::ascii()),
            ("c.obj", WriteOptions::default().dropping_fields()),
            ("d.off.gz", WriteOptions::default().dropping_fields()),
        ] {
            let path = out.path().join(name);
            let report = io::write_with_fields(&path, &read.mesh, &read.fields, &options)?;
            let again = io::read(&path).map_err(|e| failed(file, e))?;
            let same = again.mesh == read.mesh && again.mesh.polygons() == read.mesh.polygons();
            if !same || again.fields.colors != read.fields.colors {
                return Err(failed(file, format!("{name} differs ({vertices} vertices)")));
            }
            let mut fields = read.fields.clone();
            if !report.format.holds().statements {
                fields.faces.statements = Default::default();
            }
            if report.dropped.is_empty() && again.fields != fields {
                return Err(failed(file, format!("the fields of {name} differ")));
            }
        }
    }
    Ok(())
}

/// Positions, faces and fields survive in every format, rounded where it rounds; the content says
/// which it is.
fn formats(folder: &Path) -> Result<(), Failed> {
    for (file, ..) in FILES.into_iter().filter(|&(_, vertices, ..)| vertices < 10_000) {
        let read = io::read(folder.join(file)).map_err(|e| failed(file, e))?;
        let others = Format::ALL.into_iter().filter(|&format| format != Format::Stl);
        for (format, ascii) in others.flat_map(|format| [(format, false), (format, true)]) {
            let holds = format.holds();
            let options = if ascii { WriteOptions::ascii() } else { WriteOptions::default() };
            let bytes = io::to_bytes(format, &read.mesh, &read.fields, &options.dropping_fields());
            let bytes = bytes.map_err(|e| failed(file, e))?;
            let name = format!("mesh.{}", format.extensions()[0]);
            let again = Reader::strict().read_bytes(name, &bytes);
            let again = again.map_err(|e| failed(file, format!("{format}: {e}")))?;
            let round = |x: f64| if holds.exact { x } else { f64::from(x as f32) };
            let positions = read.mesh.positions().iter().map(|p| p.map(round));
            if !positions.eq(again.mesh.positions().iter().copied()) {
                return Err(failed(file, format!("other positions in {format}")));
            }
            if again.mesh.faces() != read.mesh.faces() {
                return Err(failed(file, format!("other faces in {format}")));
            }
            let held = |(name, values): &(String, Vec<f64>)| {
                let values: Vec<f64> = values.iter().map(|&x| round(x)).collect();
                again.fields.scalar(name) == Some(&values)
            };
            let colors = !holds.colors || again.fields.colors == read.fields.colors;
            if !colors || (holds.fields && !read.fields.scalars.iter().all(held)) {
                return Err(failed(file, format!("other fields in {format}")));
            }
        }
    }
    Ok(())
}
