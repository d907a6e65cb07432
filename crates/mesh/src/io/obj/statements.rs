//! Objects, groups, materials and smoothing groups of the faces of an OBJ file.

use std::collections::HashMap;

/// The statements that hold for all faces after them, in the order in which they are written.
const WORDS: [&str; 4] = ["o", "g", "usemtl", "s"];

/// The number of a keyword in [`WORDS`].
pub(super) fn keyword(word: &[u8]) -> Option<usize> {
    WORDS.iter().position(|known| known.as_bytes() == word)
}

/// Objects, groups, materials and smoothing groups of faces, and the files of materials, as an
/// OBJ file states them. OBJ files get them back; the other formats do not hold them.
///
/// Names are bytes, since OBJ has no encoding.
#[derive(Debug, Clone, Default)]
pub struct Statements {
    /// The files of materials (`mtllib`).
    pub libraries: Vec<Vec<u8>>,
    labels: [Labels; 4],
}

/// Names of faces, each stored once.
#[derive(Debug, Clone, Default)]
struct Labels {
    names: Vec<Vec<u8>>,
    /// The number of the name of each face, [`NONE`] before the first; empty without names.
    of: Vec<u32>,
}

/// The label of faces before the first statement.
const NONE: u32 = u32::MAX;

/// A statement in a piece of a file: the number of the faces of the piece before it, the
/// keyword, `None` for `mtllib`, and its text.
pub(super) type Stated = (usize, Option<usize>, Vec<u8>);

/// The text of a statement on one line: without continuations, and with nothing at its end that
/// would continue it.
pub(super) fn one_line(text: &[u8]) -> Vec<u8> {
    let mut line = text.to_vec();
    for k in 0..line.len() {
        let breaks = |at: usize| matches!(text.get(at), Some(b'\n' | b'\r'));
        if breaks(k) || (text[k] == b'\\' && breaks(k + 1)) {
            line[k] = b' ';
        }
    }
    let is_end = |b: &u8| b.is_ascii_whitespace() || *b == b'\\';
    line.truncate(line.iter().rposition(|b| !is_end(b)).map_or(0, |last| last + 1));
    line.trim_ascii_start().to_vec()
}

impl Statements {
    /// Returns true if the file has neither material libraries nor labels.
    pub fn is_empty(&self) -> bool {
        self.libraries.is_empty() && self.labels.iter().all(|labels| labels.of.is_empty())
    }

    /// The name of face `f` that the statement `keyword` (`o`, `g`, `usemtl` or `s`) gives.
    pub fn name(&self, keyword: &str, f: usize) -> Option<&[u8]> {
        let k = self::keyword(keyword.as_bytes())?;
        let Labels { names, of } = &self.labels[k];
        names.get(*of.get(f)? as usize).map(|name| &name[..])
    }

    /// The number of faces, if they have names.
    pub(crate) fn faces(&self) -> Option<usize> {
        self.labels.iter().map(|labels| labels.of.len()).find(|&count| count > 0)
    }

    /// Returns true if two faces have the same names.
    pub(crate) fn agree(&self, a: usize, b: usize) -> bool {
        self.labels.iter().all(|labels| labels.of.is_empty() || labels.of[a] == labels.of[b])
    }

    /// The statements of other faces: face `k` of the result has the names of face `of[k]`.
    pub(crate) fn selected(&self, of: &[usize]) -> Self {
        let select = |labels: &Labels| {
            let own = |_: &u32| of.iter().map(|&f| labels.of[f]).collect();
            Labels { names: labels.names.clone(), of: labels.of.first().map_or(vec![], own) }
        };
        Self { libraries: self.libraries.clone(), labels: self.labels.each_ref().map(select) }
    }

    /// The statements that tell faces apart or give them materials, in words.
    pub(crate) fn lost(&self) -> Option<String> {
        let words = ["objects", "groups", "materials", "smoothing groups"];
        let matters = |k: usize| {
            let of = &self.labels[k].of;
            of.windows(2).any(|pair| pair[0] != pair[1]) || (k == 2 && !of.is_empty())
        };
        let lost: Vec<&str> = (0..4).filter(|&k| matters(k)).map(|k| words[k]).collect();
        (!lost.is_empty()).then(|| lost.join(", "))
    }

    /// Collects the statements of pieces, each with its number of faces.
    pub(super) fn of_pieces<'a>(pieces: impl Iterator<Item = (usize, &'a [Stated])>) -> Self {
        let mut all = Self::default();
        let mut known: [HashMap<&[u8], u32>; 4] = Default::default();
        let mut current = [NONE; 4];
        let mut before = 0;
        for (faces, statements) in pieces {
            for (face, keyword, text) in statements {
                let Some(k) = *keyword else {
                    all.libraries.push(text.clone());
                    continue;
                };
                let Labels { names, of } = &mut all.labels[k];
                of.resize(before + face, current[k]);
                current[k] = *known[k].entry(text).or_insert_with(|| {
                    names.push(text.clone());
                    names.len() as u32 - 1
                });
            }
            before += faces;
        }
        for (labels, current) in all.labels.iter_mut().zip(current) {
            if !labels.names.is_empty() {
                labels.of.resize(before, current);
            }
        }
        all
    }

    /// The statements as they are written: the face that each stands before, its keyword and its
    /// text.
    pub fn runs(&self) -> Vec<(usize, &'static str, &[u8])> {
        let libraries = self.libraries.iter().map(|name| (0, "mtllib", &name[..]));
        let changes = (0..self.faces().unwrap_or(0)).flat_map(|f| self.changes_at(f));
        let changes = changes.map(|(f, k, name)| (f, WORDS[k], name));
        libraries.chain(changes).collect()
    }

    /// The statements of that many faces from [their runs](Self::runs), those of other keywords
    /// left out.
    pub fn from_runs<'a>(
        faces: usize,
        runs: impl IntoIterator<Item = (usize, &'a str, &'a [u8])>,
    ) -> Self {
        let stated = runs.into_iter().filter_map(|(f, word, text)| {
            let keyword = WORDS.iter().position(|&known| known == word);
            (keyword.is_some() || word == "mtllib").then(|| (f.min(faces), keyword, one_line(text)))
        });
        let mut stated: Vec<Stated> = stated.collect();
        stated.sort_by_key(|&(f, ..)| f);
        Self::of_pieces(std::iter::once((faces, &stated[..])))
    }

    /// The kinds of names that change between the face before `f` and `f`, with the new names.
    fn changes_at(&self, f: usize) -> impl Iterator<Item = (usize, usize, &[u8])> {
        self.labels.iter().enumerate().filter_map(move |(k, Labels { names, of })| {
            let own = *of.get(f)?;
            let earlier = if f == 0 { NONE } else { of[f - 1] };
            let name = names.get(own as usize).map_or(&b""[..], |name| name);
            (own != earlier).then_some((f, k, name))
        })
    }

    /// Appends the lines that change the names between the face before `f` and `f`.
    pub(super) fn write_before(&self, f: usize, text: &mut Vec<u8>) {
        for (_, k, name) in self.changes_at(f) {
            write_line(WORDS[k].as_bytes(), name, text);
        }
    }
}

/// Statements are equal if they are written alike.
impl PartialEq for Statements {
    fn eq(&self, other: &Self) -> bool {
        self.runs() == other.runs()
    }
}

/// Appends a statement.
pub(super) fn write_line(keyword: &[u8], value: &[u8], text: &mut Vec<u8>) {
    text.extend_from_slice(keyword);
    if !value.is_empty() {
        text.push(b' ');
        text.extend_from_slice(value);
    }
    text.push(b'\n');
}
