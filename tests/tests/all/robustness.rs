//! Defective places have a defined answer or a reason, never NaN and never a crash.

use fairing_mesh::TriMesh;
use fairing_operators::curvature::{
    CurvatureField, Estimator, JetOptions, JetWeight, Length, Neighborhood, NormalCycleOptions,
    Undefined, VertexStatus, jet_curvature, normal_cycle_curvature,
};
use fairing_operators::{OperatorError, cotan_stiffness};
use fairing_shapes as shapes;

fn check(field: &CurvatureField, mesh: &TriMesh, name: &str) {
    assert_eq!(field.len(), mesh.vertex_count());
    let numbers = [&field.kappa1, &field.kappa2, &field.mean, &field.gaussian];
    assert!(numbers.into_iter().flatten().all(|x| x.is_finite()), "{name}");
    for v in 0..field.len() {
        if !field.status[v].is_defined() {
            assert_eq!((field.kappa1[v], field.kappa2[v]), (0.0, 0.0), "{name}");
            assert!(!field.is_interior(v as u32));
        }
    }
}

fn mesh(positions: Vec<[f64; 3]>, faces: Vec<[u32; 3]>) -> TriMesh {
    TriMesh::new(positions, faces).unwrap()
}

#[test]
fn nothing_and_points_alone() {
    for positions in [vec![], vec![[1.0, 2.0, 3.0]; 4]] {
        let mesh = mesh(positions, vec![]);
        for estimator in Estimator::all() {
            let field = estimator.estimate(&mesh).unwrap();
            check(&field, &mesh, estimator.name());
            let isolated = VertexStatus::Undefined(Undefined::Isolated);
            assert!(field.status.iter().all(|&s| s == isolated), "{estimator}");
        }
    }
}

#[test]
fn one_triangle_is_flat_or_too_small() {
    let mesh = mesh(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [5.0; 3]], vec![[0, 1, 2]]);
    for estimator in Estimator::all() {
        let field = estimator.estimate(&mesh).unwrap();
        check(&field, &mesh, estimator.name());
        assert_eq!(field.boundary, [true, true, true, false]);
        let expected = match estimator {
            Estimator::Quadric(_) | Estimator::Jet(_) => {
                VertexStatus::Undefined(Undefined::TooFewNeighbors)
            }
            _ => VertexStatus::Defined,
        };
        assert_eq!(field.status[0], expected, "{estimator}");
        assert_eq!(field.status[3], VertexStatus::Undefined(Undefined::Isolated));
        assert_eq!(field.mean[..3], [0.0; 3], "{estimator}");
    }
}

/// Neighbours on a line through the vertex do not determine a quadric.
#[test]
fn a_strip_of_needles_is_not_determined() {
    let positions: Vec<_> =
        (0..40).map(|i| [f64::from(i / 2), f64::from(i % 2) * 1e-9, 0.0]).collect();
    let faces = (0..38u32).map(|i| if i % 2 == 0 { [i, i + 2, i + 1] } else { [i, i + 1, i + 2] });
    let mesh = mesh(positions, faces.collect());
    for name in ["quadric", "jet2", "jet3"] {
        let field = name.parse::<Estimator>().unwrap().estimate(&mesh).unwrap();
        check(&field, &mesh, name);
        let reason = VertexStatus::Undefined(Undefined::IllConditioned);
        assert_eq!(field.status[20], reason, "{name}");
    }
}

/// Collapsed, collinear, doubled, flipped and pinched faces in one mesh.
#[test]
fn a_soup_of_everything() {
    let mut sphere = shapes::icosphere(3);
    let n = sphere.vertex_count() as u32;
    let mut positions = sphere.positions().to_vec();
    let mut faces = sphere.faces().to_vec();
    positions.extend([positions[0], positions[1], [0.5, 0.5, 0.5], [9.0; 3]]);
    faces.extend([[0, 1, n], [0, n, n + 1], faces[3], faces[7]]);
    let [a, b, c] = faces[11];
    faces.extend([[a, c, b], [5, 80, n + 2]]);
    sphere = mesh(positions, faces);
    assert!(matches!(cotan_stiffness(&sphere), Err(OperatorError::DegenerateFace { .. })));
    for estimator in Estimator::all() {
        let field = estimator.estimate(&sphere).unwrap();
        check(&field, &sphere, estimator.name());
        let defined = field.status.iter().filter(|s| s.is_defined()).count();
        assert!(defined > 600, "{estimator} {defined}");
        // More than four rings from the damage the sphere is unchanged, up to the error of fits
        // this wide.
        let ones = field.mean.iter().filter(|h| (**h - 1.0).abs() < 0.1).count();
        assert!(ones > 300, "{estimator} {ones}");
    }
}

#[test]
fn options_out_of_range_are_refused() {
    let mesh = shapes::icosphere(1);
    for value in [-1.0, f64::NAN, f64::INFINITY] {
        let radius = Length::MeshUnits(value);
        assert!(normal_cycle_curvature(&mesh, NormalCycleOptions { radius }).is_err());
        let neighborhood = Neighborhood::Ball(radius);
        assert!(jet_curvature(&mesh, JetOptions { neighborhood, ..Default::default() }).is_err());
        let weight = JetWeight::Gaussian(value);
        assert!(jet_curvature(&mesh, JetOptions { weight, ..Default::default() }).is_err());
    }
}
