//! Selections of vertices.

use std::path::Path;

use clap::Args;
use fairing::mesh::TriMesh;
use fairing::mesh::io::VertexFields;

use super::context::{Context, Failure};
use super::surface::Surface;

/// The vertices that may move.
#[derive(Args)]
pub(crate) struct Mask {
    /// Move only the vertices at which this property of the file is above zero; the others keep
    /// their positions exactly
    #[arg(long = "where", value_name = "PROPERTY")]
    property: Option<String>,
}

impl Mask {
    pub(crate) fn is_given(&self) -> bool {
        self.property.is_some()
    }

    /// True for the vertices of the mesh computed on that may move; `None` if all may. A vertex
    /// that several of the file stand for may move if all of them may.
    pub(crate) fn of(
        &self,
        context: &Context,
        input: &Path,
        surface: &Surface,
        fields: &VertexFields,
    ) -> Result<Option<Vec<bool>>, Failure> {
        let Some(name) = &self.property else { return Ok(None) };
        let values = values_of(fields, name)?;
        let mut selected = vec![true; surface.mesh().vertex_count()];
        for (v, value) in values.iter().enumerate() {
            selected[surface.number(v as u32) as usize] &= *value > 0.0;
        }
        let count = selected.iter().filter(|selected| **selected).count();
        let file = input.display();
        if count == 0 {
            return Err(Failure::usage(format_args!(
                "{file}: {name} is above zero at no vertex: none would move"
            )));
        }
        context.note(format_args!("{file}: {name} selects {count} of {} vertices", selected.len()));
        Ok(Some(selected))
    }
}

/// The result at the selected vertices, and the mesh before it at the others.
pub(crate) fn keep_others(
    before: &TriMesh,
    after: TriMesh,
    selected: Option<&[bool]>,
) -> Result<TriMesh, Failure> {
    let Some(selected) = selected else { return Ok(after) };
    let pairs = before.positions().iter().zip(after.positions()).zip(selected);
    let positions = pairs.map(|((old, new), selected)| if *selected { *new } else { *old });
    Ok(before.with_positions(positions.collect())?)
}

/// The values of a scalar field.
fn values_of<'a>(fields: &'a VertexFields, name: &str) -> Result<&'a [f64], Failure> {
    fields.scalar(name).ok_or_else(|| unknown(name, fields.scalars.iter().map(|(n, _)| &n[..])))
}

/// The failure for a field that the file does not have, with those that it has.
pub(crate) fn unknown<'a>(name: &str, known: impl Iterator<Item = &'a str>) -> Failure {
    let known: Vec<&str> = known.collect();
    Failure::usage(if known.is_empty() {
        format!("there is no field {name}: the file has no such vertex properties")
    } else {
        format!("there is no field {name}; the file has {}", known.join(", "))
    })
}
