//! The range of noise in which each method helps.

use std::cmp::Ordering;

use anyhow::{Context as _, Result};

use super::methods::{KEPT, METHODS, SHRUNK, TEXT};
use crate::experiment::text::values;
use crate::experiments::restoring::Method;
use crate::model::table::{Table as Results, Tables, Tolerance, Unit, brief};
use crate::model::verdict::{Judgement, Shown, Verdict};
use crate::row;

/// Name of the best of all methods in the table.
const ANY: &str = "best of all";

/// Standard errors by which two limits must differ.
pub(super) const ERRORS: f64 = 2.0;

/// For each mesh and method: the levels at which its errors lie below those of
/// the noisy input, the first beyond them, and the level up to which the shape
/// is kept.
pub(super) fn table(sweep: &Results) -> Result<Results> {
    let mut table = Results::new(
        "limits",
        &TEXT.say("table limits", &[])?,
        &[
            ("mesh", Unit::Label),
            ("method", Unit::Label),
            ("normals: helps from", Unit::EdgeLengths),
            ("normals: stops at", Unit::EdgeLengths),
            ("vertices: helps from", Unit::EdgeLengths),
            ("vertices: stops at", Unit::EdgeLengths),
            ("kept up to", Unit::EdgeLengths),
            ("at least", Unit::EdgeLengths),
            ("at most", Unit::EdgeLengths),
        ],
    )
    .aside(&["vertices: helps from", "vertices: stops at"]);
    // Interpolated between errors that may move by two percent.
    for column in ["kept up to", "at least", "at most"] {
        table = table.tolerance(column, Some(Tolerance { relative: 0.05, absolute: 1e-3 }));
    }
    for mesh in sweep.labels("mesh")? {
        let mesh = mesh.as_str();
        let rows = sweep.only(&[("mesh", mesh.into())])?;
        let of = |method: &str| Errors::new(&rows.only(&[("method", method.into())])?);
        let input = of(Method::Nothing.name())?;
        let mut best: Option<Errors> = None;
        for (method, _) in &METHODS[1..] {
            let own = of(method.name())?;
            push(&mut table, [mesh, method.name()], &own, &input);
            match &mut best {
                Some(best) => best.improve(&own),
                none => *none = Some(own),
            }
        }
        push(&mut table, [mesh, ANY], &best.context("no methods")?, &input);
    }
    Ok(table)
}

/// The errors of a method over the levels at which it was run.
#[derive(Debug, Clone)]
struct Errors {
    levels: Vec<f64>,
    /// Where more of the volume is lost than [`SHRUNK`], a right angle.
    angles: Vec<f64>,
    /// Standard errors of the angles.
    uncertain: Vec<f64>,
    distances: Vec<f64>,
}

impl Errors {
    fn new(rows: &Results) -> Result<Self> {
        let optional = |column: &str| -> Result<Vec<Option<f64>>> {
            let c = rows.index(column)?;
            Ok(rows.rows.iter().map(|row| row[c].number()).collect())
        };
        let (angles, volumes) = (rows.column("normal error")?, optional("volume")?);
        let (spread, seeds) = (optional("± normal error")?, rows.column("seeds")?);
        let kept = |(angle, volume): (f64, Option<f64>)| match volume {
            Some(v) if v <= -SHRUNK => angle.max(90.0),
            _ => angle,
        };
        Ok(Self {
            levels: rows.column("σ/h")?,
            angles: angles.into_iter().zip(volumes).map(kept).collect(),
            uncertain: spread.iter().zip(seeds).map(|(s, n)| s.unwrap_or(0.0) / n.sqrt()).collect(),
            distances: rows.column("vertex error")?,
        })
    }

    /// Takes the smaller error at each level; the other was run at no more levels.
    fn improve(&mut self, other: &Self) {
        for k in 0..other.levels.len() {
            if other.angles[k] < self.angles[k] {
                (self.angles[k], self.uncertain[k]) = (other.angles[k], other.uncertain[k]);
            }
            self.distances[k] = self.distances[k].min(other.distances[k]);
        }
    }

    /// The level up to which the shape is kept if all angles are off by this many
    /// standard errors: interpolated, 0 if it never is, infinite if it always is.
    fn limit(&self, off: f64) -> f64 {
        let angles: Vec<f64> =
            self.angles.iter().zip(&self.uncertain).map(|(a, e)| a + off * e).collect();
        match angles.iter().position(|a| *a >= KEPT) {
            None => f64::INFINITY,
            Some(0) => 0.0,
            Some(k) => {
                let t = (KEPT - angles[k - 1]) / (angles[k] - angles[k - 1]);
                self.levels[k - 1] * libm::pow(self.levels[k] / self.levels[k - 1], t)
            }
        }
    }
}

fn push(table: &mut Results, names: [&str; 2], own: &Errors, input: &Errors) {
    let (a_from, a_to) = helps(&own.levels, &own.angles, &input.angles);
    let (v_from, v_to) = helps(&own.levels, &own.distances, &input.distances);
    let [kept, low, high] = [0.0, ERRORS, -ERRORS].map(|off| own.limit(off));
    table.push(row![names[0], names[1], a_from, a_to, v_from, v_to, kept, low, high]);
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

/// The limits of one method on one mesh: that of its group which keeps the shape longest.
#[derive(Debug, Clone, Copy)]
struct Limit {
    kept: f64,
    low: f64,
    high: f64,
}

impl Limit {
    /// The limit and its range: `up to 0.5 h (0.4 to 0.6 h)`.
    fn words(self) -> String {
        let range = format!("({} to {} h)", brief(self.low), brief(self.high));
        match self.kept {
            0.0 => format!("at no level {range}"),
            kept if kept.is_finite() => format!("up to {} h {range}", brief(kept)),
            _ => format!("at all levels {range}"),
        }
    }
}

/// Orders two limits.
fn compare(a: Limit, b: Limit) -> Option<Ordering> {
    if a.low > b.high {
        Some(Ordering::Greater)
    } else if a.high < b.low {
        Some(Ordering::Less)
    } else {
        // Too near to each other, or both beyond the end of the sweep.
        None
    }
}

/// Judges the claim that published denoisers keep shapes at more noise than flows. The trained one
/// has no say, but its limits are given.
pub(super) fn judge(tables: Tables<'_>) -> Result<Judgement> {
    let limits = tables.get("limits")?;
    let limit = |mesh: &str, wanted: &dyn Fn(Method) -> bool| -> Result<Limit> {
        let mut most = Limit { kept: 0.0, low: 0.0, high: 0.0 };
        for (method, _) in METHODS.iter().filter(|m| m.0 != Method::Nothing && wanted(m.0)) {
            let of = |column: &str| {
                limits.value(&[("mesh", mesh.into()), ("method", method.name().into())], column)
            };
            most.kept = most.kept.max(of("kept up to")?);
            most.low = most.low.max(of("at least")?);
            most.high = most.high.max(of("at most")?);
        }
        Ok(most)
    };
    let (mut found, mut sentences, mut numbers) = (vec![], vec![], vec![]);
    for mesh in limits.labels("mesh")? {
        let mesh = mesh.as_str();
        let flows = limit(mesh, &Method::is_linear)?;
        let denoisers = limit(mesh, &|m| !m.is_linear() && !m.is_trained())?;
        let trained = limit(mesh, &Method::is_trained)?;
        let order = compare(denoisers, flows);
        let words = match order {
            Some(Ordering::Greater) => "denoisers go further",
            Some(_) => "flows go further",
            None => "there is no measurable difference",
        };
        let [flow, denoiser, trained] = [flows, denoisers, trained].map(Limit::words);
        let values = values! { mesh, flows: flow, denoisers: denoiser, order: words, trained };
        sentences.push(TEXT.say("on a mesh", values)?);
        found.push(order);
        numbers.push((mesh.to_string(), [flows.kept, denoisers.kept]));
    }
    let [begin, each] = summary(&numbers, &found);
    let values = values! { meshes: sentences.join(" "), begin, each };
    let mut judgement =
        TEXT.judgement("7b", verdict(&found), values)?.ours().shown(Shown::figure("q7", "normals"));
    for (mesh, [flows, denoisers]) in numbers {
        for (who, kept) in [("flows", flows), ("denoisers", denoisers)] {
            // Beyond the end of the sweep there is no number.
            if kept.is_finite() {
                let name = format!("{who} keep the {mesh} up to");
                judgement = judgement.number(&name, kept, Unit::EdgeLengths);
            }
        }
    }
    Ok(judgement)
}

/// The meshes on which denoisers go further, and the limits of denoisers and flows on each mesh.
fn summary(numbers: &[(String, [f64; 2])], found: &[Option<Ordering>]) -> [String; 2] {
    let further = numbers.iter().zip(found).filter(|(_, o)| **o == Some(Ordering::Greater));
    let further: Vec<String> = further.map(|((mesh, _), _)| format!("the {mesh}")).collect();
    let words = |kept: f64| match kept {
        0.0 => "at no level".to_string(),
        kept if kept.is_finite() => format!("up to {} h", brief(kept)),
        _ => "at all levels".into(),
    };
    let each = numbers.iter().map(|(mesh, [flows, denoisers])| {
        format!("on the {mesh} {} and {}", words(*denoisers), words(*flows))
    });
    let each = each.collect::<Vec<_>>().join(", ");
    let begin = match further.len() {
        0 => "On no mesh do denoisers measurably go further. ".into(),
        n if n < found.len() => format!("Only on {} is that so. ", further.join(" and ")),
        _ => String::new(),
    };
    [begin, each]
}

/// From whether denoisers go further on each mesh; `None` where that is not known.
fn verdict(found: &[Option<Ordering>]) -> Verdict {
    let count = |wanted: fn(&Option<Ordering>) -> bool| found.iter().filter(|o| wanted(o)).count();
    let further = count(|o| *o == Some(Ordering::Greater));
    match (further, count(|o| o.is_none())) {
        (n, _) if n == found.len() => Verdict::Confirmed,
        (0, 0) => Verdict::Refuted,
        (0, _) => Verdict::Undecided,
        _ => Verdict::Qualified,
    }
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

    fn errors(angles: &[f64], uncertain: f64) -> Errors {
        let levels: Vec<f64> = (0..angles.len()).map(|k| 2f64.powi(k as i32)).collect();
        let n = levels.len();
        Errors {
            levels,
            angles: angles.to_vec(),
            uncertain: vec![uncertain; n],
            distances: vec![0.0; n],
        }
    }

    /// Half way between 10° at 2 and 20° at 4, on a logarithmic axis.
    #[test]
    fn limits_lie_between_levels() {
        assert!((errors(&[5.0, 10.0, 20.0], 1.0).limit(0.0) - 8f64.sqrt()).abs() < 1e-14);
        assert!((errors(&[5.0, 10.0, 20.0], 1.0).limit(-5.0) - 4.0).abs() < 1e-14);
        assert_eq!(errors(&[15.0, 20.0], 0.0).limit(0.0), 0.0);
        assert_eq!(errors(&[5.0, 10.0], 0.0).limit(0.0), f64::INFINITY);
    }

    /// A tie, at the end of the sweep or within its errors, decides nothing.
    #[test]
    fn ties_are_undecided() {
        let [lost, kept] = [errors(&[10.0, 20.0], 0.5), errors(&[5.0, 10.0], 0.5)].map(|e| Limit {
            kept: e.limit(0.0),
            low: e.limit(ERRORS),
            high: e.limit(-ERRORS),
        });
        assert_eq!(compare(kept, lost), Some(Ordering::Greater));
        assert_eq!(compare(lost, kept), Some(Ordering::Less));
        assert_eq!((compare(kept, kept), compare(lost, lost)), (None, None));
        let (more, less) = (Some(Ordering::Greater), Some(Ordering::Less));
        assert_eq!(verdict(&[more; 3]), Verdict::Confirmed);
        assert_eq!(verdict(&[less; 3]), Verdict::Refuted);
        assert_eq!(verdict(&[None, less, None]), Verdict::Undecided);
        assert_eq!(verdict(&[None, more, more]), Verdict::Qualified);
        assert_eq!(verdict(&[less, more, more]), Verdict::Qualified);
    }
}
