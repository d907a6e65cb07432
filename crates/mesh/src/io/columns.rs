//! Columns of named numbers, one value or three per element: from the arrays of files to fields,
//! from fields to files, and the meaning of names in PLY.

use std::collections::{BTreeMap, HashMap, HashSet};

use fairing_watch::parallel;

use crate::io::error::WriteProblem;
use crate::io::fields::{Attributes, Columns};
use crate::io::number::{put_float, put_integer};
use crate::io::{FloatWidth, NumberType, VertexFields};

/// The most numbers per element of an array that become fields.
pub(crate) const MAX_COMPONENTS: usize = 16;

/// Some numbers per vertex or face, under a name.
#[derive(Debug, PartialEq)]
pub(crate) struct NamedArray {
    pub(crate) name: String,
    pub(crate) kind: Option<NumberType>,
    /// The numbers per element, 1 or more.
    pub(crate) components: usize,
    pub(crate) values: Vec<f64>,
}

/// Arrays of one component as scalars, of three as vectors, and of other numbers as scalars
/// `name_0`, `name_1`, …
///
/// Names that are empty, repeated or have control characters are changed, which the notes tell.
pub(crate) fn from_arrays(
    arrays: Vec<NamedArray>,
    colors: Option<Vec<[u8; 3]>>,
    notes: &mut Vec<String>,
) -> Columns {
    let mut names = Names::default();
    let (mut scalars, mut vectors, mut types) = (vec![], vec![], BTreeMap::new());
    for NamedArray { name, kind, components, values } in arrays {
        let mut named = |wanted: &str| {
            let base = wanted.replace(|c: char| c.is_ascii_control(), "_");
            let name = names.changed(wanted, base, |names, name| !names.has(name), notes);
            names.taken.insert(name.clone());
            types.extend(kind.map(|kind| (name.clone(), kind)));
            name
        };
        match components {
            1 => scalars.push((named(&name), values)),
            3 => vectors.push((named(&name), values.as_chunks().0.to_vec())),
            _ => scalars.extend((0..components).map(|k| {
                let values = values.iter().skip(k).step_by(components).copied();
                (named(&format!("{name}_{k}")), values.collect())
            })),
        }
    }
    Columns { scalars, vectors, colors, types }
}

/// The values of one property group and their type in the file.
#[derive(Clone, Copy)]
pub(crate) enum Column<'a> {
    Scalar(&'a [f64], NumberType),
    Vector(&'a [[f64; 3]], NumberType),
    Color(&'a [[u8; 3]]),
}

impl Column<'_> {
    pub(crate) fn components(self) -> usize {
        if matches!(self, Self::Scalar(..)) { 1 } else { 3 }
    }

    pub(crate) fn number_type(self) -> NumberType {
        match self {
            Self::Color(_) => NumberType::U8,
            Self::Scalar(_, number) | Self::Vector(_, number) => number,
        }
    }

    /// The number of bytes per element.
    pub(crate) fn size(self) -> usize {
        self.components() * self.number_type().size()
    }

    pub(crate) fn put(self, element: usize, bytes: &mut [u8]) {
        match self {
            Self::Scalar(values, number) => number.put(&[values[element]], bytes),
            Self::Vector(values, number) => number.put(&values[element], bytes),
            Self::Color(values) => bytes.copy_from_slice(&values[element]),
        }
    }

    /// Appends the numbers of an element with a space before each.
    pub(crate) fn write(self, element: usize, text: &mut Vec<u8>) {
        match self {
            Self::Scalar(values, number) => put_text(&[values[element]], number, text),
            Self::Vector(values, number) => put_text(&values[element], number, text),
            Self::Color(values) => {
                for c in values[element] {
                    text.push(b' ');
                    put_integer(text, u64::from(c));
                }
            }
        }
    }
}

/// Appends numbers with a space before each; those of 32 bits as the shortest decimal of the
/// rounded number.
pub(crate) fn put_text(values: &[f64], number: NumberType, text: &mut Vec<u8>) {
    for &x in values {
        text.push(b' ');
        put_float(text, if number == NumberType::F32 { f64::from(x as f32) } else { x });
    }
}

/// The columns of fields: scalars, vectors, colours.
pub(crate) fn columns<'a>(
    format: &'static str,
    fields: Attributes<'a>,
    width: FloatWidth,
) -> Result<Vec<Column<'a>>, WriteProblem> {
    let kept = |name: &str| fields.types.get(name).copied();
    let mut columns = Vec::new();
    for (name, values) in fields.scalars {
        columns.push(Column::Scalar(values, width_of(format, name, values, kept(name), width)?));
    }
    for (name, values) in fields.vectors {
        let number = width_of(format, name, values.as_flattened(), kept(name), width)?;
        columns.push(Column::Vector(values, number));
    }
    columns.extend(fields.colors.map(Column::Color));
    Ok(columns)
}

/// The bytes of all elements in turn.
pub(crate) fn rows(count: usize, columns: &[Column<'_>]) -> Vec<u8> {
    let stride: usize = columns.iter().map(|column| column.size()).sum();
    let mut bytes = vec![0; stride * count];
    const PIECE: usize = 1 << 13;
    parallel::for_chunks(&mut bytes, PIECE * stride, |start, piece| {
        let rows = (start / stride..).zip(piece.chunks_exact_mut(stride));
        match columns {
            [only] => rows.for_each(|(v, row)| only.put(v, row)),
            _ => rows.for_each(|(v, row)| {
                let mut rest = row;
                for column in columns {
                    let (bytes, after) = rest.split_at_mut(column.size());
                    column.put(v, bytes);
                    rest = after;
                }
            }),
        }
    });
    bytes
}

/// The type of the numbers of a property group: the kept one if it holds them all, otherwise
/// one of floating-point numbers.
pub(crate) fn width_of(
    format: &'static str,
    name: &str,
    values: &[f64],
    kept: Option<NumberType>,
    width: FloatWidth,
) -> Result<NumberType, WriteProblem> {
    let holds =
        |number: NumberType| parallel::all(values.len(), 1 << 14, |i| number.holds(values[i]));
    if let Some(kept) = kept
        && (kept.is_integer() || width == FloatWidth::Lossless)
        && holds(kept)
    {
        return Ok(kept);
    }
    match width {
        FloatWidth::Double => Ok(NumberType::F64),
        FloatWidth::Lossless if holds(NumberType::F32) => Ok(NumberType::F32),
        FloatWidth::Lossless => Ok(NumberType::F64),
        FloatWidth::Single => match values.iter().find(|x| (**x as f32).is_infinite()) {
            None => Ok(NumberType::F32),
            Some(x) => Err(WriteProblem::UnsupportedMesh {
                format,
                what: format!("{x:e} in {name} as a 32-bit number"),
            }),
        },
    }
}

/// The columns of positions, colours and fields in PLY.
#[derive(Debug, PartialEq)]
pub(crate) struct Layout {
    pub(crate) position: Option<[usize; 3]>,
    pub(crate) colors: Option<[usize; 3]>,
    pub(crate) vectors: Vec<(String, [usize; 3])>,
    pub(crate) scalars: Vec<(String, usize)>,
}

impl Layout {
    /// Groups columns by name: `x`, `y`, `z`; `red`, `green`, `blue` if they
    /// are bytes; `nx`, `ny`, `nz` are the vector `normal`, and `name_x`,
    /// `name_y`, `name_z` the vector `name`, if adjacent and in this order. All
    /// others are scalars. Reader and writer share the rule, so that fields are
    /// read back as they were written.
    pub(crate) fn of_vertices(columns: &[(&str, NumberType)]) -> Self {
        Self::new(columns, triple_of(columns, ["x", "y", "z"]))
    }

    /// [`of_vertices`](Self::of_vertices) for faces, which have no position.
    pub(crate) fn of_faces(columns: &[(&str, NumberType)]) -> Self {
        Self::new(columns, None)
    }

    fn new(columns: &[(&str, NumberType)], position: Option<[usize; 3]>) -> Self {
        let bytes = |three: &[usize; 3]| three.iter().all(|&k| columns[k].1 == NumberType::U8);
        let colors = triple_of(columns, COLORS).filter(bytes);
        let mut layout = Self { position, colors, vectors: vec![], scalars: vec![] };
        let names: Vec<&str> = columns.iter().map(|&(name, _)| name).collect();
        let mut k = 0;
        while k < columns.len() {
            let taken = [position, colors].iter().flatten().flatten().any(|&p| p == k);
            if taken {
                k += 1;
            } else if let Some(name) = vector_name(&names[k..])
                && !layout.vectors.iter().any(|(other, _)| *other == name)
            {
                layout.vectors.push((name, [k, k + 1, k + 2]));
                k += 3;
            } else {
                layout.scalars.push((names[k].to_owned(), k));
                k += 1;
            }
        }
        layout
    }
}

/// The places of the columns of three names.
fn triple_of(columns: &[(&str, NumberType)], names: [&str; 3]) -> Option<[usize; 3]> {
    let [a, b, c] = names.map(|name| columns.iter().position(|column| column.0 == name));
    Some([a?, b?, c?])
}

/// The names of the properties of colours.
const COLORS: [&str; 3] = ["red", "green", "blue"];

/// The name of the vector whose components have the first three names, if they are one.
fn vector_name(names: &[&str]) -> Option<String> {
    let &[x, y, z, ..] = names else { return None };
    if [x, y, z] == ["nx", "ny", "nz"] {
        return Some("normal".to_owned());
    }
    let stem = x.strip_suffix("_x").filter(|stem| !stem.is_empty())?;
    let same = y.strip_suffix("_y") == Some(stem) && z.strip_suffix("_z") == Some(stem);
    same.then(|| stem.to_owned())
}

/// The property names of a vector field.
fn component_names(vector: &str) -> [String; 3] {
    if vector == "normal" {
        ["nx", "ny", "nz"].map(str::to_owned)
    } else {
        ["x", "y", "z"].map(|axis| format!("{vector}_{axis}"))
    }
}

/// The names of the vertex properties of a PLY file, in the order of the encoder:
/// position, scalars, vectors, colours.
pub(crate) fn vertex_names(fields: &VertexFields) -> Vec<String> {
    let mut names = ["x", "y", "z"].map(str::to_owned).to_vec();
    names.extend(field_names(fields.into()));
    names
}

/// The name of the list that holds the texture coordinates of the corners of a face.
pub(crate) const TEXTURE: &str = "texcoord";

/// The names of the lists that hold the corners of a face.
pub(crate) const INDICES: [&str; 2] = ["vertex_indices", "vertex_index"];

/// The names of the properties of fields.
pub(crate) fn field_names(fields: Attributes<'_>) -> Vec<String> {
    let mut names: Vec<String> = fields.scalars.iter().map(|(name, _)| name.clone()).collect();
    names.extend(fields.vectors.iter().flat_map(|(name, _)| component_names(name)));
    if fields.colors.is_some() {
        names.extend(COLORS.map(str::to_owned));
    }
    names
}

/// The fields under names that PLY reads back as they were written, with a note for
/// each changed name; `None` if all names are so.
pub(crate) fn as_properties(fields: &VertexFields) -> Option<(VertexFields, Vec<String>)> {
    let mut notes = vec![];
    let of_vertices = property_names(fields.into(), &["x", "y", "z"], &mut notes);
    let taken = [INDICES[0], INDICES[1], TEXTURE];
    let of_faces = property_names((&fields.faces).into(), &taken, &mut notes);
    if notes.is_empty() {
        return None;
    }
    let mut renamed = fields.clone();
    let VertexFields { scalars, vectors, types, faces, .. } = &mut renamed;
    rename(of_vertices, scalars, vectors, types);
    rename(of_faces, &mut faces.scalars, &mut faces.vectors, &mut faces.types);
    Some((renamed, notes))
}

/// Names for the scalars and then the vectors.
fn property_names(fields: Attributes<'_>, taken: &[&str], notes: &mut Vec<String>) -> Vec<String> {
    let colors = COLORS.iter().filter(|_| fields.colors.is_some());
    let taken = taken.iter().chain(colors).map(|&name| name.to_owned()).collect();
    let mut names = Names { taken, ..Names::default() };
    let is_byte = |name: &str| fields.types.get(name) == Some(&NumberType::U8);
    let scalars = fields.scalars.iter().map(|(name, _)| names.scalar(name, is_byte, notes));
    let mut all: Vec<String> = scalars.collect();
    all.extend(fields.vectors.iter().map(|(name, _)| names.vector(name, notes)));
    all
}

fn rename(
    names: Vec<String>,
    scalars: &mut [(String, Vec<f64>)],
    vectors: &mut [(String, Vec<[f64; 3]>)],
    types: &mut BTreeMap<String, NumberType>,
) {
    let kept = types.clone();
    let own = scalars.iter_mut().map(|(name, _)| name);
    for (own, name) in own.chain(vectors.iter_mut().map(|(name, _)| name)).zip(names) {
        types.extend(kept.get(own).map(|&kind| (name.clone(), kind)));
        *own = name;
    }
}

/// Names that are taken.
#[derive(Default)]
struct Names {
    /// The names of fields or properties.
    taken: HashSet<String>,
    /// The number to try next, by the beginning of the name.
    next: HashMap<String, usize>,
    /// The last scalars.
    last: Vec<String>,
}

impl Names {
    fn scalar(
        &mut self,
        wanted: &str,
        is_byte: impl Fn(&str) -> bool,
        notes: &mut Vec<String>,
    ) -> String {
        let wanted_is_byte = is_byte(wanted);
        let sound = |names: &Self, name: &str| {
            let last = names.last.iter().rev().take(2).rev().map(|name| &name[..]);
            let triple: Vec<&str> = last.chain([name]).collect();
            let is_part = wanted_is_byte && COLORS.contains(&name);
            let is_other = |color: &str| names.has(color) && is_byte(color);
            let completes = is_part && COLORS.iter().all(|&c| c == name || is_other(c));
            !names.has(name) && vector_name(&triple).is_none() && !completes
        };
        let name = self.changed(wanted, without_space(wanted), sound, notes);
        self.taken.insert(name.clone());
        self.last.push(name.clone());
        name
    }

    fn vector(&mut self, wanted: &str, notes: &mut Vec<String>) -> String {
        let sound = |names: &Self, name: &str| {
            component_names(name).iter().all(|component| !names.has(component))
        };
        let name = self.changed(wanted, without_space(wanted), sound, notes);
        self.taken.extend(component_names(&name));
        name
    }

    fn has(&self, name: &str) -> bool {
        self.taken.contains(name)
    }

    /// The name `base`, with a number if it is not sound.
    fn changed(
        &mut self,
        wanted: &str,
        base: String,
        sound: impl Fn(&Self, &str) -> bool,
        notes: &mut Vec<String>,
    ) -> String {
        let base = if base.is_empty() { "field".to_owned() } else { base };
        let mut name = base.clone();
        while !sound(self, &name) {
            let next = self.next.entry(base.clone()).or_insert(1);
            *next += 1;
            name = format!("{base}_{next}");
        }
        if name != wanted {
            notes.push(format!("the field {wanted:?} is called {name}"));
        }
        name
    }
}

fn without_space(name: &str) -> String {
    name.replace(|c: char| c.is_ascii_whitespace(), "_")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn layout(names: &str) -> Layout {
        let kind = |name| if name == "blue" { NumberType::F32 } else { NumberType::U8 };
        let columns: Vec<_> = names.split(' ').map(|name| (name, kind(name))).collect();
        Layout::of_vertices(&columns)
    }

    #[test]
    fn components_that_stand_together_are_vectors() {
        let found = layout("q z y x nx ny nz a_x a_y a_z b_x b_z b_y");
        assert_eq!(found.position, Some([3, 2, 1]));
        assert_eq!(found.vectors, [("normal".into(), [4, 5, 6]), ("a".into(), [7, 8, 9])]);
        let scalars: Vec<_> = found.scalars.iter().map(|(name, _)| &name[..]).collect();
        assert_eq!(scalars, ["q", "b_x", "b_z", "b_y"]);
    }

    #[test]
    fn colours_are_bytes() {
        let found = layout("x y z red green blue");
        assert_eq!(found.colors, None);
        assert_eq!(found.scalars.len(), 3);
    }
}
