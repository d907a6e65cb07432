//! Steps of a repair, their limits, and errors.

use fairing_parameters::{ParameterError, Range};

use super::rounding;
use crate::build::BuildError;
use crate::trimesh::TriMesh;

/// The distance up to which [`repair`](super::repair) merges vertices.
///
/// A vertex moves to the first vertex of the file within the distance that itself stays, so that
/// none moves farther than the distance.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Tolerance {
    /// Four units in the last place of single-precision coordinates: 2⁻²¹ of the longest side of
    /// the bounding box, or of the largest coordinate if all coordinates are single-precision
    /// numbers. Each of two corners that a program computes twice is rounded by half a unit in
    /// each coordinate, and by as much again when it is transformed.
    ///
    /// Only vertices with a boundary edge are merged, those of cracks, and only if they are closer
    /// than half of the shortest edge at either of them, so that no face collapses. Vertices
    /// stay if an edge would get an odd number of faces above one, two faces would lie flat on
    /// each other across an edge, or two would get the same corners and winding.
    #[default]
    Rounding,
    /// In mean edge lengths of the input, from 0 to 1; zero merges vertices at exactly equal
    /// positions.
    EdgeLengths(f64),
    /// In mesh units, at least 0.
    Model(f64),
    /// In diagonals of the bounding box, from 0 to 1.
    Diagonals(f64),
}

impl Tolerance {
    fn check(self) -> Result<(), ParameterError> {
        let (range, value) = match self {
            Self::Rounding => return Ok(()),
            Self::Model(length) => (Range::NOT_NEGATIVE, length),
            Self::EdgeLengths(ratio) | Self::Diagonals(ratio) => (Range::FRACTION, ratio),
        };
        range.check("tolerance", value)
    }

    /// The distance for a mesh, in mesh units.
    pub(super) fn distance(self, mesh: &TriMesh) -> f64 {
        match self {
            Self::Rounding => rounding::distance(mesh),
            Self::EdgeLengths(ratio) => ratio * mesh.mean_edge_length(),
            Self::Model(length) => length,
            Self::Diagonals(ratio) => ratio * mesh.diagonal(),
        }
    }
}

/// Steps of [`repair`](super::repair) and their limits.
///
/// The default changes no geometry: the same points are covered by the same triangles, up to the
/// rounding of single-precision coordinates.
#[derive(Debug, Clone, PartialEq)]
pub struct RepairOptions {
    /// Merges vertices within the tolerance, and drops faces that lose a corner by it.
    pub merge: bool,
    /// The distance up to which vertices are merged.
    pub tolerance: Tolerance,
    /// Drops faces with the corners of an earlier face, in any order. Both are dropped if they are
    /// a fin of a closed surface, which one of them would open; both are kept if they are a wall
    /// between two closed parts.
    pub duplicates: bool,
    /// Flips faces so that neighbours agree, as [`TriMesh::oriented`] does, and closed components
    /// that are inside out and in no other one, with all that they hold.
    pub orient: bool,
    /// Flips closed components also within others, so that normals point outwards, or inwards
    /// where an odd number of others is around: a solid within a solid becomes a cavity. Only if
    /// faces are [oriented](Self::orient).
    pub cavities: bool,
    /// Gives a vertex of its own to each sheet of faces at a non-manifold edge or vertex. Faces
    /// that run the same way along such an edge are different sheets.
    pub split: bool,
    /// Drops components with fewer faces than this; zero keeps all.
    pub smallest_component: usize,
    /// Collapses needles and flips caps: faces whose height is below this fraction of their
    /// longest edge. Zero leaves them.
    pub thin: f64,
    /// Drops vertices that no face uses, unless there are no faces at all.
    pub isolated: bool,
    /// Fills holes of at most this many edges; zero fills none. The largest boundary of a
    /// component that is not closed may be its rim, so choose less than its edges.
    pub holes: usize,
}

impl RepairOptions {
    /// The defaults.
    pub const DEFAULT: Self = Self {
        merge: true,
        tolerance: Tolerance::Rounding,
        duplicates: true,
        orient: true,
        cavities: false,
        split: true,
        smallest_component: 0,
        thin: 0.0,
        isolated: true,
        holes: 0,
    };

    /// No step, as a base for choosing single steps.
    pub const NONE: Self = Self {
        merge: false,
        duplicates: false,
        orient: false,
        split: false,
        isolated: false,
        ..Self::DEFAULT
    };

    /// The largest number of edges of a hole to fill: its triangulation takes time cubic in it.
    pub const MAX_HOLE: usize = 2000;

    pub(super) fn check(&self) -> Result<(), ParameterError> {
        self.tolerance.check()?;
        Range::from(0.0..=0.1).check("thin", self.thin)?;
        Range::from(0.0..=Self::MAX_HOLE as f64).check("holes", self.holes as f64)
    }
}

impl Default for RepairOptions {
    fn default() -> Self {
        Self::DEFAULT
    }
}

/// A reason for which [`repair`](super::repair) fails.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RepairError {
    /// An option is out of range.
    #[error(transparent)]
    Option(#[from] ParameterError),
    /// The positions that are left do not make a mesh: without the vertices that were dropped or
    /// merged, their extent is out of range.
    #[error("the repaired mesh is not valid: {0}")]
    Positions(#[source] BuildError),
}
