//! Noise models, distances, drift and scores for triangle meshes.
