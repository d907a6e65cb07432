//! Options and reports as JSON, and back.

use std::fmt::Debug;

use fairing::denoising::{
    BilateralNormalGlobalOptions, BilateralNormalOptions, BilateralOptions, Denoiser,
    FastEffectiveOptions, GuidedNormalOptions, L0Options, NonIterativeOptions,
    TotalVariationOptions, noise_level,
};
use fairing::evaluation::{
    Drift, Hausdorff, NoiseKind, NoiseLevel, NormalAngles, ScanOptions, ScoreOptions, Scores,
    add_noise,
};
use fairing::figure::{
    Background, ColorMap, ColoringOptions, RenderOptions, ScaleOptions, Shading, Viewpoint,
    Wireframe,
};
use fairing::mesh::Diagnosis;
use fairing::mesh::io::{self, Format, Reader, VertexFields, WriteOptions};
use fairing::operators::curvature::{Estimator, umbrella_mean_curvature};
use fairing::operators::{Laplacian, LaplacianKind, LumpedArea, MassKind};
use fairing::smoothing::{
    Boundary, Constraints, Diffusion, Implicit, LowPass, Method, Time, Transfer, Volume, Window,
    implicit,
};
use fairing::sparse::{CgOptions, EigenOptions};
use fairing::spectral::SpectrumOptions;
use fairing_shapes as shapes;
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::{Value, from_value, json, to_value};

/// The value as JSON, after a round trip.
fn json_of<T: Serialize + DeserializeOwned + PartialEq + Debug>(value: &T) -> Value {
    let text = serde_json::to_string(value).unwrap();
    assert_eq!(serde_json::from_str::<T>(&text).unwrap(), *value, "{text}");
    to_value(value).unwrap()
}

/// Options survive JSON, each may be omitted, and unknown options are refused.
fn check_options<T: Serialize + DeserializeOwned + PartialEq + Debug + Default>() {
    let all = json_of(&T::default());
    assert_eq!(from_value::<T>(json!({})).unwrap(), T::default());
    for (name, value) in all.as_object().unwrap() {
        assert_eq!(from_value::<T>(json!({ name.as_str(): value })).unwrap(), T::default());
    }
    let error = from_value::<T>(json!({ "no such option": 1 })).unwrap_err().to_string();
    assert!(error.contains("no such option"), "{error}");
}

#[test]
fn options_may_be_left_out_and_are_checked_by_name() {
    check_options::<Reader>();
    check_options::<WriteOptions>();
    check_options::<EigenOptions>();
    check_options::<CgOptions>();
    check_options::<SpectrumOptions>();
    check_options::<Constraints>();
    check_options::<BilateralOptions>();
    check_options::<BilateralNormalOptions>();
    check_options::<BilateralNormalGlobalOptions>();
    check_options::<FastEffectiveOptions>();
    check_options::<GuidedNormalOptions>();
    check_options::<L0Options>();
    check_options::<NonIterativeOptions>();
    check_options::<TotalVariationOptions>();
    check_options::<ScanOptions>();
    check_options::<ScoreOptions>();
    check_options::<RenderOptions>();
    check_options::<Wireframe>();
    check_options::<ColoringOptions>();
}

#[test]
fn methods_come_back_with_all_their_options() {
    for method in Method::all() {
        json_of(&method);
    }
    for estimator in Estimator::all() {
        json_of(&estimator);
    }
    for denoiser in Denoiser::all() {
        json_of(&denoiser);
    }
    for options in [ScaleOptions::EQUALIZED_HUE, ScaleOptions::SIGNED, ScaleOptions::MAGNITUDE] {
        json_of(&options);
    }
    let constraints = Constraints::boundary(Boundary::Sliding);
    let options = Implicit { constraints, ..Implicit::new(Diffusion::cotangent(5.0)) };
    let found = json_of(&options);
    assert_eq!(found["constraints"]["boundary"], json!(Boundary::Sliding.name()));
    let filter = LowPass::new(Transfer::Heat(Time::SquaredEdges(2.5)));
    assert_eq!(json_of(&filter)["transfer"], json!({ "heat": { "squared-edges": 2.5 } }));
    let missing = from_value::<LowPass>(json!({ "transfer": { "modes": 4 } })).unwrap_err();
    assert!(missing.to_string().contains("missing field"), "{missing}");
}

/// Named choices are written as their names.
#[test]
fn choices_are_their_names() {
    fn names<T: Serialize + DeserializeOwned + PartialEq + Debug + ToString>(all: &[T]) {
        for choice in all {
            assert_eq!(json_of(choice), json!(choice.to_string()));
        }
        assert!(from_value::<T>(json!("no such name")).is_err());
    }
    names(&LaplacianKind::ALL);
    names(&MassKind::ALL);
    names(&LumpedArea::ALL);
    names(&Boundary::ALL);
    names(&Volume::ALL);
    names(&Window::ALL);
    names(&ColorMap::ALL);
    names(&Viewpoint::ALL);
    names(&[Viewpoint::Angles { azimuth: 20.5, elevation: -10.0 }]);
    names(&Format::ALL);
    for kind in NoiseKind::ALL {
        let found = json_of(&kind);
        let name = match &found {
            Value::Object(fields) => fields.keys().next().unwrap(),
            other => other.as_str().unwrap(),
        };
        assert_eq!(name, kind.name());
    }
    json_of(&NoiseLevel::EdgeLengths(0.3));
    json_of(&Shading::Creased { degrees: 45.0 });
    json_of(&Background::WHITE);
}

#[test]
fn reports_and_scores_come_back() {
    let truth = shapes::bumpy_sphere(3, 0.1, 4.0);
    let level = NoiseLevel::EdgeLengths(0.2);
    let noisy = add_noise(&truth, NoiseKind::GaussianPerAxis, level, 1).unwrap();

    json_of(&Diagnosis::new(&noisy));
    let estimate = noise_level(&noisy).unwrap();
    assert_eq!(json_of(&estimate)["sigma"], json!(estimate.sigma));
    let smoothed = implicit(&noisy, &Implicit::new(Diffusion::uniform(2.0)), None).unwrap();
    assert_eq!(json_of(&smoothed.report)["iterations"], json!(smoothed.report.iterations));
    let curvature = umbrella_mean_curvature(&noisy);
    json_of(&curvature.into_signed());
    let laplacian = Laplacian::new(&noisy, LaplacianKind::Auto, MassKind::Barycentric).unwrap();
    json_of(&laplacian.reason());

    let scores = Scores::new(&smoothed.mesh, &truth, &ScoreOptions::default()).unwrap();
    json_of::<NormalAngles>(scores.normals.as_ref().unwrap());
    json_of::<Hausdorff>(&scores.hausdorff);
    json_of::<Drift>(&scores.drift);
    for score in scores.entries() {
        let found = to_value(&score).unwrap();
        assert_eq!(found["name"], json!(score.name));
        let expected = match &score.value {
            Ok(value) => json!({ "Ok": value }),
            Err(reason) => json!({ "Err": reason }),
        };
        assert_eq!(found["value"], expected);
    }

    let bytes =
        io::to_bytes(Format::Ply, &noisy, &VertexFields::default(), &WriteOptions::default());
    let file = Reader::default().read_bytes("", &bytes.unwrap()).unwrap();
    assert_eq!(json_of(&file.report)["format"], json!(Format::Ply.name()));
}
