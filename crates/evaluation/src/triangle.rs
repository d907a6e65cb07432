//! The point of a triangle closest to a given point.

use glam::DVec3;

/// Twice the area over the square of the longest side, squared, below which a
/// triangle is thin. Differences of products of dot products lose that share of
/// their digits: at 1e-3 three of sixteen.
const THIN: f64 = 1e-3;

/// The point of triangle `abc` closest to `p`, by the region of the plane that
/// `p` is over: a corner, a side or the inside. Off by a few roundings of the
/// longest side and of the distance, whatever the shape of the triangle. Source:
/// [ericson2004], section 5.1.5.
///
/// [ericson2004]: https://doi.org/10.1201/b14581
#[inline]
pub(crate) fn closest_point(p: DVec3, [a, b, c]: [DVec3; 3]) -> DVec3 {
    let (ab, ac, ap) = (b - a, c - a, p - a);
    let (d1, d2) = (ab.dot(ap), ac.dot(ap));
    if d1 <= 0.0 && d2 <= 0.0 {
        return a;
    }
    let (square_b, square_c, inner) = (ab.dot(ab), ac.dot(ac), ab.dot(ac));
    let longest = square_b.max(square_c).max(square_b + square_c - 2.0 * inner);
    // Not so for NaN either, which lengths that overflow give.
    let wide = square_b * square_c - inner * inner > THIN * longest * longest;
    if !wide {
        return closest_in_thin(p, [a, b, c]);
    }
    let bp = p - b;
    let (d3, d4) = (ab.dot(bp), ac.dot(bp));
    if d3 >= 0.0 && d4 <= d3 {
        return b;
    }
    let cp = p - c;
    let (d5, d6) = (ab.dot(cp), ac.dot(cp));
    if d6 >= 0.0 && d5 <= d6 {
        return c;
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        return a + ab * (d1 / (d1 - d3));
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        return a + ac * (d2 / (d2 - d6));
    }
    let va = d3 * d6 - d5 * d4;
    let (along, against) = (d4 - d3, d5 - d6);
    if va <= 0.0 && along >= 0.0 && against >= 0.0 {
        return b + (c - b) * (along / (along + against));
    }
    let sum = va + vb + vc;
    a + (ab * (vb / sum) + ac * (vc / sum))
}

/// The closest of the closest points of the sides and the foot of `p`, where it
/// is inside.
///
/// The foot has a coordinate along the longest side and one across it. The
/// latter is taken of the rest that the former leaves, which is small where the
/// foot matters, so that the direction across, which has few digits, cannot
/// move the foot along. A convex combination of the corners in any case, it is
/// a point of the triangle, and its distance never below that of the triangle
/// by more than rounding.
#[cold]
fn closest_in_thin(p: DVec3, corners: [DVec3; 3]) -> DVec3 {
    let square = |k: usize| {
        let d = corners[(k + 2) % 3] - corners[(k + 1) % 3];
        d.dot(d)
    };
    // The apex is opposite the longest side, the origin its nearer end.
    let apex = (1..3).fold(0, |best, k| if square(k) > square(best) { k } else { best });
    let (next, last) = ((apex + 1) % 3, (apex + 2) % 3);
    let (origin, end) = if square(next) > square(last) { (next, last) } else { (last, next) };
    let (a, b, c) = (corners[origin], corners[end], corners[apex]);

    let mut best = (f64::INFINITY, a);
    let mut offer = |q: DVec3| {
        let r = p - q;
        if r.dot(r) < best.0 {
            best = (r.dot(r), q);
        }
    };
    for (u, v) in [(a, b), (b, c), (c, a)] {
        offer(closest_on_side(p, u, v));
    }
    let (ab, ac, ap) = (b - a, c - a, p - a);
    let length = ab.dot(ab);
    if length > 0.0 {
        let (along_c, along_p) = (ac.dot(ab) / length, ap.dot(ab) / length);
        let (across_c, rest) = (ac - along_c * ab, ap - along_p * ab);
        let weight_c = rest.dot(across_c) / across_c.dot(across_c);
        let weight_b = along_p - weight_c * along_c;
        // Not so for NaN, which triangles without height give.
        if weight_b >= 0.0 && weight_c >= 0.0 && weight_b + weight_c <= 1.0 {
            offer(a + (weight_b * ab + weight_c * ac));
        }
    }
    best.1
}

/// The closest point of the side `uv`.
fn closest_on_side(p: DVec3, u: DVec3, v: DVec3) -> DVec3 {
    let d = v - u;
    let square = d.dot(d);
    let t = if square > 0.0 { (p - u).dot(d) / square } else { 0.0 };
    if t <= 0.0 {
        u
    } else if t >= 1.0 {
        v
    } else {
        u + t * d
    }
}

/// The square of the distance between a point and a triangle.
#[inline]
pub(crate) fn squared_distance(p: DVec3, triangle: [DVec3; 3]) -> f64 {
    let d = p - closest_point(p, triangle);
    d.dot(d)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn coordinate() -> impl Strategy<Value = f64> {
        // Few values make degenerate triangles and ties frequent.
        prop_oneof![Just(0.0), Just(1.0), Just(-0.5), -2.0..2.0]
    }

    fn point() -> impl Strategy<Value = DVec3> {
        [coordinate(), coordinate(), coordinate()].prop_map(DVec3::from)
    }

    proptest! {
        /// The distance to a convex set is least where the direction to the
        /// point makes no acute angle with any direction into the set.
        #[test]
        fn no_corner_lies_in_the_direction_of_the_point(p in point(), t in [point(), point(), point()]) {
            let q = closest_point(p, t);
            for corner in t {
                // Products of numbers up to 4, three digits lost to thinness.
                prop_assert!((p - q).dot(corner - q) < 1e-11, "{q:?} for {corner:?}");
            }
        }

        /// The closest point is in the triangle: its parts fill the area.
        #[test]
        fn the_point_is_in_the_triangle(p in point(), t in [point(), point(), point()]) {
            let q = closest_point(p, t);
            let area = |a: DVec3, b: DVec3, c: DVec3| { let n = (b - a).cross(c - a); n.dot(n).sqrt() };
            let [a, b, c] = t;
            let parts = area(q, b, c) + area(a, q, c) + area(a, b, q);
            prop_assert!((parts - area(a, b, c)).abs() < 1e-7, "{q:?}");
        }
    }

    /// A number of 32 digits, the sum of two floats.
    #[derive(Clone, Copy)]
    struct Double(f64, f64);

    impl Double {
        fn new(a: f64, b: f64) -> Self {
            let sum = a + b;
            let part = sum - a;
            Self(sum, (a - (sum - part)) + (b - part))
        }

        fn plus(self, other: Self) -> Self {
            let sum = Self::new(self.0, other.0);
            Self::new(sum.0, sum.1 + (self.1 + other.1))
        }

        fn minus(self, other: Self) -> Self {
            self.plus(Self(-other.0, -other.1))
        }

        fn times(self, other: Self) -> Self {
            let product = self.0 * other.0;
            let rest = self.0.mul_add(other.0, -product);
            Self::new(product, rest + (self.0 * other.1 + self.1 * other.0))
        }

        fn over(self, other: Self) -> Self {
            let first = self.0 / other.0;
            let rest = self.minus(other.times(Self(first, 0.0)));
            let second = rest.0 / other.0;
            let rest = rest.minus(other.times(Self(second, 0.0)));
            Self::new(first, second).plus(Self(rest.0 / other.0, 0.0))
        }
    }

    type Vector = [Double; 3];

    fn minus(a: Vector, b: Vector) -> Vector {
        [0, 1, 2].map(|k| a[k].minus(b[k]))
    }

    fn product(a: Vector, b: Vector) -> Double {
        (0..3).fold(Double(0.0, 0.0), |sum, k| sum.plus(a[k].times(b[k])))
    }

    fn normal(a: Vector, b: Vector) -> Vector {
        [(1, 2), (2, 0), (0, 1)].map(|(i, j)| a[i].times(b[j]).minus(a[j].times(b[i])))
    }

    /// The distance by the plane where the foot is inside, by the sides elsewhere,
    /// in 32 digits: exact to a double for heights down to 1e-12.
    fn precise_distance(p: DVec3, corners: [DVec3; 3]) -> f64 {
        let exact = |x: DVec3| x.to_array().map(|x| Double(x, 0.0));
        let (p, [a, b, c]) = (exact(p), corners.map(exact));
        let n = normal(minus(b, a), minus(c, a));
        let inside = [(a, b), (b, c), (c, a)]
            .iter()
            .all(|&(u, v)| product(normal(minus(v, u), minus(p, u)), n).0 >= 0.0);
        if inside {
            let height = product(minus(p, a), n);
            return height.times(height).over(product(n, n)).0.sqrt();
        }
        let sides = [(a, b), (b, c), (c, a)].map(|(u, v)| {
            let (d, e) = (minus(v, u), minus(p, u));
            let t = product(d, e).over(product(d, d));
            let t = if t.0 < 0.0 { Double(0.0, 0.0) } else { t };
            let t = if t.0 > 1.0 { Double(1.0, 0.0) } else { t };
            let r = [0, 1, 2].map(|k| e[k].minus(t.times(d[k])));
            product(r, r).0.sqrt()
        });
        sides.into_iter().fold(f64::INFINITY, f64::min)
    }

    proptest! {
        /// Thin triangles of side 1, needles and slivers, turned arbitrarily and
        /// moved, their corners in any order; points in them, near and far.
        #[test]
        fn distances_to_thin_triangles_are_exact_to_rounding(
            turn in [-1.0..1.0, -1.0..1.0, -1.0..1.0, -1.0..1.0f64],
            moved in [-1.0..1.0, -1.0..1.0, -1.0..1.0f64],
            exponent in -12.0..0.0f64,
            apex in prop_oneof![0.0..1.0, Just(0.0), Just(1.0)],
            weights in [0.0..1.0, 0.0..1.0f64],
            off in (-16.0..1.0f64, [-1.0..1.0, -1.0..1.0, -1.0..1.0f64]),
            order in 0usize..6,
        ) {
            // A quaternion; of any length but 0, it turns and stretches.
            let [w, x, y, z] = turn;
            let square = w * w + x * x + y * y + z * z;
            prop_assume!(square > 1e-2);
            let axes = [
                [w * w + x * x - y * y - z * z, 2.0 * (x * y + w * z), 2.0 * (x * z - w * y)],
                [2.0 * (x * y - w * z), w * w - x * x + y * y - z * z, 2.0 * (y * z + w * x)],
            ].map(|axis| DVec3::from(axis) * (1.0 / square));
            let moved = DVec3::from(moved);
            let at = |s: f64, t: f64| moved + (s * axes[0] + t * axes[1]);
            let height = libm::exp10(exponent);
            let triangle = [at(0.0, 0.0), at(1.0, 0.0), at(apex, height)];
            let order = [[0, 1, 2], [1, 2, 0], [2, 0, 1], [0, 2, 1], [2, 1, 0], [1, 0, 2]][order];
            let t = order.map(|k| triangle[k]);
            let [s, across] = weights;
            let near = at(s * (1.0 - across) + across * apex, across * height);
            let p = near + libm::exp10(off.0) * DVec3::from(off.1);
            let found = squared_distance(p, t).sqrt();
            let exact = precise_distance(p, t);
            // Coordinates up to 2 and points up to 17 away; wide triangles lose
            // three digits of a position, which matter where the distance is small.
            let allowed = if height < 0.03 { 1e-14 } else { 1e-12 };
            prop_assert!((found - exact).abs() <= allowed, "{found:e}, exactly {exact:e}");
        }
    }

    #[test]
    fn each_region() {
        let t = [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0]].map(DVec3::from);
        for (p, q) in [
            ([0.5, 0.5, 3.0], [0.5, 0.5, 0.0]),
            ([-1.0, -1.0, 1.0], [0.0, 0.0, 0.0]),
            ([3.0, -1.0, 1.0], [2.0, 0.0, 0.0]),
            ([-1.0, 3.0, 1.0], [0.0, 2.0, 0.0]),
            ([1.0, -1.0, 1.0], [1.0, 0.0, 0.0]),
            ([-1.0, 1.0, 1.0], [0.0, 1.0, 0.0]),
            ([2.0, 2.0, 1.0], [1.0, 1.0, 0.0]),
        ] {
            assert!(closest_point(p.into(), t).distance(q.into()) < 1e-15, "{p:?}");
        }
    }
}
