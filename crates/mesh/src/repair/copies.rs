//! Faces that occur more than once.

use std::collections::HashMap;

use fairing_watch::parallel;
use rayon::prelude::*;

/// Faces with the same corners.
struct Group {
    corners: [u32; 3],
    faces: Vec<u32>,
}

/// The groups at an edge of a group with an even number of faces.
#[derive(Default)]
struct Edge {
    /// Groups with an even number of faces.
    even: Vec<usize>,
    /// The number of groups with an odd number of faces.
    odd: usize,
}

/// False for the faces to drop, so that of those with the same corners, in any order, one stays.
///
/// Regions of doubled faces are exceptions where one copy would open a closed surface, since an
/// edge at their border has an even number of other faces. A fin, which has an end of its own, is
/// dropped whole, because its copies have nothing between them. A wall without an end keeps both
/// copies if they face each other: it separates two closed parts.
pub(super) fn without_copies(faces: &[[u32; 3]]) -> Vec<bool> {
    let key = |f: usize| {
        let mut corners = faces[f];
        corners.sort_unstable();
        (corners, f as u32)
    };
    let mut keys: Vec<([u32; 3], u32)> = parallel::map(faces.len(), 4096, key);
    keys.par_sort_unstable();
    let groups: Vec<&[([u32; 3], u32)]> = keys.chunk_by(|x, y| x.0 == y.0).collect();
    let mut keep = vec![true; faces.len()];
    for &(_, f) in groups.iter().flat_map(|group| &group[1..]) {
        keep[f as usize] = false;
    }
    let is_even = |group: &&[([u32; 3], u32)]| group.len().is_multiple_of(2);
    let even: Vec<Group> = (groups.iter().copied().filter(is_even))
        .map(|group| Group { corners: group[0].0, faces: group.iter().map(|x| x.1).collect() })
        .collect();
    if even.is_empty() {
        return keep;
    }
    let mut edges: HashMap<[u32; 2], Edge> = HashMap::new();
    for (i, group) in even.iter().enumerate() {
        sides(group.corners)
            .into_iter()
            .for_each(|side| edges.entry(side).or_default().even.push(i));
    }
    for group in groups.iter().filter(|group| group.len() % 2 == 1) {
        for side in sides(group[0].0) {
            if let Some(edge) = edges.get_mut(&side) {
                edge.odd += 1;
            }
        }
    }
    for region in regions(&even, &edges) {
        let borders =
            || region.iter().flat_map(|&i| sides(even[i].corners).map(|side| &edges[&side]));
        let ends = borders().any(|edge| edge.odd == 0 && edge.even.len() == 1);
        let closed = borders().all(|edge| edge.odd.is_multiple_of(2));
        let attached = borders().any(|edge| edge.odd > 0);
        if !closed || !attached {
            continue;
        }
        for group in region.iter().map(|&i| &even[i]) {
            let facing = matches!(group.faces[..], [f, g] if {
                let [f, g] = [f, g].map(|f| faces[f as usize]);
                !winds_as(f, g)
            });
            if ends || facing {
                group.faces.iter().for_each(|&f| keep[f as usize] = !ends);
            }
        }
    }
    keep
}

/// The edges of a face with ascending corners.
fn sides([a, b, c]: [u32; 3]) -> [[u32; 2]; 3] {
    [[a, b], [b, c], [a, c]]
}

/// Returns true if two faces with the same corners have the same winding.
fn winds_as(face: [u32; 3], other: [u32; 3]) -> bool {
    (0..3).any(|k| [face[k], face[(k + 1) % 3], face[(k + 2) % 3]] == other)
}

/// Groups connected by edges that have two of them and no other face.
fn regions(groups: &[Group], edges: &HashMap<[u32; 2], Edge>) -> Vec<Vec<usize>> {
    let mut seen = vec![false; groups.len()];
    let mut regions = vec![];
    for start in 0..groups.len() {
        let (mut region, mut stack) = (vec![], vec![start]);
        while let Some(i) = stack.pop() {
            if std::mem::replace(&mut seen[i], true) {
                continue;
            }
            region.push(i);
            for side in sides(groups[i].corners) {
                if let Edge { even, odd: 0 } = &edges[&side]
                    && let [_, _] = even[..]
                {
                    stack.extend(even);
                }
            }
        }
        if !region.is_empty() {
            regions.push(region);
        }
    }
    regions
}
