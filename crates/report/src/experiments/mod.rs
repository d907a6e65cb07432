//! The experiments, in the order of the report.

use crate::experiment::Experiment;

mod q1;
mod q2;
mod q3;
mod q4;
mod q5;
mod q6;
mod q7;

mod conformal;
mod denoisers;
mod estimators;
mod flows;
mod noise;

mod every_estimator;
mod families;
mod gallery;
mod gap;
mod grid;
mod mode_sums;
mod models;
mod ordinary;
mod over_lambda;
mod pairs;
mod refinement;
mod restoring;
mod samples;
mod seen;
mod spread;
mod statistics;
mod study;
mod surfaces;
mod torus;

/// The experiments in the order of the article.
pub const ALL: &[&dyn Experiment] = &[
    &q1::UniformCurvature,
    &q2::EllipsoidForms,
    &q3::CotangentCurvature,
    &noise::Noise,
    &estimators::Estimators,
    &q4::Reconstruction,
    &q5::ExplicitFlow,
    &q6::ImplicitFlow,
    &flows::Flows,
    &q7::GrowingNoise,
    &denoisers::Denoisers,
];
