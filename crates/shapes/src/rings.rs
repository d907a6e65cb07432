//! Faces between rings of different counts.

/// The faces between two rings around an axis, counter-clockwise seen from
/// where both turn counter-clockwise: `outer` and `inner` list their vertices
/// from the same direction on, evenly spaced, the inner one nearer the axis.
pub(super) fn between(outer: &[u32], inner: &[u32]) -> Vec<[u32; 3]> {
    let (n, m) = (outer.len(), inner.len());
    let mut faces = Vec::with_capacity(n + m);
    let (mut i, mut j) = (0, 0);
    while i < n || j < m {
        let (a, b) = (outer[i % n], inner[j % m]);
        // The ring whose next vertex comes first goes on: (i + 1) / n against
        // (j + 1) / m.
        if i < n && (j == m || (i + 1) * m <= (j + 1) * n) {
            faces.push([b, a, outer[(i + 1) % n]]);
            i += 1;
        } else {
            faces.push([b, a, inner[(j + 1) % m]]);
            j += 1;
        }
    }
    faces
}

/// The faces of a disc whose border is `border`, counter-clockwise, filled
/// with shrinking rings and a centre. New vertices are numbered from `first`
/// on, ring after ring inwards, the centre last; they are returned in polar
/// coordinates: radius as a fraction of the border's, angle as a fraction of a
/// turn.
pub(super) fn disc(border: &[u32], first: u32) -> (Vec<[f64; 2]>, Vec<[u32; 3]>) {
    let n = border.len();
    // Rings as far apart as neighbours on the border: n / 2π of them.
    let rings = ((n as f64 / std::f64::consts::TAU).round() as usize).max(1);
    let (mut points, mut faces) = (vec![], vec![]);
    let mut outer = border.to_vec();
    for k in (1..rings).rev() {
        let count = (n * k / rings).max(3);
        let start = first + points.len() as u32;
        let inner: Vec<u32> = (start..start + count as u32).collect();
        let radius = k as f64 / rings as f64;
        points.extend((0..count).map(|i| [radius, i as f64 / count as f64]));
        faces.extend(between(&outer, &inner));
        outer = inner;
    }
    let centre = first + points.len() as u32;
    points.push([0.0, 0.0]);
    faces.extend((0..outer.len()).map(|i| [centre, outer[i], outer[(i + 1) % outer.len()]]));
    (points, faces)
}
