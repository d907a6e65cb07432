//! From the content of a file to a mesh and its report.

use crate::io::error::{Fault, ReadProblem};
use crate::io::parsed::Parsed;
use crate::io::{FaceFields, Format, ReadReport, Reader, Strictness, VertexFields};
use crate::polygon::{Distinct, Polygons, first_mentions};

/// The parts of a mesh, with the report.
pub(crate) struct Finished {
    pub(crate) positions: Vec<[f64; 3]>,
    pub(crate) polygons: Polygons,
    pub(crate) fields: VertexFields,
    pub(crate) report: ReadReport,
}

/// Refuses faces that repeat a corner, and doubts.
fn check_strictly(reduced: &[usize], left_out: &[usize], doubts: &[String]) -> Result<(), Fault> {
    let problem = match reduced.iter().take(1).chain(left_out.first()).min() {
        Some(face) => {
            let count = reduced.len() + left_out.len();
            format!("face {face} repeats a corner ({count} such faces)")
        }
        None => match doubts.first() {
            Some(doubt) => doubt.clone(),
            None => return Ok(()),
        },
    };
    Err(Fault::whole(ReadProblem::Strict(problem)))
}

impl Parsed {
    /// Checks sizes, reduces faces that repeat a corner, leaves out faces without area and fields
    /// that are not finite (strict reading refuses all three), and writes the report.
    pub(crate) fn finish(
        mut self,
        format: Format,
        compressed: bool,
        reader: &Reader,
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
        let dropped = match reader.strictness {
            Strictness::DropBroken => self.drop_broken()?,
            Strictness::Lenient | Strictness::Strict => Dropped::default(),
        };
        let before = self.fields.faces.texture.is_some().then(|| self.polygons.clone());
        let Distinct { polygons, mut reduced, mut left_out } = self.polygons.without_repeating();
        let faces = &mut self.fields.faces;
        if !faces.is_empty() && reduced.len() + left_out.len() > 0 {
            *faces = without(faces, file_faces - dropped.faces.len(), &left_out, before.as_ref());
        }
        if polygons.len() == 0 {
            *faces = FaceFields::default();
        }
        if !dropped.faces.is_empty() {
            reduced.iter_mut().chain(&mut left_out).for_each(|face| *face = dropped.kept[*face]);
        }
        if reader.strictness == Strictness::Strict {
            check_strictly(&reduced, &left_out, &self.doubts)?;
        }
        let mixed = if let Polygons::Triangles(_) = polygons { 0..0 } else { 0..polygons.len() };
        let larger = mixed.filter(|&f| polygons.face(f).len() > 3).count();
        self.notes.append(&mut self.doubts);
        let first = |all: &[usize]| all.iter().copied().take(ReadReport::NAMED).collect();
        let report = ReadReport {
            format,
            compressed,
            vertices,
            file_faces,
            polygons: larger,
            reduced: reduced.len(),
            first_reduced: first(&reduced),
            left_out: left_out.len(),
            first_left_out: first(&left_out),
            broken_vertices: dropped.vertices.len(),
            first_broken_vertices: first(&dropped.vertices),
            broken_faces: dropped.faces.len(),
            first_broken_faces: first(&dropped.faces),
            notes: self.notes,
        };
        Ok(Finished { positions: self.positions, polygons, fields: self.fields, report })
    }

    /// Leaves out faces with a vertex that is missing or not finite, and moves vertices that are
    /// not finite to the first finite position.
    fn drop_broken(&mut self) -> Result<Dropped, Fault> {
        let is_broken = |p: &[f64; 3]| p.iter().any(|x| !x.is_finite());
        let count = self.positions.len();
        let vertices: Vec<usize> = (0..count).filter(|&v| is_broken(&self.positions[v])).collect();
        let Some(&sound) = self.positions.iter().find(|p| !is_broken(p)) else {
            return Err(Fault::whole(ReadProblem::NoVertices));
        };
        let positions = &self.positions;
        let is_sound = |v: u32| positions.get(v as usize).is_some_and(|p| !is_broken(p));
        let sides: Vec<bool> = (0..self.polygons.len())
            .map(|face| self.polygons.face(face).iter().all(|&v| is_sound(v)))
            .collect();
        let [kept, faces] = [true, false].map(|side| -> Vec<usize> {
            (0..sides.len()).filter(|&face| sides[face] == side).collect()
        });
        if !faces.is_empty() {
            let mut polygons = Polygons::with_capacity(kept.len());
            kept.iter().for_each(|&face| polygons.push(self.polygons.face(face)));
            let corners = kept.iter().flat_map(|&face| self.polygons.corners_of(face));
            self.fields.faces = self.fields.faces.selected(&kept, corners);
            self.polygons = polygons;
        }
        vertices.iter().for_each(|&v| self.positions[v] = sound);
        Ok(Dropped { vertices, faces, kept })
    }

    fn leave_out_nonfinite_fields(&mut self) {
        let doubts = &mut self.doubts;
        let mut is_finite = |name: &str, of: &str, values: &[f64], per_element: usize| {
            let bad = values.iter().position(|x| !x.is_finite());
            if let Some(at) = bad {
                let (value, element) = (values[at], at / per_element);
                doubts.push(format!("field {name} is {value} at {of} {element}: left out"));
            }
            bad.is_none()
        };
        let VertexFields { scalars, vectors, faces, .. } = &mut self.fields;
        for (of, scalars, vectors) in
            [("vertex", scalars, vectors), ("face", &mut faces.scalars, &mut faces.vectors)]
        {
            scalars.retain(|(name, values)| is_finite(name, of, values, 1));
            vectors.retain(|(name, values)| is_finite(name, of, values.as_flattened(), 3));
        }
        let finite = |all: &Vec<[f64; 2]>| {
            is_finite("of texture coordinates", "corner", all.as_flattened(), 2)
        };
        faces.texture = faces.texture.take().filter(finite);
    }
}

/// The fields of the faces that are kept: all but those left out. The corners kept are the
/// first mentions of vertices in the faces of before.
fn without(
    fields: &FaceFields,
    faces: usize,
    left_out: &[usize],
    before: Option<&Polygons>,
) -> FaceFields {
    let mut out = left_out.iter().copied().peekable();
    let kept: Vec<usize> = (0..faces).filter(|face| out.next_if_eq(face).is_none()).collect();
    let corners = before.into_iter().flat_map(|polygons| {
        kept.iter().flat_map(|&face| {
            let start = polygons.corners_of(face).start;
            first_mentions(polygons.face(face)).map(move |k| start + k)
        })
    });
    fields.selected(&kept, corners)
}

/// Broken vertices and faces, and the faces kept, all numbered as in the file.
#[derive(Default)]
struct Dropped {
    vertices: Vec<usize>,
    faces: Vec<usize>,
    kept: Vec<usize>,
}

fn check_size(what: &'static str, count: usize) -> Result<(), Fault> {
    match u32::try_from(count) {
        Ok(_) => Ok(()),
        Err(_) => Err(Fault::whole(ReadProblem::TooLarge { what, count: count as u64 })),
    }
}
