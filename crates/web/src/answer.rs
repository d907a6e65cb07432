//! Answers to requests.

use std::sync::Arc;

use fairing_mesh::TriMesh;
use serde_json::{Map, Value};

/// The answer to a request.
#[derive(Debug, Clone)]
pub struct Answer {
    /// The object that describes the result.
    pub value: Value,
    /// Arrays by name.
    pub arrays: Vec<(&'static str, Array)>,
}

/// An array of an answer.
#[derive(Debug, Clone)]
pub enum Array {
    /// Numbers, one row after the other.
    Numbers(Vec<f64>),
    /// Bytes of a file.
    Bytes(Vec<u8>),
    /// The positions of a mesh, three numbers for each vertex.
    Positions(Arc<TriMesh>),
    /// The faces of a mesh, three vertices for each.
    Faces(Arc<TriMesh>),
}

impl Array {
    /// The type of the elements: `f64`, `u32` or `u8`.
    pub fn kind(&self) -> &'static str {
        match self {
            Self::Numbers(_) | Self::Positions(_) => "f64",
            Self::Faces(_) => "u32",
            Self::Bytes(_) => "u8",
        }
    }

    /// The number of elements.
    pub fn len(&self) -> usize {
        match self {
            Self::Numbers(numbers) => numbers.len(),
            Self::Bytes(bytes) => bytes.len(),
            Self::Positions(mesh) => 3 * mesh.vertex_count(),
            Self::Faces(mesh) => 3 * mesh.face_count(),
        }
    }

    /// Returns true if there are no elements.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The address of the first element, as long as this array exists.
    pub fn address(&self) -> usize {
        match self {
            Self::Numbers(numbers) => numbers.as_ptr().addr(),
            Self::Bytes(bytes) => bytes.as_ptr().addr(),
            Self::Positions(mesh) => mesh.positions().as_ptr().addr(),
            Self::Faces(mesh) => mesh.faces().as_ptr().addr(),
        }
    }

    /// The elements as bytes, the lowest first.
    pub fn to_bytes(&self) -> Vec<u8> {
        let of_numbers = |numbers: &[f64]| numbers.iter().flat_map(|x| x.to_le_bytes()).collect();
        match self {
            Self::Numbers(numbers) => of_numbers(numbers),
            Self::Bytes(bytes) => bytes.clone(),
            Self::Positions(mesh) => of_numbers(mesh.positions().as_flattened()),
            Self::Faces(mesh) => {
                mesh.faces().as_flattened().iter().flat_map(|v| v.to_le_bytes()).collect()
            }
        }
    }
}

impl From<Value> for Answer {
    fn from(value: Value) -> Self {
        Self { value, arrays: vec![] }
    }
}

impl Answer {
    /// An answer whose object has one entry.
    pub(crate) fn entry(name: &str, value: impl Into<Value>) -> Self {
        Value::Object(Map::from_iter([(name.to_owned(), value.into())])).into()
    }

    /// The answer with another array.
    pub(crate) fn with(mut self, name: &'static str, array: Array) -> Self {
        self.arrays.push((name, array));
        self
    }
}
