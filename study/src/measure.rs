//! Comparison of a denoiser with the published methods, on one case and on many.

use std::fmt::Write as _;
use std::time::Instant;

use anyhow::{Context as _, Result, bail};
use fairing_evaluation::{SurfaceTree, drift, flipped_faces, normal_error, self_intersections};
use fairing_mesh::TriMesh;

use crate::table::Published;

/// Scores of a denoiser on one case.
#[derive(Debug, Clone, PartialEq)]
pub struct Found {
    /// The name of the case.
    pub case: String,
    /// E_a of the noisy mesh, in degrees.
    pub noisy: f64,
    /// E_a of the result.
    pub angle: f64,
    /// The least E_a of the published methods, tuned with the truth, and the
    /// method.
    pub best: Option<(f64, String)>,
    /// The least E_a of the published methods at their defaults.
    pub best_default: Option<f64>,
    /// The root mean square distance of the vertices from the true surface over
    /// that of the noisy ones.
    pub distance: f64,
    /// Flipped faces of the noisy mesh and of the result.
    pub flipped: [usize; 2],
    /// Self-intersections of the noisy mesh and of the result.
    pub intersections: [usize; 2],
    /// The relative differences of the volumes of the noisy mesh and of the result from that of the
    /// truth, for closed models.
    pub volume: Option<[f64; 2]>,
    /// The time, in seconds; zero where it is read from a table.
    pub seconds: f64,
}

/// Runs the denoiser on a case.
pub fn found(
    case: &str,
    truth: &TriMesh,
    noisy: &TriMesh,
    published: &Published,
    denoise: impl FnOnce(&TriMesh) -> Result<TriMesh>,
) -> Result<(Found, TriMesh)> {
    let start = Instant::now();
    let restored = denoise(noisy)?;
    let seconds = start.elapsed().as_secs_f64();
    let surface = SurfaceTree::new(truth)?;
    let distance = |mesh: &TriMesh| {
        let distances = surface.distances(mesh.positions());
        let sum: f64 = distances.iter().map(|d| d * d).sum();
        (sum / distances.len() as f64).sqrt()
    };
    let found = Found {
        case: case.to_string(),
        noisy: normal_error(noisy, truth)?.mean,
        angle: normal_error(&restored, truth)?.mean,
        best: best(case, published),
        best_default: best_default(case, published),
        distance: distance(&restored) / distance(noisy),
        flipped: [flipped_faces(noisy, truth)?, flipped_faces(&restored, truth)?],
        intersections: [noisy, &restored].map(self_intersections),
        volume: drift(noisy, truth)
            .volume
            .zip(drift(&restored, truth).volume)
            .map(<[f64; 2]>::from),
        seconds,
    };
    Ok((found, restored))
}

fn best(case: &str, published: &Published) -> Option<(f64, String)> {
    published.best(case).map(|e| (e.tuned, e.method.clone()))
}

fn best_default(case: &str, published: &Published) -> Option<f64> {
    published.entries(case).map(|e| e.default).min_by(f64::total_cmp)
}

impl Found {
    /// E_a over the best of the published methods.
    pub fn ratio(&self) -> Option<f64> {
        self.best.as_ref().map(|best| self.angle / best.0)
    }
}

const HEAD: &str =
    "case,noisy,angle,distance,flipped_noisy,flipped,crossings_noisy,crossings,volume_noisy,volume";

/// A table of results as text, without times and without what published
/// methods reach.
pub fn written(found: &[Found]) -> String {
    let mut text = format!("{HEAD}\n");
    for f in found {
        let volume = f.volume.map_or(",".to_owned(), |[n, v]| format!("{n:.5},{v:.5}"));
        let ([a, b], [c, d]) = (f.flipped, f.intersections);
        // Writing to a string never fails.
        let _ = writeln!(
            text,
            "{},{:.3},{:.3},{:.4},{a},{b},{c},{d},{volume}",
            f.case, f.noisy, f.angle, f.distance
        );
    }
    text
}

/// The table from its text.
pub fn read(text: &str, published: &Published) -> Result<Vec<Found>> {
    let mut lines = text.lines();
    if lines.next() != Some(HEAD) {
        bail!("the first line is not {HEAD:?}");
    }
    let lines = lines.enumerate();
    lines
        .map(|(k, line)| row(line, published).with_context(|| format!("line {}: {line:?}", k + 2)))
        .collect()
}

fn row(line: &str, published: &Published) -> Option<Found> {
    let [case, noisy, angle, distance, a, b, c, d, of_noisy, volume] =
        line.split(',').collect::<Vec<_>>().try_into().ok()?;
    Some(Found {
        case: case.to_string(),
        noisy: noisy.parse().ok()?,
        angle: angle.parse().ok()?,
        best: best(case, published),
        best_default: best_default(case, published),
        distance: distance.parse().ok()?,
        flipped: [a.parse().ok()?, b.parse().ok()?],
        intersections: [c.parse().ok()?, d.parse().ok()?],
        volume: match volume {
            "" => None,
            volume => Some([of_noisy.parse().ok()?, volume.parse().ok()?]),
        },
        seconds: 0.0,
    })
}

/// Many cases in a few numbers.
#[derive(Debug, Clone, PartialEq)]
pub struct Summary {
    /// The number of cases.
    pub cases: usize,
    /// The number of them that published results are known of.
    pub compared: usize,
    /// The median of the ratios to the best published result.
    pub median: Option<f64>,
    /// The largest of them.
    pub worst: Option<f64>,
    /// The number of cases with a ratio above 1.1.
    pub beyond_bar: usize,
    /// The number of cases with a larger E_a than a published method at its defaults.
    pub worse_than_default: usize,
    /// The number of cases with a larger E_a than the noisy mesh.
    pub worse_normals: usize,
    /// The number of cases whose vertices are farther from the truth than the
    /// noisy ones.
    pub worse_positions: usize,
    /// Flipped faces of the noisy meshes and of the results.
    pub flipped: [usize; 2],
    /// Cases with more than a tenth of the flipped faces of the noisy mesh.
    pub too_many_flipped: usize,
    /// Cases with more self-intersections than the noisy mesh.
    pub more_intersections: usize,
    /// The largest relative differences of a volume of a result from that of the truth, and
    /// from that of the noisy mesh.
    pub volume: [f64; 2],
    /// The time of all, in seconds.
    pub seconds: f64,
}

/// Sums up.
pub fn summary(found: &[Found]) -> Summary {
    let count = |is: &dyn Fn(&Found) -> bool| found.iter().filter(|f| is(f)).count();
    let mut ratios: Vec<f64> = found.iter().filter_map(Found::ratio).collect();
    ratios.sort_by(f64::total_cmp);
    let n = ratios.len();
    let median = (n > 0).then(|| 0.5 * (ratios[(n - 1) / 2] + ratios[n / 2]));
    Summary {
        cases: found.len(),
        compared: n,
        median,
        worst: ratios.last().copied(),
        beyond_bar: ratios.iter().filter(|r| **r > 1.1).count(),
        worse_than_default: count(&|f| f.best_default.is_some_and(|d| f.angle > d)),
        worse_normals: count(&|f| f.angle > f.noisy),
        worse_positions: count(&|f| f.distance > 1.0),
        flipped: [0, 1].map(|k| found.iter().map(|f| f.flipped[k]).sum()),
        too_many_flipped: count(&|f| 10 * f.flipped[1] > f.flipped[0]),
        more_intersections: count(&|f| f.intersections[1] > f.intersections[0]),
        volume: found.iter().filter_map(|f| f.volume).fold([0.0, 0.0], |[a, b], [noisy, v]| {
            [a.max(v.abs()), b.max(((1.0 + v) / (1.0 + noisy) - 1.0).abs())]
        }),
        seconds: found.iter().map(|f| f.seconds).sum(),
    }
}

#[cfg(test)]
mod tests {
    use fairing_evaluation::{NoiseKind, NoiseLevel, add_noise};

    use super::*;
    use crate::table::Entry;

    #[test]
    fn a_denoiser_is_compared_with_the_table() {
        let truth = fairing_shapes::icosphere(3);
        let level = NoiseLevel::EdgeLengths(0.3);
        let noisy = add_noise(&truth, NoiseKind::GaussianAlongNormals, level, 1).unwrap();
        let before = normal_error(&noisy, &truth).unwrap().mean;
        let mut published = Published::default();
        for (method, default, tuned) in [("a", before, 0.5 * before), ("b", 0.9 * before, before)] {
            let (case, method) = ("sphere".to_string(), method.to_string());
            published.insert(Entry { case, method, default, tuned, parameters: String::new() });
        }
        let idle = |mesh: &TriMesh| Ok(mesh.clone());
        let (none, _) = found("sphere", &truth, &noisy, &published, idle).unwrap();
        assert_eq!((none.ratio(), none.distance, none.angle), (Some(2.0), 1.0, before));
        assert_eq!(none.flipped[0], none.flipped[1]);
        let (all, _) = found("sphere", &truth, &noisy, &published, |_| Ok(truth.clone())).unwrap();
        assert_eq!(
            (all.ratio(), all.flipped[1], all.volume.map(|v| v[1])),
            (Some(0.0), 0, Some(0.0))
        );
        // Far from the truth.
        let away = |_: &TriMesh| {
            Ok(fairing_shapes::icosphere(3)
                .with_positions(truth.positions().iter().map(|p| p.map(|x| 2.0 * x)).collect())?)
        };
        let (away, _) = found("sphere", &truth, &noisy, &published, away).unwrap();
        for f in [&none, &all] {
            let again = read(&written(std::slice::from_ref(f)), &published).unwrap().remove(0);
            assert_eq!((again.flipped, again.best.clone()), (f.flipped, f.best.clone()));
            assert!((again.angle - f.angle).abs() <= 5e-4 && again.volume.is_some());
        }
        assert!(read(&format!("{HEAD}\nsphere,1"), &published).is_err());
        let sum = summary(&[none, all, away]);
        assert_eq!((sum.cases, sum.compared), (3, 3));
        assert_eq!((sum.median, sum.worst), (Some(0.0), Some(2.0)));
        assert_eq!((sum.beyond_bar, sum.worse_than_default, sum.worse_normals), (1, 1, 0));
        assert_eq!(sum.worse_positions, 1);
        assert!(
            (sum.volume[0] - 7.0).abs() < 1e-9 && (6.0..8.0).contains(&sum.volume[1]),
            "{:?}",
            sum.volume
        );
    }
}
