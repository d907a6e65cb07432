//! The formats, and how one is told from a name and from content.

use std::path::Path;

use crate::io::error::{Fault, ReadProblem};
use crate::io::{obj, off, stl};

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

    /// What the content looks like, if it looks like one of the formats.
    fn of_content(bytes: &[u8]) -> Option<Self> {
        if bytes.starts_with(b"ply") && bytes.get(3).is_some_and(u8::is_ascii_whitespace) {
            Some(Self::Ply)
        } else if stl::looks_like(bytes) {
            Some(Self::Stl)
        } else if off::looks_like(bytes) {
            Some(Self::Off)
        } else if obj::looks_like(bytes) {
            Some(Self::Obj)
        } else {
            None
        }
    }

    /// Decides by content and name. The content decides where the name says
    /// nothing; where the content is unclear (a damaged file, say) the name
    /// does, and its reader says what is wrong.
    pub(crate) fn decide(named: Option<Self>, bytes: &[u8]) -> Result<Self, Fault> {
        match (named, Self::of_content(bytes)) {
            (Some(name), Some(content)) if name != content => {
                Err(Fault::whole(ReadProblem::OtherKind {
                    extension: name.to_string(),
                    content: content.to_string(),
                }))
            }
            (_, Some(content)) => Ok(content),
            (Some(name), None) => match foreign_kind(bytes) {
                Some(kind) => Err(Fault::whole(ReadProblem::OtherKind {
                    extension: name.to_string(),
                    content: kind.to_owned(),
                })),
                None => Ok(name),
            },
            (None, None) => Err(Fault::whole(ReadProblem::UnknownKind { found: beginning(bytes) })),
        }
    }
}

/// Kinds of file that are often given a mesh's name by mistake.
fn foreign_kind(bytes: &[u8]) -> Option<&'static str> {
    const MAGIC: [(&[u8], &str); 12] = [
        (b"\x89PNG", "a PNG image"),
        (b"\xff\xd8\xff", "a JPEG image"),
        (b"GIF8", "a GIF image"),
        (b"%PDF", "a PDF document"),
        (b"PK\x03\x04", "a ZIP archive"),
        (b"\xfd7zXZ", "xz-compressed"),
        (b"BZh", "bzip2-compressed"),
        (b"\x28\xb5\x2f\xfd", "zstd-compressed"),
        (b"glTF", "a glTF model"),
        (b"\xff\xfe", "UTF-16 text"),
        (b"\xfe\xff", "UTF-16 text"),
        (b"<", "HTML or XML"),
    ];
    if bytes.starts_with(b"version https://git-lfs") {
        return Some("a Git LFS pointer");
    }
    MAGIC.iter().find(|(magic, _)| bytes.starts_with(magic)).map(|&(_, kind)| kind)
}

/// The first bytes, for an error message.
pub(crate) fn beginning(bytes: &[u8]) -> String {
    let end = bytes.iter().take(24).position(|&b| b == b'\n').unwrap_or(bytes.len().min(24));
    format!("{:?}", String::from_utf8_lossy(&bytes[..end]))
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
