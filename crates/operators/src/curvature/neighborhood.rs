//! The neighbourhood of a vertex that an estimator uses.

use std::ops::Bound;

use fairing_mesh::{Topology, TriMesh};
use fairing_parameters::{Field, Kind, Parameter, ParameterError, Range, Value, Values};
use glam::DVec3;

use crate::error::OperatorError;

/// Neighbours above which a neighbourhood does not reach through a vertex: each
/// of n neighbours would have all the others.
pub(super) const HUB: usize = 256;

/// A length, in mesh units or in mean edge lengths.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum Length {
    /// Mesh units.
    MeshUnits(f64),
    /// Mean edge lengths of the component, an edge counted once for each of its faces.
    MeanEdges(f64),
}

/// One mean edge length.
impl Default for Length {
    fn default() -> Self {
        Self::MeanEdges(1.0)
    }
}

impl Length {
    /// The length in mesh units at each vertex; 0 at isolated vertices if in mean edge lengths.
    ///
    /// # Errors
    ///
    /// [`OperatorError::Option`] if the length is negative or not finite.
    pub(crate) fn at_vertices(self, mesh: &TriMesh) -> Result<Vec<f64>, OperatorError> {
        let (Self::MeshUnits(value) | Self::MeanEdges(value)) = self;
        Range::NOT_NEGATIVE.check("radius", value)?;
        if matches!(self, Self::MeshUnits(_)) {
            return Ok(vec![value; mesh.vertex_count()]);
        }
        let components = mesh.topology().components();
        let component = |v: u32| components.label(v).map(|c| c as usize);
        let mut sums = vec![(0.0, 0usize); components.count()];
        for (f, face) in mesh.faces().iter().enumerate() {
            if let Some(c) = component(face[0]) {
                let [a, b, third] = mesh.triangle(f).map(DVec3::from);
                sums[c].0 += a.distance(b) + b.distance(third) + third.distance(a);
                sums[c].1 += 3;
            }
        }
        let mean = |v: u32| component(v).map_or(0.0, |c| sums[c].0 / sums[c].1 as f64);
        Ok((0..mesh.vertex_count() as u32).map(|v| value * mean(v)).collect())
    }
}

/// Vertices whose balls are examined in advance.
const SAMPLES: usize = 256;

/// The most elements of a ball, on average, over those of a regular mesh of the same mean edge.
const MAX_CROWDING: f64 = 20.0;

/// The elements of all balls that are never too many: a second of work.
const FEW: f64 = (1 << 24) as f64;

impl Length {
    /// Refuses balls that hold far more elements than their radius in edges suggests, as where
    /// faces are long and thin: n balls of n elements each would take hours. `size` counts the
    /// elements of the ball about a vertex; a few balls stand for all.
    ///
    /// # Errors
    ///
    /// [`OperatorError::Crowded`].
    pub(crate) fn refuse_crowded(
        self,
        mesh: &TriMesh,
        mut size: impl FnMut(u32) -> usize,
    ) -> Result<(), OperatorError> {
        let count = mesh.vertex_count();
        if count as f64 * mesh.face_count() as f64 <= FEW {
            return Ok(());
        }
        let edges = match self {
            Self::MeshUnits(value) => value / mesh.mean_edge_length(),
            Self::MeanEdges(edges) => edges,
        };
        let sampled = (0..count as u32).step_by(count.div_ceil(SAMPLES));
        let sizes: Vec<(usize, u32)> = sampled.map(|v| (size(v), v)).collect();
        let mean = sizes.iter().map(|s| s.0).sum::<usize>() as f64 / sizes.len() as f64;
        // The disc of this radius over a face of a regular mesh, and the first ring.
        let regular = 6.0 + 7.3 * edges * edges;
        match sizes.iter().max_by_key(|s| s.0) {
            Some(&(elements, vertex))
                if mean > MAX_CROWDING * regular && mean * count as f64 > FEW =>
            {
                Err(OperatorError::Crowded { vertex, elements, edges })
            }
            _ => Ok(()),
        }
    }
}

/// A length of parameters is in mean edge lengths.
impl Field for Length {
    fn parameters(&self, field: Parameter) -> Vec<Parameter> {
        let default = match self {
            Self::MeshUnits(_) => None,
            Self::MeanEdges(edges) => Some(Value::Number(*edges)),
        };
        vec![Parameter { kind: Kind::Number, default, ..field }]
    }

    fn read(&mut self, name: &'static str, values: &Values) -> Result<(), ParameterError> {
        *self = values.number(name).map_or(*self, Self::MeanEdges);
        Ok(())
    }

    fn check(&self, name: &'static str, range: Range) -> Result<(), ParameterError> {
        let (Self::MeshUnits(value) | Self::MeanEdges(value)) = self;
        range.check(name, *value)
    }
}

/// The vertices used in a fit. The search does not continue past vertices with more than 256
/// neighbours.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum Neighborhood {
    /// All within this number of edges.
    Rings(u32),
    /// The vertices that paths of edges reach without leaving the ball of this radius.
    Ball(Length),
}

const RINGS: &str = "rings";
const RADIUS: &str = "radius";
const RINGS_RANGE: Range = Range::new(Bound::Included(1.0), Bound::Included(16.0));

impl Field for Neighborhood {
    fn parameters(&self, _: Parameter) -> Vec<Parameter> {
        let (rings, radius) = match *self {
            Self::Rings(rings) => (Some(Value::Count(rings as usize)), None),
            Self::Ball(Length::MeanEdges(radius)) => (None, Some(Value::Number(radius))),
            Self::Ball(Length::MeshUnits(_)) => (None, None),
        };
        let about = "The neighbourhood of the fit, in rings";
        let in_rings = Parameter {
            range: RINGS_RANGE,
            default: rings,
            ..Parameter::new(RINGS, Kind::Count, about)
        };
        let in_edges = Parameter {
            unit: "mean edge lengths",
            range: Range::POSITIVE,
            default: radius,
            excludes: &[RINGS],
            ..Parameter::new(
                RADIUS,
                Kind::Number,
                "The radius of the neighbourhood of the fit, instead of rings",
            )
        };
        vec![in_rings, in_edges]
    }

    fn read(&mut self, _: &'static str, values: &Values) -> Result<(), ParameterError> {
        if let Some(rings) = values.count(RINGS) {
            *self = Self::Rings(rings as u32);
        }
        if let Some(radius) = values.number(RADIUS) {
            *self = Self::Ball(Length::MeanEdges(radius));
        }
        Ok(())
    }

    fn check(&self, _: &'static str, _: Range) -> Result<(), ParameterError> {
        match self {
            Self::Rings(rings) => RINGS_RANGE.check(RINGS, f64::from(*rings)),
            Self::Ball(radius) => radius.check(RADIUS, Range::POSITIVE),
        }
    }
}

/// Finds neighbourhoods, one vertex after another.
#[derive(Debug, Default)]
pub(crate) struct Explorer {
    /// The vertex for which each vertex was last reached, plus one.
    reached_for: Vec<u32>,
    /// The vertices found, the centre first, then ring by ring.
    pub(crate) found: Vec<u32>,
}

impl Explorer {
    /// Finds the neighbourhood of `v`. One with fewer than `at_least` vertices
    /// besides `v`, which would not determine a fit, is widened by whole rings
    /// until there are as many, or nothing more is connected.
    pub(crate) fn explore(
        &mut self,
        mesh: &TriMesh,
        topology: &Topology,
        v: u32,
        reach: &Reach,
        at_least: usize,
    ) {
        self.reached_for.resize(mesh.vertex_count(), 0);
        // Marks of the same vertex, from a wider search.
        for w in self.found.drain(..) {
            self.reached_for[w as usize] = 0;
        }
        self.found.push(v);
        self.reached_for[v as usize] = v + 1;
        let mut start = 0;
        match reach {
            Reach::Rings(count) => {
                for _ in 0..*count {
                    start = self.grow(topology, start, |_| true);
                }
            }
            Reach::Radii(radii) => {
                let radius = radii[v as usize];
                let at = |w: u32| DVec3::from(mesh.positions()[w as usize]);
                let centre = at(v);
                while start < self.found.len() {
                    start = self.grow(topology, start, |w| at(w).distance(centre) <= radius);
                }
                // Vertices rejected before may be neighbours of any that were found.
                start = 0;
            }
        }
        while self.found.len() <= at_least && start < self.found.len() {
            start = self.grow(topology, start, |_| true);
        }
    }

    /// Adds the neighbours of those found from `start` on; returns where the
    /// added ones start.
    #[inline]
    fn grow(&mut self, topology: &Topology, start: usize, take: impl Fn(u32) -> bool) -> usize {
        let (end, mark) = (self.found.len(), self.found[0] + 1);
        for i in start..end {
            let neighbors = topology.neighbors(self.found[i]);
            if neighbors.len() > HUB && i > 0 {
                continue;
            }
            for &w in neighbors {
                if self.reached_for[w as usize] != mark && take(w) {
                    self.reached_for[w as usize] = mark;
                    self.found.push(w);
                }
            }
        }
        end
    }
}

/// A neighbourhood in mesh units, with a radius at each vertex.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Reach {
    Rings(u32),
    Radii(Vec<f64>),
}

impl Neighborhood {
    pub(crate) fn reach(self, mesh: &TriMesh) -> Result<Reach, OperatorError> {
        Ok(match self {
            Self::Rings(count) => Reach::Rings(count),
            Self::Ball(radius) => {
                let reach = Reach::Radii(radius.at_vertices(mesh)?);
                let mut explorer = Explorer::default();
                radius.refuse_crowded(mesh, |v| {
                    explorer.explore(mesh, mesh.topology(), v, &reach, 0);
                    explorer.found.len()
                })?;
                reach
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A strip of squares, two vertices a rung.
    fn strip() -> TriMesh {
        let positions = (0..12).map(|i| [f64::from(i / 2), f64::from(i % 2), 0.0]).collect();
        let faces = (0..5u32)
            .flat_map(|q| {
                let a = 2 * q;
                [[a, a + 2, a + 1], [a + 1, a + 2, a + 3]]
            })
            .collect();
        TriMesh::new(positions, faces).unwrap()
    }

    fn found(reach: Reach, at_least: usize) -> Vec<u32> {
        let mesh = strip();
        let mut explorer = Explorer::default();
        // Marks of another vertex must not matter.
        explorer.explore(&mesh, mesh.topology(), 7, &reach, 0);
        explorer.explore(&mesh, mesh.topology(), 0, &reach, at_least);
        explorer.found.sort_unstable();
        explorer.found
    }

    #[test]
    fn rings_and_balls() {
        assert_eq!(found(Reach::Rings(0), 0), [0]);
        assert_eq!(found(Reach::Rings(1), 0), [0, 1, 2]);
        assert_eq!(found(Reach::Rings(2), 0), [0, 1, 2, 3, 4]);
        assert_eq!(found(Reach::Radii(vec![1.0; 12]), 0), [0, 1, 2]);
        assert_eq!(found(Reach::Radii(vec![1.5; 12]), 0), [0, 1, 2, 3]);
    }

    #[test]
    fn too_few_widen_until_there_are_enough_or_no_more() {
        assert_eq!(found(Reach::Rings(1), 3), [0, 1, 2, 3, 4]);
        assert_eq!(found(Reach::Radii(vec![0.1; 12]), 2), [0, 1, 2]);
        assert_eq!(found(Reach::Radii(vec![1.5; 12]), 4), [0, 1, 2, 3, 4, 5]);
        assert_eq!(found(Reach::Rings(1), 99).len(), 12);
    }

    /// Around the rim, and to the hub, but not to the other side.
    #[test]
    fn hubs_are_not_passed() {
        let n = 300u32;
        let positions = vec![[0.0; 3]; n as usize + 1];
        let faces = (0..n).map(|i| [0, i + 1, (i + 1) % n + 1]).collect();
        let fan = TriMesh::new(positions, faces).unwrap();
        let mut explorer = Explorer::default();
        explorer.explore(&fan, fan.topology(), 10, &Reach::Rings(2), 0);
        explorer.found.sort_unstable();
        assert_eq!(explorer.found, [0, 8, 9, 10, 11, 12]);
        explorer.explore(&fan, fan.topology(), 0, &Reach::Rings(2), 0);
        assert_eq!(explorer.found.len(), 301);
    }

    /// Each vertex of a disc with a hub has all faces in its ball, and each of a long thin strip a
    /// large part: n balls of n elements are refused, smaller ones estimated.
    #[test]
    fn crowded_balls_are_refused() {
        use crate::curvature::Estimator;
        let n = 12_000u32;
        let rim = |i: u32| {
            let angle = std::f64::consts::TAU * f64::from(i) / f64::from(n);
            [angle.cos(), angle.sin(), 0.0]
        };
        let positions = std::iter::once([0.0; 3]).chain((0..n).map(rim)).collect();
        let faces = (0..n).map(|i| [0, i + 1, (i + 1) % n + 1]).collect();
        let disc = TriMesh::new(positions, faces).unwrap();
        for name in ["normal-cycle", "corrected-ball", "jet3", "quadric"] {
            let estimate = |radius| {
                let estimator = Estimator::with(name, &[("radius", radius)]).unwrap();
                estimator.estimate(&disc)
            };
            let refused = estimate("2").unwrap_err();
            let whole = |elements: usize| elements + 1 >= n as usize;
            assert!(
                matches!(refused, OperatorError::Crowded { elements, .. } if whole(elements)),
                "{name}: {refused}"
            );
            assert!(estimate("0.02").is_ok(), "{name}");
        }
    }

    /// A second component a thousand times larger leaves the lengths of the first.
    #[test]
    fn mean_edges_are_those_of_a_component() {
        let mesh = strip();
        let large = mesh.positions().iter().map(|p| p.map(|x| 1000.0 * x + 50.0));
        let positions = mesh.positions().iter().copied().chain(large).collect();
        let second = mesh.faces().iter().map(|f| f.map(|v| v + 12));
        let faces = mesh.faces().iter().copied().chain(second).collect();
        let both = TriMesh::new(positions, faces).unwrap();
        let alone = Length::MeanEdges(2.0).at_vertices(&mesh).unwrap();
        let beside = Length::MeanEdges(2.0).at_vertices(&both).unwrap();
        assert_eq!(beside[..12], alone);
        assert!((beside[20] / alone[0] - 1000.0).abs() < 1e-9);
    }

    #[test]
    fn lengths_have_units_and_limits() {
        let mesh = strip();
        let h = mesh.mean_edge_length();
        assert_eq!(Length::MeanEdges(2.0).at_vertices(&mesh), Ok(vec![2.0 * h; 12]));
        assert_eq!(Length::MeshUnits(2.0).at_vertices(&mesh), Ok(vec![2.0; 12]));
        assert!(Length::MeshUnits(-1.0).at_vertices(&mesh).is_err());
        assert!(Length::MeanEdges(f64::NAN).at_vertices(&mesh).is_err());
    }

    /// Radii in mean edges are those of the component: another one, a thousand times as large,
    /// changes nothing.
    #[test]
    fn a_larger_component_changes_no_radius() {
        use crate::curvature::Estimator;
        let torus = fairing_shapes::torus(1.0, 0.4, 40, 16);
        let n = torus.vertex_count();
        let large = torus.positions().iter().map(|p| [1e3 * p[0] + 9e3, 1e3 * p[1], 1e3 * p[2]]);
        let positions = torus.positions().iter().copied().chain(large).collect();
        let other = torus.faces().iter().map(|face| face.map(|v| v + n as u32));
        let faces = torus.faces().iter().copied().chain(other).collect();
        let both = TriMesh::new(positions, faces).unwrap();
        for (name, given) in [
            ("normal-cycle", &[][..]),
            ("corrected-ball", &[]),
            ("jet3", &[("radius", "3")]),
            ("quadric", &[("radius", "3")]),
        ] {
            let estimator = Estimator::with(name, given).unwrap();
            let alone = estimator.estimate(&torus).unwrap();
            let found = estimator.estimate(&both).unwrap();
            for v in 0..n {
                let (a, b) = (found.mean[v], alone.mean[v]);
                assert!((a - b).abs() < 1e-9 * (1.0 + b.abs()), "{name}, {v}: {a} and {b}");
            }
        }
    }
}
