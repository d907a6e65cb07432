//! Repair with patches that continue the surface.

use fairing_mesh::{RepairError, RepairOptions, Repaired, TriMesh, repair_with};

use crate::engine::error::FlowError;
use crate::flows::region::{FairRegion, fair_region};

/// Mends a mesh as [`fairing_mesh::repair`] does; the patches of holes continue the surface.
///
/// The vertices inside patches are placed by [`fair_region`]. If that fails, the patches keep least
/// area, and the error is returned beside the result.
///
/// # Errors
///
/// Those of [`fairing_mesh::repair`].
///
/// # Examples
///
/// ```
/// use fairing_mesh::{RepairOptions, TriMesh};
/// use fairing_shapes as shapes;
/// use fairing_smoothing::repair_fair;
///
/// // A sphere without the faces around its first vertex.
/// let sphere = shapes::icosphere(3);
/// let faces = sphere.faces().iter().copied().filter(|face| !face.contains(&0)).collect();
/// let open = TriMesh::new(sphere.positions().to_vec(), faces)?;
/// let options = RepairOptions { holes: 10, ..RepairOptions::DEFAULT };
/// let (repaired, flat) = repair_fair(&open, &options)?;
/// assert!(flat.is_none() && repaired.mesh.topology().is_closed());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[doc(alias("fill_holes", "hole_filling"))]
pub fn repair_fair(
    mesh: &TriMesh,
    options: &RepairOptions,
) -> Result<(Repaired, Option<FlowError>), RepairError> {
    let mut flat = None;
    let repaired = repair_with(mesh, options, |mesh, patch| {
        let fair = fair_region(mesh, &FairRegion::new(patch));
        fair.map_err(|error| flat = Some(error)).ok().map(|fair| fair.mesh)
    })?;
    Ok((repaired, flat))
}
