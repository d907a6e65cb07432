//! Operators and denoisers at every size, on random meshes, and in other frames.

use fairing_denoising::{AutomaticOptions, Denoiser, update_vertices};
use fairing_evaluation::{NoiseKind, NoiseLevel, add_noise};
use fairing_mesh::{PolygonMesh, TriMesh};
use fairing_operators::{
    SparseMatrix, consistent_mass, divergence, face_gradients, face_normals, gradient,
    polygon_laplacian,
};
use fairing_shapes as shapes;
use fairing_spectral::HeatGeodesics;
use glam::DVec3;

use crate::extremes::{EXPONENTS, scaled, soup, turned};

fn noisy(mesh: &TriMesh, share: f64) -> TriMesh {
    add_noise(mesh, NoiseKind::GaussianPerAxis, NoiseLevel::EdgeLengths(share), 5).unwrap()
}

/// The entries of a matrix times a power of two, which rounds nothing.
fn times(matrix: &SparseMatrix, factors: [f64; 2]) -> SparseMatrix {
    matrix.map(|x| x * factors[0] * factors[1])
}

#[test]
fn operators_follow_their_units_at_every_size() {
    let mesh = shapes::bumpy_sphere(2, 0.2, 5.0);
    let polygons = |unit: f64| {
        let p =
            [[0.0, 0.0, 0.1], [2.0, 0.1, 0.0], [2.5, 1.0, 0.2], [1.0, 2.0, 0.0], [-0.3, 1.1, 0.3]];
        let positions = p.map(|p| p.map(|x| unit * x)).to_vec();
        PolygonMesh::new(positions, [&[0, 1, 2, 3][..], &[0, 3, 4]]).unwrap()
    };
    let values: Vec<f64> = mesh.positions().iter().map(|p| p[0] * p[1] + p[2]).collect();
    let (mass, rise, flux) =
        (consistent_mass(&mesh).unwrap(), gradient(&mesh).unwrap(), divergence(&mesh).unwrap());
    let (slopes, normals) = (face_gradients(&mesh, &values).unwrap(), face_normals(&mesh));
    let faces = polygon_laplacian(&polygons(1.0)).unwrap();
    let way = HeatGeodesics::new(&mesh).unwrap().distance(&[3]).unwrap();
    for exponent in EXPONENTS {
        let unit = 2f64.powi(exponent);
        let other = scaled(&mesh, unit);
        assert_eq!(consistent_mass(&other).unwrap(), times(&mass, [unit, unit]), "2^{exponent}");
        assert_eq!(gradient(&other).unwrap(), times(&rise, [1.0 / unit, 1.0]), "2^{exponent}");
        assert_eq!(divergence(&other).unwrap(), times(&flux, [unit, 1.0]), "2^{exponent}");
        let expected: Vec<_> = slopes.iter().map(|g| g.map(|x| x * (1.0 / unit))).collect();
        assert_eq!(face_gradients(&other, &values).unwrap(), expected, "2^{exponent}");
        assert_eq!(face_normals(&other), normals, "2^{exponent}");
        let found = polygon_laplacian(&polygons(unit)).unwrap();
        assert_eq!(found.stiffness, faces.stiffness, "2^{exponent}");
        assert_eq!(found.mass, times(&faces.mass, [unit, unit]), "2^{exponent}");
        let found = HeatGeodesics::new(&other).unwrap().distance(&[3]).unwrap();
        for (found, expected) in found.iter().zip(&way) {
            // The unit of an extent is another power of two than that of the mesh.
            let (found, expected) = (found.unwrap() / unit, expected.unwrap());
            assert!((found - expected).abs() < 1e-9, "2^{exponent}: {found} {expected}");
        }
    }
}

/// Normals off by a tenth of a turn.
#[test]
fn vertex_updates_follow_their_units_at_every_size() {
    let mesh = noisy(&shapes::icosphere(2), 0.3);
    let normals = face_normals(&shapes::icosphere(2));
    let expected = update_vertices(&mesh, &normals, 5).unwrap();
    assert_ne!(expected, mesh);
    for exponent in EXPONENTS {
        let unit = 2f64.powi(exponent);
        let found = update_vertices(&scaled(&mesh, unit), &normals, 5).unwrap();
        assert_eq!(found, scaled(&expected, unit), "2^{exponent}");
    }
}

/// Finite results or an error that names the face, for any faces.
#[test]
fn operators_of_soups_are_numbers() {
    for seed in 0..40 {
        let soup = soup(seed);
        for size in [1.0, 1e-8, 1e8, 1e-29, 1e29] {
            let mesh = scaled(&soup, size);
            let mass = consistent_mass(&mesh).unwrap();
            assert!(mass.data().iter().all(|m| *m >= 0.0 && m.is_finite()), "{seed} {size:e}");
            for found in [gradient(&mesh), divergence(&mesh)] {
                match found {
                    Ok(matrix) => assert!(matrix.data().iter().all(|x| x.is_finite())),
                    Err(error) => assert!(error.to_string().contains("face"), "{error}"),
                }
            }
            let polygons = PolygonMesh::new(mesh.positions().to_vec(), mesh.faces()).unwrap();
            match polygon_laplacian(&polygons) {
                Ok(found) => {
                    let all = found.stiffness.data().iter().chain(found.mass.data());
                    assert!(all.chain(&found.lumped_mass).all(|x| x.is_finite()), "{seed}");
                }
                Err(error) => assert!(error.to_string().contains("face"), "{error}"),
            }
        }
    }
}

/// No panic and unchanged faces for any mesh, at any size and far from the origin. `TriMesh`
/// refuses coordinates that are not finite, so the results are finite.
#[test]
fn denoisers_survive_soups() {
    for seed in 0..3 {
        let soup = soup(seed);
        let moved = soup.positions().iter().map(|[x, y, z]| [x + 1e6, y - 2e5, z + 3e6]).collect();
        let placed = [
            soup.clone(),
            scaled(&soup, 1e-8),
            scaled(&soup, 1e8),
            scaled(&soup, 1e-29),
            scaled(&soup, 1e29),
            turned(&soup, seed as f64),
            soup.with_positions(moved).unwrap(),
        ];
        for (i, mesh) in placed.iter().enumerate() {
            for denoiser in Denoiser::all() {
                match denoiser.denoise(mesh) {
                    Ok(found) => {
                        assert_eq!(found.faces(), mesh.faces(), "{denoiser} {seed} {i}");
                        let isolated = |v: usize| mesh.incidence().corners(v as u32).is_empty();
                        for v in (0..mesh.vertex_count()).filter(|&v| isolated(v)) {
                            assert_eq!(
                                found.positions()[v],
                                mesh.positions()[v],
                                "{denoiser} {seed} {i}"
                            );
                        }
                    }
                    Err(error) => {
                        assert!(!error.to_string().contains("NaN"), "{denoiser}: {error}")
                    }
                }
            }
        }
    }
}

/// Denoising commutes with rotating, scaling, moving and renumbering a mesh. The shapes are smooth,
/// so no face is near a threshold that would amplify rounding.
#[test]
fn denoisers_do_not_depend_on_the_frame() {
    let input = noisy(&shapes::torus(1.0, 0.4, 30, 14), 0.15);
    let n = input.vertex_count();
    let h = input.mean_edge_length();
    let place = |v: usize| (v * 11 + 3) % n;
    let image = |mesh: &TriMesh, case: usize| -> Vec<[f64; 3]> {
        match case {
            0 => turned(mesh, 0.9).positions().to_vec(),
            1 => scaled(mesh, 1e-8).positions().to_vec(),
            2 => scaled(mesh, 1e8).positions().to_vec(),
            3 => mesh.positions().iter().map(|[x, y, z]| [x + 3e5, y - 1e5, z + 2e5]).collect(),
            _ => {
                let mut positions = vec![[0.0; 3]; n];
                for (v, p) in mesh.positions().iter().enumerate() {
                    positions[place(v)] = *p;
                }
                positions
            }
        }
    };
    let renumbered = |[a, b, c]: [u32; 3]| [b, c, a].map(|v| place(v as usize) as u32);
    for denoiser in Denoiser::all() {
        let plain = denoiser.denoise(&input).unwrap();
        for case in 0..5 {
            let size = [1.0, 1e-8, 1e8, 1.0, 1.0][case];
            let faces = match case {
                4 => input.faces().iter().rev().map(|f| renumbered(*f)).collect(),
                _ => input.faces().to_vec(),
            };
            let other = TriMesh::new(image(&input, case), faces).unwrap();
            let found = denoiser.denoise(&other).unwrap();
            let off =
                |(p, q): (&[f64; 3], &[f64; 3])| DVec3::from(*p).distance((*q).into()) / (size * h);
            let worst =
                image(&plain, case).iter().zip(found.positions()).map(off).fold(0.0, f64::max);
            // Coordinates near 3e5 are rounded to 6e-11, a billionth of h. The network of the
            // automatic denoiser computes in single precision, 6e-8, over four stages.
            let limit = if denoiser == Denoiser::Automatic(AutomaticOptions::DEFAULT) {
                1e-5
            } else {
                1e-6
            };
            assert!(worst < limit, "{denoiser}, case {case}: {worst:e} h");
        }
    }
}
