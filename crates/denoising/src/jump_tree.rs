//! Stiff systems of jumps, as around vertices of thousands of faces.

use fairing_sparse::parallel::{sum, update};
use fairing_sparse::{CgOptions, product_by_rows};
use glam::DVec3;

use super::error::DenoiseError;
use super::jumps::JumpSystem;

/// A spanning tree of the hinges of each component with the greatest penalties, factorised as a
/// preconditioner.
///
/// The tree has the areas and the penalties of its hinges: a matrix whose factors have one entry
/// for each face. The faces around a vertex are a path of it but for one hinge, so that conjugate
/// gradients take a few iterations, however many faces there are; with the diagonal alone, √n
/// times as many for n faces.
pub(crate) struct JumpTree {
    /// All faces, parents before children.
    order: Vec<u32>,
    /// The parent of each face; the face itself at a root.
    parents: Vec<u32>,
    /// The inverse of the pivot of each face.
    inverse: Vec<f64>,
    /// The penalty towards the parent times `inverse`.
    upwards: Vec<f64>,
}

impl JumpTree {
    pub(crate) fn new(system: &JumpSystem) -> Self {
        let count = system.areas.len();
        let mut hinges: Vec<(f64, [u32; 2])> = vec![];
        for f in 0..count as u32 {
            let sides = system.sides(f as usize);
            hinges.extend(sides.filter(|(g, _)| f < *g).map(|(g, width)| (width, [f, g])));
        }
        // Stable: equal penalties in the order of faces.
        hinges.sort_by(|a, b| b.0.total_cmp(&a.0));
        let mut sets: Vec<u32> = (0..count as u32).collect();
        let mut neighbors = vec![[(u32::MAX, 0.0); 3]; count];
        for (width, ends) in hinges {
            let [a, b] = ends.map(|f| root(&mut sets, f));
            if a == b {
                continue;
            }
            sets[a as usize] = b;
            for [f, g] in [ends, [ends[1], ends[0]]] {
                let free = neighbors[f as usize].iter_mut().find(|(h, _)| *h == u32::MAX);
                // A face has three sides.
                if let Some(free) = free {
                    *free = (g, width);
                }
            }
        }
        let (order, parents, widths) = rooted(&neighbors);
        // The areas that remain once the children are eliminated: sums without subtractions.
        let mut grounded = system.areas.clone();
        let (mut inverse, mut upwards) = (vec![0.0; count], vec![0.0; count]);
        for f in order.iter().rev().map(|&f| f as usize) {
            inverse[f] = 1.0 / (grounded[f] + widths[f]);
            upwards[f] = widths[f] * inverse[f];
            if parents[f] as usize != f {
                grounded[parents[f] as usize] += upwards[f] * grounded[f];
            }
        }
        Self { order, parents, inverse, upwards }
    }

    /// Overwrites `r` with the solution for the matrix of the tree.
    fn precondition(&self, r: &mut [[f64; 3]]) {
        for f in self.order.iter().rev().map(|&f| f as usize) {
            let (up, parent) = (self.upwards[f], self.parents[f] as usize);
            if parent != f {
                r[parent] = (DVec3::from(r[parent]) + up * DVec3::from(r[f])).to_array();
            }
        }
        for f in self.order.iter().map(|&f| f as usize) {
            let (up, parent) = (self.upwards[f], self.parents[f] as usize);
            let own = self.inverse[f] * DVec3::from(r[f]);
            let above = if parent == f { DVec3::ZERO } else { up * DVec3::from(r[parent]) };
            r[f] = (own + above).to_array();
        }
    }

    /// Solves the system from the guess `x`; returns the iterations taken too.
    ///
    /// # Errors
    ///
    /// [`DenoiseError::NotSolved`], in outer step `step`.
    pub(crate) fn solve(
        &self,
        system: &JumpSystem,
        b: &[[f64; 3]],
        mut x: Vec<[f64; 3]>,
        accuracy: &CgOptions,
        step: usize,
    ) -> Result<(Vec<[f64; 3]>, usize), DenoiseError> {
        let mut r = vec![[0.0; 3]; b.len()];
        update(&mut r, |f, _| (difference(b[f], system.row(&x, f), 1.0), ()));
        let size = norm(b);
        let (mut p, mut q) = (vec![[0.0; 3]; b.len()], r.clone());
        let mut before = f64::INFINITY;
        let mut iterations = 0;
        loop {
            let residual = norm(&r);
            if residual <= accuracy.tolerance * size {
                return Ok((x, iterations));
            }
            if iterations >= accuracy.max_iterations || residual.is_nan() {
                let residual = residual / size;
                return Err(DenoiseError::NotSolved { step, iterations, residual });
            }
            fairing_watch::check();
            q.copy_from_slice(&r);
            self.precondition(&mut q);
            let now = inner(&r, &q);
            let keep = if iterations == 0 { 0.0 } else { now / before };
            before = now;
            update(&mut p, |f, p| (difference(q[f], p, -keep), ()));
            let along: f64 = product_by_rows(&p, &mut q, |f| system.row(&p, f)).iter().sum();
            let length = now / along;
            update(&mut x, |f, x| (difference(x, p[f], -length), ()));
            update(&mut r, |f, r| (difference(r, q[f], length), ()));
            iterations += 1;
        }
    }
}

/// The representative of the set of `f`; halves the paths on its way.
fn root(sets: &mut [u32], mut f: u32) -> u32 {
    while sets[f as usize] != f {
        sets[f as usize] = sets[sets[f as usize] as usize];
        f = sets[f as usize];
    }
    f
}

/// The faces of a forest, parents before children, with the parent of each and the penalty towards
/// it.
fn rooted(neighbors: &[[(u32, f64); 3]]) -> (Vec<u32>, Vec<u32>, Vec<f64>) {
    let mut parents = vec![u32::MAX; neighbors.len()];
    let mut widths = vec![0.0; neighbors.len()];
    let mut order: Vec<u32> = vec![];
    for start in 0..neighbors.len() {
        if parents[start] != u32::MAX {
            continue;
        }
        parents[start] = start as u32;
        let mut next = order.len();
        order.push(start as u32);
        while let Some(&f) = order.get(next) {
            next += 1;
            for &(g, width) in neighbors[f as usize].iter().filter(|(g, _)| *g != u32::MAX) {
                if parents[g as usize] == u32::MAX {
                    (parents[g as usize], widths[g as usize]) = (f, width);
                    order.push(g);
                }
            }
        }
    }
    (order, parents, widths)
}

/// a − t b.
#[inline]
fn difference(a: [f64; 3], b: [f64; 3], t: f64) -> [f64; 3] {
    (DVec3::from(a) - t * DVec3::from(b)).to_array()
}

fn inner(a: &[[f64; 3]], b: &[[f64; 3]]) -> f64 {
    sum(a.len(), |f| DVec3::from(a[f]).dot(b[f].into()))
}

fn norm(a: &[[f64; 3]]) -> f64 {
    inner(a, a).sqrt()
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use fairing_mesh::TriMesh;

    use super::*;

    /// A closed cone of `n` faces around its apex and as many around the centre of its base, or
    /// its upper half, a wavy fan.
    fn cone(n: u32, is_closed: bool) -> TriMesh {
        let rim = (0..n).map(|i| {
            let angle = TAU * f64::from(i) / f64::from(n);
            let (sin, cos) = libm::sincos(angle);
            [cos, sin, 0.1 * libm::sin(7.0 * angle)]
        });
        let positions = [[0.0, 0.0, 1.0], [0.0, 0.0, -0.2]].into_iter().chain(rim).collect();
        let next = |i: u32| (i + 1) % n;
        let upper = (0..n).map(|i| [0, i + 2, next(i) + 2]);
        let lower = (0..n).filter(|_| is_closed).map(|i| [1, next(i) + 2, i + 2]);
        TriMesh::new(positions, upper.chain(lower).collect()).unwrap()
    }

    /// The matrix times the noisy normals.
    fn product(system: &JumpSystem) -> Vec<[f64; 3]> {
        (0..system.areas.len()).map(|f| system.row(&system.noisy, f)).collect()
    }

    /// Solutions are right, and four times the faces take no more iterations than a few: the
    /// conjugate gradients of a diagonal took hundreds, and twice as many.
    #[test]
    fn iterations_around_hubs_do_not_grow() {
        let accuracy = CgOptions { tolerance: 1e-8, max_iterations: 60 };
        for is_closed in [false, true] {
            for n in [8000, 32_000] {
                let system = JumpSystem::new(&cone(n, is_closed), 1.4);
                assert!(system.is_stiff());
                let b = product(&system);
                let guess = vec![[0.0; 3]; b.len()];
                let tree = JumpTree::new(&system);
                let (x, iterations) = tree.solve(&system, &b, guess, &accuracy, 0).unwrap();
                assert!(iterations < 30, "{iterations} iterations, {n} faces, {is_closed}");
                let worst = x
                    .iter()
                    .zip(&system.noisy)
                    .map(|(x, expected)| DVec3::from(*x).distance(DVec3::from(*expected)));
                // The residual is 10⁻⁸ of b, measured without the areas.
                let worst = worst.fold(0.0, f64::max);
                assert!(worst < 1e-6, "{worst}");
            }
        }
    }

    /// The matrix of a tree is solved by one step: a fan that is open has no other hinges.
    #[test]
    fn a_tree_is_solved_exactly() {
        let mesh = cone(3000, false);
        let faces = mesh.faces()[1..].to_vec();
        let mesh = TriMesh::new(mesh.positions().to_vec(), faces).unwrap();
        let system = JumpSystem::new(&mesh, 1.4);
        let mut r = product(&system);
        JumpTree::new(&system).precondition(&mut r);
        for (x, expected) in r.iter().zip(&system.noisy) {
            assert!(DVec3::from(*x).distance(DVec3::from(*expected)) < 1e-8, "{x:?}");
        }
    }
}
