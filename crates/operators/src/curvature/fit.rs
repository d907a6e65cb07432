//! What the fits of polynomials share: local coordinates, and the curvature of
//! a height field.

use fairing_mesh::vec3::{distance, dot, sub};
use fairing_mesh::{Topology, TriMesh};

use super::field::{AtVertex, CurvatureField};
use super::neighborhood::{Explorer, Neighborhood};
use super::status::Undefined;
use crate::error::OperatorError;
use crate::normals::vertex_normals;
use crate::surface::{ChartNormal, FundamentalForms, SurfaceJet};
use crate::tangent::tangent_frame;

/// A neighbourhood as a height field: the vertex in the origin, its normal
/// upwards, lengths in units of `scale`.
pub(crate) struct HeightField<'a> {
    mesh: &'a TriMesh,
    /// The vertex, then its neighbours.
    vertices: &'a [u32],
    frame: [[f64; 3]; 2],
    normal: [f64; 3],
    scale: f64,
}

impl HeightField<'_> {
    /// `[x, y, z]` of the neighbours, without the vertex itself.
    #[inline]
    pub(crate) fn neighbors(&self) -> impl Iterator<Item = [f64; 3]> + '_ {
        let positions = self.mesh.positions();
        let centre = positions[self.vertices[0] as usize];
        let unit = 1.0 / self.scale;
        self.vertices[1..].iter().map(move |&w| {
            let d = sub(positions[w as usize], centre);
            [dot(d, self.frame[0]) * unit, dot(d, self.frame[1]) * unit, dot(d, self.normal) * unit]
        })
    }

    /// The curvature at the origin of a height field with this gradient and
    /// these second derivatives xx, xy, yy there, in local units.
    pub(crate) fn curvature(&self, [zx, zy]: [f64; 2], second: [f64; 3]) -> Option<AtVertex> {
        let jet = SurfaceJet {
            point: [0.0; 3],
            du: [1.0, 0.0, zx],
            dv: [0.0, 1.0, zy],
            duu: [0.0, 0.0, second[0]],
            duv: [0.0, 0.0, second[1]],
            dvv: [0.0, 0.0, second[2]],
        };
        let principal = FundamentalForms::of(jet, ChartNormal::Outward)?.principal();
        let in_space = |[x, y, z]: [f64; 3]| -> [f64; 3] {
            std::array::from_fn(|k| {
                x * self.frame[0][k] + y * self.frame[1][k] + z * self.normal[k]
            })
        };
        let values = principal.values.map(|k| k / self.scale);
        Some(AtVertex::new(values, principal.directions.map(in_space)))
    }
}

/// Fits every vertex on its own.
///
/// A neighbourhood with fewer than `at_least` others is widened; where the
/// connected part has no more, the vertex has too few neighbours. Where the
/// fit finds no solution the neighbours do not determine one.
pub(crate) fn fit_each<F>(
    mesh: &TriMesh,
    neighborhood: Neighborhood,
    at_least: usize,
    fit: F,
) -> Result<CurvatureField, OperatorError>
where
    F: Fn(&HeightField<'_>) -> Option<AtVertex> + Sync,
{
    let reach = neighborhood.reach(mesh)?;
    let topology: &Topology = mesh.topology();
    let normals = vertex_normals(mesh);
    let at_vertex = |explorer: &mut Explorer, v: u32| {
        if topology.neighbors(v).is_empty() {
            return Err(Undefined::Isolated);
        }
        let normal = normals[v as usize];
        if normal == [0.0; 3] {
            return Err(Undefined::NoArea);
        }
        explorer.explore(mesh, topology, v, reach, at_least);
        if explorer.found.len() <= at_least {
            return Err(Undefined::TooFewNeighbors);
        }
        let positions = mesh.positions();
        let centre = positions[v as usize];
        let others = &explorer.found[1..];
        let sum: f64 = others.iter().map(|&w| distance(positions[w as usize], centre)).sum();
        let scale = sum / others.len() as f64;
        if scale == 0.0 {
            return Err(Undefined::IllConditioned);
        }
        let vertices = &explorer.found;
        let field = HeightField { mesh, vertices, frame: tangent_frame(normal), normal, scale };
        fit(&field).ok_or(Undefined::IllConditioned)
    };
    Ok(CurvatureField::of_each(mesh, at_vertex))
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use fairing_mesh::shapes::{Diagonals, plane};

    /// The graph of a height over [−½, ½]², and its vertex in the middle.
    pub(crate) fn dome(height: impl Fn(f64, f64) -> f64) -> (TriMesh, usize) {
        let flat = plane(10, 10, Diagonals::Regular);
        let lift = |p: &[f64; 3]| {
            let [x, y] = [p[0] - 0.5, p[1] - 0.5];
            [x, y, height(x, y)]
        };
        let positions = flat.positions().iter().map(lift).collect();
        (flat.with_positions(positions).unwrap(), 60)
    }

    /// A slope is not curved, and the curvature of a cylinder does not depend
    /// on where the frame has its axes.
    #[test]
    fn gradients_are_taken_into_account() {
        let (mesh, v) = dome(|x, y| 0.3 * x - 0.7 * y);
        let flat = fit_each(&mesh, Neighborhood::Rings(1), 5, |f| f.curvature([0.0; 2], [0.0; 3]));
        assert_eq!(flat.unwrap().kappa1[v], 0.0);
        // z = ½ x² at x = 1 has the curvature 1 / (1 + 1)^(3/2), downwards.
        let scaled = fit_each(&mesh, Neighborhood::Rings(1), 5, |f| {
            f.curvature([1.0, 0.0], [f.scale, 0.0, 0.0])
        });
        let scaled = scaled.unwrap();
        assert!((scaled.kappa2[v] + 8f64.sqrt().recip()).abs() < 1e-14, "{}", scaled.kappa2[v]);
        assert_eq!(scaled.kappa1[v], 0.0);
    }
}
