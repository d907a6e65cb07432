//! A cursor over tokens and lines of text.

use std::borrow::Cow;

use crate::io::error::{Fault, ReadProblem, line_of, unexpected};
use crate::io::number::{self, is_delimiter};

/// The text with `\n` in place of lone `\r` line ends. `\r\n` stays, since `\r` is white space.
pub(crate) fn normalized(bytes: &[u8]) -> Cow<'_, [u8]> {
    let first = bytes.iter().position(|&b| b == b'\n' || b == b'\r');
    let lone = first.is_some_and(|at| bytes[at] == b'\r' && bytes.get(at + 1) != Some(&b'\n'));
    if lone && !bytes.contains(&b'\n') {
        Cow::Owned(bytes.iter().map(|&b| if b == b'\r' { b'\n' } else { b }).collect())
    } else {
        Cow::Borrowed(bytes)
    }
}

/// A reader of tokens separated by white space. A comment begins with the byte
/// `comment`, if given, and runs to the end of its line.
#[derive(Clone)]
pub(crate) struct Cursor<'a> {
    text: &'a [u8],
    at: usize,
    comment: Option<u8>,
}

impl<'a> Cursor<'a> {
    pub(crate) fn new(text: &'a [u8], at: usize, comment: Option<u8>) -> Self {
        Self { text, at, comment }
    }

    /// The number of bytes left, a bound on any count in the text.
    pub(crate) fn remaining(&self) -> usize {
        self.text.len() - self.at
    }

    /// The text that is left.
    pub(crate) fn rest(&self) -> &'a [u8] {
        &self.text[self.at..]
    }

    /// The number of the line at the cursor, from 1.
    pub(crate) fn line(&self) -> u64 {
        line_of(self.text, self.at)
    }

    /// Skips bytes of the token at the cursor.
    pub(crate) fn skip(&mut self, bytes: usize) {
        self.at = (self.at + bytes).min(self.text.len());
    }

    pub(crate) fn fault(&self, problem: ReadProblem) -> Fault {
        Fault::on_line(self.text, self.at, problem)
    }

    /// Moves to the next token of this line; false at the end of the line.
    #[inline]
    pub(crate) fn more_on_line(&mut self) -> bool {
        while let Some(&byte) = self.text.get(self.at) {
            if byte == b'\n' {
                return false;
            } else if is_delimiter(byte) {
                self.at += 1;
            } else if Some(byte) == self.comment {
                self.skip_line();
                return false;
            } else {
                return true;
            }
        }
        false
    }

    /// Moves to the next token on this line or a later one; false at the end.
    #[inline]
    pub(crate) fn more(&mut self) -> bool {
        while !self.more_on_line() {
            if self.at >= self.text.len() {
                return false;
            }
            self.at += 1;
        }
        true
    }

    /// Moves to the end of the line, before its `\n`.
    pub(crate) fn skip_line(&mut self) {
        let rest = &self.text[self.at..];
        self.at += rest.iter().position(|&b| b == b'\n').unwrap_or(rest.len());
    }

    /// The token at the cursor, which does not move.
    pub(crate) fn peek(&self) -> &'a [u8] {
        &self.text[self.at..number::token_end(self.text, self.at)]
    }

    /// Takes the next token, on any line.
    pub(crate) fn token(&mut self) -> Option<&'a [u8]> {
        if !self.more() {
            return None;
        }
        let token = self.peek();
        self.at += token.len();
        Some(token)
    }

    /// The token at the cursor, for an error message.
    pub(crate) fn found(&self) -> String {
        match self.text.get(self.at) {
            None => "the end of the file".to_owned(),
            Some(b'\n') => "the end of the line".to_owned(),
            Some(_) => shown(self.peek()),
        }
    }

    /// Takes the next token, on any line, as a number.
    #[inline]
    pub(crate) fn float(&mut self, what: &str) -> Result<f64, Fault> {
        if self.more()
            && let Some((value, end)) = number::float(self.text, self.at)
        {
            self.at = end;
            return Ok(value);
        }
        Err(self.fault(unexpected(what, self.found())))
    }

    /// Takes the next token, on any line, as an integer.
    #[inline]
    pub(crate) fn integer(&mut self, what: &str) -> Result<i64, Fault> {
        if self.more()
            && let Some((value, end)) = number::integer(self.text, self.at)
            && self.text.get(end).is_none_or(|&b| is_delimiter(b))
        {
            self.at = end;
            return Ok(value);
        }
        Err(self.fault(unexpected(what, self.found())))
    }

    /// Takes the next token, on any line, as a count.
    pub(crate) fn count(&mut self, what: &str) -> Result<u64, Fault> {
        let before = self.clone();
        let value = self.integer(what)?;
        u64::try_from(value).map_err(|_| {
            let mut at = before;
            at.more();
            at.fault(unexpected(what, value.to_string()))
        })
    }

    /// Fails if more than white space and comments is left.
    pub(crate) fn expect_end(&mut self, after: &str) -> Result<(), Fault> {
        if self.more() {
            let expected = format!("the end of the file after {after}");
            return Err(self.fault(unexpected(expected, self.found())));
        }
        Ok(())
    }
}

/// A token for an error message: quoted, and shortened if long.
pub(crate) fn shown(token: &[u8]) -> String {
    let text = String::from_utf8_lossy(&token[..token.len().min(40)]);
    if token.len() > 40 { format!("{text:?}…") } else { format!("{text:?}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_and_comments_are_told_apart() {
        let mut c = Cursor::new(b"1 2 # x\n\n 3\t4\r\n", 0, Some(b'#'));
        assert_eq!(c.integer("").unwrap(), 1);
        assert!(c.more_on_line());
        assert_eq!(c.integer("").unwrap(), 2);
        assert!(!c.more_on_line());
        assert_eq!(c.float("").unwrap(), 3.0);
        assert_eq!(c.token(), Some(&b"4"[..]));
        assert!(c.expect_end("4").is_ok());
    }

    #[test]
    fn lone_carriage_returns_end_lines() {
        assert_eq!(&normalized(b"a\rb\r")[..], b"a\nb\n");
        assert_eq!(&normalized(b"a\r\nb")[..], b"a\r\nb");
    }
}
