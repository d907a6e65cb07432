//! The claims of the list of methods, at their default options on meshes of 1 to 8 thousand
//! vertices.

use fairing_mesh::TriMesh;
use fairing_shapes::{self as shapes, Diagonals};
use fairing_smoothing::Method;

fn meshes() -> [(&'static str, TriMesh); 5] {
    [
        ("icosphere", shapes::icosphere(4)),
        ("sphere with poles", shapes::uv_sphere(128, 64)),
        ("ellipsoid", shapes::ellipsoid([1.0, 0.7, 0.5], 4)),
        ("torus", shapes::torus(2.0, 0.7, 120, 40)),
        ("cube", shapes::cube(24, Diagonals::Alternating)),
    ]
}

/// The volume after a method at its default options, over that before.
fn kept(mesh: &TriMesh, method: &str) -> f64 {
    let smoothed = Method::by_name(method).unwrap().run(mesh, None).unwrap().mesh;
    smoothed.signed_volume() / mesh.signed_volume()
}

/// The claims of windowed-sinc, taubin, hc and implicit about the size of finely meshed shapes.
#[test]
fn methods_preserve_the_size_as_the_list_says() {
    for (name, mesh) in meshes() {
        let lost = |method: &str| 1.0 - kept(&mesh, method);
        let [sinc, taubin, hc] = ["windowed-sinc", "taubin", "hc"].map(|method| lost(method).abs());
        assert!(sinc < 1e-4 && sinc < taubin && sinc < hc, "{name}: {sinc} {taubin} {hc}");
        assert!(taubin < 0.01 && hc < 1e-3, "{name}: {taubin} {hc}");
        for method in ["implicit", "explicit"] {
            assert!(lost(method) > 0.01, "{name}: {method} loses {}", lost(method));
        }
    }
}

/// A coarse shape keeps its size less well, and still far better than under diffusion.
#[test]
fn on_a_coarse_mesh_the_same_methods_shrink_a_little() {
    let mesh = shapes::creature(40);
    let implicit = 1.0 - kept(&mesh, "implicit");
    for method in ["windowed-sinc", "taubin", "hc"] {
        let lost = 1.0 - kept(&mesh, method);
        assert!((1e-3..0.1 * implicit).contains(&lost), "{method}: {lost}, {implicit}");
    }
}
