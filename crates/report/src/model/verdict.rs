//! Verdicts on claims.

use std::fmt;

use serde::{Deserialize, Serialize};

use crate::model::table::{Unit, brief, brief_above, brief_below};

/// The verdict on a claim.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Verdict {
    /// The measurements support the claim.
    Confirmed,
    /// The measurements contradict the claim.
    Refuted,
    /// Parts hold, or it holds under conditions that the claim does not name.
    Qualified,
    /// The measurements cannot tell: what differs lies within their standard error,
    /// or beyond the end of a sweep.
    Undecided,
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Confirmed => "right",
            Self::Refuted => "wrong",
            Self::Qualified => "half right",
            Self::Undecided => "undecided",
        })
    }
}

impl Verdict {
    /// Its name in `results.json` and in style sheets.
    pub fn key(self) -> &'static str {
        match self {
            Self::Confirmed => "confirmed",
            Self::Refuted => "refuted",
            Self::Qualified => "qualified",
            Self::Undecided => "undecided",
        }
    }
}

/// A number that decided a verdict. It is shown with two digits; one whose name says that it is the
/// largest or the least of several is a bound, and rounded outwards.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Deciding {
    /// The measured quantity.
    pub name: String,
    /// The number.
    pub value: f64,
    /// Its unit.
    pub unit: Unit,
}

impl fmt::Display for Deciding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let has = |words: &[&str]| words.iter().any(|word| self.name.contains(word));
        type Rounding = (fn(f64) -> String, fn(f64) -> f64);
        let above = ["largest", "greatest", "highest", "farthest", "worst", "at most"];
        let (show, round): Rounding = if has(&above) {
            (brief_above, f64::ceil)
        } else if has(&["least", "smallest", "lowest"]) {
            (brief_below, f64::floor)
        } else {
            (brief, f64::round)
        };
        // Orders near a whole number need their decimals.
        let value = if self.unit == Unit::Order {
            format!("{:.2}", round(100.0 * self.value) / 100.0).replace('-', "−")
        } else {
            show(self.value)
        };
        write!(f, "{} {value}", self.name)?;
        match self.unit {
            Unit::Label | Unit::One | Unit::Count | Unit::Order | Unit::Relative => Ok(()),
            Unit::Degrees => write!(f, "{}", self.unit),
            unit => write!(f, " {unit}"),
        }
    }
}

/// A figure, a view or a playground of the page, and its state.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Shown {
    /// Its id on the page.
    pub id: String,
    /// The state, as the page has it in its address.
    pub state: String,
}

/// The state of a view, as far as it differs from that at the beginning.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct ViewState {
    /// The stop of each slider.
    pub stops: Vec<usize>,
    /// The name of the field that is shown.
    pub field: String,
    /// The number of modes of a view that sums modes.
    pub modes: Option<usize>,
}

impl ViewState {
    /// Sliders at these stops.
    pub fn at(stops: &[usize]) -> Self {
        Self { stops: stops.to_vec(), ..Self::default() }
    }

    /// The state with the colours of this field.
    #[must_use]
    pub fn field(self, name: &str) -> Self {
        Self { field: name.into(), ..self }
    }

    /// The sum of this number of modes.
    pub fn modes(count: usize) -> Self {
        Self { modes: Some(count), ..Self::default() }
    }
}

impl Shown {
    /// A figure.
    pub fn figure(experiment: &str, figure: &str) -> Self {
        Self { id: format!("figure-{experiment}-{figure}"), state: String::new() }
    }

    /// A figure with the line of this name marked.
    pub fn line(experiment: &str, figure: &str, line: &str) -> Self {
        Self { state: line.into(), ..Self::figure(experiment, figure) }
    }

    /// A view in a state.
    pub fn view(experiment: &str, view: &str, state: &ViewState) -> Self {
        let stops: Vec<String> = state.stops.iter().map(usize::to_string).collect();
        // Camera, stops, field, switches, vertex, live flow and sum; empty parts are defaults.
        let mut parts = vec![String::new(), stops.join("~"), state.field.clone()];
        if let Some(modes) = state.modes {
            parts.resize(6, String::new());
            parts.push(modes.to_string());
        }
        Self { id: format!("{experiment}-{view}"), state: parts.join("!") }
    }

    /// A playground with these values of its controls.
    pub fn playground(kind: &str, values: &[&dyn std::fmt::Display]) -> Self {
        let values: Vec<String> = values.iter().map(ToString::to_string).collect();
        Self { id: format!("play-{kind}"), state: values.join("~") }
    }
}

/// A verdict on one claim, with what decided it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Judgement {
    /// The claim's id: question and letter, such as `1a`.
    pub id: String,
    /// The claim, in our words.
    pub claim: String,
    /// The verdict.
    pub verdict: Verdict,
    /// The reason, in a sentence or two with numbers from the tables.
    pub reason: String,
    /// The true statement, or the sense in which the claim holds, in one sentence for the table of
    /// claims.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub finding: String,
    /// The numbers that decided; tables of claims show the first.
    pub numbers: Vec<Deciding>,
    /// The place on the page that shows the decision: the id of a view or a playground and its
    /// state, as in an address.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shown: Option<Shown>,
    /// True for a claim of Fairing, false for one of the original report.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub ours: bool,
}

impl Judgement {
    /// A judgement without numbers yet; add them with [`Self::number`].
    pub fn new(id: &str, claim: &str, verdict: Verdict, reason: impl Into<String>) -> Self {
        let (id, claim, reason) = (id.into(), claim.into(), reason.into());
        let finding = String::new();
        Self { id, claim, verdict, reason, finding, numbers: vec![], shown: None, ours: false }
    }

    /// The word for the claim: those of the original report are claims, ours are hypotheses.
    pub fn kind(&self) -> &'static str {
        if self.ours { "Hypothesis" } else { "Claim" }
    }

    /// The same, of a claim that is ours.
    #[must_use]
    pub fn ours(self) -> Self {
        Self { ours: true, ..self }
    }

    /// Sets the true statement, in one sentence.
    #[must_use]
    pub fn finding(self, finding: impl Into<String>) -> Self {
        Self { finding: finding.into(), ..self }
    }

    /// Sets the place on the page that shows the decision.
    #[must_use]
    pub fn shown(self, shown: Shown) -> Self {
        Self { shown: Some(shown), ..self }
    }

    /// Adds a deciding number.
    #[must_use]
    pub fn number(mut self, name: &str, value: f64, unit: Unit) -> Self {
        self.numbers.push(Deciding { name: name.into(), value, unit });
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bounds_stay_bounds() {
        let shown =
            |name: &str, value, unit| Deciding { name: name.into(), value, unit }.to_string();
        assert_eq!(shown("least order", 1.9953, Unit::Order), "least order 1.99");
        assert_eq!(shown("highest order", -0.071, Unit::Order), "highest order −0.07");
        assert_eq!(shown("least change", 20.96, Unit::Percent), "least change 20 %");
        assert_eq!(shown("largest error", 0.0111, Unit::EdgeLengths), "largest error 0.012 h");
        assert_eq!(shown("median ratio", 1.96, Unit::One), "median ratio 2");
    }
}
