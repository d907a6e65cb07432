//! Smoothing flows and denoisers for triangle meshes.
