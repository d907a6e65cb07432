//! Binary STL: 80 bytes of header, a count, and 50 bytes per triangle.

use crate::io::error::{Fault, ReadProblem, unexpected};
use crate::io::parsed::{Broken, Parsed, check_finite};
use crate::polygon::Polygons;
use crate::weld::Welder;

const HEADER: usize = 84;
const RECORD: usize = 50;

/// The number of triangles that the header claims, if there is a header.
fn claimed(bytes: &[u8]) -> Option<u32> {
    let count = bytes.get(80..HEADER)?;
    Some(u32::from_le_bytes([count[0], count[1], count[2], count[3]]))
}

/// Returns true if the size of the file matches the count in its header.
pub(super) fn has_its_size(bytes: &[u8]) -> bool {
    claimed(bytes)
        .is_some_and(|count| bytes.len() as u64 == HEADER as u64 + RECORD as u64 * u64::from(count))
}

pub(super) fn parse(bytes: &[u8], broken: Broken) -> Result<Parsed, Fault> {
    let Some(count) = claimed(bytes) else {
        let found = format!("{} bytes", bytes.len());
        let problem = unexpected(
            "an STL file: text that begins with \"solid\", or a binary header of 84 bytes",
            found,
        );
        return Err(Fault::whole(problem));
    };
    let body = &bytes[HEADER..];
    if !has_its_size(bytes) {
        let expected = format!("{count} triangles of {RECORD} bytes, as the header says");
        let found = format!("{} bytes", body.len());
        return Err(Fault::at_byte(80, unexpected(expected, found)));
    }
    // A closed surface has half as many vertices as triangles.
    let mut welder = Welder::with_capacity(body.len() / RECORD / 2 + 2);
    let mut faces = Vec::with_capacity(body.len() / RECORD);
    let mut attributed = 0usize;
    for (face, record) in body.chunks_exact(RECORD).enumerate() {
        // The normal comes first and is not used.
        let numbers = record[12..48].as_chunks::<4>().0;
        let mut corners = [0; 3];
        for (k, corner) in corners.iter_mut().enumerate() {
            let position = [0, 1, 2].map(|i| f64::from(f32::from_le_bytes(numbers[3 * k + i])));
            let at = HEADER + RECORD * face + 12 + 12 * k;
            check_finite(&position, 3 * face + k, broken).map_err(|p| Fault::at_byte(at, p))?;
            *corner = welder.vertex(position).ok_or_else(|| {
                let count = u64::from(u32::MAX) + 1;
                Fault::at_byte(at, ReadProblem::TooLarge { what: "vertices", count })
            })?;
        }
        attributed += usize::from(record[48..] != [0, 0]);
        faces.push(corners);
    }
    let mut notes = Vec::new();
    if attributed > 0 {
        notes.push(format!("the attribute bytes of {attributed} triangles are ignored"));
    }
    let positions = welder.into_positions();
    Ok(Parsed { positions, polygons: Polygons::Triangles(faces), notes, ..Parsed::default() })
}

#[cfg(test)]
mod tests {
    use super::*;

    pub(crate) fn file(header: &[u8], claimed: u32, triangles: &[[[f32; 3]; 3]]) -> Vec<u8> {
        let mut bytes = header.to_vec();
        bytes.resize(80, b' ');
        bytes.extend(claimed.to_le_bytes());
        for t in triangles {
            bytes.extend([0; 12]);
            t.as_flattened().iter().for_each(|x| bytes.extend(x.to_le_bytes()));
            bytes.extend([0; 2]);
        }
        bytes
    }

    const TWO: [[[f32; 3]; 3]; 2] = [
        [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
        [[0.0, 1.0, 0.0], [1.0, -0.0, 0.0], [1.0, 1.0, 0.1]],
    ];

    #[test]
    fn a_header_that_begins_with_solid_is_still_binary() {
        let bytes = file(b"solid cube facet", 2, &TWO);
        let parsed = (crate::io::stl::FORMAT.parse)(&bytes, Broken::Refused).unwrap();
        assert_eq!(parsed.positions.len(), 4);
        assert_eq!(parsed.positions[3], [1.0, 1.0, f64::from(0.1f32)]);
        assert_eq!(parsed.polygons, Polygons::Triangles(vec![[0, 1, 2], [2, 1, 3]]));
    }

    #[test]
    fn lying_counts_and_infinite_corners_are_errors() {
        for claimed in [0, 1, 3, u32::MAX] {
            let fault = parse(&file(b"", claimed, &TWO), Broken::Refused).err().unwrap();
            let text = format!("{}{}", fault.at, fault.problem);
            assert!(text.contains(&format!("byte 80: expected {claimed} triangles")), "{text}");
        }
        let mut bad = TWO;
        bad[1][0][1] = f32::NAN;
        let fault = parse(&file(b"", 2, &bad), Broken::Refused).err().unwrap();
        assert_eq!(fault.at, crate::io::Place::Byte(84 + 50 + 12));
        assert!(parse(&[0; 83], Broken::Refused).is_err());
    }
}
