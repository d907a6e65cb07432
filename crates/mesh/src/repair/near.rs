//! Vertices that are near each other.

use std::collections::HashMap;

use glam::DVec3;

/// For each of some ascending vertices the first of them within a distance that is not itself
/// merged, so that vertices are not merged in chains; for the others these themselves. No two are
/// merged that are farther apart than the limit of either.
pub(super) fn within(
    positions: &[[f64; 3]],
    vertices: &[u32],
    distance: f64,
    limit: impl Fn(u32) -> f64,
) -> Vec<u32> {
    // Cells are no finer than coordinates are, and their numbers fit.
    let largest = positions.as_flattened().iter().fold(0.0, |max: f64, x| max.max(x.abs()));
    let side = distance.max(1e-12 * largest);
    let cell = |p: DVec3| (p / side).floor().to_array().map(|x| x as i64);
    let mut cells: HashMap<[i64; 3], Vec<u32>> = HashMap::new();
    let around = |p: DVec3| {
        let [low, high] = [cell(p - distance), cell(p + distance)];
        let [x, y, z] = std::array::from_fn(|k| low[k]..=high[k]);
        x.flat_map(move |x| y.clone().map(move |y| [x, y]))
            .flat_map(move |[x, y]| z.clone().map(move |z| [x, y, z]))
    };
    let mut first: Vec<u32> = (0..positions.len() as u32).collect();
    for &v in vertices {
        let p = DVec3::from(positions[v as usize]);
        let near = around(p).filter_map(|cell| cells.get(&cell)).flatten().copied();
        let near = near.filter(|&w| {
            let limit = distance.min(limit(v)).min(limit(w));
            p.distance(positions[w as usize].into()) <= limit
        });
        match near.min() {
            Some(w) => first[v as usize] = w,
            None => cells.entry(cell(p)).or_default().push(v),
        }
    }
    first
}
