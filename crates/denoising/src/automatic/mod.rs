//! Denoising with parameters that are estimated from the mesh.

mod around;
mod choice;
mod correlation;
mod features;
mod fits;
mod flips;
mod follow;
mod group;
mod impulses;
mod merge;
mod model;
mod network;
mod offset;
mod parts;
mod planes;
mod restraint;
mod result;
mod spikes;
mod stage;
mod state;
mod surface;
#[cfg(feature = "training")]
pub mod training;
mod wide;

use fairing_parameters::{Options, Range};

use crate::error::DenoiseError;
use crate::masked::{Masked, on_oriented};
use crate::noise_level::noisy_parts;
use group::groups;
use merge::Merged;
use parts::Part;
use result::Start;
use spikes::without_spikes;

pub use choice::Approach;
pub use result::Automatic;
pub use surface::{FaceKind, SurfaceKind};

fairing_parameters::options! {
    /// Options of [`automatic`].
    #[derive(Debug, Clone, Copy, PartialEq)]
    #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
    #[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
    pub struct AutomaticOptions {
        /// A factor on the estimated noise, for a result that is too smooth or too rough.
        pub strength: f64 = 1.0, in Range::POSITIVE;
    }
    "automatic": "estimates noise and surface from the mesh; keeps creases", [];
}

/// Denoises with a noise level and a kind of surface that are estimated from the mesh.
///
/// In the repository, `docs/denoising.md` has results and limits, `study/DESIGN.md` the constants
/// and their reasons.
///
/// 1. [Spikes](Automatic::spikes) are moved to the surface around them.
/// 2. On surfaces of volumes, as marching cubes makes them, the ends of short edges are merged, and
///    moved apart again at the end.
/// 3. Connected parts whose noise differs by more than a factor of four
///    ([`noisy_parts`](crate::noisy_parts)) are denoised separately.
/// 4. Normals are means of candidates at many scales around each face, with weights by trained
///    networks; on noise of a depth camera they may be those of
///    [`total_generalised_variation`](crate::total_generalised_variation). Faces in one plane
///    share one normal.
/// 5. Vertices move to fit the normals, by no more than the measured noise, and end evenly on both
///    sides of the surface, so that the volume of a closed part is preserved.
///
/// Planes stay planes. Isolated vertices do not move; borders move with their faces; faces are not
/// compared across edges with one, three or more faces. Faces count as
/// [oriented](fairing_mesh::TriMesh::oriented). No vertex moves further than [`Automatic::limit`].
/// Parts of [uneven faces](Automatic::uneven_vertices) stay unchanged. So does, except for spikes,
/// a mesh whose noise level is undefined, and a mesh without impulses whose noise level times the
/// strength is below 10⁻³ mean edge lengths. The result follows rotations, reflections,
/// translations and scaling of the mesh, up to rounding.
///
/// # Errors
///
/// [`DenoiseError::Option`] for a strength that is not positive;
/// [`DenoiseError::Unwelded`] for faces that do not share their corners;
/// [`DenoiseError::Build`] where numbers leave the range of floats;
/// [`DenoiseError::Model`] if the trained numbers were damaged in the build.
///
/// Source of the regression of normals in stages: [wang2016].
///
/// [wang2016]: https://doi.org/10.1145/2980179.2980232
pub fn automatic<'a>(
    mesh: impl Into<Masked<'a>>,
    options: &AutomaticOptions,
) -> Result<Automatic, DenoiseError> {
    options.check()?;
    let (mut start, mut done) = (Start::default(), vec![]);
    let mesh = on_oriented(mesh.into(), |original| {
        let without = without_spikes(original)?;
        let merged = Merged::new(original.on(&without))?;
        let input = merged.masked()?;
        let parts = noisy_parts(input);
        let uneven = merged.uneven(&parts);
        start = Start::new(original.mesh(), &without, &merged, &parts, &uneven);
        let mut positions = merged.mesh.positions().to_vec();
        for group in groups(&merged, input, parts, &uneven, options.strength) {
            let part = Part::new(input, &group.components)?;
            let denoised = group.denoise(part.masked()?)?;
            part.put_back(denoised.mesh.positions(), &mut positions);
            done.push(denoised);
        }
        Ok(without.with_positions(merged.spread(&start.positions, positions)?)?)
    })?;
    Ok(Automatic::new(mesh, start, &done))
}
