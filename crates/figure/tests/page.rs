//! Interactive pages: the numbers that they hold, and what is refused.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD as BASE64;
use fairing_figure::{Exhibit, Field, FigureError, Up, page};
use fairing_mesh::TriMesh;

fn tetrahedron() -> TriMesh {
    let corners = vec![[9.0, 0.0, 0.1], [10.0, 0.0, 0.0], [9.0, 1.0, 0.0], [9.0, 0.0, 1.0]];
    TriMesh::new(corners, vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]).unwrap()
}

fn exhibit<'a>(mesh: &'a TriMesh, fields: Vec<(String, Field<'a>)>) -> Exhibit<'a> {
    Exhibit { title: "a <mesh>".into(), mesh, fields }
}

/// The bytes of the first block of a class and a name.
fn bytes(html: &str, class: &str, name: &str) -> Vec<u8> {
    let start = format!("class=\"{class}\" data-name=\"{name}\">");
    let (_, rest) = html.split_once(&start).unwrap();
    BASE64.decode(rest.split_once('<').unwrap().0).unwrap()
}

#[test]
fn numbers_are_those_of_the_meshes() {
    let mesh = tetrahedron();
    let values = [0.1, 1e-300, f64::INFINITY, -4.0];
    let field = Field::new(&values).undefined_where(&[false, false, true, false]).unwrap();
    let fields = vec![("\"mean\" & more".into(), field)];
    let html = page(&[exhibit(&mesh, fields)], Some("\"mean\" & more"), Up::Z).unwrap();

    let positions = bytes(&html, "positions", "");
    let center = [9.5, 0.5, 0.5];
    let expected = mesh.positions().iter().flat_map(|p| [0, 1, 2].map(|k| p[k] - center[k]));
    let found = positions.as_chunks().0.iter().map(|b| f32::from_le_bytes(*b));
    assert!(found.eq(expected.map(|x| x as f32)));
    assert!(html.contains("data-up=\"z\" data-center=\"9.5 0.5 0.5\""));

    let faces = bytes(&html, "faces", "");
    let found: Vec<u32> = faces.as_chunks().0.iter().map(|b| u32::from_le_bytes(*b)).collect();
    assert_eq!(found, mesh.faces().as_flattened());

    let field = bytes(&html, "field", "&quot;mean&quot; &amp; more");
    let found: Vec<f64> = field.as_chunks().0.iter().map(|b| f64::from_le_bytes(*b)).collect();
    assert!(found[2].is_nan());
    assert_eq!([found[0], found[1], found[3]], [values[0], values[1], values[3]]);
}

/// Every element that is opened is closed; scripts share one scope, and nothing comes from
/// elsewhere.
#[test]
fn the_page_is_whole() {
    let mesh = tetrahedron();
    let html = page(&[exhibit(&mesh, vec![]), exhibit(&mesh, vec![])], None, Up::Y).unwrap();
    for name in ["html", "head", "body", "div", "script", "style", "main", "title"] {
        let opened =
            html.matches(&format!("<{name}>")).count() + html.matches(&format!("<{name} ")).count();
        assert!(opened > 0, "{name}");
        assert_eq!(opened, html.matches(&format!("</{name}>")).count(), "{name}");
    }
    assert!(html.contains("<title>a &lt;mesh&gt;, a &lt;mesh&gt;</title>"));
    for outside in ["src=", "https://", "fetch(", "XMLHttpRequest", "\nimport ", "\nexport "] {
        assert!(!html.contains(outside), "{outside}");
    }
}

#[test]
fn bad_input_is_named() {
    let mesh = tetrahedron();
    let refused = |fields, shown| page(&[exhibit(&mesh, fields)], shown, Up::Y).unwrap_err();
    assert_eq!(refused(vec![], Some("H")), FigureError::NoField { name: "H".into() });
    let short = refused(vec![("H".into(), Field::new(&[1.0]))], None);
    assert_eq!(short, FigureError::Count { what: "values", expected: 4, found: 1 });
    let infinite = refused(vec![("H".into(), Field::new(&[0.0, 1.0, f64::INFINITY, 0.0]))], None);
    let expected = FigureError::NonFinite { index: 2, value: f64::INFINITY };
    assert_eq!(infinite, expected);
    let points = TriMesh::new(vec![[0.0; 3], [1.0; 3]], vec![]).unwrap();
    let empty = page(&[exhibit(&points, vec![])], None, Up::Y).unwrap_err();
    assert_eq!(empty, FigureError::NoFaces { vertices: 2 });
    assert_eq!(page(&[], None, Up::Y).unwrap_err(), FigureError::NoFaces { vertices: 0 });
}
