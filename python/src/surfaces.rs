//! Surfaces given by formulas, with exact forms and curvature.

use fairing_operators::surface::{
    ClosedForms, Cylinder, Ellipsoid, FundamentalForms, Helicoid, ImplicitSurface,
    ParametricSurface, Sphere, Torus, WavyGraph,
};
use numpy::{PyArray1, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;

use crate::arrays::{Rows, column, rows, triples, values};
use crate::error::{Error, Result};

/// A surface `p(u, v)` from its name and parameters.
#[pyclass(frozen, module = "pyfairing._core")]
pub(crate) struct Surface {
    parametric: Box<dyn ParametricSurface + Send + Sync>,
    closed: Option<Box<dyn ClosedForms + Send + Sync>>,
    implicit: Option<Box<dyn ImplicitSurface + Send + Sync>>,
}

/// A surface of which all forms are known.
fn known<S>(surface: S) -> Surface
where
    S: ClosedForms + ImplicitSurface + Copy + Send + Sync + 'static,
{
    let (closed, implicit) = (Box::new(surface), Box::new(surface));
    Surface { parametric: Box::new(surface), closed: Some(closed), implicit: Some(implicit) }
}

fn positive(name: &str, value: f64) -> Result<f64> {
    if value > 0.0 && value.is_finite() {
        return Ok(value);
    }
    Err(Error::option(format!("{name} is {value}, but must be positive and finite")))
}

fn finite(name: &str, value: f64) -> Result<f64> {
    if value.is_finite() && value != 0.0 {
        return Ok(value);
    }
    Err(Error::option(format!("{name} is {value}, but must be finite and not zero")))
}

fn surface(name: &str, numbers: &[f64]) -> Result<Surface> {
    Ok(match (name, numbers) {
        ("ellipsoid", &[a, b, c]) => {
            known(Ellipsoid { a: positive("a", a)?, b: positive("b", b)?, c: positive("c", c)? })
        }
        ("sphere", &[radius]) => known(Sphere { radius: positive("radius", radius)? }),
        ("torus", &[major, minor]) => {
            let (major, minor) = (positive("major", major)?, positive("minor", minor)?);
            if minor >= major {
                return Err(Error::option(format!("minor is {minor}, but must be below {major}")));
            }
            known(Torus { major, minor })
        }
        ("cylinder", &[radius]) => known(Cylinder { radius: positive("radius", radius)? }),
        ("helicoid", &[rise]) => {
            let surface = Helicoid { rise: finite("rise", rise)? };
            let (parametric, closed) = (Box::new(surface), Some(Box::new(surface) as _));
            Surface { parametric, closed, implicit: None }
        }
        ("wavy_graph", &[amplitude, wave_number]) => {
            let amplitude = finite("amplitude", amplitude)?;
            let surface = WavyGraph { amplitude, wave_number: finite("wave_number", wave_number)? };
            let (parametric, implicit) = (Box::new(surface), Some(Box::new(surface) as _));
            Surface { parametric, closed: None, implicit }
        }
        _ => return Err(Error::option(format!("there is no surface {name:?} of such numbers"))),
    })
}

type Numbers<'py> = PyReadonlyArray1<'py, f64>;
type Column<'py> = Bound<'py, PyArray1<f64>>;

/// The pairs of parameters, all finite.
fn pairs(u: &Numbers<'_>, v: &Numbers<'_>) -> Result<Vec<(f64, f64)>> {
    let pairs: Vec<(f64, f64)> = values(u).into_iter().zip(values(v)).collect();
    match pairs.iter().find(|(u, v)| !(u.is_finite() && v.is_finite())) {
        Some((u, v)) => Err(Error::option(format!("({u}, {v}) is not finite"))),
        None => Ok(pairs),
    }
}

/// κ₁ ≥ κ₂ and their unit tangents.
type Principal<'py> = (Rows<'py>, Rows<'py>, Rows<'py>);

#[pymethods]
impl Surface {
    #[new]
    fn new(name: &str, numbers: Vec<f64>) -> PyResult<Self> {
        Ok(surface(name, &numbers)?)
    }

    fn point<'py>(&self, py: Python<'py>, u: Numbers<'_>, v: Numbers<'_>) -> PyResult<Rows<'py>> {
        let surface = &self.parametric;
        rows(py, pairs(&u, &v)?.into_iter().map(|(u, v)| surface.jet(u, v).point).collect())
    }

    fn normal<'py>(&self, py: Python<'py>, u: Numbers<'_>, v: Numbers<'_>) -> PyResult<Rows<'py>> {
        rows(py, self.forms(&u, &v)?.into_iter().map(|f| f.normal).collect())
    }

    /// E, F, G.
    fn first_form<'py>(
        &self,
        py: Python<'py>,
        u: Numbers<'_>,
        v: Numbers<'_>,
    ) -> PyResult<Rows<'py>> {
        rows(py, self.exactly(&u, &v, |s, u, v| s.first_form(u, v), |f| f.first)?)
    }

    /// L, M, N.
    fn second_form<'py>(
        &self,
        py: Python<'py>,
        u: Numbers<'_>,
        v: Numbers<'_>,
    ) -> PyResult<Rows<'py>> {
        rows(py, self.exactly(&u, &v, |s, u, v| s.second_form(u, v), |f| f.second)?)
    }

    fn mean_curvature<'py>(
        &self,
        py: Python<'py>,
        u: Numbers<'_>,
        v: Numbers<'_>,
    ) -> PyResult<Column<'py>> {
        let closed = |s: &dyn ClosedForms, u, v| s.mean_curvature(u, v);
        Ok(column(py, self.exactly(&u, &v, closed, |f| f.mean_curvature())?))
    }

    fn gaussian_curvature<'py>(
        &self,
        py: Python<'py>,
        u: Numbers<'_>,
        v: Numbers<'_>,
    ) -> PyResult<Column<'py>> {
        let closed = |s: &dyn ClosedForms, u, v| s.gaussian_curvature(u, v);
        Ok(column(py, self.exactly(&u, &v, closed, |f| f.gaussian_curvature())?))
    }

    fn principal<'py>(
        &self,
        py: Python<'py>,
        u: Numbers<'_>,
        v: Numbers<'_>,
    ) -> PyResult<Principal<'py>> {
        let found: Vec<_> = self.forms(&u, &v)?.into_iter().map(|f| f.principal()).collect();
        let kappa: Vec<f64> = found.iter().flat_map(|p| p.values).collect();
        let kappa = column(py, kappa).reshape([found.len(), 2])?;
        let first = rows(py, found.iter().map(|p| p.directions[0]).collect())?;
        Ok((kappa, first, rows(py, found.iter().map(|p| p.directions[1]).collect())?))
    }

    /// κ₁ ≥ κ₂ and the outward normal of the level sets through points of space.
    fn curvature_at<'py>(
        &self,
        py: Python<'py>,
        points: PyReadonlyArray2<'_, f64>,
    ) -> PyResult<(Rows<'py>, Rows<'py>)> {
        let surface = self.implicit.as_ref();
        let surface = surface.ok_or_else(|| Error::option("a helicoid has no level sets here"))?;
        let points = triples(&points)?;
        let found = points.into_iter().enumerate().map(|(i, p)| {
            let [x, y, z] = p;
            surface.curvature(p).ok_or_else(|| {
                Error::Computation(format!("point {i}, ({x}, {y}, {z}), has no level set"))
            })
        });
        let found = found.collect::<Result<Vec<_>>>()?;
        let kappa: Vec<f64> = found.iter().flat_map(|c| c.values).collect();
        let kappa = column(py, kappa).reshape([found.len(), 2])?;
        Ok((kappa, rows(py, found.iter().map(|c| c.normal).collect())?))
    }
}

impl Surface {
    fn forms(&self, u: &Numbers<'_>, v: &Numbers<'_>) -> Result<Vec<FundamentalForms>> {
        let surface = &self.parametric;
        let forms = pairs(u, v)?.into_iter().map(|(u, v)| {
            surface.forms(u, v).map_err(|error| Error::Computation(error.to_string()))
        });
        forms.collect()
    }

    /// A quantity by its closed form if there is one, else from the fundamental forms.
    fn exactly<T>(
        &self,
        u: &Numbers<'_>,
        v: &Numbers<'_>,
        closed: impl Fn(&dyn ClosedForms, f64, f64) -> T,
        from_forms: impl Fn(&FundamentalForms) -> T,
    ) -> Result<Vec<T>> {
        Ok(match &self.closed {
            Some(s) => pairs(u, v)?.into_iter().map(|(u, v)| closed(&**s, u, v)).collect(),
            None => self.forms(u, v)?.iter().map(from_forms).collect(),
        })
    }
}
