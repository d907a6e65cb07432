//! All estimators in one type.

use fairing_mesh::TriMesh;
use fairing_parameters::{Algorithm, Parameter, ParameterError, Values};

use super::corrected::{CorrectedOptions, corrected_curvature};
use super::cotangent::{CotangentOptions, cotangent_curvature};
use super::face_tensor::{FaceTensorOptions, face_tensor_curvature};
use super::field::CurvatureField;
use super::jet::{JetDegree, JetOptions, JetWeight, jet_curvature};
use super::neighborhood::{Length, Neighborhood};
use super::normal_cycle::{NormalCycleOptions, normal_cycle_curvature};
use super::quadric::{QuadricOptions, quadric_curvature};
use super::steiner::steiner_curvature;
use crate::area::LumpedArea;
use crate::error::OperatorError;
use crate::normals::NormalWeight;

/// A method to estimate curvature, with its options.
///
/// Written as its name (`Display`) and read from it with the options of
/// [`Estimator::ALL`] (`FromStr`).
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum Estimator {
    /// [`cotangent_curvature`]
    Cotangent(CotangentOptions),
    /// [`steiner_curvature`]
    Steiner,
    /// [`normal_cycle_curvature`]
    NormalCycle(NormalCycleOptions),
    /// [`corrected_curvature`]
    Corrected(CorrectedOptions),
    /// [`face_tensor_curvature`]
    FaceTensor(FaceTensorOptions),
    /// [`quadric_curvature`]
    Quadric(QuadricOptions),
    /// [`jet_curvature`]
    Jet(JetOptions),
}

impl Estimator {
    /// Every estimator, with its default options.
    pub const ALL: [Self; 10] = [
        Self::Cotangent(CotangentOptions { area: LumpedArea::Mixed }),
        Self::Steiner,
        Self::NormalCycle(NormalCycleOptions { radius: Length::MeanEdges(2.0) }),
        Self::Corrected(CorrectedOptions { normals: NormalWeight::Sphere, radius: None }),
        Self::Corrected(CorrectedOptions {
            normals: NormalWeight::Sphere,
            radius: Some(Length::MeanEdges(2.0)),
        }),
        Self::FaceTensor(FaceTensorOptions { normals: NormalWeight::Sphere }),
        Self::Quadric(QuadricOptions { neighborhood: Neighborhood::Rings(2) }),
        jet(JetDegree::Two, 2),
        jet(JetDegree::Three, 3),
        jet(JetDegree::Four, 4),
    ];

    /// The estimator to take where nothing is known about the mesh: cubic
    /// jets over three rings, which converge on irregular meshes.
    pub const RECOMMENDED: Self = jet(JetDegree::Three, 3);

    /// Its name, what it is for, its source and its parameters.
    pub fn algorithm(&self) -> &'static Algorithm {
        match self {
            Self::Cotangent(_) => &COTANGENT,
            Self::Steiner => &STEINER,
            Self::NormalCycle(_) => &NORMAL_CYCLE,
            Self::Corrected(CorrectedOptions { radius: None, .. }) => &CORRECTED,
            Self::Corrected(_) => &CORRECTED_BALL,
            Self::FaceTensor(_) => &FACE_TENSOR,
            Self::Quadric(_) => &QUADRIC,
            Self::Jet(options) => match options.degree {
                JetDegree::Two => &JET2,
                JetDegree::Three => &JET3,
                JetDegree::Four => &JET4,
            },
        }
    }

    /// The estimator of that name with values for some of its
    /// [parameters](Algorithm::parameters).
    ///
    /// # Errors
    ///
    /// [`ParameterError`] for unknown names and for values that do not fit.
    ///
    /// # Examples
    ///
    /// ```
    /// use fairing_operators::curvature::Estimator;
    /// let wide = Estimator::with("jet3", &[("rings", "5")])?;
    /// assert_ne!(wide, Estimator::RECOMMENDED);
    /// # Ok::<(), fairing_parameters::ParameterError>(())
    /// ```
    pub fn with(name: &str, values: &[(&str, &str)]) -> Result<Self, ParameterError> {
        let mut estimator: Self = name.parse()?;
        let values = Values::new(estimator.algorithm(), values)?;
        let radius = match values.get::<f64>(RADIUS)? {
            Some(radius) if radius > 0.0 && radius.is_finite() => Some(Length::MeanEdges(radius)),
            Some(_) => return Err(values.refuse(RADIUS, "above zero")),
            None => None,
        };
        match &mut estimator {
            Self::Cotangent(options) => values.read(AREA, &mut options.area)?,
            Self::Steiner => {}
            Self::NormalCycle(options) => options.radius = radius.unwrap_or(options.radius),
            Self::Corrected(options) => {
                values.read(NORMALS, &mut options.normals)?;
                options.radius = radius.or(options.radius);
            }
            Self::FaceTensor(options) => values.read(NORMALS, &mut options.normals)?,
            Self::Quadric(options) => read_reach(&values, radius, &mut options.neighborhood)?,
            Self::Jet(options) => {
                read_reach(&values, radius, &mut options.neighborhood)?;
                if let Some(width) = values.get(GAUSSIAN)? {
                    options.weight = JetWeight::Gaussian(width);
                }
            }
        }
        Ok(estimator)
    }

    /// The name on the command line and in tables.
    pub fn name(&self) -> &'static str {
        self.algorithm().name
    }

    /// What it is for, in a line.
    pub fn description(&self) -> &'static str {
        self.algorithm().description
    }

    /// Whether it estimates the directions of the principal curvatures.
    pub fn has_directions(&self) -> bool {
        !matches!(self, Self::Cotangent(_))
    }

    /// Estimates curvature at every vertex; never NaN, undefined vertices are
    /// flagged.
    ///
    /// # Errors
    ///
    /// [`OperatorError::Option`] for an option out of its range;
    /// [`OperatorError::NoLength`] for the cotangent estimator on a mesh whose
    /// vertices are all in one place.
    pub fn estimate(&self, mesh: &TriMesh) -> Result<CurvatureField, OperatorError> {
        match *self {
            Self::Cotangent(options) => cotangent_curvature(mesh, options),
            Self::Steiner => Ok(steiner_curvature(mesh)),
            Self::NormalCycle(options) => normal_cycle_curvature(mesh, options),
            Self::Corrected(options) => corrected_curvature(mesh, options),
            Self::FaceTensor(options) => Ok(face_tensor_curvature(mesh, options)),
            Self::Quadric(options) => quadric_curvature(mesh, options),
            Self::Jet(options) => jet_curvature(mesh, options),
        }
    }
}

/// The neighbourhood from the number of rings or the radius.
fn read_reach(
    values: &Values<'_>,
    radius: Option<Length>,
    reach: &mut Neighborhood,
) -> Result<(), ParameterError> {
    match (radius, values.get(RINGS)?) {
        (Some(radius), _) => *reach = Neighborhood::Ball(radius),
        (None, Some(rings)) if (1..=MOST_RINGS).contains(&rings) => {
            *reach = Neighborhood::Rings(rings);
        }
        (None, Some(_)) => return Err(values.refuse(RINGS, "between 1 and 16")),
        (None, None) => {}
    }
    Ok(())
}

const MOST_RINGS: u32 = 16;

const AREA: &str = "area";
const NORMALS: &str = "normals";
const RADIUS: &str = "radius";
const RINGS: &str = "rings";
const GAUSSIAN: &str = "gaussian";

/// The parameter `radius` of estimators over a ball.
const fn radius(default: &'static str) -> Parameter {
    Parameter::number(RADIUS, default, "The radius of the ball about each vertex")
        .unit("mean edge lengths")
}

/// The parameters of fits.
const fn reach(rings: &'static str) -> [Parameter; 2] {
    [
        Parameter::count(RINGS, rings, "How far the fit reaches, in rings of neighbours, 1 to 16"),
        Parameter::number(RADIUS, "", "How far the fit reaches, in place of rings: a radius")
            .unit("mean edge lengths")
            .excludes(&[RINGS]),
    ]
}

/// The parameter of weighted fits.
const WIDTH: Parameter =
    Parameter::number(GAUSSIAN, "", "Gaussian weights of this width, in place of equal ones")
        .unit("mean distances of the neighbours");

/// How normals are made.
const WEIGHT: Parameter =
    Parameter::choice(NORMALS, NormalWeight::CHOICES, "sphere", "The weights of face normals");

static COTANGENT: Algorithm = Algorithm::new(
    "cotangent",
    "H and K of regular meshes, and integrals on any: the cheapest; no directions",
    &["meyer2003", "pinkall1993"],
    &[Parameter::choice(AREA, LumpedArea::CHOICES, "mixed", "The areas of vertices")],
);

static STEINER: Algorithm = Algorithm::new(
    "steiner",
    "bending at creases, from dihedral angles; any mesh, however broken",
    &["sullivan2008"],
    &[],
);

static NORMAL_CYCLE: Algorithm = Algorithm::new(
    "normal-cycle",
    "curvature at a chosen scale, averaged over a ball; steady under noise",
    &["cohensteiner2003"],
    &[radius("2")],
);

static CORRECTED: Algorithm = Algorithm::new(
    "corrected",
    "principal curvatures of smooth shapes at the cost of one ring",
    &["lachaud2020"],
    &[WEIGHT, radius("")],
);

static CORRECTED_BALL: Algorithm = Algorithm::new(
    "corrected-ball",
    "smooth shapes with uneven or noisy triangles, at a chosen scale",
    &["lachaud2020"],
    &[WEIGHT, radius("2")],
);

static FACE_TENSOR: Algorithm = Algorithm::new(
    "face-tensor",
    "shading and line drawing: smooth and cheap; close to corrected",
    &["rusinkiewicz2004"],
    &[WEIGHT],
);

static QUADRIC: Algorithm = Algorithm::new(
    "quadric",
    "clean meshes of even quality, two rings; as in libigl",
    &["panozzo2010"],
    &reach("2"),
);

static JET2: Algorithm = Algorithm::new(
    "jet2",
    "noisy smooth shapes, where few coefficients resist noise",
    &["cazals2005"],
    &fitted("2"),
);

static JET3: Algorithm = Algorithm::new(
    "jet3",
    "the recommended one: converges on irregular meshes of smooth shapes",
    &["cazals2005"],
    &fitted("3"),
);

static JET4: Algorithm = Algorithm::new(
    "jet4",
    "the most accurate on fine clean meshes of smooth shapes",
    &["cazals2005"],
    &fitted("4"),
);

/// The parameters of jets.
const fn fitted(rings: &'static str) -> [Parameter; 3] {
    let [rings, radius] = reach(rings);
    [rings, radius, WIDTH]
}

const fn jet(degree: JetDegree, rings: u32) -> Estimator {
    Estimator::Jet(JetOptions {
        degree,
        neighborhood: Neighborhood::Rings(rings),
        weight: JetWeight::Uniform,
    })
}

fairing_parameters::named!(Estimator, "estimator");

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_unique_and_read_back() {
        for (i, estimator) in Estimator::ALL.iter().enumerate() {
            assert_eq!(estimator.to_string().parse(), Ok(*estimator));
            assert!(Estimator::ALL[..i].iter().all(|e| e.name() != estimator.name()));
        }
        let error = "cotan".parse::<Estimator>().unwrap_err();
        assert!(error.to_string().contains("corrected-ball, face-tensor"));
        assert!(Estimator::ALL.contains(&Estimator::RECOMMENDED));
    }

    /// The defaults of the tables are those of [`Estimator::ALL`], and each parameter of a table is read.
    #[test]
    fn tables_agree_with_the_options() {
        use fairing_parameters::Kind;
        for estimator in Estimator::ALL {
            for parameter in estimator.algorithm().parameters {
                let name = format!("{estimator} --{}", parameter.name);
                let with = |value| Estimator::with(estimator.name(), &[(parameter.name, value)]);
                if !parameter.default.is_empty() {
                    assert_eq!(with(parameter.default), Ok(estimator), "{name}");
                }
                let other = match parameter.kind {
                    Kind::Number => "1.5",
                    Kind::Count => "7",
                    _ if parameter.name == AREA => "voronoi",
                    _ => "angle",
                };
                assert_ne!(with(other).unwrap(), estimator, "{name}");
            }
        }
        for (name, given, said) in [
            ("jet3", &[("rings", "0")][..], "rings is \"0\", but must be between 1 and 16"),
            ("quadric", &[("rings", "2"), ("radius", "1")], "give rings or radius, not both"),
            ("normal-cycle", &[("radius", "-1")], "radius is \"-1\", but must be above zero"),
            ("steiner", &[("radius", "1")], "steiner has no parameter \"radius\""),
            ("cotan", &[], "corrected-ball, face-tensor"),
        ] {
            let error = Estimator::with(name, given).unwrap_err().to_string();
            assert!(error.contains(said), "{error}");
        }
    }
}
