//! The search for the best parameters of a method, with the truth.

use std::collections::HashMap;

use anyhow::Result;
use fairing_evaluation::normal_error;
use fairing_mesh::TriMesh;

use super::published::{Method, Setting};
use super::table::Entry;

/// The best parameters of the method on a noisy mesh whose truth is known:
/// from the defaults on, the parameters in turn are moved up or down as long as
/// the mean angle between normals E_a falls, until none of them helps or the
/// runs are used up.
///
/// # Errors
///
/// Those of the method; settings that fail are passed over, but for the
/// defaults.
pub fn tuned(case: &str, method: &Method, noisy: &TriMesh, truth: &TriMesh) -> Result<Entry> {
    let mut search = Search { method, noisy, truth, known: HashMap::new() };
    let start = method.defaults();
    let restored = method.run(noisy, &start)?;
    let default = normal_error(&restored, truth)?.mean;
    search.known.insert(start.clone(), default);
    let (mut at, mut best) = (start, default);
    loop {
        let before = best;
        for axis in 0..method.dimension() {
            for next in method.neighbours(&at, axis) {
                let mut from = at.clone();
                let mut to = next;
                let mut moved = false;
                while let Some(angle) = search.angle(&to).filter(|a| *a < best) {
                    (best, moved) = (angle, true);
                    at = to.clone();
                    let Some(further) = method.beyond(&from, &to, axis) else { break };
                    (from, to) = (to, further);
                }
                if moved {
                    break;
                }
            }
        }
        // A gain below a hundredth is not worth another round.
        if best > 0.99 * before || search.known.len() >= method.runs {
            return Ok(Entry {
                case: case.to_string(),
                method: method.denoiser.name().to_string(),
                default,
                tuned: best,
                parameters: method.text(&at),
            });
        }
    }
}

struct Search<'a> {
    method: &'a Method,
    noisy: &'a TriMesh,
    truth: &'a TriMesh,
    known: HashMap<Setting, f64>,
}

impl Search<'_> {
    /// E_a with this setting; `None` if the runs are used up or it fails.
    fn angle(&mut self, setting: &Setting) -> Option<f64> {
        if let Some(&angle) = self.known.get(setting) {
            return Some(angle);
        }
        if self.known.len() >= self.method.runs {
            return None;
        }
        let restored = self.method.run(self.noisy, setting).ok();
        let angle = restored.and_then(|mesh| normal_error(&mesh, self.truth).ok());
        let angle = angle.map_or(f64::INFINITY, |a| a.mean);
        self.known.insert(setting.clone(), angle);
        Some(angle)
    }
}

#[cfg(test)]
mod tests {
    use fairing_evaluation::{NoiseKind, NoiseLevel, add_noise};

    use super::*;

    /// On a sphere under strong noise the defaults of the bilateral filter of
    /// vertices, three iterations, leave most of it.
    #[test]
    fn the_search_finds_better_parameters_and_says_which() {
        let truth = fairing_shapes::icosphere(3);
        let level = NoiseLevel::EdgeLengths(0.3);
        let noisy = add_noise(&truth, NoiseKind::GaussianAlongNormals, level, 1).unwrap();
        let method = Method::named("bilateral").unwrap();
        let entry = tuned("sphere", &method, &noisy, &truth).unwrap();
        assert!(entry.tuned < 0.7 * entry.default, "{entry:?}");
        let again = method.run(&noisy, &method.parsed(&entry.parameters).unwrap()).unwrap();
        assert_eq!(normal_error(&again, &truth).unwrap().mean, entry.tuned);
    }
}
