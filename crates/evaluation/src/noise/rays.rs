//! Displacements along the rays from a camera.

use fairing_mesh::TriMesh;
use fairing_parameters::ParameterError;
use glam::DVec3;
use rand_chacha::ChaCha8Rng;

use super::field::correlated;
use crate::error::EvaluationError;
use crate::normal::standard_normal;

/// The fewest steps of disparity of the farthest vertex: its disparity stays positive with an
/// error of more than ten standard deviations, beyond what a generator draws.
const FEWEST_STEPS: f64 = 8.0;

/// The most trials for the number of steps that gives the level.
const TRIALS: usize = 16;

/// The position of the camera, by default three diagonals of the bounding box from its centre
/// along +z, and the centre.
///
/// # Errors
///
/// [`ParameterError`] for a coordinate that is not finite or beyond those of all meshes.
pub(crate) fn camera_and_centre(
    mesh: &TriMesh,
    camera: Option<[f64; 3]>,
) -> Result<[DVec3; 2], ParameterError> {
    let [low, high] = mesh.bounding_box().unwrap_or_default().map(DVec3::from);
    let centre = 0.5 * low + 0.5 * high;
    let eye = camera.map_or(centre + 3.0 * mesh.diagonal() * DVec3::Z, DVec3::from);
    for x in eye.to_array() {
        let near = x.abs() <= 1e31;
        ParameterError::require(near, "coordinate of the camera", x, "between -1e31 and 1e31")?;
    }
    Ok([eye, centre])
}

/// The displacements of noise along rays for σ = 1.
pub(super) fn along_rays(
    mesh: &TriMesh,
    camera: Option<[f64; 3]>,
    rng: &mut ChaCha8Rng,
) -> Result<Vec<DVec3>, EvaluationError> {
    let [eye, _] = camera_and_centre(mesh, camera)?;
    let along = |(v, &p): (usize, &[f64; 3])| {
        let ray = DVec3::from(p) - eye;
        let unit = ray.try_normalize().ok_or_else(|| unseen(v, eye))?;
        Ok(standard_normal(rng) * unit)
    };
    mesh.positions().iter().enumerate().map(along).collect()
}

/// The displacements of a depth camera whose root mean square is `sigma`.
pub(super) fn depth_camera(
    mesh: &TriMesh,
    camera: Option<[f64; 3]>,
    length: f64,
    sigma: f64,
    rng: &mut ChaCha8Rng,
) -> Result<Vec<DVec3>, EvaluationError> {
    let independent: Vec<f64> = (0..mesh.vertex_count()).map(|_| standard_normal(rng)).collect();
    let view = View::new(mesh, camera, correlated(mesh, &independent, length))?;
    if sigma == 0.0 || view.rays.is_empty() {
        return Ok(vec![DVec3::ZERO; mesh.vertex_count()]);
    }
    Ok(view.displacements(view.steps(sigma)?))
}

/// The rays from a camera to all vertices, with their depths and the errors of disparity.
struct View {
    rays: Vec<DVec3>,
    depths: Vec<f64>,
    /// In standard deviations, each half a step.
    errors: Vec<f64>,
}

impl View {
    fn new(
        mesh: &TriMesh,
        camera: Option<[f64; 3]>,
        errors: Vec<f64>,
    ) -> Result<Self, EvaluationError> {
        let [eye, centre] = camera_and_centre(mesh, camera)?;
        let axis = (centre - eye).normalize_or_zero();
        let rays: Vec<DVec3> = mesh.positions().iter().map(|&p| DVec3::from(p) - eye).collect();
        let depths: Vec<f64> = rays.iter().map(|ray| ray.dot(axis)).collect();
        match depths.iter().position(|&z| z <= 0.0) {
            Some(v) => Err(unseen(v, eye)),
            None => Ok(Self { rays, depths, errors }),
        }
    }

    /// The disparity of vertex v in steps as measured, where a depth of 1 has `steps` steps.
    fn measured(&self, v: usize, steps: f64) -> f64 {
        (steps / self.depths[v] + 0.5 * self.errors[v]).round()
    }

    fn displacements(&self, steps: f64) -> Vec<DVec3> {
        let moved = |(v, &ray): (usize, &DVec3)| {
            let depth = steps / self.measured(v, steps);
            (depth / self.depths[v] - 1.0) * ray
        };
        self.rays.iter().enumerate().map(moved).collect()
    }

    /// The steps of disparity at a depth of 1 that give the level.
    ///
    /// To first order the displacement is |p − c| Z e / steps, with an error e of ¼ from the
    /// measurement and 1/12 from rounding, squared.
    fn steps(&self, sigma: f64) -> Result<f64, EvaluationError> {
        let squares = |f: &dyn Fn(usize) -> f64| {
            let sum: f64 = (0..self.rays.len()).map(f).sum();
            (sum / self.rays.len() as f64).sqrt()
        };
        let spread = squares(&|v| self.rays[v].length_squared() * self.depths[v].powi(2) / 3.0);
        let farthest = self.depths.iter().fold(0.0, |m: f64, &z| m.max(z));
        let least = FEWEST_STEPS * farthest;
        let largest = spread / least;
        if sigma > largest {
            let expected = format!("at most {largest:.3e} for a depth camera at this distance");
            return Err(ParameterError::range("noise level in mesh units", sigma, expected).into());
        }
        let mut steps = spread / sigma;
        let mut best = (f64::INFINITY, steps);
        for _ in 0..TRIALS {
            let moved = self.displacements(steps);
            let ratio = squares(&|v| moved[v].length_squared()) / sigma;
            let off = (ratio - 1.0).abs();
            if off < best.0 {
                best = (off, steps);
            }
            if off < 1e-4 {
                break;
            }
            steps = (steps * ratio.clamp(0.5, 2.0)).max(0.75 * least);
        }
        Ok(best.1)
    }
}

fn unseen(vertex: usize, eye: DVec3) -> EvaluationError {
    EvaluationError::NotInFront { vertex: vertex as u32, camera: eye.to_array() }
}

#[cfg(test)]
mod tests {
    use fairing_shapes as shapes;
    use rand::SeedableRng;

    use super::*;

    /// A tilted plane becomes stairs: all measured disparities are whole numbers of steps, of
    /// which there are few, and the vertices lie at their depths.
    #[test]
    fn disparities_are_multiples_of_the_step() {
        let plane = shapes::plane(40, 40, shapes::Diagonals::Regular);
        let tilted = plane.positions().iter().map(|&[x, y, _]| [x, y, 0.3 * x]).collect();
        let plane = plane.with_positions(tilted).unwrap();
        let mut rng = ChaCha8Rng::seed_from_u64(3);
        let independent: Vec<f64> =
            plane.positions().iter().map(|_| standard_normal(&mut rng)).collect();
        let view = View::new(&plane, None, correlated(&plane, &independent, 3.0)).unwrap();
        let steps = view.steps(0.01).unwrap();
        let moved = view.displacements(steps);
        let axis = DVec3::NEG_Z;
        let mut seen = std::collections::BTreeSet::new();
        for (v, d) in moved.iter().enumerate() {
            let disparity = steps / (view.rays[v] + *d).dot(axis);
            assert!((disparity - disparity.round()).abs() < 1e-9 * disparity, "{disparity}");
            assert!((disparity - steps / view.depths[v]).abs() < 0.5 + 0.5 * 4.5);
            seen.insert(disparity.round() as i64);
        }
        assert!((5..60).contains(&seen.len()), "{}", seen.len());
    }
}
