//! Kinds of noise.

/// The relation between the noise of neighbouring vertices.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum NoiseKind {
    /// Independent from vertex to vertex.
    Independent,
    /// Similar at neighbours, as in the waves of a scanner: the mesh looks smooth, and small radii
    /// agree with each other but not with large ones. All radii are then used, and the error is the
    /// difference from the next larger radius.
    Correlated,
}

fairing_parameters::choices!(NoiseKind, "kind of noise",
    Independent: "independent", "Independent from vertex to vertex";
    Correlated: "correlated", "Similar at neighbours, as the waves of some scanners";
);
#[cfg(feature = "serde")]
fairing_parameters::serde_by_name!(NoiseKind);
