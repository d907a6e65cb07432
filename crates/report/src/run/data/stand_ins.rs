//! The generated meshes that stand in for those of the assignment.

use fairing_mesh::{BuildError, TriMesh};
use fairing_shapes::{self as shapes, Diagonals};
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;

use crate::experiment::inputs::Input;

/// A generated mesh and its description.
pub(super) struct StandIn {
    pub(super) mesh: TriMesh,
    pub(super) about: &'static str,
    pub(super) made_by: String,
}

/// The seed of all that is random here.
const SEED: u64 = 7;

/// The distance of neighbours that gives the block about as many vertices as
/// the machine part of the assignment.
const BLOCK_SPACING: f64 = 0.075;

/// Uniform noise on each axis, in mean edge lengths: as measured between the
/// noisy machine part of the assignment and its original.
const BLOCK_NOISE: f64 = 0.389;

/// Noise of the patch, as the standard deviation along z in mean edge lengths.
const PATCH_NOISE: f64 = 0.17;

/// Makes the stand-in of an input, if it has one.
pub(super) fn for_input(input: Input) -> Option<StandIn> {
    let (mesh, about, made_by) = match input {
        Input::Flower => (
            shapes::flower(0.0714, SEED),
            "an open flower of four petals with very uneven faces",
            format!("shapes::flower(0.0714, {SEED})"),
        ),
        Input::Plane => (
            shapes::plane(9, 9, Diagonals::Regular),
            "a flat grid of 10 × 10 vertices",
            "shapes::plane(9, 9, Diagonals::Regular)".into(),
        ),
        Input::Armadillo => (
            shapes::creature(24),
            "the animal of creature_25k.ply, coarse enough for a full spectrum",
            "shapes::creature(24)".into(),
        ),
        Input::ArmadilloLarge => (
            shapes::creature(138),
            "an upright animal with limbs, a tail and wrinkled skin",
            "shapes::creature(138)".into(),
        ),
        Input::NoisyPlane => {
            let clean = shapes::jittered_plane(45, 45, 0.2, SEED);
            (
                noisy_along_z(&clean),
                "an open patch of irregular faces with normal noise along z",
                format!(
                    "shapes::jittered_plane(45, 45, 0.2, {SEED}), z + N(0, {PATCH_NOISE} h), seed {SEED}"
                ),
            )
        }
        Input::NoisyFandisk => (
            noisy_on_each_axis(&shapes::cad_block(BLOCK_SPACING)),
            "block.ply with uniform noise on each axis, vertex for vertex",
            format!(
                "shapes::cad_block({BLOCK_SPACING}), each coordinate + U(−1, 1) · {BLOCK_NOISE} h, seed {SEED}"
            ),
        ),
        Input::Fandisk => (
            shapes::cad_block(BLOCK_SPACING),
            "a block with sharp edges and fillets",
            format!("shapes::cad_block({BLOCK_SPACING})"),
        ),
        Input::Cube => (
            shapes::cube(1, Diagonals::Regular),
            "a cube of 8 vertices",
            "shapes::cube(1, Diagonals::Regular)".into(),
        ),
        _ => return None,
    };
    Some(StandIn { mesh, about, made_by })
}

/// Normal noise along z.
fn noisy_along_z(mesh: &TriMesh) -> TriMesh {
    let sigma = PATCH_NOISE * mesh.mean_edge_length();
    let mut rng = ChaCha8Rng::seed_from_u64(SEED);
    // The sum of twelve uniform numbers is close enough to normal, and the same
    // on every platform, since only additions are involved.
    let mut normal = || (0..12).map(|_| rng.random::<f64>()).sum::<f64>() - 6.0;
    moved(mesh, |[x, y, z]| [x, y, z + sigma * normal()])
}

/// Uniform noise on each axis.
fn noisy_on_each_axis(mesh: &TriMesh) -> TriMesh {
    let size = BLOCK_NOISE * mesh.mean_edge_length();
    let mut rng = ChaCha8Rng::seed_from_u64(SEED);
    moved(mesh, |p| p.map(|x| x + size * (2.0 * rng.random::<f64>() - 1.0)))
}

fn moved(mesh: &TriMesh, shift: impl FnMut([f64; 3]) -> [f64; 3]) -> TriMesh {
    let positions = mesh.positions().iter().copied().map(shift).collect();
    let moved: Result<TriMesh, BuildError> = mesh.with_positions(positions);
    // Finite noise on finite positions, one for each.
    moved.expect("noise keeps positions finite")
}
