//! Arrays of numbers in the binary data, with bounds that the file must hold; colours are linear in
//! files and sRGB in memory.

use std::borrow::Cow;

use crate::io::error::{Fault, unexpected};
use crate::io::glb::document::Document;
use crate::io::glb::entry::Entry;
use crate::io::{NumberType, Reader};

/// The reader of arrays.
pub(super) struct Accessors<'a> {
    document: &'a Document<'a>,
    /// The most bytes of memory that the arrays to come may take: several may share bytes of the
    /// file, and a mesh may be in many nodes.
    budget: usize,
}

/// Numbers of equal elements in the file.
pub(super) struct Accessor<'a> {
    pub(super) count: usize,
    pub(super) components: usize,
    kind: NumberType,
    normalized: bool,
    part: Part<'a>,
}

/// The bytes of elements.
struct Part<'a> {
    bytes: Cow<'a, [u8]>,
    /// From one element to the next.
    stride: usize,
    /// The place of `bytes` in the file, if they are a part of it.
    at: Option<usize>,
}

impl<'a> Accessors<'a> {
    pub(super) fn new(document: &'a Document<'a>, file: usize) -> Self {
        Self { document, budget: Reader::unpacked_limit(file) }
    }

    /// The array of an index, whose bounds are checked.
    pub(super) fn open(&mut self, index: usize) -> Result<Accessor<'a>, Fault> {
        let root = self.document.root();
        let entry = root.at("accessors", index)?;
        let kind = kind_of(&entry)?;
        let components = match entry.get("type").and_then(|entry| entry.text()) {
            Some("SCALAR") => 1,
            Some("VEC2") => 2,
            Some("VEC3") => 3,
            Some("VEC4") => 4,
            other => {
                let found = other.unwrap_or("none");
                return Err(entry.fault("the type SCALAR, VEC2, VEC3 or VEC4", found));
            }
        };
        let size = components * kind.size();
        let count = entry.required_count("count")?;
        let sparse = entry.get("sparse");
        let whole = match entry.get("bufferView") {
            None if sparse.is_some() => None,
            _ => Some(self.part(&entry, count, size)?),
        };
        let normalized = entry.flag("normalized");
        self.spend(&entry, count, 8 * components)?;
        let part = match (sparse, whole) {
            (Some(sparse), whole) => self.replaced(&entry, &sparse, whole, count, size)?,
            (None, Some(part)) => part,
            (None, None) => return Err(entry.fault("a bufferView", "none")),
        };
        Ok(Accessor { count, components, kind, normalized, part })
    }

    /// The elements with those that a sparse accessor replaces; zeros without a whole.
    fn replaced(
        &mut self,
        entry: &Entry<'a>,
        sparse: &Entry<'a>,
        whole: Option<Part<'a>>,
        count: usize,
        size: usize,
    ) -> Result<Part<'a>, Fault> {
        let [indices, values] = ["indices", "values"].map(|key| sparse.get(key));
        let (Some(indices), Some(values)) = (indices, values) else {
            return Err(sparse.fault("indices and values", "none"));
        };
        let replaced = sparse.required_count("count")?;
        let kind = kind_of(&indices)?;
        if !matches!(kind, NumberType::U8 | NumberType::U16 | NumberType::U32) {
            return Err(indices.fault("unsigned integers", "other numbers"));
        }
        let of = self.part(&indices, replaced, kind.size())?;
        let values = self.part(&values, replaced, size)?;
        self.spend(entry, count, size)?;
        let mut bytes = match whole {
            None => vec![0; count * size],
            Some(whole) => (0..count).flat_map(|k| whole.element(k, size)).copied().collect(),
        };
        for k in 0..replaced {
            let index = kind.decode_integer(false, of.element(k, kind.size()));
            let at = usize::try_from(index).ok().filter(|&index| index < count);
            let Some(at) = at.map(|index| index * size) else {
                let expected = format!("indices of {count} elements");
                return Err(indices.fault(&expected, index.to_string()));
            };
            bytes[at..at + size].copy_from_slice(values.element(k, size));
        }
        Ok(Part { bytes: Cow::Owned(bytes), stride: size, at: None })
    }

    /// The bytes of `count` elements of `size` bytes each in the view that an entry names.
    fn part(&self, entry: &Entry<'a>, count: usize, size: usize) -> Result<Part<'a>, Fault> {
        let Some(view) = entry.optional_count("bufferView")? else {
            return Err(entry.fault("a bufferView", "none"));
        };
        let view = self.document.root().at("bufferViews", view)?;
        let stride = view.optional_count("byteStride")?.unwrap_or(size);
        if stride < size {
            let expected = format!("a byteStride of {size} or more");
            return Err(view.fault(&expected, stride.to_string()));
        }
        let (bytes, at) = self.view(&view)?;
        let start = entry.optional_count("byteOffset")?.unwrap_or(0);
        let length = match count.checked_sub(1) {
            Some(steps) => steps.checked_mul(stride).and_then(|bytes| bytes.checked_add(size)),
            None => Some(0),
        };
        let end = length.and_then(|length| start.checked_add(length));
        match end.and_then(|end| bytes.get(start..end)) {
            Some(part) => {
                let at = at.map(|at| at + start);
                Ok(Part { bytes: Cow::Borrowed(part), stride, at })
            }
            None => {
                let expected = format!("{count} elements of {size} bytes from byte {start}");
                let found = format!("a bufferView of {} bytes", bytes.len());
                Err(entry.fault(&expected, found))
            }
        }
    }

    /// The bytes of a view, and their place in the file.
    fn view(&self, view: &Entry<'a>) -> Result<(&'a [u8], Option<usize>), Fault> {
        let number = view.required_count("buffer")?;
        let entry = self.document.root().at("buffers", number)?;
        let Some(buffer) = self.document.buffers.get(number).and_then(Option::as_ref) else {
            return Err(entry.fault("data in the binary chunk or a URI", "none"));
        };
        let length = view.required_count("byteLength")?;
        let start = view.optional_count("byteOffset")?.unwrap_or(0);
        let end = start.checked_add(length);
        match end.and_then(|end| buffer.data.get(start..end)) {
            Some(bytes) => Ok((bytes, buffer.at.map(|at| at + start))),
            None => {
                let expected = format!("{length} bytes from byte {start}");
                Err(view.fault(&expected, format!("a buffer of {} bytes", buffer.data.len())))
            }
        }
    }

    /// Refuses more memory than a sound file of this size needs.
    pub(super) fn spend(
        &mut self,
        entry: &Entry<'_>,
        count: usize,
        each: usize,
    ) -> Result<(), Fault> {
        let left = count.checked_mul(each).and_then(|bytes| self.budget.checked_sub(bytes));
        match left {
            Some(left) => self.budget = left,
            None => {
                let expected = "arrays of which the file needs no hundreds of copies";
                return Err(entry.fault(expected, format!("{count} more elements")));
            }
        }
        Ok(())
    }
}

/// The type of numbers.
fn kind_of(entry: &Entry<'_>) -> Result<NumberType, Fault> {
    Ok(match entry.required_count("componentType")? {
        5120 => NumberType::I8,
        5121 => NumberType::U8,
        5122 => NumberType::I16,
        5123 => NumberType::U16,
        5125 => NumberType::U32,
        5126 => NumberType::F32,
        other => return Err(entry.fault("a componentType", other.to_string())),
    })
}

impl Part<'_> {
    fn element(&self, k: usize, size: usize) -> &[u8] {
        &self.bytes[k * self.stride..][..size]
    }
}

impl Accessor<'_> {
    /// All numbers, those of an element together.
    pub(super) fn floats(&self) -> Vec<f64> {
        let size = self.kind.size();
        let divisor = match (self.normalized, self.kind) {
            (true, NumberType::I8) => 127.0,
            (true, NumberType::U8) => 255.0,
            (true, NumberType::I16) => 32767.0,
            (true, NumberType::U16) => 65535.0,
            _ => 1.0,
        };
        let decode = |bytes: &[u8]| {
            let x = self.kind.decode(false, bytes) / divisor;
            if self.normalized { x.max(-1.0) } else { x }
        };
        let element = |k: usize| self.part.element(k, self.components * size);
        (0..self.count).flat_map(|k| element(k).chunks_exact(size).map(decode)).collect()
    }

    /// All numbers of a list of indices.
    pub(super) fn indices(&self, entry: &Entry<'_>) -> Result<Vec<u32>, Fault> {
        use NumberType::{U8, U16, U32};
        if self.components != 1 || self.normalized || !matches!(self.kind, U8 | U16 | U32) {
            return Err(entry.fault("unsigned integers", "other numbers"));
        }
        let element = |k: usize| self.part.element(k, self.kind.size());
        let index = |k: usize| self.kind.decode_integer(false, element(k));
        Ok((0..self.count).map(|k| index(k) as u32).collect())
    }

    /// Fails unless elements have as many components.
    pub(super) fn require(&self, entry: &Entry<'_>, components: &[usize]) -> Result<(), Fault> {
        if components.contains(&self.components) {
            return Ok(());
        }
        let expected: Vec<String> = components.iter().map(usize::to_string).collect();
        let expected = format!("{} components", expected.join(" or "));
        Err(entry.fault(&expected, self.components.to_string()))
    }

    /// A problem of an element.
    pub(super) fn fault(&self, element: usize, problem: crate::io::ReadProblem) -> Fault {
        match self.part.at {
            Some(at) => Fault::at_byte(at + element * self.part.stride, problem),
            None => Fault::whole(problem),
        }
    }

    /// Fails unless there are as many elements.
    pub(super) fn require_count(&self, entry: &Entry<'_>, expected: usize) -> Result<(), Fault> {
        if self.count == expected {
            return Ok(());
        }
        let expected = format!("{expected} elements of {}", entry.path());
        Err(Fault::whole(unexpected(expected, self.count.to_string())))
    }
}

/// The linear value of an sRGB byte, of 65535; different bytes have different values.
pub(super) fn to_linear(byte: u8) -> u16 {
    let c = f64::from(byte) / 255.0;
    let linear = if c <= 0.04045 { c / 12.92 } else { libm::pow((c + 0.055) / 1.055, 2.4) };
    (65535.0 * linear).round() as u16
}

/// The sRGB byte of a linear value from 0 to 1.
pub(super) fn to_srgb(linear: f64) -> u8 {
    let c = match linear {
        x if x <= 0.003_130_8 => 12.92 * x,
        x => 1.055 * libm::pow(x, 1.0 / 2.4) - 0.055,
    };
    (255.0 * c).round() as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_survive() {
        for byte in 0..=255 {
            assert_eq!(to_srgb(f64::from(to_linear(byte)) / 65535.0), byte);
        }
        assert_eq!((to_linear(0), to_linear(255), to_linear(188)), (0, 65535, 32957));
    }
}
