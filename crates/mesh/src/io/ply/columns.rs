//! Properties of an element as positions, fields and colours, grouped by their names.

use std::collections::BTreeMap;

use crate::io::fields::{Attributes, Columns};
use crate::io::ply::header::{Element, Kind};
use crate::io::ply::source::Rows;
use crate::io::{NumberType, VertexFields};

/// The types and the grouping of the scalar properties of an element.
pub(super) struct Scalars {
    pub(super) kinds: Vec<NumberType>,
    pub(super) layout: Layout,
}

impl Scalars {
    pub(super) fn new(element: &Element, layout: fn(&[Column<'_>]) -> Layout) -> Self {
        let (kinds, columns): (Vec<NumberType>, Vec<Column<'_>>) = element
            .properties
            .iter()
            .filter_map(|property| match property.kind {
                Kind::Scalar(kind) => {
                    let is_byte = kind == NumberType::U8;
                    Some((kind, Column { name: &property.name, is_byte }))
                }
                Kind::List { .. } => None,
            })
            .unzip();
        Self { kinds, layout: layout(&columns) }
    }

    /// Decodes rows of one size, in parallel; property `k` begins at `offsets[k]`.
    pub(super) fn of_rows(&self, rows: &Rows<'_>, offsets: &[usize]) -> Columns {
        let Layout { scalars, vectors, colors, .. } = &self.layout;
        let scalar = |k: usize| -> Vec<f64> {
            let (offset, kind) = (offsets[k], self.kinds[k]);
            rows.map(|row| kind.decode(rows.big_endian, &row[offset..]))
        };
        let colors = colors.map(|ks| {
            let at = ks.map(|k| offsets[k]);
            rows.map(|row| at.map(|offset| row[offset]))
        });
        let triples = |ks: &[usize; 3]| self.triples_of_rows(rows, offsets, *ks);
        Columns {
            scalars: scalars.iter().map(|(name, k)| (name.clone(), scalar(*k))).collect(),
            vectors: vectors.iter().map(|(name, ks)| (name.clone(), triples(ks))).collect(),
            colors,
            types: self.types(),
        }
    }

    /// Three properties as vectors. The usual case, three adjacent little-endian numbers of
    /// one type, has its own branch-free loop.
    pub(super) fn triples_of_rows(
        &self,
        rows: &Rows<'_>,
        offsets: &[usize],
        properties: [usize; 3],
    ) -> Vec<[f64; 3]> {
        let columns = properties.map(|k| (offsets[k], self.kinds[k]));
        let [(offset, kind), ..] = columns;
        let side_by_side = [0, 1, 2].map(|k| (offset + k * kind.size(), kind)) == columns;
        match kind {
            NumberType::F32 if side_by_side && !rows.big_endian => rows.map(|row| {
                let words = row[offset..offset + 12].as_chunks().0;
                [words[0], words[1], words[2]].map(|word| f64::from(f32::from_le_bytes(word)))
            }),
            NumberType::F64 if side_by_side && !rows.big_endian => rows.map(|row| {
                let words = row[offset..offset + 24].as_chunks().0;
                [words[0], words[1], words[2]].map(f64::from_le_bytes)
            }),
            _ => rows.map(|row| {
                columns.map(|(offset, kind)| kind.decode(rows.big_endian, &row[offset..]))
            }),
        }
    }

    /// Groups values that were read one by one.
    pub(super) fn of_values(&self, mut values: Vec<Vec<f64>>) -> Columns {
        let Layout { scalars, vectors, colors, .. } = &self.layout;
        let vectors =
            vectors.iter().map(|(name, ks)| (name.clone(), triples(&values, *ks))).collect();
        let colors =
            colors.map(|ks| triples(&values, ks).iter().map(|c| c.map(|x| x as u8)).collect());
        let scalars = scalars
            .iter()
            .map(|(name, k)| (name.clone(), std::mem::take(&mut values[*k])))
            .collect();
        Columns { scalars, vectors, colors, types: self.types() }
    }

    /// Returns true for a part of a colour, which must be a byte in text as well.
    pub(super) fn is_color(&self, property: usize) -> bool {
        self.layout.colors.is_some_and(|ks| ks.contains(&property))
    }

    /// The types of fields; a vector has one if its components agree.
    fn types(&self) -> BTreeMap<String, NumberType> {
        let Layout { scalars, vectors, .. } = &self.layout;
        let scalars = scalars.iter().map(|(name, k)| (name.clone(), self.kinds[*k]));
        let vectors = vectors.iter().filter_map(|(name, ks)| {
            let [x, y, z] = ks.map(|k| self.kinds[k]);
            (x == y && y == z).then(|| (name.clone(), x))
        });
        scalars.chain(vectors).collect()
    }
}

/// Three columns of values as vectors.
pub(super) fn triples(values: &[Vec<f64>], [a, b, c]: [usize; 3]) -> Vec<[f64; 3]> {
    let (a, b, c) = (&values[a], &values[b], &values[c]);
    a.iter().zip(b).zip(c).map(|((&a, &b), &c)| [a, b, c]).collect()
}

/// The name of the format.
pub(super) const NAME: &str = "PLY";

/// The name and type of a property.
pub(crate) struct Column<'a> {
    pub(crate) name: &'a str,
    pub(crate) is_byte: bool,
}

/// The columns of positions, colours and fields.
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
    pub(crate) fn of_vertices(columns: &[Column<'_>]) -> Self {
        Self::new(columns, true)
    }

    /// [`of_vertices`](Self::of_vertices) for faces, which have no position.
    pub(crate) fn of_faces(columns: &[Column<'_>]) -> Self {
        Self::new(columns, false)
    }

    fn new(columns: &[Column<'_>], positions: bool) -> Self {
        let find = |name: &str| columns.iter().position(|column| column.name == name);
        let all = |names: [&str; 3]| {
            let [a, b, c] = names.map(find);
            Some([a?, b?, c?])
        };
        let position = all(["x", "y", "z"]).filter(|_| positions);
        let bytes = |three: &[usize; 3]| three.iter().all(|&k| columns[k].is_byte);
        let colors = all(COLORS).filter(bytes);
        let mut layout = Self { position, colors, vectors: vec![], scalars: vec![] };
        let names: Vec<&str> = columns.iter().map(|column| column.name).collect();
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
                layout.scalars.push((columns[k].name.to_owned(), k));
                k += 1;
            }
        }
        layout
    }
}

/// The names of the properties of colours.
pub(crate) const COLORS: [&str; 3] = ["red", "green", "blue"];

/// The name of the vector whose components have the first three names, if they are one.
pub(crate) fn vector_name(names: &[&str]) -> Option<String> {
    let &[x, y, z, ..] = names else { return None };
    if [x, y, z] == ["nx", "ny", "nz"] {
        return Some("normal".to_owned());
    }
    let stem = x.strip_suffix("_x").filter(|stem| !stem.is_empty())?;
    let same = y.strip_suffix("_y") == Some(stem) && z.strip_suffix("_z") == Some(stem);
    same.then(|| stem.to_owned())
}

/// The property names of a vector field.
pub(crate) fn component_names(vector: &str) -> [String; 3] {
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

#[cfg(test)]
mod tests {
    use super::*;

    fn layout(names: &str) -> Layout {
        let columns: Vec<_> =
            names.split(' ').map(|name| Column { name, is_byte: name != "blue" }).collect();
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
