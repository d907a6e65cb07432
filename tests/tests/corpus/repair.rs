//! Repair of the files of the corpus: a second run changes nothing, the default keeps the surface.

use std::path::Path;

use fairing_mesh::{Diagnosis, RepairOptions, Repaired, Tolerance, TriMesh, io};
use fairing_smoothing::repair_fair;
use libtest_mimic::Failed;

use crate::{Test, verbs};

/// The tests of this area.
pub(crate) fn trials() -> Vec<(&'static str, Test)> {
    vec![("a_second_run_changes_nothing", is_idempotent), ("the_default_keeps_the_surface", keeps)]
}

/// Every step alone and with others.
fn options() -> Vec<RepairOptions> {
    let all = RepairOptions::DEFAULT;
    vec![
        all.clone(),
        RepairOptions { thin: Diagnosis::SLIVER, ..all.clone() },
        RepairOptions { tolerance: Tolerance::EdgeLengths(0.01), ..all.clone() },
        RepairOptions { tolerance: Tolerance::EdgeLengths(0.3), thin: 0.05, ..all.clone() },
        RepairOptions { holes: 60, tolerance: Tolerance::EdgeLengths(0.01), ..all.clone() },
        RepairOptions { holes: 30, orient: false, split: false, ..all.clone() },
        RepairOptions {
            holes: 100,
            smallest_component: 50,
            thin: 0.01,
            tolerance: Tolerance::EdgeLengths(0.05),
            ..all
        },
        RepairOptions { holes: 60, ..RepairOptions::NONE },
    ]
}

/// The largest file that all options are tried on, in bytes, and the largest for the default.
const MAX_BYTES: [u64; 2] = [1 << 20, 4 << 20];

/// Checks every file up to a size, in bytes.
fn each(
    folder: &Path,
    max_bytes: u64,
    check: impl Fn(&TriMesh) -> Option<String>,
) -> Result<(), Failed> {
    let mut wrong = String::new();
    for file in verbs::files(folder, max_bytes)? {
        let mesh = io::read(folder.join(&file))?.mesh;
        if let Some(what) = check(&mesh) {
            wrong += &format!("{}: {what}\n", file.display());
        }
    }
    if wrong.is_empty() { Ok(()) } else { Err(wrong.into()) }
}

fn repaired(mesh: &TriMesh, options: &RepairOptions) -> Repaired {
    repair_fair(mesh, options).unwrap().0
}

fn is_idempotent(folder: &Path) -> Result<(), Failed> {
    each(folder, MAX_BYTES[0], |mesh| {
        options().into_iter().find_map(|options| {
            let once = repaired(mesh, &options);
            // Within the distance of the first run, which is a part of the mean edge of its input.
            let tolerance = match options.tolerance {
                Tolerance::EdgeLengths(ratio) => Tolerance::Model(ratio * mesh.mean_edge_length()),
                other => other,
            };
            let twice = repaired(&once.mesh, &RepairOptions { tolerance, ..options.clone() });
            let counts =
                || twice.changes.iter().map(|(step, e)| (step, e.len())).collect::<Vec<_>>();
            (!twice.is_unchanged() || twice.mesh != once.mesh)
                .then(|| format!("{options:?} changes again: {:?}", counts()))
        })
    })
}

/// No corner of a face moves, if only equal positions are merged. What is closed once it is welded
/// stays closed, apart from one edge in a thousand: fins that hang on fins, and edges that no pairs
/// of sheets can share.
fn keeps(folder: &Path) -> Result<(), Failed> {
    each(folder, MAX_BYTES[1], |mesh| {
        let welded = mesh.welded().mesh;
        let tolerance = Tolerance::EdgeLengths(0.0);
        let result = repaired(mesh, &RepairOptions { tolerance, ..RepairOptions::DEFAULT });
        let mut wrong = vec![];
        let open = result.mesh.topology().boundary_edges().count();
        if welded.topology().is_closed() && 1000 * open > welded.topology().edges().len() {
            wrong.push(format!("{open} edges are open"));
        }
        for (face, source) in result.mesh.faces().iter().zip(&result.face_sources) {
            let place = |mesh: &TriMesh, face: [u32; 3]| {
                let mut corners = face.map(|v| mesh.positions()[v as usize].map(|x| x + 0.0));
                corners.sort_by(|p, q| p.partial_cmp(q).unwrap());
                corners
            };
            let before = source.map(|f| place(mesh, mesh.faces()[f as usize]));
            if before != Some(place(&result.mesh, *face)) {
                wrong.push(format!("{source:?} has moved"));
            }
        }
        (!wrong.is_empty()).then(|| wrong.join(", "))
    })
}
