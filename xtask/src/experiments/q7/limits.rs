//! From where to where each method helps.

use anyhow::Result;

use super::{KEPT, METHODS, SWEEP};
use crate::experiments::restoring::Method;
use crate::row;
use crate::table::{Cell, Table as Results, Tables, Unit, short};
use crate::verdict::{Judgement, Verdict};

/// What the table calls the best of all methods.
const ANY: &str = "best of all";

/// For each mesh and method: the levels at which its errors lie below those of
/// the noisy input, the first beyond them, and the last at which the shape is
/// kept.
pub(super) fn table(sweep: &Results) -> Result<Results> {
    let mut table = Results::new(
        "limits",
        "Where each method helps, from the sweep: the first level at which its mean error lies below that of the noisy input; the first level after that at which it no longer does (a dash: it still helps at the last level of the sweep); the same by the distance of the vertices; and the last level at which the shape is kept. The last row of each mesh takes the best method at each level: beyond its last level nothing recovers the shape.",
        &[
            ("mesh", Unit::Label),
            ("method", Unit::Label),
            ("E_a helps from", Unit::EdgeLengths),
            ("E_a stops at", Unit::EdgeLengths),
            ("E_v helps from", Unit::EdgeLengths),
            ("E_v stops at", Unit::EdgeLengths),
            ("kept up to", Unit::EdgeLengths),
            ("lost from", Unit::EdgeLengths),
        ],
    );
    for mesh in ["block", "torus", "scan"] {
        let rows = sweep.only(&[("mesh", mesh.into())])?;
        let of = |method: &str| rows.only(&[("method", method.into())]);
        let input = of(Method::Nothing.name())?;
        let levels = input.column("σ/h")?;
        let (noisy, away) = (input.column("E_a")?, input.column("E_v")?);
        let mut best = [vec![f64::INFINITY; levels.len()], vec![f64::INFINITY; levels.len()]];
        for (method, _) in &METHODS[1..] {
            let own = of(method.name())?;
            let errors = [own.column("E_a")?, own.column("E_v")?];
            for (best, error) in best.iter_mut().zip(&errors) {
                best.iter_mut().zip(error).for_each(|(b, e)| *b = b.min(*e));
            }
            push(&mut table, [mesh, method.name()], &levels, &errors, [&noisy, &away]);
        }
        push(&mut table, [mesh, ANY], &levels, &best, [&noisy, &away]);
    }
    Ok(table)
}

fn push(
    table: &mut Results,
    names: [&str; 2],
    levels: &[f64],
    errors: &[Vec<f64>; 2],
    input: [&Vec<f64>; 2],
) {
    let [(a_from, a_to), (v_from, v_to)] = [0, 1].map(|k| helps(levels, &errors[k], input[k]));
    let lost = errors[0].iter().position(|e| *e >= KEPT);
    let kept = match lost {
        Some(0) => None,
        Some(k) => Some(levels[k - 1]),
        None => levels.last().copied(),
    };
    let lost = lost.map(|k| levels[k]);
    table.push(row![names[0], names[1], a_from, a_to, v_from, v_to, kept, lost]);
}

/// The first level at which an error lies below that of the input, and the
/// first after it at which it does not.
fn helps(levels: &[f64], error: &[f64], input: &[f64]) -> (Option<f64>, Option<f64>) {
    let better: Vec<bool> = error.iter().zip(input).map(|(e, i)| e < i).collect();
    let Some(first) = better.iter().position(|b| *b) else {
        return (None, levels.first().copied());
    };
    let end = better[first..].iter().position(|b| !*b).map(|k| levels[first + k]);
    (Some(levels[first]), end)
}

/// Whether denoisers keep shapes at more noise than flows.
pub(super) fn judge(tables: Tables<'_>) -> Result<Judgement> {
    let limits = tables.get("limits")?;
    let kept = |mesh: &str, wanted: &dyn Fn(Method) -> bool| -> Result<f64> {
        let mut most = 0.0_f64;
        for (method, _) in METHODS.iter().filter(|m| m.0 != Method::Nothing && wanted(m.0)) {
            let row = limits.only(&[("mesh", mesh.into()), ("method", method.name().into())])?;
            let cell = &row.rows[0][row.index("kept up to")?];
            most = most.max(Cell::number(cell).unwrap_or(0.0));
        }
        Ok(most)
    };
    let (mut further, mut sentences, mut numbers) = (0, vec![], vec![]);
    for mesh in ["block", "torus", "scan"] {
        let flows = kept(mesh, &Method::is_linear)?;
        let denoisers = kept(mesh, &|m| !m.is_linear())?;
        further += usize::from(denoisers > flows);
        sentences.push(format!("{mesh}: {} and {} h", short(flows), short(denoisers)));
        numbers.push((mesh, denoisers));
    }
    let verdict = match further {
        0 => Verdict::Refuted,
        3 => Verdict::Confirmed,
        _ => Verdict::Qualified,
    };
    let reason = format!(
        "The last levels at which flows and filters without creases, and denoisers, keep the shape: {}. The levels tried go up to {} h.",
        sentences.join("; "),
        short(SWEEP[SWEEP.len() - 1]),
    );
    let claim = "Denoisers keep the shape under more noise than flows do";
    let judgement = Judgement::new("7b", claim, verdict, reason).ours();
    Ok(numbers.into_iter().fold(judgement, |j, (mesh, level)| {
        j.number(&format!("denoisers keep the {mesh} up to"), level, Unit::EdgeLengths)
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_method_helps_over_a_range() {
        let levels = [0.1, 0.2, 0.3, 0.4];
        assert_eq!(
            helps(&levels, &[2.0, 1.0, 1.0, 5.0], &[1.0, 2.0, 3.0, 4.0]),
            (Some(0.2), Some(0.4))
        );
        assert_eq!(helps(&levels, &[0.0; 4], &[1.0; 4]), (Some(0.1), None));
        assert_eq!(helps(&levels, &[2.0; 4], &[1.0; 4]), (None, Some(0.1)));
    }
}
