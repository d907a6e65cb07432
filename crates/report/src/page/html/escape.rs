//! Words and data as HTML.

use crate::page::prose::{self, Paragraph};

/// Text for use between tags or in a quoted attribute.
pub(super) fn escape(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
        .replace('\'', "&#39;")
}

/// Text in which `` `words` `` are code.
pub(super) fn with_code(text: &str) -> String {
    let mut html = String::new();
    let mut rest = text;
    while let Some((before, (code, after))) =
        rest.split_once('`').and_then(|(before, after)| Some((before, after.split_once('`')?)))
    {
        html += &format!("{}<code>{}</code>", escape(before), escape(code));
        rest = after;
    }
    html + &escape(rest)
}

/// Paragraphs and lists, with code.
pub(super) fn paragraphs(text: &str) -> String {
    let mut html = String::new();
    for part in prose::paragraphs(text) {
        html += &match part {
            Paragraph::Item(words) => format!("<ul><li>{}</li></ul>", with_code(words)),
            Paragraph::Plain(words) => format!("<p>{}</p>", with_code(words)),
        };
    }
    // Items in a row are one list.
    html.replace("</ul><ul>", "")
}

/// JSON for use inside a `<script>`: nothing in it can end the element.
pub(super) fn script_json(value: &serde_json::Value) -> String {
    value.to_string().replace('<', "\\u003c")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_breaks_out() {
        assert_eq!(escape("<a b='\"'>&"), "&lt;a b=&#39;&quot;&#39;&gt;&amp;");
        assert_eq!(with_code("a `b<c` d"), "a <code>b&lt;c</code> d");
        assert_eq!(with_code("a ` <"), "a ` &lt;");
        let listed = "<p>a</p><ul><li>b</li><li>&lt;</li></ul>";
        assert_eq!(paragraphs("a\n\n- b\n\n- <"), listed);
        let value = serde_json::json!("</script><!--");
        let text = script_json(&value);
        assert!(!text.contains('<'));
        assert_eq!(serde_json::from_str::<serde_json::Value>(&text).unwrap(), value);
    }
}
