//! Methods that are compared, levels of noise, and the limits of a kept shape.

use fairing_denoising::{
    AutomaticOptions, BilateralNormalGlobalOptions, BilateralNormalOptions, BilateralOptions,
    Denoiser, FastEffectiveOptions, GuidedNormalOptions, L0Options,
    TotalGeneralisedVariationOptions, TotalVariationOptions,
};

use crate::experiment::text::Text;
use crate::experiments::restoring::Method;

/// The words of the experiment.
pub(super) static TEXT: Text = Text::new("q7", include_str!("../../../text/q7.md"));

/// The assignment's levels, in model units.
pub(super) const ASSIGNMENT: [f64; 3] = [0.05, 0.1, 0.5];

/// The mean normal error in degrees below which a shape counts as kept: two faces that are each off
/// by as much are 30° apart, the angle from which an edge counts as sharp.
pub(super) const KEPT: f64 = 15.0;

/// The largest loss of volume of a shape that counts as kept, in per cent: normals alone do not
/// show shrinkage.
pub(super) const SHRUNK: f64 = 50.0;

/// A stricter bound on that loss, which decides whether the choice of [`SHRUNK`] matters.
pub(super) const STRICT: f64 = 10.0;

/// The methods, and true for those fast enough to run on all seeds. Non-iterative denoising is left
/// to the comparison of denoisers: its radius grows with the noisy edges, at high noise to the size
/// of the mesh.
pub(super) const METHODS: [(Method, bool); 16] = [
    (Method::Nothing, true),
    (Method::Explicit, true),
    (Method::Implicit, true),
    (Method::ReportExplicit, true),
    (Method::ReportImplicit, true),
    (Method::Taubin, true),
    (Method::Spectral, true),
    (Method::Denoiser(Denoiser::Bilateral(BilateralOptions::DEFAULT)), false),
    (Method::Denoiser(Denoiser::FastEffective(FastEffectiveOptions::DEFAULT)), true),
    (Method::Denoiser(Denoiser::BilateralNormal(BilateralNormalOptions::DEFAULT)), true),
    (
        Method::Denoiser(Denoiser::BilateralNormalGlobal(BilateralNormalGlobalOptions::DEFAULT)),
        true,
    ),
    (Method::Denoiser(Denoiser::L0(L0Options::DEFAULT)), false),
    (Method::Denoiser(Denoiser::TotalVariation(TotalVariationOptions::DEFAULT)), false),
    (Method::Denoiser(Denoiser::GuidedNormal(GuidedNormalOptions::DEFAULT)), false),
    (
        Method::Denoiser(Denoiser::TotalGeneralisedVariation(
            TotalGeneralisedVariationOptions::DEFAULT,
        )),
        false,
    ),
    (Method::Denoiser(Denoiser::Automatic(AutomaticOptions::DEFAULT)), false),
];
