//! The content of PLY files as the crate ply-rs-bw holds it.

use ply_rs::ply::{
    Addable, DefaultElement, ElementDef, Ply, Property, PropertyDef, PropertyType, ScalarType,
};

use crate::build::BuildError;
use crate::polygon::PolygonMesh;
use crate::trimesh::TriMesh;

const AXES: [&str; 3] = ["x", "y", "z"];
const CORNERS: &str = "vertex_indices";

/// Positions as the properties `x`, `y` and `z` of the element `vertex`, faces as the list
/// `vertex_indices` of `face`.
///
/// # Examples
///
/// ```
/// use fairing_mesh::TriMesh;
/// use ply_rs::ply::{DefaultElement, Ply};
///
/// let corners = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
/// let mesh = TriMesh::new(corners, vec![[0, 1, 2]])?;
/// let ply = Ply::<DefaultElement>::from(&mesh);
/// assert_eq!(TriMesh::try_from(&ply)?, mesh);
/// # Ok::<(), fairing_mesh::BuildError>(())
/// ```
impl From<&TriMesh> for Ply<DefaultElement> {
    fn from(mesh: &TriMesh) -> Self {
        let mut ply = Self::new();
        let element = |name: &str, count, properties: Vec<(&str, PropertyType)>| {
            let mut element = ElementDef::new(name.to_owned());
            element.count = count;
            for (name, kind) in properties {
                element.properties.add(PropertyDef::new(name.to_owned(), kind));
            }
            element
        };
        let coordinates = AXES.map(|axis| (axis, PropertyType::Scalar(ScalarType::Double)));
        let corners = PropertyType::List(ScalarType::UChar, ScalarType::UInt);
        let elements = &mut ply.header.elements;
        elements.add(element("vertex", mesh.vertex_count(), coordinates.to_vec()));
        elements.add(element("face", mesh.face_count(), vec![(CORNERS, corners)]));
        let vertex = |position: &[f64; 3]| -> DefaultElement {
            let values = position.map(Property::Double);
            AXES.map(str::to_owned).into_iter().zip(values).collect()
        };
        let vertices = mesh.positions().iter().map(vertex).collect();
        ply.payload.insert("vertex".to_owned(), vertices);
        let face = |face: &[u32; 3]| -> DefaultElement {
            [(CORNERS.to_owned(), Property::ListUInt(face.to_vec()))].into_iter().collect()
        };
        ply.payload.insert("face".to_owned(), mesh.faces().iter().map(face).collect());
        ply
    }
}

/// Positions and faces; polygons are split by [`PolygonMesh::triangulate`]. A coordinate that is
/// missing counts as NaN, and a face without a list of corners has none.
///
/// # Errors
///
/// [`BuildError::NotAnIndex`] for the first face with a negative corner, and those of
/// [`PolygonMesh::new`].
impl TryFrom<&Ply<DefaultElement>> for TriMesh {
    type Error = BuildError;

    fn try_from(ply: &Ply<DefaultElement>) -> Result<Self, BuildError> {
        let elements = |name: &str| ply.payload.get(name).into_iter().flatten();
        let position = |vertex: &DefaultElement| {
            AXES.map(|axis| vertex.get(axis).and_then(number).unwrap_or(f64::NAN))
        };
        let corners = |(face, element): (usize, &DefaultElement)| {
            let list = element.get(CORNERS).or_else(|| element.get("vertex_index"));
            list.map_or(Some(vec![]), indices).ok_or(BuildError::NotAnIndex { face })
        };
        let faces: Result<Vec<Vec<u32>>, BuildError> =
            elements("face").enumerate().map(corners).collect();
        let positions = elements("vertex").map(position).collect();
        Ok(PolygonMesh::new(positions, faces?)?.triangulate())
    }
}

fn number(property: &Property) -> Option<f64> {
    Some(match *property {
        Property::Char(x) => f64::from(x),
        Property::UChar(x) => f64::from(x),
        Property::Short(x) => f64::from(x),
        Property::UShort(x) => f64::from(x),
        Property::Int(x) => f64::from(x),
        Property::UInt(x) => f64::from(x),
        Property::Float(x) => f64::from(x),
        Property::Double(x) => x,
        _ => return None,
    })
}

/// The corners of a face; `None` unless all are indices.
fn indices(property: &Property) -> Option<Vec<u32>> {
    fn all<I: TryInto<u32> + Copy>(list: &[I]) -> Option<Vec<u32>> {
        list.iter().map(|&index| index.try_into().ok()).collect()
    }
    match property {
        Property::ListChar(list) => all(list),
        Property::ListUChar(list) => all(list),
        Property::ListShort(list) => all(list),
        Property::ListUShort(list) => all(list),
        Property::ListInt(list) => all(list),
        Property::ListUInt(list) => all(list),
        _ => None,
    }
}
