//! The problem made dimensionless and put in the order of its factor.

use crate::cholesky::{Cholesky, CholeskyError, SymbolicCholesky};
use crate::eigen::EigenError;
use crate::eigen::basis::{self, Block, Small, products, weighted_products};
use crate::eigen::nullspace;
use crate::factor::LANES;
use crate::ldlt::Ldlt;
use crate::mass::{Mass, combine};
use crate::matrix::{Rows, SparseMatrix};
use crate::ordering::{self, Ordering};
use crate::product;

/// S' = S / s and M' = M / m with mean diagonals 1, rows in the order of elimination.
///
/// λ = λ' · s / m; everything inside the solver is in units of λ', so that tiny and huge meshes are alike.
pub(crate) struct Problem {
    symbolic: SymbolicCholesky,
    unordered_stiffness: SparseMatrix,
    unordered_mass: UnorderedMass,
    stiffness: SparseMatrix,
    mass: OrderedMass,
    /// λ / λ'.
    pub(crate) unit: f64,
    mass_unit: f64,
    /// Number of components with constants in the null space of S, and which one each ordered row is in.
    pub(crate) constants: (usize, Vec<Option<u32>>),
}

enum UnorderedMass {
    Lumped(Vec<f64>),
    Consistent(SparseMatrix),
}

enum OrderedMass {
    Lumped(Vec<f64>),
    Consistent { matrix: SparseMatrix, factor: Cholesky },
}

impl Problem {
    pub(crate) fn new(stiffness: &SparseMatrix, mass: Mass<'_>) -> Result<Self, EigenError> {
        let n = stiffness.rows();
        mass.check(n)?;
        let mean = |d: Vec<f64>| d.iter().sum::<f64>() / n as f64;
        let stiffness_unit = match mean(Rows::of(stiffness).diagonal()) {
            d if d > 0.0 && d.is_finite() => d,
            _ => 1.0,
        };
        let mass_unit = mean(mass.diagonal());
        let scaled = |matrix: &SparseMatrix, unit: f64| matrix.map(|v| v / unit);
        let unordered_stiffness = scaled(stiffness, stiffness_unit);
        let unordered_mass = match mass {
            Mass::Lumped(d) => UnorderedMass::Lumped(d.iter().map(|m| m / mass_unit).collect()),
            Mass::Consistent(matrix) => UnorderedMass::Consistent(scaled(matrix, mass_unit)),
        };
        let pattern = combine(1.0, unordered_mass.view(), 1.0, &unordered_stiffness);
        let symbolic = SymbolicCholesky::new(&pattern, Ordering::LeastFill)
            .map_err(|source| EigenError::Factor { shift: 0.0, source })?;
        let order = symbolic.order();
        let stiffness = permuted(&unordered_stiffness, order);
        let mass = match &unordered_mass {
            UnorderedMass::Lumped(d) => {
                OrderedMass::Lumped(order.iter().map(|&row| d[row as usize]).collect())
            }
            UnorderedMass::Consistent(matrix) => {
                let matrix = permuted(matrix, order);
                let factor = Cholesky::new(&matrix).map_err(EigenError::ConsistentMass)?;
                OrderedMass::Consistent { matrix, factor }
            }
        };
        Ok(Self {
            constants: nullspace::constant_components(Rows::of(&stiffness)),
            unit: stiffness_unit / mass_unit,
            mass_unit,
            symbolic,
            unordered_stiffness,
            unordered_mass,
            stiffness,
            mass,
        })
    }

    pub(crate) fn rows(&self) -> usize {
        self.stiffness.rows()
    }

    /// `order()[k]`: the caller's row that is the k-th here.
    pub(crate) fn order(&self) -> &[u32] {
        self.symbolic.order()
    }

    /// √m: vectors with φᵀM'φ = 1 are divided by it to have φᵀMφ = 1.
    pub(crate) fn norm_unit(&self) -> f64 {
        self.mass_unit.sqrt()
    }

    /// S' − σM', positive definite.
    pub(crate) fn definite(&self, sigma: f64) -> Result<Cholesky, CholeskyError> {
        self.symbolic.factorize(&self.shifted(sigma))
    }

    /// S' − σM', indefinite.
    pub(crate) fn indefinite(&self, sigma: f64) -> Result<Ldlt, CholeskyError> {
        self.symbolic.factorize_indefinite(&self.shifted(sigma))
    }

    fn shifted(&self, sigma: f64) -> SparseMatrix {
        combine(-sigma, self.unordered_mass.view(), 1.0, &self.unordered_stiffness)
    }

    /// M' W.
    pub(crate) fn mass_times(&self, w: &[[f64; LANES]]) -> Block {
        match &self.mass {
            OrderedMass::Lumped(d) => w.iter().zip(d).map(|(w, m)| w.map(|w| w * m)).collect(),
            OrderedMass::Consistent { matrix, .. } => {
                let mut out = vec![[0.0; LANES]; w.len()];
                product::multiply_lanes(Rows::of(matrix), w, &mut out);
                out
            }
        }
    }

    /// Uᵀ M' W for every block U of each basis.
    pub(crate) fn mass_products<const N: usize>(
        &self,
        bases: [&[Block]; N],
        w: &[[f64; LANES]],
    ) -> [Vec<Small>; N] {
        match &self.mass {
            OrderedMass::Lumped(d) => bases.map(|basis| weighted_products(basis, Some(d), w)),
            OrderedMass::Consistent { .. } => {
                let mw = self.mass_times(w);
                bases.map(|basis| products(basis, &mw))
            }
        }
    }

    /// The diagonal of Wᵀ M' W.
    pub(crate) fn squares(&self, w: &Block) -> [f64; LANES] {
        match &self.mass {
            OrderedMass::Lumped(d) => basis::weighted_squares(d, w),
            OrderedMass::Consistent { .. } => {
                let gram = self.gram(w);
                std::array::from_fn(|j| gram[j][j])
            }
        }
    }

    /// Wᵀ M' W.
    pub(crate) fn gram(&self, w: &Block) -> Small {
        let [gram] = self.mass_products([std::slice::from_ref(w)], w);
        gram[0]
    }

    /// Rᵀ M'⁻¹ R.
    pub(crate) fn inverse_gram(&self, r: &Block) -> Small {
        let solved: Block = match &self.mass {
            OrderedMass::Lumped(d) => r.iter().zip(d).map(|(r, m)| r.map(|r| r / m)).collect(),
            OrderedMass::Consistent { factor, .. } => {
                let mut x = r.clone();
                let columns = x.as_flattened_mut();
                // An n × LANES array over the same numbers: the shape fits by construction.
                if let Ok(view) = ndarray::ArrayViewMut2::from_shape((r.len(), LANES), columns) {
                    factor.solve_block_in_place(view);
                }
                x
            }
        };
        products(std::slice::from_ref(r), &solved)[0]
    }

    /// S' W − M' W diag(λ').
    pub(crate) fn residual(&self, w: &Block, lambda: &[f64; LANES]) -> Block {
        let mut r = vec![[0.0; LANES]; w.len()];
        product::multiply_lanes(Rows::of(&self.stiffness), w, &mut r);
        for (r, m) in r.iter_mut().zip(self.mass_times(w)) {
            for lane in 0..LANES {
                r[lane] -= lambda[lane] * m[lane];
            }
        }
        r
    }
}

impl UnorderedMass {
    fn view(&self) -> Mass<'_> {
        match self {
            Self::Lumped(d) => Mass::Lumped(d),
            Self::Consistent(matrix) => Mass::Consistent(matrix),
        }
    }
}

/// P A Pᵀ: row k is row `order[k]` of A.
fn permuted(matrix: &SparseMatrix, order: &[u32]) -> SparseMatrix {
    let rows = Rows::of(matrix);
    // An ordering of a factorisation is a permutation.
    let inverse = ordering::invert(order).unwrap_or_default();
    let mut starts = Vec::with_capacity(order.len() + 1);
    starts.push(0);
    let (mut columns, mut values) =
        (Vec::with_capacity(rows.columns.len()), Vec::with_capacity(rows.columns.len()));
    let mut entries = vec![];
    for &row in order {
        let (row_columns, row_values) = rows.row(row as usize);
        entries.clear();
        entries.extend(row_columns.iter().zip(row_values).map(|(&j, &v)| (inverse[j as usize], v)));
        entries.sort_unstable_by_key(|e| e.0);
        columns.extend(entries.iter().map(|e| e.0));
        values.extend(entries.iter().map(|e| e.1));
        starts.push(columns.len() as u32);
    }
    SparseMatrix::new((order.len(), order.len()), starts, columns, values)
}
