//! Sizes, shapes and mixtures of parts at which formulas that are right on paper fail. Properties
//! of shape must not depend on its size, on the rest of the mesh or on the frame.

use fairing_denoising::{
    AutomaticOptions, Denoiser, SurfaceKind, automatic, noise_level, noisy_parts,
};
use fairing_evaluation::{
    NoiseKind, NoiseLevel, ScoreOptions, Scores, SurfaceTree, add_noise, drift, feature_edges,
    flipped_faces, hausdorff, normal_error, self_intersections, surface_distance,
    vertex_displacement,
};
use fairing_mesh::TriMesh;
use fairing_operators::curvature::{
    CotangentOptions, Estimator, FaceTensorOptions, MeanCurvature, cotangent_curvature,
    face_tensor_curvature, gaussian_curvature, mean_curvature, scaled_umbrella_mean_curvature,
    umbrella_mean_curvature,
};
use fairing_operators::intrinsic::robust_laplacian;
use fairing_operators::{
    LumpedArea, NormalWeight, cotan_stiffness, gradient, lumped_mass, weighted_vertex_normals,
};
use fairing_shapes as shapes;
use glam::DVec3;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Powers of two from one end of the range of extents to the other.
pub(crate) const EXPONENTS: [i32; 5] = [-97, -66, -20, 50, 97];

fn power(exponent: i32) -> f64 {
    2f64.powi(exponent)
}

fn mapped(mesh: &TriMesh, f: impl Fn([f64; 3]) -> [f64; 3]) -> TriMesh {
    mesh.with_positions(mesh.positions().iter().map(|&p| f(p)).collect()).unwrap()
}

pub(crate) fn scaled(mesh: &TriMesh, factor: f64) -> TriMesh {
    mapped(mesh, |p| p.map(|x| factor * x))
}

fn all_scaled(values: &[f64], factor: f64) -> Vec<f64> {
    values.iter().map(|x| x * factor).collect()
}

/// Several meshes in one, in their order.
fn union(meshes: &[TriMesh]) -> TriMesh {
    let (mut positions, mut faces) = (vec![], vec![]);
    for mesh in meshes {
        let first = positions.len() as u32;
        positions.extend_from_slice(mesh.positions());
        faces.extend(mesh.faces().iter().map(|f| f.map(|v| v + first)));
    }
    TriMesh::new(positions, faces).unwrap()
}

/// A rotation about an arbitrary axis.
pub(crate) fn turned(mesh: &TriMesh, angle: f64) -> TriMesh {
    let (s, c) = angle.sin_cos();
    let (t, d) = (1.3 * angle).sin_cos();
    mapped(mesh, |[x, y, z]| {
        let [x, y, z] = [c * x - s * y, s * x + c * y, z];
        [x, d * y - t * z, t * y + d * z]
    })
}

fn noisy(mesh: &TriMesh, share: f64, seed: u64) -> TriMesh {
    let kind = NoiseKind::GaussianAlongNormals;
    add_noise(mesh, kind, NoiseLevel::EdgeLengths(share), seed).unwrap()
}

/// Each is a fact about the shape, so that a power of two changes no bit of it.
#[test]
fn scores_do_not_depend_on_the_size() {
    let reference = shapes::cad_block(0.3);
    let mesh = noisy(&reference, 0.3, 4);
    let options = ScoreOptions::default();
    let expected = Scores::new(&mesh, &reference, &options).unwrap();
    let distances = surface_distance(&mesh, &reference).unwrap();
    let bounds = hausdorff(&mesh, &reference, 1e-3).unwrap();
    let normals = normal_error(&mesh, &reference).unwrap();
    for exponent in EXPONENTS {
        let unit = power(exponent);
        let (m, r) = (scaled(&mesh, unit), scaled(&reference, unit));
        let found = Scores::new(&m, &r, &options).unwrap();
        assert_eq!(found.entries(), expected.entries(), "2^{exponent}");
        assert_eq!(found.diagonal, expected.diagonal * unit);
        let d = surface_distance(&m, &r).unwrap();
        assert_eq!((d.max(), d.chamfer()), (distances.max() * unit, distances.chamfer() * unit));
        let h = hausdorff(&m, &r, 1e-3 * unit).unwrap();
        assert_eq!((h.lower, h.upper), (bounds.lower * unit, bounds.upper * unit));
        let n = normal_error(&m, &r).unwrap();
        assert_eq!((n.mean, n.max, n.worst), (normals.mean, normals.max, normals.worst));
        assert_eq!(drift(&m, &r), drift(&mesh, &reference));
        assert_eq!(flipped_faces(&m, &r), flipped_faces(&mesh, &reference));
        let moved = vertex_displacement(&m, &r).unwrap();
        let near = vertex_displacement(&mesh, &reference).unwrap();
        assert!((moved.rms / unit / near.rms - 1.0).abs() < 1e-14 && moved.max == near.max * unit);
        assert_eq!(feature_edges(&m, &r, 30.0), feature_edges(&mesh, &reference, 30.0));
        let query = [0.3, 0.2, 1.7];
        let closest = SurfaceTree::new(&mesh).unwrap().closest(query);
        let there = SurfaceTree::new(&m).unwrap().closest(query.map(|x| unit * x));
        assert_eq!((there.distance, there.face), (closest.distance * unit, closest.face));
    }
}

#[test]
fn crossings_do_not_depend_on_the_size() {
    let sphere = shapes::icosphere(1);
    let both = union(&[sphere.clone(), mapped(&sphere, |[x, y, z]| [x + 0.7, y + 0.11, z + 0.23])]);
    let expected = self_intersections(&both);
    assert!(expected > 20);
    for exponent in EXPONENTS {
        assert_eq!(self_intersections(&scaled(&both, power(exponent))), expected, "2^{exponent}");
    }
}

#[test]
fn curvatures_scale_to_the_last_bit() {
    let mesh =
        shapes::jittered(&shapes::torus(1.0, 0.4, 14, 8), 0.3, 2, shapes::onto_torus(1.0, 0.4));
    for estimator in Estimator::all() {
        let expected = estimator.estimate(&mesh).unwrap();
        for exponent in EXPONENTS {
            let unit = power(exponent);
            let found = estimator.estimate(&scaled(&mesh, unit)).unwrap();
            assert_eq!(found.status, expected.status, "{estimator} 2^{exponent}");
            assert_eq!(
                all_scaled(&found.kappa1, unit),
                expected.kappa1,
                "{estimator} 2^{exponent}"
            );
            assert_eq!(all_scaled(&found.kappa2, unit), expected.kappa2);
            assert_eq!(all_scaled(&found.mean, unit), expected.mean);
            assert_eq!(all_scaled(&all_scaled(&found.gaussian, unit), unit), expected.gaussian);
            assert_eq!(found.directions, expected.directions);
        }
    }
    let area = LumpedArea::Mixed;
    let gaussian = gaussian_curvature(&mesh, area).unwrap().values;
    let operators: [fn(&TriMesh) -> MeanCurvature; 3] =
        [umbrella_mean_curvature, scaled_umbrella_mean_curvature, |mesh| {
            mean_curvature(mesh, LumpedArea::Mixed).unwrap()
        }];
    for (k, estimate) in operators.iter().enumerate() {
        let expected = estimate(&mesh);
        for exponent in EXPONENTS {
            let (unit, there) = (power(exponent), scaled(&mesh, power(exponent)));
            let found = estimate(&there);
            let back = if k == 0 { 1.0 / unit } else { unit };
            assert_eq!(all_scaled(&found.signed, back), expected.signed, "{k} 2^{exponent}");
            let found = gaussian_curvature(&there, area).unwrap().values;
            assert_eq!(all_scaled(&all_scaled(&found, unit), unit), gaussian);
        }
    }
}

#[test]
fn operators_scale_to_the_last_bit() {
    let mesh = noisy(&shapes::icosphere(2), 0.1, 3);
    let stiffness = cotan_stiffness(&mesh).unwrap();
    let slopes = gradient(&mesh).unwrap();
    let robust = robust_laplacian(&mesh).unwrap();
    let level = noise_level(&mesh).unwrap();
    for exponent in EXPONENTS {
        let (unit, there) = (power(exponent), scaled(&mesh, power(exponent)));
        assert_eq!(cotan_stiffness(&there).unwrap(), stiffness, "2^{exponent}");
        assert_eq!(all_scaled(gradient(&there).unwrap().data(), unit), slopes.data());
        for area in [LumpedArea::Barycentric, LumpedArea::Voronoi, LumpedArea::Mixed] {
            let mass = lumped_mass(&there, area).unwrap();
            let back = all_scaled(&all_scaled(&mass, 1.0 / unit), 1.0 / unit);
            assert_eq!(back, lumped_mass(&mesh, area).unwrap(), "2^{exponent}");
        }
        let found = robust_laplacian(&there).unwrap();
        assert_eq!(found.stiffness, robust.stiffness, "2^{exponent}");
        assert_eq!(all_scaled(&all_scaled(&found.mass, 1.0 / unit), 1.0 / unit), robust.mass);
        let found = noise_level(&there).unwrap();
        assert_eq!((found.sigma, found.samples), (level.sigma * unit, level.samples));
        assert!((found.tail_ratio - level.tail_ratio).abs() < 1e-14);
        for weight in [NormalWeight::Area, NormalWeight::Angle, NormalWeight::Sphere] {
            let found = weighted_vertex_normals(&there, weight);
            let expected = weighted_vertex_normals(&mesh, weight);
            assert!(
                found.iter().zip(expected).all(|(&a, b)| DVec3::from(a).distance(b.into()) < 1e-14)
            );
        }
    }
}

/// The noise is removed at any size, and as at size one.
#[test]
fn denoisers_do_not_depend_on_the_size() {
    let mesh = noisy(&shapes::icosphere(2), 0.3, 6);
    for denoiser in Denoiser::all() {
        let expected = denoiser.denoise(&mesh).unwrap();
        assert!(vertex_displacement(&expected, &mesh).unwrap().rms > 1e-3, "{denoiser}");
        for exponent in [-97, 50, 97] {
            let there = denoiser.denoise(&scaled(&mesh, power(exponent))).unwrap();
            // Iterations end at tolerances in which some sizes are absolute.
            let gap = vertex_displacement(&scaled(&there, 1.0 / power(exponent)), &expected);
            assert!(gap.unwrap().max < 1e-9, "{denoiser} 2^{exponent}");
        }
    }
}

/// A doubled sheet has no volume to drift from, wherever rounding puts it.
#[test]
fn nothing_drifts_from_a_volume_of_rounding() {
    let sheet = shapes::jittered_plane(6, 6, 0.2, 1);
    let faces = sheet.faces().iter().copied();
    // Front and back are sewn at the border; vertices inside are doubled.
    let n = sheet.vertex_count() as u32;
    let border = |v: u32| sheet.topology().is_boundary_vertex(v);
    let back = faces.clone().map(|[a, b, c]| [a, c, b].map(|v| if border(v) { v } else { v + n }));
    let positions = [sheet.positions(), sheet.positions()].concat();
    let pillow = TriMesh::new(positions, faces.chain(back).collect()).unwrap();
    for turn in 0..30 {
        let flat =
            mapped(&turned(&pillow, f64::from(turn)), |[x, y, z]| [x + 1.0, y + 7.0, z - 2.0]);
        let full = noisy(&flat, 0.1, 3);
        assert_eq!(drift(&full, &flat).volume, None, "{}", flat.signed_volume());
        assert_eq!(drift(&flat, &full).volume.map(|x| (x + 1.0).abs() < 1e-9), Some(true));
    }
}

/// Vertices of this many columns in the plane and a face without area.
fn bad_face(at: [f64; 3], size: f64) -> TriMesh {
    let corner = |x: f64, y: f64| [at[0] + size * x, at[1] + size * y, at[2]];
    let positions = vec![corner(0.0, 0.0), corner(1.0, 0.0), corner(2.0, 0.0), corner(0.5, 1.0)];
    TriMesh::new(positions, vec![[0, 2, 1], [0, 1, 3]]).unwrap()
}

/// The operator of a part is that of the part alone, whatever else is there:
/// flat faces, points, parts of another size.
#[test]
fn parts_of_a_mesh_do_not_change_each_other() {
    let point = TriMesh::new(vec![[7.0; 3]; 3], vec![[0, 1, 2]]).unwrap();
    let small = scaled(&shapes::jittered(&shapes::icosphere(1), 0.3, 1, shapes::onto_sphere), 1e-6);
    let parts = [shapes::icosphere(2), bad_face([9.0, 0.0, 0.0], 4.0), small, point];
    let whole = robust_laplacian(&union(&parts)).unwrap();
    assert!(whole.mass.iter().all(|&m| m > 0.0));
    let mut first = 0;
    for part in &parts[..3] {
        let alone = robust_laplacian(part).unwrap();
        for (v, row) in alone.stiffness.outer_iterator().enumerate() {
            let found = whole.stiffness.outer_view(first + v).unwrap();
            assert_eq!(found.data(), row.data(), "{v} of {first}");
            assert_eq!(whole.mass[first + v], alone.mass[v]);
        }
        first += part.vertex_count();
    }
}

/// H of a small sphere beside a face without area in a part of its own is that
/// of a sphere of size one beside it, in its own unit.
#[test]
fn a_flat_face_far_away_does_not_bend_a_small_part() {
    let field_of = |radius: f64| {
        let small = scaled(&shapes::icosphere(2), radius);
        let mesh = union(&[small, bad_face([3.0, 0.0, 0.0], 1.0), shapes::icosphere(2)]);
        cotangent_curvature(&mesh, CotangentOptions::default()).unwrap()
    };
    let (expected, sphere) = (field_of(1.0), shapes::icosphere(2));
    for radius in [1e-3, 1e-5, 1e-8] {
        let field = field_of(radius);
        assert_eq!(field.too_thin, Some(sphere.face_count() as u32));
        for v in 0..sphere.vertex_count() {
            let found = field.mean[v] * radius;
            // Barycentric areas at the vertices of valence five are too small.
            assert!((found - 1.0).abs() < 0.15, "{radius} {found}");
            assert!((found - expected.mean[v]).abs() < 1e-12, "{radius} {found}");
        }
    }
    assert_eq!(cotangent_curvature(&sphere, CotangentOptions::default()).unwrap().too_thin, None);
}

/// A flat face in a part lengthens nothing beyond its neighbours.
#[test]
fn a_flat_face_changes_its_neighbourhood_only() {
    let sphere = shapes::icosphere(2);
    let [a, b, c] = sphere.faces()[0];
    // The first face reaches its side ab through a face without area.
    let mut positions = sphere.positions().to_vec();
    let middle = positions.len() as u32;
    let [p, q] = [a, b].map(|v| DVec3::from(positions[v as usize]));
    positions.push((0.5 * (p + q)).to_array());
    let mut faces = sphere.faces().to_vec();
    faces[0] = [a, middle, c];
    faces.extend([[middle, b, c], [a, b, middle]]);
    let mesh = TriMesh::new(positions, faces).unwrap();
    let (with, without) = (robust_laplacian(&mesh).unwrap(), robust_laplacian(&sphere).unwrap());
    // The face itself and those at its three sides, on both sides of the cover.
    assert!(with.mollified <= 8 && with.added_length > 0.0, "{}", with.mollified);
    let near = |v: u32| {
        [a, b, c].contains(&v)
            || sphere.topology().neighbors(v).iter().any(|w| [a, b, c].contains(w))
    };
    for v in (0..sphere.vertex_count() as u32).filter(|&v| !near(v)) {
        assert_eq!(with.mass[v as usize], without.mass[v as usize], "{v}");
    }
}

/// κ₁ = 1 and κ₂ = 0 however long the faces are, in any frame.
#[test]
fn fits_of_long_faces_are_determined_in_any_frame() {
    let (around, along) = (24u32, 9u32);
    for aspect in [1.0, 95.0, 950.0] {
        // Faces `aspect` times as long along the axis as around it, and back.
        for length in [0.26 * aspect, 0.26 / aspect] {
            let height = length * f64::from(along);
            let cylinder = shapes::cylinder(1.0, height, around, along, shapes::Ends::Open);
            for name in ["quadric", "jet2", "jet3"] {
                let estimator: Estimator = name.parse().unwrap();
                let expected = estimator.estimate(&cylinder).unwrap();
                let defined = expected.status.iter().filter(|s| s.is_defined()).count();
                assert_eq!(defined, cylinder.vertex_count(), "{name} {length}");
                for v in (0..expected.len()).filter(|&v| expected.is_interior(v as u32)) {
                    let [a, b] = [expected.kappa1[v], expected.kappa2[v]];
                    // Two or three rings of 15 degrees, one-sided near the ends.
                    // Where faces are short along the axis, what a polynomial
                    // misses around it is large beside the square of that length.
                    let right = (a - 1.0).abs() < 0.25 && b.abs() < 0.1;
                    assert!(right || length < 0.26, "{name} {length} {a} {b}");
                }
                for turn in 1..4 {
                    let mesh = turned(&cylinder, 0.7 * f64::from(turn));
                    let found = estimator.estimate(&mesh).unwrap();
                    assert_eq!(found.status, expected.status, "{name} {length} {turn}");
                    for v in 0..found.len() {
                        let gap = (found.kappa1[v] - expected.kappa1[v]).abs();
                        let size = 1.0 + expected.kappa1[v].abs() + expected.kappa2[v].abs();
                        // Heights rounded to ε of the long way, over the short one
                        // squared.
                        assert!(gap < 1e-7 * aspect * size, "{name} {length} {turn} {gap}");
                    }
                }
            }
        }
    }
}

/// The tip of a needle has the same tensor in any position.
#[test]
fn tensors_of_needles_do_not_depend_on_the_frame() {
    for height in [1e-3, 1e-6, 1e-8] {
        // A fan on the unit sphere with two vertices close to each other.
        let at = |t: f64, p: f64| [t.sin() * p.cos(), t.sin() * p.sin(), t.cos()];
        let mut positions = vec![at(0.0, 0.0), at(0.5, 0.0), at(0.5, height)];
        positions.extend([1.2, 2.9, 4.4].map(|p| at(0.5, p)));
        let faces = (1..6).map(|i| [0, i, i % 5 + 1]).collect();
        let fan = TriMesh::new(positions, faces).unwrap();
        let expected = face_tensor_curvature(&fan, FaceTensorOptions::default());
        for turn in 1..30 {
            let found =
                face_tensor_curvature(&turned(&fan, f64::from(turn)), FaceTensorOptions::default());
            for v in 0..6 {
                let gap = (found.kappa1[v] - expected.kappa1[v]).abs();
                // Rounding of the positions over the height of the needle.
                let limit = 1e-9 + 1e-14 / height;
                let size = expected.kappa1[v].abs() + expected.kappa2[v].abs();
                assert!(gap < limit * size, "{height} {turn} {v} {gap} {size}");
            }
        }
    }
}

/// A clean part beside a noisy one, of any size and curved or flat: the noise
/// of the one is measured and removed, and the other stays as it is.
#[test]
fn clean_parts_do_not_hide_noise() {
    let sphere = shapes::icosphere(3);
    let noise = noisy(&sphere, 0.2, 9);
    let alone = noise_level(&noise).unwrap();
    let alone_moved = automatic(&noise, &AutomaticOptions::default()).unwrap();
    let far = |mesh: &TriMesh| mapped(mesh, |[x, y, z]| [x + 5.0, y + 0.3, z - 0.2]);
    let clean = [
        far(&shapes::plane(10, 10, shapes::Diagonals::Regular)),
        far(&shapes::plane(60, 60, shapes::Diagonals::Alternating)),
        far(&turned(&shapes::jittered_plane(40, 40, 0.2, 2), 0.4)),
        far(&shapes::icosphere(4)),
    ];
    for (i, part) in clean.iter().enumerate() {
        let mesh = union(&[part.clone(), noise.clone()]);
        let found = noise_level(&mesh).unwrap();
        assert!((found.sigma / alone.sigma - 1.0).abs() < 1e-12, "{i}: {found:?} {alone:?}");
        let parts = noisy_parts(&mesh);
        assert_eq!((parts.len(), &parts[0].components[..]), (2, &[1][..]), "{i}");
        if i > 1 {
            continue;
        }
        let result = automatic(&mesh, &AutomaticOptions::default()).unwrap();
        assert_eq!(result.kind, alone_moved.kind);
        assert_ne!(result.kind, SurfaceKind::Clean);
        let (kept, moved) = result.mesh.positions().split_at(part.vertex_count());
        assert_eq!(kept, part.positions());
        assert_eq!(moved, alone_moved.mesh.positions());
    }
}

/// Random triangles on random points, many of them flat, doubled or turned.
pub(crate) fn soup(seed: u64) -> TriMesh {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let n = rng.random_range(8..30u32);
    let positions = (0..n)
        .map(|_| std::array::from_fn(|_| f64::from(rng.random_range(-4..5i32)) * 0.25))
        .collect();
    let mut faces: Vec<[u32; 3]> = vec![];
    while faces.len() < 2 * n as usize {
        let face: [u32; 3] = std::array::from_fn(|_| rng.random_range(0..n));
        if face[0] != face[1] && face[1] != face[2] && face[2] != face[0] {
            faces.push(face);
        }
    }
    TriMesh::new(positions, faces).unwrap()
}

/// Sound on any soup, at any size and far from the origin: positive masses, no
/// positive weight, rows that sum to zero; curvatures that are numbers.
#[test]
fn operators_on_soups_are_sound_at_any_size() {
    for seed in 0..60 {
        let soup = soup(seed);
        let placed = [
            soup.clone(),
            scaled(&soup, 1e-8),
            scaled(&soup, 1e8),
            scaled(&soup, 1e-29),
            turned(&soup, seed as f64),
            mapped(&soup, |[x, y, z]| [x + 1e6, y - 2e5, z + 3e6]),
        ];
        for (i, mesh) in placed.iter().enumerate() {
            let robust = robust_laplacian(mesh).unwrap();
            let largest = robust.stiffness.data().iter().fold(0.0, |m: f64, x| m.max(x.abs()));
            assert!(largest.is_finite(), "{seed} {i}");
            for (v, row) in robust.stiffness.outer_iterator().enumerate() {
                let isolated = mesh.incidence().corners(v as u32).is_empty();
                assert_eq!(robust.mass[v] > 0.0, !isolated, "{seed} {i} {v}");
                assert!(row.iter().map(|(_, s)| s).sum::<f64>().abs() < 1e-9 * (1.0 + largest));
                for (w, &s) in row.iter() {
                    assert!(v == w || s <= 1e-9 * (1.0 + largest), "{seed} {i} {v} {w} {s}");
                }
            }
            for estimator in Estimator::all() {
                let field = estimator.estimate(mesh).unwrap();
                let all = [&field.kappa1, &field.kappa2, &field.mean, &field.gaussian];
                assert!(all.into_iter().flatten().all(|x| x.is_finite()), "{estimator} {seed} {i}");
                for [a, b] in field
                    .directions
                    .iter()
                    .flat_map(|[a, b]| a.iter().zip(b))
                    .map(|(a, b)| [*a, *b])
                {
                    let (a, b) = (DVec3::from(a), DVec3::from(b));
                    let unit = a.length_squared().is_normal();
                    assert!(!unit || (a.length() - 1.0).abs() < 1e-9 && a.dot(b).abs() < 1e-9);
                }
            }
            if let Some(level) = noise_level(mesh) {
                assert!(level.sigma.is_finite() && level.sigma >= 0.0, "{seed} {i}");
            }
            let scores = Scores::new(mesh, &placed[0], &ScoreOptions::default()).unwrap();
            let values = scores.entries().into_iter().filter_map(|score| score.value.ok());
            assert!(values.into_iter().all(f64::is_finite), "{seed} {i}");
        }
    }
}
