//! Profiles turned around an axis.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use super::solid::{Chart, Curve, Solid, joined, reversed};
use fairing_shapes::outline::Piece;

/// Parts of a turn, between straight seams.
const SECTORS: usize = 4;

/// The curve of a point of the profile: a circle in parts, or a point of the axis.
#[derive(Clone)]
pub(super) enum Ring {
    Point(u32),
    Circle([Curve; SECTORS]),
}

impl Ring {
    /// The ring around the axis through `centre`.
    pub(super) fn new(solid: &mut Solid, centre: [f64; 2], [r, z]: [f64; 2]) -> Self {
        if r < 1e-9 {
            return Self::Point(solid.corner([centre[0], centre[1], z]));
        }
        let at = |angle: f64| {
            let (s, c) = libm::sincos(angle);
            [centre[0] + r * c, centre[1] + r * s, z]
        };
        let starts: [u32; SECTORS] =
            std::array::from_fn(|i| solid.corner(at(i as f64 * FRAC_PI_2)));
        Self::Circle(std::array::from_fn(|i| {
            let ends = (starts[i], starts[(i + 1) % SECTORS]);
            solid.curve(ends.0, ends.1, |t| at((i as f64 + t) * FRAC_PI_2))
        }))
    }

    fn start(&self, sector: usize) -> u32 {
        match self {
            Self::Point(v) => *v,
            Self::Circle(parts) => parts[sector % SECTORS][0],
        }
    }

    /// The whole circle, counter-clockwise seen from +z.
    pub(super) fn border(&self) -> Curve {
        match self {
            Self::Point(v) => vec![*v],
            Self::Circle(parts) => joined(&parts.each_ref().map(Vec::as_slice)),
        }
    }
}

/// Adds the surface of the pieces, one after another in the half plane of
/// radius and height with the model on their left, around the axis through
/// `centre`; returns the first and the last ring. `first` is the ring to begin
/// with, if there is one. A closed profile ends where it began.
pub(super) fn revolve(
    solid: &mut Solid,
    centre: [f64; 2],
    pieces: &[Piece],
    first: Option<Ring>,
) -> [Ring; 2] {
    let begin = first.unwrap_or_else(|| Ring::new(solid, centre, pieces[0].at(0.0)));
    let [from, to] = [pieces[0].at(0.0), pieces[pieces.len() - 1].at(1.0)];
    let closed = libm::hypot(from[0] - to[0], from[1] - to[1]) < 1e-9;
    let mut low = begin.clone();
    for (k, &piece) in pieces.iter().enumerate() {
        let high = if closed && k + 1 == pieces.len() {
            begin.clone()
        } else {
            Ring::new(solid, centre, piece.at(1.0))
        };
        band(solid, centre, piece, [&low, &high]);
        low = high;
    }
    [begin, low]
}

/// The surface of one piece, in sectors.
fn band(solid: &mut Solid, centre: [f64; 2], piece: Piece, [low, high]: [&Ring; 2]) {
    let meridians: Vec<Curve> = (0..SECTORS)
        .map(|i| {
            let (s, c) = libm::sincos(i as f64 * FRAC_PI_2);
            let lift = |[r, z]: [f64; 2]| [centre[0] + r * c, centre[1] + r * s, z];
            solid.piece((low.start(i), high.start(i)), piece, lift)
        })
        .collect();
    for i in 0..SECTORS {
        let mut parts: Vec<Curve> = vec![];
        if let Ring::Circle(circle) = low {
            parts.push(circle[i].clone());
        }
        parts.push(meridians[(i + 1) % SECTORS].clone());
        if let Ring::Circle(circle) = high {
            parts.push(reversed(&circle[i]));
        }
        parts.push(reversed(&meridians[i]));
        let border = joined(&parts.iter().map(Vec::as_slice).collect::<Vec<_>>());
        let middle = (i as f64 + 0.5) * FRAC_PI_2;
        solid.face(&[border], &sector(centre, middle, piece));
    }
}

/// The chart of a sector around this angle.
fn sector<'a>(centre: [f64; 2], middle: f64, piece: Piece) -> Chart<'a> {
    // Radius, height, angle from the middle; and back.
    let polar = move |p: [f64; 3]| {
        let (x, y) = (p[0] - centre[0], p[1] - centre[1]);
        let mut angle = (libm::atan2(y, x) - middle) % TAU;
        if angle < -PI {
            angle += TAU;
        } else if angle > PI {
            angle -= TAU;
        }
        (libm::hypot(x, y), p[2], angle)
    };
    let lift = move |[r, z]: [f64; 2], angle: f64| {
        let (s, c) = libm::sincos(middle + angle);
        [centre[0] + r * c, centre[1] + r * s, z]
    };
    let [a, b] = [piece.at(0.0), piece.at(1.0)];
    if !piece.is_straight() {
        return conformal(piece, polar, lift);
    }
    let length = piece.length();
    let slope = (b[0] - a[0]) / length;
    if slope.abs() < 1e-3 {
        let r = 0.5 * (a[0] + b[0]);
        return Chart {
            to_plane: Box::new(move |p| {
                let (r_p, z, angle) = polar(p);
                [r * angle, length * piece.fraction([r_p, z])]
            }),
            to_space: Box::new(move |[x, s]| lift(piece.at(s / length), x / r)),
            isometric: true,
        };
    }
    // Unrolled: the distance from the apex is r / |slope|, the angle is scaled
    // by |slope|.
    let (steep, side) = (slope.abs(), slope.signum());
    Chart {
        to_plane: Box::new(move |p| {
            let (r, _, angle) = polar(p);
            let (s, c) = libm::sincos(angle * steep);
            [r / steep * s, side * r / steep * c]
        }),
        to_space: Box::new(move |[x, y]| {
            let r = steep * libm::hypot(x, y);
            let angle = libm::atan2(x, side * y) / steep;
            lift(piece.at((r - a[0]) / (b[0] - a[0])), angle)
        }),
        isometric: true,
    }
}

/// The chart of a sector whose profile is an arc clear of the axis: the angle
/// and ∫ ds / r, which keeps angles.
fn conformal<'a>(
    piece: Piece,
    polar: impl Fn([f64; 3]) -> (f64, f64, f64) + 'a,
    lift: impl Fn([f64; 2], f64) -> [f64; 3] + 'a,
) -> Chart<'a> {
    const PARTS: usize = 512;
    let step = piece.length() / PARTS as f64;
    let mut heights = vec![0.0];
    for k in 0..PARTS {
        let r = piece.at((k as f64 + 0.5) / PARTS as f64)[0];
        heights.push(heights[k] + step / r);
    }
    let table = heights.clone();
    Chart {
        to_plane: Box::new(move |p| {
            let (r, z, angle) = polar(p);
            let t = (piece.fraction([r, z]) * PARTS as f64).clamp(0.0, PARTS as f64);
            let k = (t as usize).min(PARTS - 1);
            [angle, table[k] + (t - k as f64) * (table[k + 1] - table[k])]
        }),
        to_space: Box::new(move |[angle, y]| {
            let k = heights.partition_point(|&h| h <= y).clamp(1, PARTS) - 1;
            let t = k as f64 + (y - heights[k]) / (heights[k + 1] - heights[k]);
            lift(piece.at(t / PARTS as f64), angle)
        }),
        isometric: false,
    }
}
