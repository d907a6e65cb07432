//! Every verb of the program on meshes with a vertex of thousands of faces, or with thousands of
//! teeth, at two sizes; commands whose time grows too fast are listed.

use std::f64::consts::TAU;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Instant;

use anyhow::{Context as _, Result, ensure};
use fairing_mesh::{TriMesh, io};

/// The triangles of the smaller meshes; the larger ones have four times as many.
const COUNT: u32 = 16_000;

/// Seconds below which growth is not judged: starting the program takes a part of them.
const SHORT: f64 = 0.3;

/// The largest exponent of the time over the number of triangles, and that of pictures and of
/// estimators over balls.
const GROWTH: [f64; 2] = [1.2, 1.5];

/// A command on a mesh, `IN`, that writes to `OUT`.
struct Case {
    words: String,
    limit: f64,
}

/// Builds the program, and prints the seconds of each command on each shape at both sizes, with the
/// exponent.
///
/// # Errors
///
/// If the time of one grows too fast.
pub(crate) fn run() -> Result<()> {
    let program = program()?;
    let folder = std::env::temp_dir().join(format!("fairing-hubs-{}", std::process::id()));
    std::fs::create_dir_all(&folder)?;
    let too_fast = measured(&program, &folder);
    std::fs::remove_dir_all(&folder)?;
    let too_fast = too_fast?;
    ensure!(too_fast.is_empty(), "these grow too fast:\n{}", too_fast.join("\n"));
    Ok(())
}

/// The program beside this one.
fn program() -> Result<PathBuf> {
    let own = std::env::current_exe()?;
    let folder = own.parent().context("the program has no folder")?;
    let mut build = Command::new("cargo");
    build.args(["build", "--package=fairing", "--features=cli"]);
    build.args(folder.ends_with("release").then_some("--release"));
    ensure!(build.status()?.success(), "the program does not build");
    Ok(folder.join("fairing"))
}

/// A shape of about that many faces.
type Shape = fn(u32) -> Result<TriMesh>;

fn measured(program: &Path, folder: &Path) -> Result<Vec<String>> {
    let shapes: [(&str, Shape); 5] =
        [("fan", fan), ("star", star), ("cone", cone), ("two hubs", two_hubs), ("comb", comb)];
    let cases = cases(program)?;
    let mut too_fast = vec![];
    for (shape, make) in shapes {
        let files = [COUNT, 4 * COUNT].map(|count| folder.join(format!("{shape}{count}.ply")));
        for (path, count) in files.iter().zip([COUNT, 4 * COUNT]) {
            io::write(path, &make(count)?)?;
        }
        for case in &cases {
            let found = files.each_ref().map(|input| seconds(program, case, input, folder));
            let line = match found {
                [Ok(Some(small)), Ok(Some(large))] => {
                    let exponent = libm::log(large / small) / libm::log(4.0);
                    let line = format!(
                        "{shape:<9}{:<58}{small:8.2} s {large:8.2} s  n^{exponent:.2}",
                        case.words
                    );
                    if large > SHORT && exponent > case.limit {
                        too_fast.push(line.clone());
                    }
                    line
                }
                [Err(error), _] | [_, Err(error)] => return Err(error),
                _ => format!("{shape:<9}{:<58} refused", case.words),
            };
            println!("{line}");
        }
    }
    Ok(too_fast)
}

/// The commands: all flows, denoisers and estimators that the program lists, and the other verbs.
fn cases(program: &Path) -> Result<Vec<Case>> {
    let plain = [
        "info IN",
        "convert IN -o OUT.obj",
        "repair IN -o OUT.ply",
        "repair IN -o OUT.ply --thin 0.002",
        "repair IN -o OUT.ply --tolerance 0.01 --holes 50 --components 9",
        "spectrum IN -k 10",
        "reconstruct IN -k 10 -o OUT.ply",
        "geodesic IN --from 5 --path 700 -o OUT.ply",
        "compare IN IN",
        "noise IN --sigma 0.1 -o OUT.ply",
        "scan IN --camera 40,30,90 --size 160x120 -o OUT.ply",
        "smooth IN --method region --vertices 10-20 -o OUT.ply",
    ];
    let mut cases: Vec<Case> =
        plain.map(|words| Case { words: words.to_owned(), limit: GROWTH[0] }).into();
    cases.push(Case { words: "render IN --size 200x200 -o OUT.png".to_owned(), limit: GROWTH[1] });
    for (verb, option) in [("smooth", "method"), ("denoise", "method"), ("curvature", "estimator")]
    {
        let output = Command::new(program).args([verb, "--list"]).output()?;
        let text = String::from_utf8(output.stdout)?;
        let names = text.lines().filter(|line| !line.starts_with(' '));
        // The region needs vertices.
        for name in names.filter_map(|line| line.split(':').next()).filter(|n| *n != "region") {
            let words = format!("{verb} IN --{option} {name} -o OUT.ply");
            let over_ball = ["normal-cycle", "corrected-ball"].contains(&name);
            cases.push(Case { words, limit: GROWTH[usize::from(over_ball)] });
        }
    }
    Ok(cases)
}

/// The seconds that a command takes; `None` if it refuses the mesh.
fn seconds(program: &Path, case: &Case, input: &Path, folder: &Path) -> Result<Option<f64>> {
    let output = folder.join("out").display().to_string();
    let input = input.display().to_string();
    let words = case.words.split(' ').map(|word| match word {
        "IN" => input.clone(),
        word => word.replace("OUT", &output),
    });
    let mut command = Command::new(program);
    command.args(words).arg("--quiet").stdout(Stdio::null()).stderr(Stdio::null());
    if case.words.contains(" -o ") {
        command.arg("--force");
    }
    let start = Instant::now();
    let status = command.status()?;
    Ok(status.success().then(|| start.elapsed().as_secs_f64()))
}

/// Points on a circle about the z axis, with a radius and a height for each number.
fn circle(count: u32, at: impl Fn(u32) -> [f64; 2]) -> impl Iterator<Item = [f64; 3]> {
    (0..count).map(move |i| {
        let (sin, cos) = libm::sincos(TAU * f64::from(i) / f64::from(count));
        let [radius, height] = at(i);
        [radius * cos, radius * sin, height]
    })
}

/// Triangles around vertex `hub`, with the rim from vertex `first` on.
fn around(hub: u32, first: u32, count: u32) -> impl Iterator<Item = [u32; 3]> {
    (0..count).map(move |i| [hub, first + i, first + (i + 1) % count])
}

/// A wavy disc around its centre.
fn fan(count: u32) -> Result<TriMesh> {
    let wave = |i: u32| [1.0, 0.1 * libm::sin(7.0 * TAU * f64::from(i) / f64::from(count))];
    let positions = std::iter::once([0.0; 3]).chain(circle(count, wave)).collect();
    Ok(TriMesh::new(positions, around(0, 1, count).collect())?)
}

/// A disc with long spikes.
fn star(count: u32) -> Result<TriMesh> {
    let spike = |i: u32| [if i.is_multiple_of(2) { 1.0 } else { 10.0 }, 0.0];
    let positions = std::iter::once([0.0, 0.0, 0.3]).chain(circle(count, spike)).collect();
    Ok(TriMesh::new(positions, around(0, 1, count).collect())?)
}

/// A closed cone: an apex, and the centre of its base.
fn cone(count: u32) -> Result<TriMesh> {
    let rim = circle(count / 2, |_| [1.0, 0.0]);
    let positions = [[0.0, 0.0, 1.0], [0.0; 3]].into_iter().chain(rim).collect();
    let base = around(1, 2, count / 2).map(|[hub, a, b]| [hub, b, a]);
    Ok(TriMesh::new(positions, around(0, 2, count / 2).chain(base).collect())?)
}

/// A disc in two halves, each around a vertex of its own.
fn two_hubs(count: u32) -> Result<TriMesh> {
    let half = count / 2;
    let positions = [[0.0, -0.3, 0.0], [0.0, 0.3, 0.0]].into_iter();
    let rim = circle(count, |_| [1.0, 0.0]);
    let faces = around(0, 2, count).map(|[_, a, b]| [u32::from(a < 2 + half), a, b]);
    let between = [[0, 2, 1], [1, 2 + half, 0]];
    Ok(TriMesh::new(positions.chain(rim).collect(), faces.chain(between).collect())?)
}

/// A strip with a long thin tooth on each square.
fn comb(count: u32) -> Result<TriMesh> {
    let teeth = count / 3;
    let row = |shift: f64, y: f64, count: u32| {
        (0..count).map(move |i| [0.01 * (f64::from(i) + shift), y, 0.0])
    };
    let below = row(0.0, 0.0, teeth + 1).chain(row(0.0, 0.01, teeth + 1));
    let positions = below.chain(row(0.5, 0.3, teeth)).collect();
    let above = teeth + 1;
    let faces = (0..teeth).flat_map(|i| {
        let [a, b] = [i, above + i];
        [[a, a + 1, b + 1], [a, b + 1, b], [b, b + 1, 2 * above + i]]
    });
    Ok(TriMesh::new(positions, faces.collect())?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_shapes_are_manifold() {
        for (make, hubs, loops) in [
            (fan as fn(u32) -> Result<TriMesh>, 1, 1),
            (star, 1, 1),
            (cone, 2, 0),
            (two_hubs, 2, 1),
            (comb, 0, 1),
        ] {
            let mesh = make(120).unwrap();
            let topology = mesh.topology();
            assert!(topology.is_manifold() && topology.components().count() == 1);
            assert!(topology.orientation().is_consistent());
            assert_eq!(topology.boundary_loops().len(), loops);
            let valence = |v: &u32| topology.neighbors(*v).len() >= 60;
            assert_eq!((0..mesh.vertex_count() as u32).filter(valence).count(), hubs);
        }
    }
}
