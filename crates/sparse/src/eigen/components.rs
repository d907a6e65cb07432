//! Disconnected problems: each component is solved separately and the spectra are merged.
//!
//! Weyl's law estimates from its mass how many pairs each component contributes. After a first
//! merge, an inertia count just above the last value finds the components with further pairs, and
//! their number. Components whose blocks of S and M are equal bit by bit are solved once. An
//! eigenvalue shared by copies is a multiple eigenvalue of the whole problem, partly invisible to a
//! Krylov space of the whole, but an ordinary one in each copy.

use std::collections::HashMap;
use std::collections::hash_map::Entry;

use ndarray::Array2;

use crate::components::{components, constant_components};
use crate::eigen::certificate::count_in_gap;
use crate::eigen::problem::Problem;
use crate::eigen::{Beyond, EigenOptions, EigenPairs, solve};
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

enum PartMass {
    Lumped(Vec<f64>),
    Consistent(SparseMatrix),
}

/// The components of S and M together; `None` if there is only one.
fn parts(stiffness: &SparseMatrix, mass: Mass<'_>) -> Option<Vec<Part>> {
    let groups = groups(stiffness, mass);
    if groups.len() < 2 {
        return None;
    }
    let mut places = vec![(0, 0); stiffness.rows()];
    for (group, rows) in groups.iter().enumerate() {
        for (local, &row) in rows.iter().enumerate() {
            places[row as usize] = (group as u32, local as u32);
        }
    }
    let (mut parts, mut known) = (Vec::<Part>::new(), HashMap::<_, usize>::new());
    for (group, rows) in groups.into_iter().enumerate() {
        let place = |j: u32| {
            let (other, place) = places[j as usize];
            (other == group as u32).then_some(place)
        };
        let block = |whole: &SparseMatrix| matrix::kept(whole, &rows, place);
        let stiffness = block(stiffness);
        let mass = match mass {
            Mass::Lumped(d) => PartMass::Lumped(rows.iter().map(|&r| d[r as usize]).collect()),
            Mass::Consistent(matrix) => PartMass::Consistent(block(matrix)),
        };
        let pairs = EigenPairs::none(rows.len());
        let part = Part { copies: vec![rows], stiffness, mass, pairs };
        match known.entry(part.bits()) {
            Entry::Occupied(equal) => parts[*equal.get()].copies.extend(part.copies),
            Entry::Vacant(new) => {
                new.insert(parts.len());
                parts.push(part);
            }
        }
    }
    Some(parts)
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
    let zeros_of = |part: &Part| constant_components(Rows::new(&part.stiffness)).0;
    let zeros: Vec<usize> = parts.iter().map(zeros_of).collect();
    let all_zeros: usize = parts.iter().zip(&zeros).map(|(p, zeros)| p.copies.len() * zeros).sum();
    for (part, zeros) in parts.iter_mut().zip(zeros) {
        part.solve(zeros + share(part, count.saturating_sub(all_zeros)), options)?;
    }
    let last = loop {
        let merged = merge(&parts);
        let missing = count.saturating_sub(merged.len());
        let Some(last) = merged.get(count - 1).map(|last| last.value) else {
            // Too few are known: continue with the part that may have the next one.
            let open = parts.iter_mut().filter(|p| p.known() < p.stiffness.rows());
            let lowest = |a: &&mut Part, b: &&mut Part| a.clear_below().total_cmp(&b.clear_below());
            let Some(part) = open.min_by(lowest) else { break 0.0 };
            part.solve(part.known() + share(part, missing).max(1), options)?;
            continue;
        };
        // Zeros are known from the start.
        let mut open =
            parts.iter_mut().filter(|p| last > 0.0 && p.clear_below() <= last).peekable();
        if open.peek().is_none() {
            break last;
        }
        open.try_for_each(|part| part.complete_to(last, options))?;
    };
    // Pairs known by value only, and pairs that meet only the tolerance of an eigenvalue beyond
    // the merge, are computed. That changes them by rounding, and maybe the merge.
    let limit = options.residual_limit(last);
    loop {
        let mut used = vec![0; parts.len()];
        for chosen in merge(&parts).iter().take(count) {
            used[chosen.part] = used[chosen.part].max(chosen.index + 1);
        }
        let mut open = parts.iter_mut().zip(used).filter(|(part, used)| {
            let residuals = part.pairs.residuals.get(..*used);
            residuals.is_none_or(|r| {
                r.len() < part.pairs.residuals.len() && r.iter().any(|r| *r > limit)
            })
        });
        let Some((part, used)) = open.next() else { break };
        part.solve(used, options)?;
    }
    Ok(assemble(&parts, rows, count))
}

/// The first `count` pairs of all parts, ascending, in the caller's rows.
fn assemble(parts: &[Part], rows: usize, count: usize) -> EigenPairs {
    let mut merged = merge(parts);
    let clear_below = parts.iter().map(Part::clear_below).fold(f64::INFINITY, smaller);
    // Pairs known by value only come after all wanted pairs.
    let following = merged.split_off(count.min(merged.len()));
    let mut vectors = Array2::zeros((rows, merged.len()));
    for (j, chosen) in merged.iter().enumerate() {
        for (local, &row) in chosen.rows.iter().enumerate() {
            vectors[[row as usize, j]] = parts[chosen.part].pairs.vectors[[local, chosen.index]];
        }
    }
    let clear = |v: &f64| *v < clear_below || *v == 0.0;
    EigenPairs {
        values: merged.iter().map(|c| c.value).collect(),
        vectors,
        residuals: merged.iter().map(|c| parts[c.part].pairs.residuals[c.index]).collect(),
        certified: parts.iter().all(|p| p.pairs.certified),
        beyond: Beyond {
            values: following.iter().map(|c| c.value).filter(clear).collect(),
            clear_below,
        },
    }
}

/// A known value of a copy of a part.
struct Known<'a> {
    value: f64,
    part: usize,
    /// The rows of the copy in the whole problem.
    rows: &'a [u32],
    /// Its index in the spectrum of the part.
    index: usize,
}

/// The known values of all copies, ascending; equal values in the order of their components.
fn merge(parts: &[Part]) -> Vec<Known<'_>> {
    let mut all = vec![];
    for (part, Part { copies, pairs, .. }) in parts.iter().enumerate() {
        for rows in copies {
            let values = pairs.values.iter().chain(&pairs.beyond.values).enumerate();
            all.extend(values.map(|(index, &value)| Known { value, part, rows, index }));
        }
    }
    let place = |known: &Known<'_>| (known.rows[0], known.index);
    all.sort_by(|a, b| a.value.total_cmp(&b.value).then_with(|| place(a).cmp(&place(b))));
    all
}

impl Part {
    /// The bits of its blocks.
    fn bits(&self) -> Vec<u64> {
        let bits_of = |matrix: &SparseMatrix| {
            let Rows { starts, columns, values } = Rows::new(matrix);
            let numbers = starts.iter().chain(columns).map(|&i| u64::from(i));
            numbers.chain(values.iter().map(|v| v.to_bits())).collect::<Vec<u64>>()
        };
        let mut bits = bits_of(&self.stiffness);
        match &self.mass {
            PartMass::Lumped(d) => bits.extend(d.iter().map(|m| m.to_bits())),
            PartMass::Consistent(matrix) => bits.extend(bits_of(matrix)),
        }
        bits
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
