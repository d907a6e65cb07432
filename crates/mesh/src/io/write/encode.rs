//! From a surface to the bytes of a format.

use crate::io::error::WriteProblem;
use crate::io::write::surface::Surface;
use crate::io::write::{WriteReport, fields, obj, off, ply, stl};
use crate::io::{Format, UnheldFields, WriteOptions};

/// The bytes of a file, in pieces, with the report.
pub(super) fn encode(
    format: Format,
    surface: Surface<'_>,
    options: &WriteOptions,
) -> Result<(Vec<Vec<u8>>, WriteReport), WriteProblem> {
    fields::check(surface.fields, surface.positions.len())?;
    let unheld = fields::unheld(format, surface.fields);
    if !unheld.is_empty() && options.unheld_fields == UnheldFields::Refuse {
        return Err(WriteProblem::FieldsNotHeld { format, fields: unheld });
    }
    let mut notes = Vec::new();
    let pieces = match format {
        Format::Obj => obj::encode(surface),
        Format::Ply => ply::encode(surface, options)?,
        Format::Off => off::encode(surface),
        Format::Stl => stl::encode(surface, options.encoding, &mut notes)?,
    };
    let bytes = pieces.iter().map(Vec::len).sum();
    Ok((pieces, WriteReport { format, bytes, dropped: unheld, notes }))
}
