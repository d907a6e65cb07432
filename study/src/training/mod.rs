//! Training of the denoiser's networks, stage after stage.

mod correlated;
mod fit;
mod gradient;
mod pairs;

use fairing_denoising::training::{Model, Network, Seen, State, advance, samples};
use fairing_denoising::{DenoiseError, noise_level};
use fairing_mesh::TriMesh;
use glam::DVec3;

use fit::{Random, fit};
use gradient::Lesson;

pub use correlated::correlated_pairs;
pub use pairs::training_pairs;

/// A mesh with noise, and without.
#[derive(Debug, Clone)]
pub struct TrainingPair {
    /// The mesh with noise.
    pub noisy: TriMesh,
    /// The same vertices and faces without noise.
    pub truth: TriMesh,
}

/// Length of a training.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TrainingOptions {
    /// Stages in a row.
    pub stages: usize,
    /// Networks of each stage, whose answers are averaged; they begin at other random numbers.
    pub members: usize,
    /// The faces that are drawn from each pair for each stage.
    pub faces_per_pair: usize,
    /// Passes over all drawn faces.
    pub epochs: usize,
    /// The bits of a weight in the file, from 2 to 12.
    pub bits: u32,
    /// The seed of all draws.
    pub seed: u64,
}

/// Trains the stages of [`automatic`](fairing_denoising::automatic) and returns the bytes of
/// their file. The loss is the mean over the pairs of the logarithm of the mean
/// chord between the regressed and the true normal. `say` receives a line after
/// each pass. The result has the same bits for any number of threads.
///
/// Pairs without a noise level are left out.
pub fn train_normals(
    pairs: &[TrainingPair],
    options: &TrainingOptions,
    mut say: impl FnMut(String),
) -> Result<Vec<u8>, DenoiseError> {
    let mut all: Vec<Course<'_>> = vec![];
    for TrainingPair { noisy, truth } in pairs {
        let Some(level) = noise_level(noisy).filter(|l| l.sigma > 0.0) else { continue };
        all.push(Course { state: State::new(noisy, level), normals: true_normals(truth) });
    }
    let mut random = Random(options.seed);
    let mut stages = vec![];
    for stage in 0..options.stages {
        let lessons = lessons(&all, options.faces_per_pair, &mut random);
        let networks: Vec<Network> = (0..options.members)
            .map(|member| {
                fit(&lessons, all.len(), options.epochs, &mut random, |epoch, loss| {
                    say(format!("stage {stage}, network {member}, pass {epoch}: {loss:.4}"));
                })
            })
            .collect();
        drop(lessons);
        // Nobody looks at what the last stage makes of the pairs.
        if stage + 1 < options.stages {
            for course in &mut all {
                advance(&mut course.state, &networks)?;
            }
        }
        stages.push(networks);
    }
    Ok(Model { stages, bits: options.bits, seed: options.seed }.write())
}

/// A pair between two stages.
struct Course<'a> {
    state: State<'a>,
    /// The true normals; zero for a face without area.
    normals: Vec<DVec3>,
}

fn true_normals(mesh: &TriMesh) -> Vec<DVec3> {
    (0..mesh.face_count()).map(|f| DVec3::from(mesh.area_vector(f)).normalize_or_zero()).collect()
}

/// Faces drawn from each pair.
fn lessons(all: &[Course<'_>], count: usize, random: &mut Random) -> Vec<Lesson> {
    let mut lessons = vec![];
    for (pair, Course { state, normals }) in all.iter().enumerate() {
        let mut faces: Vec<u32> = (0..normals.len() as u32).collect();
        random.shuffle(&mut faces, count);
        faces.truncate(count);
        faces.sort_unstable();
        for (found, &f) in samples(state, &faces).into_iter().zip(&faces) {
            let t = normals[f as usize];
            if let Some(Seen { sample, frame, .. }) = found
                && t != DVec3::ZERO
            {
                let target = frame.map(|e| e.dot(t) as f32);
                lessons.push(Lesson { sample, target, pair: pair as u32 });
            }
        }
    }
    lessons
}

#[cfg(test)]
mod tests {
    use fairing_shapes as shapes;

    use super::*;

    fn pair() -> TrainingPair {
        let truth = shapes::cube(8, shapes::Diagonals::Alternating);
        TrainingPair { noisy: shapes::jittered(&truth, 0.15, 3, |p| p), truth }
    }

    pub(super) fn some_lessons() -> Vec<Lesson> {
        let TrainingPair { noisy, truth } = pair();
        let state = State::new(&noisy, noise_level(&noisy).unwrap());
        lessons(&[Course { state, normals: true_normals(&truth) }], 40, &mut Random(1))
    }

    /// A few steps lower the loss, to the same bits on one thread and on three.
    #[test]
    fn training_does_not_depend_on_the_threads() {
        let options = TrainingOptions {
            stages: 1,
            members: 2,
            faces_per_pair: 300,
            epochs: 40,
            bits: 8,
            seed: 2,
        };
        let train = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let mut lines = vec![];
            let bytes = pool.install(|| train_normals(&[pair()], &options, |l| lines.push(l)));
            (bytes.unwrap(), lines)
        };
        let (one, three) = (train(1), train(3));
        assert!(one == three);
        let number = |line: &str| -> f64 { line.rsplit(' ').next().unwrap().parse().unwrap() };
        assert!(number(&one.1[39]) < 0.9 * number(&one.1[0]), "{:?}", one.1);
    }
}
