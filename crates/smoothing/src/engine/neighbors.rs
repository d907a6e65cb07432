//! The graph of the edges of a mesh.

use fairing_sparse::GraphLaplacian;
use fairing_sparse::parallel::CHUNK;
use rayon::prelude::*;

/// `L` for uniform weights, `(Lx)ᵢ = mean over neighbours xⱼ − xᵢ`: `S = D − A`, `M = D`. Vertices for which `fixed` is
/// true, and isolated ones, have zero rows.
pub(crate) fn uniform(vertex_count: usize, faces: &[[u32; 3]], fixed: &[bool]) -> GraphLaplacian {
    let (offsets, columns) = neighbor_lists(vertex_count, faces, fixed);
    GraphLaplacian::uniform(offsets, columns)
}

/// Vertices with more faces sort their neighbours to find repetitions: searching is quadratic.
const MANY_FACES: usize = 64;

/// The neighbours of every vertex along edges of faces, each once, in compressed rows; `[v]` for an isolated or
/// fixed vertex `v`.
fn neighbor_lists(n: usize, faces: &[[u32; 3]], fixed: &[bool]) -> (Vec<u32>, Vec<u32>) {
    let mut start = vec![0u32; n + 1];
    for &v in faces.as_flattened() {
        start[v as usize + 1] += 1;
    }
    for v in 0..n {
        start[v + 1] += start[v];
    }
    let mut next = start.clone();
    let mut around = vec![0u32; faces.len() * 3];
    for (f, face) in faces.iter().enumerate() {
        for &v in face {
            let slot = &mut next[v as usize];
            around[*slot as usize] = f as u32;
            *slot += 1;
        }
    }
    let pieces: Vec<(Vec<u32>, Vec<u32>)> = (0..n.div_ceil(CHUNK))
        .into_par_iter()
        .map(|chunk| {
            let vertices = chunk * CHUNK..n.min((chunk + 1) * CHUNK);
            let mut lists = Vec::with_capacity(CHUNK * 7);
            let mut lengths = Vec::with_capacity(CHUNK);
            for v in vertices {
                let begin = lists.len();
                let around = &around[start[v] as usize..start[v + 1] as usize];
                if fixed[v] || around.is_empty() {
                    lists.push(v as u32);
                } else if around.len() > MANY_FACES {
                    let corners = around.iter().flat_map(|&f| faces[f as usize]);
                    let mut all: Vec<u32> = corners.filter(|&j| j as usize != v).collect();
                    all.sort_unstable();
                    all.dedup();
                    lists.extend(all);
                } else {
                    for &f in around {
                        for j in faces[f as usize] {
                            if j as usize != v && !lists[begin..].contains(&j) {
                                lists.push(j);
                            }
                        }
                    }
                }
                lengths.push((lists.len() - begin) as u32);
            }
            (lists, lengths)
        })
        .collect();
    let mut offsets = Vec::with_capacity(n + 1);
    let mut neighbors = Vec::with_capacity(pieces.iter().map(|(lists, _)| lists.len()).sum());
    let mut end = 0;
    offsets.push(0);
    for (lists, lengths) in pieces {
        neighbors.extend_from_slice(&lists);
        for length in lengths {
            end += length;
            offsets.push(end);
        }
    }
    (offsets, neighbors)
}
