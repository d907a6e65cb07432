//! Parameters of tasks that are not families of algorithms.

use anyhow::Result;
use fairing::task::Unit;
use fairing_evaluation::NoiseKind;
use fairing_operators::LaplacianKind;
use fairing_parameters::{Algorithm, Choice, Options, Range, Value, Values, choices, options};

use crate::request::Request;

options! {
    /// Parameters of `spectrum` and `reconstruct`.
    #[derive(Debug, Clone, PartialEq)]
    pub struct SpectrumTask {
        /// The number of modes.
        pub k: usize = 50, in Range::from(1.0..=2000.0);
        /// The Laplacian.
        pub operator: LaplacianKind = LaplacianKind::Auto, among &OPERATORS;
        /// The condition at the boundary.
        pub boundary: BoundaryCondition = BoundaryCondition::Neumann;
    }
    "spectrum": "the smallest eigenvalues and modes of the Laplacian", ["vallet2008"];
    "reconstruct": "the mesh from its smoothest modes", ["taubin1995", "vallet2008"],
        without ["boundary"], with Self::DEFAULT, if |_| false;
}

/// The Laplacians of a spectrum: those of cotangents, and the uniform one.
const OPERATORS: [Choice; 4] = {
    let [auto, cotangent, robust] = LaplacianKind::CHOICES;
    let uniform = Choice::new("uniform", "The graph of the edges, whatever the positions");
    [auto, cotangent, robust, uniform]
};

/// The condition at the boundary.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BoundaryCondition {
    /// No flux.
    Neumann,
    /// Zero.
    Dirichlet,
}

choices!(BoundaryCondition, "boundary condition",
    Neumann: "neumann", "no flux: the boundary is free";
    Dirichlet: "dirichlet", "zero at the boundary";
);

options! {
    /// Parameters of `distance`.
    #[derive(Debug, Clone, PartialEq)]
    pub struct DistanceOptions {
        /// The vertices from which distances are measured.
        pub sources: Vec<u32> = Vec::new(), required true;
        /// The stiffness of the Laplacian.
        pub operator: LaplacianKind = LaplacianKind::NonNegative;
    }
    "distance": "geodesic distance by the heat method", ["crane2013"];
}

options! {
    /// Parameters of `repair`; every other step is taken.
    #[derive(Debug, Clone, PartialEq)]
    pub struct RepairTask {
        /// The distance up to which vertices are merged; zero merges those that differ by rounding.
        pub tolerance: f64 = 0.0, in Range::FRACTION, unit "mean edge lengths";
        /// The number of faces below which a component is dropped.
        pub components: usize = 0;
        /// The height below which faces are collapsed or flipped, as a fraction of their longest
        /// edge; 0.002 removes slivers.
        pub thin: f64 = 0.0, in Range::from(0.0..=0.1);
        /// The number of edges up to which holes are filled.
        pub holes: usize = 0, in Range::from(0.0..=2000.0);
    }
    "repair": "merges vertices, drops doubled faces, turns faces to agree, fills holes", [];
}

options! {
    /// Parameters of `compare`.
    #[derive(Debug, Clone, PartialEq)]
    pub struct CompareOptions {
        /// The largest gap between the two bounds of the Hausdorff distance.
        pub hausdorff_tolerance: f64 = 1e-3, in Range::NOT_NEGATIVE, unit "diagonals";
        /// The smallest dihedral angle of a sharp edge.
        pub feature_angle: f64 = 30.0, in Range::from(0.0..=180.0), unit "degrees";
    }
    "compare": "distances, angles between normals, changes of volume and area", [];
}

options! {
    /// Parameters of `noise`, whose methods are the kinds of noise.
    #[derive(Debug, Clone, PartialEq)]
    pub struct NoiseOptions {
        /// The standard deviation of the displacement.
        pub sigma: f64 = 0.3, in Range::NOT_NEGATIVE;
        /// The unit of sigma.
        pub unit: Unit = Unit::Edge;
        /// The fraction of vertices that are moved.
        pub fraction: f64 = 0.25, in Range::FRACTION;
        /// The distance at which the correlation has fallen to 1/e.
        pub length: f64 = 2.0, in Range::from(0.1..=100.0), unit "mean edge lengths";
        /// The seed of the random numbers.
        pub seed: u32 = 1;
    }
    "noise": "noise with a seed", [];
}

impl NoiseOptions {
    /// The kinds of noise as algorithms.
    pub(crate) fn algorithms() -> Vec<Algorithm> {
        NoiseKind::ALL.into_iter().map(Self::algorithm).collect()
    }

    fn algorithm(kind: NoiseKind) -> Algorithm {
        let mut algorithm = Self::DEFAULT.entry().algorithm();
        (algorithm.name, algorithm.description) = (kind.name(), kind.description());
        algorithm.parameters.retain(|parameter| match parameter.name {
            "fraction" => kind.with_fraction(0.5).is_some(),
            "length" => kind.with_length(2.0).is_some(),
            _ => true,
        });
        let length = match kind {
            NoiseKind::Correlated { length }
            | NoiseKind::DepthCamera { length, .. }
            | NoiseKind::Fused { length } => length,
            _ => Self::DEFAULT.length,
        };
        for parameter in algorithm.parameters.iter_mut().filter(|p| p.name == "length") {
            parameter.default = Some(Value::Number(length));
        }
        algorithm
    }

    /// The kind of that name, and the values of a request.
    pub(crate) fn of(name: &str, request: &Request<'_>) -> Result<(NoiseKind, Self)> {
        let kind: NoiseKind = name.parse()?;
        let values = Values::new(&Self::algorithm(kind), &request.values()?)?;
        let mut options = Self::DEFAULT;
        options.read(&values)?;
        let kind = values.number("fraction").and_then(|f| kind.with_fraction(f)).unwrap_or(kind);
        let kind = values.number("length").and_then(|l| kind.with_length(l)).unwrap_or(kind);
        Ok((kind, options))
    }
}
