//! The bound on displacements: the measured noise.

use fairing_mesh::TriMesh;
use fairing_watch::parallel;
use glam::DVec3;

use super::follow::offsets_along;
use crate::error::DenoiseError;
use crate::masked::Masked;
use crate::noise_level::{LocalResiduals, NoiseEstimate};

/// The root mean square displacement along the normals over the level of the noise, at most:
/// Morozov's discrepancy principle. Where all of the displacement is noise it is 0.7 to 0.95.
const MAX_RATIO: f64 = 1.2;

/// Rounds of averaging over neighbours: the weights of some 150 vertices.
const ROUNDS: usize = 20;

/// The displacement that counts in full, in allowed ones: a few vertices far from the surface do
/// not restrain all around them.
const CLIP: f64 = 3.0;

/// The correlation of residuals across edges from which they are shape, not noise. That of
/// independent noise is negative, because each residual is in the fits of its neighbours.
const SHAPE: f64 = 0.15;

/// The fraction of the surface on which residuals have to be independent for their level there to
/// be that of the whole.
const ENOUGH: f64 = 0.5;

/// The level of residuals that shape can make, in mean edge lengths: relief of the height of the
/// edges would be steeper. On clean real and standard meshes it is 0.06 or less.
const RELIEF: f64 = 0.1;

/// The noise that displacements may remove.
pub(super) struct Allowed {
    /// The square of the level around each vertex; empty where the level is uniform.
    squares: Vec<f64>,
    /// The square of the level of the whole mesh.
    whole: f64,
}

impl Allowed {
    /// The noise of one level: correlated noise, whose residuals are alike.
    pub(super) fn uniform(sigma: f64) -> Self {
        Self { squares: vec![], whole: sigma * sigma }
    }

    /// The noise that residuals show. Where those of neighbours are independent, it is theirs;
    /// where they are alike, as on relief and at creases, it is that of the rest of the mesh. If
    /// they are independent on less than half of the surface, the level is smaller in
    /// proportion: relief and correlated noise cannot be distinguished. What exceeds a tenth of an
    /// edge is noise in any case.
    pub(super) fn measured(input: Masked<'_>, level: &NoiseEstimate) -> Self {
        let mesh = input.mesh();
        let LocalResiduals { squares, products, counts } = LocalResiduals::new(input, level);
        let [squares, products, counts] =
            [squares, products, counts].map(|numbers| averaged(mesh, numbers));
        let variance = level.sigma * level.sigma;
        let local: Vec<Option<[f64; 2]>> = (0..mesh.vertex_count())
            .map(|v| {
                let known = counts[v] > 0.0 && squares[v] > 0.0;
                let correlation = products[v] / squares[v];
                let independent = (1.0 - correlation / SHAPE).clamp(0.0, 1.0);
                known.then(|| [independent, variance * squares[v] / counts[v]])
            })
            .collect();
        let (mut count, mut share, mut sum) = (0.0, 0.0, 0.0);
        for [independent, square] in local.iter().flatten() {
            count += 1.0;
            share += independent;
            sum += independent * square;
        }
        if count == 0.0 {
            return Self::uniform(level.sigma);
        }
        let whole = sum / share.max(ENOUGH * count);
        let squares = local.into_iter().map(|found| match found {
            Some([independent, square]) => independent * square + (1.0 - independent) * whole,
            None => whole,
        });
        let mut allowed = Self { squares: squares.collect(), whole };
        let relief = RELIEF * mesh.mean_edge_length();
        allowed.at_least((variance - relief * relief).max(0.0).sqrt());
        allowed
    }

    /// Raises the level to at least `sigma` everywhere.
    pub(super) fn at_least(&mut self, sigma: f64) {
        let square = sigma * sigma;
        self.whole = self.whole.max(square);
        self.squares.iter_mut().for_each(|level| *level = level.max(square));
    }

    /// The noise times a factor.
    pub(super) fn scale(&mut self, factor: f64) {
        self.whole *= factor * factor;
        self.squares.iter_mut().for_each(|square| *square *= factor * factor);
    }

    /// The level of the whole mesh, in mesh units.
    pub(super) fn level(&self) -> f64 {
        self.whole.sqrt()
    }

    /// The largest mean square displacement around a vertex.
    fn at(&self, v: usize) -> f64 {
        MAX_RATIO * MAX_RATIO * self.squares.get(v).copied().unwrap_or(self.whole)
    }
}

/// A surface that moves no further than the noise, and the normals that it has there.
pub(super) struct Restrained {
    pub(super) mesh: TriMesh,
    pub(super) normals: Vec<DVec3>,
    /// The mean angle by which its faces differ from those of the surface found, in degrees.
    pub(super) turned: f64,
}

/// Shortens the displacements from the noisy mesh where their root mean square along the normals,
/// over some 150 vertices or over all of them, exceeds 1.2 times the level of the noise.
pub(super) fn restrained(
    input: Masked<'_>,
    surface: TriMesh,
    mut normals: Vec<DVec3>,
    noise: &Allowed,
) -> Result<Restrained, DenoiseError> {
    let noisy = input.mesh();
    let offsets = offsets_along(noisy, &surface, &normals);
    let squares: Vec<f64> = offsets.into_iter().map(|d| d * d).collect();
    let clipped = |v: usize, square: f64| square.min(CLIP * CLIP * noise.at(v));
    let shorter = |most: f64, found: f64| if found > most { (most / found).sqrt() } else { 1.0 };
    let mut factors = vec![1.0; squares.len()];
    if !noise.squares.is_empty() {
        let all = (0..squares.len()).map(|v| clipped(v, squares[v])).collect();
        let around = averaged(noisy, all).into_iter().enumerate();
        factors = around.map(|(v, found)| shorter(noise.at(v), found)).collect();
    }
    let (mut found, mut most) = (0.0, 0.0);
    for v in (0..squares.len()).filter(|&v| !input.is_fixed(v)) {
        found += clipped(v, factors[v] * factors[v] * squares[v]);
        most += noise.at(v);
    }
    let over = shorter(most, found);
    factors.iter_mut().for_each(|factor| *factor *= over);
    if factors.iter().all(|&factor| factor >= 1.0) {
        return Ok(Restrained { mesh: surface, normals, turned: 0.0 });
    }
    let positions = noisy.positions().iter().zip(surface.positions()).zip(&factors);
    let positions = positions
        .map(|((&p, &x), &factor)| DVec3::from(p).lerp(x.into(), factor).to_array())
        .collect();
    let mesh = surface.with_positions(positions)?;
    let mut turned = 0.0;
    for (f, face) in mesh.faces().iter().enumerate() {
        if face.iter().any(|&v| factors[v as usize] < 1.0) {
            let normal = DVec3::from(mesh.area_vector(f)).normalize_or(normals[f]);
            turned += libm::acos(normal.dot(normals[f]).clamp(-1.0, 1.0));
            normals[f] = normal;
        }
    }
    let turned = (turned / mesh.face_count().max(1) as f64).to_degrees();
    Ok(Restrained { mesh, normals, turned })
}

/// Means of numbers over some 150 vertices around each vertex.
fn averaged(mesh: &TriMesh, mut numbers: Vec<f64>) -> Vec<f64> {
    let topology = mesh.topology();
    for _ in 0..ROUNDS {
        numbers = parallel::map(numbers.len(), 64, |v| {
            let v = v as u32;
            let ring = topology.neighbors(v);
            let sum: f64 = ring.iter().map(|&w| numbers[w as usize]).sum();
            (numbers[v as usize] + sum) / (ring.len() + 1) as f64
        });
    }
    numbers
}

#[cfg(test)]
mod tests {
    use fairing_shapes as shapes;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    use super::*;
    use crate::{AutomaticOptions, automatic};

    fn gaussian(rng: &mut ChaCha8Rng) -> f64 {
        (0..12).map(|_| rng.random::<f64>()).sum::<f64>() - 6.0
    }

    /// A sphere of 2562 vertices with plane waves of four edges, together 0.12 edges high (root
    /// mean square), on the side where `z` exceeds `from`.
    fn relief(from: f64) -> TriMesh {
        let sphere = shapes::icosphere(4);
        let h = sphere.mean_edge_length();
        let mut rng = ChaCha8Rng::seed_from_u64(5);
        let waves: Vec<(DVec3, f64)> = (0..30)
            .map(|_| {
                let axis = DVec3::from([0; 3].map(|_| gaussian(&mut rng))).normalize();
                (axis * (std::f64::consts::TAU / (4.0 * h)), rng.random::<f64>() * 7.0)
            })
            .collect();
        let height = |p: DVec3| -> f64 {
            let sum: f64 = waves.iter().map(|(k, phase)| (k.dot(p) + phase).cos()).sum();
            0.12 * h * sum / (waves.len() as f64 / 2.0).sqrt()
        };
        let raised = sphere.positions().iter().map(|&p| DVec3::from(p)).map(|p| {
            let height = if p.z > from { height(p) } else { 0.0 };
            (p * (1.0 + height)).to_array()
        });
        sphere.with_positions(raised.collect()).unwrap()
    }

    /// Noise along the directions from the origin, in mean edge lengths.
    fn noisy(truth: &TriMesh, sigma: f64) -> TriMesh {
        let mut rng = ChaCha8Rng::seed_from_u64(9);
        let h = truth.mean_edge_length();
        let moved = truth.positions().iter().map(|&p| {
            let p = DVec3::from(p);
            (p + p.normalize() * (gaussian(&mut rng) * sigma * h)).to_array()
        });
        truth.with_positions(moved.collect()).unwrap()
    }

    /// The mean angle between the normals of faces with this property, in degrees.
    fn error(a: &TriMesh, b: &TriMesh, counts: impl Fn(DVec3) -> bool) -> f64 {
        let (mut sum, mut count) = (0.0, 0.0);
        for f in 0..a.face_count() {
            let [n, m] = [a, b].map(|mesh| DVec3::from(mesh.area_vector(f)).normalize());
            if counts(DVec3::from(b.triangle(f)[0])) {
                sum += libm::acos(n.dot(m).clamp(-1.0, 1.0)).to_degrees();
                count += 1.0;
            }
        }
        sum / count
    }

    fn denoised(mesh: &TriMesh) -> crate::Automatic {
        automatic(mesh, &AutomaticOptions::default()).unwrap()
    }

    /// Relief as fine as four edges stays, without noise and with a little.
    #[test]
    fn relief_is_not_taken_for_noise() {
        let truth = relief(-2.0);
        for (sigma, most) in [(0.0, 2.0), (0.03, 1.5), (0.06, 1.5)] {
            let input = noisy(&truth, sigma);
            let result = denoised(&input);
            let [before, after] = [&input, &result.mesh].map(|m| error(m, &truth, |_| true));
            assert!(after < before + most, "{sigma}: {before} before, {after} after");
            assert!(result.undecided > 0.0);
        }
        // The same without relief.
        let sphere = shapes::icosphere(4);
        let input = noisy(&sphere, 0.06);
        let result = denoised(&input);
        let [before, after] = [&input, &result.mesh].map(|m| error(m, &sphere, |_| true));
        assert!(after < 0.3 * before, "{before} before, {after} after");
        assert!(result.undecided < 0.2 * result.noise.unwrap().sigma);
    }

    /// Noise goes where there is no relief, whatever is elsewhere.
    #[test]
    fn relief_in_one_place_keeps_no_noise_in_another() {
        let truth = relief(0.0);
        let input = noisy(&truth, 0.06);
        let result = denoised(&input).mesh;
        let smooth = |p: DVec3| p.z < -0.25;
        let rough = |p: DVec3| p.z > 0.25;
        let [before, after] = [&input, &result].map(|m| error(m, &truth, smooth));
        assert!(after < 0.5 * before, "{before} before, {after} after");
        let [before, after] = [&input, &result].map(|m| error(m, &truth, rough));
        assert!(after < before + 1.5, "{before} before, {after} after");
    }
}
