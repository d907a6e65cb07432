//! Conformalised mean curvature flow of a bumpy sphere to a round one.

use anyhow::Result;
use fairing_figure::Up;
use fairing_mesh::TriMesh;
use fairing_shapes as shapes;
use fairing_smoothing::{ConformalizedMcf, conformalized_mean_curvature_flow};
use fairing_sparse::larger;
use glam::DVec3;

use super::gallery::{Gallery, Look, VIEWPOINTS};
use super::seen;
use crate::experiment::Context;
use crate::experiment::outcome::Picture;
use crate::experiment::text::{Text, values};
use crate::model::table::{Table, Tables, Tolerance, Unit, brief};
use crate::model::verdict::{Judgement, Shown, Verdict, ViewState};
use crate::model::view::{Panel, Slider, View};
use crate::row;

/// The words of the experiment on flows.
pub(super) static TEXT: Text = Text::new("flows", include_str!("../../text/flows.md"));

/// The id of the view within the experiment.
pub(super) const VIEW: &str = "conformal-view";

/// The numbers of steps that the view shows; the flow has settled at the last.
pub(super) const STOPS: [usize; 7] = [0, 1, 2, 4, 8, 16, 300];

/// The stops that are drawn.
const DRAWN: [usize; 4] = [0, 1, 4, 300];

fn bumpy(level: u32) -> TriMesh {
    shapes::bumpy_sphere(level, 0.2, 3.0)
}

/// The flow until it settles or reaches a number of steps, and the steps it made.
fn flow(mesh: &TriMesh, iterations: usize) -> Result<(TriMesh, usize)> {
    if iterations == 0 {
        return Ok((mesh.clone(), 0));
    }
    let options =
        ConformalizedMcf { time: 0.05, iterations, settled: 1e-7, ..ConformalizedMcf::default() };
    let flowed = conformalized_mean_curvature_flow(mesh, &options, None)?;
    Ok((flowed.mesh, flowed.report.iterations))
}

/// A closed mesh of genus 0 by name.
pub(super) fn bodies(context: &Context<'_>) -> Vec<(&'static str, TriMesh)> {
    let levels = context.choose(&[3, 4, 5][..], &[3, 4]).iter();
    let resolutions = context.choose(&[24, 48][..], &[24]).iter();
    levels
        .map(|&level| ("bumpy sphere", bumpy(level)))
        .chain(resolutions.map(|&resolution| ("creature", shapes::creature(resolution))))
        .collect()
}

/// Steps until meshes settle, and the remaining distance from a round sphere.
pub(super) fn table(bodies: &[(&'static str, TriMesh)]) -> Result<Table> {
    let mut table = Table::new(
        "conformal",
        &TEXT.say("table conformal", values! { most: STOPS[STOPS.len() - 1] })?,
        &[
            ("mesh", Unit::Label),
            ("vertices", Unit::Count),
            ("steps", Unit::Count),
            ("off the sphere before", Unit::Relative),
            ("off the sphere after", Unit::Relative),
        ],
    )
    .tolerance("steps", None)
    .tolerance("off the sphere after", Some(Tolerance::LOOSE));
    for (name, before) in bodies {
        let (after, steps) = flow(before, STOPS[STOPS.len() - 1])?;
        let off = [before, &after].map(farthest);
        table.push(row![*name, before.vertex_count(), steps, off[0], off[1]]);
    }
    Ok(table)
}

/// A shape this close to its best sphere is round: the error of the discrete operator on coarse
/// meshes.
const ROUND: f64 = 0.02;

/// Judges whether all of the meshes become round.
pub(super) fn judge(tables: Tables<'_>) -> Result<Judgement> {
    let table = tables.get("conformal")?;
    let (counts, off) = (table.column("vertices")?, table.column("off the sphere after")?);
    let mesh = table.index("mesh")?;
    let mut ends = vec![];
    for ((row, count), off) in table.rows.iter().zip(&counts).zip(&off) {
        let values = values! { mesh: row[mesh].to_string(), count: *count, off: *off };
        ends.push(TEXT.say("conformal on a mesh", values)?);
    }
    let round = off.iter().filter(|off| **off < ROUND).count();
    let verdict = match round {
        0 => Verdict::Refuted,
        n if n == off.len() => Verdict::Confirmed,
        _ => Verdict::Qualified,
    };
    let worst = off.iter().copied().fold(0.0, larger);
    let values = values! { round: ROUND, worst, ends: seen::list(&ends) };
    let last = ViewState::at(&[STOPS.len() - 1]);
    Ok(TEXT
        .judgement("conformal", verdict, values)?
        .ours()
        .shown(Shown::view("flows", VIEW, &last))
        .number("farthest off the sphere", worst, Unit::Relative))
}

/// The distance of each vertex from the sphere of mean radius about the centroid, over that radius.
fn off_sphere(mesh: &TriMesh) -> Vec<f64> {
    let mut centre = DVec3::ZERO;
    for f in 0..mesh.face_count() {
        for p in mesh.triangle(f) {
            centre += DVec3::from(p) * (mesh.face_area(f) / 3.0);
        }
    }
    centre *= 1.0 / mesh.area();
    let radii: Vec<f64> = mesh.positions().iter().map(|&p| centre.distance(p.into())).collect();
    let mean = radii.iter().sum::<f64>() / radii.len() as f64;
    radii.iter().map(|r| r / mean - 1.0).collect()
}

/// A sentence on the roundness of the sphere after a number of steps each.
fn rounded(errors: &[(usize, f64)]) -> Result<String> {
    let Some(((_, settled), others)) = errors.split_last() else { return Ok(String::new()) };
    let falling = errors.windows(2).all(|w| w[1].1 < w[0].1);
    let off: Vec<String> = others.iter().map(|(_, off)| brief(100.0 * off)).collect();
    let steps: Vec<String> = others.iter().map(|(n, _)| n.to_string()).collect();
    let values = values! { off: seen::list(&off), steps: seen::list(&steps), settled: *settled };
    TEXT.say(if falling { "rounded" } else { "rounded late" }, values)
}

fn farthest(mesh: &TriMesh) -> f64 {
    off_sphere(mesh).into_iter().fold(0.0, |most, off| larger(most, off.abs()))
}

/// The bumpy sphere as it becomes round: drawn, and to turn.
pub(super) fn pictures(context: &Context<'_>) -> Result<(Picture, View)> {
    let before = bumpy(context.choose(4, 3));
    let meshes: Vec<TriMesh> =
        STOPS.iter().map(|&n| Ok(flow(&before, n)?.0)).collect::<Result<_>>()?;
    let off: Vec<Vec<f64>> = meshes.iter().map(off_sphere).collect();
    let words = |steps: usize| match steps {
        300 => TEXT.words("settled", &[]),
        n => n.to_string(),
    };
    let titles: Vec<String> = STOPS.map(words).to_vec();
    let of = |(n, mesh): (&usize, &TriMesh)| (*n, farthest(mesh));
    let all_errors: Vec<(usize, f64)> = STOPS.iter().zip(&meshes).map(of).collect();
    let drawn_errors: Vec<(usize, f64)> =
        all_errors.iter().copied().filter(|(n, _)| DRAWN.contains(n)).collect();
    let drawn = STOPS.iter().zip(&titles).zip(&meshes).filter(|((n, _), _)| DRAWN.contains(n));
    let looks = drawn.map(|((_, title), mesh)| Look { title, mesh, coloring: None }).collect();
    let picture = Gallery {
        looks,
        viewpoints: &VIEWPOINTS[..1],
        up: Up::Z,
        aspect: 1.0,
        occlusion: !context.is_quick(),
    }
    .draw(
        "conformal",
        &TEXT.say("figure conformal", values! { rounded: rounded(&drawn_errors)? })?,
        &TEXT.say("figure conformal alt", &[])?,
    )?;
    let worst = meshes.iter().map(|mesh| Some(100.0 * farthest(mesh))).collect();
    let panel = Panel::moving("flow", &before, meshes.iter().map(TriMesh::positions))
        .with_moving_field("off the mean sphere", "of its radius", true, off.iter().map(|o| &o[..]))
        .with_fact("farthest off the sphere", "%", worst);
    let view = View {
        id: VIEW.into(),
        mesh: "smooth bumpy sphere".into(),
        caption: TEXT.say("view conformal", values! { rounded: rounded(&all_errors)? })?,
        alt: TEXT.say("view conformal alt", &[])?,
        fallback: "conformal".into(),
        z_up: true,
        sliders: vec![Slider::new("steps", titles)],
        start: vec![2],
        panels: vec![
            Panel::still("input", &before)
                .with_field("off the mean sphere", "of its radius", true, &off[0])
                .with_fact("farthest off the sphere", "%", vec![Some(100.0 * farthest(&before))]),
            panel,
        ],
        ..View::default()
    };
    Ok((picture, view))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The distance may grow in between; the caption then does not say that it falls.
    #[test]
    fn the_caption_has_the_distances() {
        let text = rounded(&[(0, 0.58), (1, 0.69), (16, 0.36), (300, 0.0025)]).unwrap();
        let expected = "The farthest vertex is 58, 69 and 36 % off the mean sphere after 0, 1 and 16 steps, \
             0.25 % when the flow has settled: it gets worse before it gets better.";
        assert_eq!(text, expected);
        assert!(!rounded(&[(0, 0.5), (1, 0.4), (300, 0.0)]).unwrap().contains("worse"));
    }
}
