use super::*;
use crate::{LumpedArea, consistent_mass, cotan_stiffness, lumped_mass};
use fairing_shapes as shapes;

/// Two right triangles and, as vertex 0, an isolated one.
fn square() -> TriMesh {
    let positions =
        vec![[9.0; 3], [0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
    TriMesh::new(positions, vec![[1, 2, 3], [1, 3, 4]]).unwrap()
}

/// A rhombus split along its long diagonal 12: two angles of 120° and more
/// across it.
fn rhombus(height: f64) -> TriMesh {
    let positions =
        vec![[0.0, height, 0.0], [-1.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, -height, 0.0]];
    TriMesh::new(positions, vec![[0, 1, 2], [3, 2, 1]]).unwrap()
}

#[test]
fn parts_are_those_of_the_free_functions() {
    let mesh = square();
    let area = |area| MassMatrix::Lumped(lumped_mass(&mesh, area).unwrap());
    let consistent = MassMatrix::Consistent(consistent_mass(&mesh).unwrap());
    for (mass, expected) in [
        (MassKind::Barycentric, area(LumpedArea::Barycentric)),
        (MassKind::Mixed, area(LumpedArea::Mixed)),
        (MassKind::Voronoi, area(LumpedArea::Voronoi)),
        (MassKind::Consistent, consistent),
        (MassKind::Degree, MassMatrix::Lumped(vec![0.0, 3.0, 2.0, 3.0, 2.0])),
        (MassKind::Unit, MassMatrix::Lumped(vec![0.0, 1.0, 1.0, 1.0, 1.0])),
    ] {
        for (kind, stiffness) in [
            (LaplacianKind::Cotangent, cotan_stiffness(&mesh).unwrap()),
            (LaplacianKind::Uniform, combinatorial_laplacian(&mesh).unwrap()),
        ] {
            let found = Laplacian::new(&mesh, kind, mass).unwrap();
            assert_eq!((found.stiffness(), found.mass()), (&stiffness, &expected), "{kind} {mass}");
            assert_eq!((found.kind(), found.isolated()), (kind, &[0][..]));
        }
    }
    let robust = robust_laplacian(&mesh).unwrap();
    let found = Laplacian::robust(&mesh).unwrap();
    assert_eq!(found.stiffness(), &robust.stiffness);
    assert_eq!(found.mass(), &MassMatrix::Lumped(robust.mass));
    assert_eq!(found.intrinsic().unwrap().faces, robust.faces);
    let error = Laplacian::new(&mesh, LaplacianKind::Robust, MassKind::Mixed).unwrap_err();
    assert!(error.to_string().contains("robust Laplacian has no mixed mass"), "{error}");
}

#[test]
fn auto_says_what_it_takes_and_why() {
    let auto = |mesh: &TriMesh, mass| Laplacian::new(mesh, LaplacianKind::Auto, mass).unwrap();
    let of_kind = |mesh: &TriMesh, kind| {
        let found = Laplacian::new(mesh, kind, MassKind::Barycentric).unwrap();
        let chosen = (found.kind(), found.reason());
        assert_eq!(choose(mesh, kind, MassKind::Barycentric), Ok(chosen));
        chosen
    };
    let taken = |mesh: &TriMesh| of_kind(mesh, LaplacianKind::NonNegative);
    // Auto does not mind negative weights.
    for mesh in [square(), rhombus(0.5), rhombus(1e-9)] {
        let sound = (LaplacianKind::Cotangent, Reason::Sound);
        assert_eq!(of_kind(&mesh, LaplacianKind::Auto), sound);
    }
    // The diagonal of a square has the weight zero, but for rounding.
    assert_eq!(taken(&square()), (LaplacianKind::Cotangent, Reason::NonNegative));
    // cot 2 atan 2 = −3/4 on both sides of the edge.
    let (kind, reason) = taken(&rhombus(0.5));
    let Reason::NegativeWeight { edge, weight } = reason else { panic!("{reason}") };
    assert_eq!((kind, edge), (LaplacianKind::Robust, [1, 2]));
    assert!((weight + 0.75).abs() < 1e-15, "{weight}");
    // cot 2 atan(1/h) = (h² − 1)/2h on both sides: a millionth below zero counts,
    // rounding does not.
    assert_eq!(taken(&rhombus(1.0 - 1e-6)).0, LaplacianKind::Robust);
    assert_eq!(taken(&rhombus(1.0 - 1e-12)), (LaplacianKind::Cotangent, Reason::NonNegative));
    let thin = (LaplacianKind::Robust, Reason::ThinFace { face: 0, area: 0.0, edge: 2.0 });
    assert_eq!(taken(&rhombus(0.0)), thin);
    assert_eq!(of_kind(&rhombus(0.0), LaplacianKind::Auto), thin);
    let robust = auto(&rhombus(0.0), MassKind::Barycentric);
    assert!(robust.intrinsic().is_some_and(|on| on.mollified > 0 && on.added_length > 0.0));
    // The robust kind has no other mass.
    let mixed = auto(&rhombus(0.5), MassKind::Mixed);
    assert_eq!((mixed.kind(), mixed.reason()), (LaplacianKind::Cotangent, Reason::Mass));
    let mixed =
        |height| Laplacian::new(&rhombus(height), LaplacianKind::NonNegative, MassKind::Mixed);
    assert_eq!(mixed(2.0).unwrap().kind(), LaplacianKind::Cotangent);
    assert!(matches!(mixed(0.5), Err(OperatorError::NoSuchMass { .. })));
}

#[test]
fn polygons_have_one_too() {
    let corners = vec![[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0], [7.0; 3]];
    let mesh = PolygonMesh::new(corners, [[0, 1, 2, 3]]).unwrap();
    let found = Laplacian::from_polygons(&mesh, MassKind::Barycentric).unwrap();
    assert_eq!((found.kind(), found.isolated()), (LaplacianKind::Polygon, &[4][..]));
    let x = [0.0, 1.0, 1.0, 0.0, 7.0];
    let energy: f64 = found.apply(&x).unwrap().iter().zip(x).map(|(a, b)| a * b).sum();
    assert!((energy - 1.0).abs() < 1e-14, "{energy}");
    assert!(matches!(
        Laplacian::from_polygons(&mesh, MassKind::Mixed),
        Err(OperatorError::NoSuchMass { .. })
    ));
}

/// Isolated vertices have the mass zero, and where one must be positive the mean.
#[test]
fn isolated_vertices_follow_one_rule() {
    let x = [5.0, 0.0, 1.0, 1.0, 0.0];
    for mass in [MassKind::Barycentric, MassKind::Consistent] {
        for kind in [LaplacianKind::Cotangent, LaplacianKind::Auto, LaplacianKind::Uniform] {
            let found = Laplacian::new(&square(), kind, mass).unwrap();
            assert_eq!(found.mass().lumped()[0], 0.0);
            assert_eq!(found.pointwise(&x).unwrap()[0], 0.0);
            let positive = found.positive_mass().unwrap();
            assert!((positive.lumped()[0] - 0.2).abs() < 1e-15);
            assert_eq!(positive.lumped()[1..], found.mass().lumped()[1..]);
            let shifted = found.shifted(3.0).unwrap();
            assert_eq!(shifted.get(0, 0), Some(&positive.lumped()[0]));
            assert_eq!(found.restricted(&[]).unwrap().free(), [1, 2, 3, 4]);
        }
    }
    let nothing = Laplacian::cotangent(&TriMesh::new(vec![[1.0; 3]; 2], vec![]).unwrap()).unwrap();
    assert_eq!(*nothing.positive_mass().unwrap().lumped(), [1.0; 2]);
    let flat = TriMesh::new(vec![[0.0; 3], [1.0; 3], [2.0; 3]], vec![[0, 1, 2]]).unwrap();
    let flat = Laplacian::new(&flat, LaplacianKind::Uniform, MassKind::Barycentric).unwrap();
    let error = OperatorError::Mass { vertex: 0, mass: 0.0 };
    assert_eq!(flat.positive_mass(), Err(error.clone()));
    assert_eq!(flat.restricted(&[]).unwrap_err(), error);
    assert_eq!(flat.restricted(&[0, 1, 2]).unwrap().free(), [0u32; 0]);
}

/// Products with the restriction are those with all values at free vertices and zero elsewhere.
#[test]
fn restriction_takes_out_rows_and_columns() {
    let mesh = shapes::icosphere(1);
    let mut u: Vec<f64> = (0..42).map(|v| f64::from(v * v % 17)).collect();
    for v in [3, 7, 40] {
        u[v] = 0.0;
    }
    for mass in [MassKind::Barycentric, MassKind::Consistent] {
        let whole = Laplacian::new(&mesh, LaplacianKind::Cotangent, mass).unwrap();
        let part = whole.restricted(&[40, 3, 3, 7]).unwrap();
        assert_eq!(part.free().len(), 39);
        let gathered = |all: &[f64]| part.free().iter().map(|&v| all[v as usize]).collect();
        let inside: Vec<f64> = gathered(&u);
        let expected: Vec<f64> = gathered(&whole.apply(&u).unwrap());
        for (found, expected) in multiply(part.stiffness(), &inside).iter().zip(expected) {
            assert!((found - expected).abs() < 1e-13);
        }
        let expected: Vec<f64> = gathered(&whole.mass().as_mass().times(&u));
        for (found, expected) in part.mass().as_mass().times(&inside).iter().zip(expected) {
            assert!((found - expected).abs() < 1e-15);
        }
        let error = OperatorError::NoSuchVertex { vertex: 42, vertices: 42 };
        assert_eq!(whole.restricted(&[42]).unwrap_err(), error);
        // Nothing is copied where nothing is taken out.
        let all = whole.restricted(&[]).unwrap();
        assert!(std::ptr::eq(all.stiffness(), whole.stiffness()));
        assert!(std::ptr::eq(all.mass(), whole.mass()));
    }
}

/// Refilled is the same as new, bit by bit, for each kind and mass, also where the kind changes.
#[test]
fn refilled_is_new() {
    let sphere = shapes::bumpy_sphere(3, 0.15, 4.0);
    let mut sheared: Vec<_> = sphere.positions().to_vec();
    sheared.iter_mut().for_each(|p| p[0] += 4.0 * p[1]);
    let flat = sphere.positions().iter().map(|p| [p[0], 0.0, 0.0]).collect();
    let round = sphere.with_positions(shapes::icosphere(3).into_positions()).unwrap();
    let [sheared, flat] = [sheared, flat].map(|p| sphere.with_positions(p).unwrap());
    let mut taken = vec![];
    for kind in LaplacianKind::ALL {
        for mass in MassKind::ALL {
            let Ok(mut found) = Laplacian::new(&round, kind, mass) else { continue };
            for mesh in [&sphere, &sheared, &round, &flat, &sphere] {
                match Laplacian::new(mesh, kind, mass) {
                    Ok(new) => {
                        found.refill(mesh).unwrap();
                        assert_eq!(found, new, "{kind} {mass}");
                        if kind == LaplacianKind::NonNegative && mass == MassKind::Barycentric {
                            taken.push(found.kind());
                        }
                    }
                    Err(error) => {
                        let before = found.clone();
                        assert_eq!(found.refill(mesh), Err(error), "{kind} {mass}");
                        assert_eq!(found, before);
                    }
                }
            }
        }
    }
    assert!(taken.contains(&LaplacianKind::Robust) && taken.contains(&LaplacianKind::Cotangent));
}

/// The same where rows are shared out among tasks.
#[test]
fn refilled_in_several_tasks_is_new() {
    let sphere = shapes::icosphere(5);
    let bumpy = shapes::bumpy_sphere(5, 0.15, 4.0);
    for mass in [MassKind::Barycentric, MassKind::Consistent] {
        let mut found = Laplacian::new(&sphere, LaplacianKind::Cotangent, mass).unwrap();
        found.refill(&sphere.with_positions(bumpy.positions().to_vec()).unwrap()).unwrap();
        assert_eq!(found, Laplacian::new(&bumpy, LaplacianKind::Cotangent, mass).unwrap());
    }
}

#[test]
fn refilling_notices_another_mesh() {
    let mut found = Laplacian::cotangent(&shapes::icosphere(1)).unwrap();
    let before = found.clone();
    let error = found.refill(&shapes::icosphere(2)).unwrap_err();
    assert_eq!(error, OperatorError::Length { found: 162, expected: 42 });
    let mut faces = shapes::icosphere(1).faces().to_vec();
    faces[0] = [0, 20, 41];
    let other = TriMesh::new(shapes::icosphere(1).into_positions(), faces).unwrap();
    assert!(matches!(found.refill(&other), Err(OperatorError::Connectivity { vertex: 0 })));
    assert_eq!(found, before);
    let mut square = Laplacian::cotangent(&square()).unwrap();
    let all = TriMesh::new(vec![[0.0; 3]; 5], vec![]).unwrap();
    assert_eq!(square.refill(&all), Err(OperatorError::Connectivity { vertex: 1 }));
}
