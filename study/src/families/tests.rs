//! Properties of every family.

use fairing_mesh::Diagnosis;
use glam::DVec3;
use rayon::prelude::*;

use super::*;

/// The smallest angle of all faces, in degrees.
fn smallest_angle(mesh: &TriMesh) -> (f64, usize) {
    let mut smallest = (f64::INFINITY, 0);
    for f in 0..mesh.face_count() {
        let t = mesh.triangle(f).map(DVec3::from);
        for k in 0..3 {
            let [u, v] = [1, 2].map(|j| t[(k + j) % 3] - t[k]);
            let angle = libm::atan2(u.cross(v).length(), u.dot(v)).to_degrees();
            if angle < smallest.0 {
                smallest = (angle, f);
            }
        }
    }
    smallest
}

/// The least angle of the triangles of each kind.
fn least(triangulation: Triangulation) -> f64 {
    match triangulation {
        Triangulation::Regular => 14.0,
        Triangulation::Irregular | Triangulation::Graded => 8.0,
        Triangulation::Anisotropic => 3.0,
    }
}

/// Every family in two triangulations, with a seed of its own each.
#[test]
fn all_are_clean() {
    let wrong: Vec<String> = Family::ALL
        .par_iter()
        .flat_map_iter(|&family| {
            (0..2).flat_map(move |k| {
                let index = family as usize + 2 * k;
                wrong(family, Triangulation::ALL[index % 4], 3 + 100 * index as u64)
            })
        })
        .collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Fresh families in every triangulation, with the number of faces that is asked for
/// within a tenth.
#[test]
fn fresh_ones_are_clean_in_every_triangulation() {
    let first = Family::House as usize;
    let wrong: Vec<String> = Family::ALL[first..]
        .par_iter()
        .flat_map_iter(|&family| {
            (0..8).flat_map(move |k| {
                let (triangulation, seed) = (Triangulation::ALL[k % 4], 7000 + 10 * k as u64);
                let mut wrong = wrong(family, triangulation, seed);
                let count = family.mesh(4000, triangulation, seed).face_count();
                if !(3600..=4400).contains(&count) {
                    wrong.push(format!("{family} {triangulation} {seed}: {count} faces"));
                }
                wrong
            })
        })
        .collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// The defects of a model.
fn wrong(family: Family, triangulation: Triangulation, seed: u64) -> Vec<String> {
    let name = format!("{family} {triangulation} {seed}");
    let mesh = family.mesh(2000, triangulation, seed);
    let d = Diagnosis::new(&mesh);
    let mut wrong = vec![];
    let closed = !matches!(
        family,
        Family::Minimal | Family::Strokes | Family::Cloth | Family::Shell | Family::Ruffle
    );
    if !d.is_clean() || d.components != 1 || d.closed != closed {
        wrong.push(format!("{name}: {d:?}"));
    }
    if d.volume.is_some_and(|v| v < 0.0) {
        wrong.push(format!("{name}: inside out"));
    }
    if !(1600..=2400).contains(&mesh.face_count()) {
        wrong.push(format!("{name}: {} faces", mesh.face_count()));
    }
    let (angle, face) = smallest_angle(&mesh);
    if angle < least(triangulation) {
        wrong.push(format!("{name}: {angle}° at {:?}", mesh.triangle(face)));
    }
    wrong
}

/// No shear flips a face; a seed always gives the same bytes.
#[test]
fn warped_bodies_keep_their_faces() {
    for seed in 0..12 {
        let mesh = Family::Gear.mesh(2200, Triangulation::Irregular, 3);
        let other = warped(&mesh, seed).unwrap();
        assert_eq!(other.faces(), mesh.faces());
        assert_eq!(other.positions(), warped(&mesh, seed).unwrap().positions());
        assert!(other.topology().is_closed());
        let diagnosis = Diagnosis::new(&other);
        assert_eq!(diagnosis.degenerate_faces.count, 0, "{seed}");
        // Stretched by two at most, and sheared.
        let ratio = other.signed_volume() / mesh.signed_volume();
        assert!((0.1..9.0).contains(&ratio), "{seed}: {ratio}");
    }
}

/// Details turn few faces over and leave none without area; a seed always gives the same bytes.
/// Most have details of the promised heights; on a part without vertices nothing moves.
#[test]
fn details_are_bounded() {
    let mesh = Family::Blob.mesh(4000, Triangulation::Regular, 3);
    let h = mesh.mean_edge_length();
    let mut moving = 0;
    for seed in 0..24 {
        let other = detailed(&mesh, seed).unwrap();
        assert_eq!(other.faces(), mesh.faces());
        assert_eq!(other.positions(), detailed(&mesh, seed).unwrap().positions());
        let pairs = mesh.positions().iter().zip(other.positions());
        let moved: Vec<f64> = pairs.map(|(&p, &q)| DVec3::from(p).distance(q.into())).collect();
        let farthest = moved.iter().copied().fold(0.0, f64::max);
        // A slope of 0.6 over 60 edges, at five deviations of a field, and two shorter layers.
        assert!(farthest < 80.0 * h, "{seed}: {} h", farthest / h);
        moving += usize::from(farthest > 1e-3 * h);
        let turned = (0..mesh.face_count())
            .filter(|&f| DVec3::from(mesh.area_vector(f)).dot(other.area_vector(f).into()) < 0.0)
            .count();
        assert!(turned * 50 < mesh.face_count(), "{seed}: {turned}");
        assert_eq!(Diagnosis::new(&other).degenerate_faces.count, 0, "{seed}");
    }
    assert!(moving >= 20, "{moving}");
}

/// Cut models have a border, and are otherwise the same.
#[test]
fn cut_models_have_a_border() {
    let mesh = Family::Blob.mesh(4000, Triangulation::Regular, 3);
    for seed in 0..24 {
        let part = cut(&mesh, seed).unwrap();
        let share = part.vertex_count() as f64 / mesh.vertex_count() as f64;
        assert!((0.2..0.75).contains(&share), "{seed}: {share}");
        assert!(!part.topology().is_closed());
        assert_eq!(part.topology().isolated_vertices().count(), 0);
        let corner = |mesh: &TriMesh, f: usize| mesh.triangle(f).map(|p| p.map(f64::to_bits));
        let all: std::collections::HashSet<_> =
            (0..mesh.face_count()).map(|f| corner(&mesh, f)).collect();
        assert!((0..part.face_count()).all(|f| all.contains(&corner(&part, f))));
        assert_eq!(part.positions(), cut(&mesh, seed).unwrap().positions());
    }
}

/// Meshes that cannot be warped: none of them panics.
#[test]
fn what_cannot_be_warped_is_stretched_or_an_error() {
    let point = TriMesh::new(vec![[1.0; 3]; 3], vec![[0, 1, 2]]).unwrap();
    let empty = TriMesh::new(vec![], vec![]).unwrap();
    let huge = TriMesh::new(vec![[4e29; 3], [-4e29; 3], [0.0; 3]], vec![[0, 1, 2]]).unwrap();
    for seed in 0..8 {
        assert!(warped(&point, seed).unwrap().positions().iter().flatten().all(|x| x.is_finite()));
        assert_eq!(detailed(&point, seed).unwrap().positions(), point.positions());
        assert_eq!(warped(&empty, seed).unwrap().vertex_count(), 0);
        for whole in [&point, &empty] {
            assert_eq!(cut(whole, seed).unwrap().positions(), whole.positions());
        }
        let _: Result<TriMesh, fairing_mesh::BuildError> = warped(&huge, seed);
    }
}

/// Every random model in every triangulation: a manifold without degenerate faces, of about the
/// size that was asked for, the right way out.
#[test]
fn random_bodies_are_clean() {
    let jobs: Vec<(RandomModel, u64)> =
        RandomModel::ALL.iter().flat_map(|&b| (0..8).map(move |k| (b, k))).collect();
    let wrong: Vec<String> = (jobs.into_par_iter())
        .filter_map(|(body, seed)| {
            let mesh = body.mesh(2500, Triangulation::ALL[seed as usize % 4], seed);
            let d = Diagnosis::new(&mesh);
            let open = matches!(
                body,
                RandomModel::Facets
                    | RandomModel::Swell
                    | RandomModel::Terraces
                    | RandomModel::Labyrinth
            );
            let good = d.degenerate_faces.count == 0
                && d.manifold
                && d.closed != open
                && d.volume.is_none_or(|v| v > 0.0)
                && (2000..=3000).contains(&mesh.face_count());
            (!good).then(|| format!("{body} {seed}: {} faces, {d:?}", mesh.face_count()))
        })
        .collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Walls are upright and tops level.
#[test]
fn terraces_are_right_angled() {
    for seed in 0..6 {
        let mesh = RandomModel::Terraces.mesh(3000, Triangulation::ALL[seed as usize % 4], seed);
        for f in 0..mesh.face_count() {
            let n = DVec3::from(mesh.area_vector(f)).normalize().to_array();
            let most = n.iter().fold(0.0f64, |m, x| m.max(x.abs()));
            assert!(most > 1.0 - 1e-12 && n[2] > -1e-6, "{seed}: {n:?}");
        }
    }
}

/// Two facets to a cell of the terrain, each with its own normal.
#[test]
fn facets_are_planes() {
    for seed in 0..4 {
        let mesh = RandomModel::Facets.mesh(3000, Triangulation::ALL[seed as usize], seed);
        assert!((2400..3600).contains(&mesh.face_count()), "{seed}: {}", mesh.face_count());
        let mut normals: Vec<[i64; 3]> = (0..mesh.face_count())
            .map(|f| {
                DVec3::from(mesh.area_vector(f))
                    .normalize()
                    .to_array()
                    .map(|x| libm::round(1e6 * x) as i64)
            })
            .collect();
        normals.sort_unstable();
        normals.dedup_by(|a, b| (0..3).all(|k| (a[k] - b[k]).abs() < 10));
        let cells = libm::sqrt(normals.len() as f64 / 2.0).round();
        assert_eq!(normals.len() as f64, 2.0 * cells * cells, "{seed}");
        assert!((2.0..=7.0).contains(&cells));
    }
}
