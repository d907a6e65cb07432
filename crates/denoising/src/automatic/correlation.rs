//! The correlation of noise, and the variance of means over many vertices.

use std::ops::Range;

use fairing_mesh::TriMesh;
use fairing_sparse::upper_median;
use fairing_watch::parallel;

use super::follow::offsets_along;
use super::state::{State, root_mean_square};
use crate::noise_level::NoiseEstimate;

/// The least number of border vertices of an open surface, as a multiple of the root of the number
/// of all: 3.3 on a disc, 2.3 on half of a sphere, 0 on closed surfaces.
const OPEN: f64 = 1.0;

/// The correlation of residuals on open surfaces from which they count as correlated noise, as
/// on nine in ten views of models of the development set with such noise and one in fifty with
/// independent noise; beyond the upper one for the shape of a smooth sheet.
const RESIDUALS: Range<f64> = 0.05..0.4;

/// A vertex with more neighbours than this is not looked past.
const HUB: usize = 32;

/// Returns `true` for a surface with a long border.
pub fn is_open(mesh: &TriMesh) -> bool {
    let border = mesh.topology().boundary_vertices().iter().filter(|is| **is).count();
    border as f64 > OPEN * (mesh.vertex_count() as f64).sqrt()
}

/// Returns `true` for an open surface whose residuals are correlated as by the noise of a scanner.
pub(super) fn is_sheet_of_waves(mesh: &TriMesh, level: &NoiseEstimate) -> bool {
    is_open(mesh) && RESIDUALS.contains(&level.correlation)
}

/// The variance of positions across the surface, times the sum of their correlations: the
/// variance of the mean of n positions is this over n.
pub(super) fn variance_of_means(state: &State<'_>) -> f64 {
    state.variance * correlation_over_two_rings(state)
}

/// The sum of the correlations of displacements up to two edges apart, as [`correlation_sum`].
pub(super) fn correlation_over_two_rings(state: &State<'_>) -> f64 {
    correlation_sum(state.mesh(), &displacements(state))
}

/// The correlation of the displacements of the vertices from the surface across edges, as
/// [`across_edges`] with the vertices that may move.
pub(super) fn correlation_across_edges(state: &State<'_>) -> f64 {
    across_edges(state.mesh(), displacements(state), |v| !state.input.is_fixed(v))
}

/// The correlation of the numbers at the ends of the edges whose ends are both free. Numbers are
/// clipped to the median of their absolute values, so that a few large ones do not dominate. Zero
/// if the median is zero.
fn across_edges(mesh: &TriMesh, mut numbers: Vec<f64>, is_free: impl Fn(usize) -> bool) -> f64 {
    let sizes = (0..).zip(&numbers).filter(|(v, _)| is_free(*v)).map(|(_, x)| x.abs());
    let most = upper_median(sizes.collect()).unwrap_or(0.0);
    if most == 0.0 {
        return 0.0;
    }
    numbers.iter_mut().for_each(|x| *x = (*x / most).clamp(-1.0, 1.0));
    let (mut products, mut squares) = (0.0, 0.0);
    for edge in mesh.topology().edges() {
        let [a, b] = edge.map(|v| v as usize);
        if is_free(a) && is_free(b) {
            let [x, y] = [a, b].map(|v| numbers[v]);
            products += x * y;
            squares += 0.5 * (x * x + y * y);
        }
    }
    if squares > 0.0 { products / squares } else { 0.0 }
}

/// The root mean square displacement of the vertices that may move, times their trust.
pub(super) fn mean_displacement(state: &State<'_>) -> f64 {
    let offsets = displacements(state).into_iter().enumerate();
    let free: Vec<f64> =
        offsets.filter(|&(v, _)| !state.input.is_fixed(v)).map(|(_, x)| x).collect();
    root_mean_square(&free)
}

/// The displacements of vertices from the surface, along its normals and times their trust.
fn displacements(state: &State<'_>) -> Vec<f64> {
    let offsets = offsets_along(state.mesh(), &state.surface, &state.normals);
    offsets.into_iter().zip(&state.vertex_trust).map(|(offset, t)| t * offset).collect()
}

/// The sum of the correlations of the displacement of a vertex with those of all vertices up to two
/// edges away, itself included (beyond a vertex with many neighbours none); at least one. The
/// variance of a mean over many vertices is that of independent noise times this factor.
fn correlation_sum(mesh: &TriMesh, offsets: &[f64]) -> f64 {
    let topology = mesh.topology();
    let term = |disc: &mut Vec<u32>, v: usize| {
        disc.clear();
        disc.push(v as u32);
        for &w in topology.neighbors(v as u32) {
            disc.push(w);
            let ring = topology.neighbors(w);
            if ring.len() <= HUB {
                disc.extend_from_slice(ring);
            }
        }
        disc.sort_unstable();
        disc.dedup();
        let sum: f64 = disc.iter().map(|&w| offsets[w as usize]).sum();
        let r = offsets[v];
        [r * sum, r * r]
    };
    let terms: Vec<[f64; 2]> = parallel::map_with(offsets.len(), 64, Vec::new, term);
    let [products, squares] = terms.iter().fold([0.0; 2], |s, t| [s[0] + t[0], s[1] + t[1]]);
    if squares > 0.0 { (products / squares).max(1.0) } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use fairing_shapes as shapes;

    use super::*;

    /// Independent displacements count one by one, apart from chance; means of them over two rings
    /// count as the number of vertices of about such a mean. Means of neighbours correlate.
    #[test]
    fn sums_show_correlated_displacements() {
        let mesh = shapes::plane(60, 60, shapes::Diagonals::Alternating);
        let noisy = shapes::jittered(&mesh, 0.1, 3, |p| p);
        let topology = noisy.topology();
        let mut state = 1u64;
        let white: Vec<f64> = (0..noisy.vertex_count())
            .map(|_| {
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
                (state >> 40) as f64 / (1u64 << 23) as f64 - 1.0
            })
            .collect();
        let averaged = |x: &[f64]| -> Vec<f64> {
            (0..x.len() as u32)
                .map(|v| {
                    let ring = topology.neighbors(v);
                    let sum: f64 = ring.iter().map(|&w| x[w as usize]).sum();
                    (sum + x[v as usize]) / (ring.len() + 1) as f64
                })
                .collect()
        };
        let correlated = correlation_sum(&noisy, &averaged(&averaged(&white)));
        assert!((7.0..20.0).contains(&correlated), "{correlated}");
        let independent = correlation_sum(&noisy, &white);
        assert!((1.0..1.4).contains(&independent), "{independent}");
        assert_eq!(correlation_sum(&noisy, &vec![0.0; noisy.vertex_count()]), 1.0);

        let across = |numbers: &[f64]| across_edges(&noisy, numbers.to_vec(), |_| true);
        let (apart, smooth) = (across(&white), across(&averaged(&white)));
        assert!(apart.abs() < 0.03, "{apart}");
        assert!((0.3..0.7).contains(&smooth), "{smooth}");
        // Neither vertices that are fixed nor a few far ones decide.
        let mut far = white.clone();
        (0..2 * 61).for_each(|v| far[v] = 1e9);
        assert!(across_edges(&noisy, far, |v| v >= 2 * 61).abs() < 0.03);
        let mut few = averaged(&white);
        (0..few.len()).step_by(97).for_each(|v| few[v] = -1e9);
        assert!(across(&few) > 0.8 * smooth);
        assert_eq!(across(&vec![0.0; noisy.vertex_count()]), 0.0);
    }
}
