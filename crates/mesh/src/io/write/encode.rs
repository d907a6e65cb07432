//! From a surface to the bytes of a format.

use crate::io::error::WriteProblem;
use crate::io::write::surface::Surface;
use crate::io::write::{WriteReport, fields, obj, off, ply, stl};
use crate::io::{Format, UnsupportedFields, WriteOptions};

/// The bytes of a file, in pieces, with the report.
pub(super) fn encode(
    format: Format,
    surface: Surface<'_>,
    options: &WriteOptions,
) -> Result<(Vec<Vec<u8>>, WriteReport), WriteProblem> {
    fields::check(surface.fields, surface.positions.len())?;
    let unsupported = fields::unsupported(format, surface.fields);
    if !unsupported.is_empty() && options.unsupported_fields == UnsupportedFields::Refuse {
        return Err(WriteProblem::UnsupportedFields { format, fields: unsupported });
    }
    let mut notes = Vec::new();
    let pieces = match format {
        Format::Obj => obj::encode(surface),
        Format::Ply => ply::encode(surface, options)?,
        Format::Off => off::encode(surface),
        Format::Stl => stl::encode(surface, options.encoding, &mut notes)?,
    };
    let bytes = pieces.iter().map(Vec::len).sum();
    Ok((pieces, WriteReport { format, bytes, dropped: unsupported, notes }))
}
