//! Meshes made by formula.

use fairing_mesh::TriMesh;
use fairing_shapes as shapes;
use fairing_shapes::{Diagonals, Ends, HelicoidOptions};
use pyo3::prelude::*;

use crate::error::{Error, Result};
use crate::mesh::Mesh;
use crate::options::choose;
use crate::run::Call;

/// Largest number of squares whose corners `u32` can index.
const MAX_SQUARES: u64 = u32::MAX as u64 / 12;

fn need(holds: bool, text: impl FnOnce() -> String) -> Result<()> {
    if holds { Ok(()) } else { Err(Error::option(text())) }
}

fn level(level: u32) -> Result<()> {
    need(level <= 13, || format!("level is {level}, but must be at most 13"))
}

fn between(name: &str, value: f64, low: f64, high: f64) -> Result<()> {
    need((low..=high).contains(&value), || {
        format!("{name} is {value:?}, but must be from {low:?} to {high:?}")
    })
}

fn positive(name: &str, value: f64) -> Result<()> {
    need(value > 0.0 && value.is_finite(), || {
        format!("{name} is {value}, but must be positive and finite")
    })
}

/// A length of a shape, far enough from the ends of [`EXTENTS`](fairing_mesh::EXTENTS).
fn length(name: &str, value: f64) -> Result<()> {
    between(name, value, 1e-29, 1e29)
}

fn squares(names: [&str; 2], counts: [u32; 2], least: [u32; 2]) -> Result<()> {
    for k in 0..2 {
        need(counts[k] >= least[k], || {
            format!("{} is {}, but must be at least {}", names[k], counts[k], least[k])
        })?;
    }
    need(u64::from(counts[0]) * u64::from(counts[1]) <= MAX_SQUARES, || {
        format!("{} × {} squares are more than can be numbered", counts[0], counts[1])
    })
}

fn diagonals(name: &str) -> Result<Diagonals> {
    choose(
        "diagonals",
        name,
        &[("regular", Diagonals::Regular), ("alternating", Diagonals::Alternating)],
    )
}

/// Parameters of the shape, in the order of the Python signature.
type Counts = Vec<u32>;
type Lengths = Vec<f64>;

/// Refuses parameters that are out of range.
fn check(name: &str, lengths: &[f64], counts: &[u32]) -> Result<()> {
    match (name, lengths, counts) {
        ("icosphere", [], &[l]) => level(l),
        ("uv_sphere", [], &[around, across]) => {
            squares(["around", "across"], [around, across], [3, 2])
        }
        ("bumpy_sphere", &[amplitude, frequency], &[l]) => {
            level(l)?;
            need(amplitude.abs() < 1.0 / 3.0, || {
                format!("amplitude is {amplitude}, but must be below 1/3")
            })?;
            need(frequency.is_finite(), || format!("frequency is {frequency}"))
        }
        ("ellipsoid", &[a, b, c], &[l]) => {
            level(l)?;
            [("a", a), ("b", b), ("c", c)]
                .into_iter()
                .try_for_each(|(name, axis)| length(name, axis))
        }
        ("torus", &[major, minor], &[around, across]) => {
            squares(["around", "across"], [around, across], [3, 3])?;
            length("major", major)?;
            length("minor", minor)?;
            need(minor < major, || {
                format!("the radii are {major} and {minor}, but must be 0 < minor < major")
            })
        }
        ("cylinder", &[radius, height], &[around, along]) => {
            squares(["around", "along"], [around, along], [3, 1])?;
            length("radius", radius)?;
            length("height", height)
        }
        ("plane", [], &[columns, rows]) => squares(["columns", "rows"], [columns, rows], [1, 1]),
        ("irregular_plane", &[spacing], []) => between("spacing", spacing, 1e-4, 0.5),
        ("cube", [], &[n]) => {
            squares(["squares", "squares"], [n, n], [1, 1])?;
            need(n <= 10_000, || format!("squares is {n}, but must be at most 10000"))
        }
        ("cad_block", &[spacing], []) => between("spacing", spacing, 0.005, 0.3),
        ("creature", [], &[n]) => need((24..=320).contains(&n), || {
            format!("resolution is {n}, but must be from 24 to 320")
        }),
        ("flower", &[spacing], []) => between("spacing", spacing, 1e-3, 0.2),
        ("moebius", &[w], &[around, across]) => {
            squares(["around", "across"], [around, across], [3, 1])?;
            need(0.0 < w && w < 1.0, || format!("width is {w}, but must be above 0 and below 1"))
        }
        ("helicoid", &[rise, from, to, turns], &[across, along]) => {
            squares(["across", "along"], [across, along], [1, 1])?;
            helix(rise, [from, to], turns)
        }
        _ => Err(Error::option(format!("there is no shape {name:?} of such parameters"))),
    }
}

fn helix(rise: f64, [from, to]: [f64; 2], turns: f64) -> Result<()> {
    positive("turns", turns)?;
    length("rise", rise)?;
    length("rise times turns", rise * turns)?;
    need(from < to, || format!("radii are {from} and {to}, but must ascend"))?;
    [from, to].into_iter().try_for_each(|radius| between("radius", radius, -1e29, 1e29))
}

/// The shape with checked parameters.
fn made(name: &str, lengths: &[f64], counts: &[u32], word: &str, seed: u64) -> Result<TriMesh> {
    check(name, lengths, counts)?;
    Ok(match (name, lengths, counts) {
        ("icosphere", [], &[l]) => shapes::icosphere(l),
        ("uv_sphere", [], &[around, across]) => shapes::uv_sphere(around, across),
        ("bumpy_sphere", &[amplitude, frequency], &[l]) => {
            shapes::bumpy_sphere(l, amplitude, frequency)
        }
        ("ellipsoid", &[a, b, c], &[l]) => shapes::ellipsoid([a, b, c], l),
        ("torus", &[major, minor], &[around, across]) => {
            shapes::torus(major, minor, around, across)
        }
        ("cylinder", &[radius, height], &[around, along]) => {
            let ends = choose("ends", word, &[("closed", Ends::Closed), ("open", Ends::Open)])?;
            shapes::cylinder(radius, height, around, along, ends)
        }
        ("plane", [], &[columns, rows]) => shapes::plane(columns, rows, diagonals(word)?),
        ("irregular_plane", &[spacing], []) => shapes::irregular_plane(spacing, seed),
        ("cube", [], &[n]) => shapes::cube(n, diagonals(word)?),
        ("cad_block", &[spacing], []) => shapes::cad_block(spacing),
        ("creature", [], &[resolution]) => shapes::creature(resolution),
        ("flower", &[spacing], []) => shapes::flower(spacing, seed),
        ("moebius", &[w], &[around, across]) => shapes::moebius(w, around, across),
        ("helicoid", &[rise, from, to, turns], &[across, along]) => {
            shapes::helicoid(&HelicoidOptions { rise, radii: [from, to], turns, across, along })
        }
        _ => return Err(Error::option(format!("there is no shape {name:?} of such parameters"))),
    })
}

#[pyfunction]
pub(crate) fn shape(
    py: Python<'_>,
    name: String,
    lengths: Lengths,
    counts: Counts,
    word: String,
    seed: u64,
    call: Call,
) -> PyResult<Mesh> {
    Ok(call.run(py, move || made(&name, &lengths, &counts, &word, seed))?.into())
}
