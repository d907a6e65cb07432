//! From what a parser found to what a mesh may hold.

use crate::io::error::{Fault, ReadProblem, unexpected};
use crate::io::{Format, ReadOptions, ReadReport, Strictness, VertexFields};
use crate::polygon::{Distinct, Polygons};

/// What a parser found. It has checked that coordinates are finite, that
/// indices are in range and that faces have three corners or more.
#[derive(Default)]
pub(crate) struct Parsed {
    pub(crate) positions: Vec<[f64; 3]>,
    pub(crate) polygons: Polygons,
    pub(crate) fields: VertexFields,
    /// Content that is ignored by design.
    pub(crate) notes: Vec<String>,
    /// Content that a strict reader refuses to ignore.
    pub(crate) doubts: Vec<String>,
}

/// What a mesh may hold, with the report.
pub(crate) struct Finished {
    pub(crate) positions: Vec<[f64; 3]>,
    pub(crate) polygons: Polygons,
    pub(crate) fields: VertexFields,
    pub(crate) report: ReadReport,
}

impl Parsed {
    /// Reduces faces that repeat a corner to their distinct corners, leaves out
    /// those with fewer than three and fields that are not finite, or refuses
    /// to, and writes the report.
    pub(crate) fn finish(
        mut self,
        format: Format,
        compressed: bool,
        options: &ReadOptions,
    ) -> Result<Finished, Fault> {
        let vertices = self.positions.len();
        if vertices == 0 {
            return Err(Fault::whole(ReadProblem::NoVertices));
        }
        check_size("vertices", vertices)?;
        // Polygons of n corners become triangles of 3 (n − 2).
        let corners = self.polygons.corner_count();
        let split = if let Polygons::Mixed { .. } = self.polygons { 3 } else { 1 };
        check_size("corners", split * corners)?;
        self.leave_out_nonfinite_fields();
        let file_faces = self.polygons.len();
        let Distinct { polygons, reduced, left_out } = self.polygons.without_repeating();
        if options.strictness == Strictness::Strict {
            if let Some(face) = reduced.first().into_iter().chain(left_out.first()).min() {
                let problem = ReadProblem::Strict(format!(
                    "face {face} repeats a corner ({} such faces)",
                    reduced.len() + left_out.len()
                ));
                return Err(Fault::whole(problem));
            }
            if let Some(doubt) = self.doubts.first() {
                return Err(Fault::whole(ReadProblem::Strict(doubt.clone())));
            }
        }
        let larger = match &polygons {
            Polygons::Triangles(_) => 0,
            Polygons::Mixed { .. } => {
                (0..polygons.len()).filter(|&f| polygons.face(f).len() > 3).count()
            }
        };
        self.notes.append(&mut self.doubts);
        let report = ReadReport {
            format,
            compressed,
            vertices,
            file_faces,
            polygons: larger,
            reduced: reduced.len(),
            first_reduced: reduced.iter().copied().take(ReadReport::NAMED).collect(),
            left_out: left_out.len(),
            first_left_out: left_out.iter().copied().take(ReadReport::NAMED).collect(),
            notes: self.notes,
        };
        Ok(Finished { positions: self.positions, polygons, fields: self.fields, report })
    }

    fn leave_out_nonfinite_fields(&mut self) {
        let doubts = &mut self.doubts;
        let mut doubt = |name: &str, bad: Option<(usize, f64)>| {
            if let Some((vertex, value)) = bad {
                doubts.push(format!("field {name} is {value} at vertex {vertex}: left out"));
            }
            bad.is_none()
        };
        let bad = |x: f64| !x.is_finite();
        self.fields.scalars.retain(|(name, values)| {
            doubt(name, values.iter().position(|&x| bad(x)).map(|v| (v, values[v])))
        });
        self.fields.vectors.retain(|(name, values)| {
            let at = values.as_flattened().iter().position(|&x| bad(x));
            doubt(name, at.map(|i| (i / 3, values.as_flattened()[i])))
        });
    }
}

fn check_size(what: &'static str, count: usize) -> Result<(), Fault> {
    match u32::try_from(count) {
        Ok(_) => Ok(()),
        Err(_) => Err(Fault::whole(ReadProblem::TooLarge { what, count: count as u64 })),
    }
}

/// Checks one index of a face against the number of vertices.
#[inline]
pub(crate) fn vertex_index(
    index: i64,
    face: usize,
    vertex_count: usize,
) -> Result<u32, ReadProblem> {
    match u32::try_from(index) {
        Ok(v) if (v as usize) < vertex_count => Ok(v),
        _ => Err(ReadProblem::IndexOutOfRange {
            face: face as u64,
            index,
            vertex_count: vertex_count as u64,
        }),
    }
}

/// The faces of a file, one after another, each a corner after another.
pub(crate) struct FaceList {
    vertex_count: usize,
    /// The faces that have ended.
    ended: usize,
    corners: Vec<u32>,
    pub(crate) polygons: Polygons,
    /// How many have one corner or two: points and segments, which are left
    /// out.
    pub(crate) small: usize,
}

impl FaceList {
    /// An empty list with room for that many faces.
    pub(crate) fn with_capacity(faces: usize, vertex_count: usize) -> Self {
        let polygons = Polygons::with_capacity(faces);
        Self { vertex_count, ended: 0, corners: Vec::new(), polygons, small: 0 }
    }

    /// The next corner of the face.
    #[inline]
    pub(crate) fn corner(&mut self, index: i64) -> Result<(), ReadProblem> {
        self.corners.push(vertex_index(index, self.ended, self.vertex_count)?);
        Ok(())
    }

    /// The end of the face; one without corners is a problem.
    #[inline]
    pub(crate) fn end(&mut self) -> Result<(), ReadProblem> {
        match self.corners.len() {
            0 => {
                let expected = format!("three corners or more in face {}", self.ended);
                return Err(unexpected(expected, "0"));
            }
            1 | 2 => self.small += 1,
            _ => self.polygons.push(&self.corners),
        }
        self.corners.clear();
        self.ended += 1;
        Ok(())
    }
}

/// Checks that a position is finite.
#[inline]
pub(crate) fn check_finite(position: &[f64; 3], vertex: usize) -> Result<(), ReadProblem> {
    match position.iter().find(|x| !x.is_finite()) {
        None => Ok(()),
        Some(&value) => Err(ReadProblem::NonFinite { vertex: vertex as u64, value }),
    }
}
