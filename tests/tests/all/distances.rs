//! Distances, paths and isolines through the program.

use std::fs;

use fairing_mesh::io;
use fairing_shapes as shapes;
use serde_json::Value;

use crate::command_line::{files, refuse, run};

fn length(points: &[[f64; 3]]) -> f64 {
    let step = |p: &[[f64; 3]]| (0..3).map(|k| (p[0][k] - p[1][k]).powi(2)).sum::<f64>().sqrt();
    points.windows(2).map(step).sum()
}

#[test]
fn distances_paths_and_isolines_of_a_sphere() {
    let folder = tempfile::tempdir().unwrap();
    let sphere = shapes::icosphere(4);
    io::write(folder.path().join("sphere.off"), &sphere).unwrap();
    let said = run(
        folder.path(),
        "geodesic sphere.off --from 0,0:0:-3 -o d.ply --path 700 --isolines 0.5 --lines l.obj --json",
    );
    let summary: Value = serde_json::from_str(&said).unwrap();
    let south: Vec<f64> = serde_json::from_value(summary["sources"][1].clone()).unwrap();
    assert!((south[2] + 1.0).abs() < 0.01 && south[0].hypot(south[1]) < 0.1, "{said}");
    let p = sphere.positions();
    let angle = |a: [f64; 3], b: &[f64]| {
        let dot: f64 = a.iter().zip(b).map(|(x, y)| x * y).sum();
        dot.clamp(-1.0, 1.0).acos()
    };
    let exact = |v: usize| angle(p[v], &p[0]).min(angle(p[v], &south));
    let file = io::read(folder.path().join("d.ply")).unwrap();
    let distance = file.fields.scalar("distance").unwrap();
    assert!(file.fields.scalar("defined").unwrap().iter().all(|d| *d == 1.0));
    for (v, d) in distance.iter().enumerate() {
        assert!((d - exact(v)).abs() < 0.06, "{v}: {d} {}", exact(v));
    }
    let path = summary["paths"][0]["length"].as_f64().unwrap();
    assert!((path / exact(700) - 1.0).abs() < 0.03, "{path} {}", exact(700));
    // The polylines are those of the summary.
    let text = fs::read_to_string(folder.path().join("l.obj")).unwrap();
    let (mut points, mut lengths) = (vec![], vec![]);
    for line in text.lines() {
        let (kind, rest) = line.split_once(' ').unwrap();
        match kind {
            "v" => {
                let numbers: Vec<f64> = rest.split(' ').map(|x| x.parse().unwrap()).collect();
                points.push(<[f64; 3]>::try_from(numbers).unwrap());
            }
            _ => {
                let at = rest.split(' ').map(|i| points[i.parse::<usize>().unwrap() - 1]);
                lengths.push(length(&at.collect::<Vec<_>>()));
            }
        }
    }
    assert!((lengths[0] - path).abs() < 1e-12);
    let isolines = summary["isolines"].as_array().unwrap();
    let total: f64 = isolines.iter().map(|line| line["length"].as_f64().unwrap()).sum();
    assert!((lengths[1..].iter().sum::<f64>() / total - 1.0).abs() < 1e-12);
    assert!(isolines.len() >= 2 && isolines[0]["distance"] == 0.5);
}

/// Vertices of the file, welded or not, and those that no source reaches.
#[test]
fn distances_are_at_the_vertices_of_the_file() {
    let folder = tempfile::tempdir().unwrap();
    // Two squares apart, the first of two triangles that do not share corners.
    let corners = [[0, 0], [1, 0], [0, 1], [1, 0], [1, 1], [0, 1], [5, 0], [6, 0], [5, 1]];
    let vertices = corners.map(|[x, y]| format!("v {x} {y} 0\n")).concat();
    fs::write(folder.path().join("two.obj"), vertices + "f 1 2 3\nf 4 5 6\nf 7 8 9\n").unwrap();
    let said = run(folder.path(), "geodesic two.obj --weld --from 3 --path 0,4 -o d.ply --json");
    let summary: Value = serde_json::from_str(&said).unwrap();
    assert_eq!((&summary["unreached"], &summary["paths"][0]["end"]), (&3.into(), &1.into()));
    let file = io::read(folder.path().join("d.ply")).unwrap();
    let distance = file.fields.scalar("distance").unwrap();
    assert_eq!((file.mesh.vertex_count(), distance[1], distance[3]), (9, 0.0, 0.0));
    assert_eq!(distance[2], distance[5]);
    assert_eq!(file.fields.scalar("defined").unwrap(), [[1.0; 6].as_slice(), &[0.0; 3]].concat());
    for (options, error) in [
        ("--from 77", "vertex 77"),
        ("--from 0 --path 7", "vertex"),
        ("--from 0:1", "X:Y:Z"),
        ("--from 0 --isolines 1", "--lines"),
        ("--from 0 --lines l.obj", "--path or --isolines"),
        ("--from 0 --isolines -1 --lines l.obj", "--isolines"),
        ("--from 0 --isolines 1e-9 --lines l.obj", "more than 10000"),
        ("--from 0 --isolines 1 --lines l.ply", ".obj"),
    ] {
        let line = format!("geodesic two.obj --weld {options}");
        let code = if error.starts_with("vertex") { 1 } else { 2 };
        let code = if error == ".obj" { 4 } else { code };
        let said = refuse(folder.path(), &line, code);
        assert!(said.contains(error), "{line}: {said}");
    }
    assert_eq!(files(folder.path()), ["d.ply", "two.obj"]);
}

/// A sphere and one a tenth larger are a tenth apart along the radius.
#[test]
fn a_comparison_has_the_distance_and_the_nearest_point_at_each_vertex() {
    let folder = tempfile::tempdir().unwrap();
    let sphere = shapes::icosphere(3);
    let larger = sphere.positions().iter().map(|p| p.map(|x| 1.1 * x)).collect();
    io::write(folder.path().join("a.ply"), &sphere.with_positions(larger).unwrap()).unwrap();
    io::write(folder.path().join("b.ply"), &sphere).unwrap();
    run(folder.path(), "compare a.ply b.ply -o error.ply");
    let file = io::read(folder.path().join("error.ply")).unwrap();
    let (distance, closest) = (file.fields.scalar("distance"), file.fields.vector("closest"));
    for ((p, d), q) in sphere.positions().iter().zip(distance.unwrap()).zip(closest.unwrap()) {
        assert!((d - 0.1).abs() < 1e-12 && length(&[*p, *q]) < 1e-7, "{d} {p:?} {q:?}");
    }
}
