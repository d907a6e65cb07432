//! The pairs of the literature, where they are found.

use std::path::Path;

use anyhow::{Context as _, Result};
use fairing_mesh::{TriMesh, io};

/// A noisy mesh and its truth, from files.
#[derive(Debug, Clone)]
pub struct Pair {
    /// Its name in the literature.
    pub name: &'static str,
    /// The mesh without noise, with the faces of the noisy one.
    pub truth: TriMesh,
    /// The noisy mesh.
    pub noisy: TriMesh,
}

/// Noisy file and true file of each, below the folder of the meshes.
const FILES: [[&str; 2]; 13] = [
    ["denoising/Fandisk0.3_noisy.obj", "denoising/Fandisk0.3_original.obj"],
    ["denoising/Fandisk0.7_noisy.obj", "denoising/Fandisk0.3_original.obj"],
    ["denoising/Block0.4_noisy.obj", "denoising/Block0.4_original.obj"],
    ["denoising/Twelve0.5Impulsive_noisy.obj", "denoising/Twelve0.5Impulsive_original.obj"],
    ["assignment/fandisk_ns.obj", "assignment/fandisk.obj"],
    ["denoising/Julius0.2_noisy.obj", "denoising/Julius0.2_original.obj"],
    ["denoising/KinectPyramid_noisy.obj", "denoising/KinectPyramid_original.obj"],
    ["denoising/ScanBunny090_noisy.obj", "denoising/ScanBunny090_original.obj"],
    ["denoising/ScanDragon0_noisy.obj", "denoising/ScanDragon0_original.obj"],
    ["denoising/igea_n3_noisy.obj", "denoising/igea_n3_original.obj"],
    ["denoising/child_n3_noisy.obj", "denoising/child_n3_original.obj"],
    ["denoising/trim-star_n3_noisy.obj", "denoising/trim-star_n3_original.obj"],
    ["denoising/nicolo_imp6_noisy.obj", "denoising/nicolo_imp6_original.obj"],
];

/// The names of all pairs.
pub const PAIR_NAMES: [&str; 13] = [
    "Fandisk0.3",
    "Fandisk0.7",
    "Block0.4",
    "Twelve0.5",
    "fandisk_ns",
    "Julius0.2",
    "KinectPyramid",
    "ScanBunny090",
    "ScanDragon0",
    "igea_n3",
    "child_n3",
    "trim-star_n3",
    "nicolo_imp6",
];

/// The pairs found in the folder, and the names of those that are not there.
///
/// # Errors
///
/// A file that cannot be read, or a pair with different numbers of vertices.
pub fn pairs(folder: &Path) -> Result<(Vec<Pair>, Vec<&'static str>)> {
    let (mut found, mut absent) = (vec![], vec![]);
    for (name, files) in PAIR_NAMES.into_iter().zip(FILES) {
        let [noisy, truth] = files.map(|file| folder.join(file));
        if !noisy.is_file() || !truth.is_file() {
            absent.push(name);
            continue;
        }
        let read = |path: &Path| {
            io::read(path).map(|f| f.mesh).with_context(|| format!("reading {}", path.display()))
        };
        let (noisy, truth) = (read(&noisy)?, read(&truth)?);
        // Originals may list their faces with other attributes, in the same order.
        let truth = noisy
            .with_positions(truth.positions().to_vec())
            .with_context(|| format!("{name}: the true mesh does not fit the noisy one"))?;
        found.push(Pair { name, truth, noisy });
    }
    Ok((found, absent))
}
