//! Which vertices an estimator looks at.

use fairing_mesh::vec3::distance;
use fairing_mesh::{OptionError, Topology, TriMesh};

use crate::error::OperatorError;

/// A length, in the unit that suits.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum Length {
    /// In mesh units.
    MeshUnits(f64),
    /// In mean edge lengths of the mesh.
    MeanEdges(f64),
}

impl Length {
    /// In mesh units.
    ///
    /// # Errors
    ///
    /// [`OperatorError::Option`] if it is negative or not finite.
    pub fn on(self, mesh: &TriMesh) -> Result<f64, OperatorError> {
        let (value, unit) = match self {
            Self::MeshUnits(value) => (value, 1.0),
            Self::MeanEdges(value) => (value, mesh.mean_edge_length()),
        };
        OptionError::require_not_negative("radius", value)?;
        Ok(value * unit)
    }
}

/// The vertices around a vertex that a fit takes.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum Neighborhood {
    /// All within this number of edges.
    Rings(u32),
    /// All that a path of edges reaches without leaving the ball of this
    /// radius.
    Ball(Length),
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
        reach: Reach,
        at_least: usize,
    ) {
        self.reached_for.resize(mesh.vertex_count(), 0);
        self.found.clear();
        self.found.push(v);
        self.reached_for[v as usize] = v + 1;
        let mut start = 0;
        match reach {
            Reach::Rings(count) => {
                for _ in 0..count {
                    start = self.grow(topology, start, |_| true);
                }
            }
            Reach::Radius(radius) => {
                let (positions, centre) = (mesh.positions(), mesh.positions()[v as usize]);
                while start < self.found.len() {
                    start = self.grow(topology, start, |w| {
                        distance(positions[w as usize], centre) <= radius
                    });
                }
                // Those turned away lie next to any of the others.
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
            for &w in topology.neighbors(self.found[i]) {
                if self.reached_for[w as usize] != mark && take(w) {
                    self.reached_for[w as usize] = mark;
                    self.found.push(w);
                }
            }
        }
        end
    }
}

/// A neighbourhood in mesh units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Reach {
    Rings(u32),
    Radius(f64),
}

impl Reach {
    /// That in a mesh divided by `unit`.
    pub(crate) fn divided_by(self, unit: f64) -> Self {
        match self {
            Self::Radius(radius) => Self::Radius(radius / unit),
            rings => rings,
        }
    }
}

impl Neighborhood {
    pub(crate) fn reach(self, mesh: &TriMesh) -> Result<Reach, OperatorError> {
        Ok(match self {
            Self::Rings(count) => Reach::Rings(count),
            Self::Ball(radius) => Reach::Radius(radius.on(mesh)?),
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
        explorer.explore(&mesh, mesh.topology(), 7, reach, 0);
        explorer.explore(&mesh, mesh.topology(), 0, reach, at_least);
        explorer.found.sort_unstable();
        explorer.found
    }

    #[test]
    fn rings_and_balls() {
        assert_eq!(found(Reach::Rings(0), 0), [0]);
        assert_eq!(found(Reach::Rings(1), 0), [0, 1, 2]);
        assert_eq!(found(Reach::Rings(2), 0), [0, 1, 2, 3, 4]);
        assert_eq!(found(Reach::Radius(1.0), 0), [0, 1, 2]);
        assert_eq!(found(Reach::Radius(1.5), 0), [0, 1, 2, 3]);
    }

    #[test]
    fn too_few_widen_until_there_are_enough_or_no_more() {
        assert_eq!(found(Reach::Rings(1), 3), [0, 1, 2, 3, 4]);
        assert_eq!(found(Reach::Radius(0.1), 2), [0, 1, 2]);
        assert_eq!(found(Reach::Radius(1.5), 4), [0, 1, 2, 3, 4, 5]);
        assert_eq!(found(Reach::Rings(1), 99).len(), 12);
    }

    #[test]
    fn lengths_have_units_and_limits() {
        let mesh = strip();
        let h = mesh.mean_edge_length();
        assert_eq!(Length::MeanEdges(2.0).on(&mesh), Ok(2.0 * h));
        assert_eq!(Length::MeshUnits(2.0).on(&mesh), Ok(2.0));
        assert!(Length::MeshUnits(-1.0).on(&mesh).is_err());
        assert!(Length::MeanEdges(f64::NAN).on(&mesh).is_err());
    }
}
