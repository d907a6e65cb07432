//! Errors of building a mesh.

use std::ops::RangeInclusive;

use fairing_watch::parallel;

/// The range of the extent of a mesh in mesh units: the longest side of the bounding box, unless it
/// is zero.
///
/// Formulas of this workspace take lengths to at most the eighth power, which neither overflows nor
/// underflows in this range.
pub const EXTENTS: RangeInclusive<f64> = 1e-30..=1e30;

/// The reason why positions and faces are not a valid mesh.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum BuildError {
    /// A coordinate is infinite or not a number.
    #[error(
        "vertex {vertex} has the coordinates ({}, {}, {}), which are not all finite",
        position[0], position[1], position[2]
    )]
    NonFinite {
        /// The offending vertex.
        vertex: u32,
        /// Its coordinates.
        position: [f64; 3],
    },
    /// The longest side of the box around the vertices is neither zero nor within
    /// [`EXTENTS`](crate::EXTENTS).
    #[error("the mesh has an extent of {extent:e}, outside of 1e-30 to 1e30: rescale it")]
    Extent {
        /// The longest side, in mesh units.
        extent: f64,
    },
    /// A face names a vertex that does not exist.
    #[error("face {face} names vertex {index}, but there are {vertex_count} vertices")]
    IndexOutOfRange {
        /// The offending face.
        face: usize,
        /// The index it names.
        index: u32,
        /// The number of vertices.
        vertex_count: usize,
    },
    /// A face names one vertex twice, so its area is zero for any positions.
    #[error("face {face} repeats a corner: vertices {}, {}, {}", corners[0], corners[1], corners[2])]
    RepeatedCorner {
        /// The offending face.
        face: usize,
        /// Its corners.
        corners: [u32; 3],
    },
    /// A polygon has fewer than three corners.
    #[error("face {face} has {count} corners, which is fewer than three")]
    TooFewCorners {
        /// The offending face.
        face: usize,
        /// The number of its corners.
        count: usize,
    },
    /// A polygon names one vertex twice.
    #[error("face {face} repeats a vertex among its {count} corners")]
    RepeatedPolygonCorner {
        /// The offending face.
        face: usize,
        /// The number of its corners.
        count: usize,
    },
    /// More vertices or corners than `u32` can number.
    #[error("{count} {what} are more than 32-bit indices can number")]
    TooLarge {
        /// `vertices` or `corners`.
        what: &'static str,
        /// Their number.
        count: usize,
    },
    /// The length of a flat list is not a multiple of three.
    #[error("{count} {what} are not a multiple of three")]
    NotInThrees {
        /// `coordinates` or `indices`.
        what: &'static str,
        /// Their number.
        count: usize,
    },
    /// A corner of a face does not fit into `u32`, such as −1.
    #[error("a corner of face {face} is not a 32-bit index")]
    NotAnIndex {
        /// The offending face.
        face: usize,
    },
    /// The number of new positions is not the number of vertices.
    #[error("{found} positions for a mesh of {expected} vertices")]
    PositionCount {
        /// The number of vertices.
        expected: usize,
        /// The number of positions given.
        found: usize,
    },
}

/// Checks that positions are finite, and that their extent is within [`EXTENTS`].
pub(crate) fn check_positions(positions: &[[f64; 3]]) -> Result<(), BuildError> {
    let extent = extent(positions);
    if extent == 0.0 || EXTENTS.contains(&extent) {
        return Ok(());
    }
    match positions.iter().position(|p| p.iter().any(|x| !x.is_finite())) {
        None => Err(BuildError::Extent { extent }),
        Some(v) => Err(BuildError::NonFinite { vertex: v as u32, position: positions[v] }),
    }
}

/// The positions or faces that one thread checks at a time.
const BLOCK: usize = 1 << 14;

/// The longest side of the box around positions; 0 without any, NaN if one is not finite.
fn extent(positions: &[[f64; 3]]) -> f64 {
    let around = |a: Bounds, b: Bounds| Bounds {
        low: std::array::from_fn(|k| a.low[k].min(b.low[k])),
        high: std::array::from_fn(|k| a.high[k].max(b.high[k])),
        finite: a.finite && b.finite,
    };
    let blocks = parallel::map_each(positions.chunks(BLOCK), Bounds::new);
    let Some(bounds) = blocks.into_iter().reduce(around) else {
        return 0.0;
    };
    if !bounds.finite {
        return f64::NAN;
    }
    (0..3).map(|k| bounds.high[k] - bounds.low[k]).fold(0.0, f64::max)
}

/// The box around positions.
struct Bounds {
    low: [f64; 3],
    high: [f64; 3],
    /// True if all coordinates are finite.
    finite: bool,
}

impl Bounds {
    fn new(positions: &[[f64; 3]]) -> Self {
        // Twelve numbers at a time, without a branch, are compared by vector instructions.
        const LANES: usize = 12;
        let first: [f64; LANES] = std::array::from_fn(|lane| positions[0][lane % 3]);
        // A sum is NaN where a number is, which comparisons do not show; infinite ones are the
        // lowest or the highest.
        let (mut low, mut high, mut sum) = (first, first, [0.0; LANES]);
        let (blocks, rest) = positions.as_flattened().as_chunks::<LANES>();
        for block in blocks {
            for lane in 0..LANES {
                low[lane] = if block[lane] < low[lane] { block[lane] } else { low[lane] };
            }
            for lane in 0..LANES {
                high[lane] = if block[lane] > high[lane] { block[lane] } else { high[lane] };
            }
            for lane in 0..LANES {
                sum[lane] += block[lane];
            }
        }
        for (lane, &x) in rest.iter().enumerate() {
            (low[lane], high[lane]) = (low[lane].min(x), high[lane].max(x));
            sum[lane] += x;
        }
        let fold = |lanes: [f64; LANES], f: fn(f64, f64) -> f64| {
            std::array::from_fn(|k| lanes.into_iter().skip(k).step_by(3).fold(positions[0][k], f))
        };
        let (low, high) = (fold(low, f64::min), fold(high, f64::max));
        let in_box = low.iter().chain(&high).all(|x| x.is_finite());
        Self { low, high, finite: in_box && !sum.iter().any(|sum| sum.is_nan()) }
    }
}

/// Checks that corners are below `count`, and that no face repeats one.
pub(crate) fn check_faces(faces: &[[u32; 3]], count: usize) -> Result<(), BuildError> {
    let check = |face: usize| {
        let corners = faces[face];
        let [a, b, c] = corners;
        if let Some(&index) = corners.iter().find(|&&i| i as usize >= count) {
            return Err(BuildError::IndexOutOfRange { face, index, vertex_count: count });
        }
        if a == b || b == c || c == a {
            return Err(BuildError::RepeatedCorner { face, corners });
        }
        Ok(())
    };
    // The first error of all, as on one thread.
    parallel::map_ranges(faces.len(), BLOCK, |mut faces| faces.try_for_each(check))
        .into_iter()
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One coordinate, all coordinates along an axis, or all: the extent of an axis on which all
    /// are infinite is not a number.
    #[test]
    fn positions_that_are_not_finite_are_refused() {
        // The first lanes, the rest after the last block of lanes, and a second block.
        for count in [1, 3, 7, BLOCK + 5] {
            for bad in [f64::INFINITY, f64::NEG_INFINITY, f64::NAN] {
                for k in 0..3 {
                    let one = |at: usize| {
                        let mut positions = vec![[1.0, 2.0, 3.0]; count];
                        positions[at][k] = bad;
                        (at, positions)
                    };
                    let all_of_axis = {
                        let mut position = [1.0, 2.0, 3.0];
                        position[k] = bad;
                        (0, vec![position; count])
                    };
                    let all = (0, vec![[bad; 3]; count]);
                    for (vertex, positions) in [one(0), one(count - 1), all_of_axis, all] {
                        let error = check_positions(&positions).unwrap_err();
                        let named = matches!(error, BuildError::NonFinite { vertex: v, .. }
                            if v as usize == vertex);
                        assert!(named, "{count} vertices, {bad} at {vertex}, {k}: {error}");
                    }
                }
            }
        }
        let opposite = vec![[f64::INFINITY, 0.0, 0.0], [f64::NEG_INFINITY, 0.0, 0.0]];
        assert!(matches!(check_positions(&opposite), Err(BuildError::NonFinite { vertex: 0, .. })));
    }
}
