//! Scalar properties of an element as positions, fields and colours.

use std::collections::BTreeMap;

use crate::io::NumberType;
use crate::io::columns::Layout;
use crate::io::fields::Columns;
use crate::io::ply::header::{Element, Kind};
use crate::io::ply::source::Rows;

/// The types and the grouping of the scalar properties of an element.
pub(super) struct Scalars {
    pub(super) kinds: Vec<NumberType>,
    pub(super) layout: Layout,
}

impl Scalars {
    pub(super) fn new(element: &Element, layout: fn(&[(&str, NumberType)]) -> Layout) -> Self {
        let scalars = element.properties.iter().filter_map(|property| match property.kind {
            Kind::Scalar(kind) => Some((&property.name[..], kind)),
            Kind::List { .. } => None,
        });
        let columns: Vec<_> = scalars.collect();
        Self { kinds: columns.iter().map(|&(_, kind)| kind).collect(), layout: layout(&columns) }
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
