//! All estimators under one name.

use fairing_mesh::TriMesh;

use super::corrected::{CorrectedOptions, corrected_curvature};
use super::cotangent::{CotangentOptions, cotangent_curvature};
use super::face_tensor::{FaceTensorOptions, face_tensor_curvature};
use super::field::CurvatureField;
use super::jet::{JetDegree, JetOptions, JetWeight, jet_curvature};
use super::neighborhood::{Length, Neighborhood};
use super::normal_cycle::{NormalCycleOptions, normal_cycle_curvature};
use super::quadric::{QuadricOptions, quadric_curvature};
use super::steiner::steiner_curvature;
use crate::error::OperatorError;
use crate::mass::LumpedArea;
use crate::normals::NormalWeight;

/// A method to estimate curvature, with its options.
///
/// Written as its name (`Display`) and read from it with the options of
/// [`Estimator::ALL`] (`FromStr`).
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Estimator {
    /// [`cotangent_curvature`]
    Cotangent(CotangentOptions),
    /// [`steiner_curvature`]
    Steiner,
    /// [`normal_cycle_curvature`]
    NormalCycle(NormalCycleOptions),
    /// [`corrected_curvature`]
    Corrected(CorrectedOptions),
    /// [`face_tensor_curvature`]
    FaceTensor(FaceTensorOptions),
    /// [`quadric_curvature`]
    Quadric(QuadricOptions),
    /// [`jet_curvature`]
    Jet(JetOptions),
}

impl Estimator {
    /// One of each, with the options they are known by.
    pub const ALL: [Self; 10] = [
        Self::Cotangent(CotangentOptions { area: LumpedArea::Mixed }),
        Self::Steiner,
        Self::NormalCycle(NormalCycleOptions { radius: Length::MeanEdges(2.0) }),
        Self::Corrected(CorrectedOptions { normals: NormalWeight::Sphere, radius: None }),
        Self::Corrected(CorrectedOptions {
            normals: NormalWeight::Sphere,
            radius: Some(Length::MeanEdges(2.0)),
        }),
        Self::FaceTensor(FaceTensorOptions { normals: NormalWeight::Sphere }),
        Self::Quadric(QuadricOptions { neighborhood: Neighborhood::Rings(2) }),
        jet(JetDegree::Two, 2),
        jet(JetDegree::Three, 3),
        jet(JetDegree::Four, 4),
    ];

    /// The estimator to take where nothing is known about the mesh: cubic
    /// jets over three rings, which converge on irregular meshes.
    pub const RECOMMENDED: Self = jet(JetDegree::Three, 3);

    /// The name on the command line and in tables.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Cotangent(_) => "cotangent",
            Self::Steiner => "steiner",
            Self::NormalCycle(_) => "normal-cycle",
            Self::Corrected(CorrectedOptions { radius: None, .. }) => "corrected",
            Self::Corrected(_) => "corrected-ball",
            Self::FaceTensor(_) => "face-tensor",
            Self::Quadric(_) => "quadric",
            Self::Jet(options) => match options.degree {
                JetDegree::Two => "jet2",
                JetDegree::Three => "jet3",
                JetDegree::Four => "jet4",
            },
        }
    }

    /// What it is for, in a line.
    pub fn purpose(&self) -> &'static str {
        match self {
            Self::Cotangent(_) => {
                "H and K of regular meshes, and integrals on any: the cheapest; no directions"
            }
            Self::Steiner => "bending at creases, from dihedral angles; any mesh, however broken",
            Self::NormalCycle(_) => {
                "curvature at a chosen scale, averaged over a ball; steady under noise"
            }
            Self::Corrected(CorrectedOptions { radius: None, .. }) => {
                "principal curvatures of smooth shapes at the cost of one ring"
            }
            Self::Corrected(_) => "smooth shapes with uneven or noisy triangles, at a chosen scale",
            Self::FaceTensor(_) => "shading and line drawing: smooth and cheap; close to corrected",
            Self::Quadric(_) => "clean meshes of even quality, two rings; as in libigl",
            Self::Jet(options) => match options.degree {
                JetDegree::Two => "noisy smooth shapes, where few coefficients resist noise",
                JetDegree::Three => {
                    "the recommended one: converges on irregular meshes of smooth shapes"
                }
                JetDegree::Four => "the most accurate on fine clean meshes of smooth shapes",
            },
        }
    }

    /// Its source, a key of `docs/bibliography.bib`.
    pub fn source(&self) -> &'static str {
        match self {
            Self::Cotangent(_) => "meyer2003",
            Self::Steiner => "sullivan2008",
            Self::NormalCycle(_) => "cohensteiner2003",
            Self::Corrected(_) => "lachaud2020",
            Self::FaceTensor(_) => "rusinkiewicz2004",
            Self::Quadric(_) => "panozzo2010",
            Self::Jet(_) => "cazals2005",
        }
    }

    /// Whether it finds principal directions.
    pub fn has_directions(&self) -> bool {
        !matches!(self, Self::Cotangent(_))
    }

    /// Estimates curvature at every vertex; never NaN, undefined vertices are
    /// flagged.
    ///
    /// # Errors
    ///
    /// [`OperatorError::Option`] for an option out of its range;
    /// [`OperatorError::NoLength`] for the cotangent estimator on a mesh whose
    /// vertices are all in one place.
    pub fn estimate(&self, mesh: &TriMesh) -> Result<CurvatureField, OperatorError> {
        match *self {
            Self::Cotangent(options) => cotangent_curvature(mesh, options),
            Self::Steiner => Ok(steiner_curvature(mesh)),
            Self::NormalCycle(options) => normal_cycle_curvature(mesh, options),
            Self::Corrected(options) => corrected_curvature(mesh, options),
            Self::FaceTensor(options) => Ok(face_tensor_curvature(mesh, options)),
            Self::Quadric(options) => quadric_curvature(mesh, options),
            Self::Jet(options) => jet_curvature(mesh, options),
        }
    }
}

const fn jet(degree: JetDegree, rings: u32) -> Estimator {
    Estimator::Jet(JetOptions {
        degree,
        neighborhood: Neighborhood::Rings(rings),
        weight: JetWeight::Uniform,
    })
}

fairing_mesh::named!(Estimator, "estimator");

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_unique_and_read_back() {
        for (i, estimator) in Estimator::ALL.iter().enumerate() {
            assert_eq!(estimator.to_string().parse(), Ok(*estimator));
            assert!(Estimator::ALL[..i].iter().all(|e| e.name() != estimator.name()));
        }
        let error = "cotan".parse::<Estimator>().unwrap_err();
        assert!(error.to_string().contains("corrected-ball, face-tensor"));
        assert!(Estimator::ALL.contains(&Estimator::RECOMMENDED));
    }
}
