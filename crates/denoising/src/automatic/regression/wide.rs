//! Means of noisy normals over wide regions that end at creases.

use fairing_mesh::vec3::{add, scale, sub};
use rayon::prelude::*;

use super::features::{State, WIDE};
use crate::faces::unit_or_zero;

/// For each mean: the range of differences between normals, the strength t, and the steps.
const MEANS: [(usize, f64, usize); WIDE] =
    [(0, 30.0, 24), (1, 30.0, 24), (0, 300.0, 64), (1, 300.0, 64)];

/// The least mass of a face, in mean areas: what keeps the system definite.
const LEAST_MASS: f64 = 1e-6;

/// The wide means at every face; zero where they cancel out.
///
/// Each is close to the solution x of `(M + t L) x = M n`: n the noisy normals, M the areas
/// times the trust in positions, L the Laplacian of the graph of faces whose weights are the
/// mean area of both faces times the similarity of their present normals. A mean reaches
/// `√t` faces far, less across a crease. Chebyshev's iteration from the present
/// normals, in a fixed number of steps, so that nothing depends on rounding.
pub(crate) fn wide_means(state: &State<'_>) -> [Vec<[f64; 3]>; WIDE] {
    MEANS.map(|(range, strength, steps)| wide_mean(state, range, strength, steps))
}

fn wide_mean(state: &State<'_>, range: usize, strength: f64, steps: usize) -> Vec<[f64; 3]> {
    let (noisy, areas) = (state.noisy, &state.current.areas);
    let count = areas.len();
    let least = LEAST_MASS * areas.iter().sum::<f64>() / count.max(1) as f64;
    let masses: Vec<f64> = areas
        .iter()
        .zip(state.trust)
        .map(|(a, t)| (a * t).max(least).max(f64::MIN_POSITIVE))
        .collect();
    let weights: Vec<f64> = (state.hinges.all.par_iter())
        .map(|hinge| {
            let [f, g] = hinge.faces.map(|f| f as usize);
            let (m, n) = (state.normals[f], state.normals[g]);
            if m == [0.0; 3] || n == [0.0; 3] {
                return 0.0;
            }
            let similarity = state.similarity(sub(m, n), range);
            0.5 * strength * (areas[f] + areas[g]) * similarity
        })
        .collect();
    let rows: Vec<[(u32, f64); 3]> = (0..count)
        .into_par_iter()
        .map(|f| {
            let (sides, beside) = (state.hinges.of_face[f], state.hinges.beside[f]);
            [0, 1, 2].map(|k| match weights.get(sides[k] as usize) {
                Some(&weight) => (beside[k], weight),
                None => (f as u32, 0.0),
            })
        })
        .collect();
    let inverse: Vec<f64> = (masses.iter().zip(&rows))
        .map(|(m, row)| 1.0 / (m + row.iter().map(|(_, w)| w).sum::<f64>()))
        .collect();
    // Scaled by the diagonal, eigenvalues are below 2. Those of faces of usual mass are above
    // the lower end; the iteration does not increase parts below it.
    let low = 1.0 / (1.0 + 3.0 * strength);
    let (middle, half) = (0.5 * (2.0 + low), 0.5 * (2.0 - low));
    let mut x = state.normals.to_vec();
    let mut step = vec![[0.0; 3]; count];
    let mut rho = half / middle;
    for k in 0..steps {
        let (turn, gain) = if k == 0 {
            (0.0, 1.0 / middle)
        } else {
            let next = 1.0 / (2.0 * middle / half - rho);
            let found = (next * rho, 2.0 * next / half);
            rho = next;
            found
        };
        step.par_iter_mut().enumerate().for_each(|(f, step)| {
            let target = scale(noisy.normals[f], noisy.areas[f] * state.trust[f]);
            let mut residual = sub(target, scale(x[f], masses[f]));
            for &(g, w) in &rows[f] {
                residual = add(residual, scale(sub(x[g as usize], x[f]), w));
            }
            *step = add(scale(*step, turn), scale(residual, gain * inverse[f]));
        });
        x.par_iter_mut().zip(&step).for_each(|(x, s)| *x = add(*x, *s));
    }
    x.into_par_iter().map(unit_or_zero).collect()
}

#[cfg(test)]
mod tests {
    use fairing_mesh::vec3::{distance, norm};
    use fairing_operators::noise_level;
    use fairing_shapes as shapes;

    use super::*;
    use crate::automatic::regression::Progress;
    use crate::faces::{FaceLists, FaceShapes, Hinges};

    /// A jittered cube: the wide means see each side as a plane, up to its borders, and the steps
    /// leave a tenth of the distance to the exact solution.
    #[test]
    fn wide_means_end_at_creases_and_solve_their_system() {
        let truth = shapes::cube(24, shapes::Diagonals::Alternating);
        let noisy = shapes::jittered(&truth, 0.1, 3, |p| p);
        let (hinges, rings) = (Hinges::new(&noisy), FaceLists::rings(&noisy));
        let progress = Progress::new(&noisy, &hinges, &rings, noise_level(&noisy).unwrap());
        let state = progress.state();
        let wanted = FaceShapes::new(&truth).normals;
        let far = |normals: &[[f64; 3]], to: &[[f64; 3]]| -> f64 {
            let sum: f64 = normals.iter().zip(to).map(|(&a, &b)| distance(a, b)).sum();
            sum / to.len() as f64
        };
        let start = far(&progress.normals, &wanted);
        for (range, strength, steps) in MEANS {
            let found = wide_mean(&state, range, strength, steps);
            assert!(found.iter().all(|&n| (norm(n) - 1.0).abs() < 1e-12));
            let exact = wide_mean(&state, range, strength, 3000);
            let (left, begun) = (far(&found, &exact), far(&progress.normals, &exact));
            assert!(left < 0.1 * begun, "{strength}: {left} of {begun}");
            let error = far(&found, &wanted);
            assert!(error < 0.7 * start, "{strength}: {error} of {start}");
        }
    }
}
