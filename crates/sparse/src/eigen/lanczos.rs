//! Block Lanczos with orthogonalisation against the whole basis and thick restart.
//!
//! Every block is orthogonalised against its two predecessors, as in exact arithmetic, and then
//! against the whole basis to remove rounding errors; a second such pass follows only if the first
//! changed much. (Skipping the whole basis for two blocks of four halves the work, but the
//! components missing from T show in the residuals of S, which magnify rough errors: 10⁻⁷ was
//! measured where 10⁻⁹ was estimated.)
//!
//! Ritz residuals are those of S φ = λ M φ in the M⁻¹ norm, without forming Ritz vectors: for a
//! Ritz pair (θ, V y) of A = (S − σM)⁻¹ M, A V y − θ V y = Q z and therefore S φ − λ M φ = −(S −
//! σM) Q z / θ. Source: [grimes1994], [wu2000].
//!
//! [grimes1994]: https://doi.org/10.1137/S0895479888151111
//! [wu2000]: https://doi.org/10.1137/S0895479898334605

use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use crate::direct::backend::NoConvergence;
use crate::direct::factor::LANES;
use crate::eigen::basis::{self, Block, Small};
use crate::eigen::operator::ShiftInvert;
use crate::eigen::problem::Problem;
use crate::eigen::projected::{Projected, Ritz, ZERO};
use crate::order::larger;

/// A block is orthogonalised once more if a pass removed more than this fraction of it.
const ANOTHER_PASS: f64 = 1e-2;
/// Further passes do not help: the rest is rounding, as good as random.
const MAX_PASSES: usize = 4;
/// A column that keeps less than this fraction of its length is spent: it lies in the span of the
/// others and is replaced by a random one.
const SPENT: f64 = 1e-13;

/// A growing Krylov basis.
pub(crate) struct Lanczos<'a> {
    pub(crate) operator: &'a ShiftInvert<'a>,
    /// Known eigenvectors, to which the basis stays orthogonal.
    locked: &'a [Block],
    basis: Vec<Block>,
    projected: Projected,
    /// The next block: orthonormal, not yet in the basis.
    next: Block,
    rng: ChaCha8Rng,
    fresh_restart: bool,
}

/// A Ritz pair with an estimated residual.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Candidate {
    /// Index in the Ritz decomposition.
    pub(crate) index: usize,
    /// λ', dimensionless.
    pub(crate) lambda: f64,
    /// ‖S' φ − λ' M' φ‖ in the M'⁻¹ norm.
    pub(crate) residual: f64,
    /// ‖A φ − θ φ‖ / θ² in the M' norm: the residual after a step of inverse iteration.
    pub(crate) polished: f64,
}

impl<'a> Lanczos<'a> {
    /// Starts with random vectors.
    pub(crate) fn new(operator: &'a ShiftInvert<'a>, locked: &'a [Block], rng: ChaCha8Rng) -> Self {
        let mut lanczos = Self {
            operator,
            locked,
            basis: vec![],
            projected: Projected::default(),
            next: vec![],
            rng,
            fresh_restart: false,
        };
        lanczos.next = lanczos.random_block();
        lanczos
    }

    /// Number of vectors in the basis.
    pub(crate) fn len(&self) -> usize {
        self.projected.len()
    }

    /// Extends the basis by a block.
    pub(crate) fn extend(&mut self) {
        fairing_watch::check();
        let next = std::mem::take(&mut self.next);
        let mut w = self.operator.apply(&next);
        self.basis.push(next);
        let count = self.basis.len();
        let mut column = vec![ZERO; count];
        // After a restart the new block couples to all kept blocks.
        let near = if self.fresh_restart { 0 } else { count.saturating_sub(2) };
        self.fresh_restart = false;
        let [found] = self.operator.problem.mass_products([&self.basis[near..]], &w);
        basis::subtract(&self.basis[near..], &found, &mut w);
        column[near..].copy_from_slice(&found);
        for _ in 0..MAX_PASSES {
            if self.take_off(&mut column, &mut w) <= ANOTHER_PASS {
                break;
            }
        }
        let (q, r) = self.orthonormalise(w);
        self.next = q;
        self.projected.push(column, r);
    }

    /// W ← W − V Vᵀ M W for the whole basis and the locked vectors; adds the coefficients to
    /// `column`. Returns the largest fraction of a column that this removed.
    fn take_off(&self, column: &mut [Small], w: &mut Block) -> f64 {
        let problem = self.operator.problem;
        let length = problem.squares(w).map(f64::sqrt);
        let mut taken = [0.0; LANES];
        if problem.constants.0 > LANES {
            problem.remove_constants(w);
        }
        let [found, known] = problem.mass_products([self.basis.as_slice(), self.locked], w);
        for block in found.iter().chain(&known) {
            for row in block {
                for j in 0..LANES {
                    taken[j] += row[j] * row[j];
                }
            }
        }
        basis::subtract(&self.basis, &found, w);
        basis::subtract(self.locked, &known, w);
        for (sum, part) in column.iter_mut().zip(&found) {
            for i in 0..LANES {
                for j in 0..LANES {
                    sum[i][j] += part[i][j];
                }
            }
        }
        (0..LANES)
            .map(|j| if length[j] > 0.0 { taken[j].sqrt() / length[j] } else { 0.0 })
            .fold(0.0, larger)
    }

    /// Q and R with W = Q R, Qᵀ M Q = I, by Cholesky factors of the Gram matrix, twice. Spent
    /// columns become random and get zero rows in R.
    fn orthonormalise(&mut self, mut w: Block) -> (Block, Small) {
        let problem = self.operator.problem;
        let mut total = identity();
        for _ in 0..4 {
            let (r, spent) = cholesky(&problem.gram(&w));
            basis::transform(&mut w, &inverse_upper(&r, &spent));
            total = product(&kept(&r, &spent), &total);
            if spent.iter().any(|s| *s) {
                self.replace(&mut w, &spent);
            } else if closeness(&r) < 1e-3 {
                break;
            }
        }
        (w, total)
    }

    /// Fills the spent columns with random vectors, orthogonal to the basis and the locked vectors.
    fn replace(&mut self, w: &mut Block, spent: &[bool; LANES]) {
        for row in w.iter_mut() {
            for j in (0..LANES).filter(|&j| spent[j]) {
                row[j] = self.rng.random_range(-1.0..1.0);
            }
        }
        let mut ignored = vec![ZERO; self.basis.len()];
        for _ in 0..2 {
            self.take_off(&mut ignored, w);
        }
    }

    fn random_block(&mut self) -> Block {
        let rows = self.operator.problem.rows();
        let mut w = vec![[0.0; LANES]; rows];
        self.replace(&mut w, &[true; LANES]);
        self.orthonormalise(w).0
    }

    /// Replaces the next block by random vectors, since eigenvectors orthogonal to the starting
    /// block may be missing. Call right after [`Lanczos::restart`]; the kept vectors must have
    /// converged.
    pub(crate) fn randomise_next(&mut self) {
        self.next = self.random_block();
        self.projected.coupling.iter_mut().for_each(|c| *c = ZERO);
    }

    /// Ritz pairs of the basis with their residuals.
    pub(crate) fn ritz(&self) -> Result<(Ritz, Vec<Candidate>), NoConvergence> {
        let ritz = self.projected.solve()?;
        let operator = self.operator;
        let g = operator
            .problem
            .inverse_gram(&operator.problem.residual(&self.next, &[operator.sigma; LANES]));
        let candidates = (0..ritz.values.len())
            .map(|index| {
                let theta = ritz.values[index];
                let z = self.projected.overhang(ritz.vector(index));
                let mut square = 0.0;
                for a in 0..LANES {
                    for b in 0..LANES {
                        square += z[a] * g[a][b] * z[b];
                    }
                }
                let residual = square.max(0.0).sqrt() / theta.abs();
                let length = z.iter().map(|z| z * z).sum::<f64>().sqrt();
                let polished = length / (theta * theta);
                Candidate { index, lambda: operator.eigenvalue(theta), residual, polished }
            })
            .collect();
        Ok((ritz, candidates))
    }

    /// V y for the chosen Ritz pairs, in blocks; the last block is padded with zeros.
    pub(crate) fn vectors(&self, ritz: &Ritz, chosen: &[usize]) -> Vec<Block> {
        combined(&self.basis, ritz, chosen)
    }

    /// Replaces the basis by the chosen Ritz vectors, a multiple of eight of them, and continues.
    pub(crate) fn restart(&mut self, ritz: &Ritz, chosen: &[usize]) {
        let kept = self.vectors(ritz, chosen);
        let values: Vec<f64> = chosen.iter().map(|&i| ritz.values[i]).collect();
        let coupling = chosen
            .chunks_exact(LANES)
            .map(|chunk| {
                let mut c = ZERO;
                for (b, &index) in chunk.iter().enumerate() {
                    let z = self.projected.overhang(ritz.vector(index));
                    for a in 0..LANES {
                        c[a][b] = z[a];
                    }
                }
                c
            })
            .collect();
        self.basis = kept;
        self.projected = Projected::restarted(&values, coupling);
        self.fresh_restart = true;
    }
}

/// V y for the chosen Ritz pairs of a basis V, in blocks; the last block is padded with zeros.
pub(crate) fn combined(basis: &[Block], ritz: &Ritz, chosen: &[usize]) -> Vec<Block> {
    basis::combine(basis, chosen.len().div_ceil(LANES), |u, j| {
        let mut c = ZERO;
        for (b, &index) in chosen[j * LANES..].iter().take(LANES).enumerate() {
            let y = ritz.vector(index);
            for a in 0..LANES {
                c[a][b] = y[u * LANES + a];
            }
        }
        c
    })
}

/// M-normalised constants of the first components of the problem, in blocks.
pub(crate) fn constants(problem: &Problem, count: usize) -> Vec<Block> {
    let component = &problem.constants.1;
    let mut blocks = vec![vec![[0.0; LANES]; problem.rows()]; count.div_ceil(LANES)];
    for (row, c) in component.iter().enumerate() {
        if let Some(c) = c.filter(|c| (*c as usize) < count) {
            blocks[c as usize / LANES][row][c as usize % LANES] = 1.0;
        }
    }
    for block in &mut blocks {
        let square = problem.squares(block);
        let scale = square.map(|s| if s > 0.0 { 1.0 / s.sqrt() } else { 0.0 });
        for row in block {
            for j in 0..LANES {
                row[j] *= scale[j];
            }
        }
    }
    blocks
}

fn identity() -> Small {
    let mut c = ZERO;
    for i in 0..LANES {
        c[i][i] = 1.0;
    }
    c
}

fn product(a: &Small, b: &Small) -> Small {
    let mut c = ZERO;
    for i in 0..LANES {
        for j in 0..LANES {
            c[i][j] = (0..LANES).map(|k| a[i][k] * b[k][j]).sum();
        }
    }
    c
}

/// Upper triangular R with Rᵀ R = G, and flags of the columns that depend on earlier ones.
fn cholesky(g: &Small) -> (Small, [bool; LANES]) {
    let mut r = ZERO;
    let mut spent = [false; LANES];
    for j in 0..LANES {
        let mut pivot = g[j][j];
        for k in 0..j {
            pivot -= r[k][j] * r[k][j];
        }
        // SPENT applies to lengths, not squares; the second pass repairs the loss by squaring.
        if pivot.is_nan() || pivot <= SPENT * g[j][j] || g[j][j] <= f64::MIN_POSITIVE {
            spent[j] = true;
            continue;
        }
        r[j][j] = pivot.sqrt();
        for i in j + 1..LANES {
            let mut value = g[j][i];
            for k in 0..j {
                value -= r[k][j] * r[k][i];
            }
            r[j][i] = value / r[j][j];
        }
    }
    (r, spent)
}

/// R⁻¹ on the columns that are not spent, zero elsewhere.
fn inverse_upper(r: &Small, spent: &[bool; LANES]) -> Small {
    let mut inverse = ZERO;
    for j in (0..LANES).filter(|&j| !spent[j]) {
        inverse[j][j] = 1.0 / r[j][j];
        for i in (0..j).rev().filter(|&i| !spent[i]) {
            let sum: f64 =
                (i + 1..=j).filter(|&k| !spent[k]).map(|k| r[i][k] * inverse[k][j]).sum();
            inverse[i][j] = -sum / r[i][i];
        }
    }
    inverse
}

/// R with the rows of spent columns zero.
fn kept(r: &Small, spent: &[bool; LANES]) -> Small {
    let mut r = *r;
    for i in (0..LANES).filter(|&i| spent[i]) {
        r[i] = [0.0; LANES];
    }
    r
}

/// The largest deviation of R from the identity.
fn closeness(r: &Small) -> f64 {
    let mut worst = 0.0_f64;
    for i in 0..LANES {
        for j in 0..LANES {
            let target = if i == j { 1.0 } else { 0.0 };
            worst = worst.max((r[i][j] - target).abs());
        }
    }
    worst
}
