//! The cases.

use anyhow::Result;
use fairing_evaluation::{
    NoiseKind, NoiseLevel, Scan, ScanOptions, add_noise, at_closest_points, scan,
};
use fairing_mesh::TriMesh;
use glam::DVec3;

use crate::families::{Family, Kind, Set, Triangulation};
use crate::volumes::{Grain, volume_surface};

/// A model with noise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Case {
    /// The family of the model.
    pub family: Family,
    /// The kind of triangulation.
    pub triangulation: Triangulation,
    /// The approximate number of faces.
    pub faces: usize,
    /// The seen surface, and its noise.
    pub sight: Sight,
    /// The seed of proportions, triangulation and noise.
    pub seed: u64,
}

/// The surface of a model that is seen, and its noise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Sight {
    /// The model itself, with noise of a level in mean edge lengths.
    Model(NoiseKind, f64),
    /// The depth image of a camera with these numbers of pixels; the camera of the noise
    /// is the same.
    View([u32; 2], NoiseKind, f64),
    /// The surface that marching cubes finds in a volume with this noise, and its name.
    Volume(&'static str, &'static [Grain]),
}

impl Case {
    /// Its name in tables: family, triangulation, noise and level, and the number
    /// of faces of large ones.
    pub fn name(&self) -> String {
        let Self { family, triangulation, faces, sight, .. } = self;
        let (noise, level) = match sight {
            Sight::Model(noise, level) => (noise, level),
            Sight::View(_, noise, level) => return format!("{family} scan {noise} {level}"),
            Sight::Volume(noise, _) => return format!("{family} volume {noise}"),
        };
        let size = match faces {
            0..FACES => unreachable!("no case has fewer faces than {FACES}"),
            &FACES => String::new(),
            more => format!(" {}k", more / 1000),
        };
        format!("{family} {triangulation} {noise} {level}{size}")
    }

    /// The set that its family is in.
    pub fn set(&self) -> Set {
        self.family.set()
    }

    /// The truth, and the noisy mesh with the same faces.
    pub fn meshes(&self) -> Result<(TriMesh, TriMesh)> {
        let model = self.family.mesh(self.faces, self.triangulation, self.seed);
        let (truth, noise, level) = match self.sight {
            Sight::Model(noise, level) => (model, noise, level),
            Sight::View(pixels, noise, level) => {
                let Scan { mesh, camera, .. } = view(&model, pixels, self.seed)?;
                (mesh, noise.with_camera(camera).unwrap_or(noise), level)
            }
            Sight::Volume(_, grains) => {
                let noisy = volume_surface(&model, VOLUME_FACES, grains, self.seed)?;
                return Ok((at_closest_points(&noisy, &model)?, noisy));
            }
        };
        let level = NoiseLevel::EdgeLengths(level);
        let noisy = add_noise(&truth, noise, level, self.seed)?;
        Ok((truth, noisy))
    }
}

/// The depth image of a model from a random direction, of an open one from above, three diagonals
/// away.
pub(crate) fn view(model: &TriMesh, size: [u32; 2], seed: u64) -> Result<Scan> {
    let draw = |salt: u64| unit(seed.wrapping_mul(41).wrapping_add(salt));
    let z = if model.topology().is_closed() { 2.0 * draw(1) - 1.0 } else { 0.5 + 0.5 * draw(1) };
    let (flat, turn) = ((1.0 - z * z).sqrt(), std::f64::consts::TAU * draw(2));
    let toward = DVec3::new(flat * libm::cos(turn), flat * libm::sin(turn), z);
    let [low, high] = model.bounding_box().unwrap_or_default().map(DVec3::from);
    let camera = 0.5 * (low + high) + 3.0 * model.diagonal() * toward;
    let options = ScanOptions { camera: Some(camera.to_array()), size, ..ScanOptions::default() };
    Ok(scan(model, &options)?)
}

/// Uniform in [0, 1), by a hash (splitmix64).
pub(crate) fn unit(index: u64) -> f64 {
    let mut x = index.wrapping_add(1).wrapping_mul(0x9E37_79B9_7F4A_7C15);
    x = (x ^ (x >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    ((x ^ (x >> 31)) >> 11) as f64 / 9_007_199_254_740_992.0
}

/// The number of faces of most cases.
const FACES: usize = 4000;

/// The number of faces of large models, and of those of views and volumes.
const SEEN_FACES: usize = 20_000;

/// The cases of each family: triangulation and noise, with the levels that families take in turn.
const PLAN: [(Triangulation, NoiseKind, &[f64]); 7] = [
    (Triangulation::Regular, NoiseKind::GaussianAlongNormals, &[0.3, 0.7, 0.2, 0.5, 0.3, 0.1]),
    (Triangulation::Irregular, NoiseKind::GaussianPerAxis, &[0.2, 0.1, 0.3, 0.05]),
    (Triangulation::Anisotropic, NoiseKind::GaussianAlongNormals, &[0.1, 0.2, 0.05, 0.15]),
    (Triangulation::Graded, NoiseKind::GaussianAlongNormals, &[0.2, 0.1, 0.3, 0.15]),
    (Triangulation::Irregular, NoiseKind::Correlated { length: 2.0 }, &[0.2, 0.1, 0.3, 0.15]),
    (Triangulation::Regular, NoiseKind::Impulsive { fraction: 0.25 }, &[0.5, 0.3, 0.7, 0.4]),
    (Triangulation::Irregular, NoiseKind::Varying, &[0.2, 0.3, 0.1, 0.4]),
];

/// Larger models: family, triangulation, noise, level.
const LARGE: [(Family, Triangulation, NoiseKind, f64); 3] = [
    (Family::Gear, Triangulation::Regular, NoiseKind::GaussianAlongNormals, 0.2),
    (Family::Bracket, Triangulation::Irregular, NoiseKind::GaussianPerAxis, 0.15),
    (Family::Knot, Triangulation::Regular, NoiseKind::GaussianAlongNormals, 0.3),
];

/// All cases, set by set and family by family, the large ones last.
pub fn cases() -> Vec<Case> {
    let mut cases = vec![];
    for set in Set::ALL {
        let families = Family::ALL.iter().copied().filter(|f| f.set() == set);
        for (i, family) in families.enumerate() {
            for (k, (triangulation, noise, levels)) in PLAN.into_iter().enumerate() {
                let seed = 100 * (family as u64 + 1) + k as u64;
                let level = levels[(i + k) % levels.len()];
                let sight = Sight::Model(noise, level);
                cases.push(Case { family, triangulation, faces: FACES, sight, seed });
            }
        }
    }
    for (k, (family, triangulation, noise, level)) in LARGE.into_iter().enumerate() {
        let seed = 10_000 + k as u64;
        let sight = Sight::Model(noise, level);
        cases.push(Case { family, triangulation, faces: SEEN_FACES, sight, seed });
    }
    cases
}

/// The noise of scans: that of a depth camera, at a level like the first Kinect's, noise that is
/// correlated over two edges, and the waves of fused views.
const SENSORS: [(NoiseKind, f64); 3] = [
    (NoiseKind::DepthCamera { camera: None, length: 5.0 }, 0.67),
    (NoiseKind::Correlated { length: 2.0 }, 0.2),
    (NoiseKind::Fused { length: 8.0 }, 0.5),
];

/// One view of a model of each family with each of these, and a whole model with the waves of fused
/// views, set by set.
pub fn scans() -> Vec<Case> {
    let mut cases = vec![];
    for set in Set::ALL {
        for family in Family::ALL.iter().copied().filter(|f| f.set() == set) {
            for (k, (noise, level)) in SENSORS.into_iter().enumerate() {
                // Fused views are seen as the depth camera sees them.
                let seed = 20_000 + 10 * (family as u64 + 1) + k as u64 % 2;
                let triangulation = Triangulation::Regular;
                let sight = Sight::View([110, 82], noise, level);
                cases.push(Case { family, triangulation, faces: SEEN_FACES, sight, seed });
            }
            let [.., (noise, level)] = SENSORS;
            let (seed, sight) = (20_005 + 10 * (family as u64 + 1), Sight::Model(noise, level));
            let triangulation = Triangulation::Irregular;
            cases.push(Case { family, triangulation, faces: FACES, sight, seed });
        }
    }
    cases
}

/// The number of faces of the surfaces of volumes.
const VOLUME_FACES: usize = 8000;

/// The noise of volumes: independent at the nodes of the grid, filtered as that of tomographs, of
/// all lengths as that of fused depth images, and independent and strong.
const VOLUMES: [(&str, &[Grain]); 4] = [
    ("independent", &[Grain { level: 0.1, length: 0.0 }]),
    ("filtered", &[Grain { level: 0.2, length: 1.5 }]),
    (
        "fused",
        &[
            Grain { level: 0.05, length: 0.0 },
            Grain { level: 0.15, length: 1.5 },
            Grain { level: 0.5, length: 5.0 },
        ],
    ),
    ("strong", &[Grain { level: 0.3, length: 0.0 }]),
];

/// The surface of a volume of a model of each family with each of these, set by set. Open and thin
/// models have no volume.
pub fn volumes() -> Vec<Case> {
    let mut cases = vec![];
    for set in Set::ALL {
        let open = [Family::Minimal, Family::Strokes];
        let is_solid = |f: &Family| f.kind() != Kind::Thin && !open.contains(f);
        for family in Family::ALL.iter().copied().filter(|f| f.set() == set && is_solid(f)) {
            for (k, (name, grains)) in VOLUMES.into_iter().enumerate() {
                let seed = 30_000 + 10 * (family as u64 + 1) + k as u64;
                let triangulation = Triangulation::Regular;
                let sight = Sight::Volume(name, grains);
                cases.push(Case { family, triangulation, faces: SEEN_FACES, sight, seed });
            }
        }
    }
    cases
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    #[test]
    fn every_set_has_every_kind_and_names_are_unique() {
        let all = cases();
        assert_eq!(all.len(), 241);
        let names: BTreeSet<String> = all.iter().map(Case::name).collect();
        assert_eq!(names.len(), all.len());
        for set in Set::ALL {
            for kind in Kind::ALL {
                let mine = all.iter().filter(|c| c.set() == set && c.family.kind() == kind);
                let families: BTreeSet<Family> = mine.map(|c| c.family).collect();
                assert!(families.len() >= 2, "{set} {kind}: {families:?}");
            }
            for &triangulation in &Triangulation::ALL {
                assert!(all.iter().any(|c| c.set() == set && c.triangulation == triangulation));
            }
        }
        for family in Family::ALL {
            assert!(all.iter().filter(|c| c.family == *family).count() >= 7, "{family}");
        }
    }

    /// Three views of each model, of the noise and level that the name says, and a whole one.
    #[test]
    fn scans_are_seen_and_noisy() {
        let all = scans();
        let names: BTreeSet<String> = all.iter().map(Case::name).collect();
        assert_eq!((all.len(), names.len()), (136, 136));
        let noise_of = |case: &Case| match case.sight {
            Sight::View(_, noise, level) | Sight::Model(noise, level) => (noise, level),
            Sight::Volume(..) => unreachable!("a scan is no volume"),
        };
        let (views, whole): (Vec<&Case>, Vec<&Case>) =
            all.iter().partition(|case| matches!(case.sight, Sight::View(..)));
        let (fused, others): (Vec<&Case>, Vec<&Case>) =
            views.iter().partition(|case| matches!(noise_of(case).0, NoiseKind::Fused { .. }));
        for case in others.iter().chain(&whole).step_by(11) {
            let (truth, noisy) = case.meshes().unwrap();
            assert_eq!(truth.faces(), noisy.faces());
            let least = if let Sight::View(..) = case.sight { 4000 } else { 3000 };
            assert!(truth.face_count() > least, "{}: {}", case.name(), truth.face_count());
            let pairs = truth.positions().iter().zip(noisy.positions());
            let sum: f64 = pairs.map(|(&p, &q)| DVec3::from(p).distance_squared(q.into())).sum();
            let level = (sum / truth.vertex_count() as f64).sqrt() / truth.mean_edge_length();
            assert!((level / noise_of(case).1 - 1.0).abs() < 0.1, "{}: {level}", case.name());
        }
        for (case, seen) in fused.iter().zip(others.iter().step_by(2)).step_by(11) {
            assert!(matches!(noise_of(seen).0, NoiseKind::DepthCamera { .. }));
            let ((truth, noisy), (same, _)) = (case.meshes().unwrap(), seen.meshes().unwrap());
            assert_eq!(truth, same, "{}", case.name());
            assert_ne!(truth, noisy, "{}", case.name());
        }
    }

    /// Every surface of a volume is closed, or almost: noise may tear it where the model is thin.
    #[test]
    fn surfaces_of_volumes_lie_at_their_truth() {
        let all = volumes();
        let names: BTreeSet<String> = all.iter().map(Case::name).collect();
        assert_eq!((all.len(), names.len()), (104, 104));
        for Case { family, seed, .. } in all.iter().step_by(4) {
            let model = family.mesh(FACES, Triangulation::Regular, *seed);
            assert!(model.topology().is_closed(), "{family}");
        }
        for case in all.iter().step_by(13) {
            let (truth, noisy) = case.meshes().unwrap();
            assert!(noisy.topology().is_closed(), "{}", case.name());
            assert!((6000..12_000).contains(&noisy.face_count()), "{}", case.name());
            assert_eq!(truth.faces(), noisy.faces());
            let pairs = truth.positions().iter().zip(noisy.positions());
            let sum: f64 = pairs.map(|(&p, &q)| DVec3::from(p).distance_squared(q.into())).sum();
            let level = (sum / truth.vertex_count() as f64).sqrt() / truth.mean_edge_length();
            assert!((0.05..1.0).contains(&level), "{}: {level}", case.name());
        }
    }
}
