//! The sources of the sections, with links, from the bibliography of the repository.

use crate::model::results::Results;

const SOURCE: &str = include_str!("../../../../docs/bibliography.bib");

/// A source.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(crate) struct Entry {
    /// The key in the bibliography.
    pub(crate) key: String,
    /// First names first, separated by commas.
    pub(crate) authors: String,
    /// Last names and year, as in text: `Desbrun et al. 1999`.
    pub(crate) short: String,
    pub(crate) title: String,
    /// Journal or book with volume and pages, or the publisher, and the year.
    pub(crate) place: String,
    /// The address, a DOI where there is one; may be empty.
    pub(crate) url: String,
}

/// The source of this key; `None` if the bibliography has none.
pub(crate) fn entry(key: &str) -> Option<Entry> {
    let start = SOURCE.find(&format!("{{{key},\n"))?;
    let body = SOURCE[start..].split_once('\n')?.1;
    let body = body.split_once("\n}").map_or(body, |(body, _)| body);
    let field = |name: &str| -> String {
        let line = body
            .lines()
            .find(|line| line.split_once('=').is_some_and(|(found, _)| found.trim() == name));
        let value = line.and_then(|line| line.split_once('=')).map_or("", |(_, value)| value);
        plain(value.trim().trim_end_matches(',').trim_start_matches('{').trim_end_matches('}'))
    };
    let people: Vec<[String; 2]> = field("author").split(" and ").map(split_name).collect();
    let authors: Vec<String> = people.iter().map(|n| n.join(" ").trim().to_string()).collect();
    let year = field("year");
    let names = match &people[..] {
        [[_, one]] => one.clone(),
        [[_, one], [_, two]] => format!("{one} and {two}"),
        [[_, one], ..] => format!("{one} et al."),
        [] => String::new(),
    };
    let doi = field("doi");
    Some(Entry {
        key: key.into(),
        authors: authors.join(", "),
        short: format!("{names} {year}"),
        title: field("title"),
        place: place(&field, &year),
        url: if doi.is_empty() { field("url") } else { format!("https://doi.org/{doi}") },
    })
}

/// The sources of these keys, as far as the bibliography has them. Where two would be cited alike,
/// the initial of the first author tells them apart.
pub(crate) fn cited(keys: &[String]) -> Vec<Entry> {
    let mut entries: Vec<Entry> = keys.iter().filter_map(|key| entry(key)).collect();
    let shorts: Vec<String> = entries.iter().map(|entry| entry.short.clone()).collect();
    for entry in &mut entries {
        let alike = shorts.iter().filter(|short| **short == entry.short).count();
        if let Some(initial) = entry.authors.chars().next().filter(|_| alike > 1) {
            entry.short = format!("{initial}. {}", entry.short);
        }
    }
    entries
}

/// The first and the last names in `Last, First` or `First Last`; particles, which begin with a
/// small letter, belong to the last name.
fn split_name(name: &str) -> [String; 2] {
    if let Some((last, first)) = name.split_once(", ") {
        return [first.into(), last.into()];
    }
    let words: Vec<&str> = name.split(' ').collect();
    let particle = words.iter().position(|word| word.starts_with(char::is_lowercase));
    let (first, last) = words.split_at(particle.unwrap_or(words.len() - 1));
    [first.join(" "), last.join(" ")]
}

/// Journal or book, volume and pages, or the publisher, and the year.
fn place(field: &impl Fn(&str) -> String, year: &str) -> String {
    let names = ["journal", "booktitle", "publisher", "school", "institution", "howpublished"];
    let mut text = names.into_iter().map(field).find(|s| !s.is_empty()).unwrap_or_default();
    let (volume, number, pages) = (field("volume"), field("number"), field("pages"));
    if !volume.is_empty() {
        text += &format!(" {volume}");
    }
    if !number.is_empty() {
        text += &format!("({number})");
    }
    if !pages.is_empty() {
        text += &format!(", {pages}");
    }
    if text.is_empty() { year.into() } else { format!("{text}, {year}") }
}

/// TeX as plain text: accents and braces.
fn plain(tex: &str) -> String {
    const ACCENTS: [(&str, &str); 10] = [
        (r"{\'e}", "é"),
        (r"{\'a}", "á"),
        (r"{\`e}", "è"),
        (r#"{\"o}"#, "ö"),
        (r#"{\"u}"#, "ü"),
        (r#"{\"a}"#, "ä"),
        (r"{\ae}", "æ"),
        (r"{\o}", "ø"),
        (r"\&", "&"),
        ("--", "–"),
    ];
    let text = ACCENTS.iter().fold(tex.to_string(), |text, (from, to)| text.replace(from, to));
    text.replace(['{', '}', '$'], "").replace('`', "‘").replace('\'', "’")
}

/// The sources of all sections, in the order of the names, with the ids of the sections.
pub(crate) fn of(results: &Results) -> Vec<(Entry, Vec<&str>)> {
    let mut all: Vec<(Entry, Vec<&str>)> = vec![];
    for record in &results.experiments {
        for key in &record.section.sources {
            if let Some((_, sections)) = all.iter_mut().find(|(entry, _)| entry.key == *key) {
                sections.push(&record.id);
            } else if let Some(entry) = entry(key) {
                all.push((entry, vec![&record.id]));
            }
        }
    }
    all.sort_by(|a, b| a.0.short.cmp(&b.0.short));
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn entries_are_plain_text_with_links() {
        let found = entry("desbrun1999").unwrap();
        assert_eq!(found.short, "Desbrun et al. 1999");
        assert_eq!(found.authors, "Mathieu Desbrun, Mark Meyer, Peter Schröder, Alan H. Barr");
        assert_eq!(
            found.title,
            "Implicit Fairing of Irregular Meshes Using Diffusion and Curvature Flow"
        );
        assert_eq!(found.place, "SIGGRAPH, 317–324, 1999");
        assert_eq!(found.url, "https://doi.org/10.1145/311535.311576");
        assert_eq!(entry("vallet2008").unwrap().short, "Vallet and Lévy 2008");
        assert_eq!(entry("nobody1900"), None);
        let karni = entry("karni2000").unwrap();
        assert_eq!(karni.short, "Karni and Gotsman 2000");
        assert_eq!(karni.authors, "Zachi Karni, Craig Gotsman");
        assert_eq!(entry("docarmo1976").unwrap().short, "do Carmo 1976");
    }

    #[test]
    fn sources_cited_alike_are_told_apart() {
        let keys = ["zhang2015", "zhang2015variational", "desbrun1999"].map(String::from);
        let shorts: Vec<String> = cited(&keys).into_iter().map(|entry| entry.short).collect();
        assert_eq!(shorts, ["W. Zhang et al. 2015", "H. Zhang et al. 2015", "Desbrun et al. 1999"]);
    }

    #[test]
    fn no_entry_keeps_its_tex() {
        let keys = SOURCE.lines().filter_map(|line| line.strip_prefix('@')?.split_once('{'));
        let keys: Vec<&str> = keys.map(|(_, rest)| rest.trim_end_matches(',')).collect();
        assert!(keys.len() > 50);
        for key in keys {
            let Entry { authors, title, place, .. } = entry(key).unwrap();
            assert!(!authors.is_empty() && !title.is_empty() && !place.is_empty(), "{key}");
            for text in [authors, title, place] {
                assert!(!text.contains(['\\', '{', '}']), "{key}: {text}");
            }
        }
    }
}
