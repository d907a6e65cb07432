//! Kinds of noise and their parameters.

use fairing_parameters::{ParameterError, Range};

/// The distribution of the displacements, with the meaning of the level σ.
///
/// Written as its name (`Display`), and read from it with default parameters (`FromStr`).
///
/// A correlation length is the distance at which the correlation between the displacements of
/// two vertices has fallen to 1/e.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum NoiseKind {
    /// Each coordinate by an independent Gaussian of standard deviation σ: the
    /// root mean square displacement is √3 σ.
    #[cfg_attr(feature = "serde", serde(rename = "axes"))]
    GaussianPerAxis,
    /// Along the vertex normal, by a Gaussian of standard deviation σ.
    #[cfg_attr(feature = "serde", serde(rename = "normal"))]
    GaussianAlongNormals,
    /// Along a random direction for each vertex, all directions equally likely, by a
    /// Gaussian of standard deviation σ.
    #[cfg_attr(feature = "serde", serde(rename = "direction"))]
    GaussianAlongDirections,
    /// Each coordinate by a number between −σ and σ, all equally likely: the
    /// root mean square displacement is σ.
    #[cfg_attr(feature = "serde", serde(rename = "uniform"))]
    UniformPerAxis,
    /// [`Self::GaussianAlongDirections`] of a fraction of the vertices only; the others
    /// stay.
    Impulsive {
        /// The probability that a vertex is moved, from 0 to 1.
        fraction: f64,
    },
    /// A Gaussian random field along the vertex normals, of standard deviation σ, whose correlation
    /// falls with the number d of edges between two vertices, about as exp(−d²/ℓ²), as for some
    /// scanners.
    ///
    /// The displacement of vertex v is Σ k(d) g(w) / √Σ k(d)² over the vertices w
    /// within 3/2 ℓ edges, with independent Gaussians g and k(d) = exp(−2 d²/ℓ²).
    /// Paths of edges do not pass through vertices of more than 256 neighbours,
    /// which would make all around such a vertex alike. The cost grows with ℓ².
    Correlated {
        /// The correlation length ℓ, in edges, from 0.1 to 10.
        length: f64,
    },
    /// Along the vertex normal, by a Gaussian whose standard deviation varies
    /// over the surface from σ/4 to 7σ/4, as σ (1 + ¾ sin 2πt) with t the mean of
    /// the positions in the bounding box along the axes, from 0 to 1.
    Varying,
    /// Along the ray from the camera through the vertex, by a Gaussian of standard deviation σ, as
    /// for a laser scanner.
    Rays {
        /// The position of the camera, in mesh units; `None` is three diagonals of the bounding
        /// box from its centre along +z.
        camera: Option<[f64; 3]>,
    },
    /// The noise of one view of a depth camera that projects a pattern, as the first Kinect, along
    /// the rays from the camera. The root mean square displacement is σ.
    ///
    /// The camera looks at the centre of the bounding box. A vertex at depth Z along that axis
    /// has the disparity d = F / Z, in pixels, with focal length times baseline F = f b. It is
    /// measured by matching windows of pixels, with an error ε that is a Gaussian random field
    /// along the edges (as of [`Self::Correlated`]) of standard deviation 1/16 pixel, and is
    /// rounded to 1/8 pixel:
    ///
    /// ```text
    /// Z' = F / d',    d' = ⅛ round(8 (d + ε)),    p' = c + (p − c) Z' / Z
    /// ```
    ///
    /// So the error of the depth has the standard deviation σ_Z = Z² σ_d / F, and
    /// planes turn into stairs. F follows from σ, by iteration, to a per cent or better on meshes
    /// of a thousand vertices and more; with few vertices there may be no such F, and the best
    /// that was found counts. Source: [khoshelham2012], with its 1/m = 8 steps per pixel
    /// and half a step of uncertainty.
    ///
    /// [khoshelham2012]: https://doi.org/10.3390/s120201437
    DepthCamera {
        /// The position of the camera, as of [`Self::Rays`]; all vertices are in front of it.
        camera: Option<[f64; 3]>,
        /// The correlation length of ε, in edges, from 0.1 to 10: half the window.
        length: f64,
    },
    /// The noise of many views of a depth camera fused into one surface: a random field along
    /// the vertex normals that varies slowly in space. The root mean square displacement is σ.
    ///
    /// Fusion averages the errors that differ between views; errors of registration and of
    /// calibration, and the voxels, remain. The field is
    ///
    /// ```text
    /// g(p) = √(2/N) Σ cos(w·p + φ)
    /// ```
    ///
    /// over N = 256 waves [rahimi2007], whose vectors w have the Cauchy distribution that makes
    /// the correlation fall with the distance r as exp(−r/ℓ). Waves shorter than three mean
    /// edges, which the voxels average [newcombe2011], are left out. Vertices of fused views
    /// are not points of the model: the truth of a vertex is the closest point of the surface, as
    /// [`at_closest_points`](crate::at_closest_points) finds it.
    ///
    /// [rahimi2007]: https://papers.nips.cc/paper/3182-random-features-for-large-scale-kernel-machines
    /// [newcombe2011]: https://doi.org/10.1109/ISMAR.2011.6092378
    Fused {
        /// The correlation length ℓ, in mean edge lengths, from 1 to 100.
        length: f64,
    },
}

impl NoiseKind {
    /// All kinds, with default parameters: impulsive noise on a quarter of the vertices, a
    /// correlation length of two edges, of five for a depth camera and of twenty-five for
    /// fused views.
    pub const ALL: [Self; 10] = [
        Self::GaussianAlongNormals,
        Self::GaussianPerAxis,
        Self::GaussianAlongDirections,
        Self::UniformPerAxis,
        Self::Impulsive { fraction: 0.25 },
        Self::Correlated { length: 2.0 },
        Self::Varying,
        Self::Rays { camera: None },
        Self::DepthCamera { camera: None, length: 5.0 },
        Self::Fused { length: 25.0 },
    ];

    /// The name on the command line and in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::GaussianAlongNormals => "normal",
            Self::GaussianPerAxis => "axes",
            Self::GaussianAlongDirections => "direction",
            Self::UniformPerAxis => "uniform",
            Self::Impulsive { .. } => "impulsive",
            Self::Correlated { .. } => "correlated",
            Self::Varying => "varying",
            Self::Rays { .. } => "rays",
            Self::DepthCamera { .. } => "depth-camera",
            Self::Fused { .. } => "fused",
        }
    }

    /// One-line description of the displacement.
    pub fn description(self) -> &'static str {
        match self {
            Self::GaussianAlongNormals => "Gaussian along the vertex normal",
            Self::GaussianPerAxis => "Gaussian along each axis",
            Self::GaussianAlongDirections => "Gaussian along a random direction",
            Self::UniformPerAxis => "uniform along each axis",
            Self::Impulsive { .. } => {
                "Gaussian along a random direction, on a fraction of the vertices"
            }
            Self::Correlated { .. } => {
                "Gaussian along the vertex normal, correlated over a few edges"
            }
            Self::Varying => "Gaussian along the vertex normal, its level varying over the surface",
            Self::Rays { .. } => "Gaussian along the ray from the camera",
            Self::DepthCamera { .. } => {
                "one view of a depth camera: rounded disparities, along the ray from the camera"
            }
            Self::Fused { .. } => {
                "fused views of a depth camera: waves along the vertex normal, many edges long"
            }
        }
    }

    /// The kind with this fraction; `None` if it has none.
    #[must_use]
    pub fn with_fraction(self, fraction: f64) -> Option<Self> {
        matches!(self, Self::Impulsive { .. }).then_some(Self::Impulsive { fraction })
    }

    /// The kind with this correlation length; `None` if it has none.
    #[must_use]
    pub fn with_length(self, length: f64) -> Option<Self> {
        match self {
            Self::Correlated { .. } => Some(Self::Correlated { length }),
            Self::DepthCamera { camera, .. } => Some(Self::DepthCamera { camera, length }),
            Self::Fused { .. } => Some(Self::Fused { length }),
            _ => None,
        }
    }

    /// The kind with this position of the camera; `None` if it has none.
    #[must_use]
    pub fn with_camera(self, camera: [f64; 3]) -> Option<Self> {
        let camera = Some(camera);
        match self {
            Self::Rays { .. } => Some(Self::Rays { camera }),
            Self::DepthCamera { length, .. } => Some(Self::DepthCamera { camera, length }),
            _ => None,
        }
    }

    /// Refuses parameters outside their range.
    pub(super) fn check(self) -> Result<(), ParameterError> {
        match self {
            Self::Impulsive { fraction } => Range::FRACTION.check("fraction of impulses", fraction),
            Self::Correlated { length } | Self::DepthCamera { length, .. } => {
                Range::from(0.1..=10.0).check("correlation length in edges", length)
            }
            Self::Fused { length } => {
                Range::from(1.0..=100.0).check("correlation length in mean edge lengths", length)
            }
            _ => Ok(()),
        }
    }
}

fairing_parameters::named!(NoiseKind, "kind of noise");
