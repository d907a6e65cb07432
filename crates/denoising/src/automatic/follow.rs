//! The surface follows its normals, and folds open.

use fairing_mesh::TriMesh;
use fairing_watch::parallel;
use glam::DVec3;

use crate::error::DenoiseError;
use crate::faces::{FaceLists, FaceShapes, longest_side};
use crate::masked::Masked;

/// The least area of a face, as a fraction of the mean area around it.
const MIN_FRACTION: f64 = 0.3;

/// The least area of a face, in noise levels times its longest side: the area that noise can
/// take away.
const MIN_NOISE: f64 = 0.5;

/// Cost of a move across the faces while folds open, as a multiple of a move within them.
const STIFFNESS: f64 = 4.0;

/// The motion of the surface towards given normals.
pub(super) struct Follow<'a> {
    noisy: Masked<'a>,
    /// The area below which a face counts as folded.
    least: Vec<f64>,
    /// The largest distance from the noisy vertices.
    limit: f64,
}

/// The data of a face in a step.
#[derive(Clone, Copy)]
struct Aim {
    /// The height of the centroid along the normal.
    height: f64,
    /// The factor on the gradient of the area of a folded face; zero for other faces.
    opening: f64,
}

impl<'a> Follow<'a> {
    /// The surface that follows normals under noise of the level `sigma`.
    pub(super) fn new(noisy: &'a TriMesh, rings: &FaceLists, sigma: f64, limit: f64) -> Self {
        let areas: Vec<f64> =
            parallel::map(noisy.face_count(), 64, |f| DVec3::from(noisy.area_vector(f)).length());
        let least = parallel::map(areas.len(), 64, |f| {
            let mean = rings.mean(&areas, f);
            (MIN_FRACTION * mean).min(MIN_NOISE * sigma * longest_side(noisy, f))
        });
        Self { noisy: noisy.into(), least, limit }
    }

    /// The same motion, without the vertices that are fixed in `noisy`, the same mesh.
    pub(super) fn with_fixed(self, noisy: Masked<'a>) -> Self {
        Self { noisy, ..self }
    }

    /// Moves the vertices of the noisy mesh so that its faces get the normals
    /// (zero for a face that is ignored), by steps of
    ///
    /// ```text
    /// x ← x + 1/|F| Σ n (n · (c − x)) + o
    /// ```
    ///
    /// over the faces F around a vertex with centroids c. The first part is that
    /// of [`update_vertices`](crate::update_vertices), which moves across the
    /// surface only. The second opens folds: a face with less than the least
    /// area, seen along its normal, moves each corner along the gradient of its
    /// area by as much as is missing; o is the mean over these faces, made
    /// smaller across the planes of all faces around the vertex.
    pub(super) fn run(
        &self,
        from: &[[f64; 3]],
        normals: &[DVec3],
        steps: usize,
    ) -> Result<TriMesh, DenoiseError> {
        let mut positions: Vec<DVec3> = from.iter().map(|&p| p.into()).collect();
        for _ in 0..steps {
            fairing_watch::check();
            positions = self.step(&positions, normals);
        }
        Ok(self.noisy.mesh().with_positions(positions.iter().map(DVec3::to_array).collect())?)
    }

    fn step(&self, x: &[DVec3], normals: &[DVec3]) -> Vec<DVec3> {
        let noisy = self.noisy.mesh();
        let (incidence, faces) = (noisy.incidence(), noisy.faces());
        let aims: Vec<Aim> = parallel::map(faces.len(), 64, |f| {
            let (normal, least) = (normals[f], self.least[f]);
            let [a, b, c] = faces[f].map(|v| x[v as usize]);
            let area = 0.5 * normal.dot((b - a).cross(c - a));
            let mut opening = 0.0;
            if area < least && normal != DVec3::ZERO {
                let square = |p, q| {
                    let g = normal.cross(q - p);
                    0.25 * g.dot(g)
                };
                let squares = square(b, c) + square(c, a) + square(a, b);
                opening = (least - area) / squares.max(f64::MIN_POSITIVE);
            }
            Aim { height: normal.dot((a + b + c) * (1.0 / 3.0)), opening }
        });
        parallel::map(x.len(), 64, |v| {
            if self.noisy.is_fixed(v) {
                return x[v];
            }
            let corners = incidence.corners(v as u32);
            let (mut sum, mut count) = (DVec3::ZERO, 0u32);
            let (mut open, mut folds) = (DVec3::ZERO, 0u32);
            for &c in corners {
                let (f, k) = (c as usize / 3, c as usize % 3);
                let (normal, Aim { height, opening }) = (normals[f], aims[f]);
                if normal == DVec3::ZERO {
                    continue;
                }
                sum += (height - normal.dot(x[v])) * normal;
                count += 1;
                if opening > 0.0 {
                    let [p, q] = [1, 2].map(|i| x[faces[f][(k + i) % 3] as usize]);
                    let gradient = 0.5 * normal.cross(q - p);
                    open += opening * gradient;
                    folds += 1;
                }
            }
            let mut y = x[v] + sum * (1.0 / f64::from(count.max(1)));
            if folds > 0 {
                let around = corners.iter().map(|&c| normals[c as usize / 3]);
                y += within(around, open * (1.0 / f64::from(folds)));
            }
            self.held(v, y)
        })
    }

    /// The position of vertex `v` moved towards `to`, no farther than the limit from its input
    /// position; fixed vertices stay there.
    pub(super) fn held(&self, v: usize, to: DVec3) -> DVec3 {
        let from = self.noisy.mesh().positions()[v].into();
        if self.noisy.is_fixed(v) { from } else { hold(from, to, self.limit) }
    }
}

/// The offset of each noisy vertex from the surface, along the mean of the `normals` of its faces.
pub(super) fn offsets_along(noisy: &TriMesh, surface: &TriMesh, normals: &[DVec3]) -> Vec<f64> {
    let mut up = vec![DVec3::ZERO; noisy.vertex_count()];
    for (face, &n) in noisy.faces().iter().zip(normals) {
        face.iter().for_each(|&v| up[v as usize] += n);
    }
    let positions = noisy.positions().iter().zip(surface.positions());
    let offset = |((&p, &x), up): ((&[f64; 3], &[f64; 3]), DVec3)| {
        up.normalize_or_zero().dot(DVec3::from(p) - DVec3::from(x))
    };
    positions.zip(up).map(offset).collect()
}

/// The minimiser of `‖d − o‖² + 4 Σ (n · d)²`: the solution of
/// `(I + 4 Σ n nᵀ) d = o`.
pub(super) fn within(normals: impl Iterator<Item = DVec3>, o: DVec3) -> DVec3 {
    let mut rows = [DVec3::X, DVec3::Y, DVec3::Z];
    for n in normals {
        for (row, x) in rows.iter_mut().zip(n.to_array()) {
            *row += STIFFNESS * x * n;
        }
    }
    // Positive definite with eigenvalues of at least one: elimination needs no
    // pivots.
    let [a, mut b, mut c] = rows;
    let mut o = o;
    let t = b[0] / a[0];
    (b, o[1]) = (b - t * a, o[1] - t * o[0]);
    let t = c[0] / a[0];
    (c, o[2]) = (c - t * a, o[2] - t * o[0]);
    let t = c[1] / b[1];
    (c, o[2]) = (c - t * b, o[2] - t * o[1]);
    let z = o[2] / c[2];
    let y = (o[1] - b[2] * z) / b[1];
    DVec3::new((o[0] - a[1] * y - a[2] * z) / a[0], y, z)
}

/// `x`, or the point towards it at the distance `limit` from `p`.
pub(super) fn hold(p: DVec3, x: DVec3, limit: f64) -> DVec3 {
    let offset = x - p;
    let length = offset.length();
    if length > limit { p + offset * (limit / length) } else { x }
}

/// The least cosine between the label of a face and its geometry: 11.5°.
const AGREE: f64 = 0.98;

/// Rounds; later ones move hardly any face.
const ROUNDS: usize = 4;

/// Gives a face whose geometry contradicts its label the label of a neighbour.
///
/// The vertices of the noisy mesh follow the labels for twenty steps. A face
/// whose geometry then differs from its label by more than 11.5° sits on the
/// wrong side of a crease: its other faces hold its vertices elsewhere. Such
/// faces are left out, the update is done again, and each takes the label of
/// the agreeing face around it that is closest to its new geometry. Four
/// rounds, or fewer when all agree.
pub(super) fn relabel(
    mesh: &TriMesh,
    rings: &FaceLists,
    mut labels: Vec<DVec3>,
    follow: &Follow<'_>,
) -> Result<Vec<DVec3>, DenoiseError> {
    let noisy = mesh.positions();
    for _ in 0..ROUNDS {
        fairing_watch::check();
        let geometry = FaceShapes::new(&follow.run(noisy, &labels, 20)?).normals;
        let kept: Vec<DVec3> = labels
            .iter()
            .zip(&geometry)
            .map(|(&n, &g)| if n.dot(g) < AGREE { DVec3::ZERO } else { n })
            .collect();
        if kept == labels {
            break;
        }
        let geometry = FaceShapes::new(&follow.run(noisy, &kept, 20)?).normals;
        labels = parallel::map(labels.len(), 64, |f| {
            if kept[f] != DVec3::ZERO {
                return kept[f];
            }
            let neighbours = rings.row(f).iter().map(|&g| kept[g as usize]);
            neighbours
                .filter(|n| *n != DVec3::ZERO)
                .max_by(|a, b| (*a).dot(geometry[f]).total_cmp(&(*b).dot(geometry[f])))
                .unwrap_or(labels[f])
        });
    }
    Ok(labels)
}

#[cfg(test)]
mod tests {
    use fairing_shapes as shapes;

    use super::*;

    fn opposing(mesh: &TriMesh, normals: &[DVec3]) -> usize {
        (0..mesh.face_count())
            .filter(|&f| DVec3::from(mesh.area_vector(f)).dot(normals[f]) <= 0.0)
            .count()
    }

    /// On a plane moves are free within and a twenty-fifth across; at a
    /// corner of three planes they are small in all directions.
    #[test]
    fn moves_stay_within_the_faces() {
        let flat = within([DVec3::Z; 6].into_iter(), DVec3::new(1.0, 2.0, 5.0));
        for (x, expected) in flat.to_array().into_iter().zip([1.0, 2.0, 5.0 / 25.0]) {
            assert!((x - expected).abs() < 1e-14, "{flat:?}");
        }
        let s = 0.5f64.sqrt();
        let tilted = [[s, s, 0.0], [s, s, 0.0], [0.0, s, s]].map(DVec3::from);
        let d = within(tilted.into_iter(), DVec3::new(0.3, -0.2, 0.9));
        let residual = tilted.iter().fold(d, |r, &n| r + STIFFNESS * n.dot(d) * n);
        for (x, o) in residual.to_array().into_iter().zip([0.3, -0.2, 0.9]) {
            assert!((x - o).abs() < 1e-14, "{residual:?}");
        }
    }

    /// Two inner vertices of a plane that have changed places fold the faces
    /// around them; all open, and the plane stays flat. No vertex goes further
    /// than the limit, even where that leaves a fold; a plane without folds
    /// stays as it is.
    #[test]
    fn folds_open() {
        let plane = shapes::plane(8, 8, shapes::Diagonals::Regular);
        let h = plane.mean_edge_length();
        let rings = FaceLists::rings(&plane);
        let normals = vec![DVec3::Z; plane.face_count()];
        let mut positions = plane.positions().to_vec();
        positions.swap(40, 41);
        let folded = plane.with_positions(positions).unwrap();
        assert!(opposing(&folded, &normals) >= 2);
        let follow = Follow::new(&folded, &rings, 0.3 * h, f64::INFINITY);
        let opened = follow.run(folded.positions(), &normals, 60).unwrap();
        assert_eq!(opposing(&opened, &normals), 0);
        assert!(opened.positions().iter().all(|p| p[2] == 0.0));
        let short = Follow::new(&folded, &rings, 0.3 * h, 1e-3 * h);
        let kept = short.run(folded.positions(), &normals, 10).unwrap();
        for (p, q) in kept.positions().iter().zip(folded.positions()) {
            assert!(DVec3::from(*p).distance((*q).into()) <= 1e-3 * h * (1.0 + 1e-12));
        }
        let follow = Follow::new(&plane, &rings, 0.01 * h, f64::INFINITY);
        let same = follow.run(plane.positions(), &normals, 5).unwrap();
        assert_eq!(same.positions(), plane.positions());
    }
}
