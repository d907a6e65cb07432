//! Paragraphs and items of lists in words that several pages show.

/// A part of a text.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Paragraph<'a> {
    /// An item of a list, without its mark.
    Item(&'a str),
    /// Any other paragraph.
    Plain(&'a str),
}

/// The paragraphs, which empty lines part; one that begins with `- ` is an item.
pub(crate) fn paragraphs(text: &str) -> impl Iterator<Item = Paragraph<'_>> {
    let parts = text.split("\n\n").filter(|part| !part.is_empty());
    parts.map(|part| part.strip_prefix("- ").map_or(Paragraph::Plain(part), Paragraph::Item))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn items_have_a_mark() {
        let found: Vec<Paragraph<'_>> = paragraphs("a\n\n- b\n\n- c - d").collect();
        assert_eq!(found, [Paragraph::Plain("a"), Paragraph::Item("b"), Paragraph::Item("c - d")]);
    }
}
