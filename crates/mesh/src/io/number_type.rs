//! Types of the numbers in files.

/// The type of a number in a file. In memory every number is an `f64`, which holds all of them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum NumberType {
    /// A signed byte.
    I8,
    /// A byte.
    U8,
    /// A signed integer of 16 bits.
    I16,
    /// An integer of 16 bits.
    U16,
    /// A signed integer of 32 bits.
    I32,
    /// An integer of 32 bits.
    U32,
    /// A floating-point number of 32 bits.
    F32,
    /// A floating-point number of 64 bits.
    F64,
}

impl NumberType {
    /// The number of bytes.
    pub fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }

    /// Returns true for types of integers.
    pub(crate) fn is_integer(self) -> bool {
        !matches!(self, Self::F32 | Self::F64)
    }

    /// Returns true if a number of this type equals `x`; no integer equals −0.
    #[inline]
    pub fn holds(self, x: f64) -> bool {
        let kept = match self {
            Self::F64 => return true,
            Self::F32 => return f64::from(x as f32) == x,
            Self::I8 => f64::from(x as i8),
            Self::U8 => f64::from(x as u8),
            Self::I16 => f64::from(x as i16),
            Self::U16 => f64::from(x as u16),
            Self::I32 => f64::from(x as i32),
            Self::U32 => f64::from(x as u32),
        };
        kept.to_bits() == x.to_bits()
    }

    /// Writes numbers in little-endian order, rounded to 32 bits for
    /// [`F32`](Self::F32); an integer type must [hold](Self::holds) them.
    #[inline]
    pub(crate) fn put(self, values: &[f64], bytes: &mut [u8]) {
        macro_rules! put {
            ($number:ty) => {{
                let words = bytes.as_chunks_mut().0;
                words
                    .iter_mut()
                    .zip(values)
                    .for_each(|(word, &x)| *word = (x as $number).to_le_bytes());
            }};
        }
        match self {
            Self::I8 => put!(i8),
            Self::U8 => put!(u8),
            Self::I16 => put!(i16),
            Self::U16 => put!(u16),
            Self::I32 => put!(i32),
            Self::U32 => put!(u32),
            Self::F32 => put!(f32),
            Self::F64 => put!(f64),
        }
    }

    /// Reads a number at the start of `bytes`.
    #[inline]
    pub(crate) fn decode(self, big_endian: bool, bytes: &[u8]) -> f64 {
        match self {
            Self::F32 => f64::from(f32::from_bits(word(bytes, 4, big_endian) as u32)),
            Self::F64 => f64::from_bits(word(bytes, 8, big_endian)),
            _ => self.decode_integer(big_endian, bytes) as f64,
        }
    }

    /// Reads an integer at the start of `bytes`; a floating-point number is truncated.
    #[inline]
    pub(crate) fn decode_integer(self, big_endian: bool, bytes: &[u8]) -> i64 {
        let word = |size| word(bytes, size, big_endian);
        match self {
            Self::I8 => i64::from(word(1) as i8),
            Self::U8 => word(1) as i64,
            Self::I16 => i64::from(word(2) as i16),
            Self::U16 => word(2) as i64,
            Self::I32 => i64::from(word(4) as i32),
            Self::U32 => word(4) as i64,
            Self::F32 | Self::F64 => self.decode(big_endian, bytes) as i64,
        }
    }
}

/// The first `size` bytes as an unsigned integer.
#[inline]
pub(crate) fn word(bytes: &[u8], size: usize, big_endian: bool) -> u64 {
    let fold = |word: u64, &byte: &u8| (word << 8) | u64::from(byte);
    let bytes = &bytes[..size];
    if big_endian { bytes.iter().fold(0, fold) } else { bytes.iter().rev().fold(0, fold) }
}
