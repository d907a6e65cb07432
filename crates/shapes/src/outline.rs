//! Outlines of straight lines and arcs.

use std::f64::consts::{PI, TAU};

/// A piece of an outline in the plane: a straight line or an arc, with the
/// material on its left.
#[derive(Debug, Clone, Copy)]
pub enum Piece {
    /// A straight line.
    Line {
        /// Its start.
        from: [f64; 2],
        /// Its end.
        to: [f64; 2],
    },
    /// An arc; clockwise if `sweep` is negative.
    Arc {
        /// The centre of the circle.
        centre: [f64; 2],
        /// The radius of the circle.
        radius: f64,
        /// The angle of the first point from the x axis, in radians.
        start: f64,
        /// The angle from the first to the last point, in radians.
        sweep: f64,
    },
}

impl Piece {
    /// The length.
    pub fn length(self) -> f64 {
        match self {
            Self::Line { from, to } => libm::hypot(to[0] - from[0], to[1] - from[1]),
            Self::Arc { radius, sweep, .. } => radius * sweep.abs(),
        }
    }

    /// The point at the fraction `t` of the length.
    pub fn at(self, t: f64) -> [f64; 2] {
        match self {
            Self::Line { from, to } => [0, 1].map(|k| from[k] + t * (to[k] - from[k])),
            Self::Arc { centre, radius, start, sweep } => {
                let (s, c) = libm::sincos(start + t * sweep);
                [centre[0] + radius * c, centre[1] + radius * s]
            }
        }
    }

    /// The fraction of the length at the point of the piece closest to `p`, for `p` near the
    /// piece. Arcs sweep less than a turn.
    pub fn fraction(self, p: [f64; 2]) -> f64 {
        match self {
            Self::Line { from, to } => {
                let d = [to[0] - from[0], to[1] - from[1]];
                ((p[0] - from[0]) * d[0] + (p[1] - from[1]) * d[1]) / (d[0] * d[0] + d[1] * d[1])
            }
            Self::Arc { centre, start, sweep, .. } => {
                let angle = libm::atan2(p[1] - centre[1], p[0] - centre[0]);
                // From the middle of the arc, within half a turn.
                let mut turn = (angle - start - 0.5 * sweep) % TAU;
                if turn > PI {
                    turn -= TAU;
                } else if turn < -PI {
                    turn += TAU;
                }
                0.5 + turn / sweep
            }
        }
    }

    /// Returns `true` for a straight line.
    pub fn is_straight(self) -> bool {
        matches!(self, Self::Line { .. })
    }
}

/// The straight pieces of a closed polygon.
pub fn polygon(corners: &[[f64; 2]]) -> Vec<Piece> {
    let n = corners.len();
    (0..n).map(|i| Piece::Line { from: corners[i], to: corners[(i + 1) % n] }).collect()
}

/// The polygon with each corner rounded by an arc of its radius that touches
/// both sides; a radius of zero leaves it sharp.
pub fn rounded(corners: &[([f64; 2], f64)]) -> Vec<Piece> {
    let n = corners.len();
    // Where the arc of each corner begins and ends, and the arc.
    let arcs: Vec<_> = (0..n)
        .map(|i| {
            let (p, radius) = corners[i];
            let (before, after) = (corners[(i + n - 1) % n].0, corners[(i + 1) % n].0);
            if radius == 0.0 {
                return (p, p, None);
            }
            let unit = |a: [f64; 2], b: [f64; 2]| {
                let d = [b[0] - a[0], b[1] - a[1]];
                let length = libm::hypot(d[0], d[1]);
                [d[0] / length, d[1] / length]
            };
            let (u, v) = (unit(before, p), unit(p, after));
            let turn = libm::atan2(u[0] * v[1] - u[1] * v[0], u[0] * v[0] + u[1] * v[1]);
            let reach = radius * libm::tan(0.5 * turn.abs());
            let from = [p[0] - reach * u[0], p[1] - reach * u[1]];
            let to = [p[0] + reach * v[0], p[1] + reach * v[1]];
            let side = turn.signum();
            let centre = [from[0] - side * radius * u[1], from[1] + side * radius * u[0]];
            let start = libm::atan2(from[1] - centre[1], from[0] - centre[0]);
            (from, to, Some(Piece::Arc { centre, radius, start, sweep: turn }))
        })
        .collect();
    let mut pieces = vec![];
    for i in 0..n {
        pieces.extend(arcs[i].2);
        let (from, to) = (arcs[i].1, arcs[(i + 1) % n].0);
        if libm::hypot(to[0] - from[0], to[1] - from[1]) > 1e-9 {
            pieces.push(Piece::Line { from, to });
        }
    }
    pieces
}

/// A circle of `pieces` arcs, counter-clockwise, or clockwise as the outline of a hole.
pub fn circle(centre: [f64; 2], radius: f64, pieces: u32, hole: bool) -> Vec<Piece> {
    let sweep = if hole { -TAU } else { TAU } / f64::from(pieces);
    let arc = |i| Piece::Arc { centre, radius, start: f64::from(i) * sweep, sweep };
    (0..pieces).map(arc).collect()
}
