//! Mean curvature from a Laplacian of the positions, `Δx = −2 H n`.

use fairing_mesh::TriMesh;
use fairing_mesh::vec3::{add, dot, norm, scale, sub};
use rayon::prelude::*;

use super::boundary::{VertexLinks, links_of, vertex_links};
use super::gaussian::undefined;
use super::status::{ScalarCurvature, Undefined, VertexStatus};
use crate::corners::{FaceCorners, next, previous, sound_face_corners};
use crate::error::OperatorError;
use crate::mass::{LumpedArea, lumped_mass};
use crate::normals::vertex_normals;

/// The Laplacian behind a mean curvature.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum MeanOperator {
    /// The random walk, `Δx = mean(xⱼ) − xᵢ`, as the assignment has it.
    ///
    /// A **length**, not a curvature: on a regular mesh it is ¼ ℓ² times the
    /// Laplacian for edges of length ℓ. It multiplies by s when the mesh is
    /// scaled by s. On irregular meshes it also sees the unevenness of the
    /// neighbours, tangentially. Source: \[taubin1995\].
    Umbrella,
    /// The umbrella times `4 / mean(ℓ²)` over the edges at the vertex, in
    /// 1 / mesh units: exact to leading order on regular rings, and comparable
    /// with the true value. Source: \[desbrun1999\].
    ScaledUmbrella,
    /// `Δx = −M⁻¹ S x` with cotangent weights and the given area, in
    /// 1 / mesh units. Sources: \[pinkall1993\], \[meyer2003\].
    Cotangent(LumpedArea),
}

/// The mean curvature at each vertex, and the vectors it is read from.
#[derive(Debug, Clone, PartialEq)]
pub struct MeanCurvature {
    /// `Δx` at each vertex; zero where undefined.
    pub vectors: Vec<[f64; 3]>,
    /// `H = −½ Δx · n`, with the area-weighted normal n: positive where the
    /// surface bends like a sphere; zero where undefined.
    pub signed: Vec<f64>,
    /// Whether each value is defined.
    pub status: Vec<VertexStatus>,
    /// Whether each vertex is on the boundary, where the Laplacian is
    /// one-sided and points inwards along the surface.
    pub boundary: Vec<bool>,
}

impl MeanCurvature {
    /// `H = ½ ‖Δx‖`, as the assignment asks for: without a sign, and with the
    /// tangential part of Δx.
    pub fn norms(&self) -> Vec<f64> {
        self.vectors.iter().map(|&d| 0.5 * norm(d)).collect()
    }

    /// The signed values with their flags.
    pub fn into_signed(self) -> ScalarCurvature {
        ScalarCurvature { values: self.signed, status: self.status, boundary: self.boundary }
    }
}

/// Pointwise mean curvature at each vertex.
///
/// Undefined at isolated vertices, where the area is not positive, and where
/// no normal tells the sign. Boundary vertices are computed one-sidedly and
/// flagged.
///
/// # Errors
///
/// [`OperatorError::DegenerateFace`] with [`MeanOperator::Cotangent`], for the
/// first face too thin for its cotangents; never with the others.
pub fn mean_curvature(
    mesh: &TriMesh,
    operator: MeanOperator,
) -> Result<MeanCurvature, OperatorError> {
    let mut vectors = match operator {
        MeanOperator::Umbrella => umbrellas(mesh, false),
        MeanOperator::ScaledUmbrella => umbrellas(mesh, true),
        MeanOperator::Cotangent(area) => {
            let mass = lumped_mass(mesh, area)?;
            let mut vectors = integrated_laplacian(mesh, &sound_face_corners(mesh)?);
            for (vector, mass) in vectors.iter_mut().zip(mass) {
                // A cell that is not positive is flagged below by this zero.
                let s = if mass > 0.0 { 1.0 / mass } else { f64::NAN };
                *vector = scale(*vector, s);
            }
            vectors
        }
    };
    let links = vertex_links(mesh);
    let mut signed = Vec::with_capacity(vectors.len());
    let mut status = Vec::with_capacity(vectors.len());
    for ((vector, normal), links) in vectors.iter_mut().zip(vertex_normals(mesh)).zip(&links) {
        let value = -0.5 * dot(*vector, normal);
        let reason = why_not(*links, value, normal);
        if reason.is_some() {
            *vector = [0.0; 3];
        }
        signed.push(if reason.is_some() { 0.0 } else { value });
        status.push(reason.map_or(VertexStatus::Defined, VertexStatus::Undefined));
    }
    let boundary = links.iter().map(|l| l.boundary).collect();
    Ok(MeanCurvature { vectors, signed, status, boundary })
}

fn why_not(links: VertexLinks, value: f64, normal: [f64; 3]) -> Option<Undefined> {
    (!value.is_finite() || normal == [0.0; 3]).then(|| undefined(links))
}

/// `mean(xⱼ) − xᵢ` over the neighbours, each once; scaled by `4 / mean(ℓ²)` if
/// asked for.
fn umbrellas(mesh: &TriMesh, scaled: bool) -> Vec<[f64; 3]> {
    let (positions, vertices) = (mesh.positions(), mesh.faces().as_flattened());
    let incidence = mesh.incidence();
    let umbrella = |ring: &mut Vec<u32>, v: u32| {
        let corners = incidence.corners(v);
        ring.clear();
        ring.extend(corners.iter().map(|&c| vertices[next(c) as usize]));
        let closed = {
            let mut room = Vec::new();
            let links = links_of(vertices, corners, &mut room);
            links.edges == links.faces && !links.boundary
        };
        if !closed {
            ring.extend(corners.iter().map(|&c| vertices[previous(c) as usize]));
        }
        ring.sort_unstable();
        ring.dedup();
        let at = positions[v as usize];
        let (mut sum, mut squares) = ([0.0; 3], 0.0);
        for &w in ring.iter() {
            let edge = sub(positions[w as usize], at);
            sum = add(sum, edge);
            squares += dot(edge, edge);
        }
        let divisor = if scaled { 0.25 * squares } else { ring.len() as f64 };
        scale(sum, 1.0 / divisor)
    };
    (0..mesh.vertex_count() as u32)
        .into_par_iter()
        .with_min_len(2048)
        .map_init(Vec::new, umbrella)
        .collect()
}

/// `−S x` at each vertex, without assembling S.
pub(crate) fn integrated_laplacian(mesh: &TriMesh, corners: &[FaceCorners]) -> Vec<[f64; 3]> {
    let (positions, vertices) = (mesh.positions(), mesh.faces().as_flattened());
    let incidence = mesh.incidence();
    let at_vertex = |v: u32| {
        let at = positions[v as usize];
        incidence.corners(v).iter().fold([0.0; 3], |sum, &c| {
            let cot = corners[c as usize / 3].cotangents();
            let (n, p) = (next(c) as usize, previous(c) as usize);
            let to_next = sub(positions[vertices[n] as usize], at);
            let to_previous = sub(positions[vertices[p] as usize], at);
            let turn = add(scale(to_next, cot[p % 3]), scale(to_previous, cot[n % 3]));
            add(sum, scale(turn, 0.5))
        })
    };
    (0..mesh.vertex_count() as u32).into_par_iter().with_min_len(2048).map(at_vertex).collect()
}
