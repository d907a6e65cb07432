//! Shares of the vertices in the areas of faces.

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
