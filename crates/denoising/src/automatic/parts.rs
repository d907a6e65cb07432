//! Connected parts: some of them as a mesh of its own, numbered so that neighbours are near in
//! memory, and parts whose faces are too uneven to be denoised.

use fairing_mesh::{TriMesh, hilbert};
use glam::DVec3;
use rayon::prelude::*;

use crate::error::DenoiseError;
use crate::faces::longest_side;
use crate::masked::Masked;
use crate::noise_level::NoisyParts;

/// A mesh of some of the parts, with vertices in the order of a Hilbert curve, and faces in that of
/// their first vertex.
///
/// Every step reads the faces around each face. In the order of a file these may be anywhere, and
/// a step then waits for memory.
pub(super) struct Part {
    pub(super) mesh: TriMesh,
    /// The vertex of the whole mesh that each vertex is.
    vertices: Vec<u32>,
    /// A flag for each vertex.
    fixed: Vec<bool>,
}

impl Part {
    /// The parts of these numbers, ascending.
    pub(super) fn new(input: Masked<'_>, components: &[u32]) -> Result<Self, DenoiseError> {
        let whole = input.mesh();
        let parts = whole.topology().components();
        let is_in =
            |v: &u32| parts.label(*v).is_some_and(|part| components.binary_search(&part).is_ok());
        let mut vertices: Vec<u32> = (0..whole.vertex_count() as u32).filter(is_in).collect();
        let at = |v: u32| DVec3::from(whole.positions()[v as usize]);
        let low = vertices.iter().fold(DVec3::INFINITY, |low, &v| low.min(at(v)));
        let high = vertices.iter().fold(DVec3::NEG_INFINITY, |high, &v| high.max(at(v)));
        let middle = 0.5 * low + 0.5 * high;
        let scale = 1.0 / (high - middle).max_element().max(f64::MIN_POSITIVE);
        vertices
            .par_sort_by_cached_key(|&v| (hilbert(((at(v) - middle) * scale).as_vec3().into()), v));
        let mut number = vec![u32::MAX; whole.vertex_count()];
        for (new, &v) in (0..).zip(&vertices) {
            number[v as usize] = new;
        }
        let taken = whole.faces().iter().map(|face| face.map(|v| number[v as usize]));
        let mut faces: Vec<[u32; 3]> = taken.filter(|face| face[0] != u32::MAX).collect();
        faces.par_sort_by_key(|face| face.iter().min().copied());
        let positions = vertices.iter().map(|&v| whole.positions()[v as usize]).collect();
        let fixed = vertices.iter().map(|&v| input.is_fixed(v as usize)).collect();
        Ok(Self { mesh: TriMesh::new(positions, faces)?, fixed, vertices })
    }

    /// The mesh with its fixed vertices.
    pub(super) fn masked(&self) -> Result<Masked<'_>, DenoiseError> {
        Ok(Masked::new(&self.mesh, &self.fixed)?)
    }

    /// Writes the positions of these vertices where they belong.
    pub(super) fn put_back(&self, from: &[[f64; 3]], into: &mut [[f64; 3]]) {
        for (&v, &p) in self.vertices.iter().zip(from) {
            into[v as usize] = p;
        }
    }
}

/// The length of a face over the displacement of its far end: the normals of a denoised mesh are
/// off by some 3°, or one part in 20.
const LEVER: f64 = 20.0;

/// The least fraction of uneven vertices in an uneven part.
const FRACTION: f64 = 0.1;

/// Returns `true` for each connected part whose faces are so long that errors of their normals
/// would do more harm than the noise.
///
/// A vertex is uneven if a twentieth of the longest side of its faces is more than their least
/// height, so that faces fold, and more than the noise, so that positions get worse. A part is
/// uneven if more than one vertex in ten is: CAD tessellations, with faces across a whole plane
/// beside small or thin ones.
pub(super) fn uneven_parts(mesh: &TriMesh, groups: &[NoisyParts]) -> Vec<bool> {
    let mut longest = vec![0.0f64; mesh.vertex_count()];
    let mut lowest = vec![f64::INFINITY; mesh.vertex_count()];
    for (f, &face) in mesh.faces().iter().enumerate() {
        let side = longest_side(mesh, f);
        let height = if side > 0.0 { 2.0 * mesh.face_area(f) / side } else { 0.0 };
        for v in face.map(|v| v as usize) {
            longest[v] = longest[v].max(side);
            lowest[v] = lowest[v].min(height);
        }
    }
    let parts = mesh.topology().components();
    let mut noise = vec![0.0; parts.count()];
    for group in groups {
        group.components.iter().for_each(|&part| noise[part as usize] = group.level.wide_sigma);
    }
    let mut counts = vec![[0usize; 2]; parts.count()];
    for (v, (side, low)) in longest.into_iter().zip(lowest).enumerate() {
        if let Some(part) = parts.label(v as u32) {
            let [all, uneven] = &mut counts[part as usize];
            *all += 1;
            *uneven += usize::from(side > LEVER * low.max(noise[part as usize]));
        }
    }
    counts.into_iter().map(|[all, uneven]| uneven as f64 > FRACTION * all as f64).collect()
}

#[cfg(test)]
mod tests {
    use fairing_shapes as shapes;

    use super::*;
    use crate::noise_level::noisy_parts;

    #[test]
    fn parts_are_taken_out_and_put_back() {
        let positions: Vec<[f64; 3]> =
            (0..11).map(|i| [f64::from(i), f64::from(i * i), 0.0]).collect();
        // Three parts whose vertices alternate; vertex 9 is isolated.
        let faces = vec![[0, 3, 6], [1, 4, 7], [2, 5, 8], [10, 3, 0]];
        let whole = TriMesh::new(positions.clone(), faces).unwrap();
        let part = Part::new((&whole).into(), &[0, 2]).unwrap();
        let faces: Vec<_> = (part.mesh.faces().iter())
            .map(|face| face.map(|v| part.vertices[v as usize]))
            .collect();
        assert_eq!((faces.len(), part.vertices.len()), (3, 7));
        assert!([[0, 3, 6], [2, 5, 8], [10, 3, 0]].iter().all(|face| faces.contains(face)));
        let moved: Vec<_> = part.mesh.positions().iter().map(|p| [p[0], p[1], 1.0]).collect();
        let mut found = positions;
        part.put_back(&moved, &mut found);
        let raised: Vec<usize> = (0..11).filter(|&v| found[v][2] == 1.0).collect();
        assert_eq!(raised, [0, 2, 3, 5, 6, 8, 10]);
        assert_eq!(found[10][..2], [10.0, 100.0]);
    }

    /// Random numbers become near ones, and each vertex goes back to its place.
    #[test]
    fn neighbours_are_near_in_memory() {
        // The median distance between the numbers of two corners.
        let distance = |mesh: &TriMesh| {
            let mut all: Vec<u32> = mesh.faces().iter().map(|f| f[0].abs_diff(f[1])).collect();
            let middle = all.len() / 2;
            *all.select_nth_unstable(middle).1
        };
        let mesh = shapes::torus(1.0, 0.4, 300, 150);
        let n = mesh.vertex_count() as u32;
        // Factors without common divisors permute.
        let to = |v: u32| (u64::from(v) * 23_456_789 % u64::from(n)) as u32;
        let mut positions = vec![[0.0; 3]; n as usize];
        for (v, &p) in (0..).zip(mesh.positions()) {
            positions[to(v) as usize] = p;
        }
        let faces = (0..mesh.face_count())
            .map(|f| mesh.faces()[f * 34_567 % mesh.face_count()].map(to))
            .collect();
        let whole = TriMesh::new(positions.clone(), faces).unwrap();
        assert!(distance(&whole) > 5000);
        let fixed: Vec<bool> = (0..n).map(|v| v % 3 == 0).collect();
        let part = Part::new(Masked::new(&whole, &fixed).unwrap(), &[0]).unwrap();
        assert!(distance(&part.mesh) < 20);
        assert!(part.vertices.iter().zip(&part.fixed).all(|(v, fixed)| *fixed == (v % 3 == 0)));
        assert_eq!(part.mesh.face_count(), whole.face_count());
        let corner = |mesh: &TriMesh, v: u32| mesh.positions()[v as usize].map(f64::to_bits);
        let sorted = |mesh: &TriMesh| {
            let mut faces: Vec<_> =
                mesh.faces().iter().map(|face| face.map(|v| corner(mesh, v))).collect();
            faces.sort_unstable();
            faces
        };
        assert_eq!(sorted(&part.mesh), sorted(&whole));
        let mut found = vec![[0.0; 3]; n as usize];
        part.put_back(part.mesh.positions(), &mut found);
        assert_eq!(found, positions);
    }

    /// A tube around the z axis whose sides go from end to end.
    fn tessellated_tube(sides: u32) -> TriMesh {
        let tube = shapes::cylinder(1.0, 2.0, sides, 1, shapes::Ends::Open);
        shapes::jittered(&tube, 0.05, 3, |p| p)
    }

    #[test]
    fn tessellations_are_uneven_and_noisy_scans_are_not() {
        let uneven = |mesh: &TriMesh| uneven_parts(mesh, &noisy_parts(mesh));
        assert_eq!(uneven(&tessellated_tube(200)), [true]);
        for mesh in [shapes::icosphere(3), shapes::cad_block(0.2), shapes::creature(24)] {
            assert_eq!(uneven(&shapes::jittered(&mesh, 0.3, 2, |p| p)), [false]);
        }
    }

    #[test]
    fn a_tessellation_stays_as_it_is_beside_a_denoised_part() {
        let (tube, sphere) = (tessellated_tube(200), shapes::icosphere(3));
        let sphere = shapes::jittered(&sphere, 0.2, 4, |p| p);
        let alone = crate::automatic(&tube, &crate::AutomaticOptions::default()).unwrap();
        assert_eq!(alone.mesh, tube);
        assert_eq!(alone.kind, crate::SurfaceKind::Uneven);
        assert_eq!(alone.uneven_vertices, tube.vertex_count());

        let n = tube.vertex_count();
        let far = sphere.positions().iter().map(|p| [p[0] + 9.0, p[1], p[2]]);
        let positions: Vec<[f64; 3]> = tube.positions().iter().copied().chain(far).collect();
        let others = sphere.faces().iter().map(|face| face.map(|v| v + n as u32));
        let faces = tube.faces().iter().copied().chain(others).collect();
        let both = TriMesh::new(positions, faces).unwrap();
        let found = crate::automatic(&both, &crate::AutomaticOptions::default()).unwrap();
        assert_eq!(found.uneven_vertices, n);
        assert_eq!(found.mesh.positions()[..n], tube.positions()[..]);
        let moved = (n..both.vertex_count())
            .filter(|&v| found.mesh.positions()[v] != both.positions()[v])
            .count();
        assert!(moved > sphere.vertex_count() / 2, "{moved}");
    }
}
