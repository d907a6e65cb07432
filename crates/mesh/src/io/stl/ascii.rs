//! Text STL: `solid`, facets of one loop with three vertices, `endsolid`.

use crate::io::error::{Fault, ReadProblem, unexpected};
use crate::io::parsed::{Broken, Parsed, check_finite};
use crate::io::text::{Cursor, normalized};
use crate::polygon::Polygons;
use crate::weld::Welder;

/// Returns true if the bytes are text that begins with `solid`, and the next line with `facet` or
/// `endsolid` unless there is none. The count in a binary header has a byte that is zero, unless it
/// exceeds 16 million.
pub(super) fn looks_like(bytes: &[u8]) -> bool {
    let head = &bytes[..bytes.len().min(4096)];
    if head.contains(&0) {
        return false;
    }
    let text = normalized(head);
    let mut cursor = Cursor::new(&text, 0, None);
    if !cursor.token().is_some_and(|token| token.eq_ignore_ascii_case(b"solid")) {
        return false;
    }
    // The rest of the line is the name of the solid, which may be any text.
    cursor.skip_line();
    cursor.token().is_none_or(|token| {
        token.eq_ignore_ascii_case(b"facet") || token.eq_ignore_ascii_case(b"endsolid")
    })
}

pub(super) fn parse(bytes: &[u8], broken: Broken) -> Result<Parsed, Fault> {
    let text = normalized(bytes);
    let mut cursor = Cursor::new(&text, 0, None);
    // A facet takes some hundred bytes.
    let mut welder = Welder::with_capacity(text.len() / 300);
    let mut faces = Vec::new();
    let mut solids = 0usize;
    while cursor.more() {
        keyword(&mut cursor, "solid")?;
        cursor.skip_line();
        solids += 1;
        loop {
            cursor.more();
            if cursor.peek().eq_ignore_ascii_case(b"endsolid") {
                cursor.skip_line();
                break;
            }
            faces.push(facet(&mut cursor, &mut welder, faces.len(), broken)?);
        }
    }
    let notes = if solids > 1 { vec![format!("{solids} solids are one mesh")] } else { vec![] };
    let positions = welder.into_positions();
    Ok(Parsed { positions, polygons: Polygons::Triangles(faces), notes, ..Parsed::default() })
}

fn facet(
    cursor: &mut Cursor<'_>,
    welder: &mut Welder,
    face: usize,
    broken: Broken,
) -> Result<[u32; 3], Fault> {
    if !cursor.peek().eq_ignore_ascii_case(b"facet") {
        return Err(cursor.fault(unexpected("facet or endsolid", cursor.found())));
    }
    keyword(cursor, "facet")?;
    keyword(cursor, "normal")?;
    // The normal is not used: some writers leave it zero or NaN.
    for _ in 0..3 {
        cursor.float("a component of the normal")?;
    }
    keyword(cursor, "outer")?;
    keyword(cursor, "loop")?;
    let mut corners = [0; 3];
    for (k, corner) in corners.iter_mut().enumerate() {
        keyword(cursor, "vertex")?;
        let at = cursor.clone();
        let mut position = [0.0; 3];
        for x in &mut position {
            *x = cursor.float("a coordinate")?;
        }
        check_finite(&position, 3 * face + k, broken).map_err(|problem| at.fault(problem))?;
        *corner = welder.vertex(position).ok_or_else(|| {
            let count = u64::from(u32::MAX) + 1;
            at.fault(ReadProblem::TooLarge { what: "vertices", count })
        })?;
    }
    keyword(cursor, "endloop")?;
    keyword(cursor, "endfacet")?;
    Ok(corners)
}

fn keyword(cursor: &mut Cursor<'_>, word: &str) -> Result<(), Fault> {
    if cursor.more() && cursor.peek().eq_ignore_ascii_case(word.as_bytes()) {
        cursor.token();
        return Ok(());
    }
    Err(cursor.fault(unexpected(word, cursor.found())))
}

#[cfg(test)]
mod tests {
    use super::*;

    const FACET: &str = "facet normal 0 0 nan\n outer loop\n vertex 0 0 0\n vertex 1 0 0\n vertex 0 1e-1 0\n \
                         endloop\nendfacet\n";

    #[test]
    fn solids_of_any_name_and_case_are_read() {
        for text in [
            format!("solid\n{FACET}endsolid\n"),
            format!("SOLID a facet of 3\r\n{FACET}endsolid a facet of 3"),
            format!("solid x\n{}endsolid\n", FACET.to_uppercase().replace('\n', "\r\n\t")),
        ] {
            let parsed =
                parse(text.as_bytes(), Broken::Refused).unwrap_or_else(|f| panic!("{text}: {f:?}"));
            assert_eq!(parsed.positions, [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 0.1, 0.0]]);
            assert!(looks_like(text.as_bytes()));
        }
        let two = format!("solid a\n{FACET}endsolid a\nsolid b\n{FACET}endsolid b\n");
        let parsed = parse(two.as_bytes(), Broken::Refused).unwrap();
        assert_eq!(parsed.polygons, Polygons::Triangles(vec![[0, 1, 2], [0, 1, 2]]));
        assert_eq!(parsed.notes.len(), 1);
    }

    #[test]
    fn errors_name_the_line() {
        for (text, expected) in [
            (format!("solid\n{FACET}"), "line 9: expected facet or endsolid, found the end"),
            (
                "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0\nvertex".into(),
                "line 5: expected a coordinate, found \"vertex\"",
            ),
            (
                format!("solid\n{}endsolid", FACET.replace("1 0 0", "1 inf 0")),
                "line 5: vertex 1 has the coordinate inf",
            ),
            (
                format!("solid\n{}endsolid", FACET.replace("endloop", "vertex 1 1 1\nendloop")),
                "line 7: expected endloop, found \"vertex\"",
            ),
            (format!("solid\n{FACET}endsolid\njunk"), "line 10: expected solid, found \"junk\""),
        ] {
            let fault = parse(text.as_bytes(), Broken::Refused).err().unwrap();
            let message = format!("{}{}", fault.at, fault.problem);
            assert!(message.contains(expected), "{text}: {message}");
        }
    }
}
