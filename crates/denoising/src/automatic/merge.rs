//! Collapses the short edges of surfaces of volumes.
//!
//! Marching cubes puts a vertex where an edge of a grid crosses the surface. Where the surface
//! passes near a node of the grid, up to six vertices are close together. The thin faces between
//! them carry no information about the surface, and their normals are those of the noise.

use std::borrow::Cow;
use std::ops::RangeInclusive;

use fairing_mesh::TriMesh;
use glam::DVec3;

use super::parts::uneven_parts;
use crate::disjoint::root;
use crate::error::DenoiseError;
use crate::masked::Masked;
use crate::noise_level::{NoiseEstimate, NoisyParts, noisy_parts};

/// The length below which an edge is very short, over the mean length of the edges at its ends.
const VERY_SHORT: f64 = 0.2;

/// The share of vertices with a very short edge on the surface of a volume: 0.11 to 0.24 by
/// marching cubes with noise of up to a grid cell, less than 0.06 on other scans and models but
/// tessellations, where it is often more.
const SHARE: RangeInclusive<f64> = 0.08..=0.35;

/// The least number of vertices of such a surface: few have such shares by chance.
const LEAST: usize = 500;

/// The length above which an edge is long, over the same mean, and the largest share of long edges:
/// tessellations of CAD models have very short edges beside long ones.
const LONG: (f64, f64) = (1.9, 0.01);

/// The length below which edges are merged, over the same mean.
const MERGED: f64 = 0.35;

/// The ratio of levels by two-rings below which noise is independent at the nodes of the grid. On
/// the development set it is 1.35 to 1.63 with 0.1 cells or more, and 1.79 or more with filtered
/// noise.
const AT_NODES: f64 = 1.7;

/// The level of such noise over that of the fits. The best of 1, 1.3, 1.6 and 2 on the development
/// set with 0.2 cells or more.
const SHARED: f64 = 2.0;

/// The most neighbours of two vertices that are merged: marching cubes makes fewer, and the time of
/// a merge grows with them.
const HUB: usize = 64;

/// A mesh in which the surfaces of volumes are without their short edges.
pub(super) struct Merged<'a> {
    pub(super) mesh: Cow<'a, TriMesh>,
    /// A flag for each vertex; empty if none is fixed.
    fixed: Vec<bool>,
    /// The merged vertex of each vertex; `None` where nothing is merged.
    of: Option<Vec<u32>>,
    /// True for each connected part that is the surface of a volume.
    pub(super) is_volume: Vec<bool>,
    /// The noise of each connected part before merging, if it is that of a depth camera.
    camera_noise: Vec<Option<NoiseEstimate>>,
}

/// The noise of the surface of a volume.
#[derive(Debug, Clone, Copy)]
pub(super) struct VolumeNoise {
    /// The noise of a depth camera, measured before merging.
    camera_noise: Option<NoiseEstimate>,
}

impl VolumeNoise {
    /// The level of this noise, from that of fits to neighbours. If noise is independent at the
    /// nodes of the grid, vertices around a node share it, and the fits find little more than half
    /// of it. Heavy tails mean that they find shape as well; then the level stays.
    pub(super) fn level(self, mut level: NoiseEstimate) -> NoiseEstimate {
        if level.two_ring_ratio < AT_NODES && !level.is_impulsive() {
            level.sigma *= SHARED;
            level.wide_sigma *= SHARED;
        }
        if let Some(NoiseEstimate { correlation_length, wide_sigma, .. }) = self.camera_noise {
            (level.correlation_length, level.wide_sigma) = (correlation_length, wide_sigma);
        }
        level
    }
}

impl<'a> Merged<'a> {
    /// Merges the ends of short edges, in order of their lengths, where the surface stays the same.
    pub(super) fn new(input: Masked<'a>) -> Result<Self, DenoiseError> {
        let mesh = input.mesh();
        let fixed = |v: usize| input.is_fixed(v);
        let n = mesh.vertex_count();
        let edges = Edges::new(mesh);
        let is_volume = edges.volumes();
        if !is_volume.contains(&true) {
            let fixed = (0..n).map(fixed).collect();
            let camera_noise = vec![None; is_volume.len()];
            return Ok(Self {
                mesh: Cow::Borrowed(mesh),
                fixed,
                of: None,
                is_volume,
                camera_noise,
            });
        }
        let mut clusters = Clusters::new(mesh, edges.local.clone());
        for [a, b] in edges.short(&is_volume) {
            if !fixed(a as usize) && !fixed(b as usize) {
                clusters.merge(a, b);
            }
        }
        let (positions, of) = clusters.numbered();
        let faces = mesh.faces().iter().map(|face| face.map(|v| of[v as usize]));
        let faces = faces.filter(|[a, b, c]| a != b && b != c && c != a).collect();
        let mut flags = vec![false; positions.len()];
        of.iter().enumerate().for_each(|(v, &to)| flags[to as usize] = fixed(v));
        let merged = TriMesh::new(positions, faces)?;
        let (before, after) = (mesh.topology().components(), merged.topology().components());
        let mut new = vec![None; before.count()];
        for (v, &to) in (0..).zip(&of) {
            if let Some(part) = before.label(v) {
                new[part as usize] = after.label(to).map(|part| part as usize);
            }
        }
        let mut is_volume_now = vec![false; after.count()];
        for (new, is_volume) in new.iter().zip(is_volume) {
            new.iter().for_each(|&new| is_volume_now[new] = is_volume);
        }
        // The noise of a camera shows before edges are merged, and hardly ever after that.
        let mut camera_noise = vec![None; after.count()];
        for NoisyParts { components, level } in noisy_parts(input) {
            if level.correlation_length > 0.0 {
                let found = components.iter().filter_map(|&part| new[part as usize]);
                found.for_each(|part| camera_noise[part] = Some(level));
            }
        }
        let (mesh, of) = (Cow::Owned(merged), Some(of));
        Ok(Self { mesh, fixed: flags, of, is_volume: is_volume_now, camera_noise })
    }

    /// The mesh with its fixed vertices.
    pub(super) fn masked(&self) -> Result<Masked<'_>, DenoiseError> {
        Ok(Masked::new(&self.mesh, &self.fixed)?)
    }

    /// The noise of these parts, if one of them is the surface of a volume.
    pub(super) fn volume_noise(&self, components: &[u32]) -> Option<VolumeNoise> {
        let mut parts = components.iter().map(|&part| part as usize);
        parts.clone().any(|part| self.is_volume[part]).then(|| {
            let camera_noise = parts.find_map(|part| self.camera_noise[part]);
            VolumeNoise { camera_noise }
        })
    }

    /// The level of the noise of these parts; of the surface of a volume among them, its own.
    pub(super) fn level(&self, group: &NoisyParts) -> NoiseEstimate {
        self.volume_noise(&group.components).map_or(group.level, |noise| noise.level(group.level))
    }

    /// The parts whose faces are too uneven; never surfaces of volumes, which have no long faces.
    pub(super) fn uneven(&self, groups: &[NoisyParts]) -> Vec<bool> {
        let uneven = uneven_parts(&self.mesh, groups).into_iter();
        uneven.zip(&self.is_volume).map(|(is_uneven, is_volume)| is_uneven && !is_volume).collect()
    }

    /// The part of a vertex.
    pub(super) fn part(&self, v: u32) -> Option<u32> {
        self.mesh.topology().components().label(self.vertex(v))
    }

    /// The merged vertex of a vertex.
    fn vertex(&self, v: u32) -> u32 {
        self.of.as_ref().map_or(v, |of| of[v as usize])
    }

    /// The positions of all vertices, from those of the merged ones. Vertices that were merged keep
    /// their offsets from the middle along the new surface; where the middle has not moved, a
    /// vertex is where it was at the `start`.
    pub(super) fn spread(
        &self,
        start: &[[f64; 3]],
        moved: Vec<[f64; 3]>,
    ) -> Result<Vec<[f64; 3]>, DenoiseError> {
        let moved = self.mesh.with_positions(moved)?;
        let mut normals = vec![DVec3::ZERO; moved.vertex_count()];
        let mut members = vec![0u32; moved.vertex_count()];
        if self.of.is_some() {
            for (f, face) in moved.faces().iter().enumerate() {
                let area = DVec3::from(moved.area_vector(f));
                face.iter().for_each(|&v| normals[v as usize] += area);
            }
        }
        (0..start.len() as u32).for_each(|v| members[self.vertex(v) as usize] += 1);
        let place = |(v, &from): (u32, &[f64; 3])| {
            let to = self.vertex(v) as usize;
            let (middle, target) = (self.mesh.positions()[to], moved.positions()[to]);
            if middle == target {
                return from;
            }
            if members[to] == 1 {
                return target;
            }
            let offset = DVec3::from(from) - DVec3::from(middle);
            (DVec3::from(target) + offset.reject_from(normals[to].normalize_or(DVec3::Z))).into()
        };
        Ok((0..).zip(start).map(place).collect())
    }
}

/// The surface of a volume without its short edges; `None` for another mesh.
///
/// # Errors
///
/// [`DenoiseError::Build`] where numbers leave the range of floats.
pub fn without_short_edges(mesh: &TriMesh) -> Result<Option<TriMesh>, DenoiseError> {
    let merged = Merged::new(mesh.into())?;
    Ok(merged.of.is_some().then(|| merged.mesh.into_owned()))
}

/// The edges of a mesh and their lengths.
struct Edges<'a> {
    mesh: &'a TriMesh,
    lengths: Vec<f64>,
    /// The mean length of the edges at each vertex.
    local: Vec<f64>,
}

impl<'a> Edges<'a> {
    fn new(mesh: &'a TriMesh) -> Self {
        let lengths = mesh.edge_lengths();
        let mut sums = vec![(0.0, 0u32); mesh.vertex_count()];
        for (edge, length) in mesh.topology().edges().iter().zip(&lengths) {
            for &v in edge {
                let (sum, count) = &mut sums[v as usize];
                *sum += length;
                *count += 1;
            }
        }
        let local = sums.into_iter().map(|(sum, count)| sum / f64::from(count.max(1))).collect();
        Self { mesh, lengths, local }
    }

    /// The ends of each edge, and its length over the mean of those at its ends.
    fn ratios(&self) -> impl Iterator<Item = ([u32; 2], f64)> {
        self.mesh.topology().edges().iter().zip(&self.lengths).map(|(&[a, b], length)| {
            let mean = 0.5 * (self.local[a as usize] + self.local[b as usize]);
            ([a, b], if mean > 0.0 { length / mean } else { 1.0 })
        })
    }

    /// Returns `true` for each connected part that is the surface of a volume.
    fn volumes(&self) -> Vec<bool> {
        let parts = self.mesh.topology().components();
        let mut near = vec![false; self.mesh.vertex_count()];
        let mut counts = vec![[0usize; 4]; parts.count()];
        for ([a, b], ratio) in self.ratios() {
            if ratio < VERY_SHORT {
                [a, b].iter().for_each(|&v| near[v as usize] = true);
            }
            if let Some(part) = parts.label(a) {
                let [edges, long, ..] = &mut counts[part as usize];
                *edges += 1;
                *long += usize::from(ratio > LONG.0);
            }
        }
        for (v, near) in (0..).zip(near) {
            if let Some(part) = parts.label(v) {
                let [.., vertices, short] = &mut counts[part as usize];
                *vertices += 1;
                *short += usize::from(near);
            }
        }
        let share = |part: usize, of: usize| part as f64 / of.max(1) as f64;
        let is_volume = |[edges, long, vertices, short]: [usize; 4]| {
            let are_few = share(long, edges) <= LONG.1;
            vertices >= LEAST && are_few && SHARE.contains(&share(short, vertices))
        };
        counts.into_iter().map(is_volume).collect()
    }

    /// The short edges of these parts, from the shortest to the longest.
    fn short(&self, is_volume: &[bool]) -> Vec<[u32; 2]> {
        let parts = self.mesh.topology().components();
        let is_in = |v: u32| parts.label(v).is_some_and(|part| is_volume[part as usize]);
        let mut all: Vec<([u32; 2], f64)> =
            self.ratios().filter(|&([a, _], ratio)| ratio < MERGED && is_in(a)).collect();
        all.sort_by(|a, b| a.1.total_cmp(&b.1));
        all.into_iter().map(|(edge, _)| edge).collect()
    }
}

/// Sets of vertices that are merged.
struct Clusters {
    /// A parent of each vertex in its cluster, itself for the representative.
    parents: Vec<u32>,
    /// The mean of the positions, the number of members, and the mean length of the edges around,
    /// for each representative.
    middles: Vec<(DVec3, f64, f64)>,
    neighbors: Vec<Vec<u32>>,
    on_border: Vec<bool>,
}

impl Clusters {
    fn new(mesh: &TriMesh, local: Vec<f64>) -> Self {
        let topology = mesh.topology();
        let all = 0..mesh.vertex_count() as u32;
        let middles = mesh.positions().iter().zip(local).map(|(&p, l)| (p.into(), 1.0, l));
        Self {
            parents: all.clone().collect(),
            middles: middles.collect(),
            neighbors: all.map(|v| topology.neighbors(v).to_vec()).collect(),
            on_border: topology.boundary_vertices().to_vec(),
        }
    }

    /// Merges the clusters of two vertices, unless their middles are too far from each other, or
    /// the surface would touch itself: the clusters have the same neighbours only in the faces at
    /// the edge between them.
    fn merge(&mut self, a: u32, b: u32) {
        let [a, b] = [a, b].map(|v| root(&mut self.parents, v) as usize);
        if a == b || self.neighbors[a].len() + self.neighbors[b].len() > HUB {
            return;
        }
        let ((p, count, length), (q, others, further)) = (self.middles[a], self.middles[b]);
        if p.distance(q) >= MERGED * 0.5 * (length + further) {
            return;
        }
        let common = self.neighbors[a].iter().filter(|v| self.neighbors[b].contains(v)).count();
        if common > if self.on_border[a] && self.on_border[b] { 1 } else { 2 } {
            return;
        }
        let all = count + others;
        let mean = |x: f64, y: f64| (count * x + others * y) / all;
        self.middles[a] = ((count * p + others * q) / all, all, mean(length, further));
        self.on_border[a] |= self.on_border[b];
        self.parents[b] = a as u32;
        for v in std::mem::take(&mut self.neighbors[b]) {
            let around = &mut self.neighbors[v as usize];
            around.retain(|&w| w != b as u32);
            if v != a as u32 {
                if !around.contains(&(a as u32)) {
                    around.push(a as u32);
                }
                if !self.neighbors[a].contains(&v) {
                    self.neighbors[a].push(v);
                }
            }
        }
    }

    /// The middles in the order of their first vertices, and the middle of each vertex.
    fn numbered(mut self) -> (Vec<[f64; 3]>, Vec<u32>) {
        let mut numbers = vec![u32::MAX; self.parents.len()];
        let (mut positions, mut of) = (vec![], vec![]);
        for v in 0..self.parents.len() as u32 {
            let root = root(&mut self.parents, v) as usize;
            if numbers[root] == u32::MAX {
                numbers[root] = positions.len() as u32;
                positions.push(self.middles[root].0.into());
            }
            of.push(numbers[root]);
        }
        (positions, of)
    }
}

#[cfg(test)]
mod tests {
    use fairing_shapes as shapes;

    use super::*;

    /// A plane in which one vertex in six is near to its neighbour.
    fn crowded() -> TriMesh {
        let plane = shapes::plane(30, 30, shapes::Diagonals::Alternating);
        let step = 1.0 / 30.0;
        let moved = plane.positions().iter().map(|&[x, y, z]| {
            let [i, j] = [x, y].map(|t| (t / step).round() as u32);
            let is_inside = (1..28).contains(&i) && (1..30).contains(&j);
            [if is_inside && i % 2 == 0 && j % 3 == 0 { x + 0.9 * step } else { x }, y, z]
        });
        plane.with_positions(moved.collect()).unwrap()
    }

    #[test]
    fn short_edges_are_merged_and_all_vertices_return() {
        let mesh = crowded();
        let merged = Merged::new((&mesh).into()).unwrap();
        assert_eq!(merged.is_volume, [true]);
        let pairs = 13 * 9;
        assert_eq!(merged.mesh.vertex_count(), mesh.vertex_count() - pairs);
        assert_eq!(merged.mesh.face_count(), mesh.face_count() - 2 * pairs);
        assert!(merged.mesh.topology().is_manifold());
        assert_eq!(merged.mesh.topology().boundary_loops().len(), 1);
        // Nothing moved, nothing changed.
        let start = mesh.positions();
        assert_eq!(merged.spread(start, merged.mesh.positions().to_vec()).unwrap(), start);
        // A plane that is turned as a whole stays one, and near vertices keep their distance.
        let turned = |&[x, y, z]: &[f64; 3]| [0.6 * x - 0.8 * z, y, 0.8 * x + 0.6 * z];
        let target = merged.mesh.positions().iter().map(turned).collect();
        let found = merged.spread(start, target).unwrap();
        for (p, q) in found.iter().zip(start.iter().map(turned)) {
            assert!((0.8 * p[0] - 0.6 * p[2]).abs() < 1e-12, "{p:?}");
            assert!(DVec3::from(*p).distance(q.into()) < 0.03, "{p:?} {q:?}");
        }
    }

    #[test]
    fn fixed_vertices_and_other_surfaces_stay() {
        let mesh = crowded();
        let fixed = vec![true; mesh.vertex_count()];
        let merged = Merged::new(Masked::new(&mesh, &fixed).unwrap()).unwrap();
        assert_eq!(*merged.mesh, mesh);
        let tube = shapes::cylinder(1.0, 2.0, 200, 1, shapes::Ends::Open);
        for mesh in [tube, shapes::icosphere(3), shapes::cad_block(0.2), shapes::creature(24)] {
            let noisy = shapes::jittered(&mesh, 0.3, 2, |p| p);
            for mesh in [mesh, noisy] {
                let merged = Merged::new((&mesh).into()).unwrap();
                let vertices = mesh.vertex_count();
                assert!(matches!(merged.mesh, Cow::Borrowed(_)), "{vertices} vertices");
            }
        }
    }

    /// A ring of three vertices around a tube is not closed: its cross-section is no face.
    #[test]
    fn a_thin_tube_stays_open() {
        let tube = shapes::cylinder(0.1, 6.0, 3, 20, shapes::Ends::Open);
        let edges = Edges::new(&tube);
        let mut clusters = Clusters::new(&tube, edges.local.clone());
        for [a, b] in edges.short(&[true]) {
            clusters.merge(a, b);
        }
        assert_eq!(clusters.numbered().0.len(), tube.vertex_count());
    }

    /// The ends of an edge of a fan are merged, but not in a fan of a hundred faces.
    #[test]
    fn hubs_stay() {
        for (faces, left) in [(20, 20), (100, 101)] {
            let around = (0..faces).map(|k| {
                let (y, x) = libm::sincos(std::f64::consts::TAU * f64::from(k) / f64::from(faces));
                [x, y, 0.0]
            });
            let positions = std::iter::once([0.9, 0.0, 0.0]).chain(around).collect();
            let fan = (0..faces).map(|k| [0, 1 + k, 1 + (k + 1) % faces]).collect();
            let mesh = TriMesh::new(positions, fan).unwrap();
            let mut clusters = Clusters::new(&mesh, vec![1.0; mesh.vertex_count()]);
            clusters.merge(0, 1);
            assert_eq!(clusters.numbered().0.len(), left);
        }
    }
}
