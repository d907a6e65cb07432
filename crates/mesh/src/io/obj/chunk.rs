//! One piece of an OBJ file, parsed independently of the others.

use std::ops::Range;

use crate::io::error::{ReadProblem, unexpected};
use crate::io::number::{self, is_delimiter};
use crate::io::obj::indices::Indices;
use crate::io::obj::scan::{ends, is_keyword, next_line, next_statement, skip_blanks, word_end};
use crate::io::obj::statements::{Stated, keyword, one_line};
use crate::io::parsed::{Broken, NO_VERTEX, check_finite};
use crate::io::text::shown;
use crate::polygon::Polygons;

/// The content of a piece. Indices count from 0; relative ones (negative in the
/// file) are resolved once the number of vertices before the piece is known.
#[derive(Default)]
pub(super) struct Chunk {
    pub(super) range: Range<usize>,
    pub(super) positions: Vec<[f64; 3]>,
    pub(super) colors: Vec<[f64; 3]>,
    pub(super) texture: Vec<[f64; 2]>,
    pub(super) normals: Vec<[f64; 3]>,
    /// The texture coordinates and normals of the corners of `polygons`.
    pub(super) texture_of: Indices,
    pub(super) normal_of: Indices,
    pub(super) polygons: Polygons,
    pub(super) stated: Vec<Stated>,
    /// Corners with relative indices, and the index from the first vertex of the
    /// piece; from that of the file once resolved.
    relative: Vec<(usize, i64)>,
    pub(super) largest: i64,
    pub(super) smallest: i64,
    pub(super) counts: Counts,
    broken: Broken,
    /// The first problem and its byte.
    pub(super) fault: Option<(usize, ReadProblem)>,
}

/// The number of ignored statements of each kind.
#[derive(Debug, Default, Clone, Copy)]
pub(super) struct Counts {
    depths: usize,
    lines: usize,
    points: usize,
    materials: usize,
    curves: usize,
    pub(super) small: usize,
    pub(super) weighted: usize,
    pub(super) alphas: usize,
}

impl Counts {
    pub(super) fn add(&mut self, other: &Self) {
        self.depths += other.depths;
        self.lines += other.lines;
        self.points += other.points;
        self.materials += other.materials;
        self.curves += other.curves;
        self.small += other.small;
        self.weighted += other.weighted;
        self.alphas += other.alphas;
    }

    pub(super) fn notes(&self) -> Vec<String> {
        let ignored =
            |count: usize, what: &str| (count > 0).then(|| format!("{count} {what} are ignored"));
        [
            ignored(self.depths, "third texture coordinates"),
            ignored(self.lines, "line elements"),
            ignored(self.points, "point elements"),
            ignored(self.materials, "rendering statements"),
            ignored(self.curves, "statements about curves and free-form surfaces"),
        ]
        .into_iter()
        .flatten()
        .collect()
    }
}

/// A problem and its byte.
type Stop = (usize, ReadProblem);

impl Chunk {
    pub(super) fn parse(text: &[u8], range: Range<usize>, broken: Broken) -> Self {
        // Usual lines take thirty to forty bytes (v) and twenty (f); the vectors
        // grow if the guess is too low.
        let guess = range.len() / 48;
        let mut chunk = Self {
            positions: Vec::with_capacity(guess),
            polygons: Polygons::with_capacity(guess),
            largest: -1,
            range,
            broken,
            ..Self::default()
        };
        chunk.fault = chunk.statements(text).err();
        chunk
    }

    fn statements(&mut self, text: &[u8]) -> Result<(), Stop> {
        let mut at = self.range.start;
        let mut corners = Vec::with_capacity(16);
        while at < self.range.end {
            at = skip_blanks(text, at);
            let blank_follows = text.get(at + 1).is_some_and(|&b| b == b' ' || b == b'\t');
            at = match text.get(at) {
                Some(b'v') if blank_follows => self.vertex(text, at + 1)?,
                Some(b'f') if blank_follows => self.face(text, at + 1, &mut corners)?,
                Some(b'\n' | b'#') | None => next_line(text, at),
                Some(_) => self.other(text, at, &mut corners)?,
            };
        }
        Ok(())
    }

    /// Parses any statement except `v` and `f` followed by a blank.
    fn other(&mut self, text: &[u8], at: usize, corners: &mut Vec<u32>) -> Result<usize, Stop> {
        let end = word_end(text, at);
        let mut word = &text[at..end];
        // A keyword may touch the `\` of a continuation.
        if word.len() > 1 && word.ends_with(b"\\") {
            word = &word[..word.len() - 1];
        }
        let after = at + word.len();
        let counts = &mut self.counts;
        match word {
            b"v" => return self.vertex(text, after),
            b"f" | b"fo" => return self.face(text, after, corners),
            b"vt" => {
                let [u, v, w] = numbers(text, after, 1);
                self.texture.push([u, v]);
                counts.depths += usize::from(w != 0.0);
            }
            b"vn" => self.normals.push(numbers(text, after, 3)),
            b"mtllib" => self.state(text, after, None),
            b"o" | b"g" | b"usemtl" | b"s" => {
                self.state(text, after, keyword(word));
            }
            b"l" => counts.lines += 1,
            b"p" => counts.points += 1,
            b"usemap" | b"maplib" | b"bevel" | b"c_interp" | b"d_interp" | b"lod"
            | b"shadow_obj" | b"trace_obj" | b"mg" => counts.materials += 1,
            word if is_keyword(word) => counts.curves += 1,
            word => return Err((at, unexpected("an OBJ statement", shown(word)))),
        }
        Ok(next_statement(text, after))
    }

    /// Keeps the rest of a statement about the faces after it.
    fn state(&mut self, text: &[u8], at: usize, keyword: Option<usize>) {
        let value = one_line(&text[at..next_statement(text, at)]);
        self.stated.push((self.polygons.len(), keyword, value));
    }

    #[inline]
    fn vertex(&mut self, text: &[u8], mut at: usize) -> Result<usize, Stop> {
        let start = at;
        let mut position = [0.0; 3];
        for x in &mut position {
            at = skip_blanks(text, at);
            (*x, at) = float(text, at, "a coordinate")?;
        }
        check_finite(&position, self.positions.len(), self.broken)
            .map_err(|problem| (start, problem))?;
        self.positions.push(position);
        at = skip_blanks(text, at);
        if ends(text, at) { Ok(next_line(text, at)) } else { self.rest_of_vertex(text, at) }
    }

    /// The weight or the colour after a position.
    fn rest_of_vertex(&mut self, text: &[u8], mut at: usize) -> Result<usize, Stop> {
        let mut values = [0.0; 4];
        let mut count = 0;
        while !ends(text, at) && count < 5 {
            let (value, end) = float(text, at, "a weight or a colour")?;
            if count < 4 {
                values[count] = value;
            }
            count += 1;
            at = skip_blanks(text, end);
        }
        match count {
            1 => self.counts.weighted += usize::from(values[0] != 1.0),
            3 | 4 => {
                self.colors.push([values[0], values[1], values[2]]);
                self.counts.alphas += usize::from(count == 4);
            }
            _ => {
                let found = if count == 2 { "5" } else { "more than 7" };
                return Err((at, unexpected("3, 4, 6 or 7 numbers for a vertex", found)));
            }
        }
        Ok(next_line(text, at))
    }

    #[inline]
    fn face(&mut self, text: &[u8], mut at: usize, corners: &mut Vec<u32>) -> Result<usize, Stop> {
        if let Some((triangle, end)) = plain_triangle(text, at) {
            let [a, b, c] = triangle;
            self.largest = self.largest.max(i64::from(a.max(b).max(c)));
            self.polygons.push_triangle(triangle);
            return Ok(end);
        }
        let start = at;
        corners.clear();
        let base = self.polygons.corner_count();
        loop {
            at = skip_blanks(text, at);
            if ends(text, at) {
                break;
            }
            let Some((index, end)) = number::integer(text, at) else {
                return Err((at, unexpected("the index of a vertex", word(text, at))));
            };
            if index < 0 {
                let relative = self.positions.len() as i64 + index;
                self.relative.push((base + corners.len(), relative));
                corners.push(0);
            } else if let Some(corner) = u32::try_from(index).ok().and_then(|i| i.checked_sub(1)) {
                self.largest = self.largest.max(i64::from(corner));
                corners.push(corner);
            } else if self.broken == Broken::Kept {
                corners.push(NO_VERTEX);
            } else {
                return Err((at, unexpected("an index from 1 to 2^32 - 1", index.to_string())));
            }
            at = end;
            if text.get(end) == Some(&b'/') {
                let corner = base + corners.len() - 1;
                let indices;
                (indices, at) = attributes(text, end)?;
                for (index, of, count) in [
                    (indices[0], &mut self.texture_of, self.texture.len()),
                    (indices[1], &mut self.normal_of, self.normals.len()),
                ] {
                    if let Some(index) = index {
                        of.set(corner, index, count);
                    }
                }
            }
            if !ends(text, at) && !is_delimiter(text[at]) && skip_blanks(text, at) == at {
                return Err((at, unexpected("white space after an index", word(text, at))));
            }
        }
        match corners[..] {
            [a, b, c] => self.polygons.push_triangle([a, b, c]),
            [_, _, _, ..] => self.polygons.push(corners),
            [] => return Err((start, unexpected("the corners of a face", "none"))),
            _ => {
                while self.relative.pop_if(|&mut (corner, _)| corner >= base).is_some() {}
                self.texture_of.truncate(base);
                self.normal_of.truncate(base);
                self.counts.small += 1;
            }
        }
        Ok(next_line(text, at))
    }

    /// Makes relative indices absolute, given the number of vertices in the
    /// pieces before.
    pub(super) fn resolve_relative(&mut self, vertices_before: usize) {
        for (corner, index) in &mut self.relative {
            *index += vertices_before as i64;
            self.largest = self.largest.max(*index);
            self.smallest = self.smallest.min(*index);
            self.polygons.corners_mut()[*corner] = u32::try_from(*index).unwrap_or(NO_VERTEX);
        }
    }

    /// The index at a corner; a relative one may be negative or exceed 32 bits.
    pub(super) fn index(&self, corner: usize, stored: u32) -> i64 {
        match self.relative.binary_search_by_key(&corner, |&(corner, _)| corner) {
            Ok(k) => self.relative[k].1,
            Err(_) => i64::from(stored),
        }
    }
}

/// Parses three positive indices up to the end of the line, the usual form of a
/// face. Returns the indices, counted from 0, and the start of the next line.
#[inline]
fn plain_triangle(text: &[u8], at: usize) -> Option<([u32; 3], usize)> {
    let mut rest = &text[at..];
    let mut triangle = [0u32; 3];
    for corner in &mut triangle {
        while let [b' ', after @ ..] = rest {
            rest = after;
        }
        let length = rest.len();
        while let [digit @ b'0'..=b'9', after @ ..] = rest {
            *corner = corner.wrapping_mul(10).wrapping_add(u32::from(digit - b'0'));
            rest = after;
        }
        // Nine digits fit in 32 bits.
        if length - rest.len() > 9 {
            return None;
        }
        *corner = corner.checked_sub(1)?;
        if !matches!(rest, [b' ' | b'\r' | b'\n', ..]) {
            return None;
        }
    }
    let rest = match rest {
        [b'\n', rest @ ..] | [b'\r', b'\n', rest @ ..] | [b' ', b'\n', rest @ ..] => rest,
        _ => return None,
    };
    Some((triangle, text.len() - rest.len()))
}

/// A number that ends at white space, a comment or a continuation.
#[inline]
fn float(text: &[u8], at: usize, what: &str) -> Result<(f64, usize), Stop> {
    match number::float(text, at) {
        Some(found) => Ok(found),
        None => float_before_mark(text, at).ok_or_else(|| (at, unexpected(what, word(text, at)))),
    }
}

/// A number that a comment or a continuation touches.
#[cold]
fn float_before_mark(text: &[u8], at: usize) -> Option<(f64, usize)> {
    let token = &text[at..number::token_end(text, at)];
    let end = token.iter().position(|&b| b == b'#' || b == b'\\')?;
    let (value, length) = number::float(&token[..end], 0)?;
    (length == end).then_some((value, at + end))
}

/// The indices of `/t`, `//n` or `/t/n` after that of a vertex, and the place after them.
#[inline]
fn attributes(text: &[u8], mut at: usize) -> Result<([Option<i64>; 2], usize), Stop> {
    let mut indices = [None; 2];
    for index in &mut indices {
        if text.get(at) != Some(&b'/') {
            break;
        }
        at += 1;
        if matches!(text.get(at), Some(b'-' | b'+' | b'0'..=b'9')) {
            match number::integer(text, at) {
                Some((found, end)) => (*index, at) = (Some(found), end),
                None => return Err((at, unexpected("an index", word(text, at)))),
            }
        }
    }
    Ok((indices, at))
}

/// Up to three numbers of a statement; NaN for those of the first `required` that are missing or
/// no numbers, and 0 for others. Broken texture coordinates and normals do not make a mesh broken.
fn numbers(text: &[u8], mut at: usize, required: usize) -> [f64; 3] {
    let mut numbers = [0.0; 3];
    for (k, x) in numbers.iter_mut().enumerate() {
        at = skip_blanks(text, at);
        if k >= required && ends(text, at) {
            break;
        }
        match float(text, at, "") {
            Ok(found) => (*x, at) = found,
            Err(_) => {
                *x = f64::NAN;
                at = word_end(text, at);
            }
        }
    }
    numbers
}

/// The word at a place, for an error message.
fn word(text: &[u8], at: usize) -> String {
    match text.get(at) {
        None => "the end of the file".to_owned(),
        Some(b'\n') => "the end of the line".to_owned(),
        Some(b'#') => "a comment".to_owned(),
        Some(_) => shown(&text[at..word_end(text, at)]),
    }
}
