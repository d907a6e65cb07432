//! Nested dissection: a fill-reducing ordering by short cuts through the graph of a matrix.
//!
//! A separator, eliminated last, splits the graph into halves without mutual fill; the halves are
//! split recursively. Each node has coordinates: its distances (in edges) to a few nodes far apart,
//! smoothed over neighbours. A part is cut across the direction of largest variance, where the
//! fewest edges cross near the median, and the separator is a minimum vertex cover of the cut edges
//! (König's theorem). Pieces below [`LEAF`] nodes are ordered by minimum degree, each by itself.
//!
//! Source: [george1973], \[harel2002\].
//!
//! [george1973]: https://doi.org/10.1137/0710032

use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};

use fairing_watch::parallel::map;

use crate::direct::backend::{self, TooLarge};
use crate::matrix::Rows;

/// Parts with fewer nodes are not cut.
const LEAF: usize = 300;
/// Coordinates of a node.
const AXES: usize = 6;
/// Rounds of smoothing of the coordinates.
const ROUNDS: usize = 4;
/// Largest distance of the cut from the median, as a fraction of the nodes.
const WINDOW: f64 = 0.06;
/// Largest separator, as a fraction of its part; graphs that are not surfaces exceed it.
const MAX_SEPARATOR: f64 = 0.3;
/// Parts with fewer nodes run on one thread.
const PARALLEL: usize = 5_000;

type Place = [f32; AXES];

/// A part of the graph with its nodes renumbered.
struct Part {
    names: Vec<u32>,
    starts: Vec<u32>,
    neighbors: Vec<u32>,
    places: Vec<Place>,
}

/// An order of elimination in two parts.
#[derive(Debug, Default)]
struct Dissection {
    /// Nodes of the leaves, eliminated first.
    leaves: Vec<u32>,
    /// Nodes of the separators, children before parents.
    separators: Vec<u32>,
}

/// The nested dissection order of a symmetric matrix; anything once `spared` is true.
pub(crate) fn dissected(rows: Rows<'_>, spared: &AtomicBool) -> Result<Vec<u32>, TooLarge> {
    let Dissection { leaves, separators } = dissect(rows, spared)?;
    Ok([leaves, separators].concat())
}

fn dissect(rows: Rows<'_>, spared: &AtomicBool) -> Result<Dissection, TooLarge> {
    let n = rows.count();
    let mut starts = Vec::with_capacity(n + 1);
    let mut neighbors = Vec::with_capacity(rows.columns.len());
    starts.push(0);
    for i in 0..n {
        neighbors.extend(rows.row(i).0.iter().copied().filter(|&j| j as usize != i));
        starts.push(neighbors.len() as u32);
    }
    let mut whole =
        Part { names: (0..n as u32).collect(), starts, neighbors, places: vec![[0.0; AXES]; n] };
    if n > LEAF {
        whole.find_places(spared);
    }
    whole.dissect(spared)
}

impl Part {
    fn len(&self) -> usize {
        self.names.len()
    }

    fn around(&self, node: usize) -> &[u32] {
        &self.neighbors[self.starts[node] as usize..self.starts[node + 1] as usize]
    }

    /// Sets the coordinates: distances to nodes, each the farthest from those before, smoothed.
    /// Nodes of different components get a distance larger than any within a component.
    fn find_places(&mut self, spared: &AtomicBool) {
        let n = self.len();
        let mut nearest = vec![u32::MAX; n];
        // Starts at the farthest node from an arbitrary one.
        let mut from = farthest(&self.distances(0));
        for axis in 0..AXES {
            if spared.load(Relaxed) {
                return;
            }
            let distances = self.distances(from);
            for ((place, near), &d) in self.places.iter_mut().zip(&mut nearest).zip(&distances) {
                place[axis] = d.min(n as u32) as f32;
                *near = (*near).min(d);
            }
            from = farthest(&nearest);
        }
        for _ in 0..ROUNDS {
            self.places = map(n, 1024, |node| {
                let around = self.around(node);
                let mut sum = self.places[node];
                for &other in around {
                    for axis in 0..AXES {
                        sum[axis] += self.places[other as usize][axis];
                    }
                }
                sum.map(|s| s / (around.len() + 1) as f32)
            });
        }
    }

    /// Graph distances from a node to every other, `u32::MAX` if unreachable.
    fn distances(&self, from: usize) -> Vec<u32> {
        let mut distance = vec![u32::MAX; self.len()];
        let mut queue = Vec::with_capacity(self.len());
        distance[from] = 0;
        queue.push(from as u32);
        let mut head = 0;
        while let Some(&node) = queue.get(head) {
            head += 1;
            let next = distance[node as usize] + 1;
            for &other in self.around(node as usize) {
                if distance[other as usize] == u32::MAX {
                    distance[other as usize] = next;
                    queue.push(other);
                }
            }
        }
        distance
    }

    fn dissect(self, spared: &AtomicBool) -> Result<Dissection, TooLarge> {
        if spared.load(Relaxed) {
            return Ok(Dissection::default());
        }
        let side = if self.len() > LEAF { self.cut() } else { None };
        let Some(side) = side else {
            let graph = Rows { starts: &self.starts, columns: &self.neighbors, values: &[] };
            let order = backend::minimum_degree(graph)?;
            let leaves = order.into_iter().map(|k| self.names[k as usize]).collect();
            return Ok(Dissection { leaves, separators: vec![] });
        };
        let separator: Vec<u32> =
            (0..self.len()).filter(|&i| side[i] == Side::Cut).map(|i| self.names[i]).collect();
        let large = self.len() > PARALLEL;
        let halves = [Side::Low, Side::High].map(|half| self.part(&side, half));
        drop(self);
        let [low, high] = halves;
        let (low, high) = if large {
            rayon::join(|| low.dissect(spared), || high.dissect(spared))
        } else {
            (low.dissect(spared), high.dissect(spared))
        };
        let (mut low, high) = (low?, high?);
        low.leaves.extend(high.leaves);
        low.separators.extend(high.separators);
        low.separators.extend(separator);
        Ok(low)
    }

    /// The subgraph of the nodes on one side.
    fn part(&self, side: &[Side], half: Side) -> Self {
        let mut number = vec![u32::MAX; self.len()];
        let kept: Vec<usize> = (0..self.len()).filter(|&i| side[i] == half).collect();
        for (new, &old) in kept.iter().enumerate() {
            number[old] = new as u32;
        }
        let mut starts = Vec::with_capacity(kept.len() + 1);
        let mut neighbors = vec![];
        starts.push(0);
        for &old in &kept {
            let inside = self.around(old).iter().map(|&j| number[j as usize]);
            neighbors.extend(inside.filter(|&j| j != u32::MAX));
            starts.push(neighbors.len() as u32);
        }
        Self {
            names: kept.iter().map(|&i| self.names[i]).collect(),
            places: kept.iter().map(|&i| self.places[i]).collect(),
            starts,
            neighbors,
        }
    }

    /// The side of each node, or the separator; `None` if no cut pays.
    fn cut(&self) -> Option<Vec<Side>> {
        let n = self.len();
        let direction = self.main_direction();
        let key: Vec<f32> =
            self.places.iter().map(|p| (0..AXES).map(|a| p[a] * direction[a]).sum()).collect();
        let mut order: Vec<u32> = (0..n as u32).collect();
        let reach = (WINDOW * n as f64) as usize;
        let window = (n / 2 - reach).max(1)..(n / 2 + reach).min(n - 1);
        let by_key =
            |a: &u32, b: &u32| key[*a as usize].total_cmp(&key[*b as usize]).then(a.cmp(b));
        // Only nodes near the median need to be sorted.
        order.select_nth_unstable_by(window.start, by_key);
        order[window.start..].select_nth_unstable_by(window.len(), by_key);
        order[window.clone()].sort_unstable_by(by_key);
        let split = self.fewest_crossings(&order, window);
        let mut side = vec![Side::High; n];
        for &node in &order[..split] {
            side[node as usize] = Side::Low;
        }
        let cover = self.cover(&side);
        for &node in &cover {
            side[node as usize] = Side::Cut;
        }
        let worth = (cover.len() as f64) < MAX_SEPARATOR * n as f64
            && side.contains(&Side::Low)
            && side.contains(&Side::High);
        worth.then_some(side)
    }

    /// The direction of largest variance of the coordinates, by power iteration.
    fn main_direction(&self) -> [f32; AXES] {
        let n = self.len() as f64;
        let mut mean = [0.0; AXES];
        for place in &self.places {
            for a in 0..AXES {
                mean[a] += f64::from(place[a]) / n;
            }
        }
        let mut covariance = [[0.0; AXES]; AXES];
        for place in &self.places {
            let d: [f64; AXES] = std::array::from_fn(|a| f64::from(place[a]) - mean[a]);
            for a in 0..AXES {
                for b in 0..AXES {
                    covariance[a][b] += d[a] * d[b];
                }
            }
        }
        let mut direction: [f64; AXES] = std::array::from_fn(|a| 1.0 + 0.1 * a as f64);
        for _ in 0..60 {
            let next: [f64; AXES] =
                std::array::from_fn(|a| (0..AXES).map(|b| covariance[a][b] * direction[b]).sum());
            let length = next.iter().map(|x| x * x).sum::<f64>().sqrt();
            if length <= f64::MIN_POSITIVE {
                break;
            }
            direction = next.map(|x| x / length);
        }
        direction.map(|x| x as f32)
    }

    /// The number of ordered nodes on the low side of the cut that crosses the fewest edges, within
    /// the window.
    fn fewest_crossings(&self, order: &[u32], window: Range<usize>) -> usize {
        let mut rank = vec![0u32; order.len()];
        for (k, &node) in order.iter().enumerate().skip(window.start) {
            rank[node as usize] = k as u32;
        }
        // Relative to the number of crossings at the start of the window.
        let (mut crossing, mut best, mut split) = (0, 0, window.start);
        for k in window {
            let around = self.around(order[k] as usize);
            let later = around.iter().filter(|&&j| rank[j as usize] as usize > k).count();
            crossing += later as i64 - (around.len() - later) as i64;
            if crossing < best {
                (best, split) = (crossing, k + 1);
            }
        }
        split
    }

    /// The neighbours of a low node on the high side.
    fn across<'b>(&'b self, side: &'b [Side], node: usize) -> impl Iterator<Item = u32> + 'b {
        self.around(node).iter().copied().filter(move |&j| side[j as usize] == Side::High)
    }

    /// A minimum vertex cover of the edges between the sides, by König's theorem from a maximum
    /// matching.
    fn cover(&self, side: &[Side]) -> Vec<u32> {
        let n = self.len();
        let low = |i: &usize| side[*i] == Side::Low && self.across(side, *i).next().is_some();
        let low: Vec<usize> = (0..n).filter(low).collect();
        let partner = self.largest_matching(side, &low);
        // The cover consists of high nodes reached from unmatched low nodes by alternating paths,
        // and of low nodes not reached.
        let mut reached = vec![false; n];
        let mut stack: Vec<usize> =
            low.iter().copied().filter(|&i| partner[i] == u32::MAX).collect();
        for &node in &stack {
            reached[node] = true;
        }
        let mut cover = vec![];
        while let Some(node) = stack.pop() {
            for other in self.across(side, node) {
                if !reached[other as usize] {
                    reached[other as usize] = true;
                    cover.push(other);
                    let next = partner[other as usize] as usize;
                    if next < n && !reached[next] {
                        reached[next] = true;
                        stack.push(next);
                    }
                }
            }
        }
        cover.extend(low.iter().filter(|&&i| !reached[i]).map(|&i| i as u32));
        cover
    }

    /// The partner of each node in a maximum matching between the sides; `u32::MAX` for none.
    fn largest_matching(&self, side: &[Side], low: &[usize]) -> Vec<u32> {
        let n = self.len();
        let mut partner = vec![u32::MAX; n];
        for &node in low {
            let free = self.across(side, node).find(|&j| partner[j as usize] == u32::MAX);
            if let Some(free) = free {
                partner[free as usize] = node as u32;
                partner[node] = free;
            }
        }
        // Augments along alternating paths, found breadth first; `seen` is the root of the last
        // search to visit a node.
        let mut seen = vec![u32::MAX; n];
        let mut before = vec![u32::MAX; n];
        let mut queue = vec![];
        for &root in low {
            if partner[root] != u32::MAX {
                continue;
            }
            queue.clear();
            queue.push(root);
            let mut head = 0;
            'search: while head < queue.len() {
                let node = queue[head];
                head += 1;
                for other in self.across(side, node) {
                    if seen[other as usize] == root as u32 {
                        continue;
                    }
                    seen[other as usize] = root as u32;
                    before[other as usize] = node as u32;
                    match partner[other as usize] {
                        u32::MAX => {
                            augment(&mut partner, &before, other);
                            break 'search;
                        }
                        next => queue.push(next as usize),
                    }
                }
            }
        }
        partner
    }
}

/// Swaps matched and unmatched edges along the alternating path that ends at `end`.
fn augment(partner: &mut [u32], before: &[u32], mut end: u32) {
    while end != u32::MAX {
        let start = before[end as usize];
        let next = partner[start as usize];
        partner[start as usize] = end;
        partner[end as usize] = start;
        end = next;
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Side {
    Low,
    High,
    Cut,
}

/// The first node with the largest distance.
fn farthest(distance: &[u32]) -> usize {
    let mut best = 0;
    for (node, &d) in distance.iter().enumerate() {
        if d > distance[best] {
            best = node;
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::matrix::SparseMatrix;

    fn graph(n: usize, edges: impl Iterator<Item = (usize, usize)>) -> SparseMatrix {
        let mut t = sprs::TriMatI::<f64, u32>::new((n, n));
        for i in 0..n {
            t.add_triplet(i, i, 1.0);
        }
        for (i, j) in edges {
            t.add_triplet(i, j, -1.0);
            t.add_triplet(j, i, -1.0);
        }
        t.to_csr()
    }

    fn grid(nx: usize, ny: usize, from: usize) -> impl Iterator<Item = (usize, usize)> {
        (0..nx * ny).flat_map(move |i| {
            let right = (i % nx + 1 < nx).then_some((from + i, from + i + 1));
            let up = (i + nx < nx * ny).then_some((from + i, from + i + nx));
            right.into_iter().chain(up)
        })
    }

    /// Every node occurs once, and without the separators no piece is larger than a leaf.
    #[test]
    fn separators_separate() {
        let n = 70 * 60 + 40 * 50;
        let matrix = graph(n, grid(70, 60, 0).chain(grid(40, 50, 70 * 60)));
        let rows = Rows::new(&matrix);
        let found = dissect(rows, &AtomicBool::new(false)).unwrap();
        let mut all: Vec<u32> = found.leaves.iter().chain(&found.separators).copied().collect();
        all.sort_unstable();
        assert!(all.iter().copied().eq(0..n as u32));
        // The first cuts of a grid of 4200 nodes are about 60 long; all separators together must be
        // far fewer than the nodes.
        assert!(found.separators.len() < n / 5, "{}", found.separators.len());
        let mut left = vec![false; n];
        for &node in &found.leaves {
            left[node as usize] = true;
        }
        for seed in 0..n {
            let (mut size, mut stack) = (0, vec![]);
            if std::mem::take(&mut left[seed]) {
                stack.push(seed);
            }
            while let Some(node) = stack.pop() {
                size += 1;
                for &j in rows.row(node).0 {
                    if std::mem::take(&mut left[j as usize]) {
                        stack.push(j as usize);
                    }
                }
            }
            assert!(size <= LEAF, "{size}");
        }
    }

    /// The cover of a grid cut along a column is that column, not both sides of the cut.
    #[test]
    fn covers_are_smallest() {
        let (nx, ny) = (12, 9);
        let matrix = graph(nx * ny, grid(nx, ny, 0));
        let rows = Rows::new(&matrix);
        let part = Part {
            names: (0..(nx * ny) as u32).collect(),
            starts: rows.starts.to_vec(),
            neighbors: rows.columns.to_vec(),
            places: vec![],
        };
        let side: Vec<Side> =
            (0..nx * ny).map(|i| if i % nx < 6 { Side::Low } else { Side::High }).collect();
        assert_eq!(part.cover(&side).len(), ny);
    }

    /// A complete graph has no cut.
    #[test]
    fn dense_graphs_stay_whole() {
        let n = LEAF + 50;
        let matrix = graph(n, (0..n).flat_map(|i| (0..i).map(move |j| (i, j))));
        let found = dissect(Rows::new(&matrix), &AtomicBool::new(false)).unwrap();
        assert_eq!((found.leaves.len(), found.separators.len()), (n, 0));
    }
}
