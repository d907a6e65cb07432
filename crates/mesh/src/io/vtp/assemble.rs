//! From the arrays of a VTP file to a mesh with fields.

use crate::io::NumberType;
use crate::io::columns::{MAX_COMPONENTS, NamedArray, from_arrays};
use crate::io::error::{Fault, ReadProblem, unexpected};
use crate::io::fields::Columns;
use crate::io::parsed::{Broken, FaceList, NO_VERTEX, Parsed, check_finite, strip_triangles};
use crate::io::vtp::data::Decoder;
use crate::io::vtp::document::{self, Array, ArrayType, CELLS, COLORS, Document, Piece};
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

/// The places in [`CELLS`] of the cells that become faces.
const POLYS: usize = 2;
const STRIPS: usize = 3;

/// The arrays of points and of cells, of all pieces.
#[derive(Default)]
struct Joined {
    points: Vec<NamedArray>,
    cells: Vec<NamedArray>,
    /// The number of pieces before.
    pieces: usize,
    small: usize,
    /// The number of cells of each kind of [`CELLS`].
    counts: [usize; 4],
}

impl Joined {
    fn add(
        &mut self,
        decoder: &mut Decoder<'_>,
        piece: &Piece,
        broken: Broken,
        parsed: &mut Parsed,
    ) -> Result<(), Fault> {
        let base = parsed.positions.len();
        add_points(decoder, piece, broken, parsed)?;
        let (mut polygons, cell_of) = self.faces(decoder, piece, broken)?;
        for v in polygons.corners_mut() {
            // Too many vertices are refused later.
            *v = if *v == NO_VERTEX { NO_VERTEX } else { v.saturating_add(base as u32) };
        }
        parsed.polygons.append(&polygons);
        for array in &piece.arrays {
            let (arrays, count, of) = match array.section {
                "PointData" => (&mut self.points, piece.points, None),
                "CellData" => (&mut self.cells, sum(&piece.cells), Some(&cell_of[..])),
                _ => continue,
            };
            let expected = count.saturating_mul(array.components);
            let values = decoder.floats(array, Some(expected))?;
            join(arrays, self.pieces, array, values, of, &mut parsed.doubts);
        }
        self.pieces += 1;
        for (all, count) in self.counts.iter_mut().zip(piece.cells) {
            *all = all.saturating_add(count);
        }
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
        let mut cell_of = Vec::new();
        for kind in [POLYS, STRIPS] {
            let Some(cells) = Cells::read(decoder, piece, kind)? else { continue };
            let first = sum(&piece.cells[..kind]);
            let mut start = 0;
            for (cell, &end) in cells.ends.iter().enumerate() {
                let corners = &cells.corners[start..end];
                let last = end.saturating_sub(1);
                let fault = |at: usize| move |problem: ReadProblem| (at, problem);
                let mut add = || {
                    if kind == POLYS {
                        for (k, &index) in corners.iter().enumerate() {
                            faces.corner(index).map_err(fault(start + k))?;
                        }
                        return faces.end().map_err(fault(last));
                    }
                    for triangle in strip_triangles(corners) {
                        triangle.iter().try_for_each(|&v| faces.corner(v)).map_err(fault(last))?;
                        faces.end().map_err(fault(last))?;
                    }
                    Ok(())
                };
                add().map_err(|(at, problem)| decoder.fault_at(cells.connectivity, at, problem))?;
                cell_of.resize(faces.polygons.len(), first.saturating_add(cell));
                start = end;
            }
        }
        self.small += faces.small;
        Ok((faces.polygons, cell_of))
    }

    fn finish(self, document: &Document, parsed: &mut Parsed) {
        let [verts, lines, _, strips] = self.counts;
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

fn sum(counts: &[usize]) -> usize {
    counts.iter().fold(0, |sum: usize, &count| sum.saturating_add(count))
}

fn add_points(
    decoder: &mut Decoder<'_>,
    piece: &Piece,
    broken: Broken,
    parsed: &mut Parsed,
) -> Result<(), Fault> {
    let Some(array) = piece.arrays.iter().find(|array| array.section == "Points") else {
        if piece.points == 0 {
            return Ok(());
        }
        let problem = unexpected(format!("an array of {} Points", piece.points), "none");
        return Err(decoder.fault_in_element(piece.at, problem));
    };
    if array.components != 3 {
        let problem = unexpected("3 components of Points", array.components.to_string());
        return Err(decoder.fault(array, problem));
    }
    let values = decoder.floats(array, Some(piece.points.saturating_mul(3)))?;
    let positions = values.as_chunks::<3>().0;
    for (k, position) in positions.iter().enumerate() {
        check_finite(position, parsed.positions.len() + k, broken)
            .map_err(|problem| decoder.fault_at(array, 3 * k, problem))?;
    }
    parsed.positions.extend_from_slice(positions);
    Ok(())
}

/// Cells of one kind.
struct Cells<'a> {
    connectivity: &'a Array,
    corners: Vec<i64>,
    /// The end of each cell in `corners`.
    ends: Vec<usize>,
}

impl<'a> Cells<'a> {
    /// The cells of a kind of [`CELLS`], if any.
    fn read(
        decoder: &mut Decoder<'_>,
        piece: &'a Piece,
        kind: usize,
    ) -> Result<Option<Self>, Fault> {
        let (section, count) = (CELLS[kind], piece.cells[kind]);
        if count == 0 {
            return Ok(None);
        }
        let array = |name: &str| {
            let is_wanted = |array: &&Array| array.section == section && array.name == name;
            piece.arrays.iter().find(is_wanted).ok_or_else(|| {
                let problem = unexpected(format!("an array {name} of {section}"), "none");
                decoder.fault_in_element(piece.at, problem)
            })
        };
        let (connectivity, offsets) = (array("connectivity")?, array("offsets")?);
        let corners = decoder.integers(connectivity, None)?;
        let (mut ends, mut before) = (Vec::new(), 0);
        for (cell, end) in decoder.integers(offsets, Some(count))?.into_iter().enumerate() {
            let end =
                usize::try_from(end).ok().filter(|end| (before..=corners.len()).contains(end));
            before = end.ok_or_else(|| {
                let expected = format!("ascending offsets up to {}", corners.len());
                let problem = unexpected(expected, format!("another at cell {cell}"));
                decoder.fault_at(offsets, cell, problem)
            })?;
            ends.push(before);
        }
        if before != corners.len() {
            let expected = format!("{before} numbers in array connectivity, as offsets say");
            let problem = unexpected(expected, corners.len().to_string());
            return Err(decoder.fault(connectivity, problem));
        }
        Ok(Some(Self { connectivity, corners, ends }))
    }
}

/// Adds the values of an array to those of the pieces before: of the elements `of`, or of all.
fn join(
    arrays: &mut Vec<NamedArray>,
    pieces: usize,
    array: &Array,
    mut values: Vec<f64>,
    of: Option<&[usize]>,
    doubts: &mut Vec<String>,
) {
    const EXACT: f64 = 9_007_199_254_740_992.0;
    let (name, components) = (array.name.clone(), array.components);
    let kind = match array.kind {
        ArrayType::Number(number) => Some(number),
        ArrayType::I64 | ArrayType::U64 => None,
    };
    if kind.is_none() && values.iter().any(|x| x.abs() > EXACT) {
        doubts.push(format!("integers of {name:?} are rounded to 53 bits"));
    }
    if let Some(of) = of {
        let element = |&k: &usize| values[k * components..(k + 1) * components].iter().copied();
        values = of.iter().flat_map(element).collect();
    }
    match arrays.iter_mut().find(|known| known.name == name) {
        None if pieces == 0 => arrays.push(NamedArray { name, kind, components, values }),
        Some(known) if pieces > 0 && known.components == components => known.values.extend(values),
        _ => doubts.push(format!("the array {name:?} is not in every piece once: left out")),
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
    from_arrays(arrays, colors, &mut parsed.notes)
}
