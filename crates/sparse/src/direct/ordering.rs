//! Fill-reducing orderings and the elimination tree.

use std::sync::atomic::{AtomicBool, Ordering::Relaxed};

use crate::direct::backend::{self, TooLarge};
use crate::direct::dissection;
use crate::matrix::Rows;

/// The elimination order of a factorisation.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum Ordering {
    /// Approximate minimum degree.
    #[default]
    MinimumDegree,
    /// Nested dissection, with minimum degree inside its smallest pieces. On a sphere of 160
    /// thousand random vertices 10.4 million entries instead of 13.9, and half of the operations;
    /// on meshes with regular connectivity more entries than minimum degree (2.1 million instead of
    /// 1.2 on a scan of 43 thousand vertices).
    NestedDissection,
    /// Minimum degree; if its fill exceeds that of typical surface meshes, nested dissection too,
    /// and the order of the sparser factor. The two orders are found in parallel.
    LeastFill,
    /// The order of the matrix.
    Natural,
    /// A permutation: row `order[k]` is eliminated k-th. It is composed with the postorder of its
    /// elimination tree, which preserves the fill and makes the columns of a supernode adjacent
    /// (1.7 times faster).
    Custom(Vec<u32>),
}

/// Expected nonzeros in the factor of a surface mesh, n (5.5 log₂ n − 35) for n rows: fitted to
/// minimum degree on regular triangle grids (within a tenth from a thousand to 640 thousand rows).
/// Nested dissection attains it on all meshes measured.
pub(crate) fn usual_fill(rows: usize) -> f64 {
    let n = rows as f64;
    n * (5.5 * libm::log2(n.max(2.0)) - 35.0).max(4.0)
}

/// The inverse of a permutation, or the first entry that is out of range or repeated.
pub(crate) fn invert(order: &[u32]) -> Result<Vec<u32>, u32> {
    let mut inverse = vec![u32::MAX; order.len()];
    for (k, &row) in order.iter().enumerate() {
        match inverse.get_mut(row as usize) {
            Some(place) if *place == u32::MAX => *place = k as u32,
            _ => return Err(row),
        }
    }
    Ok(inverse)
}

/// Rows up to which minimum degree often has the usual fill; with more, both orders are found at
/// the same time.
const SMALL: usize = 20_000;

/// The order of [`Ordering::LeastFill`].
pub(crate) fn least_fill(rows: Rows<'_>) -> Result<Postordered, TooLarge> {
    let n = rows.count();
    let counted = |order: Vec<u32>| {
        // An order of ours is a permutation.
        let inverse = invert(&order).map_err(|_| TooLarge)?;
        let found = Postordered::new(rows, &order, &inverse);
        Ok((found.fill(rows), found))
    };
    // True once the first order is good enough, so that the second is not needed.
    let spared = AtomicBool::new(false);
    let least_degree = || {
        let first = counted(backend::minimum_degree(rows)?)?;
        spared.store((first.0 as f64) < usual_fill(n), Relaxed);
        Ok(first)
    };
    let dissected = || {
        let order = dissection::dissected(rows, &spared)?;
        if spared.load(Relaxed) { Ok(None) } else { counted(order).map(Some) }
    };
    let (first, second) = if n > SMALL && rayon::current_num_threads() > 1 {
        rayon::join(least_degree, dissected)
    } else {
        (least_degree(), dissected())
    };
    let first = first?;
    if spared.load(Relaxed) {
        return Ok(first.1);
    }
    Ok(match second? {
        Some(second) if second.0 < first.0 => second.1,
        _ => first.1,
    })
}

/// An elimination order in which every subtree of its elimination tree is contiguous.
#[derive(Debug)]
pub(crate) struct Postordered {
    /// Row `order[k]` is eliminated k-th.
    pub(crate) order: Vec<u32>,
    pub(crate) inverse: Vec<u32>,
    /// The parents of places in the order, `u32::MAX` at roots.
    parents: Vec<u32>,
}

impl Postordered {
    /// `order` composed with the postorder of its elimination tree.
    pub(crate) fn new(rows: Rows<'_>, order: &[u32], inverse: &[u32]) -> Self {
        let tree = elimination_tree(rows, order, inverse);
        let visited = postorder(&tree);
        let mut place = vec![u32::MAX; tree.len()];
        for (k, &node) in visited.iter().enumerate() {
            place[node as usize] = k as u32;
        }
        let place_of = |node: u32| place.get(node as usize).copied().unwrap_or(u32::MAX);
        Self {
            order: visited.iter().map(|&k| order[k as usize]).collect(),
            inverse: inverse.iter().map(|&k| place[k as usize]).collect(),
            parents: visited.iter().map(|&k| place_of(tree[k as usize])).collect(),
        }
    }

    /// The number of entries of the factor on and below the diagonal, almost in linear time: a row
    /// has entries in the part of the tree between its leaves and itself. Source:
    /// [gilbert1994].
    ///
    /// [gilbert1994]: https://doi.org/10.1137/S0895479892236921
    pub(crate) fn fill(&self, rows: Rows<'_>) -> usize {
        const NONE: u32 = u32::MAX;
        let n = self.order.len();
        // The first place of each subtree, and the change of the count from the children.
        let mut first: Vec<u32> = (0..n as u32).collect();
        let mut count = vec![1i64; n];
        for k in 0..n {
            let parent = self.parents[k];
            if parent != NONE {
                count[parent as usize] = 0;
                first[parent as usize] = first[parent as usize].min(first[k]);
            }
        }
        let (mut latest, mut leaf) = (vec![NONE; n], vec![NONE; n]);
        let mut ancestor: Vec<u32> = (0..n as u32).collect();
        for k in 0..n {
            let parent = self.parents[k];
            if parent != NONE {
                count[parent as usize] -= 1;
            }
            for &column in rows.row(self.order[k] as usize).0 {
                let i = self.inverse[column as usize] as usize;
                // In a subtree that has a leaf of row i already, k is no leaf.
                if i <= k || (latest[i] != NONE && first[k] <= latest[i]) {
                    continue;
                }
                latest[i] = first[k];
                count[k] += 1;
                let before = std::mem::replace(&mut leaf[i], k as u32);
                if before != NONE {
                    count[root(&mut ancestor, before) as usize] -= 1;
                }
            }
            if parent != NONE {
                ancestor[k] = parent;
            }
        }
        let mut fill = 0;
        for k in 0..n {
            fill += count[k];
            if self.parents[k] != NONE {
                count[self.parents[k] as usize] += count[k];
            }
        }
        fill as usize
    }
}

/// The root of a set in a forest of sets, whose path is shortened.
fn root(ancestor: &mut [u32], from: u32) -> u32 {
    let mut root = from;
    while ancestor[root as usize] != root {
        root = ancestor[root as usize];
    }
    let mut node = from;
    while node != root {
        node = std::mem::replace(&mut ancestor[node as usize], root);
    }
    root
}

/// Parents in the elimination tree of the permuted matrix, `u32::MAX` at roots. Liu's algorithm
/// with path compression, almost linear in the number of entries. Source: [liu1990].
///
/// [liu1990]: https://doi.org/10.1137/0611010
fn elimination_tree(rows: Rows<'_>, order: &[u32], inverse: &[u32]) -> Vec<u32> {
    let n = order.len();
    let mut parent = vec![u32::MAX; n];
    let mut ancestor = vec![u32::MAX; n];
    for k in 0..n {
        for &column in rows.row(order[k] as usize).0 {
            let mut node = inverse[column as usize];
            while (node as usize) < k {
                let next = std::mem::replace(&mut ancestor[node as usize], k as u32);
                if next == u32::MAX {
                    parent[node as usize] = k as u32;
                    break;
                }
                node = next;
            }
        }
    }
    parent
}

/// The nodes of a forest, children before parents and every subtree contiguous.
fn postorder(parent: &[u32]) -> Vec<u32> {
    let n = parent.len();
    let mut first_child = vec![u32::MAX; n];
    let mut sibling = vec![u32::MAX; n];
    for node in (0..n).rev() {
        if let Some(first) = first_child.get_mut(parent[node] as usize) {
            sibling[node] = std::mem::replace(first, node as u32);
        }
    }
    let mut order = Vec::with_capacity(n);
    let mut stack = vec![];
    for root in (0..n).filter(|&node| parent[node] == u32::MAX) {
        stack.push(root as u32);
        while let Some(&node) = stack.last() {
            let child = first_child[node as usize];
            if child == u32::MAX {
                order.push(node);
                stack.pop();
            } else {
                first_child[node as usize] = sibling[child as usize];
                stack.push(child);
            }
        }
    }
    order
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use rand::{RngExt as _, SeedableRng as _};
    use rand_chacha::ChaCha8Rng;

    use super::*;
    use crate::matrix::SparseMatrix;

    /// Path 0 – 1 – 2 – 3 – 4, eliminated from both ends: 0, 4, 1, 3 have chains 0 → 1 → 2 and 4 →
    /// 3 → 2.
    #[test]
    fn postorder_puts_subtrees_together() {
        let mut t = sprs::TriMatI::<f64, u32>::new((5, 5));
        for i in 0..5 {
            t.add_triplet(i, i, 2.0);
            if i > 0 {
                t.add_triplet(i, i - 1, -1.0);
                t.add_triplet(i - 1, i, -1.0);
            }
        }
        let matrix: SparseMatrix = t.to_csr();
        let order = [0, 4, 1, 3, 2];
        let inverse = invert(&order).unwrap();
        let tree = elimination_tree(Rows::new(&matrix), &order, &inverse);
        assert_eq!(tree, [2, 3, 4, 4, u32::MAX]);
        let found = Postordered::new(Rows::new(&matrix), &order, &inverse);
        assert_eq!(found.order, [0, 1, 4, 3, 2]);
        assert_eq!(found.inverse, invert(&found.order).unwrap());
        assert_eq!(found.parents, [1, 4, 3, 4, u32::MAX]);
        // Each but the last has one entry below the diagonal.
        assert_eq!(found.fill(Rows::new(&matrix)), 9);
    }

    /// The fill of random graphs, some of them in several parts, is that of an elimination with
    /// sets.
    #[test]
    fn fill_is_counted() {
        let mut rng = ChaCha8Rng::seed_from_u64(3);
        for edges in [0, 20, 50, 90, 200] {
            let n = 60;
            let mut t = sprs::TriMatI::<f64, u32>::new((n, n));
            (0..n).for_each(|i| t.add_triplet(i, i, 1.0));
            for _ in 0..edges {
                let [i, j] = [0, 0].map(|_: i32| rng.random_range(0..n));
                t.add_triplet(i, j, 1.0);
                t.add_triplet(j, i, 1.0);
            }
            let matrix: SparseMatrix = t.to_csr();
            let rows = Rows::new(&matrix);
            let order: Vec<u32> = (0..n as u32).map(|k| k * 7 % n as u32).collect();
            let found = Postordered::new(rows, &order, &invert(&order).unwrap());
            let place = |j: &u32| found.inverse[*j as usize] as usize;
            let mut below: Vec<BTreeSet<usize>> = (0..n)
                .map(|k| rows.row(found.order[k] as usize).0.iter().map(place).collect())
                .collect();
            let mut entries = 0;
            for k in 0..n {
                let column: BTreeSet<usize> = below[k].range(k..).copied().collect();
                entries += column.len();
                for &i in column.range(k + 1..) {
                    below[i].extend(column.range(i..));
                }
            }
            assert_eq!(found.fill(rows), entries, "{edges} edges");
        }
    }

    #[test]
    fn only_permutations_invert() {
        assert_eq!(invert(&[2, 0, 1]), Ok(vec![1, 2, 0]));
        assert_eq!(invert(&[0, 0, 1]), Err(0));
        assert_eq!(invert(&[0, 3, 1]), Err(3));
    }
}
