//! Names of Laplacians, masses and areas of vertices.

use fairing_parameters::{Choice, Field, Kind, Parameter, ParameterError, Value, Values};

/// The kind of stiffness of a [`Laplacian`](crate::Laplacian).
///
/// Written as its name (`Display`), and read from it (`FromStr`).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum LaplacianKind {
    /// [`Cotangent`](Self::Cotangent), or [`Robust`](Self::Robust) where a face is too thin for its
    /// cotangents ([`MIN_HEIGHT_RATIO`](crate::MIN_HEIGHT_RATIO)). The default of spectra, flows,
    /// heat, Poisson problems and curvature. With any mass other than barycentric always cotangent,
    /// because the robust kind supports no other mass.
    Auto,
    /// [`Cotangent`](Self::Cotangent), or [`Robust`](Self::Robust) where a face
    /// is too thin for its cotangents or an edge that is not Delaunay has a
    /// negative weight (by more than 10⁻¹⁰ of the diagonal). The default of
    /// geodesic distances: without negative weights heat is nowhere negative.
    /// Exists with the barycentric mass only where it is robust.
    NonNegative,
    /// The graph of the edges, each with the weight 1, whatever the positions:
    /// [`combinatorial_laplacian`](crate::combinatorial_laplacian).
    Uniform,
    /// Cotangents of the faces, which refuse a face that is too thin:
    /// [`cotan_stiffness`](crate::cotan_stiffness).
    Cotangent,
    /// Cotangents of the intrinsic Delaunay triangulation of the tufted cover,
    /// on any mesh that has an edge with a length:
    /// [`robust_laplacian`](crate::intrinsic::robust_laplacian).
    Robust,
    /// Polygons, each with a virtual vertex:
    /// [`polygon_laplacian`](crate::polygon_laplacian). On triangles, the
    /// cotangent one.
    Polygon,
}

fairing_parameters::named!(LaplacianKind, "Laplacian",
    Auto: "auto",
    NonNegative: "non-negative",
    Uniform: "uniform",
    Cotangent: "cotangent",
    Robust: "robust",
    Polygon: "polygon",
);

/// The kind of mass of a [`Laplacian`](crate::Laplacian).
///
/// Written as its name (`Display`), and read from it (`FromStr`).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[non_exhaustive]
pub enum MassKind {
    /// Diagonal, a third of the area of each face:
    /// [`LumpedArea::Barycentric`]. All kinds of Laplacian have it.
    #[default]
    Barycentric,
    /// Diagonal, [`LumpedArea::Mixed`].
    Mixed,
    /// Diagonal, [`LumpedArea::Voronoi`], which may be negative.
    Voronoi,
    /// Finite elements, [`consistent_mass`](crate::consistent_mass):
    /// eigenvalues approach those of the surface from above.
    Consistent,
    /// The number of edges at the vertex, dimensionless: with the uniform
    /// stiffness, −M⁻¹S is the
    /// [random walk](crate::random_walk_laplacian).
    Degree,
    /// 1 at each vertex that has a face, dimensionless.
    Unit,
}

fairing_parameters::named!(MassKind, "mass",
    Barycentric: "barycentric",
    Mixed: "mixed",
    Voronoi: "voronoi",
    Consistent: "consistent",
    Degree: "degree",
    Unit: "unit",
);

impl MassKind {
    /// The area that it is made of, if it is a diagonal of areas.
    pub fn area(self) -> Option<LumpedArea> {
        match self {
            Self::Barycentric => Some(LumpedArea::Barycentric),
            Self::Mixed => Some(LumpedArea::Mixed),
            Self::Voronoi => Some(LumpedArea::Voronoi),
            Self::Consistent | Self::Degree | Self::Unit => None,
        }
    }
}

impl From<LumpedArea> for MassKind {
    fn from(area: LumpedArea) -> Self {
        match area {
            LumpedArea::Barycentric => Self::Barycentric,
            LumpedArea::Mixed => Self::Mixed,
            LumpedArea::Voronoi => Self::Voronoi,
        }
    }
}

impl LaplacianKind {
    /// The kinds that a program offers where weights come from cotangents.
    pub const CHOICES: [Choice; 3] = [
        Choice::new(
            "auto",
            "Cotangents, or robust if a face is too thin for cotangents; always cotangent unless \
             the areas are barycentric",
        ),
        Choice::new("cotangent", "Cotangents of the faces"),
        Choice::new("robust", "Cotangents of the intrinsic Delaunay triangulation, for any mesh"),
    ];
}

/// The kinds of cotangents, unless the field names its choices.
impl Field for LaplacianKind {
    fn parameters(&self, field: Parameter) -> Vec<Parameter> {
        let kind = match field.kind {
            Kind::Choice(_) => field.kind,
            _ => Kind::Choice(&Self::CHOICES),
        };
        vec![Parameter { kind, default: Some(Value::from(self.name())), ..field }]
    }

    fn read(&mut self, name: &'static str, values: &Values) -> Result<(), ParameterError> {
        *self = values.choice(name).unwrap_or(*self);
        Ok(())
    }
}

#[cfg(feature = "serde")]
fairing_parameters::serde_by_name!(LaplacianKind);
#[cfg(feature = "serde")]
fairing_parameters::serde_by_name!(MassKind);

/// The rule that divides the area of a face among its corners.
///
/// Written as its name (`Display`), and read from it (`FromStr`).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum LumpedArea {
    /// A third each: `Aᵢ = ⅓ Σ A`. Positive wherever a face has area, and
    /// defined on every mesh; on irregular meshes the cells ignore the shape
    /// of the faces.
    Barycentric,
    /// The part nearest to each corner, `⅛ (b² cot β + c² cot γ)` for the
    /// sides b, c that meet in the corner. The best for pointwise values;
    /// **may be negative** at obtuse angles. Source: [meyer2003].
    ///
    /// [meyer2003]: https://doi.org/10.1007/978-3-662-05105-4_2
    Voronoi,
    /// Voronoi where no angle is obtuse; else half of the area for the obtuse
    /// corner and a quarter for each of the others. Never negative.
    /// Source: [meyer2003].
    ///
    /// [meyer2003]: https://doi.org/10.1007/978-3-662-05105-4_2
    Mixed,
}

fairing_parameters::choices!(LumpedArea, "area of a vertex",
    Barycentric: "barycentric", "One third of the area of each adjacent face";
    Voronoi: "voronoi", "Voronoi cells; can be negative at obtuse angles, which flows refuse";
    Mixed: "mixed", "Voronoi cells, clipped to obtuse faces; never negative";
);
#[cfg(feature = "serde")]
fairing_parameters::serde_by_name!(LumpedArea);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::normals::NormalWeight;

    #[test]
    fn names_read_back() {
        for kind in LaplacianKind::ALL {
            assert_eq!(kind.to_string().parse(), Ok(kind));
        }
        for kind in MassKind::ALL {
            assert_eq!(kind.to_string().parse(), Ok(kind));
        }
        for area in LumpedArea::ALL {
            assert_eq!(area.to_string().parse(), Ok(area));
            assert_eq!(MassKind::from(area).name(), area.name());
        }
        for weight in NormalWeight::ALL {
            assert_eq!(weight.to_string().parse(), Ok(weight));
        }
        let error = "cotan".parse::<LaplacianKind>().unwrap_err().to_string();
        assert!(error.contains("\"cotan\"") && error.contains("uniform, cotangent"), "{error}");
        assert!("area".parse::<MassKind>().unwrap_err().to_string().contains("barycentric"));
    }
}
