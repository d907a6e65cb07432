//! Preservation of volume or area during a flow.

use std::sync::Arc;

use fairing_mesh::{Connectivity, TriMesh};
use glam::DVec3;

use crate::engine::constraints::Freedom;
use crate::engine::error::FlowFailure;

/// Treatment of the volume in each step.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Volume {
    /// Not constrained: diffusion shrinks.
    #[default]
    Drifts,
    /// Restored after each step by scaling about the centroid of the volume. Source:
    /// [desbrun1999].
    ///
    /// [desbrun1999]: https://doi.org/10.1145/311535.311576
    Rescaled,
    /// Restored after each step by moving all vertices by the same distance along their normals.
    /// Local: parts that have not shrunk hardly change.
    Offset,
}

fairing_parameters::choices!(Volume, "treatment of the volume",
    Drifts: "drift", "Not constrained";
    Rescaled: "rescale", "Preserved by scaling about the centroid after each step";
    Offset: "offset", "Preserved by an offset along the normals after each step";
);
#[cfg(feature = "serde")]
fairing_parameters::serde_by_name!(Volume);

/// The largest number of Newton steps for the offset distance. The volume is a cubic in it, and the
/// loss of one flow step is small.
const MAX_STEPS: usize = 20;

/// The relative error of the volume at which the Newton steps end.
const TOLERANCE: f64 = 1e-13;

/// The relative error of the volume that is accepted if rounding prevents convergence.
const ACCEPTED: f64 = 1e-9;

/// Restores a volume or an area after each step.
#[derive(Debug, Clone)]
pub(crate) struct SizeKeeper {
    size: Size,
    /// The faces, [oriented](TriMesh::oriented).
    connectivity: Arc<Connectivity>,
}

/// The preserved quantity.
#[derive(Debug, Clone, Copy)]
enum Size {
    /// The area, preserved by scaling about the centroid of the surface.
    Area(f64),
    /// The volume, preserved by scaling about its centroid.
    Rescaled(f64),
    /// The volume, preserved by an offset along the normals.
    Offset(f64),
}

impl SizeKeeper {
    /// Preserves the area if `keep_area`, otherwise the volume; `None` if neither is preserved.
    pub(crate) fn new(
        mesh: &TriMesh,
        volume: Volume,
        keep_area: bool,
        freedom: &Freedom,
    ) -> Result<Option<Self>, FlowFailure> {
        if !keep_area && volume == Volume::Drifts {
            return Ok(None);
        }
        let oriented = mesh.oriented();
        let size = Self::size_of(&oriented, volume, keep_area, freedom)?;
        Ok(Some(Self { size, connectivity: Arc::clone(oriented.connectivity()) }))
    }

    fn size_of(
        mesh: &TriMesh,
        volume: Volume,
        keep_area: bool,
        freedom: &Freedom,
    ) -> Result<Size, FlowFailure> {
        let (faces, x) = (mesh.faces(), mesh.positions());
        if keep_area {
            return Ok(Size::Area(surface(faces, x).0));
        }
        if !mesh.topology().is_closed() || !mesh.topology().orientation().is_orientable() {
            return Err(FlowFailure::Volume { reason: "the mesh is not closed and orientable" });
        }
        let target = signed_volume(faces, x);
        // The volume of a flat or doubled sheet consists of rounding errors.
        if !(target.is_finite() && target.abs() > rounding(faces, x)) {
            return Err(FlowFailure::Volume { reason: "the input encloses no volume" });
        }
        if volume == Volume::Offset {
            return Ok(Size::Offset(target));
        }
        if freedom.fixed.contains(&true) {
            return Err(FlowFailure::Volume {
                reason: "scaling would move pinned vertices; use an offset along the normals",
            });
        }
        Ok(Size::Rescaled(target))
    }

    /// Restores the size.
    pub(crate) fn restore(&self, x: &mut [[f64; 3]], freedom: &Freedom) -> Result<(), FlowFailure> {
        let faces = self.connectivity.faces();
        match self.size {
            Size::Area(target) => {
                let (area, centre) = surface(faces, x);
                rescale(x, centre, (target / area).sqrt())
            }
            Size::Rescaled(target) => {
                let volume = signed_volume(faces, x);
                rescale(x, volume_centroid(faces, x, volume), libm::cbrt(target / volume))
            }
            Size::Offset(target) => offset(target, faces, x, freedom),
        }
    }
}

fn rescale(x: &mut [[f64; 3]], centre: DVec3, factor: f64) -> Result<(), FlowFailure> {
    if !(factor.is_finite() && factor > 0.0) {
        return Err(FlowFailure::Volume { reason: "the mesh has collapsed or turned inside out" });
    }
    for p in x.iter_mut() {
        *p = (centre + factor * (DVec3::from(*p) - centre)).to_array();
    }
    Ok(())
}

fn offset(
    target: f64,
    faces: &[[u32; 3]],
    x: &mut [[f64; 3]],
    freedom: &Freedom,
) -> Result<(), FlowFailure> {
    let mut normals = area_vectors(faces, x);
    for (i, n) in normals.iter_mut().enumerate() {
        let length = n.length();
        *n = if freedom.fixed[i] || length == 0.0 { DVec3::ZERO } else { *n * (1.0 / length) };
    }
    let mut missing = target - signed_volume(faces, x);
    for _ in 0..MAX_STEPS {
        if missing.abs() <= TOLERANCE * target.abs() {
            break;
        }
        // ∂V/∂xᵢ is a third of the area vectors around vertex i, exactly.
        let around = area_vectors(faces, x);
        let growth: f64 = around.iter().zip(&normals).map(|(a, n)| a.dot(*n) / 3.0).sum();
        let distance = missing / growth;
        if !distance.is_finite() {
            break;
        }
        for (p, n) in x.iter_mut().zip(&normals) {
            *p = (DVec3::from(*p) + distance * n).to_array();
        }
        missing = target - signed_volume(faces, x);
    }
    // Far from the origin, rounding of the positions alone may change the volume by more.
    let corners = faces.iter().flatten().flat_map(|&v| x[v as usize]);
    let far = corners.fold(0.0, |m: f64, x| m.max(x.abs()));
    let attainable = f64::EPSILON * far * surface(faces, x).0;
    if missing.abs() <= (ACCEPTED * target.abs()).max(attainable) {
        return Ok(());
    }
    Err(FlowFailure::Volume { reason: "no offset along the normals restores it" })
}

/// The area and centroid of the surface.
fn surface(faces: &[[u32; 3]], x: &[[f64; 3]]) -> (f64, DVec3) {
    let origin = middle(faces, x);
    let mut total = 0.0;
    let mut moment = DVec3::ZERO;
    for &face in faces {
        let [a, b, c] = face.map(|v| DVec3::from(x[v as usize]) - origin);
        let area = 0.5 * (b - a).cross(c - a).length();
        total += area;
        moment += (a + (b + c)) * (area / 3.0);
    }
    (total, origin + moment * (1.0 / total))
}

/// The signed volume `⅙ Σ a · (b × c)` about the mean of the first corners.
pub(crate) fn signed_volume(faces: &[[u32; 3]], x: &[[f64; 3]]) -> f64 {
    let origin = middle(faces, x);
    let corner = |v: u32| DVec3::from(x[v as usize]) - origin;
    faces.iter().map(|&[a, b, c]| corner(a).dot(corner(b).cross(corner(c)))).sum::<f64>() / 6.0
}

/// A bound on the rounding error of a vanishing volume: of each term and of their sum.
fn rounding(faces: &[[u32; 3]], x: &[[f64; 3]]) -> f64 {
    let origin = middle(faces, x);
    let corner = |v: u32| DVec3::from(x[v as usize]) - origin;
    let (mut products, mut terms) = (0.0, 0.0);
    for &[a, b, c] in faces {
        let [a, b, c] = [corner(a), corner(b), corner(c)];
        products += a.length() * b.length() * c.length();
        terms += a.dot(b.cross(c)).abs();
    }
    f64::EPSILON * (8.0 * products + faces.len() as f64 * terms) / 6.0
}

/// The centroid of the volume, from tetrahedra over the faces weighted by their signed volumes.
fn volume_centroid(faces: &[[u32; 3]], x: &[[f64; 3]], volume: f64) -> DVec3 {
    let origin = middle(faces, x);
    let corner = |v: u32| DVec3::from(x[v as usize]) - origin;
    let mut moment = DVec3::ZERO;
    for &face in faces {
        let [a, b, c] = face.map(corner);
        let six = a.dot(b.cross(c));
        moment += (a + (b + c)) * (six / 24.0);
    }
    origin + moment * (1.0 / volume)
}

/// The sum of the area vectors of the faces around each vertex.
fn area_vectors(faces: &[[u32; 3]], x: &[[f64; 3]]) -> Vec<DVec3> {
    let mut sums = vec![DVec3::ZERO; x.len()];
    for &face in faces {
        let [a, b, c] = face.map(|v| DVec3::from(x[v as usize]));
        let area = 0.5 * (b - a).cross(c - a);
        for v in face {
            sums[v as usize] += area;
        }
    }
    sums
}

/// The origin about which volumes and moments lose no digits: the mean of the first corners of the
/// faces. Isolated vertices do not count, however far away.
fn middle(faces: &[[u32; 3]], x: &[[f64; 3]]) -> DVec3 {
    let sum: DVec3 = faces.iter().map(|face| DVec3::from(x[face[0] as usize])).sum();
    sum * (1.0 / faces.len().max(1) as f64)
}
