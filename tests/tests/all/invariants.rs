//! Invariants of every mesh: sums, scaling, relabelling, rigid motion.

use std::f64::consts::TAU;

use fairing_mesh::TriMesh;
use fairing_operators::curvature::{Estimator, angle_defect, gaussian_curvature};
use fairing_operators::intrinsic::robust_laplacian;
use fairing_operators::{
    LumpedArea, SparseMatrix, combinatorial_laplacian, consistent_mass, cotan_stiffness,
    divergence, gradient, lumped_mass, random_walk_laplacian, vertex_normals,
};
use fairing_shapes as shapes;
use glam::DVec3;
use proptest::prelude::*;

/// Sphere, torus, open cylinder, Möbius band, flower, block: closed, with handles, open, one-sided,
/// irregular, sharp; each randomly deformed.
fn meshes() -> impl Strategy<Value = TriMesh> {
    (0..6usize, 0.0..0.12f64, any::<u64>()).prop_map(|(kind, amount, seed)| {
        let mesh = match kind {
            0 => shapes::icosphere(2),
            1 => shapes::torus(1.0, 0.4, 14, 8),
            2 => shapes::cylinder(1.0, 2.0, 12, 6, shapes::Ends::Open),
            3 => shapes::moebius(0.4, 24, 3),
            4 => shapes::flower(0.2, 3),
            _ => shapes::cad_block(0.25),
        };
        // A smooth deformation, so no face collapses.
        let phase = (seed % 1000) as f64;
        let positions = mesh
            .positions()
            .iter()
            .map(|p| {
                let bend = |k: usize| amount * (3.0 * p[(k + 1) % 3] + phase + k as f64).sin();
                [p[0] + bend(0), p[1] + bend(1), p[2] + bend(2)]
            })
            .collect();
        mesh.with_positions(positions).unwrap()
    })
}

/// A rotation about a random axis.
fn turned(mesh: &TriMesh, axis: [f64; 3], angle: f64, shift: [f64; 3]) -> TriMesh {
    let (s, c) = angle.sin_cos();
    let (axis, shift) = (DVec3::from(axis), DVec3::from(shift));
    let turn = |p: DVec3| {
        let along = axis * (axis.dot(p) * (1.0 - c));
        c * p + s * axis.cross(p) + along + shift
    };
    mesh.with_positions(mesh.positions().iter().map(|&p| turn(p.into()).to_array()).collect())
        .unwrap()
}

fn axes() -> impl Strategy<Value = [f64; 3]> {
    prop::array::uniform3(-1.0..1.0f64)
        .prop_filter_map("a direction", |axis| Some(DVec3::from(axis).try_normalize()?.to_array()))
}

/// The largest entry of the difference, relative to the largest entry.
fn gap(a: &SparseMatrix, b: &SparseMatrix) -> f64 {
    assert_eq!((a.indptr(), a.indices()), (b.indptr(), b.indices()));
    let largest = a.data().iter().fold(0.0, |m: f64, x| m.max(x.abs()));
    a.data().iter().zip(b.data()).fold(0.0, |m: f64, (x, y)| m.max((x - y).abs())) / largest
}

fn largest_row_sum(m: &SparseMatrix) -> f64 {
    m.outer_iterator().map(|row| row.data().iter().sum::<f64>().abs()).fold(0.0, f64::max)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]

    #[test]
    fn gauss_bonnet(mesh in meshes()) {
        let total: f64 = angle_defect(&mesh).iter().sum();
        let expected = TAU * mesh.topology().euler_characteristic() as f64;
        // One rounding of order 2π for each of the thousand vertices.
        prop_assert!((total - expected).abs() < 1e-10, "{total} {expected}");
    }

    #[test]
    fn areas_sum_to_the_area(mesh in meshes()) {
        let area: f64 = (0..mesh.face_count()).map(|f| mesh.face_area(f)).sum();
        for kind in [LumpedArea::Barycentric, LumpedArea::Voronoi, LumpedArea::Mixed] {
            let mass = lumped_mass(&mesh, kind).unwrap();
            prop_assert!((mass.iter().sum::<f64>() - area).abs() < 1e-12 * area);
            if kind != LumpedArea::Voronoi {
                prop_assert!(mass.iter().all(|&m| m > 0.0));
            }
        }
        let consistent: f64 = consistent_mass(&mesh).unwrap().data().iter().sum();
        prop_assert!((consistent - area).abs() < 1e-12 * area);
    }

    #[test]
    fn matrices_are_symmetric_with_zero_row_sums(mesh in meshes()) {
        let s = cotan_stiffness(&mesh).unwrap();
        for m in [&s, &combinatorial_laplacian(&mesh).unwrap(), &consistent_mass(&mesh).unwrap()] {
            prop_assert_eq!(m.transpose_view().to_csr(), m.clone());
        }
        prop_assert!(largest_row_sum(&s) < 1e-11);
        prop_assert!(largest_row_sum(&combinatorial_laplacian(&mesh).unwrap()) == 0.0);
        prop_assert!(largest_row_sum(&random_walk_laplacian(&mesh).unwrap()) < 1e-14);
    }

    /// ∫ ∇x·∇x + ∇y·∇y + ∇z·∇z = 2 area: each tangent direction contributes once.
    #[test]
    fn the_energy_of_the_positions_is_twice_the_area(mesh in meshes()) {
        let s = cotan_stiffness(&mesh).unwrap();
        let mut energy = 0.0;
        for axis in 0..3 {
            let x: ndarray::Array1<f64> = mesh.positions().iter().map(|p| p[axis]).collect();
            energy += x.dot(&(&s * &x));
        }
        let area: f64 = (0..mesh.face_count()).map(|f| mesh.face_area(f)).sum();
        prop_assert!((energy - 2.0 * area).abs() < 1e-11 * area);
    }

    #[test]
    fn stiffness_is_divergence_of_gradient(mesh in meshes()) {
        let product = &divergence(&mesh).unwrap() * &gradient(&mesh).unwrap();
        let s = cotan_stiffness(&mesh).unwrap();
        for (i, row) in product.outer_iterator().enumerate() {
            for (j, &x) in row.iter() {
                let found = s.get(i, j).copied().unwrap_or(0.0);
                prop_assert!((x + found).abs() < 1e-11, "{i} {j} {x} {found}");
            }
        }
    }

    #[test]
    fn scaling_does_what_the_units_say(mesh in meshes(), factor in 0.01..100.0f64) {
        let scaled = mesh.with_positions(mesh.positions().iter().map(|p| p.map(|x| factor * x)).collect());
        let scaled = scaled.unwrap();
        prop_assert!(gap(&cotan_stiffness(&mesh).unwrap(), &cotan_stiffness(&scaled).unwrap()) < 1e-12);
        for kind in [LumpedArea::Barycentric, LumpedArea::Voronoi, LumpedArea::Mixed] {
            let (a, b) = (lumped_mass(&mesh, kind).unwrap(), lumped_mass(&scaled, kind).unwrap());
            let total: f64 = b.iter().sum();
            for (a, b) in a.iter().zip(b) {
                prop_assert!((a * factor * factor - b).abs() < 1e-12 * total);
            }
        }
        for estimator in Estimator::all() {
            let (a, b) = (estimator.estimate(&mesh).unwrap(), estimator.estimate(&scaled).unwrap());
            let size = a.kappa1.iter().chain(&a.kappa2).fold(0.0, |m: f64, k| m.max(k.abs()));
            prop_assert_eq!(&a.status, &b.status);
            for v in 0..a.len() {
                // Normal equations square the condition number of a fit.
                let values = [a.kappa1[v], factor * b.kappa1[v]];
                prop_assert!((values[0] - values[1]).abs() < 1e-6 * size, "{estimator} {v} {values:?} {size}");
                prop_assert!((a.gaussian[v] - factor * factor * b.gaussian[v]).abs() < 1e-6 * size * size);
            }
        }
    }

    #[test]
    fn rigid_motion_changes_nothing(
        mesh in meshes(),
        axis in axes(),
        angle in -3.0..3.0f64,
        shift in prop::array::uniform3(-5.0..5.0f64),
    ) {
        let moved = turned(&mesh, axis, angle, shift);
        prop_assert!(gap(&cotan_stiffness(&mesh).unwrap(), &cotan_stiffness(&moved).unwrap()) < 1e-11);
        for (a, b) in vertex_normals(&mesh).into_iter().zip(vertex_normals(&moved)) {
            let there = turned(&mesh.with_positions(vec![a; mesh.vertex_count()]).unwrap(), axis, angle, [0.0; 3]);
            prop_assert!(DVec3::from(there.positions()[0]).dot(b.into()) > 1.0 - 1e-12);
        }
        for estimator in Estimator::all() {
            let (a, b) = (estimator.estimate(&mesh).unwrap(), estimator.estimate(&moved).unwrap());
            let size = a.kappa1.iter().chain(&a.kappa2).fold(0.0, |m: f64, k| m.max(k.abs()));
            for v in 0..a.len() {
                prop_assert!((a.mean[v] - b.mean[v]).abs() < 1e-6 * size, "{estimator} {v}");
            }
        }
    }

    /// Permuted vertices and faces give the permuted values. The cut along which the faces of a
    /// one-sided part disagree depends on their order, and so does curvature near it.
    #[test]
    fn relabelling_relabels(mesh in meshes(), seed in any::<u64>()) {
        let n = mesh.vertex_count();
        let mut order: Vec<u32> = (0..n as u32).collect();
        let mut state = seed | 1;
        for i in (1..n).rev() {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            order.swap(i, (state >> 33) as usize % (i + 1));
        }
        let mut positions = vec![[0.0; 3]; n];
        for (v, &to) in order.iter().enumerate() {
            positions[to as usize] = mesh.positions()[v];
        }
        let faces = mesh.faces().iter().rev().map(|&[a, b, c]| [b, c, a].map(|v| order[v as usize]));
        let other = TriMesh::new(positions, faces.collect()).unwrap();
        let (s, t) = (cotan_stiffness(&mesh).unwrap(), cotan_stiffness(&other).unwrap());
        for (i, row) in s.outer_iterator().enumerate() {
            for (j, &x) in row.iter() {
                let y = *t.get(order[i] as usize, order[j] as usize).unwrap();
                prop_assert!((x - y).abs() < 1e-11);
            }
        }
        for estimator in Estimator::all() {
            let (a, b) = (estimator.estimate(&mesh).unwrap(), estimator.estimate(&other).unwrap());
            let size = a.kappa1.iter().chain(&a.kappa2).fold(0.0, |m: f64, k| m.max(k.abs()));
            for (v, &to) in order.iter().enumerate() {
                let same = (a.kappa1[v] - b.kappa1[to as usize]).abs() < 1e-6 * size;
                prop_assert!(same || !mesh.one_sided_faces().is_empty(), "{estimator}");
                prop_assert_eq!(a.boundary[v], b.boundary[to as usize]);
            }
        }
    }

    /// Flipping all faces changes all signs except that of K, and none on a one-sided part, where H
    /// is not negative from either side.
    #[test]
    fn the_inside_out_mesh_bends_the_other_way(mesh in meshes()) {
        let faces = mesh.faces().iter().map(|&[a, b, c]| [a, c, b]).collect();
        let inside_out = TriMesh::new(mesh.positions().to_vec(), faces).unwrap();
        let one_sided = !mesh.one_sided_faces().is_empty();
        for estimator in Estimator::all() {
            let (a, b) = (estimator.estimate(&mesh).unwrap(), estimator.estimate(&inside_out).unwrap());
            let size = a.kappa1.iter().chain(&a.kappa2).fold(0.0, |m: f64, k| m.max(k.abs()));
            for v in 0..a.len() {
                let turned = (a.kappa1[v] + b.kappa2[v]).abs() < 1e-6 * size;
                let same = (a.kappa1[v] - b.kappa1[v]).abs() < 1e-6 * size;
                let flat = (a.kappa1[v] + a.kappa2[v]).abs() < 1e-6 * size;
                let is_odd = if one_sided { same || flat } else { turned };
                let values = [a.kappa1[v], a.kappa2[v], b.kappa1[v], b.kappa2[v]];
                prop_assert!(is_odd, "{estimator} {v} {one_sided} {values:?} {size}");
                prop_assert!((a.gaussian[v] - b.gaussian[v]).abs() < 1e-6 * size * size);
            }
        }
    }

    /// The intrinsic operators keep the properties of the plain ones and add a sign condition.
    #[test]
    fn robust_operators_are_sound(mesh in meshes()) {
        let robust = robust_laplacian(&mesh).unwrap();
        let area: f64 = (0..mesh.face_count()).map(|f| mesh.face_area(f)).sum();
        prop_assert!((robust.mass.iter().sum::<f64>() - area).abs() < 1e-10 * area);
        prop_assert!(largest_row_sum(&robust.stiffness) < 1e-10);
        prop_assert_eq!(robust.stuck, 0);
        for (i, row) in robust.stiffness.outer_iterator().enumerate() {
            for (j, &s) in row.iter() {
                prop_assert!(i == j || s <= 1e-9, "{i} {j} {s}");
            }
        }
    }
}

/// Bitwise equal results for any number of threads.
#[test]
fn threads_do_not_matter() {
    let mesh = shapes::jittered(&shapes::icosphere(5), 0.3, 1, shapes::onto_sphere);
    let run = || {
        let fields =
            Estimator::all().iter().map(|e| e.estimate(&mesh).unwrap()).collect::<Vec<_>>();
        let k = gaussian_curvature(&mesh, LumpedArea::Mixed).unwrap();
        (cotan_stiffness(&mesh).unwrap(), consistent_mass(&mesh).unwrap(), fields, k)
    };
    let one = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap().install(run);
    let five = rayon::ThreadPoolBuilder::new().num_threads(5).build().unwrap().install(run);
    assert!(one == five);
}
