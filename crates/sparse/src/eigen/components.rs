//! Disconnected problems: each component is solved separately and the spectra are merged.
//!
//! Weyl's law estimates from its mass how many pairs each component contributes. After a first
//! merge, an inertia count just above the last value finds the components with further pairs, and
//! their number. Components whose blocks of S and M are equal bit by bit are solved once. An
//! eigenvalue shared by copies is a multiple eigenvalue of the whole problem, partly invisible to a
//! Krylov space of the whole, but an ordinary one in each copy.

use std::collections::HashMap;
use std::hash::{DefaultHasher, Hasher};

use ndarray::Array2;

use crate::components::components;
use crate::eigen::certificate::count_in_gap;
use crate::eigen::problem::Problem;
use crate::eigen::{Beyond, EigenOptions, EigenPairs};
use crate::eigen::{nullspace, solve};
use crate::error::SparseError;
use crate::mass::Mass;
use crate::matrix::{self, Rows, SparseMatrix};
use crate::order::smaller;

/// Relative distance of the count above the last value of the merge: large enough for a reliable
/// count, small enough that few extra pairs are computed.
const MARGIN: f64 = 0.04;

/// The `count` smallest eigenpairs of S φ = λ M φ.
///
/// S must be symmetric positive semi-definite, M positive definite. Cost for k pairs: one
/// factorisation of S − σM, another for the inertia count, and about 2 to 3 k solves, each
/// orthogonalised against as many vectors; beyond [`EigenOptions::slice`] pairs the cost grows
/// linearly.
///
/// # Errors
///
/// [`SparseError`], including a mass that is not positive, with its row, and
/// [`SparseError::PairsNotConverged`], with the number of pairs that met the tolerance.
///
/// # Examples
///
/// ```
/// use fairing_sparse::{EigenOptions, Mass, SparseMatrix, smallest_eigenpairs};
/// // A path of two vertices: eigenvalues 0 and 2.
/// let s = SparseMatrix::new((2, 2), vec![0, 2, 4], vec![0, 1, 0, 1], vec![1.0, -1.0, -1.0, 1.0]);
/// let pairs = smallest_eigenpairs(&s, Mass::Lumped(&[1.0, 1.0]), 2, &EigenOptions::default())?;
/// assert_eq!(pairs.values[0], 0.0);
/// assert!((pairs.values[1] - 2.0).abs() < 1e-14);
/// # Ok::<(), fairing_sparse::SparseError>(())
/// ```
#[doc(alias("eigs", "eigsh"))]
pub fn smallest_eigenpairs(
    stiffness: &SparseMatrix,
    mass: Mass<'_>,
    count: usize,
    options: &EigenOptions,
) -> Result<EigenPairs, SparseError> {
    let rows = stiffness.rows();
    if count > rows {
        return Err(SparseError::TooManyPairs { wanted: count, rows });
    }
    mass.check(rows)?;
    if count == 0 {
        return Ok(EigenPairs::none(rows));
    }
    fairing_watch::stage("modes", count as u64);
    match parts(stiffness, mass) {
        Some(parts) => smallest(parts, rows, count, options),
        None => solve::connected(stiffness, mass, count, options),
    }
}

/// A component, or several equal ones.
struct Part {
    /// The rows of each copy in the whole problem, ascending.
    copies: Vec<Vec<u32>>,
    stiffness: SparseMatrix,
    mass: PartMass,
    /// The known part of its spectrum.
    pairs: EigenPairs,
}

#[derive(PartialEq)]
enum PartMass {
    Lumped(Vec<f64>),
    Consistent(SparseMatrix),
}

/// A pair in the merge.
#[derive(Debug, Clone, Copy)]
struct Chosen {
    value: f64,
    part: usize,
    copy: usize,
    index: usize,
}

/// The components of S and M together; `None` if there is only one.
fn parts(stiffness: &SparseMatrix, mass: Mass<'_>) -> Option<Vec<Part>> {
    let groups = groups(stiffness, mass);
    if groups.len() < 2 {
        return None;
    }
    let mut parts: Vec<Part> = vec![];
    let mut known: HashMap<u64, Vec<usize>> = HashMap::new();
    let mut places = vec![(0, 0); stiffness.rows()];
    for (group, rows) in groups.iter().enumerate() {
        for (local, &row) in rows.iter().enumerate() {
            places[row as usize] = (group as u32, local as u32);
        }
    }
    for rows in groups {
        let part = Part::new(stiffness, mass, rows, &places);
        let alike = known.entry(part.hash()).or_default();
        let equal = |&&i: &&usize| {
            let other: &Part = &parts[i];
            other.stiffness == part.stiffness && other.mass == part.mass
        };
        match alike.iter().find(equal) {
            Some(&i) => parts[i].copies.extend(part.copies),
            None => {
                alike.push(parts.len());
                parts.push(part);
            }
        }
    }
    Some(parts)
}

/// The `count` smallest eigenpairs of all parts together.
fn smallest(
    mut parts: Vec<Part>,
    rows: usize,
    count: usize,
    options: &EigenOptions,
) -> Result<EigenPairs, SparseError> {
    let total: f64 = parts.iter().map(|p| p.copies.len() as f64 * p.mass.view().total()).sum();
    let share = |part: &Part, pairs: usize| {
        (pairs as f64 * (part.mass.view().total() / total)).round() as usize
    };
    let constants: Vec<usize> = parts
        .iter()
        .map(|part| nullspace::constant_components(Rows::new(&part.stiffness)).0)
        .collect();
    let zeros: usize = parts.iter().zip(&constants).map(|(p, c)| p.copies.len() * c).sum();
    for (part, constants) in parts.iter_mut().zip(constants) {
        let wanted = constants + share(part, count.saturating_sub(zeros));
        part.solve(wanted, options)?;
    }
    loop {
        match last_of_merge(&parts, count) {
            // Too few are known: continue with the part that may have the next one.
            None => {
                let known: usize = parts.iter().map(|p| p.copies.len() * p.known()).sum();
                let open = parts.iter_mut().filter(|p| p.known() < p.stiffness.rows());
                let lowest =
                    |a: &&mut Part, b: &&mut Part| a.clear_below().total_cmp(&b.clear_below());
                let Some(part) = open.min_by(lowest) else { break };
                let wanted = part.known() + share(part, count - known).max(1);
                part.solve(wanted, options)?;
            }
            Some(last) => {
                let mut complete = true;
                for part in parts.iter_mut().filter(|p| !p.is_complete_to(last)) {
                    complete = false;
                    part.complete_to(last, options)?;
                }
                if complete {
                    break;
                }
            }
        }
    }
    // These pairs meet only the tolerance of an eigenvalue beyond the merge.
    let limit = options.residual_limit(last_of_merge(&parts, count).unwrap_or(0.0));
    let used = used(&parts, count);
    for (part, used) in parts.iter_mut().zip(used) {
        let residuals = &part.pairs.residuals;
        if used < residuals.len() && residuals[..used].iter().any(|r| *r > limit) {
            part.solve(used, options)?;
        }
    }
    // Only values are known. Another solve changes them by rounding, and maybe the merge.
    loop {
        let mut complete = true;
        let used = self::used(&parts, count);
        for (part, used) in parts.iter_mut().zip(used) {
            if used > part.pairs.values.len() {
                complete = false;
                part.solve(used, options)?;
            }
        }
        if complete {
            break;
        }
    }
    Ok(assemble(&parts, rows, count))
}

/// The first `count` pairs of all parts, ascending, in the caller's rows.
fn assemble(parts: &[Part], rows: usize, count: usize) -> EigenPairs {
    let mut merged = merge(parts, usize::MAX);
    let clear_below = parts.iter().map(Part::clear_below).fold(f64::INFINITY, smaller);
    // Pairs known by value only come after all wanted pairs.
    let following = merged.split_off(count.min(merged.len()));
    let mut vectors = Array2::zeros((rows, merged.len()));
    for (j, chosen) in merged.iter().enumerate() {
        let part = &parts[chosen.part];
        for (local, &row) in part.copies[chosen.copy].iter().enumerate() {
            vectors[[row as usize, j]] = part.pairs.vectors[[local, chosen.index]];
        }
    }
    EigenPairs {
        values: merged.iter().map(|c| c.value).collect(),
        vectors,
        residuals: merged.iter().map(|c| parts[c.part].pairs.residuals[c.index]).collect(),
        certified: parts.iter().all(|p| p.pairs.certified),
        beyond: Beyond {
            values: following
                .iter()
                .map(|c| c.value)
                .filter(|v| *v < clear_below || *v == 0.0)
                .collect(),
            clear_below,
        },
    }
}

/// The known values of all copies, ascending; equal values in the order of their components.
fn merge(parts: &[Part], count: usize) -> Vec<Chosen> {
    let mut all = vec![];
    for (p, part) in parts.iter().enumerate() {
        for copy in 0..part.copies.len() {
            let values = part.pairs.values.iter().chain(&part.pairs.beyond.values).enumerate();
            all.extend(values.map(|(index, &value)| Chosen { value, part: p, copy, index }));
        }
    }
    let first_row = |c: &Chosen| parts[c.part].copies[c.copy][0];
    all.sort_by(|a, b| {
        let rows = || first_row(a).cmp(&first_row(b));
        a.value.total_cmp(&b.value).then_with(rows).then(a.index.cmp(&b.index))
    });
    all.truncate(count);
    all
}

/// The number of values that each part has among the `count` smallest.
fn used(parts: &[Part], count: usize) -> Vec<usize> {
    let mut used = vec![0; parts.len()];
    for chosen in merge(parts, count) {
        used[chosen.part] = used[chosen.part].max(chosen.index + 1);
    }
    used
}

/// The `count`-th smallest known value, if there are as many.
fn last_of_merge(parts: &[Part], count: usize) -> Option<f64> {
    let known = |part: &Part| {
        let mut values = part.pairs.values.clone();
        values.extend(&part.pairs.beyond.values);
        std::iter::repeat_n(values, part.copies.len()).flatten().collect::<Vec<f64>>()
    };
    let mut values: Vec<f64> = parts.iter().flat_map(known).collect();
    let index = count.checked_sub(1).filter(|i| *i < values.len())?;
    Some(*values.select_nth_unstable_by(index, f64::total_cmp).1)
}

impl Part {
    fn new(
        stiffness: &SparseMatrix,
        mass: Mass<'_>,
        rows: Vec<u32>,
        places: &[(u32, u32)],
    ) -> Self {
        let part_mass = match mass {
            Mass::Lumped(d) => PartMass::Lumped(rows.iter().map(|&r| d[r as usize]).collect()),
            Mass::Consistent(matrix) => PartMass::Consistent(block(matrix, &rows, places)),
        };
        Self {
            stiffness: block(stiffness, &rows, places),
            mass: part_mass,
            pairs: EigenPairs::none(rows.len()),
            copies: vec![rows],
        }
    }

    /// Hash, equal for equal blocks.
    fn hash(&self) -> u64 {
        let mut hasher = DefaultHasher::new();
        let mut add = |matrix: &SparseMatrix| {
            let rows = Rows::new(matrix);
            rows.columns.iter().for_each(|&c| hasher.write_u32(c));
            rows.values.iter().for_each(|v| hasher.write_u64(v.to_bits()));
        };
        add(&self.stiffness);
        if let PartMass::Consistent(matrix) = &self.mass {
            add(matrix);
        }
        if let PartMass::Lumped(d) = &self.mass {
            d.iter().for_each(|m| hasher.write_u64(m.to_bits()));
        }
        hasher.finish()
    }

    /// Known values, with or without vectors.
    fn known(&self) -> usize {
        self.pairs.values.len() + self.pairs.beyond.values.len()
    }

    /// Unknown values are not smaller.
    fn clear_below(&self) -> f64 {
        if self.known() == self.stiffness.rows() {
            f64::INFINITY
        } else {
            self.pairs.beyond.clear_below
        }
    }

    /// Zeros are known from the start.
    fn is_complete_to(&self, last: f64) -> bool {
        last <= 0.0 || self.clear_below() > last
    }

    /// Computes at least the first `wanted` pairs.
    fn solve(&mut self, wanted: usize, options: &EigenOptions) -> Result<(), SparseError> {
        let wanted = wanted.min(self.stiffness.rows());
        let mass = self.mass.view();
        self.pairs = solve::connected(&self.stiffness, mass, wanted, options)?;
        Ok(())
    }

    /// Counts the values up to a little above the last of the merge and finds the missing ones.
    fn complete_to(&mut self, last: f64, options: &EigenOptions) -> Result<(), SparseError> {
        fairing_watch::check();
        let known = self.known();
        let problem = Problem::new(&self.stiffness, self.mass.view())?;
        let from = last / problem.unit;
        let mut wanted = known + 1;
        let sure = count_in_gap(&problem, from, from * (1.0 + MARGIN))
            .ok()
            .filter(|c| c.is_sure(problem.largest_strain(), c.shift - from));
        if let Some(counted) = sure {
            if counted.count == known {
                self.pairs.beyond.clear_below = counted.shift * problem.unit;
                return Ok(());
            }
            wanted = wanted.max(counted.count);
        }
        self.solve(wanted, options)
    }
}

impl PartMass {
    fn view(&self) -> Mass<'_> {
        match self {
            Self::Lumped(d) => Mass::Lumped(d),
            Self::Consistent(matrix) => Mass::Consistent(matrix),
        }
    }
}

/// The diagonal block of the rows of one group. `places`: the group of each row and its index
/// there.
fn block(matrix: &SparseMatrix, rows: &[u32], places: &[(u32, u32)]) -> SparseMatrix {
    let group = places[rows[0] as usize].0;
    matrix::kept(matrix, rows, |j| {
        let (other, place) = places[j as usize];
        (other == group).then_some(place)
    })
}

/// The rows of each component of S and M together, ascending, in the order of their first rows.
fn groups(stiffness: &SparseMatrix, mass: Mass<'_>) -> Vec<Vec<u32>> {
    let s = Rows::new(stiffness);
    let m = match mass {
        Mass::Lumped(_) => None,
        Mass::Consistent(matrix) => Some(Rows::new(matrix)),
    };
    let neighbors = |i: usize| {
        let coupled = m.iter().flat_map(move |m| m.nonzeros(i));
        s.nonzeros(i).chain(coupled)
    };
    let (count, label) = components(s.count(), |_| false, neighbors);
    let mut groups = vec![vec![]; count];
    for (row, label) in label.into_iter().enumerate() {
        groups[label as usize].push(row as u32);
    }
    groups
}
