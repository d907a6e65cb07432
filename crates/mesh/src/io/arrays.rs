//! Names of fields: free in some formats, those of properties in others.

use std::collections::{BTreeMap, HashMap, HashSet};

use crate::io::fields::{Attributes, Columns};
use crate::io::ply::columns::{COLORS, INDICES, TEXTURE, component_names, vector_name};
use crate::io::{NumberType, VertexFields};

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
pub(crate) fn columns(
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
