//! Options for reading and writing.

/// The treatment of content that a mesh cannot hold.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum Strictness {
    /// Leave it out and report it.
    #[default]
    Lenient,
    /// Refuse the file, for example for faces that repeat a corner, vertex weights
    /// other than 1, or fields with values that are not finite.
    Strict,
    /// Like [`Lenient`](Self::Lenient), and also drops faces that the other modes refuse: those
    /// with an index out of range or a non-finite vertex. Such a vertex keeps its number, so that
    /// the numbers of all other vertices and the rows of fields stay those of the file; it takes
    /// the position of the first valid vertex and belongs to no face.
    DropBroken,
}

/// A reader of mesh files by these rules and limits; [`read`](super::read) takes the default.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
pub struct Reader {
    /// The treatment of content that a mesh cannot hold.
    pub strictness: Strictness,
    /// The largest size of a file or stream, in bytes, and that of its decompressed content.
    pub max_bytes: u64,
    /// The largest ratio of decompressed to compressed size, beyond
    /// [`Self::FREE_UNPACKED_BYTES`]. Meshes seldom exceed 20; a deflate
    /// bomb reaches 1000.
    pub max_unpack_ratio: u64,
}

impl Reader {
    /// A decompressed size in bytes that is always allowed, even for a tiny file.
    pub const FREE_UNPACKED_BYTES: u64 = 16 << 20;

    /// The most bytes of memory that the arrays of a file of `bytes` bytes may take, where packed
    /// arrays or several of the same bytes take more than the file.
    pub(crate) fn unpacked_limit(bytes: usize) -> usize {
        let ratio = usize::try_from(Self::default().max_unpack_ratio).unwrap_or(usize::MAX);
        let free = usize::try_from(Self::FREE_UNPACKED_BYTES).unwrap_or(usize::MAX);
        bytes.saturating_mul(ratio).saturating_add(free)
    }

    /// A reader with [`Strictness::DropBroken`].
    pub fn dropping_broken() -> Self {
        Self { strictness: Strictness::DropBroken, ..Self::default() }
    }

    /// A reader with [`Strictness::Strict`].
    pub fn strict() -> Self {
        Self { strictness: Strictness::Strict, ..Self::default() }
    }
}

impl Default for Reader {
    fn default() -> Self {
        Self { strictness: Strictness::Lenient, max_bytes: 16 << 30, max_unpack_ratio: 250 }
    }
}

/// The encoding of a format that has a binary and a text form.
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

/// The width of floating-point numbers in a format that has several. Fields of integers
/// keep their [type](super::VertexFields::types).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum FloatWidth {
    /// The type that a field has in its file; otherwise `float` if every value of the
    /// property group (the positions, or one field) is exactly a 32-bit number, and
    /// `double` if not. Lossless, and data that came from 32 bits take no more space
    /// than before.
    #[default]
    Lossless,
    /// Always `double`.
    Double,
    /// Always `float`, rounded to nearest.
    Single,
}

/// The treatment of fields that a format cannot hold.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum UnsupportedFields {
    /// Fail, and write nothing.
    #[default]
    Refuse,
    /// Leave the fields out and name them in the [`WriteReport`](super::WriteReport).
    Drop,
}

/// Options for writing.
#[derive(Debug, Clone, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
pub struct WriteOptions {
    /// Used by formats with both encodings, [`Holds::binary`](super::Holds::binary).
    pub encoding: Encoding,
    /// Used by formats with several widths, [`Holds::float_widths`](super::Holds::float_widths).
    /// Other text is the shortest that reads back as the same `f64`; binary STL has 32 bits.
    pub float_width: FloatWidth,
    /// The treatment of fields that the format cannot hold.
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

    /// These options with another width of floating-point numbers.
    #[must_use]
    pub fn with_float_width(mut self, width: FloatWidth) -> Self {
        self.float_width = width;
        self
    }
}
