//! Vertices far from everything around them.

use std::borrow::Cow;

use fairing_mesh::TriMesh;
use fairing_sparse::upper_median;
use fairing_watch::parallel;
use glam::DVec3;

use crate::error::DenoiseError;
use crate::masked::Masked;

/// The least excess of a spike or of an impulse.
#[derive(Clone, Copy)]
struct Bounds {
    /// The excess in mean distances of the neighbours.
    steep: f64,
    /// The excess in medians of a distance over some rings.
    far: f64,
    /// The distance of these medians.
    around: fn(&Height) -> f64,
    /// The excess in mesh units.
    least: f64,
}

/// Spikes are steeper than corners.
const SPIKE: Bounds = Bounds { steep: 1.0, far: 8.0, around: |h| h.height.abs(), least: 0.0 };

/// Impulses are between vertices with little noise, whose heights are those of the shape.
const IMPULSE: Bounds = Bounds { steep: 0.25, far: 12.0, around: |h| h.excess, least: 0.0 };

/// The least excess of an impulse, in noise levels.
const FAR_IMPULSE: f64 = 15.0;

/// The least fraction of the vertices that may move and are such impulses: fewer may be corners.
const IMPULSES: f64 = 0.01;

/// The rings of vertices around a spike that its excess is compared with.
const RINGS: usize = 3;

/// The largest height over the plane of its neighbours that a vertex is put at, as a fraction of
/// their mean distance.
const BENT: f64 = 0.25;

/// A vertex with more neighbours is no spike, and is not looked past.
const HUB: usize = 64;

/// The most rounds: each moves the highest of spikes that are neighbours.
const ROUNDS: usize = 32;

/// Puts spikes on the surface around them, repeatedly until none is left.
///
/// The two rings around a vertex predict its height over the plane of its neighbours in three
/// ways: as zero, by a paraboloid, and by a cone. The excess is its distance from the interval of
/// the three. A spike has a larger excess than each neighbour, above the mean distance of the
/// neighbours, above the median distance of the second ring from that plane, and above eight times
/// the median of the heights over three rings, about six standard deviations of independent noise.
/// So creases, and corners and tips that continue over two rings, are hardly ever spikes. Fixed
/// vertices and those on borders never are.
pub(super) fn without_spikes(input: Masked<'_>) -> Result<Cow<'_, TriMesh>, DenoiseError> {
    put_back(input, SPIKE)
}

/// The same for impulses that are a quarter as steep, but whose excess is above 15 times the noise
/// level `sigma` and 12 times the median excess over three rings; the mesh itself unless they are
/// one in a hundred of the vertices that may move.
pub(super) fn without_impulses(
    input: Masked<'_>,
    sigma: f64,
) -> Result<Cow<'_, TriMesh>, DenoiseError> {
    let mesh = input.mesh();
    let without = put_back(input, Bounds { least: FAR_IMPULSE * sigma, ..IMPULSE })?;
    let pairs = mesh.positions().iter().zip(without.positions());
    let count = pairs.filter(|(p, q)| p != q).count() as f64;
    let free = (0..mesh.vertex_count()).filter(|&v| !input.is_fixed(v)).count();
    let are_few = count < IMPULSES * free as f64;
    Ok(if are_few { Cow::Borrowed(mesh) } else { without })
}

fn put_back(input: Masked<'_>, bounds: Bounds) -> Result<Cow<'_, TriMesh>, DenoiseError> {
    let mut current = Cow::Borrowed(input.mesh());
    for _ in 0..ROUNDS {
        let heights = heights(&current);
        let spikes: Vec<usize> = (0..current.vertex_count())
            .filter(|&v| !input.is_fixed(v) && heights[v].excess > bounds.least)
            .filter(|&v| is_spike(&current, &heights, v as u32, bounds))
            .collect();
        if spikes.is_empty() {
            break;
        }
        let mut positions = current.positions().to_vec();
        for v in spikes {
            positions[v] = heights[v].place.to_array();
        }
        current = Cow::Owned(current.with_positions(positions)?);
    }
    Ok(current)
}

/// A vertex over its neighbours.
#[derive(Clone, Copy, Default)]
struct Height {
    /// Over their plane.
    height: f64,
    /// Their mean distance from their mean, along the plane; the median distance of the second ring
    /// from the plane if that is larger.
    reach: f64,
    /// The point over their mean that two rings predict.
    place: DVec3,
    /// The distance from the prism over the neighbours that lies between the predictions.
    excess: f64,
}

/// The height of each inner vertex; zero for vertices on borders and for hubs.
fn heights(mesh: &TriMesh) -> Vec<Height> {
    parallel::map_with(mesh.vertex_count(), 64, Vec::new, |second, v| {
        height(mesh, v as u32, second).unwrap_or_default()
    })
}

/// The plane of the neighbours has the area vector of their polygon, and goes through their mean.
fn height(mesh: &TriMesh, v: u32, second: &mut Vec<(u32, f64)>) -> Option<Height> {
    let (topology, faces) = (mesh.topology(), mesh.faces());
    let (ring, corners) = (topology.neighbors(v), mesh.incidence().corners(v));
    if ring.len() < 3 || ring.len() > HUB || corners.len() != ring.len() {
        return None;
    }
    let at = |v: u32| DVec3::from(mesh.positions()[v as usize]);
    let x = at(v);
    let mut sum = DVec3::ZERO;
    for &c in corners {
        let (f, k) = (c as usize / 3, c as usize % 3);
        let [p, q] = [1, 2].map(|i| at(faces[f][(k + i) % 3]));
        // Over a closed polygon the sum does not depend on x.
        sum += (p - x).cross(q - x);
    }
    let up = sum.try_normalize()?;
    let count = ring.len() as f64;
    let mean = ring.iter().fold(DVec3::ZERO, |s, &w| s + at(w)) * (1.0 / count);
    let along = |w: u32| (at(w) - mean).reject_from_normalized(up).length();
    let reach = ring.iter().map(|&w| along(w)).sum::<f64>() / count;
    second.clear();
    for beyond in ring.iter().map(|&w| topology.neighbors(w)).filter(|r| r.len() <= HUB) {
        let next = beyond.iter().filter(|&u| *u != v && !ring.contains(u));
        second.extend(next.map(|&u| (u, up.dot(at(u) - mean))));
    }
    second.sort_unstable_by_key(|&(u, _)| u);
    second.dedup_by_key(|&mut (u, _)| u);
    if second.len() < ring.len() || reach <= 0.0 {
        return None;
    }
    let further = second.iter().map(|&(u, _)| along(u)).sum::<f64>() / second.len() as f64;
    let middle = second.len() / 2;
    let (_, &mut (_, fall), _) = second.select_nth_unstable_by(middle, |a, b| a.1.total_cmp(&b.1));
    let (_, &mut (_, size), _) =
        second.select_nth_unstable_by(middle, |a, b| a.1.abs().total_cmp(&b.1.abs()));
    let spread = size.abs();
    let further = further.max(1.25 * reach);
    let cone = -fall * reach / (further - reach);
    let paraboloid = -fall * reach * reach / (further * further - reach * reach);
    let height = up.dot(x - mean);
    let (low, high) = (cone.min(0.0), cone.max(0.0));
    let above = height - height.clamp(low, high);
    let outermost = ring.iter().map(|&w| along(w)).fold(0.0, f64::max);
    let beside = (along(v) - outermost).max(0.0);
    let excess = (above * above + beside * beside).sqrt();
    let place = mean + paraboloid.clamp(-BENT * reach, BENT * reach) * up;
    Some(Height { height, reach: reach.max(spread), place, excess })
}

fn is_spike(mesh: &TriMesh, heights: &[Height], v: u32, bounds: Bounds) -> bool {
    let Height { excess, reach, .. } = heights[v as usize];
    let is_higher = |&w: &u32| (heights[w as usize].excess, v) > (excess, w);
    excess > bounds.steep * reach
        && !mesh.topology().neighbors(v).iter().any(is_higher)
        && excess > bounds.far * median_around(mesh, heights, v, bounds.around)
}

/// The median of a distance over some rings around a vertex, without its own.
fn median_around(mesh: &TriMesh, heights: &[Height], v: u32, distance: fn(&Height) -> f64) -> f64 {
    let mut found = vec![v];
    for _ in 0..RINGS {
        let rings = found.iter().map(|&w| mesh.topology().neighbors(w)).filter(|r| r.len() <= HUB);
        let next: Vec<u32> = rings.flatten().copied().collect();
        found.extend(next);
        found.sort_unstable();
        found.dedup();
    }
    let others = found.iter().filter(|&&w| w != v);
    upper_median(others.map(|&w| distance(&heights[w as usize])).collect()).unwrap_or(0.0)
}

/// The spikes that were moved.
#[derive(Default)]
pub(super) struct Spikes {
    pub(super) count: usize,
    /// The largest distance that one was moved.
    pub(super) farthest: f64,
}

/// Counts the spikes among positions; those that `stay` go back to where they were.
pub(super) fn counted_spikes(
    original: &TriMesh,
    positions: &mut [[f64; 3]],
    stay: impl Fn(u32) -> bool,
) -> Spikes {
    let (mut count, mut farthest) = (0, 0.0f64);
    for (v, (position, &from)) in (0..).zip(positions.iter_mut().zip(original.positions())) {
        if stay(v) {
            *position = from;
        } else if *position != from {
            count += 1;
            farthest = DVec3::from(*position).distance(from.into()).max(farthest);
        }
    }
    Spikes { count, farthest }
}

#[cfg(test)]
mod tests {
    use fairing_shapes as shapes;

    use super::*;

    /// A sphere of which some vertices are far away in all directions, some of them neighbours,
    /// with little, much and no noise at the others: the spikes return to the surface, and hardly
    /// anything else moves.
    #[test]
    fn spikes_return_to_the_surface() {
        let truth = shapes::icosphere(4);
        let h = truth.mean_edge_length();
        for amount in [0.0, 0.02, 0.3] {
            let noisy = shapes::jittered(&truth, amount, 3, |p| p);
            let far = shapes::jittered(&truth, 0.49, 4, |p| p);
            let is_far = |v: usize| v * 7919 % 100 < 5;
            let positions = (noisy.positions().iter().zip(truth.positions().iter()).enumerate())
                .map(|(v, (&p, &t))| {
                    let away = (DVec3::from(far.positions()[v]) - DVec3::from(t)).normalize();
                    let by = if is_far(v) { 3.0 + (v % 7) as f64 } else { 0.0 };
                    (DVec3::from(p) + by * h * away).to_array()
                })
                .collect();
            let input = noisy.with_positions(positions).unwrap();
            let fixed: Vec<bool> = (0..truth.vertex_count()).map(|v| v % 10 == 0).collect();
            let found = without_spikes(Masked::new(&input, &fixed).unwrap()).unwrap();
            let (mut back, mut all, mut strays) = (0, 0, 0);
            for (v, &p) in found.positions().iter().enumerate() {
                let distance = DVec3::from(p).distance(truth.positions()[v].into());
                if is_far(v) && !fixed[v] {
                    (back, all) = (back + usize::from(distance < 0.7 * h), all + 1);
                } else if p != input.positions()[v] {
                    assert!(!fixed[v]);
                    strays += 1;
                }
            }
            // Fixed spikes draw others aside.
            assert!(all > 100 && back * 10 > all * 9, "{amount}: {back} of {all}");
            assert!(strays <= 3, "{amount}: {strays} others moved");
        }
    }

    /// A coarse sphere of which a tenth of the vertices are displaced by half an edge: most return,
    /// and hardly anything else moves. The heights of the others are those of the sphere, an eighth
    /// of the displacement and more.
    #[test]
    fn impulses_return_to_a_curved_surface() {
        let truth = shapes::icosphere(3);
        let h = truth.mean_edge_length();
        let is_moved = |v: usize| v * 7919 % 100 < 10;
        let moved = truth.positions().iter().enumerate().map(|(v, &p)| {
            let by = if is_moved(v) { 0.5 * h } else { 0.0 };
            p.map(|x| (1.0 + by) * x)
        });
        let input = truth.with_positions(moved.collect()).unwrap();
        let found = without_impulses((&input).into(), 1e-4 * h).unwrap();
        let distance =
            |v: usize| DVec3::from(found.positions()[v]).distance(truth.positions()[v].into()) / h;
        let (moved, rest): (Vec<usize>, Vec<usize>) =
            (0..truth.vertex_count()).partition(|&v| is_moved(v));
        let back = moved.iter().filter(|&&v| distance(v) < 0.2).count();
        assert!(back * 4 > moved.len() * 3, "{back} of {}", moved.len());
        assert!(rest.iter().filter(|&&v| distance(v) > 0.0).count() <= 3);
    }

    /// Creases, corners and tips are never mistaken for spikes, at any noise.
    #[test]
    fn corners_are_not_spikes() {
        let cube = shapes::cube(10, shapes::Diagonals::Alternating);
        let flat = shapes::plane(30, 30, shapes::Diagonals::Regular);
        let heights = flat.positions().iter().map(|&[x, y, _]| [x, y, (x - 0.5).hypot(y - 0.5)]);
        let cone = flat.with_positions(heights.map(|[x, y, r]| [x, y, 3.0 * r]).collect()).unwrap();
        let block = shapes::cad_block(0.1);
        for truth in [cube, block, cone, shapes::creature(48)] {
            for amount in [0.0, 0.001, 0.02, 0.2] {
                let noisy = shapes::jittered(&truth, amount, 3, |p| p);
                let found = without_spikes((&noisy).into()).unwrap();
                assert!(matches!(found, Cow::Borrowed(_)), "{amount}");
            }
        }
    }
}
