use super::*;
use fairing_mesh::{Diagnosis, TriMesh};
use glam::DVec3;

/// The smallest angle of all faces, in degrees.
fn smallest_angle(mesh: &TriMesh) -> f64 {
    let mut smallest = f64::INFINITY;
    for f in 0..mesh.face_count() {
        let t = mesh.triangle(f).map(DVec3::from);
        for k in 0..3 {
            let (u, v) = (t[(k + 1) % 3] - t[k], t[(k + 2) % 3] - t[k]);
            smallest = smallest.min((u.dot(v) / (u.length() * v.length())).clamp(-1.0, 1.0).acos());
        }
    }
    smallest.to_degrees()
}

/// Asserts that a shape is clean and connected, of this genus with this many
/// boundary loops, every angle at least this many degrees; a closed model has
/// positive volume.
#[track_caller]
fn check(mesh: &TriMesh, genus: u32, loops: usize, angle: f64) {
    let d = Diagnosis::new(mesh);
    assert!(d.is_clean(), "{d:?}");
    assert_eq!((d.components, d.genus, d.boundary_loops), (1, Some(genus), loops));
    assert_eq!((d.sliver_faces.count, d.duplicate_positions.count), (0, 0));
    assert_eq!(d.closed, loops == 0);
    assert!(d.volume.is_none_or(|v| v > 0.0), "inside out: {:?}", d.volume);
    let smallest = smallest_angle(mesh);
    assert!(smallest >= angle, "an angle of {smallest}°");
}

#[test]
fn closed_shapes() {
    // The angles of an icosphere tend to their limit from above.
    check(&icosphere(4), 0, 0, 54.0);
    check(&uv_sphere(24, 12), 0, 0, 13.0);
    check(&uv_sphere(3, 2), 0, 0, 40.0);
    check(&torus(3.0, 1.0, 48, 24), 1, 0, 26.0);
    check(&torus(3.0, 1.0, 3, 3), 1, 0, 5.0);
    check(&ellipsoid([3.0, 2.0, 1.0], 4), 0, 0, 24.0);
    check(&bumpy_sphere(4, 0.08, 6.0), 0, 0, 40.0);
    for squares in [1, 2, 7] {
        for diagonals in [Diagonals::Regular, Diagonals::Alternating] {
            check(&cube(squares, diagonals), 0, 0, 45.0 - 1e-9);
        }
    }
    for around in [3, 5, 24, 100] {
        check(&cylinder(1.0, 2.0, around, 8, Ends::Closed), 0, 0, 8.0);
    }
}

#[test]
fn open_shapes() {
    check(&cylinder(1.0, 2.0, 24, 8, Ends::Open), 0, 2, 43.0);
    for diagonals in [Diagonals::Regular, Diagonals::Alternating] {
        check(&plane(8, 8, diagonals), 0, 1, 45.0 - 1e-9);
    }
    check(&helicoid(&HelicoidOptions::default()), 0, 1, 30.0);
    for seed in 0..4 {
        check(&jittered_plane(30, 30, 0.24, seed), 0, 1, 3.0);
        check(&irregular_plane(0.05, seed), 0, 1, 15.0);
        check(&flower(0.075, seed), 0, 1, 8.0);
    }
    for f in 0..128 {
        assert!(plane(8, 8, Diagonals::Alternating).area_vector(f)[2] > 0.0);
    }
}

#[test]
fn blocks_and_creatures() {
    for spacing in [0.05, 0.08, 0.1, 0.17, 0.3] {
        check(&cad_block(spacing), 1, 0, 24.0);
    }
    // 84 and 90 are resolutions at which a plain surface net is not manifold.
    for resolution in [48, 84, 90] {
        check(&creature(resolution), 0, 0, 5.0);
    }
    // Thick limbs of few triangles leave narrower angles where they meet.
    for resolution in [24, 28, 36] {
        check(&creature(resolution), 0, 0, 3.0);
    }
}

#[test]
fn a_moebius_band_has_one_side_and_one_border() {
    let d = Diagnosis::new(&moebius(0.4, 48, 6));
    assert!(d.manifold && !d.orientable && d.genus.is_none());
    assert_eq!((d.boundary_loops, d.euler_characteristic), (1, 0));
    // One inconsistent edge for each square along the seam.
    assert_eq!(d.inconsistent_edges.count, 6);
}

/// Inscribed and circumscribed parts cancel on none of these; each halving of
/// the edges divides the errors by four.
#[test]
fn areas_and_volumes_converge_quadratically() {
    use std::f64::consts::PI;
    type Family = fn(u32) -> TriMesh;
    let families: [(&str, Family, f64, Option<f64>); 4] = [
        ("torus", |n| torus(3.0, 1.0, 12 * n, 6 * n), 12.0 * PI * PI, Some(6.0 * PI * PI)),
        ("uv sphere", |n| uv_sphere(8 * n, 4 * n), 4.0 * PI, Some(4.0 * PI / 3.0)),
        ("cylinder", |n| cylinder(1.0, 2.0, 8 * n, n, Ends::Closed), 6.0 * PI, Some(2.0 * PI)),
        // ∫∫ √(v² + c²) dv du with c = ½, |v| ≤ 1, 0 ≤ u ≤ 2π.
        (
            "helicoid",
            |n| {
                helicoid(&HelicoidOptions {
                    across: 4 * n,
                    along: 12 * n,
                    ..HelicoidOptions::default()
                })
            },
            2.0 * PI * (1.25f64.sqrt() + 0.25 * 2f64.asinh()),
            None,
        ),
    ];
    for (name, family, area, volume) in families {
        let errors: Vec<[f64; 2]> = [4, 8, 16, 32]
            .map(|n| {
                let mesh = family(n);
                let volume = volume.map_or(0.0, |v| v - mesh.signed_volume());
                [area - mesh.area(), volume]
            })
            .to_vec();
        for pair in errors.windows(2) {
            for k in 0..if volume.is_some() { 2 } else { 1 } {
                let order = (pair[0][k] / pair[1][k]).log2();
                assert!((1.9..2.1).contains(&order), "{name}: {order}, {errors:?}");
            }
        }
    }
}

#[test]
fn jitter_stays_on_the_surface_and_keeps_faces_upright() {
    let axes = [3.0, 2.0, 1.0];
    let upright = |moved: &TriMesh, still: &TriMesh| {
        (0..still.face_count())
            .all(|f| DVec3::from(moved.area_vector(f)).dot(still.area_vector(f).into()) > 0.0)
    };
    for seed in 0..4 {
        let sphere = jittered(&icosphere(3), 0.3, seed, onto_sphere);
        assert!(upright(&sphere, &icosphere(3)));
        check(&sphere, 0, 0, 15.0);
        assert!(sphere.positions().iter().all(|&p| (DVec3::from(p).length() - 1.0).abs() < 1e-15));

        let e = jittered(&ellipsoid(axes, 3), 0.3, seed, onto_ellipsoid(axes));
        assert!(upright(&e, &ellipsoid(axes, 3)));
        check(&e, 0, 0, 8.0);
        for p in e.positions() {
            let f: f64 = (0..3).map(|k| (p[k] / axes[k]).powi(2)).sum();
            assert!((f - 1.0).abs() < 1e-14, "{f}");
        }

        let t = jittered(&torus(3.0, 1.0, 36, 12), 0.3, seed, onto_torus(3.0, 1.0));
        assert!(upright(&t, &torus(3.0, 1.0, 36, 12)));
        check(&t, 1, 0, 8.0);
        for p in t.positions() {
            assert!(((p[0].hypot(p[1]) - 3.0).hypot(p[2]) - 1.0).abs() < 1e-14);
        }
    }
    let still = plane(4, 4, Diagonals::Regular);
    assert_eq!(jittered(&still, 0.0, 1, |p| p), still);
}

/// The same seed gives the same mesh, another seed another.
#[test]
fn seeds() {
    assert_eq!(flower(0.1, 5), flower(0.1, 5));
    assert_ne!(flower(0.1, 5), flower(0.1, 6));
    assert_ne!(irregular_plane(0.1, 5), irregular_plane(0.1, 6));
    assert_ne!(jittered_plane(5, 5, 0.1, 5), jittered_plane(5, 5, 0.1, 6));
}

/// Creases are exact: every edge whose faces differ by more than 20° ends on
/// the outline or on the upright lines, and the volume of the block is that of
/// its outline under the arch.
#[test]
fn the_block_has_exact_creases() {
    let block = cad_block(0.08);
    let topology = block.topology();
    let mut sharp = 0;
    for (e, ends) in topology.edges().iter().enumerate() {
        let [f, g] = *topology.edge_faces(e as u32) else { panic!("edge {e} is not inside") };
        let cosine = {
            let [n, m] = [f, g].map(|f| DVec3::from(block.area_vector(f as usize)).normalize());
            n.dot(m)
        };
        if cosine > 20f64.to_radians().cos() {
            continue;
        }
        sharp += 1;
        let [p, q] = ends.map(|v| block.positions()[v as usize]);
        let flat = p[2] == 0.0 && q[2] == 0.0;
        let arch = |p: [f64; 3]| p[2] == 1.4 - 0.05 * (p[0] - 1.0) * (p[0] - 1.0);
        let upright = p[0] == q[0] && p[1] == q[1];
        assert!(flat || arch(p) && arch(q) || upright, "{p:?} {q:?}");
    }
    // Two rims of about 17, and uprights at the seven sharp corners.
    assert!((400..600).contains(&sharp), "{sharp}");
    // Finer blocks converge to the volume with the square of the spacing.
    let volumes = [0.1, 0.05, 0.025].map(|h| cad_block(h).signed_volume());
    let ratio = (volumes[0] - volumes[1]) / (volumes[1] - volumes[2]);
    assert!((3.0..5.0).contains(&ratio), "{volumes:?}");
}

/// Noise leaves the border of an open mesh where it is, to the last bit, and nothing else.
#[test]
fn jitter_keeps_the_border() {
    let open = cylinder(1.0, 2.0, 14, 6, Ends::Open);
    let moved = jittered(&open, 0.4, 2, |p| p);
    let border = open.topology().boundary_vertices();
    for (v, &border) in border.iter().enumerate() {
        assert_eq!(moved.positions()[v] == open.positions()[v], border, "{v}");
    }
}
