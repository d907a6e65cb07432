//! The surfaces of families, measured.

use std::collections::BTreeSet;

use fairing_evaluation::self_intersections;
use fairing_mesh::TriMesh;
use glam::DVec3;
use rayon::prelude::*;

use super::{Family, Kind, Triangulation};

fn triangulation(k: usize) -> Triangulation {
    Triangulation::ALL[k % 4]
}

#[test]
fn families_do_not_cross_themselves() {
    Family::ALL.par_iter().enumerate().for_each(|(k, family)| {
        let mesh = family.mesh(2000, triangulation(k), 40 + k as u64);
        assert_eq!(self_intersections(&mesh), 0, "{family} {}", triangulation(k));
    });
}

/// The direction of a vector that is not zero.
fn direction(v: [f64; 3]) -> DVec3 {
    DVec3::from(v).try_normalize().unwrap()
}

/// The length of side k of a triangle.
fn side(triangle: [[f64; 3]; 3], k: usize) -> f64 {
    DVec3::from(triangle[k]).distance(triangle[(k + 1) % 3].into())
}

/// The normals of all faces, rounded to six digits.
fn directions(mesh: &TriMesh) -> BTreeSet<[i64; 3]> {
    let rounded = |f| direction(mesh.area_vector(f)).to_array().map(|x| (1e6 * x).round() as i64);
    (0..mesh.face_count()).map(rounded).collect()
}

/// A face across a crease of a model with plane sides would have a normal of its own, so there are
/// no more normals than sides. The star has 60; rounding may split each.
#[test]
fn no_face_of_a_planar_family_spans_a_crease() {
    let planar = Family::ALL.iter().filter(|f| f.kind() == Kind::Planar);
    for (k, family) in planar.enumerate() {
        let mesh = family.mesh(2000, triangulation(k + 1), 7);
        let found = directions(&mesh).len();
        assert!((5..=150).contains(&found), "{family}: {found} normals of {}", mesh.face_count());
    }
}

/// All three corners of each face lie on one cylinder or end. The face has its normal up to the
/// error of a chord: half the turn over the face, and the sagitta over the height of the face.
#[test]
fn faces_of_the_joint_lie_on_its_cylinders() {
    for k in 0..4 {
        let mesh = Family::Joint.mesh(2000, triangulation(k), k as u64);
        let x = mesh.positions();
        let radius = |along: usize, at: f64| {
            let rim = x.iter().filter(|p| (p[along] - at).abs() < 1e-12);
            rim.map(|p| p[(along + 1) % 3].hypot(p[(along + 2) % 3])).fold(0.0, f64::max)
        };
        let (wide, thin) = (radius(0, 1.0), radius(2, 1.1));
        assert!(0.2 < thin && thin < wide && wide < 0.6);
        for f in 0..mesh.face_count() {
            let t = mesh.triangle(f);
            let n = direction(mesh.area_vector(f));
            let all = |is: &dyn Fn([f64; 3]) -> bool| t.iter().all(|&p| is(p));
            let middle = [0, 1, 2].map(|k| (t[0][k] + t[1][k] + t[2][k]) / 3.0);
            let expected = [
                (all(&|p| (p[1].hypot(p[2]) - wide).abs() < 1e-9), [0.0, middle[1], middle[2]]),
                (all(&|p| (p[0].hypot(p[1]) - thin).abs() < 1e-9), [middle[0], middle[1], 0.0]),
                (all(&|p| (p[0].abs() - 1.0).abs() < 1e-9), [middle[0], 0.0, 0.0]),
                (all(&|p| (p[2] - 1.1).abs() < 1e-9), [0.0, 0.0, 1.0]),
            ];
            let height = 2.0 * mesh.face_area(f) / (0..3).map(|k| side(t, k)).fold(0.0, f64::max);
            let agrees = |normal: [f64; 3]| {
                let out = direction(normal);
                // Where the normal has no component, neither have the corners except along the
                // axis.
                let beside =
                    |p: [f64; 3]| [0, 1, 2].map(|k| if normal[k] == 0.0 { 0.0 } else { p[k] });
                let turn = t.map(|p| out.dot(direction(beside(p))).clamp(-1.0, 1.0).acos());
                let half = turn.into_iter().fold(0.0, f64::max);
                let arc = wide * (1.0 - half.cos());
                n.dot(out) > (half + (arc / height).min(1.0).asin() + 1e-6).min(1.57).cos()
            };
            let fits = expected.into_iter().any(|(on, normal)| on && agrees(normal));
            assert!(fits, "face {f} of {}: {t:?}, normal {n:?}", triangulation(k));
        }
    }
}

/// The shortest edge of a graded mesh is far below its longest, as its density varies by ten; faces
/// of the anisotropic cylinders of a gear are stretched.
#[test]
fn triangulations_are_what_they_say() {
    let spread = |triangulation| {
        let mesh = Family::Frame.mesh(3000, triangulation, 3);
        let mut areas: Vec<f64> = (0..mesh.face_count()).map(|f| mesh.face_area(f)).collect();
        areas.sort_by(f64::total_cmp);
        let n = areas.len();
        let aspects = (0..n).map(|f| {
            let t = mesh.triangle(f);
            let longest = side(t, 0).max(side(t, 1)).max(side(t, 2));
            longest * longest / (2.0 * mesh.face_area(f))
        });
        (areas[19 * n / 20] / areas[n / 20], aspects.sum::<f64>() / n as f64)
    };
    let [regular, irregular, anisotropic, graded] = Triangulation::ALL.map(spread);
    // An equilateral triangle has 2/√3.
    assert!(regular.0 < 2.5 && regular.1 < 1.5, "{regular:?}");
    assert!(irregular.0 > 1.5 && irregular.1 > 1.5 && irregular.1 < 1.8, "{irregular:?}");
    assert!(anisotropic.1 > 2.2, "{anisotropic:?}");
    assert!(graded.0 > 6.0 && graded.1 < 1.6, "{graded:?}");
}
