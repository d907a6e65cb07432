//! The kind of surface at each face.

use fairing_mesh::TriMesh;
use glam::DVec3;

use crate::faces::{FaceShapes, Hinges, NO_HINGE};

/// The least turn at a crease, 20°, as a cosine.
const CREASE: f64 = 0.939_692_620_785_908_4;

/// The least ratio of the turn at a crease to the second smallest turn at the four other sides of
/// its two faces: on a curved surface turns are alike, and at a corner two of the others may be
/// creases.
const STANDS_OUT: f64 = 2.5;

/// The largest turn at a flat face, 2°, as a cosine.
const FLAT: f64 = 0.999_390_827_019_095_7;

/// The least length of all creases of a creased surface, in diagonals of the mesh. On the
/// development set of the benchmark, models without creases reach at most 0.5 (blobs, cloth and
/// relief), and designed models 3.9 or more.
const CREASE_LENGTH: f64 = 2.0;

/// The kind of surface of a whole mesh.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum SurfaceKind {
    /// The creases are together as long as two diagonals: a designed model.
    Creased,
    /// The surface has fewer creases or none, like most scans.
    Smooth,
    /// No noise was found, and no vertex was moved.
    Clean,
    /// The faces are too uneven for normals to determine positions, and no vertex was moved.
    Uneven,
}

fairing_parameters::named!(SurfaceKind, "kind of surface",
    Creased: "creased",
    Smooth: "smooth",
    Clean: "clean",
    Uneven: "uneven",
);

/// The kind of surface at a face.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum FaceKind {
    /// Turns by less than 2° at all sides.
    Flat,
    /// Turns more, but has no crease.
    Curved,
    /// Has a crease at a side: a turn of more than 20° that is more than 2.5 times
    /// the second smallest at the four sides around, and goes on at both ends.
    Creased,
}

fairing_parameters::named!(FaceKind, "kind of a face",
    Flat: "flat",
    Curved: "curved",
    Creased: "creased",
);

/// The kind of each face, and whether the mesh has creases as long as two of its
/// diagonals.
pub(super) fn face_kinds(mesh: &TriMesh, hinges: &Hinges) -> (Vec<FaceKind>, bool) {
    let normals = FaceShapes::new(mesh).normals;
    let turns: Vec<f64> = (hinges.all.iter())
        .map(|hinge| {
            let [a, b] = hinge.faces.map(|f| normals[f as usize]);
            libm::acos(a.dot(b).clamp(-1.0, 1.0))
        })
        .collect();
    let (crease, flat) = (libm::acos(CREASE), libm::acos(FLAT));
    let sharp: Vec<bool> = (0..turns.len())
        .map(|e| {
            let mut others = [0.0; 4];
            let sides = hinges.all[e].faces.iter().flat_map(|&f| hinges.of_face[f as usize]);
            let sides = sides.filter(|&s| s != e as u32 && s != NO_HINGE);
            others.iter_mut().zip(sides).for_each(|(o, s)| *o = turns[s as usize]);
            others.sort_by(f64::total_cmp);
            turns[e] > crease && turns[e] > STANDS_OUT * others[1]
        })
        .collect();
    let mut ends = vec![0u32; mesh.vertex_count()];
    for (hinge, _) in hinges.all.iter().zip(&sharp).filter(|(_, sharp)| **sharp) {
        hinge.ends.iter().for_each(|&v| ends[v as usize] += 1);
    }
    let goes_on = |e: usize| sharp[e] && hinges.all[e].ends.iter().all(|&v| ends[v as usize] > 1);
    let kinds = (hinges.of_face.iter())
        .map(|sides| {
            let mut sides = sides.iter().filter(|&&e| e != NO_HINGE).map(|&e| e as usize);
            if sides.clone().any(goes_on) {
                FaceKind::Creased
            } else if sides.all(|e| turns[e] < flat) {
                FaceKind::Flat
            } else {
                FaceKind::Curved
            }
        })
        .collect();
    let p = mesh.positions();
    let length: f64 = (0..sharp.len())
        .filter(|&e| goes_on(e))
        .map(|e| {
            let [v, w] = hinges.all[e].ends;
            DVec3::from(p[v as usize]).distance(p[w as usize].into())
        })
        .sum();
    (kinds, length > CREASE_LENGTH * mesh.diagonal())
}

#[cfg(test)]
mod tests {
    use fairing_shapes as shapes;

    use super::*;

    fn kinds(mesh: &TriMesh) -> ([usize; 3], bool) {
        let (kinds, creased) = face_kinds(mesh, &Hinges::new(mesh));
        (FaceKind::ALL.map(|kind| kinds.iter().filter(|k| **k == kind).count()), creased)
    }

    /// A cube of 10 × 10 squares on a side: two faces of a square at each of the
    /// 120 edges on its creases, fewer at corners; a ball has none, even where it
    /// turns by more than 20°.
    #[test]
    fn creases_stand_out() {
        let (found, creased) = kinds(&shapes::cube(10, shapes::Diagonals::Regular));
        assert!(creased && found[1] == 0 && (200..=240).contains(&found[2]), "{found:?}");
        let sphere = shapes::icosphere(1);
        assert_eq!(kinds(&sphere), ([0, sphere.face_count(), 0], false));
        let plane = shapes::plane(5, 5, shapes::Diagonals::Regular);
        assert_eq!(kinds(&plane), ([50, 0, 0], false));
    }
}
