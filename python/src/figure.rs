//! Pictures.

use fairing_figure::{
    Background, Camera, ColorMap, ColoringOptions, Colors, Exhibit, Field, Image, Occlusion,
    RenderOptions, Shading, Up, Viewpoint, Wireframe, page, render,
};
use numpy::{PyArray1, PyArray3, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::arrays::{triples, values};
use crate::error::{Error, Result};
use crate::mesh::Mesh;
use crate::options::choose;
use crate::run::Call;

/// A view: a name, or azimuth and elevation in degrees.
#[derive(FromPyObject)]
pub(crate) enum View {
    Named(String),
    Angles(f64, f64),
}

impl View {
    fn viewpoint(&self) -> Result<Viewpoint> {
        match self {
            Self::Named(name) => {
                let views = Viewpoint::ALL.map(|view| (view.name().unwrap_or_default(), view));
                choose("view", name, &views)
            }
            Self::Angles(azimuth, elevation) => {
                if !(azimuth.is_finite() && elevation.is_finite()) {
                    return Err(Error::option(format!(
                        "view is ({azimuth}, {elevation}), but must be finite"
                    )));
                }
                Ok(Viewpoint::Angles { azimuth: *azimuth, elevation: *elevation })
            }
        }
    }
}

/// Style of the picture, from Python.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Style {
    view: View,
    up: String,
    size: (u32, u32),
    samples: u32,
    wireframe: bool,
    shading: String,
    transparent: bool,
    shadows: bool,
}

impl Style {
    fn options(&self) -> Result<RenderOptions> {
        let shadings = [
            ("creased", Shading::Creased { degrees: 45.0 }),
            ("smooth", Shading::Smooth),
            ("flat", Shading::Flat),
        ];
        Ok(RenderOptions {
            width: self.size.0,
            height: self.size.1,
            samples: self.samples,
            shading: choose("shading", &self.shading, &shadings)?,
            wireframe: self.wireframe.then(Wireframe::default),
            background: if self.transparent { Background::Transparent } else { Background::WHITE },
            ..RenderOptions::default()
        })
    }
}

/// Colour mapping, from Python.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Coloring {
    map: Option<String>,
    range: Option<(f64, f64)>,
    equalize: bool,
}

impl Coloring {
    fn options(&self) -> Result<ColoringOptions> {
        let maps = ColorMap::ALL.map(|map| (map.name(), map));
        let map = self.map.as_ref().map(|name| choose("map", name, &maps)).transpose()?;
        Ok(ColoringOptions { map, range: self.range, equalize: self.equalize })
    }
}

/// The values at the two ends of a map, and its name.
type Bar = (f64, f64, &'static str);

type Shown = (Image, Option<Bar>);
type PyShown<'py> = (Bound<'py, PyArray3<u8>>, Option<Bar>);

/// The picture, and its colour range if a field is shown.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "named in Python")]
pub(crate) fn render_mesh<'py>(
    py: Python<'py>,
    mesh: &Mesh,
    field: Option<PyReadonlyArray1<'_, f64>>,
    undefined: Option<PyReadonlyArray1<'_, bool>>,
    colors: Option<PyReadonlyArray2<'_, u8>>,
    coloring: Coloring,
    style: Style,
    call: Call,
) -> PyResult<PyShown<'py>> {
    let mesh = mesh.share();
    let field = field.map(|f| values(&f));
    let undefined = undefined.map(|u| values(&u));
    let given = colors.map(|c| triples(&c)).transpose()?;
    let (options, coloring) = (style.options()?, coloring.options()?);
    let viewpoint = style.view.viewpoint()?;
    let up = upward(&style.up)?;
    let (image, range): Shown = call.run(py, move || {
        let camera = Camera::fit(&[&*mesh], viewpoint, up, options.aspect())?;
        let (colors, range) = match &field {
            Some(field) => {
                let (scale, colors) = coloring.colors(&mesh, field, undefined.as_deref())?;
                (Some(colors), Some((scale.low(), scale.high(), scale.map().name())))
            }
            None => (given, None),
        };
        let colors = colors.as_deref().map_or(Colors::CLAY, Colors::PerVertex);
        let shadows = style.shadows.then(|| Occlusion::bake(&mesh));
        let image = render(&mesh, colors, shadows.as_ref(), &camera, &options)?;
        Ok((image, range))
    })?;
    let (width, height) = (image.width() as usize, image.height() as usize);
    let pixels = PyArray1::from_vec(py, image.pixels().as_flattened().to_vec());
    Ok((pixels.reshape([height, width, 4])?, range))
}

fn upward(name: &str) -> Result<Up> {
    choose("up", name, &[("y", Up::Y), ("z", Up::Z)])
}

/// The name of a field, its values, and where they are undefined.
type NamedField<'py> = (String, PyReadonlyArray1<'py, f64>, Option<PyReadonlyArray1<'py, bool>>);

/// The interactive page of meshes, each with its title and its fields.
#[pyfunction]
pub(crate) fn viewer_page(
    py: Python<'_>,
    meshes: Vec<(PyRef<'_, Mesh>, String, Vec<NamedField<'_>>)>,
    shown: Option<String>,
    up: &str,
    call: Call,
) -> PyResult<String> {
    let up = upward(up)?;
    let meshes: Vec<_> = meshes
        .iter()
        .map(|(mesh, title, fields)| {
            let own = |(name, field, undefined): &NamedField<'_>| {
                (name.clone(), values(field), undefined.as_ref().map(values))
            };
            (mesh.share(), title.clone(), fields.iter().map(own).collect::<Vec<_>>())
        })
        .collect();
    call.run(py, move || {
        let mut exhibits = vec![];
        for (mesh, title, own) in &meshes {
            let mut fields = vec![];
            for (name, values, undefined) in own {
                let mut field = Field::new(values);
                if let Some(undefined) = undefined {
                    field = field.undefined_where(undefined)?;
                }
                fields.push((name.clone(), field));
            }
            exhibits.push(Exhibit { title: title.clone(), mesh, fields });
        }
        Ok(page(&exhibits, shown.as_deref(), up)?)
    })
}

/// The bytes of a PNG file of an `h × w × 4` image.
#[pyfunction]
pub(crate) fn png<'py>(
    py: Python<'py>,
    pixels: numpy::PyReadonlyArray3<'_, u8>,
) -> PyResult<Bound<'py, PyBytes>> {
    let shape = pixels.as_array().dim();
    let [height, width] = [shape.0, shape.1].map(|n| u32::try_from(n).unwrap_or(u32::MAX));
    let flat: Vec<u8> = pixels.as_array().iter().copied().collect();
    let image = Image::from_pixels(width, height, flat.as_chunks::<4>().0.to_vec());
    Ok(PyBytes::new(py, &image.map_err(Error::from)?.to_png().map_err(Error::from)?))
}
