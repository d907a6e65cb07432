//! Laplace-Beltrami spectra, transforms, filters and signatures.
