//! Discrete differential operators and curvature of triangle meshes.
