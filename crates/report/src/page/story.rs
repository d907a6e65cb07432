//! Order of the experiments as an article: the title, the rules for a student, and three acts.
//! Numbers come from the results; none is written here.

use crate::experiment::text::{Text, values};
use crate::model::results::{Record, Results};
use crate::model::section;
use crate::model::verdict::Verdict;

/// The title of the report.
pub(crate) const TITLE: &str = "What the Laplacian says about a mesh, and what it does to it";

static TEXT: Text = Text::new("story", include_str!("../../text/story.md"));

/// Smoothing in two sentences, before anything is named.
pub(crate) fn idea() -> String {
    TEXT.words("idea", &[])
}

/// The question that the first playground raises.
pub(crate) fn question() -> String {
    TEXT.words("question", &[])
}

/// The playground that opens the report.
pub(crate) fn first_playground() -> section::Playground {
    let [caption, alt] = ["opening", "opening alt"].map(|heading| TEXT.words(heading, &[]));
    section::Playground { kind: "opening".into(), caption, alt }
}

/// The subject of the report, and whether generated meshes take the place of the assignment's.
pub(crate) fn about(results: &Results) -> String {
    let mut about = TEXT.words("about", &[]);
    if results.experiments.iter().flat_map(|r| &r.inputs).any(|input| input.stand_in) {
        about = format!("{about} {}", TEXT.words("stand-ins", &[]));
    }
    about
}

/// The forms of the report, and the command that makes them.
pub(crate) fn forms() -> String {
    TEXT.words("forms", &[])
}

/// The meaning of the verdicts.
pub(crate) fn verdicts() -> String {
    TEXT.words("verdicts", &[])
}

/// The lead of the list of meshes.
pub(crate) fn meshes() -> String {
    TEXT.words("meshes", &[])
}

/// The lead of the list of files.
pub(crate) fn files() -> String {
    TEXT.words("files", &[])
}

/// The meshes that take the place of the assignment's, each with the name of that.
pub(crate) fn replaced(pairs: &str) -> String {
    TEXT.words("replaced", values! { pairs })
}

/// A part of the article.
pub(crate) struct Act {
    /// Its name in links.
    pub(crate) id: &'static str,
    pub(crate) title: &'static str,
    act: section::Act,
}

pub(crate) const ACTS: [Act; 3] = [
    Act { act: section::Act::Curvature, id: "act-curvature", title: "I. Measuring curvature" },
    Act { act: section::Act::Spectrum, id: "act-spectrum", title: "II. A shape as a spectrum" },
    Act {
        act: section::Act::Diffusion,
        id: "act-diffusion",
        title: "III. Diffusion and denoising",
    },
];

/// The number of claims of the original report that hold, in a sentence; empty without claims.
pub(crate) fn tally(results: &Results) -> String {
    let counts = VERDICTS.map(|verdict| (results.judged(verdict).len(), verdict));
    let total: usize = counts.iter().map(|(count, _)| count).sum();
    let mut counts = counts.iter().filter(|(count, _)| *count > 0);
    match (total, counts.next()) {
        (_, None) => String::new(),
        (1, Some((_, verdict))) => format!("The original report's one claim is {verdict}."),
        (_, Some((count, verdict))) => {
            let verb = if *count == 1 { "is" } else { "are" };
            let others = counts.map(|(count, verdict)| format!(", {} {verdict}", in_words(*count)));
            let (total, count) = (in_words(total), in_words(*count));
            let others: String = others.collect();
            format!("Of the original report's {total} claims {count} {verb} {verdict}{others}.")
        }
    }
}

/// A count as a word, up to twelve.
fn in_words(count: usize) -> String {
    const WORDS: [&str; 13] = [
        "no", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten",
        "eleven", "twelve",
    ];
    WORDS.get(count).map_or_else(|| count.to_string(), ToString::to_string)
}

impl Act {
    /// Its subject, in a sentence or two.
    pub(crate) fn about(&self) -> String {
        TEXT.words(&self.id.replace("act-", "act "), &[])
    }

    /// The experiments of this act that were run.
    pub(crate) fn sections<'a>(&self, results: &'a Results) -> impl Iterator<Item = &'a Record> {
        let act = self.act;
        results.experiments.iter().filter(move |record| record.section.act == Some(act))
    }
}

/// Experiments that belong to no act, in their order.
pub(crate) fn others(results: &Results) -> impl Iterator<Item = &Record> {
    results.experiments.iter().filter(|record| record.section.act.is_none())
}

/// The experiments in the order of the article.
pub(crate) fn in_order(results: &Results) -> Vec<&Record> {
    ACTS.iter().flat_map(|act| act.sections(results)).chain(others(results)).collect()
}

/// A rule for the student: the claim behind it, and the verdicts from which it follows.
pub(crate) struct Rule {
    pub(crate) claim: &'static str,
    follows: &'static [Verdict],
}

impl Rule {
    /// The advice.
    pub(crate) fn text(&self) -> String {
        TEXT.words(&format!("rule {}", self.claim), &[])
    }
}

/// The verdicts in the order in which they are counted.
pub(crate) const VERDICTS: [Verdict; 4] =
    [Verdict::Refuted, Verdict::Qualified, Verdict::Confirmed, Verdict::Undecided];

/// Advice to the student.
const RULES: [Rule; 6] = [
    Rule { claim: "3a", follows: &[Verdict::Qualified, Verdict::Confirmed] },
    Rule { claim: "1a", follows: &[Verdict::Refuted, Verdict::Qualified] },
    Rule { claim: "2a", follows: &[Verdict::Refuted] },
    Rule { claim: "5a", follows: &[Verdict::Qualified, Verdict::Confirmed] },
    Rule { claim: "6b", follows: &[Verdict::Refuted, Verdict::Qualified] },
    Rule { claim: "7a", follows: &[Verdict::Qualified, Verdict::Refuted] },
];

/// The rules that follow from these results.
pub(crate) fn rules(results: &Results) -> Vec<&'static Rule> {
    let claims = results.claims();
    let follows = |rule: &&Rule| {
        claims.iter().any(|(_, c)| c.id == rule.claim && rule.follows.contains(&c.verdict))
    };
    RULES.iter().filter(follows).collect()
}

#[cfg(test)]
mod tests {
    use crate::model::verdict::Judgement;

    use super::*;

    fn results(claims: &[(&str, Verdict)]) -> Results {
        let claim = |&(id, verdict): &(&str, Verdict)| Judgement::new(id, "It is so", verdict, "");
        let claims = claims.iter().map(claim).collect();
        let provenance = crate::model::provenance::Provenance::default();
        let experiments = vec![Record { claims, ..Record::default() }];
        Results { provenance, form: Default::default(), experiments }
    }

    /// Words that are always needed are in the texts: without them a program would end.
    #[test]
    fn every_text_has_its_words() {
        let opening = [idea(), question(), first_playground().caption];
        let opening = opening.into_iter().chain([
            forms(),
            verdicts(),
            meshes(),
            files(),
            replaced("a for b"),
        ]);
        let acts = ACTS.iter().map(Act::about);
        let rules = RULES.iter().map(Rule::text);
        let methods = crate::experiments::ALL.iter().map(|experiment| experiment.card().method);
        for words in opening.chain(acts).chain(rules).chain(methods) {
            assert!(!words.is_empty() && !words.contains('{'), "{words}");
        }
    }

    #[test]
    fn the_opening_counts_the_claims_and_rules_follow_from_them() {
        let none = results(&[]);
        assert_eq!((tally(&none), rules(&none).len()), (String::new(), 0));
        let one = results(&[("4a", Verdict::Confirmed)]);
        assert_eq!(tally(&one), "The original report's one claim is right.");
        let some =
            [("2a", Verdict::Refuted), ("5a", Verdict::Qualified), ("7a", Verdict::Qualified)];
        let some = results(&some);
        let expected = "Of the original report's three claims one is wrong, two half right.";
        assert_eq!(tally(&some), expected);
        let claims: Vec<&str> = rules(&some).iter().map(|rule| rule.claim).collect();
        assert_eq!(claims, ["2a", "5a", "7a"]);
    }
}
