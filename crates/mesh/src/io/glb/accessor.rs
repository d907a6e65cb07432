//! Arrays of numbers in the binary data, with bounds that the file must hold.

use crate::io::error::{Fault, unexpected};
use crate::io::glb::document::{Document, Entry};
use crate::io::{NumberType, ReadOptions};

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
    stride: usize,
    bytes: &'a [u8],
    /// The place of `bytes` in the file.
    at: usize,
}

impl<'a> Accessors<'a> {
    pub(super) fn new(document: &'a Document<'a>, file: usize) -> Self {
        Self { document, budget: ReadOptions::unpacked_limit(file) }
    }

    /// The array of an index, whose bounds are checked.
    pub(super) fn open(&mut self, index: usize) -> Result<Accessor<'a>, Fault> {
        let root = self.document.root();
        let entry = root.at("accessors", index)?;
        if entry.get("sparse").is_some() {
            return Err(entry.fault("an array that is not sparse", "a sparse one"));
        }
        let Some(view) = entry.optional_count("bufferView")? else {
            return Err(entry.fault("a bufferView", "none"));
        };
        let view = root.at("bufferViews", view)?;
        let kind = match entry.required_count("componentType")? {
            5120 => NumberType::I8,
            5121 => NumberType::U8,
            5122 => NumberType::I16,
            5123 => NumberType::U16,
            5125 => NumberType::U32,
            5126 => NumberType::F32,
            other => return Err(entry.fault("a componentType", other.to_string())),
        };
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
        let stride = view.optional_count("byteStride")?.unwrap_or(size);
        if stride < size {
            let expected = format!("a byteStride of {size} or more");
            return Err(view.fault(&expected, stride.to_string()));
        }
        let (bytes, at) = self.view(&view)?;
        let count = entry.required_count("count")?;
        let start = entry.optional_count("byteOffset")?.unwrap_or(0);
        let length = match count.checked_sub(1) {
            Some(steps) => steps.checked_mul(stride).and_then(|bytes| bytes.checked_add(size)),
            None => Some(0),
        };
        let end = length.and_then(|length| start.checked_add(length));
        let Some(part) = end.and_then(|end| bytes.get(start..end)) else {
            let expected = format!("{count} elements of {size} bytes from byte {start}");
            return Err(entry.fault(&expected, format!("a bufferView of {} bytes", bytes.len())));
        };
        let normalized = entry.flag("normalized");
        self.spend(&entry, count, 8 * components)?;
        Ok(Accessor { count, components, kind, normalized, stride, bytes: part, at: at + start })
    }

    /// The bytes of a view, and their place in the file.
    fn view(&self, view: &Entry<'a>) -> Result<(&'a [u8], usize), Fault> {
        let buffer = view.required_count("buffer")?;
        let entry = self.document.root().at("buffers", buffer)?;
        if let Some(uri) = entry.get("uri") {
            let found = match uri.text() {
                Some(text) if !text.starts_with("data:") => format!("data in the file {text:?}"),
                _ => "data in a URI".to_owned(),
            };
            return Err(entry.fault("data in the binary chunk", found));
        }
        let Some((binary, at)) = self.document.binary.filter(|_| buffer == 0) else {
            return Err(entry.fault("data in the binary chunk", "none"));
        };
        let length = view.required_count("byteLength")?;
        let start = view.optional_count("byteOffset")?.unwrap_or(0);
        let end = start.checked_add(length);
        match end.and_then(|end| binary.get(start..end)) {
            Some(bytes) => Ok((bytes, at + start)),
            None => {
                let expected = format!("{length} bytes from byte {start}");
                Err(view.fault(&expected, format!("a buffer of {} bytes", binary.len())))
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
        let element = |k: usize| &self.bytes[k * self.stride..][..self.components * size];
        (0..self.count).flat_map(|k| element(k).chunks_exact(size).map(decode)).collect()
    }

    /// All numbers of a list of indices.
    pub(super) fn indices(&self, entry: &Entry<'_>) -> Result<Vec<u32>, Fault> {
        use NumberType::{U8, U16, U32};
        if self.components != 1 || self.normalized || !matches!(self.kind, U8 | U16 | U32) {
            return Err(entry.fault("unsigned integers", "other numbers"));
        }
        let index = |k: usize| self.kind.decode_integer(false, &self.bytes[k * self.stride..]);
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
        Fault::at_byte(self.at + element * self.stride, problem)
    }

    /// A problem of a number of elements.
    pub(super) fn unequal(&self, entry: &Entry<'_>, expected: usize) -> Option<Fault> {
        let found = self.count;
        let problem =
            || unexpected(format!("{expected} elements of {}", entry.path()), found.to_string());
        (found != expected).then(|| Fault::whole(problem()))
    }
}
