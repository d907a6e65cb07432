//! The words of an experiment: a Markdown file of `text/` with a head in TOML and a block under
//! each heading, whose `{placeholders}` are filled with the numbers of a run.
//!
//! A placeholder `{name}` shows a number with two digits, `{name:up}` and `{name:down}` round it
//! outwards for a bound (at most, at least), `{name:short}` shows four digits, `{name:fixed}` two
//! decimals, and `{name:percent}` hundred times the number. Several words may follow the colon.
//!
//! Lines are joined to paragraphs. A line that begins with `- ` opens a paragraph of its own, which
//! the pages show as an item of a list.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::sync::OnceLock;

use anyhow::{Context as _, Result, anyhow};
use serde::Deserialize;

use crate::experiment::Card;
use crate::experiment::inputs::Input;
use crate::model::section::{Act, Playground, Section};
use crate::model::table::{brief, brief_above, brief_below, short};
use crate::model::verdict::{Judgement, Verdict};

/// The words of an experiment, or of a part that several experiments share.
#[derive(Debug)]
pub(crate) struct Text {
    /// The name of the file, without its ending; the id of the experiment.
    id: &'static str,
    source: &'static str,
    parsed: OnceLock<Result<Parsed, String>>,
}

#[derive(Debug)]
struct Parsed {
    head: Head,
    /// The blocks by their headings.
    blocks: BTreeMap<&'static str, &'static str>,
}

/// The head: everything before the first heading.
#[derive(Debug, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
struct Head {
    title: String,
    act: Option<Act>,
    formulas: Vec<String>,
    commands: Vec<String>,
    edge_lengths_of: String,
    sources: Vec<String>,
    notation: Vec<String>,
    figures: Vec<String>,
    tables: Vec<String>,
    names: Vec<(String, String)>,
    playground: Option<String>,
}

/// A value for a placeholder.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Value {
    /// A number.
    Number(f64),
    /// A whole number.
    Count(usize),
    /// Words, such as the name of a mesh.
    Words(String),
}

impl From<f64> for Value {
    fn from(x: f64) -> Self {
        Self::Number(x)
    }
}

impl From<usize> for Value {
    fn from(n: usize) -> Self {
        Self::Count(n)
    }
}

impl From<&str> for Value {
    fn from(words: &str) -> Self {
        Self::Words(words.into())
    }
}

impl From<String> for Value {
    fn from(words: String) -> Self {
        Self::Words(words)
    }
}

/// Names of placeholders with what fills them: `values! { ratio: 1.0 / worst, mesh }`, where `mesh`
/// is a variable of that name.
macro_rules! values {
    (@value $name:ident) => { $crate::experiment::text::Value::from($name) };
    (@value $name:ident $value:expr) => { $crate::experiment::text::Value::from($value) };
    ($($name:ident $(: $value:expr)?),* $(,)?) => {
        &[$((stringify!($name), $crate::experiment::text::values!(@value $name $($value)?))),*]
    };
}
pub(crate) use values;

/// Placeholders and what fills them.
pub(crate) type Values<'a> = &'a [(&'static str, Value)];

impl Text {
    /// The words of a file of `text/`, by its name without ending and its content.
    pub(crate) const fn new(id: &'static str, source: &'static str) -> Self {
        Self { id, source, parsed: OnceLock::new() }
    }

    fn parsed(&self) -> Result<&Parsed> {
        let parsed = self.parsed.get_or_init(|| parse(self.source).map_err(|e| format!("{e:#}")));
        parsed.as_ref().map_err(|error| anyhow!("text/{}.md: {error}", self.id))
    }

    /// The block under a heading, its placeholders filled. Lines are joined to paragraphs.
    ///
    /// # Errors
    ///
    /// If there is no such heading, or a placeholder has no value.
    pub(crate) fn say(&self, heading: &str, values: Values<'_>) -> Result<String> {
        let block = self.parsed()?.blocks.get(heading);
        let block = block.with_context(|| format!("text/{}.md has no # {heading}", self.id))?;
        filled(&joined(block), values).with_context(|| format!("text/{}.md, # {heading}", self.id))
    }

    /// The description of the experiment: title, question, method, and its section. The values fill
    /// the method.
    ///
    /// # Panics
    ///
    /// If the file lacks a part, or a placeholder has no value; a test reads all cards.
    pub(crate) fn card(
        &'static self,
        inputs: &'static [Input],
        parameters: Vec<(&'static str, String)>,
        values: Values<'_>,
    ) -> Card {
        let card = self.described(inputs, parameters, values);
        card.unwrap_or_else(|error| panic!("{error:#}"))
    }

    /// As [`Self::say`], for words that are always needed.
    ///
    /// # Panics
    ///
    /// As [`Self::card`].
    pub(crate) fn words(&self, heading: &str, values: Values<'_>) -> String {
        self.say(heading, values).unwrap_or_else(|error| panic!("{error:#}"))
    }

    fn described(
        &'static self,
        inputs: &'static [Input],
        parameters: Vec<(&'static str, String)>,
        values: Values<'_>,
    ) -> Result<Card> {
        let head = &self.parsed()?.head;
        let playground = head.playground.as_ref().map(|kind| {
            let [caption, alt] = ["playground", "playground alt"].map(|h| self.say(h, &[]));
            anyhow::Ok(Playground { kind: kind.clone(), caption: caption?, alt: alt? })
        });
        Ok(Card {
            id: self.id,
            title: &head.title,
            question: self.say("question", &[])?,
            method: self.say("method", values)?,
            formulas: head.formulas.clone(),
            section: Section {
                act: head.act,
                bridge: self.say("bridge", &[])?,
                commands: head.commands.clone(),
                edge_lengths_of: head.edge_lengths_of.clone(),
                notation: head.notation.clone(),
                figures: head.figures.clone(),
                tables: head.tables.clone(),
                names: head.names.clone(),
                sources: head.sources.clone(),
                playground: playground.transpose()?,
            },
            inputs,
            parameters,
        })
    }

    /// The judgement of a claim: its words, and the reason and the finding that are written for
    /// this verdict (`# reason 3a confirmed`) or for any (`# reason 3a`).
    ///
    /// # Errors
    ///
    /// If the text has no reason for this verdict: it was written for another.
    pub(crate) fn judgement(
        &self,
        claim: &str,
        verdict: Verdict,
        values: Values<'_>,
    ) -> Result<Judgement> {
        let part = |kind: &str| -> Result<String> {
            let heading = format!("{kind} {claim}");
            let exact = format!("{heading} {}", verdict.key());
            let blocks = &self.parsed()?.blocks;
            let found = if blocks.contains_key(&*exact) { &exact } else { &heading };
            self.say(found, values).with_context(|| {
                format!(
                    "the verdict on claim {claim} is \"{verdict}\", for which nothing is written"
                )
            })
        };
        let words = self.say(&format!("claim {claim}"), values)?;
        let judgement = Judgement::new(claim, &words, verdict, part("reason")?);
        Ok(judgement.finding(part("finding")?))
    }
}

/// The lines of a block, joined to paragraphs with an empty line between them.
fn joined(block: &str) -> String {
    let block = block.replace("\n- ", "\n\n- ");
    let paragraphs = block.split("\n\n").filter(|paragraph| !paragraph.trim().is_empty());
    let paragraphs = paragraphs.map(|p| p.lines().map(str::trim).collect::<Vec<_>>().join(" "));
    paragraphs.map(|p| p.trim().to_string()).collect::<Vec<_>>().join("\n\n")
}

/// Head and blocks.
fn parse(source: &'static str) -> Result<Parsed> {
    let rest = source.strip_prefix("+++\n").context("it does not begin with +++")?;
    let (head, body) = rest.split_once("+++\n").context("its head has no end")?;
    let mut blocks = BTreeMap::new();
    for block in body.split("\n# ").skip(1) {
        let (heading, words) = block.split_once('\n').unwrap_or((block, ""));
        if blocks.insert(heading.trim(), words.trim()).is_some() {
            return Err(anyhow!("# {heading} occurs twice"));
        }
    }
    Ok(Parsed { head: toml::from_str(head)?, blocks })
}

/// The text with values in the place of placeholders.
fn filled(text: &str, values: Values<'_>) -> Result<String> {
    let mut out = String::new();
    let mut rest = text;
    while let Some((before, after)) = rest.split_once('{') {
        let (name, after) = after.split_once('}').context("a { without }")?;
        let (name, style) = name.split_once(':').unwrap_or((name, ""));
        let value = values.iter().find(|(known, _)| *known == name);
        let (_, value) = value.with_context(|| format!("{{{name}}} has no value"))?;
        out += before;
        out += &shown(value, style)?;
        rest = after;
    }
    Ok(out + rest)
}

fn shown<'a>(value: &'a Value, style: &str) -> Result<Cow<'a, str>> {
    let mut x = match value {
        Value::Words(words) => return Ok(words.as_str().into()),
        Value::Count(n) => return Ok(n.to_string().into()),
        Value::Number(x) => *x,
    };
    let mut show: fn(f64) -> String = brief;
    for word in style.split_whitespace() {
        match word {
            "up" => show = brief_above,
            "down" => show = brief_below,
            "short" => show = short,
            "fixed" => show = |x| format!("{x:.2}").replace('-', "−"),
            "percent" => x *= 100.0,
            _ => return Err(anyhow!("no style {word}")),
        }
    }
    Ok(show(x).into())
}

#[cfg(test)]
mod tests {
    use super::*;

    static TEXT: Text = Text::new(
        "q9",
        "+++\ntitle = \"T\"\n+++\n\n# method\n\nAt least {ratio:down}, at most\n{ratio:up}.\n\n\
         {mesh}: {left:percent} %.\n\n# claim 9a\n\nC.\n\n# reason 9a confirmed\n\nR {n}.\n\n# finding 9a\n\nF.\n",
    );

    #[test]
    fn placeholders_are_filled_and_bounds_rounded_outwards() {
        let values = values! { ratio: 6.871, mesh: "torus", left: 0.127 };
        let text = TEXT.say("method", values).unwrap();
        assert_eq!(text, "At least 6.8, at most 6.9.\n\ntorus: 13 %.");
        let error = format!("{:#}", TEXT.say("method", &[]).unwrap_err());
        assert!(error.contains("text/q9.md, # method") && error.contains("{ratio}"), "{error}");
    }

    #[test]
    fn lines_are_joined_and_items_are_kept_apart() {
        assert_eq!(joined("a\nb\n\n- c\n  d\n- e"), "a b\n\n- c d\n\n- e");
        assert_eq!(joined(""), "");
    }

    #[test]
    fn a_verdict_needs_its_own_words() {
        let values = values! { n: 3_usize };
        let found = TEXT.judgement("9a", Verdict::Confirmed, values).unwrap();
        assert_eq!((&*found.claim, &*found.reason, &*found.finding), ("C.", "R 3.", "F."));
        let error = format!("{:#}", TEXT.judgement("9a", Verdict::Refuted, values).unwrap_err());
        assert!(error.contains("\"wrong\", for which nothing is written"), "{error}");
    }
}
