//! The cases.

use crate::families::{Family, Set, Triangulation};
use anyhow::Result;
use fairing_evaluation::{NoiseKind, NoiseLevel, add_noise};
use fairing_mesh::TriMesh;

/// A model with noise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Case {
    /// The family of the model.
    pub family: Family,
    /// The kind of triangulation.
    pub triangulation: Triangulation,
    /// The approximate number of faces.
    pub faces: usize,
    /// The kind of noise.
    pub noise: NoiseKind,
    /// The noise level, in mean edge lengths.
    pub level: f64,
    /// The seed of proportions, triangulation and noise.
    pub seed: u64,
}

impl Case {
    /// Its name in tables: family, triangulation, noise and level, and the number
    /// of faces of large ones.
    pub fn name(&self) -> String {
        let Self { family, triangulation, faces, noise, level, .. } = self;
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
        let truth = self.family.mesh(self.faces, self.triangulation, self.seed);
        let level = NoiseLevel::EdgeLengths(self.level);
        let noisy = add_noise(&truth, self.noise, level, self.seed)?;
        Ok((truth, noisy))
    }
}

/// The number of faces of most cases.
const FACES: usize = 4000;

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
                cases.push(Case { family, triangulation, faces: FACES, noise, level, seed });
            }
        }
    }
    for (k, (family, triangulation, noise, level)) in LARGE.into_iter().enumerate() {
        let seed = 10_000 + k as u64;
        cases.push(Case { family, triangulation, faces: 20_000, noise, level, seed });
    }
    cases
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use crate::families::Kind;

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
}
