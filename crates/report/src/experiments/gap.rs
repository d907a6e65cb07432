//! Numbers of modes that may be kept: a truncation between equal or nearly equal
//! eigenvalues depends on the basis that a solver happened to choose in their
//! eigenspace, and is no property of the mesh.

use anyhow::{Result, ensure};
use fairing_spectral::{SpectralError, Spectrum};

/// Tolerance, between processors, of numbers that depend on a truncation.
pub(super) const ANGLE: f64 = Spectrum::GAP_ANGLE;

/// The relative gap after the first k modes; infinite after all of them.
pub(super) fn behind(spectrum: &Spectrum, k: usize) -> f64 {
    match spectrum.values.get(k) {
        Some(next) if *next > 0.0 && k > 0 => (next - spectrum.values[k - 1]) / next,
        Some(_) => 0.0,
        None => f64::INFINITY,
    }
}

/// The least number of modes from k on after which there is a gap; `None` if
/// the known modes end before it.
pub(super) fn next(spectrum: &Spectrum, k: usize) -> Option<usize> {
    spectrum.gap_above(k).filter(|&k| k <= spectrum.len())
}

/// Modes up to the first gap from k on and one beyond it, from a solver of so
/// many modes of a mesh with n vertices.
pub(super) fn modes(
    n: usize,
    k: usize,
    solve: impl Fn(usize) -> Result<Spectrum, SpectralError>,
) -> Result<Spectrum> {
    ensure!(k <= n, "there are {n} modes, not {k}");
    let mut more = 4 + k / 50;
    loop {
        let spectrum = solve((k + more).min(n))?;
        let last = spectrum.len();
        if let Some(kept) = next(&spectrum, k).filter(|&kept| kept < last || last == n) {
            return Ok(spectrum.truncated((kept + 1).min(spectrum.len()))?);
        }
        ensure!(spectrum.len() < n, "no gap from {k} modes on");
        more *= 2;
    }
}

#[cfg(test)]
mod tests {
    use fairing_mesh::TriMesh;
    use fairing_operators::Laplacian;
    use fairing_shapes as shapes;
    use fairing_spectral::{EigenOptions, SpectrumOptions, graph_spectrum, spectrum};

    use super::*;

    /// Every mode of a mesh: there is none after them to be mixed with.
    #[test]
    fn all_modes_end_at_a_gap() {
        let mesh = shapes::icosphere(1);
        let n = mesh.vertex_count();
        let laplacian = Laplacian::cotangent(&mesh).unwrap();
        let all = modes(n, n, |k| spectrum(&laplacian, k, &SpectrumOptions::default())).unwrap();
        assert_eq!((all.len(), next(&all, n)), (n, Some(n)));
    }

    /// A projection at a gap does not depend on the numbering of the vertices, by which the
    /// solver chooses its basis; one through a cluster does.
    #[test]
    fn numbers_at_gaps_do_not_depend_on_the_basis() {
        let mesh = shapes::torus(1.0, 0.4, 24, 10);
        let n = mesh.vertex_count();
        let map = |v: u32| (v * 7 + 3) % n as u32;
        let mut positions = vec![[0.0; 3]; n];
        for (v, p) in mesh.positions().iter().enumerate() {
            // Some relief that is not symmetric.
            positions[map(v as u32) as usize] =
                [p[0] + 0.1 * p[1] * p[1] * p[2], p[1], p[2] + 0.2 * p[0] * p[0] * p[1]];
        }
        let old = (0..n as u32).map(|v| positions[map(v) as usize]).collect();
        let faces = mesh.faces().iter().map(|f| f.map(map)).collect();
        let other = TriMesh::new(positions, faces).unwrap();
        let mesh = mesh.with_positions(old).unwrap();
        let solve = |mesh: &TriMesh, k| {
            graph_spectrum(mesh, k, fairing_operators::MassKind::Degree, &EigenOptions::default())
        };
        let [a, b] = [&mesh, &other].map(|m| modes(n, 12, |k| solve(m, k)).unwrap());
        let kept = next(&a, 12).unwrap();
        assert_eq!(next(&b, 12), Some(kept));
        let errors =
            |m: &TriMesh, s: &Spectrum| fairing_spectral::reconstruction_errors(m, s).unwrap();
        let (a, b) = (errors(&mesh, &a), errors(&other, &b));
        assert!((a[kept] / b[kept] - 1.0).abs() < ANGLE, "{} and {}", a[kept], b[kept]);
    }
}
