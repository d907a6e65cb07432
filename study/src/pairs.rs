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

/// Name, noisy file and true file of each, the files below the folder of the meshes.
const PAIRS: [[&str; 3]; 13] = [
    ["Fandisk0.3", "denoising/Fandisk0.3_noisy.obj", "denoising/Fandisk0.3_original.obj"],
    ["Fandisk0.7", "denoising/Fandisk0.7_noisy.obj", "denoising/Fandisk0.3_original.obj"],
    ["Block0.4", "denoising/Block0.4_noisy.obj", "denoising/Block0.4_original.obj"],
    [
        "Twelve0.5",
        "denoising/Twelve0.5Impulsive_noisy.obj",
        "denoising/Twelve0.5Impulsive_original.obj",
    ],
    ["fandisk_ns", "assignment/fandisk_ns.obj", "assignment/fandisk.obj"],
    ["Julius0.2", "denoising/Julius0.2_noisy.obj", "denoising/Julius0.2_original.obj"],
    ["KinectPyramid", "denoising/KinectPyramid_noisy.obj", "denoising/KinectPyramid_original.obj"],
    ["ScanBunny090", "denoising/ScanBunny090_noisy.obj", "denoising/ScanBunny090_original.obj"],
    ["ScanDragon0", "denoising/ScanDragon0_noisy.obj", "denoising/ScanDragon0_original.obj"],
    ["igea_n3", "denoising/igea_n3_noisy.obj", "denoising/igea_n3_original.obj"],
    ["child_n3", "denoising/child_n3_noisy.obj", "denoising/child_n3_original.obj"],
    ["trim-star_n3", "denoising/trim-star_n3_noisy.obj", "denoising/trim-star_n3_original.obj"],
    ["nicolo_imp6", "denoising/nicolo_imp6_noisy.obj", "denoising/nicolo_imp6_original.obj"],
];

/// Returns true for the name of a pair.
pub fn is_pair(name: &str) -> bool {
    PAIRS.iter().any(|[pair, ..]| *pair == name)
}

/// The pairs found in the folder, and the names of those that are not there.
pub fn pairs(folder: &Path) -> Result<(Vec<Pair>, Vec<&'static str>)> {
    let (mut found, mut absent) = (vec![], vec![]);
    for [name, noisy, truth] in PAIRS {
        let [noisy, truth] = [noisy, truth].map(|file| folder.join(file));
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
