//! The range of noise in which each method helps.

use std::cmp::Ordering;
use std::collections::BTreeMap;

use anyhow::{Context as _, Result};

use super::methods::{KEPT, METHODS, SHRUNK, STRICT, TEXT};
use crate::experiment::text::values;
use crate::experiments::restoring::Method;
use crate::experiments::seen;
use crate::model::table::{Table as Results, Tables, Tolerance, Unit};
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
        let of = |method: &str| Errors::new(&rows.only(&[("method", method.into())])?, SHRUNK);
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
    /// Normal errors; a right angle at levels where more of the volume is lost than allowed.
    angles: Vec<f64>,
    /// Standard errors of the angles.
    uncertain: Vec<f64>,
    distances: Vec<f64>,
}

impl Errors {
    /// The errors of a method, if a shape may lose this much of its volume, in per cent.
    fn new(rows: &Results, shrunk: f64) -> Result<Self> {
        let optional = |column: &str| -> Result<Vec<Option<f64>>> {
            let c = rows.index(column)?;
            Ok(rows.rows.iter().map(|row| row[c].number()).collect())
        };
        let (angles, volumes) = (rows.column("normal error")?, optional("volume")?);
        let (spread, seeds) = (optional("± normal error")?, rows.column("seeds")?);
        let kept = |(angle, volume): (f64, Option<f64>)| match volume {
            Some(v) if v <= -shrunk => angle.max(90.0),
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

/// The limit of the method of a group that keeps a mesh longest.
#[derive(Debug, Clone, Copy)]
struct Limit {
    method: &'static str,
    kept: f64,
    low: f64,
    high: f64,
}

impl Limit {
    /// The limit of the methods that are wanted, if a shape may lose this much of its volume.
    fn of(
        sweep: &Results,
        mesh: &str,
        shrunk: f64,
        wanted: impl Fn(Method) -> bool,
    ) -> Result<Self> {
        let rows = sweep.only(&[("mesh", mesh.into())])?;
        let mut most = Self { method: "none", kept: 0.0, low: 0.0, high: 0.0 };
        for (method, _) in METHODS.iter().filter(|m| m.0 != Method::Nothing && wanted(m.0)) {
            let own = Errors::new(&rows.only(&[("method", method.name().into())])?, shrunk)?;
            let [kept, low, high] = [0.0, ERRORS, -ERRORS].map(|off| own.limit(off));
            if kept > most.kept {
                (most.method, most.kept) = (method.name(), kept);
            }
            most.low = most.low.max(low);
            most.high = most.high.max(high);
        }
        Ok(most)
    }

    /// The limits of flows and filters without creases, and of published denoisers.
    fn pair(sweep: &Results, mesh: &str, shrunk: f64) -> Result<[Self; 2]> {
        let flows = Self::of(sweep, mesh, shrunk, Method::is_linear)?;
        Ok([flows, Self::of(sweep, mesh, shrunk, is_published)?])
    }
}

/// The best flow and the best denoiser on each mesh, with the noise up to which they keep it.
pub(super) fn kept(sweep: &Results) -> Result<Results> {
    let labels = ["flow or filter", "denoiser"];
    let limits = [
        "flow: up to",
        "flow, strictly: up to",
        "denoiser: up to",
        "automatic: up to",
        "denoiser better up to",
    ];
    let mut table = Results::new(
        "kept",
        &TEXT.say("table kept", values! { kept: KEPT, shrunk: SHRUNK, strict: STRICT })?,
        &[
            ("mesh", Unit::Label),
            (labels[0], Unit::Label),
            (limits[0], Unit::EdgeLengths),
            (limits[1], Unit::EdgeLengths),
            (labels[1], Unit::Label),
            (limits[2], Unit::EdgeLengths),
            (limits[3], Unit::EdgeLengths),
            (limits[4], Unit::EdgeLengths),
        ],
    )
    .aside(&[labels[1]]);
    // Two methods may be equally good, and errors move by two per cent.
    for label in labels {
        table = table.tolerance(label, None);
    }
    for limit in limits {
        table = table.tolerance(limit, Some(Tolerance { relative: 0.05, absolute: 1e-3 }));
    }
    for mesh in sweep.labels("mesh")? {
        let [flow, denoiser] = Limit::pair(sweep, &mesh, SHRUNK)?;
        let trained = Limit::of(sweep, &mesh, SHRUNK, Method::is_trained)?;
        let [strict, _] = Limit::pair(sweep, &mesh, STRICT)?;
        let better = better_up_to(sweep, &mesh)?;
        table.push(row![
            mesh,
            flow.method,
            flow.kept,
            strict.kept,
            denoiser.method,
            denoiser.kept,
            trained.kept,
            better,
        ]);
    }
    Ok(table)
}

/// The level up to which the best published denoiser leaves a smaller normal error than the best
/// flow; zero if it never does.
fn better_up_to(sweep: &Results, mesh: &str) -> Result<f64> {
    let rows = sweep.only(&[("mesh", mesh.into())])?;
    let mut best: BTreeMap<String, (f64, [f64; 2])> = BTreeMap::new();
    for (method, _) in METHODS {
        if !method.is_linear() && !is_published(method) {
            continue;
        }
        let own = rows.only(&[("method", method.name().into())])?;
        for (level, error) in own.column("σ/h")?.into_iter().zip(own.column("normal error")?) {
            // Levels are below ten, and have the order of their texts.
            let entry = best.entry(format!("{level:.4}")).or_insert((level, [f64::INFINITY; 2]));
            let least = &mut entry.1[usize::from(is_published(method))];
            *least = least.min(error);
        }
    }
    let better = best.values().take_while(|(_, [flow, denoiser])| denoiser < flow);
    Ok(better.last().map_or(0.0, |(level, _)| *level))
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
/// does not count.
pub(super) fn judge(tables: Tables<'_>) -> Result<Judgement> {
    let sweep = tables.get("sweep")?;
    let meshes = sweep.labels("mesh")?;
    let (mut found, mut strict, mut numbers, mut better) = (vec![], vec![], vec![], vec![]);
    for mesh in &meshes {
        let [flow, denoiser] = Limit::pair(sweep, mesh, SHRUNK)?;
        found.push(compare(denoiser, flow));
        numbers.push((format!("flows keep the {mesh} up to"), flow.kept));
        numbers.push((format!("denoisers keep the {mesh} up to"), denoiser.kept));
        let [flow, denoiser] = Limit::pair(sweep, mesh, STRICT)?;
        strict.push(compare(denoiser, flow));
        let level = better_up_to(sweep, mesh)?;
        let heading = if level > 0.0 { "better on a mesh" } else { "never better" };
        better.push(TEXT.say(heading, values! { mesh: mesh.as_str(), level })?);
    }
    let values = values! {
        kept: KEPT, shrunk: SHRUNK, strict: STRICT, errors: ERRORS,
        denoisers: METHODS.iter().filter(|m| is_published(m.0)).count(),
        found: orders(&meshes, &found)?, better: seen::list(&better),
        stricter: if found == strict {
            TEXT.say("strictly the same", values! { strict: STRICT })?
        } else {
            let found = orders(&meshes, &strict)?;
            TEXT.say("strictly", values! { strict: STRICT, found })?
        },
    };
    let mut judgement =
        TEXT.judgement("7b", verdict(&found), values)?.ours().shown(Shown::figure("q7", "normals"));
    // Beyond the end of the sweep there is no number.
    for (name, kept) in numbers.into_iter().filter(|(_, kept)| kept.is_finite()) {
        judgement = judgement.number(&name, kept, Unit::EdgeLengths);
    }
    Ok(judgement)
}

/// Returns true for a published denoiser.
fn is_published(method: Method) -> bool {
    method != Method::Nothing && !method.is_linear() && !method.is_trained()
}

/// The meshes on which denoisers and on which flows go further, as a sentence without its end.
fn orders(meshes: &[String], found: &[Option<Ordering>]) -> Result<String> {
    let mut clauses = vec![];
    for (heading, wanted) in [
        ("denoisers further", Some(Ordering::Greater)),
        ("flows further", Some(Ordering::Less)),
        ("no difference", None),
    ] {
        let names = meshes.iter().zip(found).filter(|(_, order)| **order == wanted);
        let names: Vec<String> = names.map(|(mesh, _)| format!("the {mesh}")).collect();
        let meshes = match names.len() {
            0 => continue,
            count if count == meshes.len() => TEXT.say("all meshes", values! { count })?,
            _ => seen::list(&names),
        };
        clauses.push(TEXT.say(heading, values! { meshes })?);
    }
    Ok(clauses.join("; "))
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
            method: "any",
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
