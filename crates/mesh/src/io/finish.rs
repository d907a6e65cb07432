//! From the content of a file to a mesh and its report.

use crate::io::error::{Fault, ReadProblem};
use crate::io::parsed::Parsed;
use crate::io::{Format, ReadOptions, ReadReport, Strictness, VertexFields};
use crate::polygon::{Distinct, Polygons};

/// The parts of a mesh, with the report.
pub(crate) struct Finished {
    pub(crate) positions: Vec<[f64; 3]>,
    pub(crate) polygons: Polygons,
    pub(crate) fields: VertexFields,
    pub(crate) report: ReadReport,
}

impl Parsed {
    /// Checks sizes, reduces faces that repeat a corner, leaves out faces without area and fields
    /// that are not finite (strict reading refuses all three), and writes the report.
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
        let dropped = match options.strictness {
            Strictness::DropBroken => self.drop_broken()?,
            Strictness::Lenient | Strictness::Strict => Dropped::default(),
        };
        let Distinct { polygons, mut reduced, mut left_out } = self.polygons.without_repeating();
        if !dropped.faces.is_empty() {
            reduced.iter_mut().chain(&mut left_out).for_each(|face| *face = dropped.kept[*face]);
        }
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
            self.polygons = polygons;
        }
        vertices.iter().for_each(|&v| self.positions[v] = sound);
        Ok(Dropped { vertices, faces, kept })
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
