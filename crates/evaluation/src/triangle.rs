//! Points and triangles.

use fairing_mesh::vec3::{add, dot, scale, sub};

/// The sine squared of the angle at the first corner below which a triangle is
/// treated as its sides: rounding would decide on which side of them a point
/// is, and leave half of the digits to the height.
const FLAT: f64 = 1e-12;

/// The point of triangle `abc` closest to `p`, by the region of the plane that
/// `p` is over: a corner, a side or the inside. Of triangles without area, the
/// closest point of their sides. Source: \[ericson2004\], section 5.1.5.
#[inline]
pub(crate) fn closest_point(p: [f64; 3], [a, b, c]: [[f64; 3]; 3]) -> [f64; 3] {
    let (ab, ac, ap) = (sub(b, a), sub(c, a), sub(p, a));
    let (d1, d2) = (dot(ab, ap), dot(ac, ap));
    if d1 <= 0.0 && d2 <= 0.0 {
        return a;
    }
    let bp = sub(p, b);
    let (d3, d4) = (dot(ab, bp), dot(ac, bp));
    if d3 >= 0.0 && d4 <= d3 {
        return b;
    }
    let cp = sub(p, c);
    let (d5, d6) = (dot(ab, cp), dot(ac, cp));
    if d6 >= 0.0 && d5 <= d6 {
        return c;
    }
    let (squares, inner) = (dot(ab, ab) * dot(ac, ac), dot(ab, ac));
    // Not so for NaN either, which lengths that overflow give.
    let wide = squares - inner * inner > FLAT * squares;
    if !wide {
        return closest_on_sides(p, [a, b, c]);
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        return add(a, scale(ab, d1 / (d1 - d3)));
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        return add(a, scale(ac, d2 / (d2 - d6)));
    }
    let va = d3 * d6 - d5 * d4;
    let (along, against) = (d4 - d3, d5 - d6);
    if va <= 0.0 && along >= 0.0 && against >= 0.0 {
        return add(b, scale(sub(c, b), along / (along + against)));
    }
    let sum = va + vb + vc;
    add(a, add(scale(ab, vb / sum), scale(ac, vc / sum)))
}

#[cold]
fn closest_on_sides(p: [f64; 3], [a, b, c]: [[f64; 3]; 3]) -> [f64; 3] {
    let mut best = (f64::INFINITY, a);
    for (u, v) in [(a, b), (b, c), (c, a)] {
        let d = sub(v, u);
        let square = dot(d, d);
        let t = if square > 0.0 { (dot(sub(p, u), d) / square).clamp(0.0, 1.0) } else { 0.0 };
        let q = add(u, scale(d, t));
        let r = sub(p, q);
        if dot(r, r) < best.0 {
            best = (dot(r, r), q);
        }
    }
    best.1
}

/// The square of the distance between a point and a triangle.
#[inline]
pub(crate) fn squared_distance(p: [f64; 3], triangle: [[f64; 3]; 3]) -> f64 {
    let d = sub(p, closest_point(p, triangle));
    dot(d, d)
}

#[cfg(test)]
mod tests {
    use fairing_mesh::vec3::{cross, distance};
    use proptest::prelude::*;

    use super::*;

    fn coordinate() -> impl Strategy<Value = f64> {
        // Few values make degenerate triangles and ties frequent.
        prop_oneof![Just(0.0), Just(1.0), Just(-0.5), -2.0..2.0]
    }

    fn point() -> impl Strategy<Value = [f64; 3]> {
        [coordinate(), coordinate(), coordinate()]
    }

    proptest! {
        /// The distance to a convex set is least where the direction to the
        /// point makes no acute angle with any direction into the set.
        #[test]
        fn no_corner_lies_in_the_direction_of_the_point(p in point(), t in [point(), point(), point()]) {
            let q = closest_point(p, t);
            for corner in t {
                // Products of numbers up to 4; flat triangles, taken for their
                // sides, lose half of the digits.
                prop_assert!(dot(sub(p, q), sub(corner, q)) < 1e-5, "{q:?} for {corner:?}");
            }
        }

        /// The closest point is in the triangle: its parts fill the area.
        #[test]
        fn the_point_is_in_the_triangle(p in point(), t in [point(), point(), point()]) {
            let q = closest_point(p, t);
            let area = |a, b, c| { let n = cross(sub(b, a), sub(c, a)); dot(n, n).sqrt() };
            let [a, b, c] = t;
            let parts = area(q, b, c) + area(a, q, c) + area(a, b, q);
            prop_assert!((parts - area(a, b, c)).abs() < 1e-7, "{q:?}");
        }
    }

    #[test]
    fn each_region() {
        let t = [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0]];
        for (p, q) in [
            ([0.5, 0.5, 3.0], [0.5, 0.5, 0.0]),
            ([-1.0, -1.0, 1.0], [0.0, 0.0, 0.0]),
            ([3.0, -1.0, 1.0], [2.0, 0.0, 0.0]),
            ([-1.0, 3.0, 1.0], [0.0, 2.0, 0.0]),
            ([1.0, -1.0, 1.0], [1.0, 0.0, 0.0]),
            ([-1.0, 1.0, 1.0], [0.0, 1.0, 0.0]),
            ([2.0, 2.0, 1.0], [1.0, 1.0, 0.0]),
        ] {
            assert!(distance(closest_point(p, t), q) < 1e-15, "{p:?}");
        }
    }
}
