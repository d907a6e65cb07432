//! Surfaces of noisy volumes, by marching cubes: what scanners that fuse depth images, and
//! tomographs, deliver.

use anyhow::{Context as _, Result};
use fairing_evaluation::{SurfaceTree, inside};
use fairing_mesh::TriMesh;
use glam::DVec3;
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;

/// The width of the band around the surface in which distances are known, in grid cells.
const BAND: f64 = 2.5;

/// The number of faces that marching cubes makes, times the square of the width of a cell, over the
/// area.
const DENSITY: f64 = 3.0;

/// The largest number of nodes of a grid.
const MAX_NODES: usize = 20_000_000;

/// Noise of the distances at the nodes of a grid.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Grain {
    /// The standard deviation, in grid cells.
    pub level: f64,
    /// The standard deviation of the Gaussian that averages independent noise, in grid cells; 0 for
    /// independent noise.
    pub length: f64,
}

/// The surface of a closed model in a grid, in a random position, with about this many faces. The
/// noise is added to the signed distances at the nodes; of the surface the largest part is taken.
/// Ambiguous faces of the grid keep the nodes inside apart.
pub fn volume_surface(
    model: &TriMesh,
    faces: usize,
    grains: &[Grain],
    seed: u64,
) -> Result<TriMesh> {
    let mut random = ChaCha8Rng::seed_from_u64(seed ^ 0x00d0_5000);
    let turned = model.with_positions(turned(model, &mut random))?;
    let cell = (DENSITY * model.area() / faces as f64).sqrt();
    let grid = Grid::around(&turned, cell, &mut random)?;
    let mut values = grid.distances(&turned)?;
    for grain in grains {
        let noise = grid.noise(grain.length, &mut random);
        for (value, x) in values.iter_mut().zip(noise) {
            *value += grain.level * cell * x;
        }
    }
    let surface = largest(&grid.surface(&values)?)?;
    // Back to where the model is.
    let back = axes(&mut ChaCha8Rng::seed_from_u64(seed ^ 0x00d0_5000));
    let positions = surface.positions().iter().map(|&p| {
        let p = DVec3::from(p);
        (back[0] * p.x + back[1] * p.y + back[2] * p.z).to_array()
    });
    Ok(surface.with_positions(positions.collect())?)
}

/// Orthogonal axes in random directions.
fn axes(random: &mut ChaCha8Rng) -> [DVec3; 3] {
    let mut vector = || DVec3::from(std::array::from_fn(|_| normal(random)));
    let x = vector().normalize_or(DVec3::X);
    let y = vector().reject_from(x).normalize_or(x.any_orthonormal_vector());
    [x, y, x.cross(y)]
}

/// The coordinates of the vertices along random axes.
fn turned(model: &TriMesh, random: &mut ChaCha8Rng) -> Vec<[f64; 3]> {
    let axes = axes(random);
    let along = |&p: &[f64; 3]| axes.map(|axis| axis.dot(p.into()));
    model.positions().iter().map(along).collect()
}

/// A number of the standard normal distribution.
fn normal(random: &mut ChaCha8Rng) -> f64 {
    let u: f64 = 1.0 - random.random::<f64>();
    (-2.0 * libm::log(u)).sqrt() * libm::cos(std::f64::consts::TAU * random.random::<f64>())
}

/// The part of the surface with the most faces.
fn largest(mesh: &TriMesh) -> Result<TriMesh> {
    let parts = mesh.topology().components();
    let label = |face: &[u32; 3]| parts.label(face[0]);
    let mut counts = vec![0usize; parts.count()];
    mesh.faces().iter().filter_map(label).for_each(|part| counts[part as usize] += 1);
    let most = (0..).zip(&counts).max_by_key(|(_, count)| **count).map(|(part, _)| part);
    let mut numbers = vec![u32::MAX; mesh.vertex_count()];
    let mut positions = vec![];
    for (v, number) in
        numbers.iter_mut().enumerate().filter(|(v, _)| parts.label(*v as u32) == most)
    {
        *number = positions.len() as u32;
        positions.push(mesh.positions()[v]);
    }
    let faces = mesh.faces().iter().filter(|face| label(face) == most);
    Ok(TriMesh::new(positions, faces.map(|f| f.map(|v| numbers[v as usize])).collect())?)
}

/// The nodes of a grid, x first.
struct Grid {
    origin: DVec3,
    cell: f64,
    sides: [usize; 3],
}

impl Grid {
    /// A grid around a mesh, somewhere within a cell.
    fn around(mesh: &TriMesh, cell: f64, random: &mut ChaCha8Rng) -> Result<Self> {
        let [low, high] = mesh.bounding_box().context("no vertices")?.map(DVec3::from);
        let margin = DVec3::splat((BAND + 1.5) * cell);
        let shift = DVec3::from(std::array::from_fn(|_| random.random::<f64>())) * cell;
        let origin = low - margin - shift;
        let sides = ((high + margin - origin) / cell).to_array().map(|n| n.ceil() as usize + 1);
        let nodes = sides.iter().try_fold(1usize, |all, &n| all.checked_mul(n));
        nodes.filter(|&n| n <= MAX_NODES).context("too many cells for this model")?;
        Ok(Self { origin, cell, sides })
    }

    fn node(&self, [i, j, k]: [usize; 3]) -> usize {
        (k * self.sides[1] + j) * self.sides[0] + i
    }

    fn count(&self) -> usize {
        self.sides.iter().product()
    }

    fn point(&self, steps: [usize; 3]) -> DVec3 {
        self.origin + self.cell * DVec3::from(steps.map(|n| n as f64))
    }

    /// The steps of all nodes, in order.
    fn nodes(&self) -> impl Iterator<Item = [usize; 3]> {
        let [a, b, c] = self.sides;
        (0..c).flat_map(move |k| (0..b).flat_map(move |j| (0..a).map(move |i| [i, j, k])))
    }

    /// The signed distance from a closed surface at the nodes of a band, negative inside; NaN at
    /// all others.
    fn distances(&self, mesh: &TriMesh) -> Result<Vec<f64>> {
        let mut near = vec![false; self.count()];
        for f in 0..mesh.face_count() {
            let corners = mesh.triangle(f).map(|p| (DVec3::from(p) - self.origin) / self.cell);
            let [a, b, c] = corners;
            let low = (a.min(b).min(c) - BAND).to_array().map(|x| x.max(0.0).floor() as usize);
            let high = (a.max(b).max(c) + BAND).to_array().map(|x| x.max(0.0).ceil() as usize);
            let range = |axis: usize| low[axis]..=high[axis].min(self.sides[axis] - 1);
            for k in range(2) {
                for j in range(1) {
                    range(0).for_each(|i| near[self.node([i, j, k])] = true);
                }
            }
        }
        let all = self.nodes().zip(&near).filter(|(_, near)| **near);
        let points: Vec<[f64; 3]> = all.map(|(steps, _)| self.point(steps).into()).collect();
        let closest = SurfaceTree::new(mesh)?.closest_to_all(&points);
        let sides = inside(mesh, &points, &closest);
        let mut found = closest
            .iter()
            .zip(sides)
            .map(|(at, is_inside)| if is_inside { -at.distance } else { at.distance });
        Ok(near
            .into_iter()
            .map(|near| if near { found.next() } else { None }.unwrap_or(f64::NAN))
            .collect())
    }

    /// Noise of level 1 at all nodes.
    fn noise(&self, length: f64, random: &mut ChaCha8Rng) -> Vec<f64> {
        let mut all: Vec<f64> = (0..self.count()).map(|_| normal(random)).collect();
        if length <= 0.0 {
            return all;
        }
        let reach = (3.0 * length).ceil() as usize;
        let weights: Vec<f64> =
            (0..=reach).map(|k| libm::exp(-0.5 * (k as f64 / length).powi(2))).collect();
        let mut stride = 1;
        for side in self.sides {
            let mut line = vec![0.0; side];
            for start in 0..all.len() {
                if start / stride % side != 0 {
                    continue;
                }
                for (i, x) in line.iter_mut().enumerate() {
                    let near = i.saturating_sub(reach)..(i + reach + 1).min(side);
                    *x = near.map(|j| weights[i.abs_diff(j)] * all[start + j * stride]).sum();
                }
                line.iter().enumerate().for_each(|(i, &x)| all[start + i * stride] = x);
            }
            stride *= side;
        }
        let level = (all.iter().map(|x| x * x).sum::<f64>() / all.len() as f64).sqrt();
        all.iter_mut().for_each(|x| *x /= level.max(f64::MIN_POSITIVE));
        all
    }

    /// The surface on which the values are zero, by marching cubes.
    fn surface(&self, values: &[f64]) -> Result<TriMesh> {
        let mut vertices = vec![u32::MAX; 3 * values.len()];
        let (mut positions, mut faces) = (vec![], vec![]);
        for steps in self.nodes() {
            if (0..3).any(|axis| steps[axis] + 1 >= self.sides[axis]) {
                continue;
            }
            let at = |corner: usize| std::array::from_fn(|axis| steps[axis] + (corner >> axis & 1));
            let corners: [f64; 8] = std::array::from_fn(|corner| values[self.node(at(corner))]);
            if corners.iter().any(|x| x.is_nan()) {
                continue;
            }
            let mut vertex = |[a, b]: [usize; 2]| {
                let (a, b) = (a.min(b), a.max(b));
                let axis = (a ^ b).trailing_zeros() as usize;
                let slot = &mut vertices[3 * self.node(at(a)) + axis];
                if *slot == u32::MAX {
                    *slot = positions.len() as u32;
                    let [p, q] = [a, b].map(|corner| self.point(at(corner)));
                    positions.push(p.lerp(q, corners[a] / (corners[a] - corners[b])).to_array());
                }
                *slot
            };
            for polygon in polygons(corners.map(|x| x < 0.0)) {
                let ids: Vec<u32> = polygon.into_iter().map(&mut vertex).collect();
                faces.extend((1..ids.len() - 1).map(|k| [ids[0], ids[k + 1], ids[k]]));
            }
        }
        faces.retain(|&[a, b, c]| a != b && b != c && c != a);
        Ok(TriMesh::new(positions, faces)?)
    }
}

/// The corners of the faces of a cube, counter-clockwise seen from outside; bit k of a corner is
/// its step along axis k.
const SIDES: [[usize; 4]; 6] =
    [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];

/// The polygons of the surface in a cube, as edges of the cube that it crosses, clockwise seen from
/// outside of the surface. In each face of the cube a line goes around each row of corners inside.
fn polygons(is_inside: [bool; 8]) -> Vec<Vec<[usize; 2]>> {
    let mut lines: Vec<[[usize; 2]; 2]> = vec![];
    for side in SIDES {
        for (k, &a) in side.iter().enumerate() {
            let next = side[(k + 1) % 4];
            if is_inside[a] && !is_inside[next] {
                let back = (1..4).map(|n| side[(k + 4 - n) % 4]).position(|b| !is_inside[b]);
                let first = back.map_or(k, |n| (k + 4 - n) % 4);
                let before = side[(first + 3) % 4];
                lines.push([[a, next], [side[first], before]]);
            }
        }
    }
    let key = |[a, b]: [usize; 2]| [a.min(b), a.max(b)];
    let mut all = vec![];
    while let Some([start, mut end]) = lines.pop() {
        let mut polygon = vec![start];
        while let Some(at) = lines.iter().position(|line| key(line[0]) == key(end)) {
            let [from, to] = lines.swap_remove(at);
            polygon.push(from);
            end = to;
        }
        all.push(polygon);
    }
    all
}

#[cfg(test)]
mod tests {
    use fairing_denoising::training::without_short_edges;
    use fairing_denoising::{AutomaticOptions, automatic, noise_level};
    use fairing_evaluation::{NoiseKind, NoiseLevel, add_noise, at_closest_points, normal_error};
    use fairing_shapes as shapes;

    use crate::families::{Family, Triangulation};

    use super::*;

    /// The surface of a clean volume is closed, lies within the square of a cell of the sphere, and
    /// its normals point outwards; noise of the distances moves it by its level.
    #[test]
    fn spheres_become_spheres() {
        let ball = shapes::icosphere(5);
        let cell = (DENSITY * ball.area() / 6000.0).sqrt();
        let distance = |mesh: &TriMesh| {
            let off = mesh.positions().iter().map(|&p| DVec3::from(p).length() - 1.0);
            (off.map(|x| x * x).sum::<f64>() / mesh.vertex_count() as f64).sqrt()
        };
        let clean = volume_surface(&ball, 6000, &[], 1).unwrap();
        assert!((5000..7000).contains(&clean.face_count()), "{}", clean.face_count());
        assert!(clean.topology().is_closed() && clean.topology().is_manifold());
        let (volume, off) = (clean.signed_volume(), distance(&clean) / cell.powi(2));
        assert!((4.1..4.2).contains(&volume) && off < 0.3, "{volume}, {off}");
        for length in [0.0, 2.0] {
            let noisy = volume_surface(&ball, 6000, &[Grain { level: 0.2, length }], 1).unwrap();
            assert!(noisy.topology().is_closed() && noisy.signed_volume() > 4.0);
            let level = distance(&noisy) / cell;
            assert!((0.1..0.3).contains(&level), "{length}: {level}");
        }
    }

    /// Each crossed edge of a cube is in one polygon, whatever corners are inside.
    #[test]
    fn polygons_use_every_crossed_edge_once() {
        for bits in 0..256usize {
            let is_inside: [bool; 8] = std::array::from_fn(|k| bits >> k & 1 == 1);
            let found = polygons(is_inside);
            let mut used: Vec<[usize; 2]> =
                found.iter().flatten().map(|&[a, b]| [a.min(b), a.max(b)]).collect();
            used.sort_unstable();
            let edges = (0..8usize).flat_map(|a| [1, 2, 4].map(|bit| [a, a | bit]));
            let crossed = edges.filter(|&[a, b]| a != b && is_inside[a] != is_inside[b]);
            let mut expected: Vec<[usize; 2]> = crossed.collect();
            expected.sort_unstable();
            assert_eq!(used, expected, "{bits:08b}");
            assert!(found.iter().all(|polygon| polygon.len() >= 3), "{bits:08b}");
        }
    }

    /// Surfaces of volumes lose their short edges, whatever the noise; models in any triangulation
    /// keep all of theirs.
    #[test]
    fn only_surfaces_of_volumes_are_merged() {
        let ball = shapes::icosphere(5);
        for (level, length) in [(0.0, 0.0), (0.1, 0.0), (0.4, 0.0), (0.4, 1.5), (1.0, 5.0)] {
            let noisy = volume_surface(&ball, 6000, &[Grain { level, length }], 2).unwrap();
            let merged = without_short_edges(&noisy).unwrap().expect("a surface of a volume");
            let left = merged.vertex_count() as f64 / noisy.vertex_count() as f64;
            assert!((0.6..0.85).contains(&left), "{level} {length}: {left}");
            assert!(merged.topology().is_manifold() && merged.topology().is_closed());
        }
        for (k, &family) in Family::ALL.iter().enumerate() {
            let triangulation = Triangulation::ALL[k % 4];
            let model = family.mesh(4000, triangulation, 5);
            let level = NoiseLevel::EdgeLengths(0.3);
            let noisy = add_noise(&model, NoiseKind::GaussianPerAxis, level, 3).unwrap();
            for mesh in [model, noisy] {
                assert!(without_short_edges(&mesh).unwrap().is_none(), "{family} {triangulation}");
            }
        }
    }

    /// Noise of a volume is removed, although the thin faces of its surface are as noisy as can be.
    /// Its level counts twice where it is independent and shape has no part in it.
    #[test]
    fn noise_of_volumes_is_removed() {
        let models = [shapes::icosphere(5), shapes::cad_block(0.05)];
        for (model, bounds) in models.into_iter().zip(MOST) {
            for (grain, (most, factor)) in GRAINS.into_iter().zip(bounds) {
                let noisy = volume_surface(&model, 6000, &[grain], 4).unwrap();
                let truth = at_closest_points(&noisy, &model).unwrap();
                let error = |mesh: &TriMesh| normal_error(mesh, &truth).unwrap().mean;
                let found = automatic(&noisy, &AutomaticOptions::default()).unwrap();
                assert_eq!(found.uneven_vertices, 0);
                let (before, after) = (error(&noisy), error(&found.mesh));
                assert!(after < most, "{grain:?}: {before} {after}");
                let merged = without_short_edges(&noisy).unwrap().unwrap();
                let fits = noise_level(&merged).unwrap().sigma;
                let counted = found.noise.unwrap().sigma / fits;
                assert!((counted / factor - 1.0).abs() < 1e-12, "{grain:?}: {counted}");
            }
        }
    }

    const GRAINS: [Grain; 3] = [
        Grain { level: 0.1, length: 0.0 },
        Grain { level: 0.2, length: 1.5 },
        Grain { level: 0.4, length: 0.0 },
    ];

    /// The largest error on the ball and on the block, in degrees; before it is 7° to 9°, and 28°
    /// under the strong noise. The factor on the noise level: of weak noise of the block the shape
    /// has a part.
    const MOST: [[(f64, f64); 3]; 2] =
        [[(0.7, 2.0), (5.0, 1.0), (4.0, 2.0)], [(3.4, 1.0), (5.0, 1.0), (10.0, 2.0)]];
}
