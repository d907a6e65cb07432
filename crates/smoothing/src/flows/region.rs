//! Fairing of a region with fixed surroundings.

use fairing_mesh::{RepairError, RepairOptions, Repaired, TriMesh, repair_with};
use fairing_operators::{LaplacianKind, LumpedArea, MassKind};
use fairing_parameters::Options;
use fairing_sparse::{Cholesky, LaplacianPower, SparseMatrix, larger};

use crate::engine::assemble::operators;
use crate::engine::diffusion::{
    AREA, OPERATOR, WEIGHTS, check_areas, chosen, refuse_with_uniform, weights,
};
use crate::engine::error::{FlowError, FlowFailure};
use crate::engine::outcome::{Approach, Report, Smoothed};
use crate::engine::run::refuse_unwelded;

fairing_parameters::options! {
    /// Options of [`fair_region`].
    #[derive(Debug, Clone, PartialEq)]
    #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
    #[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
    pub struct FairRegion {
        /// The vertices to replace.
        pub region: Vec<u32> = Vec::new(), name "vertices", required true;
        /// The order of the energy: 1 membrane, 2 thin plate, 3 minimum variation of curvature.
        pub order: u32 = 2, in 1.0..=4.0;
        /// The areas of vertices for cotangents.
        pub area: LumpedArea = LumpedArea::Barycentric;
        /// The kind of cotangent Laplacian; auto means cotangent for areas other than barycentric.
        pub kind: LaplacianKind = LaplacianKind::Auto, name "operator";
    }
    "region": "replaces a region by the smoothest surface that fits its surroundings", ["botsch2004"];
    also [weights("cotangent")];
    then |options, values| {
        if values.text(WEIGHTS) == Some("uniform") {
            refuse_with_uniform(values, &[OPERATOR, AREA])?;
            options.kind = LaplacianKind::Uniform;
        }
        check_areas(options.kind, options.area, values)
    };
}

impl FairRegion {
    /// A thin plate over `region`, with cotangent weights and barycentric areas.
    pub fn new(region: Vec<u32>) -> Self {
        Self { region, ..Self::DEFAULT }
    }
}

/// Replaces the vertices of a region by the solution of `Δᵏ x = 0` with all other vertices fixed.
///
/// ```text
/// K = S (M⁻¹ S)ᵏ⁻¹,    K_rr x_r = −K_ro x_o
/// ```
///
/// for the vertices r of the region and o outside: the minimum of the discrete `∫ ‖∇ᵏ x‖²`. The k
/// rings around the region are boundary values; at a boundary of the mesh the conditions are
/// natural (free). The operator is that of the input; a second call uses that of the first result.
///
/// # Errors
///
/// [`FlowError`] if the order is out of range, if a vertex does not exist, if a face is too thin
/// for cotangents, or if the region contains a whole component, whose position is then
/// undetermined; [`FlowFailure::NotConverged`] if the region is too wide for the order, so that the
/// factor has no correct digits; [`FlowFailure::Hub`] if thousands of its vertices have one
/// neighbour in common, so that the matrix would be dense.
///
/// # Examples
///
/// ```
/// use fairing_shapes as shapes;
/// use fairing_smoothing::{FairRegion, fair_region};
///
/// // The upper cap of a sphere, replaced by a membrane: flat above its rim.
/// let sphere = shapes::icosphere(3);
/// let cap = (0..sphere.vertex_count() as u32)
///     .filter(|&v| sphere.positions()[v as usize][2] > 0.7)
///     .collect();
/// let flat = fair_region(&sphere, &FairRegion { order: 1, ..FairRegion::new(cap) })?;
/// assert!(flat.mesh.positions().iter().all(|p| p[2] < 0.75));
/// # Ok::<(), fairing_smoothing::FlowError>(())
/// ```
///
/// Source: [botsch2004].
///
/// [botsch2004]: https://www.graphics.rwth-aachen.de/media/papers/modeling1.pdf
#[doc(alias("minimize_area", "minimize_curvature"))]
pub fn fair_region(mesh: &TriMesh, options: &FairRegion) -> Result<Smoothed, FlowError> {
    let (solved, too_thin) = solve(mesh, options).map_err(|failure| failure.before(mesh))?;
    let approach = Approach::Cholesky { factorisations: 1 };
    let report = Report { iterations: 1, approach, too_thin, ..Report::default() };
    Ok(Smoothed { mesh: solved, report })
}

/// The faired mesh, and the first face too thin for cotangents if that decided the kind of
/// Laplacian.
fn solve(mesh: &TriMesh, options: &FairRegion) -> Result<(TriMesh, Option<u32>), FlowFailure> {
    options.check()?;
    refuse_unwelded(mesh)?;
    let region = vertices(mesh, &options.region)?;
    if region.is_empty() {
        return Ok((mesh.clone(), None));
    }
    let (kinds, too_thin) = match options.kind {
        LaplacianKind::Uniform => ((LaplacianKind::Uniform, MassKind::Degree), None),
        kind => {
            let (kind, too_thin) = chosen(mesh, kind, options.area)?;
            ((kind, options.area.into()), too_thin)
        }
    };
    let (stiffness, mass) = operators(mesh, kinds)?;
    refuse_hub(mesh, &region, options.order)?;
    let power = LaplacianPower::new(&stiffness, &mass, options.order);
    let right = from_outside(&power, &region, mesh.positions());
    let factor =
        Cholesky::new(&symmetric(&power.principal(&region))).map_err(FlowFailure::NotFactored)?;
    let mut positions = mesh.positions().to_vec();
    for (&v, p) in region.iter().zip(factor.solve_points(&right)) {
        positions[v as usize] = p;
    }
    refine(&factor, &power, mesh.faces(), &region, &mut positions)?;
    Ok((mesh.with_positions(positions)?, too_thin))
}

/// The distinct vertices of a region in ascending order, without isolated vertices, whose rows are
/// empty.
fn vertices(mesh: &TriMesh, region: &[u32]) -> Result<Vec<u32>, FlowFailure> {
    let mut region = region.to_vec();
    region.sort_unstable();
    region.dedup();
    let vertex_count = mesh.vertex_count();
    if let Some(&vertex) = region.iter().find(|&&v| v as usize >= vertex_count) {
        return Err(FlowFailure::NoSuchVertex { vertex, vertex_count });
    }
    region.retain(|&v| !mesh.incidence().corners(v).is_empty());
    Ok(region)
}

/// Refuses a region whose matrix would be dense: neighbours of one vertex are neighbours of each
/// other in a power of a Laplacian.
fn refuse_hub(mesh: &TriMesh, region: &[u32], order: u32) -> Result<(), FlowFailure> {
    let topology = mesh.topology();
    let mut inside = vec![0usize; mesh.vertex_count()];
    for &v in region {
        inside[v as usize] += 1;
        topology.neighbors(v).iter().for_each(|&w| inside[w as usize] += 1);
    }
    // The products in each row of the power, repeated ones counted.
    let mut products = inside.clone();
    for _ in 1..order {
        let row = |v: usize| {
            let around: usize =
                topology.neighbors(v as u32).iter().map(|&w| products[w as usize]).sum();
            products[v] + around
        };
        products = (0..products.len()).map(row).collect();
    }
    let total: usize = region.iter().map(|&v| products[v as usize]).sum();
    if total <= SLACK * 7usize.pow(order) * region.len() + FULL_ROWS * FULL_ROWS {
        return Ok(());
    }
    let hub = (0..inside.len()).max_by_key(|&v| inside[v]).unwrap_or_default();
    Err(FlowFailure::Hub { vertex: hub as u32, neighbors: inside[hub] })
}

/// The right-hand side of a region, from the positions outside.
fn from_outside(power: &LaplacianPower<'_>, region: &[u32], x: &[[f64; 3]]) -> Vec<[f64; 3]> {
    let mut outside = x.to_vec();
    for &v in region {
        outside[v as usize] = [0.0; 3];
    }
    let all = power.apply(&outside);
    region.iter().map(|&v| all[v as usize].map(|k| -k)).collect()
}

/// The largest number of products in a row of the matrix of a region, relative to that of a regular
/// mesh.
const SLACK: usize = 10;

/// The number of rows that may be full.
const FULL_ROWS: usize = 4000;

/// The largest number of corrections; two are the rule.
const MAX_CORRECTIONS: usize = 20;

/// The size of corrections, relative to the extent, that counts as rounding.
const SETTLED: f64 = 4.0 * f64::EPSILON;

/// The largest correction, relative to the extent, that is accepted after corrections have stopped
/// decreasing.
const ACCEPTED: f64 = 1e-10;

/// Refines the solution until corrections are negligible. The k-th power of a Laplacian over a
/// region m edges wide has a condition of m²ᵏ, so the factor and a residual in plain arithmetic
/// have few correct digits in the smooth part of a solution. One correct digit of the factor
/// suffices; the residual is computed in double-double arithmetic from the factors of the power.
fn refine(
    factor: &Cholesky,
    power: &LaplacianPower<'_>,
    faces: &[[u32; 3]],
    region: &[u32],
    x: &mut [[f64; 3]],
) -> Result<(), FlowFailure> {
    let corners = || faces.as_flattened().iter().map(|&v| x[v as usize]);
    let low = corners().fold([f64::INFINITY; 3], |m, p| [0, 1, 2].map(|k| m[k].min(p[k])));
    let high = corners().fold([f64::NEG_INFINITY; 3], |m, p| [0, 1, 2].map(|k| m[k].max(p[k])));
    let extent = (0..3).map(|k| (high[k] - low[k]).max(high[k].abs()).max(low[k].abs()));
    let extent = extent.fold(0.0, larger);
    let mut before = f64::INFINITY;
    for iterations in 1..=MAX_CORRECTIONS {
        let all = power.apply(x);
        let residual: Vec<[f64; 3]> = region.iter().map(|&v| all[v as usize].map(|y| -y)).collect();
        let mut largest = (0.0, 0u32);
        for (&v, d) in region.iter().zip(factor.solve_points(&residual)) {
            let p = &mut x[v as usize];
            *p = [0, 1, 2].map(|k| p[k] + d[k]);
            let size = d.into_iter().map(f64::abs).fold(0.0, larger);
            if size > largest.0 || size.is_nan() {
                largest = (size, v);
            }
        }
        let (size, vertex) = (largest.0 / extent, largest.1);
        if size <= SETTLED || extent == 0.0 {
            return Ok(());
        }
        // False for NaN.
        let contracts = size < 0.5 * before;
        if !contracts || iterations == MAX_CORRECTIONS {
            return if size <= ACCEPTED {
                Ok(())
            } else {
                Err(FlowFailure::NotConverged { residual: size, iterations, vertex })
            };
        }
        before = size;
    }
    Ok(())
}

/// The mean of a matrix and its transpose: products are symmetric only up to rounding.
fn symmetric(matrix: &SparseMatrix) -> SparseMatrix {
    let transpose = matrix.transpose_view().to_csr();
    (matrix + &transpose).map(|x| 0.5 * x)
}

/// Mends a mesh as [`fairing_mesh::repair`] does; the patches of holes continue the surface.
///
/// The vertices inside patches are placed by [`fair_region`]. If that fails, the patches stay as
/// [`fairing_mesh::repair`] made them, of least area, and the error is returned beside the result.
///
/// # Errors
///
/// Those of [`fairing_mesh::repair`].
///
/// # Examples
///
/// ```
/// use fairing_mesh::{RepairOptions, TriMesh};
/// use fairing_shapes as shapes;
/// use fairing_smoothing::repair_fair;
///
/// // A sphere without the faces around its first vertex.
/// let sphere = shapes::icosphere(3);
/// let faces = sphere.faces().iter().copied().filter(|face| !face.contains(&0)).collect();
/// let open = TriMesh::new(sphere.positions().to_vec(), faces)?;
/// let options = RepairOptions { holes: 10, ..RepairOptions::DEFAULT };
/// let (repaired, flat) = repair_fair(&open, &options)?;
/// assert!(flat.is_none() && repaired.mesh.topology().is_closed());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[doc(alias("fill_holes", "hole_filling"))]
pub fn repair_fair(
    mesh: &TriMesh,
    options: &RepairOptions,
) -> Result<(Repaired, Option<FlowError>), RepairError> {
    let mut flat = None;
    let repaired = repair_with(mesh, options, |mesh, patch| {
        let fair = fair_region(mesh, &FairRegion::new(patch));
        fair.map_err(|error| flat = Some(error)).ok().map(|fair| fair.mesh)
    })?;
    Ok((repaired, flat))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A few vertices at the rim of a disc with a hub: only their rows are multiplied. All of them
    /// are neighbours of each other in the matrix, so it is refused with an error that names the
    /// hub.
    #[test]
    fn a_region_around_a_hub_is_small_or_refused() {
        let n = 40_000u32;
        let rim = |i: u32| {
            let angle = std::f64::consts::TAU * f64::from(i) / f64::from(n);
            [angle.cos(), angle.sin(), 0.0]
        };
        let positions = std::iter::once([0.0; 3]).chain((0..n).map(rim)).collect();
        let faces = (0..n).map(|i| [0, 1 + i, 1 + (i + 1) % n]).collect();
        let disc = TriMesh::new(positions, faces).unwrap();
        let region = |last: u32, order| {
            fair_region(&disc, &FairRegion { order, ..FairRegion::new((5..last).collect()) })
        };
        let few = region(15, 2).unwrap();
        assert!(few.mesh.positions().iter().all(|p| p[2].abs() < 1e-12));
        let FlowError { failure, .. } = region(n, 2).unwrap_err();
        let neighbors = n as usize - 5;
        assert!(matches!(failure, FlowFailure::Hub { vertex: 0, neighbors: k } if k == neighbors));
        assert!(region(n, 1).is_ok());
    }
}
