//! Keeping the volume that a flow would lose.

use fairing_mesh::TriMesh;
use fairing_mesh::vec3::{add, cross, dot, norm, scale, sub};

use crate::constraints::Freedom;
use crate::error::FlowFailure;

/// What happens to the volume in each step.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Volume {
    /// It changes as the flow has it: diffusion shrinks.
    #[default]
    Drifts,
    /// After each step the mesh is scaled about the centroid of its volume to the volume of the input.
    /// Source: \[desbrun1999\].
    Rescaled,
    /// After each step all vertices move by one distance along their normals, inward or outward, so that the
    /// volume of the input is restored. Local: thin parts do not pay for the loss of others in proportion.
    Offset,
}

/// Newton steps for the offset distance; volume is a cubic in it, and the loss of one step is small.
const MOST_STEPS: usize = 20;

/// The error of the volume that is left, relative to the volume.
const TOLERANCE: f64 = 1e-13;

/// Restores a volume after each step.
#[derive(Debug, Clone, Copy)]
pub(crate) struct VolumeKeeper {
    policy: Volume,
    target: f64,
}

impl VolumeKeeper {
    /// `None` if the volume may drift.
    pub(crate) fn new(
        mesh: &TriMesh,
        policy: Volume,
        freedom: &Freedom,
    ) -> Result<Option<Self>, FlowFailure> {
        if policy == Volume::Drifts {
            return Ok(None);
        }
        if !mesh.topology().is_closed() || !mesh.topology().orientation().is_consistent() {
            return Err(FlowFailure::Volume {
                reason: "only a closed mesh whose faces agree in orientation has one",
            });
        }
        if policy == Volume::Rescaled && freedom.held.contains(&true) {
            return Err(FlowFailure::Volume {
                reason: "scaling would move pinned vertices; take an offset along the normals",
            });
        }
        let target = signed_volume(mesh.faces(), mesh.positions());
        if !(target.is_finite() && target != 0.0) {
            return Err(FlowFailure::Volume { reason: "the input has none" });
        }
        Ok(Some(Self { policy, target }))
    }

    /// Restores the volume.
    pub(crate) fn restore(
        &self,
        faces: &[[u32; 3]],
        x: &mut [[f64; 3]],
        freedom: &Freedom,
    ) -> Result<(), FlowFailure> {
        match self.policy {
            Volume::Drifts => Ok(()),
            Volume::Rescaled => self.rescale(faces, x),
            Volume::Offset => self.offset(faces, x, freedom),
        }
    }

    fn rescale(&self, faces: &[[u32; 3]], x: &mut [[f64; 3]]) -> Result<(), FlowFailure> {
        let volume = signed_volume(faces, x);
        let ratio = self.target / volume;
        if !(ratio.is_finite() && ratio > 0.0) {
            return Err(FlowFailure::Volume {
                reason: "the mesh has collapsed or turned inside out",
            });
        }
        let factor = ratio.cbrt();
        let centre = volume_centroid(faces, x, volume);
        for p in x.iter_mut() {
            *p = add(centre, scale(sub(*p, centre), factor));
        }
        Ok(())
    }

    fn offset(
        &self,
        faces: &[[u32; 3]],
        x: &mut [[f64; 3]],
        freedom: &Freedom,
    ) -> Result<(), FlowFailure> {
        let mut normals = area_vectors(faces, x);
        for (i, n) in normals.iter_mut().enumerate() {
            let length = norm(*n);
            *n = if freedom.held[i] || length == 0.0 { [0.0; 3] } else { scale(*n, 1.0 / length) };
        }
        for _ in 0..MOST_STEPS {
            let missing = self.target - signed_volume(faces, x);
            if missing.abs() <= TOLERANCE * self.target.abs() {
                return Ok(());
            }
            // ∂V/∂xᵢ is a third of the area vectors around vertex i, exactly.
            let growth: f64 =
                area_vectors(faces, x).iter().zip(&normals).map(|(a, n)| dot(*a, *n) / 3.0).sum();
            let distance = missing / growth;
            if !distance.is_finite() {
                break;
            }
            for (p, n) in x.iter_mut().zip(&normals) {
                *p = add(*p, scale(*n, distance));
            }
        }
        let missing = self.target - signed_volume(faces, x);
        if missing.abs() <= 1e-9 * self.target.abs() {
            return Ok(());
        }
        Err(FlowFailure::Volume { reason: "no offset along the normals restores it" })
    }
}

/// The signed volume `⅙ Σ a · (b × c)` about the mean of the points.
pub(crate) fn signed_volume(faces: &[[u32; 3]], x: &[[f64; 3]]) -> f64 {
    let origin = mean(x);
    let corner = |v: u32| sub(x[v as usize], origin);
    faces.iter().map(|&[a, b, c]| dot(corner(a), cross(corner(b), corner(c)))).sum::<f64>() / 6.0
}

/// The centroid of the volume: tetrahedra from the mean of the points, weighted by their signed volumes.
fn volume_centroid(faces: &[[u32; 3]], x: &[[f64; 3]], volume: f64) -> [f64; 3] {
    let origin = mean(x);
    let corner = |v: u32| sub(x[v as usize], origin);
    let mut moment = [0.0; 3];
    for &face in faces {
        let [a, b, c] = face.map(corner);
        let six = dot(a, cross(b, c));
        moment = add(moment, scale(add(a, add(b, c)), six / 24.0));
    }
    add(origin, scale(moment, 1.0 / volume))
}

/// The sum of the area vectors of the faces around each vertex.
fn area_vectors(faces: &[[u32; 3]], x: &[[f64; 3]]) -> Vec<[f64; 3]> {
    let mut sums = vec![[0.0; 3]; x.len()];
    for &face in faces {
        let [a, b, c] = face.map(|v| x[v as usize]);
        let area = scale(cross(sub(b, a), sub(c, a)), 0.5);
        for v in face {
            sums[v as usize] = add(sums[v as usize], area);
        }
    }
    sums
}

fn mean(x: &[[f64; 3]]) -> [f64; 3] {
    let sum = x.iter().fold([0.0; 3], |s, &p| add(s, p));
    scale(sum, 1.0 / x.len().max(1) as f64)
}
