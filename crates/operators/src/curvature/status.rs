//! The status of a value at a vertex: defined, or the reason why it is not.

use std::fmt;

/// Why there is no value at a vertex.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum Undefined {
    /// No face has the vertex.
    Isolated,
    /// The faces around it have no area, or their normals cancel.
    NoArea,
    /// Fewer neighbours than the method needs.
    TooFewNeighbors,
    /// The neighbours do not determine the method's equations, as if all lie on a line.
    IllConditioned,
}

impl fmt::Display for Undefined {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Isolated => "isolated vertex",
            Self::NoArea => "no area around the vertex, or normals that cancel",
            Self::TooFewNeighbors => "too few neighbours",
            Self::IllConditioned => "equations not determined",
        })
    }
}

/// The status of a value at a vertex: defined, or the reason why it is not.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum VertexStatus {
    /// The value is there.
    Defined,
    /// There is no value; the field is zero there.
    Undefined(Undefined),
}

impl VertexStatus {
    /// Returns true if the value is defined.
    pub fn is_defined(self) -> bool {
        self == Self::Defined
    }
}

/// A curvature at each vertex.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct ScalarCurvature {
    /// The values in vertex order, zero where undefined.
    pub values: Vec<f64>,
    /// The status of each value.
    pub status: Vec<VertexStatus>,
    /// True for vertices on the boundary, where values are one-sided.
    pub boundary: Vec<bool>,
}

impl ScalarCurvature {
    /// Values, whether each is defined, and whether its vertex is on the boundary.
    ///
    /// # Panics
    ///
    /// If the three differ in length.
    pub fn new(values: Vec<f64>, status: Vec<VertexStatus>, boundary: Vec<bool>) -> Self {
        assert!(
            values.len() == status.len() && values.len() == boundary.len(),
            "{} values, {} states, {} flags of the boundary",
            values.len(),
            status.len(),
            boundary.len()
        );
        Self { values, status, boundary }
    }

    /// The value at vertex `v`, if defined.
    ///
    /// # Panics
    ///
    /// If there is no vertex `v`.
    pub fn get(&self, v: u32) -> Option<f64> {
        let v = v as usize;
        self.status[v].is_defined().then(|| self.values[v])
    }

    /// True at each vertex without a value, where the zero means nothing: the flags for colours.
    pub fn undefined(&self) -> Vec<bool> {
        self.status.iter().map(|status| !status.is_defined()).collect()
    }

    /// The vertices whose value is defined and not one-sided: use these for
    /// colour ranges and statistics.
    pub fn interior(&self) -> impl Iterator<Item = (u32, f64)> + '_ {
        (0..self.values.len())
            .filter(|&v| self.status[v].is_defined() && !self.boundary[v])
            .map(|v| (v as u32, self.values[v]))
    }
}

/// From values, why there would be none, and boundary flags: a value that is
/// not finite becomes zero, undefined for that reason.
impl FromIterator<(f64, Undefined, bool)> for ScalarCurvature {
    fn from_iter<I: IntoIterator<Item = (f64, Undefined, bool)>>(items: I) -> Self {
        let mut all = Self { values: vec![], status: vec![], boundary: vec![] };
        for (value, reason, boundary) in items {
            let defined = value.is_finite();
            all.values.push(if defined { value } else { 0.0 });
            all.status.push(if defined {
                VertexStatus::Defined
            } else {
                VertexStatus::Undefined(reason)
            });
            all.boundary.push(boundary);
        }
        all
    }
}
