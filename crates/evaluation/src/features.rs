//! Sharp edges found, missed and false.

use fairing_mesh::TriMesh;
use fairing_parameters::ParameterError;
use glam::DVec3;

use crate::correspondence::in_one_winding;
use crate::error::EvaluationError;

/// Counts of sharp edges that a mesh shares with a reference.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct FeatureEdges {
    /// Edges that are sharp in both.
    pub shared: usize,
    /// Edges that are sharp in the mesh.
    pub found: usize,
    /// Edges that are sharp in the reference.
    pub expected: usize,
}

impl FeatureEdges {
    /// The share of the mesh's sharp edges that are sharp in the reference;
    /// `None` if the mesh has none.
    pub fn precision(&self) -> Option<f64> {
        (self.found > 0).then(|| self.shared as f64 / self.found as f64)
    }

    /// The share of the reference's sharp edges that are sharp in the mesh;
    /// `None` if the reference has none.
    pub fn recall(&self) -> Option<f64> {
        (self.expected > 0).then(|| self.shared as f64 / self.expected as f64)
    }

    /// The F-score, the harmonic mean of precision and recall: 1 where both have the same sharp
    /// edges, 0 where none is shared. Unlike recall, it falls where noise makes further edges
    /// sharp. `None` if the reference has none.
    pub fn f_score(&self) -> Option<f64> {
        let both = (self.found + self.expected) as f64;
        (self.expected > 0).then(|| 2.0 * self.shared as f64 / both)
    }
}

/// Compares, edge by edge, the edges with a dihedral angle of at least
/// `degrees`. Boundary edges, non-manifold edges and edges of a face without
/// area have no dihedral angle and are not counted.
///
/// # Errors
///
/// [`EvaluationError::NoCorrespondence`] unless both have the same faces,
/// [`EvaluationError::Option`] unless 0 < `degrees` < 180.
pub fn feature_edges(
    mesh: &TriMesh,
    reference: &TriMesh,
    degrees: f64,
) -> Result<FeatureEdges, EvaluationError> {
    let (mesh, reference) = in_one_winding(mesh, reference)?;
    let between = degrees > 0.0 && degrees < 180.0;
    ParameterError::require(between, "feature angle", degrees, "above 0 and below 180 degrees")?;
    let topology = mesh.topology();
    let mut edges = FeatureEdges { shared: 0, found: 0, expected: 0 };
    for e in 0..topology.edges().len() as u32 {
        let [f, g] = *topology.edge_faces(e) else { continue };
        let sharp = |mesh: &TriMesh| {
            // Unit vectors: products of areas are fourth powers of lengths.
            let [m, n] = [f, g].map(|f| DVec3::from(mesh.area_vector(f as usize)).try_normalize());
            let turn =
                |(m, n): (DVec3, DVec3)| libm::atan2(m.cross(n).length(), m.dot(n)).to_degrees();
            m.zip(n).map(turn).is_some_and(|angle| angle >= degrees)
        };
        let (found, expected) = (sharp(&mesh), sharp(&reference));
        edges.found += usize::from(found);
        edges.expected += usize::from(expected);
        edges.shared += usize::from(found && expected);
    }
    Ok(edges)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn precision_is_of_the_found_and_recall_of_the_expected() {
        let edges = FeatureEdges { shared: 1, found: 2, expected: 4 };
        assert_eq!((edges.precision(), edges.recall()), (Some(0.5), Some(0.25)));
        let none = FeatureEdges { shared: 0, found: 0, expected: 0 };
        assert_eq!((none.precision(), none.recall()), (None, None));
    }

    /// Recall alone calls a mesh all of whose edges are sharp perfect.
    #[test]
    fn the_f_score_falls_where_too_many_edges_are_sharp() {
        let edges = FeatureEdges { shared: 1, found: 2, expected: 4 };
        let (precision, recall) = (0.5, 0.25);
        let harmonic = 2.0 / (1.0 / precision + 1.0 / recall);
        assert!((edges.f_score().unwrap() - harmonic).abs() < 1e-15);
        let exploded = FeatureEdges { shared: 10, found: 990, expected: 10 };
        assert_eq!((exploded.recall(), exploded.f_score()), (Some(1.0), Some(0.02)));
        let lost = FeatureEdges { shared: 0, found: 0, expected: 4 };
        let none = FeatureEdges { shared: 0, found: 3, expected: 0 };
        assert_eq!((lost.f_score(), none.f_score()), (Some(0.0), None));
    }
}
