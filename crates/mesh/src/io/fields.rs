//! Data of vertices and faces that a file stores with its mesh.

use std::collections::BTreeMap;

use crate::io::{NumberType, Statements};

/// Named fields and colours with one value per vertex, in vertex order, and those of
/// faces beside them.
///
/// Two values are equal if their fields are; [`types`](Self::types) do not count.
#[derive(Debug, Clone, Default)]
pub struct VertexFields {
    /// Scalar fields by name, in the order of the file.
    pub scalars: Vec<(String, Vec<f64>)>,
    /// Vector fields by name, in the order of the file. Vertex normals are the
    /// field `normal`.
    pub vectors: Vec<(String, Vec<[f64; 3]>)>,
    /// Colours: red, green, blue from 0 to 255.
    pub colors: Option<Vec<[u8; 3]>>,
    /// The types that the numbers of fields have in the file, by the name of the
    /// field. A format that has the type keeps it as long as it holds every value;
    /// without one, [`FloatWidth`](super::FloatWidth) decides.
    pub types: BTreeMap<String, NumberType>,
    /// Fields of faces.
    pub faces: FaceFields,
}

/// Named fields and colours with one value per face, in face order.
///
/// Two values are equal if their fields are; [`types`](Self::types) do not count.
#[derive(Debug, Clone, Default)]
pub struct FaceFields {
    /// Scalar fields by name, in the order of the file.
    pub scalars: Vec<(String, Vec<f64>)>,
    /// Vector fields by name, in the order of the file. Face normals are the field
    /// `normal`.
    pub vectors: Vec<(String, Vec<[f64; 3]>)>,
    /// Colours: red, green, blue from 0 to 255.
    pub colors: Option<Vec<[u8; 3]>>,
    /// The types of numbers, as [`VertexFields::types`].
    pub types: BTreeMap<String, NumberType>,
    /// Texture coordinates of each corner of each face in turn.
    pub texture: Option<Vec<[f64; 2]>>,
    /// Objects, groups and materials of an OBJ file.
    pub statements: Statements,
}

impl PartialEq for VertexFields {
    fn eq(&self, other: &Self) -> bool {
        self.scalars == other.scalars
            && self.vectors == other.vectors
            && self.colors == other.colors
            && self.faces == other.faces
    }
}

impl PartialEq for FaceFields {
    fn eq(&self, other: &Self) -> bool {
        self.scalars == other.scalars
            && self.vectors == other.vectors
            && self.colors == other.colors
            && self.texture == other.texture
            && self.statements == other.statements
    }
}

impl VertexFields {
    /// Returns true if there are neither fields nor colours, of vertices or of faces.
    pub fn is_empty(&self) -> bool {
        self.scalars.is_empty()
            && self.vectors.is_empty()
            && self.colors.is_none()
            && self.faces.is_empty()
    }

    /// The scalar field of this name.
    pub fn scalar(&self, name: &str) -> Option<&[f64]> {
        self.scalars.iter().find(|(n, _)| n == name).map(|(_, values)| &values[..])
    }

    /// The vector field of this name.
    pub fn vector(&self, name: &str) -> Option<&[[f64; 3]]> {
        self.vectors.iter().find(|(n, _)| n == name).map(|(_, values)| &values[..])
    }

    /// Adds a scalar field.
    #[must_use]
    pub fn with_scalar(mut self, name: impl Into<String>, values: Vec<f64>) -> Self {
        self.scalars.push((name.into(), values));
        self
    }

    /// Adds a vector field.
    #[must_use]
    pub fn with_vector(mut self, name: impl Into<String>, values: Vec<[f64; 3]>) -> Self {
        self.vectors.push((name.into(), values));
        self
    }

    /// Sets the colours.
    #[must_use]
    pub fn with_colors(mut self, colors: Vec<[u8; 3]>) -> Self {
        self.colors = Some(colors);
        self
    }

    /// Removes the normals of vertices and faces, which do not fit moved vertices.
    #[must_use]
    pub fn without_normals(mut self) -> Self {
        self.vectors.retain(|(name, _)| name != "normal");
        self.faces.vectors.retain(|(name, _)| name != "normal");
        self
    }

    /// The fields of vertices and faces of a part of the mesh, or of a mesh made from it: vertex
    /// `k` of the result has the values of vertex `vertices[k]`, and faces as in
    /// [`FaceFields::selected`].
    ///
    /// # Panics
    ///
    /// If there is no such vertex, face or corner.
    #[must_use]
    pub fn selected(
        &self,
        vertices: &[u32],
        faces: &[usize],
        corners: impl IntoIterator<Item = usize>,
    ) -> Self {
        fn select<T: Copy>(values: &[T], of: &[u32]) -> Vec<T> {
            of.iter().map(|&v| values[v as usize]).collect()
        }
        Self {
            scalars: self.scalars.iter().map(|(n, v)| (n.clone(), select(v, vertices))).collect(),
            vectors: self.vectors.iter().map(|(n, v)| (n.clone(), select(v, vertices))).collect(),
            colors: self.colors.as_ref().map(|colors| select(colors, vertices)),
            types: self.types.clone(),
            faces: self.faces.selected(faces, corners),
        }
    }
}

impl FaceFields {
    /// Returns true if there are no fields, colours, texture coordinates or statements.
    pub fn is_empty(&self) -> bool {
        self.scalars.is_empty()
            && self.vectors.is_empty()
            && self.colors.is_none()
            && self.texture.is_none()
            && self.statements.is_empty()
    }

    /// Returns true if two faces have the same values, texture coordinates aside.
    pub(crate) fn agree(&self, a: usize, b: usize) -> bool {
        self.scalars.iter().all(|(_, values)| values[a] == values[b])
            && self.vectors.iter().all(|(_, values)| values[a] == values[b])
            && self.colors.iter().all(|colors| colors[a] == colors[b])
            && self.statements.agree(a, b)
    }

    /// The fields of other faces: face `k` of the result has the values of face `of[k]`,
    /// and its corners those of `corners` in turn.
    ///
    /// # Panics
    ///
    /// If there is no such face or corner.
    #[must_use]
    pub fn selected(&self, of: &[usize], corners: impl IntoIterator<Item = usize>) -> Self {
        fn select<T: Copy>(values: &[T], of: &[usize]) -> Vec<T> {
            of.iter().map(|&face| values[face]).collect()
        }
        Self {
            scalars: self.scalars.iter().map(|(n, v)| (n.clone(), select(v, of))).collect(),
            vectors: self.vectors.iter().map(|(n, v)| (n.clone(), select(v, of))).collect(),
            colors: self.colors.as_ref().map(|colors| select(colors, of)),
            types: self.types.clone(),
            texture: self.texture.as_ref().map(|all| corners.into_iter().map(|k| all[k]).collect()),
            statements: self.statements.selected(of),
        }
    }
}

/// Columns of either kind of element.
#[derive(Default)]
pub(crate) struct Columns {
    pub(crate) scalars: Vec<(String, Vec<f64>)>,
    pub(crate) vectors: Vec<(String, Vec<[f64; 3]>)>,
    pub(crate) colors: Option<Vec<[u8; 3]>>,
    pub(crate) types: BTreeMap<String, NumberType>,
}

impl Columns {
    pub(crate) fn of_vertices(self) -> VertexFields {
        let Self { scalars, vectors, colors, types } = self;
        VertexFields { scalars, vectors, colors, types, faces: FaceFields::default() }
    }

    pub(crate) fn of_faces(self) -> FaceFields {
        let Self { scalars, vectors, colors, types } = self;
        FaceFields { scalars, vectors, colors, types, ..FaceFields::default() }
    }
}

/// The fields of either kind of element.
#[derive(Clone, Copy)]
pub(crate) struct Attributes<'a> {
    pub(crate) scalars: &'a [(String, Vec<f64>)],
    pub(crate) vectors: &'a [(String, Vec<[f64; 3]>)],
    pub(crate) colors: Option<&'a [[u8; 3]]>,
    pub(crate) types: &'a BTreeMap<String, NumberType>,
}

impl<'a> From<&'a VertexFields> for Attributes<'a> {
    fn from(fields: &'a VertexFields) -> Self {
        let VertexFields { scalars, vectors, colors, types, .. } = fields;
        Self { scalars, vectors, colors: colors.as_deref(), types }
    }
}

impl<'a> From<&'a FaceFields> for Attributes<'a> {
    fn from(fields: &'a FaceFields) -> Self {
        let FaceFields { scalars, vectors, colors, types, .. } = fields;
        Self { scalars, vectors, colors: colors.as_deref(), types }
    }
}
