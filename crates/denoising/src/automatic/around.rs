//! Sums over the faces around a face.

use fairing_watch::parallel;
use glam::DVec3;

use super::fits::{LocalFit, Moments, moments, tangents};
use super::state::{RANGES, State, similarities};
use crate::faces::{Marks, NO_HINGE};

/// The radii of neighbourhoods, in local scales.
pub(super) const RADII: [f64; 3] = [1.5, 3.0, 5.0];

/// The most hinges between the centre and a face of a neighbourhood. On a regular mesh the largest
/// radius is ten hinges wide; the rest is for stretched faces. Noise of several mean
/// edge lengths makes areas, and with them radii, so large that a ball alone would hold
/// thousands of faces.
const DEPTH: usize = 15;

/// The radius and the range of each local fit.
pub(super) const FITS: [(usize, usize); 5] = [(1, 1), (2, 1), (2, 0), (1, 3), (2, 3)];

/// Faces that are weighed together.
const LANES: usize = 4;

/// A number for each of some faces.
type Lanes = [f64; LANES];

/// Eight sums, as many as the widest vectors hold.
type Eight = [f64; 8];

/// The terms of a face in the sums of its neighbours.
struct Terms {
    /// The noisy area vector times its trust; the area times the present normal; the area;
    /// the area times the signed displacement along the normal.
    means: Eight,
    /// The area times: the products of two components of the present normal; the squared
    /// displacement; the agreement of the noisy normal with the present one.
    others: Eight,
}

impl Terms {
    fn new(state: &State<'_>, f: usize) -> Self {
        let (m, area) = (state.normals[f], state.current.areas[f]);
        let [a, b, c] = (state.noisy.areas[f] * state.trust[f] * state.noisy.normals[f]).to_array();
        let moved = state.noisy.centroids[f] - state.current.centroids[f];
        let (x, y, z) = (area * m.x, area * m.y, area * m.z);
        let agreement = area * m.dot(state.noisy.normals[f]);
        let square = area * moved.dot(moved);
        Self {
            means: [a, b, c, x, y, z, area, area * moved.dot(m)],
            others: [x * m.x, x * m.y, x * m.z, y * m.y, y * m.z, z * m.z, square, agreement],
        }
    }
}

/// Sums over the neighbourhood of a face.
pub(super) struct Sums {
    /// Weighted sums of [`Terms::means`], for each radius and range.
    pub(super) means: [[Eight; RANGES]; RADII.len()],
    /// Weighted sums of [`Terms::others`], for each radius.
    pub(super) others: [Eight; RADII.len()],
    pub(super) fits: [LocalFit; FITS.len()],
}

/// A few faces of a neighbourhood.
struct Group {
    faces: [u32; LANES],
    /// The weight by distance, for each radius.
    near: [Lanes; RADII.len()],
    /// The weight by similarity of normals, for each range.
    alike: [Lanes; RANGES],
    /// The trust in positions.
    trust: Lanes,
    /// The moments of the noisy centroids, along the axes of the face in the middle.
    moments: [Moments; LANES],
}

/// The data of all faces that their neighbours sum, for one stage.
pub(super) struct Surroundings<'a> {
    state: &'a State<'a>,
    terms: Vec<Terms>,
}

impl<'a> Surroundings<'a> {
    pub(super) fn new(state: &'a State<'a>) -> Self {
        let terms = parallel::map(state.normals.len(), 64, |f| Terms::new(state, f));
        Self { state, terms }
    }
}

/// Finds the faces around one, and sums over them.
pub(super) struct Gatherer<'a> {
    around: &'a Surroundings<'a>,
    marks: Marks,
    /// The faces found, and their squared distances in local scales; longer than the number found.
    found: Vec<(u32, f64)>,
    /// Faces seen for the first time.
    fresh: Vec<u32>,
    /// The faces found, those of smaller radii first.
    sorted: Vec<(u32, f64)>,
    groups: Vec<Group>,
}

impl<'a> Gatherer<'a> {
    pub(super) fn new(around: &'a Surroundings<'a>) -> Self {
        let marks = Marks::new(around.terms.len());
        let (found, fresh, sorted, groups) = (vec![], vec![], vec![], vec![]);
        Self { around, marks, found, fresh, sorted, groups }
    }

    pub(super) fn state(&self) -> &'a State<'a> {
        self.around.state
    }

    /// The sums around face `f`, which has a normal.
    #[inline(always)]
    pub(super) fn sums(&mut self, f: usize) -> Sums {
        let count = self.gather(f);
        let Self { around, found, sorted, groups, .. } = self;
        let ends = sort(&found[..count], sorted);
        group(around.state, f, sorted, groups);
        let within = |radius: usize| &groups[..ends[radius].div_ceil(LANES)];
        let mut sums = Sums {
            means: [[[0.0; 8]; RANGES]; RADII.len()],
            others: [[0.0; 8]; RADII.len()],
            fits: [LocalFit::EMPTY; FITS.len()],
        };
        for radius in 0..RADII.len() {
            (sums.means[radius], sums.others[radius]) =
                weighted(within(radius), radius, &around.terms);
        }
        const { assert!(FITS[0].0 == 1 && FITS[3].0 == 1) };
        [sums.fits[0], sums.fits[3]] = fitted(within(1), 1, [FITS[0].1, FITS[3].1]);
        const { assert!(FITS[1].0 == 2 && FITS[2].0 == 2 && FITS[4].0 == 2) };
        [sums.fits[1], sums.fits[2], sums.fits[4]] =
            fitted(within(2), 2, [FITS[1].1, FITS[2].1, FITS[4].1]);
        sums
    }

    /// Finds the faces around `f` up to the largest radius and at most [`DEPTH`] hinges away,
    /// itself first, and returns their number. The set does not depend on the numbering of the
    /// faces. Nearly no branch depends on the data: a third of the faces are new, in no order.
    #[inline(always)]
    fn gather(&mut self, f: usize) -> usize {
        let Self { around: Surroundings { state, .. }, marks, found, fresh, .. } = self;
        let centre = state.current.centroids[f];
        let inverse = 1.0 / (state.scales[f] * state.scales[f]);
        let reach = RADII[RADII.len() - 1] * RADII[RADII.len() - 1];
        marks.clear();
        marks.insert(f as u32);
        found.resize(found.len().max(1), (0, 0.0));
        found[0] = (f as u32, 0.0);
        let (mut begin, mut end) = (0, 1);
        for _ in 0..DEPTH {
            fresh.resize(fresh.len().max(3 * (end - begin)), 0);
            let mut new = 0;
            for &(g, _) in &found[begin..end] {
                for k in state.hinges.beside[g as usize] {
                    if k != NO_HINGE {
                        fresh[new] = k;
                        new += usize::from(marks.insert(k));
                    }
                }
            }
            found.resize(found.len().max(end + new), (0, 0.0));
            begin = end;
            for &k in &fresh[..new] {
                let d = inverse * state.current.centroids[k as usize].distance_squared(centre);
                found[end] = (k, d);
                end += usize::from(d < reach);
            }
        }
        end
    }
}

/// Sorts faces by the smallest radius that contains them, and returns the number within each
/// radius. The first face fills up the last group, from where its weight is zero.
#[inline(always)]
fn sort(found: &[(u32, f64)], sorted: &mut Vec<(u32, f64)>) -> [usize; RADII.len()] {
    let [inner, middle, _] = RADII.map(|r| r * r);
    let class = |d: f64| usize::from(d >= inner) + usize::from(d >= middle);
    let mut counts = [0; RADII.len()];
    for &(_, d) in found {
        counts[class(d)] += 1;
    }
    let ends = [counts[0], counts[0] + counts[1], found.len()];
    let mut next = [0, ends[0], ends[1]];
    sorted.clear();
    sorted.resize(found.len().next_multiple_of(LANES), (found[0].0, f64::INFINITY));
    for &(g, d) in found {
        let slot = &mut next[class(d)];
        sorted[*slot] = (g, d);
        *slot += 1;
    }
    ends
}

/// The weights and points of the faces around face `f`.
#[inline(always)]
fn group(state: &State<'_>, f: usize, sorted: &[(u32, f64)], groups: &mut Vec<Group>) {
    let n = state.normals[f];
    let centre = state.current.centroids[f];
    let inverse = 1.0 / state.scales[f];
    let [a, b] = tangents(n).map(|e| inverse * e);
    let axes = [a, b, inverse * n];
    let ranges = state.factors();
    let squares = RADII.map(|r| 1.0 / (r * r));
    groups.clear();
    for of_group in sorted.chunks_exact(LANES) {
        let mut group = Group {
            faces: [0; LANES],
            near: [[0.0; LANES]; RADII.len()],
            alike: [[1.0; LANES]; RANGES],
            trust: [0.0; LANES],
            moments: [[0.0; 24]; LANES],
        };
        let mut offset = [[0.0; LANES]; 3];
        let mut apart = [[0.0; LANES]; 3];
        let mut distance = [0.0; LANES];
        for (l, &(g, d)) in of_group.iter().enumerate() {
            let g = g as usize;
            group.faces[l] = g as u32;
            group.trust[l] = state.trust[g];
            distance[l] = d;
            let (p, m) = (state.noisy.centroids[g], state.normals[g]);
            for k in 0..3 {
                offset[k][l] = p[k];
                apart[k][l] = m[k];
            }
        }
        for k in 0..3 {
            for l in 0..LANES {
                offset[k][l] -= centre[k];
                apart[k][l] -= n[k];
            }
        }
        for l in 0..LANES {
            let square =
                apart[0][l] * apart[0][l] + apart[1][l] * apart[1][l] + apart[2][l] * apart[2][l];
            let alike = similarities(square, ranges);
            for q in 0..RANGES {
                group.alike[q][l] = alike[q];
            }
        }
        for (near, s) in group.near.iter_mut().zip(squares) {
            for l in 0..LANES {
                let t = (1.0 - distance[l] * s).max(0.0);
                near[l] = t * t;
            }
        }
        for (l, of_point) in group.moments.iter_mut().enumerate() {
            let along = |e: DVec3| offset[0][l] * e.x + offset[1][l] * e.y + offset[2][l] * e.z;
            *of_point = moments(axes.map(along));
        }
        groups.push(group);
    }
}

/// Weighted sums of the terms of faces.
#[inline(always)]
fn weighted(groups: &[Group], radius: usize, terms: &[Terms]) -> ([Eight; RANGES], Eight) {
    let mut means = [[0.0; 8]; RANGES];
    let mut others = [0.0; 8];
    for group in groups {
        for l in 0..LANES {
            let terms = &terms[group.faces[l] as usize];
            let near = group.near[radius][l];
            for (mean, alike) in means.iter_mut().zip(&group.alike) {
                let w = near * alike[l];
                for k in 0..8 {
                    mean[k] += w * terms.means[k];
                }
            }
            for k in 0..8 {
                others[k] += near * terms.others[k];
            }
        }
    }
    (means, others)
}

/// The fits to the points of faces, one for each range.
#[inline(always)]
fn fitted<const N: usize>(groups: &[Group], radius: usize, ranges: [usize; N]) -> [LocalFit; N] {
    let mut fits = [LocalFit::EMPTY; N];
    for group in groups {
        for l in 0..LANES {
            for (fit, range) in fits.iter_mut().zip(ranges) {
                let w = group.near[radius][l] * group.alike[range][l] * group.trust[l];
                fit.add(&group.moments[l], w);
            }
        }
    }
    fits
}
