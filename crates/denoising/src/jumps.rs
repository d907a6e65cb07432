//! Jumps of a field of normals across edges.

use fairing_mesh::TriMesh;
use fairing_sparse::parallel::update;
use fairing_watch::parallel;
use glam::DVec3;

use super::faces::{FaceShapes, Hinge, Hinges};

/// The quadratic step of an alternating direction method for functionals of the jumps of normals.
///
/// With noisy normals m, areas A, lengths ℓ of the hinges, the penalty r and wanted jumps q, all in
/// units of the mean edge length h, so that the numbers do not depend on the scale, the step
/// minimises
///
/// ```text
/// ½ Σ_faces A ‖n − m‖² + ½ r Σ_hinges ℓ ‖n_f − n_g − q‖²
/// ```
///
/// where f is the lower of the two faces of a hinge.
pub(crate) struct JumpSystem {
    pub(crate) hinges: Hinges,
    /// The normals m.
    pub(crate) noisy: Vec<[f64; 3]>,
    pub(crate) areas: Vec<f64>,
    /// The face across each side of each face, and the penalty times ℓ there;
    /// the face itself, and zero, where there is no hinge.
    across: Vec<[u32; 3]>,
    widths: Vec<[f64; 3]>,
    /// The lengths of the sides of all faces that have a hinge, in sum.
    lengths: f64,
}

/// The ratio of the lengths of hinges to the areas of faces, in sums over all and in units of h,
/// above which a system is stiff. It is 7 on even meshes, and about n/2 on a disc of n faces around
/// its centre.
const STIFF: f64 = 500.0;

impl JumpSystem {
    pub(crate) fn new(mesh: &TriMesh, penalty: f64) -> Self {
        let hinges = Hinges::new(mesh);
        let FaceShapes { normals, areas, .. } = FaceShapes::new(mesh);
        let h = mesh.mean_edge_length();
        let areas: Vec<f64> = areas.iter().map(|a| (a / (h * h)).max(1e-6)).collect();
        let side = |f: usize, e: u32| {
            let Some(hinge) = hinges.all.get(e as usize) else { return (f as u32, 0.0) };
            let [g, k] = hinge.faces;
            (if g as usize == f { k } else { g }, penalty * length(mesh, hinge) / h)
        };
        let lengths = 2.0 * hinges.all.iter().map(|hinge| length(mesh, hinge) / h).sum::<f64>();
        let sides = parallel::map(areas.len(), 64, |f| hinges.of_face[f].map(|e| side(f, e)));
        let across = sides.iter().map(|sides| sides.map(|(g, _)| g)).collect();
        let widths = sides.iter().map(|sides| sides.map(|(_, width)| width)).collect();
        let noisy = normals.iter().map(DVec3::to_array).collect();
        Self { hinges, noisy, areas, across, widths, lengths }
    }

    /// Row `f` of the matrix times x.
    #[inline]
    pub(crate) fn row(&self, x: &[[f64; 3]], f: usize) -> [f64; 3] {
        let (across, widths) = (&self.across[f], &self.widths[f]);
        let own = DVec3::from(x[f]);
        let mut sum = self.areas[f] * own;
        for k in 0..3 {
            sum += widths[k] * (own - DVec3::from(x[across[k] as usize]));
        }
        sum.to_array()
    }

    /// Returns true where faces are so thin that conjugate gradients take the more iterations the
    /// more faces there are, as around a vertex of thousands.
    pub(crate) fn is_stiff(&self) -> bool {
        self.lengths > STIFF * self.areas.iter().sum::<f64>()
    }

    /// The face across each hinge of face `f`, with the penalty there.
    pub(crate) fn sides(&self, f: usize) -> impl Iterator<Item = (u32, f64)> + '_ {
        let sides = self.across[f].into_iter().zip(self.widths[f]);
        sides.filter(move |(g, _)| *g as usize != f)
    }

    /// The diagonal of the matrix.
    pub(crate) fn diagonal(&self) -> Vec<f64> {
        let faces = self.areas.iter().zip(&self.widths);
        faces.map(|(area, widths)| area + widths.iter().sum::<f64>()).collect()
    }

    /// The right-hand side: the noisy normals and the wanted jump of each hinge.
    pub(crate) fn right_hand_side(
        &self,
        wanted: impl Fn(usize) -> DVec3 + Sync,
        b: &mut [[f64; 3]],
    ) {
        update(b, |f, _| {
            let mut sum = self.areas[f] * DVec3::from(self.noisy[f]);
            for k in 0..3 {
                let e = self.hinges.of_face[f][k] as usize;
                if e < self.hinges.all.len() {
                    sum += self.sign(f, k) * self.widths[f][k] * wanted(e);
                }
            }
            (sum.to_array(), ())
        });
    }

    /// 1 if face `f` is the lower one at its side `k`, and −1 otherwise: a jump times this sign
    /// points out of the face.
    pub(crate) fn sign(&self, f: usize, k: usize) -> f64 {
        if (f as u32) < self.across[f][k] { 1.0 } else { -1.0 }
    }

    /// The jump of a field across hinge `e`: the value of the lower face less that of the other.
    #[inline]
    pub(crate) fn jump(&self, x: &[[f64; 3]], e: usize) -> DVec3 {
        let [f, g] = self.hinges.all[e].faces.map(|f| DVec3::from(x[f as usize]));
        f - g
    }
}

/// The length of a hinge, in mesh units.
pub(crate) fn length(mesh: &TriMesh, hinge: &Hinge) -> f64 {
    let [a, b] = hinge.ends.map(|v| DVec3::from(mesh.positions()[v as usize]));
    a.distance(b)
}

/// The value wanted next of a quantity that costs its length: the quantity plus the dual variable,
/// shortened by `threshold`, minus the dual variable.
///
/// The dual variable is the quantity minus the value `wanted` before, or zero in the first step.
#[inline]
pub(crate) fn shorten(quantity: DVec3, wanted: [f64; 3], threshold: f64, first: bool) -> [f64; 3] {
    let dual = if first { DVec3::ZERO } else { quantity - DVec3::from(wanted) };
    let q = quantity + dual;
    let size = q.length();
    let kept = size - threshold;
    let short = if kept > 0.0 { q * (kept / size) } else { DVec3::ZERO };
    (short - dual).to_array()
}

#[cfg(test)]
mod tests {
    use fairing_shapes as shapes;

    use super::*;

    /// The matrix is that of Σ A x² + r Σ ℓ (x_f − x_g)² over the hinges, and the right-hand side
    /// of the jumps of a field is the matrix times the field where the noisy normals are the field.
    #[test]
    fn the_matrix_is_that_of_the_jumps() {
        let plane = shapes::plane(4, 3, shapes::Diagonals::Alternating);
        for mesh in [shapes::cad_block(0.3), plane] {
            let system = JumpSystem::new(&mesh, 1.4);
            let x = &system.noisy;
            let vector = |x: [f64; 3]| DVec3::from(x);
            let h = mesh.mean_edge_length();
            let mut expected: f64 =
                x.iter().zip(&system.areas).map(|(x, a)| a * vector(*x).length_squared()).sum();
            for hinge in &system.hinges.all {
                let [a, b] = hinge.ends.map(|v| vector(mesh.positions()[v as usize]));
                let [f, g] = hinge.faces.map(|f| vector(x[f as usize]));
                expected += 1.4 * a.distance(b) / h * f.distance_squared(g);
            }
            let found: f64 = (0..x.len()).map(|f| vector(x[f]).dot(vector(system.row(x, f)))).sum();
            assert!((found - expected).abs() < 1e-12 * expected, "{found} {expected}");
            let mut b = vec![[0.0; 3]; x.len()];
            system.right_hand_side(|e| system.jump(x, e), &mut b);
            let mut unit = vec![[0.0; 3]; x.len()];
            for f in 0..x.len() {
                // A few terms, in the same order but for the sign of a zero.
                assert!(vector(b[f]).distance(vector(system.row(x, f))) < 1e-13, "{:?}", b[f]);
                unit[f] = [1.0; 3];
                assert!((system.row(&unit, f)[0] - system.diagonal()[f]).abs() < 1e-13);
                unit[f] = [0.0; 3];
            }
        }
    }
}
