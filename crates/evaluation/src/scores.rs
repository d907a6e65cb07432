//! All scores of a mesh against a reference, with names and units.

use std::fmt;

use fairing_mesh::TriMesh;
use fairing_parameters::Range;

use crate::distance::{self, SurfaceDistance, VertexDisplacement, tree, vertex_displacement};
use crate::drift::{Drift, drift, flipped_faces};
use crate::error::EvaluationError;
use crate::features::{FeatureEdges, feature_edges};
use crate::hausdorff::{self, Hausdorff};
use crate::intersections::self_intersections;
use crate::normal_error::{NormalAngles, curvature_error, normal_error};

/// Settings of the scores.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
pub struct ScoreOptions {
    /// The width of the interval around the Hausdorff distance, as a fraction of
    /// the reference's bounding-box diagonal; at least the rounding of the
    /// coordinates, as in [`hausdorff`](crate::hausdorff()).
    pub hausdorff_tolerance: f64,
    /// The smallest dihedral angle of a feature edge, in degrees.
    pub feature_angle: f64,
}

impl Default for ScoreOptions {
    fn default() -> Self {
        Self { hausdorff_tolerance: 1e-4, feature_angle: 30.0 }
    }
}

/// The scores of a mesh against a reference. Scores that compare element by
/// element are errors if the faces differ.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Scores {
    /// The diagonal of the reference's bounding box, in mesh units.
    pub diagonal: f64,
    /// E_a: angles between the normals of matching faces.
    pub normals: Result<NormalAngles, EvaluationError>,
    /// E_v and its reverse: distances between vertices and surfaces.
    pub distance: SurfaceDistance,
    /// The Hausdorff distance over all points of both surfaces.
    pub hausdorff: Hausdorff,
    /// Distances between matching vertices.
    pub displacement: Result<VertexDisplacement, EvaluationError>,
    /// Changes of volume, area and edge length.
    pub drift: Drift,
    /// Faces turned by more than a right angle.
    pub flipped_faces: Result<usize, EvaluationError>,
    /// Pairs of faces of the mesh that pass through each other.
    pub self_intersections: usize,
    /// Sharp edges found and missed.
    pub features: Result<FeatureEdges, EvaluationError>,
    /// The relative error of mean curvature; `None` for a flat reference.
    pub curvature: Result<Option<f64>, EvaluationError>,
}

/// The unit of a score.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum ScoreUnit {
    /// Degrees.
    Degrees,
    /// Shares of the reference's bounding-box diagonal.
    Diagonals,
    /// Relative to the reference, or a fraction from 0 to 1.
    Relative,
    /// A number of elements.
    Count,
    /// Decibels.
    Decibels,
}

impl fmt::Display for ScoreUnit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Degrees => "°",
            Self::Diagonals => "diagonal",
            Self::Relative => "relative",
            Self::Count => "count",
            Self::Decibels => "dB",
        })
    }
}

/// A score with its name and unit; if it is undefined, the reason.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct Score {
    /// A name for machines, in lower case with underscores.
    pub name: &'static str,
    /// A name to display, with spaces.
    pub label: &'static str,
    /// The unit of the value.
    pub unit: ScoreUnit,
    /// The value, or the reason for its absence.
    pub value: Result<f64, String>,
}

impl Scores {
    /// Computes all scores.
    ///
    /// # Errors
    ///
    /// [`EvaluationError::NoFaces`] or [`EvaluationError::NoVertices`] where
    /// there is nothing to compare; [`EvaluationError::Option`] for an
    /// option that is not positive and finite, or an angle of 180° or more.
    pub fn new(
        mesh: &TriMesh,
        reference: &TriMesh,
        options: &ScoreOptions,
    ) -> Result<Self, EvaluationError> {
        Range::POSITIVE.check("Hausdorff tolerance", options.hausdorff_tolerance)?;
        let (own, other) = (tree(mesh, "mesh")?, tree(reference, "reference")?);
        let diagonal = reference.diagonal();
        // A reference of one point has no diagonal to take a fraction of.
        let unit = if diagonal > 0.0 { diagonal } else { 1.0 };
        let features = feature_edges(mesh, reference, options.feature_angle);
        if let Err(error @ EvaluationError::Option(_)) = features {
            return Err(error);
        }
        let tolerance = options.hausdorff_tolerance * unit;
        let displacement = vertex_displacement(mesh, reference);
        Ok(Self {
            diagonal,
            normals: normal_error(mesh, reference),
            distance: distance::between(mesh, &own, reference, &other)?,
            hausdorff: hausdorff::between(mesh, &own, reference, &other, tolerance),
            displacement,
            drift: drift(mesh, reference),
            flipped_faces: flipped_faces(mesh, reference),
            self_intersections: self_intersections(mesh),
            features,
            curvature: curvature_error(mesh, reference),
        })
    }

    /// The peak signal-to-noise ratio in decibels,
    ///
    /// ```text
    /// 20 log₁₀(diagonal / root mean square displacement)
    /// ```
    ///
    /// `None` where vertices do not correspond or nothing moved.
    pub fn psnr(&self) -> Option<f64> {
        let rms = self.displacement.as_ref().ok()?.rms;
        Some(20.0 * libm::log10(self.diagonal / rms)).filter(|x| x.is_finite())
    }

    /// All scores, in the order of the table; always the same names.
    pub fn entries(&self) -> Vec<Score> {
        let mut entries = self.normal_entries();
        entries.extend(self.distance_entries());
        entries.extend(self.displacement_entries());
        entries.extend(self.drift_entries());
        entries.extend(self.defect_entries());
        entries
    }

    fn normal_entries(&self) -> Vec<Score> {
        let angle = |f: fn(&NormalAngles) -> f64| measured(&self.normals, f);
        let entry = |name, label, value| Score { name, label, unit: ScoreUnit::Degrees, value };
        vec![
            entry("normal_mean", "normal angle, mean", angle(|n| n.mean)),
            entry("normal_area_weighted", "normal angle, by area", angle(|n| n.area_weighted)),
            entry("normal_max", "normal angle, largest", angle(|n| n.max)),
        ]
    }

    fn distance_entries(&self) -> Vec<Score> {
        let entry = |name, label, length: f64| Score {
            name,
            label,
            unit: ScoreUnit::Diagonals,
            value: self.in_diagonals(length),
        };
        let (d, b) = (&self.distance.forward, &self.distance.backward);
        vec![
            entry("distance_mean", "vertices to reference, mean", d.mean),
            entry("distance_rms", "vertices to reference, RMS", d.rms),
            entry("distance_max", "vertices to reference, largest", d.max),
            entry("reverse_mean", "reference's vertices to mesh, mean", b.mean),
            entry("reverse_rms", "reference's vertices to mesh, RMS", b.rms),
            entry("reverse_max", "reference's vertices to mesh, largest", b.max),
            entry("chamfer", "Chamfer, sum of both means", self.distance.chamfer()),
            entry("hausdorff_lower", "Hausdorff, at least", self.hausdorff.lower),
            entry("hausdorff_upper", "Hausdorff, at most", self.hausdorff.upper),
        ]
    }

    fn displacement_entries(&self) -> Vec<Score> {
        let moved = &self.displacement;
        let entry = |name, label, unit, value| Score { name, label, unit, value };
        let length = |f: fn(&VertexDisplacement) -> f64| {
            measured(moved, f).and_then(|x| self.in_diagonals(x))
        };
        let psnr = match moved {
            Ok(_) => some(self.psnr(), "no vertex moved"),
            Err(error) => Err(error.to_string()),
        };
        let diagonals = ScoreUnit::Diagonals;
        vec![
            entry("displacement_rms", "matching vertices, RMS", diagonals, length(|m| m.rms)),
            entry("displacement_max", "matching vertices, largest", diagonals, length(|m| m.max)),
            entry("psnr", "peak signal to noise", ScoreUnit::Decibels, psnr),
        ]
    }

    fn drift_entries(&self) -> Vec<Score> {
        let entry = |name, label, change, reason| Score {
            name,
            label,
            unit: ScoreUnit::Relative,
            value: some(change, reason),
        };
        let no_volume = "not closed and consistently oriented, or the reference has no volume";
        let Drift { volume, area, edge_length, .. } = self.drift;
        vec![
            entry("volume_drift", "change of volume", volume, no_volume),
            entry("area_drift", "change of area", area, "the reference has no area"),
            entry(
                "edge_length_drift",
                "change of mean edge length",
                edge_length,
                "the reference has no edges",
            ),
        ]
    }

    fn defect_entries(&self) -> Vec<Score> {
        let count = |name, label, value| Score { name, label, unit: ScoreUnit::Count, value };
        let relative = |name, label, value| Score { name, label, unit: ScoreUnit::Relative, value };
        let ratio = |f: fn(&FeatureEdges) -> Option<f64>, reason: &str| match &self.features {
            Ok(edges) => some(f(edges), reason),
            Err(error) => Err(error.to_string()),
        };
        let curvature = match &self.curvature {
            Ok(error) => some(*error, "the reference is flat"),
            Err(error) => Err(error.to_string()),
        };
        let precision = ratio(FeatureEdges::precision, "the mesh has no sharp edge");
        let recall = ratio(FeatureEdges::recall, "the reference has no sharp edge");
        let crossings = Ok(self.self_intersections as f64);
        vec![
            count("flipped_faces", "flipped faces", measured(&self.flipped_faces, |&n| n as f64)),
            count("self_intersections", "crossing pairs of faces", crossings),
            relative("feature_precision", "sharp edges, precision", precision),
            relative("feature_recall", "sharp edges, recall", recall),
            relative("curvature_error", "mean curvature, relative error", curvature),
        ]
    }

    /// A length in diagonals of the reference.
    fn in_diagonals(&self, length: f64) -> Result<f64, String> {
        match length / self.diagonal {
            x if x.is_finite() => Ok(x),
            _ => Err("the reference has no extent".to_owned()),
        }
    }
}

/// A number of one group of scores, or the reason why the group is undefined.
fn measured<T>(part: &Result<T, EvaluationError>, f: impl Fn(&T) -> f64) -> Result<f64, String> {
    part.as_ref().map(f).map_err(ToString::to_string)
}

fn some(x: Option<f64>, reason: &str) -> Result<f64, String> {
    x.ok_or_else(|| reason.to_owned())
}

/// A table of label, value and unit, one line per score; a dash and the reason
/// for an undefined one.
impl fmt::Display for Scores {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for Score { label, unit, value, .. } in self.entries() {
            match value {
                Ok(count) if unit == ScoreUnit::Count => writeln!(f, "{label:<38} {count:>12}")?,
                Ok(x) if x != 0.0 && x.abs() < 1e-3 => {
                    writeln!(f, "{label:<38} {x:>12.4e} {unit}")?
                }
                Ok(x) => writeln!(f, "{label:<38} {x:>12.5} {unit}")?,
                Err(reason) => writeln!(f, "{label:<38} {:>12} {reason}", "–")?,
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use fairing_shapes as shapes;

    use super::*;

    /// A hundredth of the diagonal is 40 dB.
    #[test]
    fn the_ratio_of_amplitudes_is_in_decibels() {
        let sphere = shapes::icosphere(1);
        let shift = 0.01 * sphere.diagonal();
        let moved = sphere.positions().iter().map(|&[x, y, z]| [x + shift, y, z]).collect();
        let moved = sphere.with_positions(moved).unwrap();
        let scores = Scores::new(&moved, &sphere, &ScoreOptions::default()).unwrap();
        assert!((scores.psnr().unwrap() - 40.0).abs() < 1e-9, "{:?}", scores.psnr());
    }
}
