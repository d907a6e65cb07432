//! Arrays in numpy's format: a header that describes the array, and little-endian numbers.
//!
//! Source: the format's description in numpy's documentation, `numpy.lib.format`.

use std::io::{self, Read, Write};

use ndarray::{Array2, ShapeBuilder as _};

/// The magic bytes and the version of the format, 1.0.
const MAGIC: &[u8] = b"\x93NUMPY\x01\x00";

/// Alignment of the first number.
const ALIGNMENT: usize = 64;

/// Numbers converted at once.
const CHUNK: usize = 8192;

/// Element type of an array.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    /// `<f8`.
    Float,
    /// `<u4`.
    Index,
}

impl Kind {
    fn descriptor(self) -> &'static str {
        match self {
            Self::Float => "<f8",
            Self::Index => "<u4",
        }
    }

    /// Bytes of one number.
    fn size(self) -> usize {
        match self {
            Self::Float => 8,
            Self::Index => 4,
        }
    }
}

#[derive(Debug, Clone, PartialEq)]
enum Numbers {
    Floats(Vec<f64>),
    Indices(Vec<u32>),
}

/// An array of one or two dimensions.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Npy {
    numbers: Numbers,
    shape: Vec<usize>,
    /// True if the first index varies fastest.
    by_columns: bool,
}

impl Npy {
    pub(crate) fn floats(values: &[f64]) -> Self {
        let shape = vec![values.len()];
        Self { numbers: Numbers::Floats(values.to_vec()), shape, by_columns: false }
    }

    pub(crate) fn indices(values: &[u32]) -> Self {
        let shape = vec![values.len()];
        Self { numbers: Numbers::Indices(values.to_vec()), shape, by_columns: false }
    }

    /// Keeps the memory order of the matrix.
    pub(crate) fn matrix(matrix: &Array2<f64>) -> Self {
        let by_columns = !matrix.is_standard_layout();
        let values = if by_columns {
            matrix.t().iter().copied().collect()
        } else {
            matrix.iter().copied().collect()
        };
        let shape = vec![matrix.nrows(), matrix.ncols()];
        Self { numbers: Numbers::Floats(values), shape, by_columns }
    }

    fn kind(&self) -> Kind {
        match self.numbers {
            Numbers::Floats(_) => Kind::Float,
            Numbers::Indices(_) => Kind::Index,
        }
    }

    /// The numbers; empty for indices.
    pub(crate) fn into_floats(self) -> Vec<f64> {
        match self.numbers {
            Numbers::Floats(values) => values,
            Numbers::Indices(_) => Vec::new(),
        }
    }

    /// The indices; empty for floating-point numbers.
    pub(crate) fn into_indices(self) -> Vec<u32> {
        match self.numbers {
            Numbers::Floats(_) => Vec::new(),
            Numbers::Indices(values) => values,
        }
    }

    /// The matrix, if it has two dimensions.
    pub(crate) fn into_matrix(self) -> Option<Array2<f64>> {
        let &[rows, columns] = &self.shape[..] else { return None };
        let by_columns = self.by_columns;
        Array2::from_shape_vec((rows, columns).set_f(by_columns), self.into_floats()).ok()
    }

    pub(crate) fn write(&self, to: &mut impl Write) -> io::Result<()> {
        to.write_all(MAGIC)?;
        let header = self.header();
        to.write_all(&(header.len() as u16).to_le_bytes())?;
        to.write_all(header.as_bytes())?;
        match &self.numbers {
            Numbers::Floats(values) => write_numbers(to, values, |x| x.to_le_bytes()),
            Numbers::Indices(values) => write_numbers(to, values, |x| x.to_le_bytes()),
        }
    }

    /// The header as numpy writes it, padded to align the numbers.
    fn header(&self) -> String {
        let order = if self.by_columns { "True" } else { "False" };
        let shape = match self.shape[..] {
            [n] => format!("({n},)"),
            ref shape => {
                let sizes: Vec<String> = shape.iter().map(usize::to_string).collect();
                format!("({})", sizes.join(", "))
            }
        };
        let descriptor = self.kind().descriptor();
        let mut header =
            format!("{{'descr': '{descriptor}', 'fortran_order': {order}, 'shape': {shape}, }}");
        // Plus the magic bytes, two bytes of length and the line end.
        let length = (MAGIC.len() + 2 + header.len() + 1).next_multiple_of(ALIGNMENT);
        header.extend(std::iter::repeat_n(' ', length - MAGIC.len() - 2 - header.len() - 1));
        header.push('\n');
        header
    }

    /// Reads an array of that kind from a file of `size` bytes.
    ///
    /// # Errors
    ///
    /// If the content is not such an array or does not have the length in its header.
    pub(crate) fn read(from: &mut impl Read, size: u64, kind: Kind) -> io::Result<Self> {
        let mut start = [0; 10];
        from.read_exact(&mut start)?;
        if start[..8] != *MAGIC {
            return Err(wrong("not an array in version 1.0 of numpy's format"));
        }
        let length = usize::from(u16::from_le_bytes([start[8], start[9]]));
        let mut header = vec![0; length];
        from.read_exact(&mut header)?;
        let header = std::str::from_utf8(&header).map_err(|_| wrong("the header is not text"))?;
        let (shape, by_columns) = parse(header, kind)?;
        let count = shape.iter().try_fold(1usize, |n, &s| n.checked_mul(s));
        let bytes = count.and_then(|n| n.checked_mul(kind.size()));
        let expected = bytes.and_then(|n| n.checked_add(10 + length));
        if expected.is_none_or(|n| n as u64 != size) {
            return Err(wrong(&format!("shape {shape:?} does not fit a file of {size} bytes")));
        }
        let count = count.unwrap_or(0);
        let numbers = match kind {
            Kind::Float => Numbers::Floats(read_numbers(from, count, f64::from_le_bytes)?),
            Kind::Index => Numbers::Indices(read_numbers(from, count, u32::from_le_bytes)?),
        };
        Ok(Self { numbers, shape, by_columns })
    }
}

fn wrong(problem: &str) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidData, problem.to_string())
}

/// Shape and order from `{'descr': '<f8', 'fortran_order': False, 'shape': (3, 2), }`.
fn parse(header: &str, kind: Kind) -> io::Result<(Vec<usize>, bool)> {
    let value = |key: &str| {
        let (_, rest) = header.split_once(&format!("'{key}':"))?;
        Some(rest.trim_start())
    };
    let missing = |key: &str| wrong(&format!("the header does not say {key}"));
    let descriptor = value("descr").ok_or_else(|| missing("descr"))?;
    let found = descriptor.trim_start_matches('\'').split('\'').next().unwrap_or_default();
    if found != kind.descriptor() {
        return Err(wrong(&format!("holds {found} instead of {}", kind.descriptor())));
    }
    let order = value("fortran_order").ok_or_else(|| missing("fortran_order"))?;
    let by_columns = order.starts_with("True");
    let shape = value("shape").ok_or_else(|| missing("shape"))?;
    let sizes = shape.strip_prefix('(').and_then(|s| s.split_once(')')).map(|(sizes, _)| sizes);
    let sizes = sizes.ok_or_else(|| missing("shape"))?;
    let sizes = sizes.split(',').map(str::trim).filter(|s| !s.is_empty());
    let shape: Result<Vec<usize>, _> = sizes.map(str::parse).collect();
    Ok((shape.map_err(|e| wrong(&format!("shape: {e}")))?, by_columns))
}

fn write_numbers<T: Copy, const N: usize>(
    to: &mut impl Write,
    values: &[T],
    bytes: impl Fn(T) -> [u8; N],
) -> io::Result<()> {
    let mut buffer = Vec::with_capacity(N * CHUNK.min(values.len()));
    for chunk in values.chunks(CHUNK) {
        buffer.clear();
        buffer.extend(chunk.iter().flat_map(|&x| bytes(x)));
        to.write_all(&buffer)?;
    }
    Ok(())
}

/// Allocates memory as numbers arrive and does not trust their declared count.
fn read_numbers<T, const N: usize>(
    from: &mut impl Read,
    count: usize,
    number: impl Fn([u8; N]) -> T,
) -> io::Result<Vec<T>> {
    let mut values = Vec::new();
    let mut buffer = vec![0; N * CHUNK.min(count)];
    while values.len() < count {
        let bytes = &mut buffer[..N * CHUNK.min(count - values.len())];
        from.read_exact(bytes)?;
        values.extend(bytes.as_chunks::<N>().0.iter().map(|&b| number(b)));
    }
    Ok(values)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The output of `numpy.save` for `numpy.array([[1.5, -2.0, 0.0]])` and for
    /// `numpy.arange(2, dtype="u4")`.
    #[test]
    fn files_are_those_of_numpy() {
        let padded = |header: &str| format!("{header:<117}\n");
        let mut floats = MAGIC.to_vec();
        floats.extend([118, 0]);
        let header = "{'descr': '<f8', 'fortran_order': False, 'shape': (1, 3), }";
        floats.extend(padded(header).bytes());
        floats.extend([1.5f64, -2.0, 0.0].iter().flat_map(|x| x.to_le_bytes()));
        let matrix = ndarray::array![[1.5, -2.0, 0.0]];
        let mut written = Vec::new();
        Npy::matrix(&matrix).write(&mut written).unwrap();
        assert_eq!(written, floats);
        let read = Npy::read(&mut &floats[..], floats.len() as u64, Kind::Float).unwrap();
        assert_eq!(read.into_matrix().unwrap(), matrix);

        let mut indices = MAGIC.to_vec();
        indices.extend([118, 0]);
        let header = "{'descr': '<u4', 'fortran_order': False, 'shape': (2,), }";
        indices.extend(padded(header).bytes());
        indices.extend([0, 0, 0, 0, 1, 0, 0, 0]);
        let mut written = Vec::new();
        Npy::indices(&[0, 1]).write(&mut written).unwrap();
        assert_eq!(written, indices);
    }

    #[test]
    fn both_orders_keep_their_entries() {
        let rows = Array2::from_shape_fn((5, 3), |(i, j)| (10 * i + j) as f64);
        let columns = Array2::from_shape_fn((5, 3).f(), |(i, j)| (10 * i + j) as f64);
        for matrix in [rows, columns] {
            let mut bytes = Vec::new();
            Npy::matrix(&matrix).write(&mut bytes).unwrap();
            assert_eq!((bytes.len() - 15 * 8) % ALIGNMENT, 0);
            let read = Npy::read(&mut &bytes[..], bytes.len() as u64, Kind::Float).unwrap();
            assert_eq!(read.into_matrix().unwrap(), matrix);
        }
    }

    /// A forged shape allocates no memory; other types, versions and truncated files are refused.
    #[test]
    fn malformed_arrays_are_refused() {
        let mut bytes = Vec::new();
        Npy::floats(&[1.0, 2.0]).write(&mut bytes).unwrap();
        let read = |bytes: &[u8], kind| Npy::read(&mut &*bytes, bytes.len() as u64, kind);
        assert!(read(&bytes, Kind::Float).is_ok());
        let error = |bytes: &[u8], kind| read(bytes, kind).unwrap_err().to_string();
        assert!(error(&bytes, Kind::Index).contains("<f8 instead of <u4"));
        assert!(error(&bytes[..bytes.len() - 1], Kind::Float).contains("does not fit"));
        assert!(read(&bytes[..9], Kind::Float).is_err());
        let text = String::from_utf8_lossy(&bytes[10..128]).into_owned();
        for shape in ["(99999999999999,)", "(9999999999, 9999999999)", "(x,)", "2"] {
            let mut forged = bytes.clone();
            let header = text.replace("(2,)", shape);
            forged.splice(10..128, format!("{:<117}\n", header.trim_end()).bytes());
            assert!(read(&forged, Kind::Float).is_err(), "{shape}");
        }
        bytes[6] = 9;
        assert!(error(&bytes, Kind::Float).contains("version"));
    }
}
