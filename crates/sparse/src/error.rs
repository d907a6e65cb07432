//! Errors of sparse matrices, linear systems and eigenproblems.

/// The error of a matrix, a linear system or an eigenproblem.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SparseError {
    /// The offsets are not one more than rows, do not ascend from zero, or do not end with the
    /// number of entries.
    #[error(
        "offset {place} is {found}: offsets ascend from 0 to the number of entries, one more than rows"
    )]
    Offsets {
        /// The first offset that is wrong.
        place: usize,
        /// Its value; 0 if it is missing.
        found: u32,
    },
    /// There are more or fewer values of a matrix than columns.
    #[error("{found} values for {expected} columns")]
    Columns {
        /// The number of values.
        found: usize,
        /// The number of columns.
        expected: usize,
    },
    /// An entry outside of the matrix.
    #[error("row {row}, column {column} is outside of a {} × {} matrix", shape.0, shape.1)]
    Outside {
        /// Its row.
        row: usize,
        /// Its column.
        column: u32,
        /// The rows and columns of the matrix.
        shape: (usize, usize),
    },
    /// Columns of a row that do not ascend, or one that comes twice.
    #[error("column {column} of row {row} does not come after the one before it")]
    Order {
        /// The row.
        row: usize,
        /// The column.
        column: u32,
    },
    /// More entries than 32-bit indices can number.
    #[error("{entries} entries are more than 32-bit indices can number")]
    TooManyEntries {
        /// The number of entries.
        entries: usize,
    },
    /// The sizes of a mass and a stiffness matrix differ.
    #[error("the mass has {mass} rows, the stiffness {stiffness}")]
    MassSize {
        /// Rows of the mass matrix.
        mass: usize,
        /// Rows of the stiffness matrix.
        stiffness: usize,
    },
    /// A diagonal entry of a mass is zero, negative, infinite or NaN.
    #[error("mass {value:e} of row {row} is not positive and finite")]
    MassNotPositive {
        /// The row.
        row: usize,
        /// Its diagonal entry.
        value: f64,
    },
    /// A matrix to factorise is not square.
    #[error("the matrix is {rows} × {columns}, not square")]
    NotSquare {
        /// Its rows.
        rows: usize,
        /// Its columns.
        columns: usize,
    },
    /// An entry is infinite or NaN.
    #[error("entry ({row}, {column}) is {value}")]
    NotFinite {
        /// Row of the entry.
        row: usize,
        /// Column of the entry.
        column: usize,
        /// The entry.
        value: f64,
    },
    /// An entry differs from its mirror image, or one of the two is not stored.
    #[error("entry ({row}, {column}) differs from its mirror image by {difference:e}")]
    NotSymmetric {
        /// Row of the entry.
        row: usize,
        /// Column of the entry.
        column: usize,
        /// Entry minus mirror image.
        difference: f64,
    },
    /// A custom ordering is not a permutation of the rows.
    #[error(
        "the ordering is no permutation of the rows: {length} entries for {rows} rows, row \
         {entry} repeated or out of range"
    )]
    NotAnOrdering {
        /// Length of the ordering.
        length: usize,
        /// The number of rows of the matrix.
        rows: usize,
        /// The first entry that is out of range or repeated.
        entry: u32,
    },
    /// The pattern of the matrix differs from the analysed one.
    #[error("row {row} has a different pattern than in the analysed matrix")]
    PatternChanged {
        /// The first row that differs.
        row: usize,
    },
    /// A pivot is negligible relative to the diagonal of its row: the matrix is singular to working
    /// precision.
    #[error(
        "the matrix is singular: pivot {pivot:e} in row {row}, where the diagonal is {diagonal:e}"
    )]
    Singular {
        /// The row, in the order of the matrix.
        row: usize,
        /// The pivot: its diagonal entry after elimination.
        pivot: f64,
        /// Its diagonal entry.
        diagonal: f64,
    },
    /// A pivot is negative: the matrix has a negative eigenvalue.
    #[error(
        "the matrix is not positive definite: pivot {pivot:e} in row {row}, where the diagonal is {diagonal:e}"
    )]
    Indefinite {
        /// The row, in the order of the matrix.
        row: usize,
        /// The pivot: its diagonal entry after elimination.
        pivot: f64,
        /// Its diagonal entry.
        diagonal: f64,
    },
    /// Rounding leaves fewer than half of the digits of a solution.
    #[error(
        "the system is too ill-conditioned (condition about {condition:.0e}): fewer than \
         half of the digits of its solution would be correct"
    )]
    IllConditioned {
        /// An estimate of the condition of the matrix scaled to a unit diagonal.
        condition: f64,
    },
    /// Not enough memory, or more than 2³² entries in the factor.
    #[error("the factor of {rows} rows is too large for memory or for 32-bit indices")]
    TooLarge {
        /// The number of rows of the matrix.
        rows: usize,
    },
    /// A search direction p has pᵀ A p ≤ 0: the matrix is not positive definite.
    #[error("the matrix is not positive definite: pᵀAp = {curvature:e} in iteration {iteration}")]
    NegativeCurvature {
        /// The iteration.
        iteration: usize,
        /// pᵀ A p.
        curvature: f64,
    },
    /// A solution did not reach the tolerance.
    #[error(
        "no convergence: relative residual {residual:e} after {iterations} iterations, largest in row {row}"
    )]
    NotConverged {
        /// Iterations taken.
        iterations: usize,
        /// The largest relative residual.
        residual: f64,
        /// The row with the largest residual.
        row: usize,
    },
    /// More eigenpairs were requested than there are rows.
    #[error("{wanted} eigenpairs were requested, but the matrix has {rows} rows")]
    TooManyPairs {
        /// Eigenpairs wanted.
        wanted: usize,
        /// Rows of the problem.
        rows: usize,
    },
    /// S − σM could not be factorised. A negative or zero pivot means that S is not positive
    /// semi-definite.
    #[error("S − σM with σ = {shift:e} cannot be factorised")]
    Factor {
        /// σ, in units of λ.
        shift: f64,
        /// The error of the factorisation.
        source: Box<SparseError>,
    },
    /// The consistent mass is not positive definite.
    #[error("the consistent mass is not positive definite")]
    ConsistentMass(#[source] Box<SparseError>),
    /// Fewer eigenpairs converged than were wanted.
    #[error("{converged} of {wanted} eigenpairs converged within {blocks} blocks")]
    PairsNotConverged {
        /// Pairs that met the tolerance.
        converged: usize,
        /// Pairs wanted.
        wanted: usize,
        /// Blocks spent.
        blocks: usize,
    },
    /// No gap after the wanted eigenvalues is wide enough for an inertia count, so their
    /// completeness cannot be verified, as on a mesh of thousands of equal spikes.
    #[error(
        "eigenvalue {wanted}, {value:e}, and those that follow differ by less than 0.011 %: they \
         cannot be told apart"
    )]
    Crowded {
        /// Pairs wanted.
        wanted: usize,
        /// The last of them.
        value: f64,
    },
    /// The inertia count differs from the number of eigenvalues found, even after new starting
    /// vectors.
    #[error("{found} eigenvalues found below {shift:e}, inertia counts {counted}")]
    Miscounted {
        /// Eigenvalues found.
        found: usize,
        /// Eigenvalues counted.
        counted: usize,
        /// The shift of the count, in units of λ.
        shift: f64,
    },
    /// The dense decomposition did not converge.
    #[error("the dense decomposition of {rows} rows did not converge")]
    Dense {
        /// Rows of the problem.
        rows: usize,
    },
}
