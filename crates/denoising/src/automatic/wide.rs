//! Means of noisy normals over wide regions that end at creases.

use fairing_watch::parallel;
use glam::{DVec3, Vec3A};

use super::features::{WIDE, WIDE_RANGES};
use super::state::State;
use crate::faces::NO_HINGE;

/// For each diffusion: the range of differences between normals, the strength t, and the steps.
const DIFFUSIONS: [(usize, f64, usize); 4] =
    [(0, 30.0, 24), (1, 30.0, 24), (0, 300.0, 64), (1, 300.0, 64)];

/// The first of the diffusions that are also sharpened.
const SHARPENED_FROM: usize = 2;

const _: () = {
    assert!(WIDE == 2 * DIFFUSIONS.len() - SHARPENED_FROM);
    let mut k = 0;
    while k < DIFFUSIONS.len() {
        assert!(WIDE_RANGES[k] == DIFFUSIONS[k].0);
        let sharpened = k + WIDE - DIFFUSIONS.len();
        assert!(k < SHARPENED_FROM || WIDE_RANGES[sharpened] == DIFFUSIONS[k].0);
        k += 1;
    }
};

/// The least number of faces for a thread: a step takes little time.
const MIN_FACES: usize = 2048;

/// The least mass of a face, in mean areas; keeps the system definite.
const MIN_MASS: f64 = 1e-6;

/// Returns the wide means at every face; zero where they cancel out.
///
/// Each diffusion is close to the solution x of `(M + t L) x = M n`: n the noisy normals, M the
/// areas times the trust in positions, L the Laplacian of the graph of faces whose weights are
/// the mean area of both faces times the similarity of their present normals. A mean reaches
/// `√t` faces far, less across a crease. The widest are also sharpened: x and the diffusion
/// of n − x, so that what varies slowly is kept to the second order in t.
pub(crate) fn wide_means(state: &State<'_>) -> [Vec<DVec3>; WIDE] {
    let units = |x: &[DVec3]| {
        parallel::map(x.len(), 64, |i| {
            let x = x[i];
            x.normalize_or_zero()
        })
    };
    let (mut plain, mut sharpened) = (vec![], vec![]);
    for (k, (range, strength, steps)) in DIFFUSIONS.into_iter().enumerate() {
        let diffusion = Diffusion::new(state, range, strength);
        let mut x = state.normals.to_vec();
        diffusion.solve(&mut x, steps);
        plain.push(units(&x));
        if k >= SHARPENED_FROM {
            diffusion.sharpen(&mut x, steps);
            sharpened.push(units(&x));
        }
    }
    plain.append(&mut sharpened);
    let mut all = plain.into_iter();
    std::array::from_fn(|_| all.next().unwrap_or_default())
}

/// The system of one diffusion, each row divided by its diagonal.
struct Diffusion {
    strength: f64,
    masses: Vec<f64>,
    /// The right-hand side.
    target: Vec<DVec3>,
    /// The face across each side, and t times the weight.
    rows: Vec<[(u32, f32); 3]>,
}

impl Diffusion {
    fn new(state: &State<'_>, range: usize, strength: f64) -> Self {
        let (noisy, areas) = (&state.noisy, &state.current.areas);
        let count = areas.len();
        let least = MIN_MASS * areas.iter().sum::<f64>() / count.max(1) as f64;
        let least = least.max(f64::MIN_POSITIVE);
        let weight = |f: usize, g: u32| {
            let Some(&n) = state.normals.get(g as usize) else { return 0.0 };
            if n == DVec3::ZERO || state.normals[f] == DVec3::ZERO {
                return 0.0;
            }
            let similarity = state.similarity(state.normals[f] - n, range);
            0.5 * strength * (areas[f] + areas[g as usize]) * similarity
        };
        let mut system = Self { strength, masses: vec![], target: vec![], rows: vec![] };
        let row = |f: usize| {
            let beside = state.hinges.beside[f];
            let weights = beside.map(|g| weight(f, g));
            let mass = (areas[f] * state.trust[f]).max(least);
            let inverse = 1.0 / (mass + weights.iter().sum::<f64>());
            let side = |k: usize| match beside[k] {
                NO_HINGE => (f as u32, 0.0),
                g => (g, (inverse * weights[k]) as f32),
            };
            let vector = noisy.areas[f] * state.trust[f] * noisy.normals[f];
            (inverse * mass, (inverse * vector, [0, 1, 2].map(side)))
        };
        (system.masses, (system.target, system.rows)) =
            parallel::map(count, 64, row).into_iter().unzip();
        system
    }

    /// Adds the diffusion of what x leaves of the noisy normals.
    fn sharpen(mut self, x: &mut [DVec3], steps: usize) {
        let masses = &self.masses;
        parallel::for_rows(&mut self.target, |f, target| {
            *target = 2.0 * *target - masses[f] * x[f];
        });
        self.solve(x, steps);
    }

    /// Chebyshev's iteration from x, in a fixed number of steps, so that nothing depends on
    /// rounding. The change of x is small where there is little noise, and in single precision.
    fn solve(&self, x: &mut [DVec3], steps: usize) {
        // Scaled by the diagonal, eigenvalues are below 2. Those of faces of usual mass are above
        // the lower end; the iteration does not increase parts below it.
        let low = 1.0 / (1.0 + 3.0 * self.strength);
        let (middle, half) = (0.5 * (2.0 + low), 0.5 * (2.0 - low));
        let start = |f: usize| {
            let mut residual = self.target[f] - self.masses[f] * x[f];
            for &(g, w) in &self.rows[f] {
                residual += f64::from(w) * (x[g as usize] - x[f]);
            }
            residual.as_vec3a()
        };
        let residuals: Vec<Vec3A> = parallel::map(x.len(), 64, start);
        let mut change = vec![Vec3A::ZERO; x.len()];
        let mut next = change.clone();
        let mut rho = half / middle;
        for k in 0..steps {
            let (turn, gain) = if k == 0 {
                (0.0, 1.0 / middle)
            } else {
                let smaller = 1.0 / (2.0 * middle / half - rho);
                let found = (smaller * rho, 2.0 * smaller / half);
                rho = smaller;
                found
            };
            let (turn, gain) = (turn as f32, gain as f32);
            // The next change replaces the one before the last.
            parallel::for_rows(&mut next, |f, next| {
                let now = change[f];
                let mut residual = residuals[f] - now;
                for &(g, w) in &self.rows[f] {
                    residual += w * change[g as usize];
                }
                *next = now + (turn * (now - *next) + gain * residual);
            });
            std::mem::swap(&mut change, &mut next);
        }
        parallel::for_rows(x, |f, x| *x += change[f].as_dvec3());
    }
}

#[cfg(test)]
mod tests {
    use fairing_shapes as shapes;
    use glam::DVec3;

    use super::*;
    use crate::faces::FaceShapes;
    use crate::noise_level;

    /// A jittered cube: the wide means see each side as a plane, up to its borders, and the steps
    /// leave a tenth of the distance to the exact solution.
    #[test]
    fn wide_means_end_at_creases_and_solve_their_system() {
        let truth = shapes::cube(24, shapes::Diagonals::Alternating);
        let noisy = shapes::jittered(&truth, 0.1, 3, |p| p);
        let state = State::new(&noisy, noise_level(&noisy).unwrap());
        let wanted = FaceShapes::new(&truth).normals;
        let far = |normals: &[DVec3], to: &[DVec3]| -> f64 {
            let sum: f64 = normals.iter().zip(to).map(|(&a, &b)| a.distance(b)).sum();
            sum / to.len() as f64
        };
        let start = far(&state.normals, &wanted);
        let all = wide_means(&state);
        for (k, (range, strength, steps)) in DIFFUSIONS.into_iter().enumerate() {
            let solved = |steps| {
                let mut x = state.normals.to_vec();
                Diffusion::new(&state, range, strength).solve(&mut x, steps);
                x.into_iter().map(DVec3::normalize_or_zero).collect::<Vec<_>>()
            };
            let found = solved(steps);
            assert!(found.iter().all(|&n| (n.length() - 1.0).abs() < 1e-12));
            assert_eq!(found, all[k]);
            let exact = solved(3000);
            let (left, begun) = (far(&found, &exact), far(&state.normals, &exact));
            assert!(left < 0.1 * begun, "{strength}: {left} of {begun}");
            let error = far(&found, &wanted);
            assert!(error < 0.7 * start, "{strength}: {error} of {start}");
        }
    }

    /// On a sphere with wide bumps the widest means leave 1 / (1 + x) of a bump of t times its
    /// eigenvalue = x, sharpened ones 1 − (x / (1 + x))²: the error is x / (1 + x) times as large,
    /// less than 0.9 for x below 9.
    #[test]
    fn sharpened_means_keep_what_is_curved() {
        let truth = shapes::bumpy_sphere(4, 0.1, 2.0);
        let noisy = shapes::jittered(&truth, 0.01, 3, |p| p);
        let state = State::new(&noisy, noise_level(&noisy).unwrap());
        let all = wide_means(&state);
        let wanted = FaceShapes::new(&truth).normals;
        let far = |normals: &[DVec3]| -> f64 {
            normals.iter().zip(&wanted).map(|(&a, &b)| a.distance(b)).sum()
        };
        for k in SHARPENED_FROM..DIFFUSIONS.len() {
            let (plain, sharpened) = (far(&all[k]), far(&all[k + WIDE - DIFFUSIONS.len()]));
            assert!(sharpened < 0.9 * plain, "{k}: {sharpened} of {plain}");
        }
    }
}
