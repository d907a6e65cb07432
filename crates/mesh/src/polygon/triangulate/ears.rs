//! Polygons cut ear by ear.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use glam::DVec3;

use super::tree::{Tree, Triangle};

/// The sine of a turn that rounding may produce in a straight line.
const STRAIGHT: f64 = 1e-10;

/// The triangles of one polygon, by the numbers of its corners.
pub(super) struct Split {
    pub(super) triangles: Vec<[usize; 3]>,
    /// False if the polygon ran out of ears: it crosses itself or has no area.
    pub(super) simple: bool,
}

pub(super) fn fan(corners: &[usize]) -> Vec<[usize; 3]> {
    corners[1..].windows(2).map(|pair| [corners[0], pair[0], pair[1]]).collect()
}

/// The turn of the path p, q, r at q: twice the signed area seen along the normal,
/// or 0 if it is no more than rounding.
pub(super) fn turn(p: DVec3, q: DVec3, r: DVec3, normal: DVec3) -> f64 {
    let (a, b) = (q - p, r - q);
    let turn = a.cross(b).dot(normal);
    if turn.abs() > STRAIGHT * a.length() * b.length() * normal.length() { turn } else { 0.0 }
}

/// The neighbour of a corner that is cut.
const CUT: usize = usize::MAX;

/// A polygon of which some corners are cut.
struct Polygon<'a> {
    points: &'a [DVec3],
    normal: DVec3,
    /// The corners before and after each.
    neighbours: Vec<[usize; 2]>,
    left: Tree<'a>,
    /// The ears by their shape, the first of equal ones on top, with the judgement they are of.
    ears: BinaryHeap<(u64, Reverse<usize>, u32)>,
    /// The judgements of each corner; only the last is valid.
    judged: Vec<u32>,
    /// The corners that are no ears because this one is in their triangles.
    blocked: Vec<Vec<usize>>,
}

/// Cuts ears until three corners are left, or none is an ear.
pub(super) fn cut(points: &[DVec3], normal: DVec3) -> Split {
    let n = points.len();
    let mut polygon = Polygon {
        points,
        normal,
        neighbours: (0..n).map(|k| [(k + n - 1) % n, (k + 1) % n]).collect(),
        left: Tree::new(points),
        ears: BinaryHeap::with_capacity(n),
        judged: vec![0; n],
        blocked: vec![vec![]; n],
    };
    (0..n).for_each(|k| polygon.judge(k));
    let mut triangles = Vec::with_capacity(n - 2);
    while triangles.len() < n - 3
        && let Some((_, Reverse(k), judgement)) = polygon.ears.pop()
    {
        if polygon.judged[k] == judgement {
            let [before, after] = polygon.neighbours[k];
            triangles.push([before, k, after]);
            polygon.cut(k);
        }
    }
    let rest: Vec<usize> = (0..n).filter(|&k| polygon.neighbours[k][0] != CUT).collect();
    let simple = match rest[..] {
        [p, q, r] => turn(points[p], points[q], points[r], normal) >= 0.0,
        _ => false,
    };
    triangles.extend(fan(&rest));
    Split { triangles, simple }
}

impl Polygon<'_> {
    /// Cuts the ear at a corner. Only its neighbours' triangles change, but the corner may have
    /// been inside others.
    fn cut(&mut self, k: usize) {
        let [before, after] = std::mem::replace(&mut self.neighbours[k], [CUT; 2]);
        self.neighbours[before][1] = after;
        self.neighbours[after][0] = before;
        self.judged[k] += 1;
        self.left.remove(k);
        self.judge(before);
        self.judge(after);
        for other in std::mem::take(&mut self.blocked[k]) {
            if self.neighbours[other][0] != CUT && other != before && other != after {
                self.judge(other);
            }
        }
    }

    /// Lists the ear at a corner by its shape: area over the sum of squared sides.
    fn judge(&mut self, k: usize) {
        self.judged[k] += 1;
        let [before, after] = self.neighbours[k];
        let corners = [before, k, after].map(|k| self.points[k]);
        let [p, q, r] = corners;
        let area = turn(p, q, r, self.normal);
        if area <= 0.0 {
            return;
        }
        if let Some(inside) = self.left.one_in(&Triangle::new(corners, self.normal)) {
            return self.blocked[inside].push(k);
        }
        let squared = p.distance_squared(q) + q.distance_squared(r) + r.distance_squared(p);
        let quality = area / squared;
        if quality > 0.0 {
            // Positive numbers are ordered as their bits are.
            self.ears.push((quality.to_bits(), Reverse(k), self.judged[k]));
        }
    }
}
