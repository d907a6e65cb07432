//! Vertex data stored with a mesh in its file.

/// Named fields and colours with one value per vertex, in vertex order.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct VertexFields {
    /// Scalar fields by name, in the order of the file.
    pub scalars: Vec<(String, Vec<f64>)>,
    /// Vector fields by name, in the order of the file. Vertex normals are the
    /// field `normal`.
    pub vectors: Vec<(String, Vec<[f64; 3]>)>,
    /// Colours: red, green, blue from 0 to 255.
    pub colors: Option<Vec<[u8; 3]>>,
}

impl VertexFields {
    /// Returns true if there are neither fields nor colours.
    pub fn is_empty(&self) -> bool {
        self.scalars.is_empty() && self.vectors.is_empty() && self.colors.is_none()
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

    /// The values at some vertices, in their order, such as those of a part of the mesh.
    ///
    /// # Panics
    ///
    /// If there is no such vertex.
    #[must_use]
    pub fn at_vertices(&self, vertices: &[u32]) -> Self {
        fn at<T: Copy>(values: &[T], vertices: &[u32]) -> Vec<T> {
            vertices.iter().map(|&v| values[v as usize]).collect()
        }
        let scalars =
            self.scalars.iter().map(|(name, values)| (name.clone(), at(values, vertices)));
        let vectors =
            self.vectors.iter().map(|(name, values)| (name.clone(), at(values, vertices)));
        Self {
            scalars: scalars.collect(),
            vectors: vectors.collect(),
            colors: self.colors.as_ref().map(|colors| at(colors, vertices)),
        }
    }
}
