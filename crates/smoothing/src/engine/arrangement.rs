//! A vertex order that keeps neighbours close in memory.
//!
//! A smoothing step reads every neighbour of every vertex. Files often scatter neighbours over the
//! whole array (subdivision appends new vertices at the end); sorting along a space-filling curve
//! brings them together and makes a step several times faster. Observed runs keep the input's
//! vertex order, so that positions can be shown without a copy.

use fairing_mesh::{BuildError, TriMesh};
use fairing_watch::parallel;
use rayon::prelude::*;

/// The working copy of a mesh, and its vertex order.
pub(crate) struct Arrangement {
    mesh: TriMesh,
    /// The input vertex at each place; `None` if the input's order is kept.
    order: Option<Vec<u32>>,
}

impl Arrangement {
    /// Keeps the input's order.
    pub(crate) fn as_given(mesh: &TriMesh) -> Self {
        Self { mesh: mesh.clone(), order: None }
    }

    /// Sorts vertices by slabs across the bounding box, and faces by their first vertex in that
    /// order.
    pub(crate) fn in_slabs(mesh: &TriMesh) -> Result<Self, BuildError> {
        let n = mesh.vertex_count();
        let order = slab_order(mesh);
        let mut place = vec![0u32; n];
        for (new, &old) in order.iter().enumerate() {
            place[old as usize] = new as u32;
        }
        let positions = parallel::map(order.len(), 64, |i| {
            let old = order[i];
            mesh.positions()[old as usize]
        });
        let faces = sorted_faces(mesh.faces(), &place);
        Ok(Self { mesh: TriMesh::new(positions, faces)?, order: Some(order) })
    }

    /// The mesh in working order.
    pub(crate) fn mesh(&self) -> &TriMesh {
        &self.mesh
    }

    /// Returns one value per vertex to the input's order.
    pub(crate) fn restore<T: Copy + Default>(&self, values: Vec<T>) -> Vec<T> {
        match &self.order {
            None => values,
            Some(order) => {
                let mut restored = vec![T::default(); values.len()];
                for (&old, value) in order.iter().zip(values) {
                    restored[old as usize] = value;
                }
                restored
            }
        }
    }

    /// Permutes one value per vertex from the input's order to working order.
    pub(crate) fn arrange<T: Copy>(&self, values: &[T]) -> Vec<T> {
        match &self.order {
            None => values.to_vec(),
            Some(order) => order.iter().map(|&old| values[old as usize]).collect(),
        }
    }

    /// The input's number of the vertex at `place`.
    pub(crate) fn original(&self, place: u32) -> u32 {
        self.order.as_ref().map_or(place, |order| order[place as usize])
    }
}

/// The vertices sorted by √n slabs across the longest side of the bounding box, and within a slab
/// along a Morton curve through the other two sides; ties keep the input's order.
///
/// A slab of a surface holds about √n vertices, and neighbours are a slab or two apart, so the
/// bandwidth is a small multiple of √n. Clenshaw's recurrence in `fairing_sparse` relies on this.
fn slab_order(mesh: &TriMesh) -> Vec<u32> {
    let Some([low, high]) = mesh.bounding_box() else { return Vec::new() };
    let side = [0, 1, 2].map(|d| high[d] - low[d]);
    let longest = (0..3).fold(0, |l, d| if side[d] > side[l] { d } else { l });
    let others = [(longest + 1) % 3, (longest + 2) % 3];
    let scale = 1.0 / side[longest].max(f64::MIN_POSITIVE);
    let slabs = (mesh.vertex_count() as f64).sqrt().min(MAX_SLABS);
    let key = |p: &[f64; 3]| {
        let slab = ((p[longest] - low[longest]) * scale * slabs) as u64;
        let [a, b] = others.map(|d| spread(((p[d] - low[d]) * scale * CELLS) as u64));
        slab << 20 | a << 1 | b
    };
    // Slab and cell in the high bits, vertex number in the low bits: no two keys are equal.
    let mut keyed: Vec<u64> = parallel::map(mesh.positions().len(), 64, |v| {
        let p = &mesh.positions()[v];
        key(p) << 32 | v as u64
    });
    keyed.par_sort_unstable();
    keyed.into_par_iter().map(|k| k as u32).collect()
}

/// The largest number of slabs: twelve bits of a key.
const MAX_SLABS: f64 = 4095.0;

/// The cells of the Morton curve along the longest side: ten bits for each direction.
const CELLS: f64 = 1023.0;

/// Spreads ten bits, inserting a zero after each.
fn spread(bits: u64) -> u64 {
    let mut b = bits & 0x3ff;
    b = (b | b << 8) & 0x00ff_00ff;
    b = (b | b << 4) & 0x0f0f_0f0f;
    b = (b | b << 2) & 0x3333_3333;
    (b | b << 1) & 0x5555_5555
}

/// Faces with their new vertex numbers, sorted by the smallest of the three (a counting sort).
fn sorted_faces(faces: &[[u32; 3]], place: &[u32]) -> Vec<[u32; 3]> {
    let moved = |face: &[u32; 3]| face.map(|v| place[v as usize]);
    let first = |face: &[u32; 3]| face[0].min(face[1]).min(face[2]) as usize;
    let mut next = vec![0u32; place.len() + 1];
    for face in faces {
        next[first(&moved(face)) + 1] += 1;
    }
    for v in 0..place.len() {
        next[v + 1] += next[v];
    }
    let mut sorted = vec![[0u32; 3]; faces.len()];
    for face in faces {
        let face = moved(face);
        let slot = &mut next[first(&face)];
        sorted[*slot as usize] = face;
        *slot += 1;
    }
    sorted
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A tetrahedron and an isolated vertex between two of its corners.
    fn sample() -> TriMesh {
        let positions =
            vec![[9.0, 0.0, 0.0], [0.0; 3], [0.0, 9.0, 0.0], [4.0, 0.0, 0.0], [0.0, 0.0, 9.0]];
        TriMesh::new(positions, vec![[0, 1, 2], [0, 4, 1], [1, 4, 2], [0, 2, 4]]).unwrap()
    }

    #[test]
    fn restoring_undoes_arranging() {
        let mesh = sample();
        let arranged = Arrangement::in_slabs(&mesh).unwrap();
        assert_ne!(arranged.mesh(), &mesh);
        assert_eq!(arranged.restore(arranged.mesh().positions().to_vec()), mesh.positions());
        let labels = [10, 11, 12, 13, 14];
        assert_eq!(arranged.restore(arranged.arrange(&labels)), labels);
        for place in 0..5 {
            let old = arranged.original(place) as usize;
            assert_eq!(arranged.mesh().positions()[place as usize], mesh.positions()[old]);
        }
    }

    #[test]
    fn faces_keep_their_geometry_and_orientation() {
        let mesh = sample();
        let arranged = Arrangement::in_slabs(&mesh).unwrap();
        let areas = |m: &TriMesh| {
            let mut a: Vec<String> =
                (0..4).map(|f| format!("{:?}", m.area_vector(f).map(|x| x + 0.0))).collect();
            a.sort();
            a
        };
        assert_eq!(areas(&mesh), areas(arranged.mesh()));
    }

    #[test]
    fn spreading_interleaves_ten_bits() {
        for bits in [0u64, 1, 2, 0b10_1101_0011, 1023] {
            let slow = (0..10).fold(0, |s, k| s | (bits >> k & 1) << (2 * k));
            assert_eq!(spread(bits), slow);
        }
    }
}
