//! The vertices as samples of curvature: one-ring densities of corrected measures.

use fairing_mesh::TriMesh;
use fairing_watch::parallel;
use glam::DVec3;

use super::super::corrected::CorrectedMeasures;
use crate::normals::{NormalWeight, smoothed_normals, weighted_vertex_normals};
use crate::tangent::tangent_frame;

/// Rounds of averaging over the neighbours that make a mean edge length a local one.
const ROUNDS: usize = 4;

/// A vertex with the measures of a third of each of its faces, in units of [`Sites::unit`].
///
/// Two lines of the cache, since neighbourhoods read them in any order.
#[derive(Debug, Clone, Copy)]
#[repr(align(64))]
pub(super) struct Site {
    /// The unit normal after two rounds of averaging, zero where there is none.
    pub(super) normal: DVec3,
    /// The first axis of the tangent plane; the second is `normal × axis`.
    pub(super) axis: DVec3,
    /// μ⁰.
    pub(super) area: f64,
    /// ½ μ¹, μ², and the parts ½ (II₁₁ − II₂₂) and II₁₂ of the second form, integrated.
    pub(super) measure: [f64; 4],
    /// The mean of the squared distance to the vertex over its faces.
    pub(super) spread: f64,
}

/// All vertices.
#[derive(Debug)]
pub(super) struct Sites {
    pub(super) all: Vec<Site>,
    /// In units of `unit`; apart, since searches read nothing else.
    pub(super) positions: Vec<DVec3>,
    /// The local mean edge length.
    pub(super) length: Vec<f64>,
    /// The local area of a vertex over the square of `length`.
    pub(super) area: Vec<f64>,
    /// A power of two near the mean edge length, in mesh units: powers of lengths in this unit
    /// neither overflow nor underflow.
    pub(super) unit: f64,
}

impl Sites {
    pub(super) fn new(mesh: &TriMesh) -> Self {
        let unit = power_of_two(mesh.mean_edge_length());
        let normals = weighted_vertex_normals(mesh, NormalWeight::Sphere);
        let smooth = smoothed_normals(mesh, &normals);
        let triangle = |f: usize| mesh.triangle(f).map(|p| p.map(|x| x / unit));
        let measures: Vec<CorrectedMeasures> = parallel::map(mesh.face_count(), 4096, |f| {
            let u = mesh.faces()[f].map(|v| normals[v as usize]);
            if u.contains(&[0.0; 3]) {
                CorrectedMeasures::default()
            } else {
                CorrectedMeasures::from_triangle(triangle(f), u)
            }
        });
        let site = |v: u32| {
            let corners = mesh.incidence().corners(v);
            let (mut sum, mut spread, mut whole) = (CorrectedMeasures::default(), 0.0, 0.0);
            for &c in corners {
                let (f, k) = (c as usize / 3, c as usize % 3);
                sum = sum.plus(&measures[f], 1.0 / 3.0);
                let x = triangle(f).map(DVec3::from);
                let (p, q) = (x[(k + 1) % 3] - x[k], x[(k + 2) % 3] - x[k]);
                let area = 0.5 * p.cross(q).length();
                let squares = p.length_squared() + q.length_squared() + (p + q).length_squared();
                spread += area * squares / 12.0;
                whole += area;
            }
            let spread = if whole > 0.0 { spread / whole } else { 0.0 };
            (Site::new(smooth[v as usize], &sum, spread), whole / 3.0)
        };
        let found: Vec<(Site, f64)> = parallel::map(mesh.vertex_count(), 1024, |v| site(v as u32));
        let all: Vec<Site> = found.iter().map(|(site, _)| *site).collect();
        let position = |p: &[f64; 3]| DVec3::from(p.map(|x| x / unit));
        let positions: Vec<DVec3> = mesh.positions().iter().map(position).collect();
        let length = smoothed(mesh, mean_edges(mesh, &positions));
        let area = smoothed(mesh, found.iter().map(|(_, area)| *area).collect());
        let area = area.iter().zip(&length).map(|(a, l)| a / (l * l)).collect();
        Self { all, positions, length, area, unit }
    }
}

impl Site {
    fn new(normal: DVec3, sum: &CorrectedMeasures, spread: f64) -> Self {
        let [axis, other] = tangent_frame(normal);
        let form = |x: DVec3, y: DVec3| x.dot(sum.tensor.map(|row| DVec3::from(row).dot(y)).into());
        let measure = [
            0.5 * sum.mean,
            sum.gaussian,
            0.5 * (form(axis, axis) - form(other, other)),
            0.5 * (form(axis, other) + form(other, axis)),
        ];
        let area = sum.area;
        Self { normal, axis, area, measure, spread }
    }
}

/// The largest power of two not above a positive number; 1 otherwise.
fn power_of_two(x: f64) -> f64 {
    if x.is_normal() && x > 0.0 { libm::ldexp(1.0, libm::ilogb(x)) } else { 1.0 }
}

/// The mean length of the edges at each vertex.
fn mean_edges(mesh: &TriMesh, positions: &[DVec3]) -> Vec<f64> {
    let topology = mesh.topology();
    let mean = |v: usize| {
        let neighbors = topology.neighbors(v as u32);
        let distance = |&w: &u32| positions[v].distance(positions[w as usize]);
        neighbors.iter().map(distance).sum::<f64>() / (neighbors.len() as f64).max(1.0)
    };
    parallel::map(positions.len(), 1024, mean)
}

/// The values after [`ROUNDS`] rounds of averaging over each vertex and its neighbours.
pub(super) fn smoothed(mesh: &TriMesh, mut values: Vec<f64>) -> Vec<f64> {
    let topology = mesh.topology();
    for _ in 0..ROUNDS {
        let mean = |v: usize| {
            let neighbors = topology.neighbors(v as u32);
            let sum: f64 = neighbors.iter().map(|&w| values[w as usize]).sum();
            (values[v] + sum) / (1 + neighbors.len()) as f64
        };
        values = parallel::map(values.len(), 1024, mean);
    }
    values
}
