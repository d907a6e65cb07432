//! Properties of every public type.

use std::collections::BTreeSet;
use std::path::Path;

/// A trait of all types that threads can share and send.
trait Shared: Send + Sync {}

impl<T: Send + Sync> Shared for T {}

/// Compiles only if all the types are `Send` and `Sync`.
macro_rules! all_shared {
    ($($type:ty),* $(,)?) => {
        fn names() -> Vec<&'static str> {
            fn name<T: Shared>() -> &'static str {
                std::any::type_name::<T>()
            }
            vec![$(name::<$type>()),*]
        }
    };
}

all_shared!(
    // mesh
    fairing::parameters::Algorithm,
    fairing::parameters::Choice,
    fairing::parameters::Kind,
    fairing::parameters::Parameter,
    fairing::parameters::ParameterError,
    fairing::parameters::Values,
    fairing::parameters::WeightedVertex,
    fairing::mesh::BuildError,
    fairing::mesh::Components,
    fairing::mesh::Connectivity,
    fairing::mesh::Diagnosis,
    fairing::mesh::Fan,
    fairing::mesh::Incidence,
    fairing::mesh::Moments,
    fairing::mesh::Orientation,
    fairing::mesh::PolygonFaces,
    fairing::mesh::PolygonMesh,
    fairing::mesh::OpenHole,
    fairing::mesh::OpenReason,
    fairing::mesh::RepairError,
    fairing::mesh::RepairOptions,
    fairing::mesh::RepairStep,
    fairing::mesh::Repaired,
    fairing::mesh::Welded,
    fairing::mesh::Tally,
    fairing::mesh::Tolerance,
    fairing::mesh::Topology,
    fairing::mesh::TriMesh,
    fairing::parameters::ParameterError,
    fairing::mesh::io::Encoding,
    fairing::mesh::io::FaceFields,
    fairing::mesh::io::FloatWidth,
    fairing::mesh::io::Format,
    fairing::mesh::io::Holds,
    fairing::mesh::io::MeshFile,
    fairing::mesh::io::NamedFormat,
    fairing::mesh::io::NumberType,
    fairing::mesh::io::Place,
    fairing::mesh::io::ReadError,
    fairing::mesh::io::ReadProblem,
    fairing::mesh::io::ReadReport,
    fairing::mesh::io::Reader,
    fairing::mesh::io::Statements,
    fairing::mesh::io::Strictness,
    fairing::mesh::io::UnsupportedFields,
    fairing::mesh::io::VertexFields,
    fairing::mesh::io::WriteError,
    fairing::mesh::io::WriteOptions,
    fairing::mesh::io::WriteProblem,
    fairing::mesh::io::WriteReport,
    // shapes
    fairing::shapes::Diagonals,
    fairing::shapes::Ends,
    fairing::shapes::HelicoidOptions,
    // sparse
    fairing::sparse::Beyond,
    fairing::sparse::CgOptions,
    fairing::sparse::CgSolution,
    fairing::sparse::ChebyshevSeries,
    fairing::sparse::Cholesky,
    fairing::sparse::GraphSystem,
    fairing::sparse::EigenOptions,
    fairing::sparse::EigenPairs,
    fairing::sparse::FieldOperator<fn(&[[f64; 3]], &mut [[f64; 3]]) -> [f64; 3]>,
    fairing::sparse::GraphLaplacian,
    fairing::sparse::GraphNumbers<'static>,
    fairing::sparse::Inertia,
    fairing::sparse::LaplacianPower<'static>,
    fairing::sparse::Ldlt,
    fairing::sparse::Mass<'static>,
    fairing::sparse::Ordering,
    fairing::sparse::Solved,
    fairing::sparse::SparseError,
    fairing::sparse::SymbolicCholesky,
    fairing::sparse::Workload,
    // watch
    fairing::watch::Cancelled,
    fairing::watch::Handle,
    fairing::watch::Progress,
    fairing::watch::Watch,
    // operators
    fairing::operators::CotangentPattern,
    fairing::operators::Intrinsic,
    fairing::operators::Laplacian,
    fairing::operators::LaplacianKind,
    fairing::operators::LumpedArea,
    fairing::operators::MassKind,
    fairing::operators::MassMatrix,
    fairing::operators::ThinFaces,
    fairing::operators::NormalEquations<3>,
    fairing::operators::NormalFactor<3>,
    fairing::operators::NormalWeight,
    fairing::operators::OperatorError,
    fairing::operators::PolygonLaplacian,
    fairing::operators::Reason,
    fairing::operators::Restricted<'static>,
    fairing::operators::curvature::Accuracy,
    fairing::operators::curvature::AdaptiveOptions,
    fairing::operators::curvature::CorrectedMeasures,
    fairing::operators::curvature::CorrectedOptions,
    fairing::operators::curvature::CotangentOptions,
    fairing::operators::curvature::CurvatureField,
    fairing::operators::curvature::Estimator,
    fairing::operators::curvature::FaceTensorOptions,
    fairing::operators::curvature::JetDegree,
    fairing::operators::curvature::JetOptions,
    fairing::operators::curvature::JetWeight,
    fairing::operators::curvature::Length,
    fairing::operators::curvature::MeanCurvature,
    fairing::operators::curvature::Neighborhood,
    fairing::operators::curvature::NormalCycleOptions,
    fairing::operators::curvature::QuadricOptions,
    fairing::operators::curvature::ScalarCurvature,
    fairing::operators::curvature::Undefined,
    fairing::operators::curvature::VertexStatus,
    fairing::operators::intrinsic::IntrinsicFaces,
    fairing::operators::intrinsic::RobustLaplacian,
    fairing::operators::surface::ChartNormal,
    fairing::operators::surface::Cylinder,
    fairing::operators::surface::Ellipsoid,
    fairing::operators::surface::FundamentalForms,
    fairing::operators::surface::Helicoid,
    fairing::operators::surface::PointCurvature,
    fairing::operators::surface::PrincipalDirections,
    fairing::operators::surface::Sphere,
    fairing::operators::surface::SurfaceJet,
    fairing::operators::surface::Torus,
    fairing::operators::surface::WavyGraph,
    // spectral
    fairing::spectral::Compressed,
    fairing::spectral::Filtered,
    fairing::spectral::GeodesicPath,
    fairing::spectral::Isoline,
    fairing::spectral::HeatDiffusion,
    fairing::spectral::HeatGeodesics,
    fairing::spectral::Poisson<'static>,
    fairing::spectral::Reconstruction,
    fairing::spectral::Rest,
    fairing::spectral::SpectralError,
    fairing::spectral::Spectrum,
    fairing::spectral::SpectrumOptions,
    fairing::spectral::Split,
    fairing::spectral::SurfacePoint,
    // smoothing
    fairing::smoothing::Approach,
    fairing::smoothing::Boundary,
    fairing::smoothing::ConformalizedMcf,
    fairing::smoothing::Constraints,
    fairing::smoothing::Diffusion,
    fairing::smoothing::Explicit,
    fairing::smoothing::FairRegion,
    fairing::smoothing::FlowError,
    fairing::smoothing::FlowFailure,
    fairing::smoothing::Hc,
    fairing::smoothing::Implicit,
    fairing::smoothing::LowPass,
    fairing::smoothing::Method,
    fairing::smoothing::Report,
    fairing::smoothing::ScaleDependent,
    fairing::smoothing::Smoothed,
    fairing::smoothing::SoftConstraint,
    fairing::smoothing::Stability,
    fairing::smoothing::Step<'static>,
    fairing::smoothing::Taubin,
    fairing::smoothing::Time,
    fairing::smoothing::Transfer,
    fairing::smoothing::Update,
    fairing::smoothing::Volume,
    fairing::smoothing::Window,
    fairing::smoothing::WindowedSinc,
    // denoising
    fairing::denoising::Masked<'static>,
    fairing::denoising::NoiseEstimate,
    fairing::denoising::NoisyParts,
    fairing::denoising::Automatic,
    fairing::denoising::BilateralNormalGlobalOptions,
    fairing::denoising::BilateralNormalOptions,
    fairing::denoising::BilateralOptions,
    fairing::denoising::DenoiseError,
    fairing::denoising::Denoiser,
    fairing::denoising::FastEffectiveOptions,
    fairing::denoising::GuidedNormalOptions,
    fairing::denoising::L0Options,
    fairing::denoising::NonIterativeOptions,
    fairing::denoising::FaceKind,
    fairing::denoising::SurfaceKind,
    fairing::denoising::TotalVariationOptions,
    // evaluation
    fairing::evaluation::Closest,
    fairing::evaluation::Drift,
    fairing::evaluation::EvaluationError,
    fairing::evaluation::FeatureEdges,
    fairing::evaluation::Hausdorff,
    fairing::evaluation::NoiseKind,
    fairing::evaluation::NoiseLevel,
    fairing::evaluation::NormalAngles,
    fairing::evaluation::Scan,
    fairing::evaluation::ScanOptions,
    fairing::evaluation::Score,
    fairing::evaluation::ScoreOptions,
    fairing::evaluation::ScoreUnit,
    fairing::evaluation::Scores,
    fairing::evaluation::SurfaceDistance,
    fairing::evaluation::SurfaceTree,
    fairing::evaluation::VertexDisplacement,
    fairing::evaluation::VertexDistance,
    // figure
    fairing::figure::Axis,
    fairing::figure::AxisScale,
    fairing::figure::Background,
    fairing::figure::Camera,
    fairing::figure::Center,
    fairing::figure::ColorBar,
    fairing::figure::ColorMap,
    fairing::figure::ColoringOptions,
    fairing::figure::Colors<'static>,
    fairing::figure::Drawing,
    fairing::figure::FigureError,
    fairing::figure::Exhibit<'static>,
    fairing::figure::Field<'static>,
    fairing::figure::Figure,
    fairing::figure::Image,
    fairing::figure::Legend,
    fairing::figure::Limits,
    fairing::figure::Occlusion,
    fairing::figure::Panel,
    fairing::figure::Plot,
    fairing::figure::RenderOptions,
    fairing::figure::Scale,
    fairing::figure::ScaleOptions,
    fairing::figure::Series,
    fairing::figure::Shading,
    fairing::figure::Shape,
    fairing::figure::Spread,
    fairing::figure::Up,
    fairing::figure::Viewpoint,
    fairing::figure::Wireframe,
    // the façade
    fairing::Error,
    fairing::ErrorKind,
);

/// The names of the structs and enums that are declared at the top level of a file.
fn public_types(folder: &Path, found: &mut BTreeSet<String>) {
    for entry in folder.read_dir().unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            public_types(&path, found);
            continue;
        }
        let text = std::fs::read_to_string(&path).unwrap();
        let names = text.lines().filter_map(|line| {
            let rest = line.strip_prefix("pub struct ").or(line.strip_prefix("pub enum "))?;
            rest.split(|c: char| !c.is_alphanumeric()).next()
        });
        found.extend(names.map(str::to_owned));
    }
}

/// Types that only the study uses, through the feature `training`, and private ones.
const HIDDEN: [&str; 12] = [
    "Growth",
    "Layer",
    "Model",
    "Network",
    "Parts",
    "Patch",
    "Piece",
    "PrincipalAxes",
    "Sample",
    "Seen",
    "State",
    "Trace",
];

/// Every public type is in the list above and therefore checked to be `Send` and `Sync`.
#[test]
fn every_public_type_is_send_and_sync() {
    let crates = Path::new(env!("CARGO_MANIFEST_DIR")).join("../crates");
    let mut found = BTreeSet::new();
    for name in [
        "watch",
        "mesh",
        "shapes",
        "sparse",
        "operators",
        "spectral",
        "smoothing",
        "denoising",
        "evaluation",
        "figure",
    ] {
        public_types(&crates.join(name).join("src"), &mut found);
    }
    let listed: BTreeSet<&str> = names()
        .into_iter()
        .filter_map(|name| name.split('<').next()?.rsplit("::").next())
        .collect();
    let seen = |name: &&String| !listed.contains(&name[..]) && !HIDDEN.contains(&&name[..]);
    let missing: Vec<_> = found.iter().filter(seen).collect();
    assert!(missing.is_empty(), "not in the list of this test: {missing:?}");
}
