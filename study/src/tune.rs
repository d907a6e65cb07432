//! The search for the best parameters of a method, with the truth.

use std::collections::HashMap;

use anyhow::Result;
use fairing_evaluation::normal_error;
use fairing_mesh::TriMesh;

use crate::published::{Method, Setting};
use crate::table::Entry;

/// The best parameters of the method on a noisy mesh whose truth is known.
///
/// From the defaults on, the parameters in turn are moved up or down as long as
/// the mean angle between normals E_a falls, until none of them helps or the
/// runs are used up; likewise from the other starts of the method.
///
/// # Errors
///
/// The errors of the method with its defaults; other settings that fail are skipped.
pub fn tuned(case: &str, method: &Method, noisy: &TriMesh, truth: &TriMesh) -> Result<Entry> {
    let restored = method.run(noisy, &method.defaults())?;
    let default = normal_error(&restored, truth)?.mean;
    let known = HashMap::from([(method.defaults(), default)]);
    let mut search = Search { method, noisy, truth, known, limit: 0 };
    let mut best = (default, method.defaults());
    for start in method.starts() {
        search.limit += method.runs;
        let found = search.descend(start);
        if found.0 < best.0 {
            best = found;
        }
    }
    Ok(Entry {
        case: case.to_string(),
        method: method.denoiser.name().to_string(),
        default,
        tuned: best.0,
        parameters: method.text(&best.1),
    })
}

struct Search<'a> {
    method: &'a Method,
    noisy: &'a TriMesh,
    truth: &'a TriMesh,
    known: HashMap<Setting, f64>,
    /// The largest number of settings to try.
    limit: usize,
}

impl Search<'_> {
    /// The best setting found from this one on.
    fn descend(&mut self, start: Setting) -> (f64, Setting) {
        let mut best = (self.angle(&start).unwrap_or(f64::INFINITY), start);
        loop {
            let before = best.0;
            for axis in 0..self.method.dimension() {
                for next in self.method.neighbours(&best.1, axis) {
                    if self.follow(&mut best, next, axis) {
                        break;
                    }
                }
            }
            // A gain below a hundredth is not worth another round.
            if best.0 > 0.99 * before || self.known.len() >= self.limit {
                return best;
            }
        }
    }

    /// Goes on from the best setting to `to` and further as long as that helps,
    /// and says whether it did.
    fn follow(&mut self, best: &mut (f64, Setting), mut to: Setting, axis: usize) -> bool {
        let mut helped = false;
        while let Some(angle) = self.angle(&to).filter(|a| *a < best.0) {
            let from = std::mem::replace(best, (angle, to)).1;
            helped = true;
            let Some(further) = self.method.beyond(&from, &best.1, axis) else { break };
            to = further;
        }
        helped
    }

    /// E_a with this setting; `None` if the runs are used up.
    fn angle(&mut self, setting: &Setting) -> Option<f64> {
        if let Some(&angle) = self.known.get(setting) {
            return Some(angle);
        }
        if self.known.len() >= self.limit {
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
