//! Models with plane faces.

use std::collections::HashMap;

use glam::DVec3;

use super::solid::{Chart, Curve, Solid, joined, reversed};

/// The corners of a model with plane faces, and its faces, each a loop of corners
/// counter-clockwise seen from outside.
pub(super) struct Polyhedron {
    pub(super) corners: Vec<[f64; 3]>,
    pub(super) faces: Vec<Vec<usize>>,
}

/// Adds the model.
pub(super) fn polyhedron(solid: &mut Solid, Polyhedron { corners, faces }: &Polyhedron) {
    let ids: Vec<u32> = corners.iter().map(|&p| solid.corner(p)).collect();
    let mut lines: HashMap<(usize, usize), Curve> = HashMap::new();
    for face in faces {
        let n = face.len();
        let sides: Vec<Curve> = (0..n)
            .map(|i| {
                let (a, b) = (face[i], face[(i + 1) % n]);
                let key = (a.min(b), a.max(b));
                let line = lines.entry(key).or_insert_with(|| solid.line(ids[key.0], ids[key.1]));
                if a == key.0 { line.clone() } else { reversed(line) }
            })
            .collect();
        let border = joined(&sides.iter().map(Vec::as_slice).collect::<Vec<_>>());
        let p: Vec<DVec3> = face.iter().map(|&i| corners[i].into()).collect();
        // Twice the vector area.
        let normal = (1..n - 1).fold(DVec3::ZERO, |s, i| s + (p[i] - p[0]).cross(p[i + 1] - p[0]));
        let normal = normal * (1.0 / normal.length());
        solid.face(&[border], &Chart::plane(p[0], normal, p[1] - p[0]));
    }
}

/// The convex model `x · n ≤ d` for all planes (n, d),
/// n of unit length; `None` if two corners are closer than `least`.
pub(super) fn convex(planes: &[(DVec3, f64)], least: f64) -> Option<Polyhedron> {
    let (mut corners, mut on): (Vec<DVec3>, Vec<[usize; 3]>) = (vec![], vec![]);
    let n = planes.len();
    for i in 0..n {
        for j in i + 1..n {
            for k in j + 1..n {
                let Some(p) = meeting([planes[i], planes[j], planes[k]]) else { continue };
                let inside = planes
                    .iter()
                    .enumerate()
                    .all(|(m, (normal, d))| [i, j, k].contains(&m) || normal.dot(p) < *d);
                if inside {
                    corners.push(p);
                    on.push([i, j, k]);
                }
            }
        }
    }
    for a in 0..corners.len() {
        for b in 0..a {
            if corners[a].distance(corners[b]) < least {
                return None;
            }
        }
    }
    let mut faces = vec![];
    for (m, (normal, _)) in planes.iter().enumerate() {
        let mut face: Vec<usize> = (0..corners.len()).filter(|&c| on[c].contains(&m)).collect();
        if face.len() < 3 {
            return None;
        }
        let sum = face.iter().fold(DVec3::ZERO, |s, &c| s + corners[c]);
        let middle = sum * (1.0 / face.len() as f64);
        let x = (corners[face[0]] - middle).try_normalize()?;
        let y = normal.cross(x);
        let angle = |c: usize| {
            let d = corners[c] - middle;
            libm::atan2(d.dot(y), d.dot(x))
        };
        face.sort_by(|&a, &b| angle(a).total_cmp(&angle(b)));
        faces.push(face);
    }
    let corners = corners.into_iter().map(DVec3::into).collect();
    Some(Polyhedron { corners, faces })
}

/// The intersection of three planes; `None` if they are nearly dependent.
pub(super) fn meeting([(a, d), (b, e), (c, f)]: [(DVec3, f64); 3]) -> Option<DVec3> {
    let determinant = a.dot(b.cross(c));
    if determinant.abs() < 1e-6 {
        return None;
    }
    let sum = b.cross(c) * d + c.cross(a) * e + a.cross(b) * f;
    Some(sum * (1.0 / determinant))
}
