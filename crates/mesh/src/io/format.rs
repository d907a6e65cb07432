//! The formats and their names.

use std::path::Path;

/// A format of mesh files.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Format {
    /// Wavefront OBJ, text.
    Obj,
    /// PLY, the Stanford polygon format, text or binary.
    Ply,
    /// OFF, the object file format of Geomview, text.
    Off,
    /// STL of stereolithography, text or binary.
    Stl,
}

/// The format of a file by its name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub struct NamedFormat {
    /// What the file extension says.
    pub format: Format,
    /// Whether the file is gzip-compressed: `.gz` follows.
    pub gzip: bool,
}

crate::named!(Format, "format");
#[cfg(feature = "serde")]
crate::serde_by_name!(Format);

impl Format {
    /// All formats.
    pub const ALL: [Self; 4] = [Self::Obj, Self::Ply, Self::Off, Self::Stl];

    /// The name in messages: the file extension in capital letters.
    pub fn name(self) -> &'static str {
        match self {
            Self::Obj => "OBJ",
            Self::Ply => "PLY",
            Self::Off => "OFF",
            Self::Stl => "STL",
        }
    }

    /// The format that the file extension says, if it is a known one. Case does
    /// not matter; `coff`, `noff` and `stoff` count as `off`.
    pub fn from_path(path: impl AsRef<Path>) -> Option<NamedFormat> {
        let path = path.as_ref();
        let name = path.file_name().map(|n| n.to_string_lossy().to_ascii_lowercase());
        let name = name.unwrap_or_default();
        let (stem, gzip) = match name.strip_suffix(".gz") {
            Some(stem) => (stem, true),
            None => (&name[..], false),
        };
        let format = match stem.rsplit_once('.')?.1 {
            "obj" => Self::Obj,
            "ply" => Self::Ply,
            "off" | "coff" | "noff" | "stoff" => Self::Off,
            "stl" => Self::Stl,
            _ => return None,
        };
        Some(NamedFormat { format, gzip })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn extensions_name_formats_in_any_case_and_under_gz() {
        for (name, format, gzip) in [
            ("a.obj", Some(Format::Obj), false),
            ("b.tar.PLY.GZ", Some(Format::Ply), true),
            ("dir.stl/c.COFF", Some(Format::Off), false),
            ("d.stl.gz", Some(Format::Stl), true),
            ("e.gz", None, true),
            ("obj", None, false),
        ] {
            let expected = format.map(|format| NamedFormat { format, gzip });
            assert_eq!(Format::from_path(name), expected, "{name}");
        }
    }

    #[test]
    fn names_read_back_in_any_case() {
        for format in Format::ALL {
            assert_eq!(format.to_string().parse(), Ok(format));
            assert_eq!(format.name().to_lowercase().parse(), Ok(format));
        }
        let error = "fbx".parse::<Format>().unwrap_err().to_string();
        assert!(error.contains("OBJ, PLY, OFF, STL"), "{error}");
    }
}
