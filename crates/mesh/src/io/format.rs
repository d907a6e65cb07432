//! The table of formats: names, marks, parsers and encoders.

use std::path::Path;

use crate::io::error::{Fault, ReadProblem, WriteProblem};
use crate::io::row::{Holds, Row};
use crate::io::{foreign, glb, obj, off, ply, stl, vtp};

/// Makes the enum of formats from the table.
macro_rules! formats {
    ($($(#[$doc:meta])* $format:ident = $row:expr,)*) => {
        /// A format of mesh files.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
        #[non_exhaustive]
        pub enum Format {
            $($(#[$doc])* $format,)*
        }

        impl Format {
            /// All formats.
            pub const ALL: [Self; [$(Self::$format),*].len()] = [$(Self::$format),*];

            pub(crate) fn row(self) -> &'static Row {
                match self {
                    $(Self::$format => &$row,)*
                }
            }
        }
    };
}

// Content is compared with the last row first: OBJ is known by one word, binary STL by its size
// alone, whatever it begins with, and the formats after STL by more than that.
formats! {
    /// Wavefront OBJ, text.
    Obj = obj::FORMAT,
    /// PLY, the Stanford polygon format, text or binary.
    Ply = ply::FORMAT,
    /// OFF, the object file format of Geomview, text.
    Off = off::FORMAT,
    /// STL of stereolithography, text or binary.
    Stl = stl::FORMAT,
    /// VTP, the XML format of polygonal data of VTK and ParaView, binary or text.
    Vtp = vtp::FORMAT,
    /// GLB, the binary form of glTF 2.0 of viewers and browsers.
    Glb = glb::FORMAT,
}

/// The format of a file by its name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub struct NamedFormat {
    /// The format of the file extension.
    pub format: Format,
    /// True for a name that ends in `.gz`: the file is gzip-compressed.
    pub gzip: bool,
}

fairing_parameters::named!(Format, "format");
#[cfg(feature = "serde")]
fairing_parameters::serde_by_name!(Format);

impl Format {
    /// The name in messages, in capital letters.
    pub fn name(self) -> &'static str {
        self.row().name
    }

    /// The file extensions, in lower case and without a dot; the usual one is first.
    pub fn extensions(self) -> &'static [&'static str] {
        self.row().extensions
    }

    /// The content that files of this format hold.
    pub fn holds(self) -> Holds {
        self.row().holds
    }

    /// The format of a known file extension, in upper or lower case.
    pub fn from_path(path: impl AsRef<Path>) -> Option<NamedFormat> {
        let path = path.as_ref();
        let name = path.file_name().map(|n| n.to_string_lossy().to_ascii_lowercase());
        let name = name.unwrap_or_default();
        let (stem, gzip) = match name.strip_suffix(".gz") {
            Some(stem) => (stem, true),
            None => (&name[..], false),
        };
        let extension = stem.rsplit_once('.')?.1;
        let format = Self::ALL.into_iter().find(|f| f.extensions().contains(&extension))?;
        Some(NamedFormat { format, gzip })
    }

    /// The format that the content looks like.
    pub(crate) fn from_content(bytes: &[u8]) -> Option<Self> {
        Self::ALL.into_iter().rev().find(|format| (format.row().looks_like)(bytes))
    }

    /// Decides by content and name. The content decides if the name has no known extension; if the
    /// content is unclear (in a damaged file, for example), the name decides, and its parser finds
    /// the fault.
    pub(crate) fn decide(named: Option<Self>, bytes: &[u8]) -> Result<Self, Fault> {
        let other = |name: Self, content: &str| {
            let (extension, content) = (name.to_string(), content.to_owned());
            Err(Fault::whole(ReadProblem::OtherKind { extension, content }))
        };
        match (named, Self::from_content(bytes)) {
            (Some(name), Some(content)) if name != content => other(name, content.name()),
            (_, Some(content)) => Ok(content),
            (Some(name), None) => match foreign::kind(bytes) {
                Some(kind) => other(name, &kind),
                None => Ok(name),
            },
            (None, None) => {
                let known = Self::ALL.map(Self::name).to_vec();
                let found = foreign::kind(bytes).unwrap_or_else(|| beginning(bytes));
                Err(Fault::whole(ReadProblem::UnknownKind { known, found }))
            }
        }
    }
}

impl WriteProblem {
    /// [`UnknownExtension`](Self::UnknownExtension) with the file extensions of all formats.
    pub fn unknown_extension() -> Self {
        let known = Format::ALL.map(|format| format.extensions()[0]).to_vec();
        Self::UnknownExtension { known }
    }
}

/// The first bytes, for an error message.
fn beginning(bytes: &[u8]) -> String {
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
    fn names_and_extensions_belong_to_one_format() {
        for format in Format::ALL {
            assert_eq!(format.to_string().parse(), Ok(format));
            assert_eq!(format.name().to_lowercase().parse(), Ok(format));
            for extension in format.extensions() {
                let named = Format::from_path(format!("a.{extension}")).unwrap();
                assert_eq!((named.format, named.gzip), (format, false));
            }
        }
        let error = "fbx".parse::<Format>().unwrap_err().to_string();
        assert!(error.contains("OBJ, PLY, OFF, STL, VTP, GLB"), "{error}");
    }
}
