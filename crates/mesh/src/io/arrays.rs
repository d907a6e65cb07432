//! Named arrays of numbers as fields, for formats in which names are free.

use std::collections::{BTreeMap, HashMap, HashSet};

use crate::io::NumberType;
use crate::io::fields::Columns;
use crate::io::ply::columns::{COLORS, component_names, vector_name};

/// The most numbers per element of an array that become fields.
pub(crate) const MAX_COMPONENTS: usize = 16;

/// Some numbers per vertex or face, under a name.
#[derive(Debug, Clone, PartialEq)]
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
/// Names that a mesh could not be written with are changed, which the notes tell: all fields of
/// a file can be written to PLY. `taken` are names that they must not have.
pub(crate) fn columns(
    arrays: Vec<NamedArray>,
    colors: Option<Vec<[u8; 3]>>,
    taken: &[&str],
    notes: &mut Vec<String>,
) -> Columns {
    let mut names = Names::new(taken, colors.is_some());
    let (mut scalars, mut vectors, mut types) = (vec![], vec![], BTreeMap::new());
    for NamedArray { name, kind, components, values } in arrays {
        let mut keep = |sound: &str| {
            if let Some(kind) = kind {
                types.insert(sound.to_owned(), kind);
            }
        };
        match components {
            1 => {
                let name = names.scalar(&name, notes);
                keep(&name);
                scalars.push((name, values));
            }
            3 => {
                let name = names.vector(&name, notes);
                keep(&name);
                vectors.push((name, values.as_chunks().0.to_vec()));
            }
            _ => {
                for k in 0..components {
                    let name = names.scalar(&format!("{name}_{k}"), notes);
                    keep(&name);
                    let values = values.iter().skip(k).step_by(components).copied();
                    scalars.push((name, values.collect()));
                }
            }
        }
    }
    Columns { scalars, vectors, colors, types }
}

/// Names under which fields are read back from PLY as they were written.
struct Names {
    /// The names of properties.
    taken: HashSet<String>,
    /// The number to try next, by the beginning of the name.
    next: HashMap<String, usize>,
    /// The last scalars.
    last: Vec<String>,
}

impl Names {
    fn new(taken: &[&str], colors: bool) -> Self {
        let colors = COLORS.iter().filter(|_| colors);
        let taken = taken.iter().chain(colors).map(|&name| name.to_owned()).collect();
        Self { taken, next: HashMap::new(), last: vec![] }
    }

    fn scalar(&mut self, wanted: &str, notes: &mut Vec<String>) -> String {
        let sound = |names: &Self, name: &str| {
            let last = names.last.iter().rev().take(2).rev().map(|name| &name[..]);
            let triple: Vec<&str> = last.chain([name]).collect();
            let is_part = COLORS.contains(&name);
            let completes =
                is_part && COLORS.iter().all(|&color| color == name || names.has(color));
            !names.has(name) && vector_name(&triple).is_none() && !completes
        };
        let name = self.changed(wanted, sound, notes);
        self.taken.insert(name.clone());
        self.last.push(name.clone());
        name
    }

    fn vector(&mut self, wanted: &str, notes: &mut Vec<String>) -> String {
        let sound = |names: &Self, name: &str| {
            component_names(name).iter().all(|component| !names.has(component))
        };
        let name = self.changed(wanted, sound, notes);
        self.taken.extend(component_names(&name));
        name
    }

    fn has(&self, name: &str) -> bool {
        self.taken.contains(name)
    }

    /// The name without white space, with a number if it is not sound.
    fn changed(
        &mut self,
        wanted: &str,
        sound: impl Fn(&Self, &str) -> bool,
        notes: &mut Vec<String>,
    ) -> String {
        let unsound = |c: char| c.is_ascii_whitespace() || c.is_ascii_control();
        let base = wanted.replace(unsound, "_");
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
