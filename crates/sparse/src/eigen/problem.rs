//! The problem in dimensionless form and in the order of its factor.

use fairing_watch::parallel::for_chunks;

use crate::components;
use crate::direct::cholesky::{Cholesky, SymbolicCholesky};
use crate::direct::factor::{Factor, LANES};
use crate::direct::ldlt::Ldlt;
use crate::direct::ordering::{self, Ordering};
use crate::eigen::basis::{self, Block, Small, products, weighted_products};
use crate::error::SparseError;
use crate::mass::{Mass, combine};
use crate::matrix::{Rows, SparseMatrix};
use crate::order::larger;
use crate::product;

/// Rows per parallel task.
const ROWS_OF_TASK: usize = 1024;

/// S' = S / s and M' = M / m, rows in elimination order. s is the median of the diagonal,
/// insensitive to a few huge entries, and m the mean mass, both rounded to a power of two so that
/// the division is exact.
///
/// λ = λ' · s / m; the solver works in units of λ', independent of the scale of the mesh.
pub(crate) struct Problem {
    symbolic: SymbolicCholesky,
    unordered_stiffness: SparseMatrix,
    unordered_mass: UnorderedMass,
    stiffness: SparseMatrix,
    /// The row sums of S', exactly zero if zero up to rounding.
    excess: Vec<f64>,
    mass: OrderedMass,
    /// λ / λ'.
    pub(crate) unit: f64,
    mass_unit: f64,
    /// The median of the diagonal of S' over the mean of M': 1 but for the rounding of the units.
    pub(crate) rate: f64,
    /// Number of components whose constants are in the null space of S, and the component of each
    /// ordered row.
    pub(crate) constants: (usize, Vec<Option<u32>>),
    /// The mass M' of each of those components.
    constant_masses: Vec<f64>,
}

enum UnorderedMass {
    Lumped(Vec<f64>),
    Consistent(SparseMatrix),
}

enum OrderedMass {
    Lumped(Vec<f64>),
    Consistent { matrix: SparseMatrix, factor: Factor },
}

impl Problem {
    pub(crate) fn new(stiffness: &SparseMatrix, mass: Mass<'_>) -> Result<Self, SparseError> {
        let n = stiffness.rows();
        mass.check(n)?;
        let median = median_of_positive(Rows::new(stiffness).diagonal());
        let stiffness_unit = power_of_two(median);
        // Division before addition, since the sum of huge masses may overflow.
        let mean = mass.diagonal().iter().map(|m| m / n as f64).sum();
        let mass_unit = power_of_two(mean);
        let scaled = |matrix: &SparseMatrix, unit: f64| matrix.map(|v| v / unit);
        let unordered_stiffness = scaled(stiffness, stiffness_unit);
        let unordered_mass = match mass {
            Mass::Lumped(d) => UnorderedMass::Lumped(d.iter().map(|m| m / mass_unit).collect()),
            Mass::Consistent(matrix) => UnorderedMass::Consistent(scaled(matrix, mass_unit)),
        };
        let pattern = combine(1.0, unordered_mass.view(), 1.0, &unordered_stiffness);
        let symbolic = SymbolicCholesky::new(&pattern, Ordering::LeastFill)
            .map_err(|source| SparseError::Factor { shift: 0.0, source: Box::new(source) })?;
        let order = symbolic.order();
        let stiffness = permuted(&unordered_stiffness, order);
        let mass = match &unordered_mass {
            UnorderedMass::Lumped(d) => {
                OrderedMass::Lumped(order.iter().map(|&row| d[row as usize]).collect())
            }
            UnorderedMass::Consistent(matrix) => {
                let matrix = permuted(matrix, order);
                let factor = Cholesky::new(&matrix)
                    .map_err(|source| SparseError::ConsistentMass(Box::new(source)))?;
                OrderedMass::Consistent { matrix, factor: factor.into_factor() }
            }
        };
        let constants = components::constant_components(Rows::new(&stiffness));
        let constant_masses = component_masses(&mass, &constants);
        let excess = components::row_sums(Rows::new(&stiffness));
        Ok(Self {
            excess,
            constants,
            constant_masses,
            unit: stiffness_unit / mass_unit,
            mass_unit,
            rate: (median / stiffness_unit) / (mean / mass_unit),
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

    /// `order()[k]`: the caller's row in place k.
    pub(crate) fn order(&self) -> &[u32] {
        self.symbolic.order()
    }

    /// √m: vectors with φᵀM'φ = 1 divided by it satisfy φᵀMφ = 1.
    pub(crate) fn norm_unit(&self) -> f64 {
        self.mass_unit.sqrt()
    }

    /// S' − σM', positive definite.
    pub(crate) fn definite(&self, sigma: f64) -> Result<Cholesky, SparseError> {
        self.symbolic.factorize(&self.shifted(sigma))
    }

    /// S' − σM', indefinite.
    pub(crate) fn indefinite(&self, sigma: f64) -> Result<Ldlt, SparseError> {
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
                product::multiply_lanes(Rows::new(matrix), w, &mut out);
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
                    factor.solve_block(view);
                }
                x
            }
        };
        products(std::slice::from_ref(r), &solved)[0]
    }

    /// |S'| |W| + M' |W| diag |λ'|: the sum of the absolute terms of a residual.
    pub(crate) fn magnitude(&self, w: &Block, lambda: &[f64; LANES]) -> Block {
        let w: Block = w.iter().map(|w| w.map(f64::abs)).collect();
        let s = Rows::new(&self.stiffness);
        let mut out = self.mass_times(&w);
        for (i, out) in out.iter_mut().enumerate() {
            for lane in 0..LANES {
                out[lane] = (out[lane] * lambda[lane]).abs();
            }
            let (columns, values) = s.row(i);
            for (&j, v) in columns.iter().zip(values) {
                for lane in 0..LANES {
                    out[lane] += v.abs() * w[j as usize][lane];
                }
            }
        }
        out
    }

    /// Σ sᵢᵢ φᵢ² of each vector of a block.
    pub(crate) fn strains(&self, block: &Block) -> [f64; LANES] {
        basis::weighted_squares(&Rows::new(&self.stiffness).diagonal(), block)
    }

    /// The largest Σ sᵢᵢ φᵢ² of the vectors in these blocks.
    pub(crate) fn strain(&self, blocks: &[Block]) -> f64 {
        blocks.iter().flat_map(|block| self.strains(block)).fold(0.0, larger)
    }

    /// An upper bound of the strain of vectors of length 1 in M', for lumped masses; far above
    /// most.
    pub(crate) fn largest_strain(&self) -> f64 {
        let masses = self.unordered_mass.view().diagonal();
        let diagonal = Rows::new(&self.unordered_stiffness).diagonal();
        // A consistent mass is at least a quarter of its diagonal.
        diagonal.iter().zip(masses).map(|(s, m)| 4.0 * s.abs() / m).fold(0.0, larger)
    }

    /// Removes the constants of all components from a block.
    pub(crate) fn remove_constants(&self, w: &mut Block) {
        let (count, component) = &self.constants;
        let mw = self.mass_times(w);
        let mut sums = vec![[0.0; LANES]; *count];
        for (c, mw) in component.iter().zip(&mw) {
            if let Some(c) = c {
                for lane in 0..LANES {
                    sums[*c as usize][lane] += mw[lane];
                }
            }
        }
        for (w, c) in w.iter_mut().zip(component) {
            if let Some(c) = c {
                let (sum, mass) = (&sums[*c as usize], self.constant_masses[*c as usize]);
                for lane in 0..LANES {
                    w[lane] -= sum[lane] / mass;
                }
            }
        }
    }

    /// S' W − M' W diag(λ'), from differences: (S φ)ᵢ = Σⱼ sᵢⱼ (φⱼ − φᵢ) + eᵢ φᵢ with the row
    /// sum eᵢ, exactly zero for a Laplacian. The stored diagonal has lost everything below its
    /// last digit.
    pub(crate) fn residual(&self, w: &Block, lambda: &[f64; LANES]) -> Block {
        let rows = Rows::new(&self.stiffness);
        let mut r = self.mass_times(w);
        for_chunks(&mut r, ROWS_OF_TASK, |start, r| {
            for (i, r) in (start..).zip(r) {
                let (own, excess) = (w[i], self.excess[i]);
                let mut sum = own.map(|own| excess * own);
                let (columns, values) = rows.row(i);
                for (&j, &v) in columns.iter().zip(values).filter(|(j, _)| **j as usize != i) {
                    let other = &w[j as usize];
                    for lane in 0..LANES {
                        sum[lane] += v * (other[lane] - own[lane]);
                    }
                }
                for lane in 0..LANES {
                    r[lane] = sum[lane] - lambda[lane] * r[lane];
                }
            }
        });
        r
    }
}

/// 1ᵀ M' 1 over each component with constants.
fn component_masses(mass: &OrderedMass, constants: &(usize, Vec<Option<u32>>)) -> Vec<f64> {
    let ones;
    let row_masses = match mass {
        OrderedMass::Lumped(d) => d,
        OrderedMass::Consistent { matrix, .. } => {
            ones = product::multiply(matrix, &vec![1.0; matrix.rows()]);
            &ones
        }
    };
    let mut masses = vec![0.0; constants.0];
    for (c, m) in constants.1.iter().zip(row_masses) {
        if let Some(c) = c {
            masses[*c as usize] += m;
        }
    }
    masses
}

/// The median of the positive entries; 1 without positive entries.
fn median_of_positive(mut values: Vec<f64>) -> f64 {
    values.retain(|v| *v > 0.0 && v.is_finite());
    if values.is_empty() {
        return 1.0;
    }
    let middle = values.len() / 2;
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}

/// The nearest power of two, kept away from both ends of the range of floats.
fn power_of_two(value: f64) -> f64 {
    libm::exp2(libm::log2(value).round().clamp(-1000.0, 1000.0))
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
    let rows = Rows::new(matrix);
    // The ordering of a factorisation is a permutation.
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
