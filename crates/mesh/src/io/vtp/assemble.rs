//! From the arrays of a VTP file to a mesh with fields.

use crate::io::NumberType;
use crate::io::arrays::{MAX_COMPONENTS, NamedArray, columns};
use crate::io::error::{Fault, ReadProblem, unexpected};
use crate::io::fields::Columns;
use crate::io::parsed::{Broken, FaceList, NO_VERTEX, Parsed, check_finite, strip_triangles};
use crate::io::vtp::data::Decoder;
use crate::io::vtp::document::{self, Array, ArrayType, COLORS, Document, Piece, Section};
use crate::polygon::Polygons;

pub(super) fn parse(bytes: &[u8], broken: Broken) -> Result<Parsed, Fault> {
    let document = document::read(bytes)?;
    let mut parsed = Parsed { notes: document.notes.clone(), ..Parsed::default() };
    let mut joined = Joined::default();
    let mut decoder = Decoder::new(bytes, &document);
    for piece in &document.pieces {
        joined.add(&mut decoder, piece, broken, &mut parsed)?;
    }
    joined.finish(&document, &mut parsed);
    Ok(parsed)
}

/// The arrays of points and of cells, of all pieces.
#[derive(Default)]
struct Joined {
    points: Vec<NamedArray>,
    cells: Vec<NamedArray>,
    /// The number of pieces before.
    pieces: usize,
    small: usize,
    /// The numbers of vertices, lines and strips.
    others: [usize; 3],
}

impl Joined {
    fn add(
        &mut self,
        decoder: &mut Decoder<'_>,
        piece: &Piece,
        broken: Broken,
        parsed: &mut Parsed,
    ) -> Result<(), Fault> {
        add_points(decoder, piece, broken, parsed)?;
        let (polygons, of) = self.faces(decoder, piece, broken)?;
        let base = parsed.positions.len() - piece.points;
        let shift = |v: &mut u32| {
            // Too many vertices are refused later.
            *v = if *v == NO_VERTEX { NO_VERTEX } else { v.saturating_add(base as u32) };
        };
        let mut polygons = polygons;
        polygons.corners_mut().iter_mut().for_each(shift);
        parsed.polygons.append(&polygons);
        let cells = [piece.verts, piece.lines, piece.polys, piece.strips];
        let cells = cells.iter().try_fold(0, |sum: usize, &count| sum.checked_add(count));
        let cells = cells.unwrap_or(usize::MAX);
        for (section, array) in &piece.arrays {
            match section {
                Section::PointData => {
                    let values = decode(decoder, array, piece.points, parsed)?;
                    let all: Vec<usize> = (0..piece.points).collect();
                    join(&mut self.points, self.pieces, array, &values, &all, parsed);
                }
                Section::CellData => {
                    let values = decode(decoder, array, cells, parsed)?;
                    join(&mut self.cells, self.pieces, array, &values, &of, parsed);
                }
                _ => {}
            }
        }
        self.pieces += 1;
        self.others[0] += piece.verts;
        self.others[1] += piece.lines;
        self.others[2] += piece.strips;
        Ok(())
    }

    /// The faces of a piece and the cell of each.
    fn faces(
        &mut self,
        decoder: &mut Decoder<'_>,
        piece: &Piece,
        broken: Broken,
    ) -> Result<(Polygons, Vec<usize>), Fault> {
        let mut faces = FaceList::with_capacity(0, piece.points, broken);
        let mut of = Vec::new();
        let first = piece.verts.saturating_add(piece.lines);
        let polys = Cells::read(decoder, piece, Section::Polys, piece.polys)?;
        for (cell, corners) in polys.iter() {
            let kept = faces.polygons.len();
            for (k, &index) in corners.iter().enumerate() {
                let at = polys.ends[cell] - corners.len() + k;
                faces.corner(index).map_err(|problem| polys.fault(decoder, at, problem))?;
            }
            let end = polys.ends[cell].saturating_sub(1);
            faces.end().map_err(|problem| polys.fault(decoder, end, problem))?;
            if faces.polygons.len() > kept {
                of.push(first + cell);
            }
        }
        let first = first.saturating_add(piece.polys);
        let strips = Cells::read(decoder, piece, Section::Strips, piece.strips)?;
        for (cell, corners) in strips.iter() {
            let end = strips.ends[cell].saturating_sub(1);
            for triangle in strip_triangles(corners) {
                for index in triangle {
                    faces.corner(index).map_err(|problem| strips.fault(decoder, end, problem))?;
                }
                faces.end().map_err(|problem| strips.fault(decoder, end, problem))?;
                of.push(first + cell);
            }
        }
        self.small += faces.small;
        Ok((faces.polygons, of))
    }

    fn finish(self, document: &Document, parsed: &mut Parsed) {
        let [verts, lines, strips] = self.others;
        // Without faces, cells of vertices show the points.
        let verts = if parsed.polygons.len() > 0 { verts } else { 0 };
        for (count, what) in [(verts, "vertices"), (lines, "lines")] {
            if count > 0 {
                parsed.notes.push(format!("{count} cells that are {what} are ignored"));
            }
        }
        if strips > 0 {
            parsed.notes.push(format!("{strips} triangle strips are split into triangles"));
        }
        if self.small > 0 {
            let small = self.small;
            parsed.doubts.push(format!("{small} faces have fewer than three corners: left out"));
        }
        let normals = |which: usize| {
            document.pieces.first().and_then(|piece| piece.normals[which].as_deref())
        };
        let count = parsed.positions.len();
        let points = fields(self.points, count, normals(0), parsed);
        let cells = fields(self.cells, parsed.polygons.len(), normals(1), parsed);
        parsed.fields = points.of_vertices();
        parsed.fields.faces = cells.of_faces();
    }
}

fn add_points(
    decoder: &mut Decoder<'_>,
    piece: &Piece,
    broken: Broken,
    parsed: &mut Parsed,
) -> Result<(), Fault> {
    let mut points = piece.arrays.iter().filter(|(section, _)| *section == Section::Points);
    let Some((_, array)) = points.next() else {
        return match piece.points {
            0 => Ok(()),
            points => {
                let problem = unexpected(format!("an array of {points} Points"), "none");
                Err(decoder.fault_in_element(piece.at, problem))
            }
        };
    };
    if array.components != 3 {
        let problem = unexpected("3 components of Points", array.components.to_string());
        return Err(decoder.fault(array, problem));
    }
    let values = decoder.floats(array, piece.points.checked_mul(3).or(Some(usize::MAX)))?;
    let positions = values.as_chunks::<3>().0;
    for (k, position) in positions.iter().enumerate() {
        check_finite(position, parsed.positions.len() + k, broken)
            .map_err(|problem| decoder.fault_at(array, 3 * k, problem))?;
    }
    parsed.positions.extend_from_slice(positions);
    Ok(())
}

/// Cells of one section.
struct Cells<'a> {
    connectivity: Option<&'a Array>,
    corners: Vec<i64>,
    /// The end of each cell in `corners`.
    ends: Vec<usize>,
}

impl<'a> Cells<'a> {
    fn read(
        decoder: &mut Decoder<'_>,
        piece: &'a Piece,
        section: Section,
        count: usize,
    ) -> Result<Self, Fault> {
        let mut cells = Self { connectivity: None, corners: vec![], ends: vec![] };
        if count == 0 {
            return Ok(cells);
        }
        let array = |name: &str| {
            piece.array(section, name).ok_or_else(|| {
                let problem = unexpected(format!("an array {name} of {section:?}"), "none");
                decoder.fault_in_element(piece.at, problem)
            })
        };
        let (connectivity, offsets) = (array("connectivity")?, array("offsets")?);
        cells.corners = decoder.integers(connectivity, None)?;
        let mut before = 0;
        for (cell, end) in decoder.integers(offsets, Some(count))?.into_iter().enumerate() {
            let end = usize::try_from(end).ok().filter(|&end| end <= cells.corners.len());
            let Some(end) = end.filter(|&end| end >= before) else {
                let expected = format!("ascending offsets up to {}", cells.corners.len());
                let problem = unexpected(expected, format!("another at cell {cell}"));
                return Err(decoder.fault_at(offsets, cell, problem));
            };
            cells.ends.push(end);
            before = end;
        }
        if before != cells.corners.len() {
            let expected = format!("{before} numbers in array connectivity, as offsets say");
            let problem = unexpected(expected, cells.corners.len().to_string());
            return Err(decoder.fault(connectivity, problem));
        }
        cells.connectivity = Some(connectivity);
        Ok(cells)
    }

    fn iter(&self) -> impl Iterator<Item = (usize, &[i64])> {
        let mut start = 0;
        self.ends.iter().enumerate().map(move |(cell, &end)| {
            let corners = &self.corners[start..end];
            start = end;
            (cell, corners)
        })
    }

    /// A problem at a corner.
    fn fault(&self, decoder: &Decoder<'_>, at: usize, problem: ReadProblem) -> Fault {
        match self.connectivity {
            Some(array) => decoder.fault_at(array, at, problem),
            None => Fault::whole(problem),
        }
    }
}

/// The numbers of an array of fields, for `count` elements.
fn decode(
    decoder: &mut Decoder<'_>,
    array: &Array,
    count: usize,
    parsed: &mut Parsed,
) -> Result<Vec<f64>, Fault> {
    let expected = count.saturating_mul(array.components);
    let values = decoder.floats(array, Some(expected))?;
    const EXACT: f64 = 9_007_199_254_740_992.0;
    let wide = matches!(array.kind, ArrayType::I64 | ArrayType::U64);
    if wide && values.iter().any(|x| x.abs() > EXACT) {
        let name = &array.name;
        parsed.doubts.push(format!("integers of {name:?} are rounded to 53 bits"));
    }
    Ok(values)
}

/// Adds the values of the elements `of` to those of the pieces before.
fn join(
    arrays: &mut Vec<NamedArray>,
    pieces: usize,
    array: &Array,
    values: &[f64],
    of: &[usize],
    parsed: &mut Parsed,
) {
    let components = array.components;
    let values = of.iter().flat_map(|&k| &values[k * components..(k + 1) * components]).copied();
    let known = arrays.iter().position(|known| known.name == array.name);
    match known {
        None if pieces == 0 => {
            let kind = match array.kind {
                ArrayType::Number(number) => Some(number),
                ArrayType::I64 | ArrayType::U64 => None,
            };
            let (name, values) = (array.name.clone(), values.collect());
            arrays.push(NamedArray { name, kind, components, values });
        }
        Some(k) if pieces > 0 && arrays[k].components == components => {
            arrays[k].values.extend(values);
        }
        _ => {
            let name = &array.name;
            parsed.doubts.push(format!("the array {name:?} is not in every piece once: left out"));
        }
    }
}

/// Arrays as fields of `count` elements; the array of normals becomes `normal`, and bytes under
/// the name of colours become colours.
fn fields(
    mut arrays: Vec<NamedArray>,
    count: usize,
    normals: Option<&str>,
    parsed: &mut Parsed,
) -> Columns {
    if count == 0 {
        return Columns::default();
    }
    arrays.retain(|array| {
        let name = &array.name;
        let complete = array.values.len() == count * array.components;
        if !complete {
            parsed.doubts.push(format!("the array {name:?} is not in every piece once: left out"));
        } else if array.components > MAX_COMPONENTS {
            let components = array.components;
            parsed.notes.push(format!("the array {name:?} of {components} components is ignored"));
        }
        complete && array.components <= MAX_COMPONENTS
    });
    let is_colors =
        |a: &NamedArray| a.name == COLORS && a.components == 3 && a.kind == Some(NumberType::U8);
    let colors = arrays.iter().position(is_colors).map(|k| {
        let values = arrays.remove(k).values;
        values.as_chunks().0.iter().map(|color: &[f64; 3]| color.map(|c| c as u8)).collect()
    });
    for array in &mut arrays {
        if Some(&array.name[..]) == normals && array.components == 3 {
            array.name = "normal".to_owned();
        }
        if array.kind.is_none() {
            let types = [NumberType::I32, NumberType::U32];
            array.kind = types.into_iter().find(|t| array.values.iter().all(|&x| t.holds(x)));
        }
    }
    columns(arrays, colors, &mut parsed.notes)
}
