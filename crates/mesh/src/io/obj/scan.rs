//! Lexical structure of OBJ: statements, comments and continued lines.

use std::ops::Range;

use crate::io::number::is_delimiter;

/// Every keyword of the format, in the order of its specification.
const KEYWORDS: [&[u8]; 42] = [
    b"v",
    b"vt",
    b"vn",
    b"vp",
    b"cstype",
    b"deg",
    b"bmat",
    b"step",
    b"p",
    b"l",
    b"f",
    b"fo",
    b"curv",
    b"curv2",
    b"surf",
    b"parm",
    b"trim",
    b"hole",
    b"scrv",
    b"sp",
    b"end",
    b"con",
    b"g",
    b"s",
    b"mg",
    b"o",
    b"bevel",
    b"c_interp",
    b"d_interp",
    b"lod",
    b"usemtl",
    b"usemap",
    b"mtllib",
    b"maplib",
    b"shadow_obj",
    b"trace_obj",
    b"ctech",
    b"stech",
    b"call",
    b"csh",
    b"bzp",
    b"cdc",
];

pub(super) fn is_keyword(word: &[u8]) -> bool {
    KEYWORDS.contains(&word)
}

/// Skips white space and continued line ends (`\` before the end of a line).
#[inline]
pub(super) fn skip_blanks(text: &[u8], mut at: usize) -> usize {
    loop {
        match text.get(at) {
            Some(b' ' | b'\t' | b'\r' | b'\x0b' | b'\x0c') => at += 1,
            Some(b'\\') => match &text[at + 1..] {
                [b'\n', ..] => at += 2,
                [b'\r', b'\n', ..] => at += 3,
                _ => return at,
            },
            _ => return at,
        }
    }
}

/// Returns true at the end of a statement: the end of a line or of the text, or a
/// comment.
#[inline]
pub(super) fn ends(text: &[u8], at: usize) -> bool {
    matches!(text.get(at), None | Some(b'\n' | b'#'))
}

/// The start of the next line, even if this line is continued.
pub(super) fn next_line(text: &[u8], at: usize) -> usize {
    text[at..].iter().position(|&b| b == b'\n').map_or(text.len(), |n| at + n + 1)
}

/// The start of the next statement; lines that end in `\` are continued.
pub(super) fn next_statement(text: &[u8], at: usize) -> usize {
    let mut next = next_line(text, at);
    while is_continued(text, next) && next < text.len() {
        next = next_line(text, next);
    }
    next
}

/// Returns true if the line that ends before `next` is continued there.
fn is_continued(text: &[u8], next: usize) -> bool {
    let line = text[..next].strip_suffix(b"\n").unwrap_or(b"");
    line.strip_suffix(b"\r").unwrap_or(line).ends_with(b"\\")
}

/// Splits the text between statements into pieces of about `size` bytes.
pub(super) fn split(text: &[u8], size: usize) -> Vec<Range<usize>> {
    let mut ranges = Vec::with_capacity(text.len() / size + 1);
    let mut start = 0;
    while start < text.len() {
        let end = next_statement(text, (start + size).min(text.len()));
        ranges.push(start..end);
        start = end;
    }
    ranges
}

/// The end of the word that begins at `at`.
pub(super) fn word_end(text: &[u8], at: usize) -> usize {
    let ends = |&b: &u8| is_delimiter(b) || b == b'#';
    text[at..].iter().position(ends).map_or(text.len(), |n| at + n)
}

/// The keyword of the first statement after comments and blank lines.
pub(super) fn first_keyword(text: &[u8]) -> Option<Vec<u8>> {
    let mut at = 0;
    while at < text.len() {
        at = skip_blanks(text, at);
        if !ends(text, at) {
            return Some(text[at..word_end(text, at)].to_vec());
        }
        at = next_line(text, at);
    }
    None
}

/// The offset of the `n`-th face of a range.
pub(super) fn face_statement(text: &[u8], range: Range<usize>, n: usize) -> usize {
    let mut at = range.start;
    let mut seen = 0;
    while at < range.end {
        let start = skip_blanks(text, at);
        if ends(text, start) {
            at = next_line(text, start);
            continue;
        }
        let word = &text[start..word_end(text, start)];
        if matches!(word.strip_suffix(b"\\").unwrap_or(word), b"f" | b"fo") {
            if seen == n {
                return start;
            }
            seen += 1;
        }
        at = next_statement(text, start);
    }
    range.end
}
