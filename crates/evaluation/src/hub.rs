//! Vertices of many faces: the boxes around these faces overlap in most pairs, but the directions
//! in which the vertex sees them do not.

use fairing_mesh::TriMesh;
use glam::DVec3;

/// The number of faces at a vertex above which they are sorted by direction. Below, up to half a
/// million pairs are tested one by one, in hundredths of a second.
const HUB: usize = 1000;

/// A triangle whose box has all directions.
const ALL_DIRECTIONS: [DVec3; 3] = [DVec3::NEG_ONE, DVec3::ONE, DVec3::ONE];

/// The faces without a hub, a vertex of more than [`HUB`] faces, and those of each hub, of which a
/// face with several has the lowest.
pub(crate) fn by_hub(mesh: &TriMesh) -> (Vec<u32>, Vec<(u32, Vec<u32>)>) {
    let offsets = mesh.incidence().offsets();
    let is_hub = |v: u32| (offsets[v as usize + 1] - offsets[v as usize]) as usize > HUB;
    let mut of_hubs: Vec<(u32, u32)> = vec![];
    let mut others = vec![];
    for (f, face) in mesh.faces().iter().enumerate() {
        match face.iter().copied().filter(|&v| is_hub(v)).min() {
            Some(hub) => of_hubs.push((hub, f as u32)),
            None => others.push(f as u32),
        }
    }
    of_hubs.sort_unstable();
    let groups = of_hubs.chunk_by(|a, b| a.0 == b.0);
    (others, groups.map(|group| (group[0].0, group.iter().map(|x| x.1).collect())).collect())
}

/// A triangle with a box around the directions in which a vertex sees a face.
///
/// For a corner of the face they are an arc of the unit sphere. Two faces that cross do so in a
/// direction of both.
pub(crate) fn seen(mesh: &TriMesh, vertex: u32, face: u32) -> [DVec3; 3] {
    let at = |v: u32| DVec3::from(mesh.positions()[v as usize]);
    let direction = |v: u32| (at(v) - at(vertex)).try_normalize();
    let [a, b, c] = mesh.faces()[face as usize];
    let arc_between = |v: u32, w: u32| arc(direction(v)?, direction(w)?);
    let found = match [a == vertex, b == vertex, c == vertex] {
        [true, ..] => arc_between(b, c),
        [_, true, _] => arc_between(c, a),
        [.., true] => arc_between(a, b),
        _ => [a, b, c].map(direction).into_iter().collect::<Option<Vec<_>>>().and_then(around),
    };
    found.unwrap_or(ALL_DIRECTIONS)
}

/// A triangle around an arc between two directions, their ends and where the tangents there meet.
/// `None` beyond a right angle, up to which they meet within √2.
fn arc(u: DVec3, v: DVec3) -> Option<[DVec3; 3]> {
    (u.dot(v) >= 0.0).then(|| [u, v, (u + v) * (1.0 / (1.0 + u.dot(v)))])
}

/// A triangle with the box of a triangle of the sphere: that of its sides, and beyond where it has
/// the end of an axis inside.
fn around(corners: Vec<DVec3>) -> Option<[DVec3; 3]> {
    let sides =
        [arc(corners[0], corners[1])?, arc(corners[1], corners[2])?, arc(corners[2], corners[0])?];
    let points = sides.as_flattened();
    let mut low = points.iter().copied().fold(DVec3::INFINITY, DVec3::min);
    let mut high = points.iter().copied().fold(DVec3::NEG_INFINITY, DVec3::max);
    for (k, axis) in DVec3::AXES.into_iter().enumerate() {
        // Rounding must not put an axis on a side outside.
        let turns = [0, 1, 2].map(|i| corners[i].cross(corners[(i + 1) % 3]).dot(axis));
        if turns.iter().all(|&t| t >= -1e-12) || turns.iter().all(|&t| t <= 1e-12) {
            (low[k], high[k]) = (-1.0, 1.0);
        }
    }
    Some([low, high, high])
}
