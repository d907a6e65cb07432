//! The spectrum of a torus of revolution, to rounding: an oracle for meshes of it.
//!
//! With w = R + r cos v the metric is w² du² + r² dv². Modes are e^(imu) f(v), and f solves
//!
//! ```text
//! −(w f′)′ / r² + m² f / w = ω w f
//! ```
//!
//! on the circle. Galerkin with trigonometric polynomials converges geometrically, since all
//! coefficients are analytic; the trapezoidal rule integrates them as well.

use std::f64::consts::TAU;

use anyhow::Result;
use fairing_evaluation::observed_orders;
use fairing_operators::Laplacian;
use fairing_shapes as shapes;
use fairing_sparse::{EigenOptions, Mass, SparseMatrix, larger, smallest_eigenpairs};
use fairing_spectral::{SpectrumOptions, spectrum};

use super::surfaces::{JITTER, Sampling};
use crate::experiment::Context;
use crate::experiment::text::{Text, values};
use crate::model::table::{Table, Unit};
use crate::row;

static TEXT: Text = Text::new("torus", include_str!("../../text/torus.md"));

/// Degree of the polynomials; doubling it changes nothing above rounding.
const DEGREE: usize = 24;
/// Eigenvalues compared, the zero left out.
const COMPARED: usize = 12;
const MAJOR: f64 = 1.0;
const MINOR: f64 = 0.4;

/// The `count` smallest eigenvalues, ascending.
fn eigenvalues(major: f64, minor: f64, count: usize) -> Result<Vec<f64>> {
    let size = 2 * DEGREE + 1;
    let points = 8 * DEGREE;
    let options = EigenOptions { dense_rows: size, ..Default::default() };
    let mut all = vec![];
    // ω ≥ m²/(R + r)²: enough m for as many eigenvalues as are wanted.
    for m in 0..count.min(DEGREE) {
        let (mut s, mut b) = (vec![0.0; size * size], vec![0.0; size * size]);
        for p in 0..points {
            let v = TAU * p as f64 / points as f64;
            let w = major + minor * libm::cos(v);
            // 1, cos v, sin v, cos 2v, … and their derivatives.
            let basis: Vec<(f64, f64)> = (0..size)
                .map(|k| {
                    let q = k.div_ceil(2) as f64;
                    let (sin, cos) = libm::sincos(q * v);
                    if k % 2 == 1 {
                        (cos, -q * sin)
                    } else if k == 0 {
                        (1.0, 0.0)
                    } else {
                        (sin, q * cos)
                    }
                })
                .collect();
            for (i, f) in basis.iter().enumerate() {
                for (j, g) in basis.iter().enumerate() {
                    s[i * size + j] +=
                        w * f.1 * g.1 / (minor * minor) + (m * m) as f64 * f.0 * g.0 / w;
                    b[i * size + j] += w * f.0 * g.0;
                }
            }
        }
        let full = |values: Vec<f64>| {
            let starts = (0..=size).map(|i| (i * size) as u32).collect();
            let columns = (0..size * size).map(|k| (k % size) as u32).collect();
            SparseMatrix::new((size, size), starts, columns, values)
        };
        let (s, b) = (full(s), full(b));
        let found = smallest_eigenpairs(&s, Mass::Consistent(&b), count.min(DEGREE), &options)?;
        for value in found.values {
            // e^(imu) and e^(−imu).
            all.extend(std::iter::repeat_n(value.max(0.0), if m == 0 { 1 } else { 2 }));
        }
    }
    all.sort_by(f64::total_cmp);
    all.truncate(count);
    Ok(all)
}

/// Eigenvalues of finer and finer meshes of a torus against the exact ones.
pub(super) fn table(context: &Context<'_>, levels: u32) -> Result<Table> {
    let exact = eigenvalues(MAJOR, MINOR, COMPARED + 1)?;
    let mut table = Table::new(
        "torus",
        &TEXT.say("table", values! { major: MAJOR, minor: MINOR })?,
        &[
            ("sampling", Unit::Label),
            ("h", Unit::Length),
            ("first", Unit::InverseArea),
            ("exact", Unit::InverseArea),
            ("error", Unit::Relative),
            ("order", Unit::Order),
        ],
    );
    for sampling in Sampling::BOTH {
        let (mut h, mut error, mut first) = (vec![], vec![], vec![]);
        for level in 0..levels {
            let regular = shapes::torus(MAJOR, MINOR, 30 << level, 16 << level);
            let onto = shapes::onto_torus(MAJOR, MINOR);
            let mesh = match sampling {
                Sampling::Regular => regular,
                Sampling::Jittered => {
                    shapes::jittered(&regular, JITTER, context.seed("eigenvalues"), onto)
                }
            };
            let values =
                spectrum(&Laplacian::cotangent(&mesh)?, COMPARED + 1, &SpectrumOptions::default())?
                    .values;
            let errors = values.iter().zip(&exact).skip(1).map(|(a, b)| (a / b - 1.0).abs());
            h.push(mesh.mean_edge_length());
            error.push(errors.fold(0.0, larger));
            first.push(values[1]);
        }
        let orders = observed_orders(&h, &error);
        for i in 0..h.len() {
            // The coarsest mesh has nothing to be compared with.
            let order = (i > 0).then(|| orders[i - 1]);
            table.push(row![sampling.name(), h[i], first[i], exact[1], error[i], order]);
        }
    }
    Ok(table)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A thin torus is a circle times a small circle: m²/R² below 1/r², each twice.
    #[test]
    fn a_thin_torus_is_a_circle() {
        let found = eigenvalues(2.0, 1e-3, 9).unwrap();
        for (k, value) in found.iter().enumerate() {
            let m = k.div_ceil(2) as f64;
            // The metric varies by 10⁻³ / 2 along the small circle; to first order that cancels.
            assert!((value - m * m / 4.0).abs() < 1e-5 * (1.0 + m * m), "{k}: {value}");
        }
    }

    /// A torus has one eigenvalue of zero, and every eigenvalue with m > 0 is double.
    #[test]
    fn eigenvalues_come_in_pairs() {
        let found = eigenvalues(1.0, 0.4, 13).unwrap();
        assert!(found[0].abs() < 1e-9 && found[1] > 0.3);
        assert_eq!(found[1], found[2]);
    }
}
