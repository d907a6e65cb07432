//! Interactive pages: meshes side by side under one camera, in a browser.

use std::fmt::Write as _;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD as BASE64;
use fairing_mesh::TriMesh;

use crate::bundle::{Module, bundle, compact};
use crate::camera::Up;
use crate::color::ColorMap;
use crate::error::FigureError;
use crate::field::Field;
use crate::svg::escape;

/// The modules of the viewer, for [`bundle`] and the pages of other crates.
pub const VIEWER: [Module<'static>; 11] = {
    macro_rules! viewer {
        ($($file:literal),*) => {
            [$((concat!("figure/viewer/", $file), include_str!(concat!("../viewer/", $file)))),*]
        };
    }
    viewer![
        "bar.mjs",
        "bytes.mjs",
        "camera.mjs",
        "colors.mjs",
        "dom.mjs",
        "geometry.mjs",
        "pictures.mjs",
        "renderer.mjs",
        "show.mjs",
        "steer.mjs",
        "viewer.mjs"
    ]
};

const STYLE: &str =
    concat!(include_str!("../viewer/style.css"), include_str!("../viewer/show.css"));

const BODY: &str = include_str!("../viewer/show.html");

/// A mesh of an interactive page.
#[derive(Debug, Clone)]
pub struct Exhibit<'a> {
    /// The line above its picture.
    pub title: String,
    /// The mesh.
    pub mesh: &'a TriMesh,
    /// Scalars of its vertices, by name. Fields of the same name on several meshes share their
    /// range of colours.
    pub fields: Vec<(String, Field<'a>)>,
}

/// An HTML page that shows meshes side by side under one camera, with colours, a colour bar,
/// isolines, edges, and the values of a vertex that is clicked.
///
/// The page is one file that requests nothing and needs WebGL 2. `shown` names the field that
/// colours the meshes at first; `None` leaves them plain. Undefined values are grey. Positions are
/// rounded to single precision relative to the centre of the first mesh; faces and fields are
/// exact. A page has about 40 kB, 24 bytes a face of a closed mesh, and 11 bytes a value.
///
/// # Errors
///
/// [`FigureError::NoFaces`] for a mesh without faces, and if there is no mesh;
/// [`FigureError::NoField`] if no mesh has the field that is to be shown; [`FigureError::Count`]
/// for a field without exactly one value a vertex; [`FigureError::NonFinite`] for a defined value
/// that is not finite.
///
/// # Examples
///
/// ```
/// use fairing_figure::{Exhibit, Field, Up, page};
/// use fairing_mesh::TriMesh;
///
/// let corners = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
/// let mesh = TriMesh::new(corners, vec![[0, 1, 2]])?;
/// let fields = vec![("height".into(), Field::new(&[0.0, 0.0, 1.0]))];
/// let face = Exhibit { title: "face".into(), mesh: &mesh, fields };
/// let html = page(&[face], Some("height"), Up::Y)?;
/// assert!(html.starts_with("<!DOCTYPE html>"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn page(exhibits: &[Exhibit<'_>], shown: Option<&str>, up: Up) -> Result<String, FigureError> {
    let Some([low, high]) = exhibits.first().and_then(|e| e.mesh.bounding_box()) else {
        return Err(FigureError::NoFaces { vertices: 0 });
    };
    if let Some(name) = shown
        && !exhibits.iter().any(|e| e.fields.iter().any(|(own, _)| own == name))
    {
        return Err(FigureError::NoField { name: name.into() });
    }
    let center = [0, 1, 2].map(|k| 0.5 * (low[k] + high[k]));
    let titles: Vec<&str> = exhibits.iter().map(|e| e.title.as_str()).collect();
    let mut html = format!(
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>{title}</title>\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\
         <link rel=\"icon\" href=\"data:,\"><style>{style}</style></head>\
         <body data-up=\"{up}\" data-center=\"{x} {y} {z}\"{field}>{BODY}",
        title = escape(&titles.join(", ")),
        style = compact(STYLE),
        up = if up == Up::Z { "z" } else { "y" },
        field = shown.map(|name| format!(" data-field=\"{}\"", escape(name))).unwrap_or_default(),
        x = center[0],
        y = center[1],
        z = center[2],
    );
    for exhibit in exhibits {
        write_mesh(&mut html, exhibit, center)?;
    }
    let maps = color_maps(&[ColorMap::Viridis, ColorMap::CoolWarm]);
    // Constants: the example above would fail.
    let script = bundle("figure/viewer/show.mjs", &VIEWER).expect("the modules fit together");
    let _ = write!(
        html,
        "<script id=\"colour-maps\" type=\"application/json\">{maps}</script>\n\
         <script type=\"module\">\n{script}</script></body></html>\n"
    );
    Ok(html)
}

/// Colour maps as the viewer reads them: an object of 256 colours each, in base64.
pub fn color_maps(maps: &[ColorMap]) -> String {
    let entry = |map: &ColorMap| {
        let colors: Vec<u8> = (0..256).flat_map(|i| map.at(f64::from(i) / 255.0)).collect();
        format!("\"{}\":\"{}\"", map.name(), BASE64.encode(colors))
    };
    format!("{{{}}}", maps.iter().map(entry).collect::<Vec<_>>().join(","))
}

fn write_mesh(
    html: &mut String,
    exhibit: &Exhibit<'_>,
    center: [f64; 3],
) -> Result<(), FigureError> {
    let Exhibit { title, mesh, fields } = exhibit;
    let vertices = mesh.vertex_count();
    if mesh.face_count() == 0 {
        return Err(FigureError::NoFaces { vertices });
    }
    let _ = write!(html, "<div class=\"mesh\" hidden data-title=\"{}\">", escape(title));
    let positions = mesh.positions().iter().flat_map(|p| [0, 1, 2].map(|k| p[k] - center[k]));
    block(html, "positions", "", positions.flat_map(|x| (x as f32).to_le_bytes()));
    block(html, "faces", "", mesh.faces().iter().flatten().flat_map(|v| v.to_le_bytes()));
    for (name, field) in fields {
        if field.len() != vertices {
            let (expected, found) = (vertices, field.len());
            return Err(FigureError::Count { what: "values", expected, found });
        }
        field.check()?;
        let values = field.values().map(|x| x.unwrap_or(f64::NAN));
        block(html, "field", name, values.flat_map(f64::to_le_bytes));
    }
    *html += "</div>";
    Ok(())
}

/// Bytes as base64, in a script that no browser runs.
fn block(html: &mut String, class: &str, name: &str, bytes: impl Iterator<Item = u8>) {
    let bytes: Vec<u8> = bytes.collect();
    let name = escape(name);
    let _ = write!(html, "<script type=\"text/plain\" class=\"{class}\" data-name=\"{name}\">");
    BASE64.encode_string(bytes, html);
    *html += "</script>";
}
