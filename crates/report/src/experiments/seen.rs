//! Sentences on the effects visible in pictures, made from the values that are drawn: a caption
//! says nothing that its picture does not show.

use anyhow::Result;
use fairing_operators::curvature::ScalarCurvature;
use fairing_sparse::larger;

use super::gallery::FLAT;
use crate::experiment::text::{Text, values};

static TEXT: Text = Text::new("seen", include_str!("../../text/seen.md"));

/// Values below this part of the largest one are rounding, if only that of the coordinates in the
/// file, which may have six digits.
const ZERO: f64 = 1e-4;

/// An error below this, over the diagonal, is rounding.
const ROUNDING: f64 = 1e-9;

/// Names in a list: `a, b and c`.
pub(super) fn list(words: &[String]) -> String {
    match words.split_last() {
        Some((last, others)) if !others.is_empty() => format!("{} and {last}", others.join(", ")),
        _ => words.concat(),
    }
}

/// A part of all; zero of none.
fn share(part: usize, all: usize) -> f64 {
    part as f64 / all.max(1) as f64
}

/// The defined values inside, or all of them if so wanted.
fn defined(field: &ScalarCurvature, with_boundary: bool) -> Vec<f64> {
    let kept = (0..field.values.len())
        .filter(|&v| field.status[v].is_defined() && (with_boundary || !field.boundary[v]));
    kept.map(|v| field.values[v]).collect()
}

/// The number of values that are zero beside the largest one.
fn zeros(values: &[f64]) -> usize {
    let largest = values.iter().fold(0.0, |most, x| larger(most, x.abs()));
    let bound = (ZERO * largest).max(FLAT * ZERO);
    values.iter().filter(|x| x.abs() <= bound).count()
}

/// Returns true if a field has the colour of zero at all inner vertices.
pub(super) fn is_flat(field: &ScalarCurvature) -> bool {
    defined(field, false).iter().all(|x| x.abs() <= FLAT)
}

/// The range of diverging colours, as the end of a sentence.
pub(super) fn range(fields: &[&ScalarCurvature]) -> Result<String> {
    let is_flat = fields.iter().all(|field| is_flat(field));
    TEXT.say(if is_flat { "range flat" } else { "range" }, &[])
}

/// Mean and Gaussian curvature in diverging colours about zero.
pub(super) fn signed(mean: &ScalarCurvature, gaussian: &ScalarCurvature) -> Result<String> {
    if is_flat(mean) && is_flat(gaussian) {
        let all = defined(gaussian, true);
        let corners = all.len() - zeros(&all);
        let heading = match (is_all_flat(mean), corners) {
            (true, 0) => "flat",
            (true, _) => "flat corners",
            (false, _) => "flat inside",
        };
        return TEXT.say(heading, values! { corners });
    }
    let positive = |field: &ScalarCurvature| {
        let inside = defined(field, false);
        share(inside.iter().filter(|x| **x > 0.0).count(), inside.len())
    };
    TEXT.say("signed", values! { mean: positive(mean), gaussian: positive(gaussian) })
}

fn is_all_flat(field: &ScalarCurvature) -> bool {
    defined(field, true).iter().all(|x| x.abs() <= FLAT)
}

/// Fields in equalised colours, by name.
pub(super) fn equalised(fields: &[(&str, &ScalarCurvature)]) -> Result<String> {
    let fields = fields.iter().map(|&(name, field)| (name, defined(field, true)));
    let fields: Vec<(&str, Vec<f64>)> = fields.collect();
    if fields.iter().all(|(_, all)| 2 * zeros(all) > all.len()) {
        let shares = fields.iter().map(|(name, all)| {
            let share = share(zeros(all), all.len());
            TEXT.say("equalised share", values! { name: *name, share })
        });
        let shares = list(&shares.collect::<Result<Vec<_>>>()?);
        return TEXT.say("equalised zeros", values! { shares });
    }
    let mut ranges = vec![];
    for (name, mut all) in fields {
        all.sort_unstable_by(f64::total_cmp);
        let (Some(&first), Some(&last)) = (all.first(), all.last()) else { continue };
        let [low, high] = [all[all.len() / 4], all[3 * all.len() / 4]];
        ranges.push(TEXT.say("equalised range", values! { name, low, high, first, last })?);
    }
    TEXT.say("equalised", values! { ranges: list(&ranges) })
}

/// Two estimates of one signed field.
pub(super) fn agreement(a: &ScalarCurvature, b: &ScalarCurvature) -> Result<String> {
    if is_all_flat(a) && is_all_flat(b) {
        return TEXT.say("agreement flat", &[]);
    }
    let both = (0..a.values.len()).filter(|&v| {
        a.status[v].is_defined() && b.status[v].is_defined() && !a.boundary[v] && !b.boundary[v]
    });
    let pairs: Vec<[f64; 2]> = both.map(|v| [a.values[v], b.values[v]]).collect();
    let same = pairs.iter().filter(|[x, y]| x * y > 0.0).count();
    let squares: f64 = pairs.iter().map(|[x, y]| (x - y).powi(2)).sum();
    let size: f64 = pairs.iter().map(|[_, y]| y * y).sum();
    let (same, gap) = (share(same, pairs.len()), (squares / size).sqrt());
    TEXT.say("agreement", values! { same, gap })
}

/// Errors by name: those of one sign nearly everywhere are smooth, those of both signs are noise.
pub(super) fn errors(fields: &[(&str, &[f64])]) -> Result<String> {
    let sentences = fields.iter().map(|&(name, values)| {
        let above = values.iter().filter(|x| **x > 0.0).count();
        let most = above.max(values.len() - above);
        let is_smooth = 10 * most > 9 * values.len();
        let heading = if is_smooth { "errors smooth" } else { "errors noise" };
        TEXT.say(heading, values! { name, share: share(most, values.len()) })
    });
    Ok(sentences.collect::<Result<Vec<_>>>()?.join(" "))
}

/// Errors of several methods, by name, over rising levels: one row for each level.
pub(super) fn over_levels(rows: &[(String, Vec<f64>)], methods: &[&str]) -> Result<String> {
    let Some((last, errors)) = rows.last() else { return Ok(String::new()) };
    let rising = rows.windows(2).all(|w| w[0].1.iter().zip(&w[1].1).all(|(a, b)| a < b));
    let named: Vec<(&str, f64)> = methods.iter().copied().zip(errors.iter().copied()).collect();
    let Some([(best, least), (worst, largest)]) = ends(&named) else { return Ok(String::new()) };
    let values = values! { last: last.as_str(), best, least, worst, largest };
    TEXT.say(if rising { "levels" } else { "levels mixed" }, values)
}

/// The methods with the least and the largest error; `None` of none.
fn ends<'a>(errors: &[(&'a str, f64)]) -> Option<[(&'a str, f64); 2]> {
    let best = errors.iter().min_by(|a, b| a.1.total_cmp(&b.1))?;
    let worst = errors.iter().max_by(|a, b| a.1.total_cmp(&b.1))?;
    Some([*best, *worst])
}

/// The methods with the least and the largest normal error, by name.
pub(super) fn best_and_worst(errors: &[(&str, f64)]) -> Result<String> {
    let Some([(best, least), (worst, largest)]) = ends(errors) else { return Ok(String::new()) };
    TEXT.say("best and worst", values! { best, least, worst, largest })
}

/// A mesh from growing numbers of modes, each with its error over the diagonal.
pub(super) fn reconstructions(name: &str, errors: &[(usize, f64)]) -> Result<String> {
    let (Some(&(few, large)), Some(&(many, small))) = (errors.first(), errors.last()) else {
        return Ok(String::new());
    };
    let is_exact = small < ROUNDING;
    let heading = if is_exact { "reconstructions exact" } else { "reconstructions" };
    TEXT.say(heading, values! { few, name, large, many, small })
}

#[cfg(test)]
mod tests {
    use fairing_operators::curvature::VertexStatus;

    use super::*;

    /// The last `border` values lie on the boundary.
    fn field(values: &[f64], border: usize) -> ScalarCurvature {
        let n = values.len();
        let boundary = (0..n).map(|v| v + border >= n).collect();
        ScalarCurvature::new(values.to_vec(), vec![VertexStatus::Defined; n], boundary)
    }

    #[test]
    fn a_plane_is_grey_but_for_its_corners() {
        let mean = field(&[0.0, 1e-9, 0.0, 0.0], 2);
        let text = signed(&mean, &field(&[0.0, 0.0, 700.0, 700.0], 2)).unwrap();
        assert!(
            text.starts_with("Everything is grey except 2 vertices at corners of the border"),
            "{text}"
        );
        assert!(signed(&mean, &field(&[0.0; 4], 2)).unwrap().contains("zero everywhere"));
        assert!(
            range(&[&mean]).unwrap().contains("rounding")
                && !range(&[&field(&[1.0], 0)]).unwrap().contains("rounding")
        );
        let text =
            signed(&field(&[1.0, -1.0, 2.0, 0.5], 0), &field(&[1.0, -1.0, -2.0, 0.5], 0)).unwrap();
        assert!(text.contains("75 % of the inner vertices, K at 50 %"), "{text}");
    }

    #[test]
    fn equalised_colours_are_said_to_hide_what_they_hide() {
        let text = equalised(&[("K", &field(&[0.0, 0.0, 0.0, 9.0], 0))]).unwrap();
        assert!(text.ends_with("the colour of zero up to rounding: 75 % for K."), "{text}");
        let text = equalised(&[("K", &field(&[-8.0, 1.0, 2.0, 3.0, 90.0], 0))]).unwrap();
        assert!(text.contains("between 1 and 3 (all of them between −8 and 90)"), "{text}");
    }

    #[test]
    fn two_estimates_agree_as_far_as_they_do() {
        let (a, b) = (field(&[1.0, 2.0, -1.0], 0), field(&[1.0, 2.0, 1.0], 0));
        assert!(agreement(&a, &b).unwrap().contains("67 % of the inner vertices"));
        let flat = field(&[0.0; 3], 1);
        assert!(agreement(&flat, &flat).unwrap().starts_with("Everything is grey"));
    }

    #[test]
    fn errors_are_smooth_or_noise() {
        let text = errors(&[("a", &[1.0, -1.0, 2.0, -2.0]), ("b", &[1.0; 20])]).unwrap();
        assert!(text.contains(
            "The error of a has both signs, the more common one at 50 % of the vertices: it is noise."
        ));
        assert!(text.contains("The error of b has the same sign at 100 % of the vertices."));
    }

    #[test]
    fn a_row_is_worse_only_where_it_is() {
        let row = |name: &str, errors: [f64; 2]| (name.to_string(), errors.to_vec());
        let rising = [row("0.1", [2.0, 3.0]), row("0.5", [20.0, 30.0])];
        let text = over_levels(&rising, &["x", "y"]).unwrap();
        let end = "at σ = 0.5 it ranges from 20° (x) to 30° (y).";
        assert!(text.ends_with(end), "{text}");
        assert!(text.starts_with("The normal error grows from row to row"), "{text}");
        let mixed = [row("0.1", [2.0, 3.0]), row("0.5", [20.0, 1.0])];
        assert!(over_levels(&mixed, &["x", "y"]).unwrap().contains("with most methods"));
    }

    #[test]
    fn the_best_and_the_worst_have_their_errors() {
        let text = best_and_worst(&[("x", 2.5), ("y", 1.5), ("z", 9.0)]).unwrap();
        let expected = "The normal error ranges from 1.5° (y) to 9° (z).";
        assert_eq!(text, expected);
    }

    #[test]
    fn errors_of_reconstructions_are_those_given() {
        let text = reconstructions("ball", &[(5, 0.08), (100, 0.004)]).unwrap();
        assert!(
            text.starts_with(
                "From 5 modes the ball is off by 8 % of its diagonal, from 100 by 0.4 %"
            )
        );
        assert!(
            reconstructions("ball", &[(5, 0.08), (9, 1e-16)]).unwrap().contains("only rounding")
        );
    }
}
