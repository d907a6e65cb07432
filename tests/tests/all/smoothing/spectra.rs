//! Every linear flow compared with its factors on the modes, for parameters from far too small to
//! far too large.
//!
//! The reference uses neither series nor solvers: a dense eigendecomposition of `M⁻¹S`, by Jacobi
//! rotations, on meshes of about forty vertices in three components, with each mode multiplied by
//! its factor. The factor of the eigenvalue zero is 1, which must leave the centroid of every
//! component in place.

use super::*;
use fairing_operators::{LumpedArea, combinatorial_laplacian, cotan_stiffness, lumped_mass};
use fairing_smoothing::{LowPass, Taubin, Transfer, low_pass, taubin};

/// The modes of `M⁻¹S` on the free vertices.
struct Modes {
    /// One eigenvalue per mode.
    omega: Vec<f64>,
    /// Rows are modes, orthonormal in the inner product of `M`.
    phi: Vec<Vec<f64>>,
    mass: Vec<f64>,
    /// The limit of an infinitely long flow: the harmonic function of the fixed vertices.
    limit: Vec<[f64; 3]>,
}

/// Eigenpairs of a symmetric matrix by cyclic Jacobi rotations; rows of the second are the vectors.
fn jacobi(mut a: Vec<Vec<f64>>) -> (Vec<f64>, Vec<Vec<f64>>) {
    let n = a.len();
    let mut v: Vec<Vec<f64>> =
        (0..n).map(|i| (0..n).map(|j| f64::from(u8::from(i == j))).collect()).collect();
    for _ in 0..30 {
        for p in 0..n {
            for q in p + 1..n {
                if a[p][q] == 0.0 {
                    continue;
                }
                let theta = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
                let t = theta.signum() / (theta.abs() + theta.hypot(1.0));
                let (c, s) = (1.0 / t.hypot(1.0), t / t.hypot(1.0));
                for k in 0..n {
                    let (x, y) = (a[k][p], a[k][q]);
                    (a[k][p], a[k][q]) = (c * x - s * y, s * x + c * y);
                }
                for k in 0..n {
                    let (x, y) = (a[p][k], a[q][k]);
                    (a[p][k], a[q][k]) = (c * x - s * y, s * x + c * y);
                    let (x, y) = (v[p][k], v[q][k]);
                    (v[p][k], v[q][k]) = (c * x - s * y, s * x + c * y);
                }
            }
        }
    }
    ((0..n).map(|i| a[i][i]).collect(), v)
}

impl Modes {
    fn new(mesh: &TriMesh, uniform: bool, fixed: &[usize]) -> Self {
        let n = mesh.vertex_count();
        let (s, mass) = if uniform {
            let s = combinatorial_laplacian(mesh).unwrap().to_dense();
            let degrees = (0..n).map(|i| s[[i, i]].max(1.0)).collect();
            (s, degrees)
        } else {
            let mass = lumped_mass(mesh, LumpedArea::Barycentric).unwrap();
            (cotan_stiffness(mesh).unwrap().to_dense(), mass)
        };
        let free: Vec<usize> = (0..n).filter(|i| !fixed.contains(i)).collect();
        let scaled = |&i: &usize| {
            free.iter().map(|&j| s[[i, j]] / (mass[i] * mass[j]).sqrt()).collect::<Vec<f64>>()
        };
        let (mut omega, vectors) = jacobi(free.iter().map(scaled).collect());
        let largest = omega.iter().copied().fold(0.0, f64::max);
        for omega in &mut omega {
            // Constants on the components, to rounding.
            if *omega < 1e-12 * largest {
                *omega = 0.0;
            }
        }
        let phi: Vec<Vec<f64>> = vectors
            .iter()
            .map(|v| {
                let mut row = vec![0.0; n];
                for (&i, v) in free.iter().zip(v) {
                    row[i] = v / mass[i].sqrt();
                }
                row
            })
            .collect();
        let mut limit = vec![[0.0; 3]; n];
        for &i in fixed {
            limit[i] = mesh.positions()[i];
        }
        // S_ff x = −S_fh x_h, mode by mode; constants on components without fixed vertices do not
        // contribute.
        let mut harmonic = limit.clone();
        for (omega, row) in omega.iter().zip(&phi).filter(|(omega, _)| **omega > 0.0) {
            for k in 0..3 {
                let side: f64 = free
                    .iter()
                    .map(|&i| -row[i] * fixed.iter().map(|&j| s[[i, j]] * limit[j][k]).sum::<f64>())
                    .sum();
                for (x, phi) in harmonic.iter_mut().zip(row) {
                    x[k] += phi * side / omega;
                }
            }
        }
        Self { omega, phi, mass, limit: harmonic }
    }

    /// Positions with every mode multiplied by its factor.
    fn filtered(&self, x: &[[f64; 3]], factor: impl Fn(f64) -> f64) -> Vec<[f64; 3]> {
        let mut y = self.limit.clone();
        for (omega, row) in self.omega.iter().zip(&self.phi) {
            let g = if *omega == 0.0 { 1.0 } else { factor(*omega) };
            for k in 0..3 {
                let amount: f64 = (0..x.len())
                    .map(|i| row[i] * self.mass[i] * (x[i][k] - self.limit[i][k]))
                    .sum();
                for (y, phi) in y.iter_mut().zip(row) {
                    y[k] += g * amount * phi;
                }
            }
        }
        y
    }
}

/// A bumpy closed blob, an open patch, and a small tetrahedron apart from both.
fn three_parts() -> TriMesh {
    let (blob, patch) =
        (shapes::bumpy_sphere(0, 0.3, 3.0), shapes::plane(4, 3, shapes::Diagonals::Alternating));
    let mut positions = blob.positions().to_vec();
    let mut faces = blob.faces().to_vec();
    let n = positions.len() as u32;
    positions.extend(
        patch
            .positions()
            .iter()
            .enumerate()
            .map(|(v, p)| [2.0 * p[0] + 3.0, p[1] - 1.0, 0.2 * (v as f64 * 2.4).sin() + 0.5]),
    );
    faces.extend(patch.faces().iter().map(|f| f.map(|v| v + n)));
    let n = positions.len() as u32;
    let corner = [-2.0, 3.0, 1.0];
    positions.extend(
        [[0.0; 3], [0.1, 0.0, 0.0], [0.0, 0.12, 0.0], [0.0, 0.02, 0.09]]
            .map(|p: [f64; 3]| [0, 1, 2].map(|k| p[k] + corner[k])),
    );
    faces.extend([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]].map(|f: [u32; 3]| f.map(|v| v + n)));
    TriMesh::new(positions, faces).unwrap()
}

/// The largest distance, relative to the size of the component of each vertex.
fn apart(mesh: &TriMesh, found: &TriMesh, expected: &[[f64; 3]]) -> f64 {
    let small = mesh.vertex_count() - 4;
    found
        .positions()
        .iter()
        .zip(expected)
        .enumerate()
        .map(|(i, (&p, &q))| distance(p, q) / if i < small { 2.0 } else { 0.15 })
        .fold(0.0, f64::max)
}

const LAMBDAS: [f64; 9] = [1e-3, 0.5, 5.0, 300.0, 1e4, 1e6, 1e9, 1e12, 1e15];

/// Implicit runs, at once and step by step, with and without fixed vertices.
#[test]
fn implicit_runs_of_any_length() {
    let mesh = three_parts();
    let h2 = mesh.mean_edge_length().powi(2);
    for (uniform, pinned) in
        [(true, vec![]), (false, vec![]), (true, vec![14, 20]), (false, vec![3, 30])]
    {
        let fixed: Vec<usize> = pinned.iter().map(|&v: &u32| v as usize).collect();
        let modes = Modes::new(&mesh, uniform, &fixed);
        for lambda in LAMBDAS {
            for steps in [1usize, 3, 10, 200] {
                let diffusion =
                    if uniform { Diffusion::uniform(lambda) } else { Diffusion::cotangent(lambda) };
                let t = if uniform { lambda } else { lambda * h2 };
                let factor = |omega: f64| (1.0 + t * omega).powf(-(steps as f64));
                let expected = modes.filtered(mesh.positions(), factor);
                let constraints = Constraints { pinned: pinned.clone(), ..Constraints::default() };
                let options =
                    Implicit { iterations: steps, constraints, ..Implicit::new(diffusion) };
                let at_once = implicit(&mesh, &options, None).unwrap();
                // Series to 2.1e-10 in a norm that weighs small vertices less; solves to 1e-8 in
                // each of the steps until the modes vanish.
                let off = apart(&mesh, &at_once.mesh, &expected);
                let what =
                    format!("uniform {uniform}, fixed {fixed:?}, λ = {lambda:e}, {steps} steps");
                assert!(off < 1e-7, "{what}: {off:e}, {:?}", at_once.report.approach);
                if steps <= 10 {
                    let mut go_on = |_: &fairing_smoothing::Step<'_>| ControlFlow::Continue(());
                    let stepwise = implicit(&mesh, &options, Some(&mut go_on)).unwrap();
                    let off = apart(&mesh, &stepwise.mesh, &expected);
                    assert!(off < 1e-7, "{what}, watched: {off:e}, {:?}", stepwise.report);
                    assert!(stepwise.report.worst_residual.unwrap() <= 1e-8, "{what}");
                }
            }
        }
    }
}

/// Explicit runs of up to ten million steps, and Taubin's pairs.
#[test]
fn explicit_runs_of_any_length() {
    let mesh = three_parts();
    let modes = Modes::new(&mesh, true, &[]);
    for lambda in [1e-3, 0.5, 0.9, 1.0] {
        for steps in [1usize, 2, 10, 200, 5000, 100_000, 3_000_000] {
            let expected =
                modes.filtered(mesh.positions(), |omega| (1.0 - lambda * omega).powi(steps as i32));
            let options =
                Explicit { iterations: steps, ..Explicit::new(Diffusion::uniform(lambda)) };
            let found = explicit(&mesh, &options, None).unwrap();
            // The tolerance of a series for each link of a chain; errors stop adding up once the
            // modes vanish.
            let off = apart(&mesh, &found.mesh, &expected);
            assert!(off < 1e-8, "λ = {lambda}, {steps} steps: {off:e}, {:?}", found.report);
        }
    }
    for pairs in [1usize, 2, 10, 200, 2000] {
        let factor = |omega: f64| ((1.0 - 0.3 * omega) * (1.0 + 0.301 * omega)).powi(pairs as i32);
        let expected = modes.filtered(mesh.positions(), factor);
        let options = Taubin { pairs, ..Taubin::from_steps(0.3, -0.301) };
        let found = taubin(&mesh, &options, None).unwrap();
        let off = apart(&mesh, &found.mesh, &expected);
        assert!(off < 1e-8, "{pairs} pairs: {off:e}, {:?}", found.report);
    }
}

/// Heat and Butterworth filters from wider than the spectrum to far narrower than its smallest
/// eigenvalue.
#[test]
fn filters_of_any_width() {
    let mesh = three_parts();
    for pinned in [vec![], vec![14u32, 33]] {
        let fixed: Vec<usize> = pinned.iter().map(|&v| v as usize).collect();
        let modes = Modes::new(&mesh, false, &fixed);
        let check = |transfer: Transfer, factor: &dyn Fn(f64) -> f64| {
            let constraints = Constraints { pinned: pinned.clone(), ..Constraints::default() };
            let options = LowPass { constraints, ..LowPass::new(transfer) };
            let found = low_pass(&mesh, &options).unwrap();
            let expected = modes.filtered(mesh.positions(), factor);
            // 2.1e-10 in the norm of the mass, which is 1e-3 of the whole at the least vertex.
            let off = apart(&mesh, &found.mesh, &expected);
            assert!(off < 1e-8, "{transfer:?}: {off:e}, {:?}", found.report);
            for &v in &fixed {
                assert_eq!(found.mesh.positions()[v], mesh.positions()[v], "{transfer:?}");
            }
        };
        for width in [1e-6, 1e-3, 0.1, 1.0, 30.0, 1e3, 1e5, 1e8, 1e12, 1e15] {
            check(Transfer::Heat(Time::SquaredUnits(width)), &|omega| (-width * omega).exp());
            for order in [1, 2, 5, 16] {
                let butterworth = Transfer::Butterworth { cutoff: 1.0 / width, order };
                check(butterworth, &|omega| 1.0 / (1.0 + (omega * width).powi(order as i32)));
            }
        }
    }
}
