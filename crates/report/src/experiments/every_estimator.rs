//! Every estimator on a torus with jittered vertices, to see and to turn.

use anyhow::{Context as _, Result};
use fairing_mesh::TriMesh;
use fairing_operators::curvature::{CurvatureField, Estimator, ScalarCurvature};
use fairing_operators::surface::PointCurvature;

use super::gallery;
use super::samples::{Layout, Sample};
use super::seen;
use super::surfaces::TestSurface;
use crate::experiment::Context;
use crate::experiment::outcome::Picture;
use crate::experiment::text::{Text, values};
use crate::model::view::{Panel, Slider, View};

static TEXT: Text = Text::new("every_estimator", include_str!("../../text/every_estimator.md"));

/// Estimates and true values.
pub(super) struct EveryEstimator {
    mesh: TriMesh,
    /// Exact H and K at the vertices.
    exact: [Vec<f64>; 2],
    /// In the order of [`Estimator::all()`].
    fields: Vec<CurvatureField>,
    /// The place of the estimator that the others are compared with, and that of the recommended
    /// one.
    shown: [usize; 2],
}

impl EveryEstimator {
    pub(super) fn on_torus(context: &Context<'_>, baseline: &str) -> Result<Self> {
        let sample = Sample::Closed(TestSurface::Torus);
        let level = context.choose(5, 3);
        let mesh = sample.mesh(level, Layout::Jittered, context.seed(&format!("torus {level}")));
        let exact: Option<Vec<PointCurvature>> =
            mesh.positions().iter().map(|&p| sample.exact(p)).collect();
        let exact = exact.context("a vertex off the torus")?;
        let place = |name: &str| {
            let found = Estimator::all().iter().position(|e| e.name() == name);
            found.with_context(|| format!("there is no estimator {name}"))
        };
        Ok(Self {
            exact: [PointCurvature::mean, PointCurvature::gaussian]
                .map(|of| exact.iter().map(of).collect()),
            fields: Estimator::all().iter().map(|e| e.estimate(&mesh)).collect::<Result<_, _>>()?,
            shown: [place(baseline)?, place(Estimator::RECOMMENDED.name())?],
            mesh,
        })
    }

    /// The errors of H by the two.
    pub(super) fn picture(&self, occlusion: bool) -> Result<Picture> {
        let [baseline, chosen] = self.shown.map(|i| {
            let field = &self.fields[i];
            let errors = field.mean.iter().zip(&self.exact[0]).map(|(x, y)| x - y).collect();
            let status = (field.status.clone(), field.boundary.clone());
            (Estimator::all()[i].name(), ScalarCurvature::new(errors, status.0, status.1))
        });
        let errors = [(baseline.0, &baseline.1.values[..]), (chosen.0, &chosen.1.values)];
        let seen = seen::errors(&errors)?;
        let names = errors.map(|(name, _)| name.to_string());
        gallery::errors(
            "torus",
            &TEXT.say("figure", values! { seen, names: seen::list(&names) })?,
            &TEXT.say("figure alt", &[])?,
            &self.mesh,
            &[baseline, chosen],
            occlusion,
        )
    }

    /// One estimator beside that of a slider.
    pub(super) fn view(&self) -> Result<View> {
        let [baseline, chosen] = self.shown;
        let name = Estimator::all()[baseline].name();
        Ok(View {
            id: "torus-view".into(),
            mesh: "fine jittered torus".into(),
            caption: TEXT.say("view", values! { name })?,
            alt: TEXT.say("view alt", &[])?,
            fallback: "torus".into(),
            z_up: true,
            sliders: vec![Slider::new("estimator", Estimator::all().iter().map(Estimator::name))],
            start: vec![chosen],
            color: Some("error of mean curvature".into()),
            panels: vec![
                self.panel(name, &self.fields[baseline..=baseline]),
                self.panel("estimator of the slider", &self.fields),
            ],
            ..View::default()
        })
    }

    /// H by some estimators, a stop for each, with the errors of H and of K.
    fn panel(&self, title: &str, fields: &[CurvatureField]) -> Panel {
        let [h, k] = &self.exact;
        let error = |estimate: &[f64], exact: &[f64]| {
            let off: f64 = estimate.iter().zip(exact).map(|(x, y)| (x - y).powi(2)).sum();
            let size: f64 = exact.iter().map(|x| x * x).sum();
            Some(100.0 * (off / size).sqrt())
        };
        let means = || fields.iter().map(|f| &f.mean[..]);
        let gaussians = || fields.iter().map(|f| &f.gaussian[..]);
        Panel::still(title, &self.mesh)
            .with_moving_field("mean curvature", "1/mesh units", true, means())
            .exactly(h.clone())
            .with_fact("RMS error of H", "%", means().map(|values| error(values, h)).collect())
            .with_fact("of K", "%", gaussians().map(|values| error(values, k)).collect())
    }
}
