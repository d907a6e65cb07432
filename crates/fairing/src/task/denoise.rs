//! Removing noise from a mesh.

use fairing_denoising::{Approach, Automatic, FaceKind, NoiseEstimate};
use serde_json::{Value, json};

use super::object;

/// The report of [`automatic`](fairing_denoising::automatic()): its noise, the kind of surface with
/// the fractions of the area of each kind of face, and what was moved or left. [`Automatic`]
/// explains the entries.
pub fn denoise(found: &Automatic) -> Value {
    let fractions = FaceKind::ALL.map(|kind| (kind.name(), found.fraction(kind)));
    let border = found.mesh.topology().boundary_vertices();
    json!({
        "noise": found.noise.as_ref().map(noise),
        "kind": found.kind.name(),
        "approach": found.approach.map(Approach::name),
        "expected_error": found.expected_error,
        "undecided": found.undecided,
        "flipped_faces": found.flipped_faces,
        "area_fraction": object(fractions),
        "spikes": found.spikes,
        "uneven_vertices": found.uneven_vertices,
        "border_vertices": border.iter().filter(|border| **border).count(),
        "displacement_limit": found.limit,
    })
}

fn noise(noise: &NoiseEstimate) -> Value {
    json!({
        "sigma": noise.sigma,
        "tail_ratio": noise.tail_ratio,
        "low_ratio": noise.low_ratio,
        "two_ring_ratio": noise.two_ring_ratio,
        "correlation": noise.correlation,
        "correlation_length": noise.correlation_length,
        "wide_sigma": noise.wide_sigma,
        "impulsive": noise.is_impulsive(),
    })
}
