//! The Laplacian of a mesh: a stiffness and a mass, each of one kind.
//!
//! ```text
//! S u integrated,    M⁻¹ S u ≈ −Δu pointwise,    S φ = ω M φ
//! ```
//!
//! Spectra, heat, geodesic distance, Poisson problems and mean curvature take a [`Laplacian`] by
//! reference. The matrices are assembled by [`cotan_stiffness`](crate::cotan_stiffness),
//! [`combinatorial_laplacian`], [`robust_laplacian`], [`polygon_laplacian`],
//! [`lumped_mass`](crate::lumped_mass) and [`consistent_mass`](crate::consistent_mass).
//!
//! An isolated vertex has a zero row in the stiffness and the mass zero.
//! [`Laplacian::positive_mass`] is for systems that need a positive mass there, and
//! [`Laplacian::restricted`] omits such vertices.

mod choice;
mod mass;
mod pattern;
mod refill;
mod restricted;

use std::borrow::Cow;

use fairing_mesh::{PolygonMesh, TriMesh};
use fairing_sparse::{SparseMatrix, combine, multiply};

use crate::error::OperatorError;
use crate::intrinsic::{IntrinsicFaces, RobustLaplacian, robust_laplacian};
use crate::kind::{LaplacianKind, MassKind};
use crate::polygon::{PolygonLaplacian, polygon_laplacian};
use crate::stiffness;
use crate::stiffness::combinatorial_laplacian;

use choice::Choice;
pub use choice::{Reason, choose};
pub use mass::{MassMatrix, positive_lumped_mass};
pub use pattern::{CotangentPattern, ThinFaces};
pub use restricted::Restricted;

/// Stiffness S and mass M of one mesh.
///
/// S is `n × n` for `n` vertices, rows in vertex order, symmetric, positive
/// semi-definite, with zero row sums, dimensionless. M is in squared mesh
/// units. Boundaries are natural (zero flux). Both are zero at isolated
/// vertices.
///
/// # Examples
///
/// ```
/// use fairing_shapes as shapes;
/// use fairing_operators::{Laplacian, LaplacianKind, MassKind};
///
/// // On the unit sphere −Δz = 2z; mixed areas are the best for pointwise values.
/// let sphere = shapes::icosphere(4);
/// let laplacian = Laplacian::new(&sphere, LaplacianKind::Auto, MassKind::Mixed)?;
/// assert_eq!(laplacian.kind(), LaplacianKind::Cotangent);
/// let z: Vec<f64> = sphere.positions().iter().map(|p| p[2]).collect();
/// for (found, z) in laplacian.pointwise(&z)?.iter().zip(&z) {
///     assert!((found - 2.0 * z).abs() < 0.02);
/// }
/// # Ok::<(), fairing_operators::OperatorError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Laplacian {
    asked: LaplacianKind,
    kind: LaplacianKind,
    reason: Reason,
    mass_kind: MassKind,
    stiffness: SparseMatrix,
    mass: MassMatrix,
    isolated: Vec<u32>,
    intrinsic: Option<Intrinsic>,
}

/// The triangulation behind a robust [`Laplacian`].
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Intrinsic {
    /// The triangles.
    pub faces: IntrinsicFaces,
    /// The most that mollification added to a length, in mesh units.
    pub added_length: f64,
    /// The number of triangles of the cover with a lengthened side.
    pub mollified: usize,
    /// The number of flips, over both sides of the cover.
    pub flips: usize,
    /// The number of edges left non-Delaunay, because flipping them would have made
    /// a triangle without area: zero except for extreme lengths.
    pub stuck: usize,
}

impl Laplacian {
    /// The Laplacian of a kind with a mass of a kind.
    ///
    /// # Errors
    ///
    /// [`OperatorError::DegenerateFace`] for the first face too thin for its
    /// cotangents, with [`LaplacianKind::Cotangent`] and
    /// [`LaplacianKind::Polygon`], and for one too thin for its share of the
    /// mass; [`OperatorError::NoLength`] with the robust kind, if no edge has
    /// a length; [`OperatorError::NoSuchMass`] for the robust kind, or
    /// [`LaplacianKind::NonNegative`] where it takes the robust kind, with a
    /// mass that is not barycentric; [`OperatorError::TooLarge`] beyond 2³²
    /// entries.
    pub fn new(mesh: &TriMesh, kind: LaplacianKind, mass: MassKind) -> Result<Self, OperatorError> {
        Self::assemble(mesh, kind, mass, None)
    }

    /// [`Laplacian::new`], on the patterns of one of the same faces, kind and
    /// mass if there is one.
    fn assemble(
        mesh: &TriMesh,
        kind: LaplacianKind,
        mass: MassKind,
        like: Option<&Self>,
    ) -> Result<Self, OperatorError> {
        let cotangents = || {
            let like = like.filter(|like| like.kind == LaplacianKind::Cotangent);
            stiffness::on_pattern(mesh, like.map(Self::stiffness))
        };
        let Choice { kind: taken, reason, stiffness } =
            choice::resolve(mesh, kind, mass, cotangents)?;
        let stiffness = match (taken, stiffness) {
            (LaplacianKind::Robust, _) => return Self::robust_of(mesh, kind, reason, mass),
            (LaplacianKind::Uniform, _) => combinatorial_laplacian(mesh)?,
            (_, Some(stiffness)) => stiffness,
            (_, None) => cotangents()?,
        };
        Ok(Self {
            asked: kind,
            kind: taken,
            reason,
            mass_kind: mass,
            stiffness,
            mass: mass::assemble(mesh, mass, like.map(Self::mass))?,
            isolated: isolated(mesh),
            intrinsic: None,
        })
    }

    /// [`LaplacianKind::Auto`] with the barycentric mass: the choice for unknown meshes.
    ///
    /// # Errors
    ///
    /// As [`Laplacian::new`].
    pub fn auto(mesh: &TriMesh) -> Result<Self, OperatorError> {
        Self::new(mesh, LaplacianKind::Auto, MassKind::Barycentric)
    }

    /// [`LaplacianKind::Cotangent`] with the barycentric mass.
    ///
    /// # Errors
    ///
    /// As [`Laplacian::new`].
    pub fn cotangent(mesh: &TriMesh) -> Result<Self, OperatorError> {
        Self::new(mesh, LaplacianKind::Cotangent, MassKind::Barycentric)
    }

    /// [`LaplacianKind::Robust`], with its barycentric mass.
    ///
    /// # Errors
    ///
    /// As [`Laplacian::new`].
    pub fn robust(mesh: &TriMesh) -> Result<Self, OperatorError> {
        Self::new(mesh, LaplacianKind::Robust, MassKind::Barycentric)
    }

    /// The Laplacian of a polygon mesh, [`LaplacianKind::Polygon`], with the
    /// consistent or the barycentric mass (its row sums).
    ///
    /// # Errors
    ///
    /// [`OperatorError::DegenerateFace`] for the first polygon whose fan has a
    /// triangle too thin for its cotangents; [`OperatorError::NoSuchMass`] for
    /// another mass; [`OperatorError::TooLarge`] beyond 2³² entries.
    pub fn from_polygons(mesh: &PolygonMesh, mass: MassKind) -> Result<Self, OperatorError> {
        let kind = LaplacianKind::Polygon;
        if !matches!(mass, MassKind::Barycentric | MassKind::Consistent) {
            return Err(mass::refused(kind, mass));
        }
        let PolygonLaplacian { stiffness, mass: matrix, lumped_mass } = polygon_laplacian(mesh)?;
        let mut isolated = vec![true; mesh.vertex_count()];
        for &v in mesh.polygons().flatten() {
            isolated[v as usize] = false;
        }
        Ok(Self {
            asked: kind,
            kind,
            reason: Reason::Asked,
            mass_kind: mass,
            stiffness,
            mass: match mass {
                MassKind::Consistent => MassMatrix::Consistent(matrix),
                _ => MassMatrix::Lumped(lumped_mass),
            },
            isolated: (0..isolated.len() as u32).filter(|&v| isolated[v as usize]).collect(),
            intrinsic: None,
        })
    }

    fn robust_of(
        mesh: &TriMesh,
        asked: LaplacianKind,
        reason: Reason,
        mass_kind: MassKind,
    ) -> Result<Self, OperatorError> {
        let kind = LaplacianKind::Robust;
        if mass_kind != MassKind::Barycentric {
            return Err(mass::refused(kind, mass_kind));
        }
        let RobustLaplacian { stiffness, mass, added_length, mollified, flips, stuck, faces } =
            robust_laplacian(mesh)?;
        Ok(Self {
            asked,
            kind,
            reason,
            mass_kind,
            stiffness,
            mass: MassMatrix::Lumped(mass),
            isolated: isolated(mesh),
            intrinsic: Some(Intrinsic { faces, added_length, mollified, flips, stuck }),
        })
    }

    /// The kind chosen, never [`LaplacianKind::Auto`] or [`LaplacianKind::NonNegative`].
    pub fn kind(&self) -> LaplacianKind {
        self.kind
    }

    /// The reason for the kind.
    pub fn reason(&self) -> Reason {
        self.reason
    }

    /// The kind of the mass.
    pub fn mass_kind(&self) -> MassKind {
        self.mass_kind
    }

    /// The triangles of the robust kind, with counts of mollified and flipped edges; `None` for
    /// other kinds.
    pub fn intrinsic(&self) -> Option<&Intrinsic> {
        self.intrinsic.as_ref()
    }

    /// The number of vertices n.
    pub fn vertex_count(&self) -> usize {
        self.stiffness.rows()
    }

    /// S.
    pub fn stiffness(&self) -> &SparseMatrix {
        &self.stiffness
    }

    /// M; zero at isolated vertices.
    pub fn mass(&self) -> &MassMatrix {
        &self.mass
    }

    /// The mass with a positive number at isolated vertices too: the mean of
    /// the masses of all vertices (1 where all are zero).
    ///
    /// Rows of the stiffness and masses are zero at isolated vertices, so that they add nothing to
    /// an area, an integral or a mode. A system `M + tS` needs a positive number in their rows. Any
    /// number is correct, because the row has no other entry and the value does not change; the
    /// mean does not worsen the condition of the system.
    ///
    /// # Errors
    ///
    /// [`OperatorError::Mass`] for the first vertex with faces whose mass is
    /// not positive.
    pub fn positive_mass(&self) -> Result<Cow<'_, MassMatrix>, OperatorError> {
        self.mass.positive(&self.isolated)
    }

    /// The vertices without faces, ascending.
    pub fn isolated(&self) -> &[u32] {
        &self.isolated
    }

    /// Consumes the Laplacian; returns stiffness and mass.
    pub fn into_parts(self) -> (SparseMatrix, MassMatrix) {
        (self.stiffness, self.mass)
    }

    /// `S u`, integrated: minus the integral of Δu over the cell of each
    /// vertex, in the unit of u.
    ///
    /// # Errors
    ///
    /// [`OperatorError::Length`].
    pub fn apply(&self, u: &[f64]) -> Result<Vec<f64>, OperatorError> {
        self.check_length(u.len())?;
        Ok(multiply(&self.stiffness, u))
    }

    /// `M⁻¹ S u`, pointwise: −Δu at each vertex, in the unit of u over squared
    /// mesh units; zero at isolated vertices. A consistent mass counts by its
    /// row sums.
    ///
    /// # Errors
    ///
    /// [`OperatorError::Length`]; [`OperatorError::Mass`] for the first vertex
    /// with faces whose mass is not positive.
    pub fn pointwise(&self, u: &[f64]) -> Result<Vec<f64>, OperatorError> {
        let mut image = self.apply(u)?;
        let lumped = self.mass.lumped();
        let mut isolated = self.isolated.iter().peekable();
        for (v, (value, &mass)) in image.iter_mut().zip(&*lumped).enumerate() {
            let vertex = v as u32;
            if isolated.next_if_eq(&&vertex).is_none() {
                mass::positive(vertex, mass)?;
                *value /= mass;
            }
        }
        Ok(image)
    }

    /// `M + tS`, for a time t in squared mesh units, with
    /// [`positive_mass`](Self::positive_mass) for M: the matrix of one
    /// implicit step of heat. Positive definite for t ≥ 0.
    ///
    /// # Errors
    ///
    /// [`OperatorError::Mass`] for the first vertex with faces whose mass is
    /// not positive.
    pub fn shifted(&self, time: f64) -> Result<SparseMatrix, OperatorError> {
        let mass = self.positive_mass()?;
        Ok(combine(1.0, mass.as_mass(), time, &self.stiffness))
    }

    fn check_length(&self, found: usize) -> Result<(), OperatorError> {
        let expected = self.vertex_count();
        if found == expected { Ok(()) } else { Err(OperatorError::Length { found, expected }) }
    }
}

/// The vertices without faces, ascending.
fn isolated(mesh: &TriMesh) -> Vec<u32> {
    let pairs = mesh.incidence().offsets().windows(2).enumerate();
    pairs.filter(|(_, w)| w[0] == w[1]).map(|(v, _)| v as u32).collect()
}

#[cfg(test)]
mod tests;
