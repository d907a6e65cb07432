//! Eigenvalues and modes of a mesh.

use fairing_operators::LaplacianKind;
use fairing_spectral::Spectrum;
use serde_json::{Value, json};

/// The report of the first `k` modes of a Laplacian: the eigenvalues with their residuals, and the
/// nearest numbers of modes that split no cluster.
pub fn spectrum(modes: &Spectrum, k: usize, laplacian: LaplacianKind) -> Value {
    json!({
        "gap_below": modes.gap_below(k),
        "gap_above": modes.gap_above(k),
        "eigenvalues": modes.values,
        "residuals": modes.residuals,
        "certified": modes.certified,
        "operator": laplacian.name(),
    })
}

/// The report of modes without their values: if they are certified, and the cluster that their
/// number splits, if any.
pub fn modes(modes: &Spectrum) -> Value {
    json!({ "certified": modes.certified, "split": modes.split(modes.len()) })
}
