//! Choices for reading and writing.

/// What to do with content that is sound but cannot be kept.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum Strictness {
    /// Leave it out and report it.
    #[default]
    Lenient,
    /// Refuse the file: faces that repeat a corner, weights of vertices that
    /// are not 1, fields with values that are not finite.
    Strict,
    /// As [`Lenient`](Self::Lenient), and leave out what is broken, too, which
    /// the others refuse: faces that name a vertex that is not there or whose
    /// position is not finite. Such a vertex keeps its number, in no face and
    /// at the place of the first sound vertex, so that the numbers of all
    /// others, and the rows of fields, stay those of the file.
    DropBroken,
}

/// How to read.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
pub struct ReadOptions {
    /// What to do with content that cannot be kept.
    pub strictness: Strictness,
    /// The most bytes a compressed file may unpack to.
    pub max_unpacked_bytes: u64,
    /// The most a compressed file may grow, as a multiple of its size, beyond
    /// [`Self::FREE_UNPACKED_BYTES`]. Meshes seldom exceed 20; a deflate
    /// bomb reaches 1000.
    pub max_unpack_ratio: u64,
}

impl ReadOptions {
    /// What any compressed file may unpack to, however small it is.
    pub const FREE_UNPACKED_BYTES: u64 = 16 << 20;

    /// The default options, with broken vertices and faces left out.
    pub fn dropping_broken() -> Self {
        Self { strictness: Strictness::DropBroken, ..Self::default() }
    }

    /// The default options with strict reading.
    pub fn strict() -> Self {
        Self { strictness: Strictness::Strict, ..Self::default() }
    }
}

impl Default for ReadOptions {
    fn default() -> Self {
        Self {
            strictness: Strictness::Lenient,
            max_unpacked_bytes: 16 << 30,
            max_unpack_ratio: 250,
        }
    }
}

/// How numbers and records are laid out in a PLY or STL file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum Encoding {
    /// Binary, little endian.
    #[default]
    Binary,
    /// Text.
    Ascii,
}

/// How wide the floating-point properties of a PLY file are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum FloatWidth {
    /// `float` where every value of the property group (positions, or one
    /// field) is exactly a 32-bit number, `double` elsewhere: nothing is lost,
    /// and data that came from 32 bits take no more room than before.
    #[default]
    Lossless,
    /// `double` always.
    Double,
    /// `float` always, rounded to nearest.
    Single,
}

/// What to do with fields that a format cannot hold.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum UnsupportedFields {
    /// Write nothing and say so.
    #[default]
    Refuse,
    /// Leave them out; [`WriteReport`](super::WriteReport) names them.
    Drop,
}

/// How to write.
#[derive(Debug, Clone, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
pub struct WriteOptions {
    /// For PLY and STL; the other formats are text.
    pub encoding: Encoding,
    /// For PLY; other text is the shortest that reads back as the same `f64`,
    /// and binary STL has 32 bits.
    pub float_width: FloatWidth,
    /// For fields that the format cannot hold.
    pub unsupported_fields: UnsupportedFields,
}

impl WriteOptions {
    /// The default options with text instead of binary.
    pub fn ascii() -> Self {
        Self { encoding: Encoding::Ascii, ..Self::default() }
    }

    /// These options with fields dropped where the format cannot hold them.
    #[must_use]
    pub fn dropping_fields(mut self) -> Self {
        self.unsupported_fields = UnsupportedFields::Drop;
        self
    }

    /// These options with another width of PLY's floating-point properties.
    #[must_use]
    pub fn with_float_width(mut self, width: FloatWidth) -> Self {
        self.float_width = width;
        self
    }
}
