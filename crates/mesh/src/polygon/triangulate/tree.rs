//! Points of which some are removed, and a search for one in a triangle.

use std::ops::Range;

use glam::DVec3;

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
