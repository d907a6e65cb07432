//! Polygons cut ear by ear, and the search for a point in an ear.

use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::ops::Range;

use glam::DVec3;

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

/// The most points of a leaf.
const LEAF: usize = 8;

/// The rounding of a distance in the unit cube, with room.
const MARGIN: f64 = 1e-12;

/// A k-d tree of points in the unit cube around the origin.
pub(super) struct Tree<'a> {
    points: &'a [DVec3],
    order: Vec<usize>,
    nodes: Vec<Node>,
    /// The leaf of each point.
    leaves: Vec<usize>,
}

struct Node {
    low: DVec3,
    high: DVec3,
    /// The points that are left below.
    left: usize,
    /// The points of a leaf, in `order`.
    range: Range<usize>,
    children: Option<[usize; 2]>,
    parent: Option<usize>,
}

/// A triangle seen along a normal.
pub(super) struct Triangle {
    corners: [DVec3; 3],
    normal: DVec3,
}

impl Triangle {
    pub(super) fn new(corners: [DVec3; 3], normal: DVec3) -> Self {
        Self { corners, normal }
    }

    fn sides(&self) -> [[DVec3; 2]; 3] {
        let [p, q, r] = self.corners;
        [[p, q], [q, r], [r, p]]
    }

    /// Returns true for a point in the triangle or on its border, but not for its corners.
    fn holds(&self, x: DVec3) -> bool {
        let is_left = |[a, b]: [DVec3; 2]| (b - a).cross(x - a).dot(self.normal) >= 0.0;
        !self.corners.contains(&x) && self.sides().into_iter().all(is_left)
    }

    /// Returns false only if no point of the box is in the triangle.
    fn may_meet(&self, low: DVec3, high: DVec3) -> bool {
        self.sides().into_iter().all(|[a, b]| {
            let inward = self.normal.cross(b - a);
            let farthest = (inward * (low - a)).max(inward * (high - a)).element_sum();
            farthest >= -MARGIN * inward.length()
        })
    }
}

impl<'a> Tree<'a> {
    pub(super) fn new(points: &'a [DVec3]) -> Self {
        let order = (0..points.len()).collect();
        let mut tree = Self { points, order, nodes: vec![], leaves: vec![0; points.len()] };
        tree.build(0..points.len(), None);
        tree
    }

    /// Adds the node of a range of `order` and those below, and returns its number.
    fn build(&mut self, range: Range<usize>, parent: Option<usize>) -> usize {
        let points = self.points;
        let part = &mut self.order[range.clone()];
        let low = part.iter().fold(DVec3::INFINITY, |low, &k| low.min(points[k]));
        let high = part.iter().fold(DVec3::NEG_INFINITY, |high, &k| high.max(points[k]));
        let number = self.nodes.len();
        let left = range.len();
        self.nodes.push(Node { low, high, left, range: range.clone(), children: None, parent });
        if left <= LEAF {
            part.iter().for_each(|&k| self.leaves[k] = number);
            return number;
        }
        let axis = (high - low).max_position();
        part.select_nth_unstable_by(left / 2, |&a, &b| points[a][axis].total_cmp(&points[b][axis]));
        let middle = range.start + left / 2;
        let children = [range.start..middle, middle..range.end];
        self.nodes[number].children = Some(children.map(|part| self.build(part, Some(number))));
        number
    }

    /// Removes a point that is left.
    pub(super) fn remove(&mut self, point: usize) {
        let mut node = Some(self.leaves[point]);
        let range = self.nodes[self.leaves[point]].range.clone();
        // The points of a leaf that are left stand first.
        let left = self.nodes[self.leaves[point]].left;
        let part = &mut self.order[range];
        if let Some(at) = part[..left].iter().position(|&k| k == point) {
            part.swap(at, left - 1);
        }
        while let Some(number) = node {
            self.nodes[number].left -= 1;
            node = self.nodes[number].parent;
        }
    }

    /// A point that is left in the triangle.
    pub(super) fn one_in(&self, triangle: &Triangle) -> Option<usize> {
        let mut open = vec![0];
        while let Some(number) = open.pop() {
            let node = &self.nodes[number];
            if node.left == 0 || !triangle.may_meet(node.low, node.high) {
                continue;
            }
            match node.children {
                Some(children) => open.extend(children),
                None => {
                    let part = &self.order[node.range.clone()][..node.left];
                    let found = part.iter().find(|&&k| triangle.holds(self.points[k]));
                    if found.is_some() {
                        return found.copied();
                    }
                }
            }
        }
        None
    }
}
