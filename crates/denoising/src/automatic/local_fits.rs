//! Polynomials fitted around each face at the largest scale the data allow.

use fairing_mesh::TriMesh;
use fairing_mesh::vec3::{add, cross, distance, dot, norm, scale, sub};
use fairing_operators::NormalEquations;
use rayon::prelude::*;

use crate::faces::{FaceShapes, Hinges, NO_HINGE, unit_or_zero};

/// The radii tried, in mean edge lengths: 1.3, 1.69, … 8.2.
const RADII: [f64; 8] = [1.3, 1.69, 2.197, 2.856, 3.713, 4.827, 6.275, 8.157];

/// Faces that turn further from the face of the fit (60°) are out of its
/// region: the surface is no height field there.
const HEIGHT_FIELD: f64 = 0.5;

/// The points a plane and a quadric need at least: more than their unknowns.
const PLANE_POINTS: usize = 6;
const QUADRIC_POINTS: usize = 9;

/// The least sum of the weights, so that a few outliers do not carry a fit.
const LEAST_WEIGHT: f64 = 3.5;

/// What is fitted, and where it may not cross.
pub(super) struct Regions<'a> {
    /// The positions that are fitted.
    pub(super) noisy: &'a TriMesh,
    /// The positions that say what is near.
    pub(super) current: &'a TriMesh,
    /// A unit normal for each face: the direction of heights.
    pub(super) normals: &'a [[f64; 3]],
    pub(super) hinges: &'a Hinges,
    /// For each hinge, whether regions end there.
    pub(super) crease: &'a [bool],
    /// The weight of each vertex.
    pub(super) weights: &'a [f64],
}

impl Regions<'_> {
    /// The centroids of the current mesh.
    pub(super) fn centroids(&self) -> Vec<[f64; 3]> {
        FaceShapes::new(self.current).centroids
    }

    /// The faces across the sides of face `f` that are no creases.
    pub(super) fn across(&self, f: u32) -> impl Iterator<Item = u32> + '_ {
        let sides = self.hinges.of_face[f as usize].into_iter();
        sides.filter(|&e| e != NO_HINGE && !self.crease[e as usize]).map(move |e| {
            let [a, b] = self.hinges.all[e as usize].faces;
            if a == f { b } else { a }
        })
    }
}

/// How scales are compared.
#[derive(Debug, Clone, Copy)]
pub(super) struct FitRule {
    /// The standard deviation of the heights, in mesh units.
    pub(super) sigma: f64,
    /// How many standard deviations two slopes may differ by.
    pub(super) agreement: f64,
}

/// A height field `c₀ + c₁x + c₂y + c₃x² + c₄xy + c₅y²` over a frame.
#[derive(Debug, Clone, Copy)]
pub(super) struct Fit {
    origin: [f64; 3],
    axes: [[f64; 3]; 3],
    coefficients: [f64; 6],
    variance: f64,
    radius: f64,
}

impl Fit {
    /// The unit normal above a point.
    pub(super) fn normal_at(&self, p: [f64; 3]) -> [f64; 3] {
        let d = sub(p, self.origin);
        let (x, y) = (dot(d, self.axes[0]), dot(d, self.axes[1]));
        let c = &self.coefficients;
        let slope_x = c[1] + 2.0 * c[3] * x + c[4] * y;
        let slope_y = c[2] + c[4] * x + 2.0 * c[5] * y;
        let tilt = add(scale(self.axes[0], slope_x), scale(self.axes[1], slope_y));
        unit_or_zero(sub(self.axes[2], tilt))
    }

    /// The variance of the slope at the origin, both components together.
    pub(super) fn variance(&self) -> f64 {
        self.variance
    }

    pub(super) fn origin(&self) -> [f64; 3] {
        self.origin
    }

    pub(super) fn radius(&self) -> f64 {
        self.radius
    }
}

/// A fit around the centroid of each face, or `None` where too few vertices
/// determine none.
///
/// Planes and quadrics are fitted to the noisy vertices of the region that
/// grows from the face, at growing radii, without crossing creases. Among them
/// the one with the least variance of its slope is kept that agrees with all
/// others of its kind at smaller radii, and with all kept so far of the other
/// kind: Lepski's rule, which stops as soon as the shape shows through the
/// noise.
///
/// Source: \[lepski1991\].
pub(super) fn local_fits(regions: &Regions<'_>, rule: &FitRule) -> Vec<Option<Fit>> {
    let count = regions.noisy.face_count();
    let h = regions.noisy.mean_edge_length();
    let centroids = regions.centroids();
    let block = (count / 64).max(1024);
    let blocks: Vec<Vec<Option<Fit>>> = (0..count.div_ceil(block))
        .into_par_iter()
        .map(|k| {
            let mut growth = Growth::new(regions, &centroids, h);
            (k * block..((k + 1) * block).min(count))
                .map(|f| fit_face(regions, rule, f as u32, &mut growth))
                .collect()
        })
        .collect();
    blocks.into_iter().flatten().collect()
}

/// A region that grows from a face, and the equations of its fits.
struct Growth<'a> {
    regions: &'a Regions<'a>,
    centroids: &'a [[f64; 3]],
    h: f64,
    /// The faces and vertices that have been seen carry the current stamp.
    faces: Vec<u32>,
    vertices: Vec<u32>,
    stamp: u32,
    /// Seen, but too far so far.
    frontier: Vec<u32>,
    queue: Vec<u32>,
    frame: [[f64; 3]; 3],
    origin: [f64; 3],
    planes: NormalEquations<3>,
    quadrics: NormalEquations<6>,
    points: usize,
    weight: f64,
}

impl<'a> Growth<'a> {
    fn new(regions: &'a Regions<'a>, centroids: &'a [[f64; 3]], h: f64) -> Self {
        Self {
            regions,
            centroids,
            h,
            faces: vec![0; centroids.len()],
            vertices: vec![0; regions.noisy.vertex_count()],
            stamp: 0,
            frontier: vec![],
            queue: vec![],
            frame: [[0.0; 3]; 3],
            origin: [0.0; 3],
            planes: NormalEquations::default(),
            quadrics: NormalEquations::default(),
            points: 0,
            weight: 0.0,
        }
    }

    /// Begins a region at face `f`.
    fn start(&mut self, f: u32) {
        self.frame = self.frame_of(f);
        self.origin = self.centroids[f as usize];
        self.planes = NormalEquations::default();
        self.quadrics = NormalEquations::default();
        (self.points, self.weight) = (0, 0.0);
        self.stamp += 1;
        self.faces[f as usize] = self.stamp;
        self.frontier.clear();
        self.frontier.push(f);
    }

    /// The axes of the fit around face `f`: the last is the direction of
    /// heights, the first points along the longest side of the face. They turn
    /// with the mesh, and so do all decisions that depend on them, such as
    /// whether the vertices of a thin strip determine a fit.
    fn frame_of(&self, f: u32) -> [[f64; 3]; 3] {
        let n = self.regions.normals[f as usize];
        let [a, b, c] = self.regions.current.triangle(f as usize);
        let sides = [sub(b, a), sub(c, b), sub(a, c)];
        let square = |k: usize| dot(sides[k], sides[k]);
        let longest = (1..3).fold(0, |best, k| if square(k) > square(best) { k } else { best });
        let across = cross(n, sides[longest]);
        // A side along the direction of heights leaves any axis as good.
        let steep = norm(across) <= 1e-6 * norm(sides[longest]);
        let axis = if n[0].abs() < 0.6 { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] };
        let e2 = unit_or_zero(if steep { cross(n, axis) } else { across });
        [cross(e2, n), e2, n]
    }

    /// Takes in the faces up to a radius, in mesh units.
    fn grow(&mut self, radius: f64) {
        std::mem::swap(&mut self.queue, &mut self.frontier);
        self.frontier.clear();
        let mut i = 0;
        while i < self.queue.len() {
            let g = self.queue[i];
            i += 1;
            let turned = dot(self.regions.normals[g as usize], self.frame[2]) < HEIGHT_FIELD;
            if turned || distance(self.centroids[g as usize], self.origin) > radius {
                self.frontier.push(g);
                continue;
            }
            for v in self.regions.noisy.faces()[g as usize] {
                self.add(v as usize);
            }
            for other in self.regions.across(g) {
                if self.faces[other as usize] != self.stamp {
                    self.faces[other as usize] = self.stamp;
                    self.queue.push(other);
                }
            }
        }
        self.queue.clear();
    }

    /// Adds a vertex to the equations, once.
    fn add(&mut self, v: usize) {
        if self.vertices[v] == self.stamp {
            return;
        }
        self.vertices[v] = self.stamp;
        let w = self.regions.weights[v];
        let d = scale(sub(self.regions.noisy.positions()[v], self.origin), 1.0 / self.h);
        let [x, y, z] = self.frame.map(|e| dot(d, e));
        self.planes.add(&[1.0, x, y], z, w);
        self.quadrics.add(&[1.0, x, y, x * x, x * y, y * y], z, w);
        self.points += 1;
        self.weight += w;
    }

    /// The plane and its slope variance, in units of h and of σ²/h².
    fn plane(&self) -> Option<([f64; 6], f64)> {
        let factor = self.planes.factor().filter(|_| self.points >= PLANE_POINTS)?;
        let c = factor.solve(self.planes.rhs());
        let variance = factor.variance(&[0.0, 1.0, 0.0]) + factor.variance(&[0.0, 0.0, 1.0]);
        Some(([c[0], c[1], c[2], 0.0, 0.0, 0.0], variance))
    }

    /// The quadric and its slope variance at the origin, in the same units.
    fn quadric(&self) -> Option<([f64; 6], f64)> {
        let factor = self.quadrics.factor().filter(|_| self.points >= QUADRIC_POINTS)?;
        let variance = factor.variance(&[0.0, 1.0, 0.0, 0.0, 0.0, 0.0])
            + factor.variance(&[0.0, 0.0, 1.0, 0.0, 0.0, 0.0]);
        Some((factor.solve(self.quadrics.rhs()), variance))
    }
}

/// Lepski's rule around face `f`.
fn fit_face(regions: &Regions<'_>, rule: &FitRule, f: u32, growth: &mut Growth<'_>) -> Option<Fit> {
    if regions.normals[f as usize] == [0.0; 3] {
        return None;
    }
    growth.start(f);
    let h = growth.h;
    let mut accepted: Vec<([f64; 2], f64)> = vec![];
    let mut best: Option<Fit> = None;
    // Whether planes and quadrics have agreed so far.
    let mut alive = [true, true];
    for radius in RADII {
        growth.grow(radius * h);
        if growth.weight < LEAST_WEIGHT {
            continue;
        }
        for (kind, alive) in alive.iter_mut().enumerate().filter(|(_, alive)| **alive) {
            let fit = if kind == 0 { growth.plane() } else { growth.quadric() };
            let Some((c, variance)) = fit else { continue };
            let variance = variance * (rule.sigma / h).powi(2);
            let slope = [c[1], c[2]];
            *alive = accepted.iter().all(|&(a, v)| {
                let difference = (a[0] - slope[0]).powi(2) + (a[1] - slope[1]).powi(2);
                difference <= rule.agreement.powi(2) * v.max(variance)
            });
            if *alive {
                accepted.push((slope, variance));
                if best.is_none_or(|b| variance < b.variance) {
                    best = Some(Fit {
                        origin: growth.origin,
                        axes: growth.frame,
                        coefficients: [c[0] * h, c[1], c[2], c[3] / h, c[4] / h, c[5] / h],
                        variance,
                        radius: radius * h,
                    });
                }
            }
        }
        if growth.frontier.is_empty() || alive == [false, false] {
            break;
        }
    }
    best
}
