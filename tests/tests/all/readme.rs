//! The README: its numbers are those of the committed tables.

use std::collections::BTreeSet;

use serde_json::Value;

use crate::advice::{Rows, number, read, report};

/// The numbers in a column.
fn column(rows: &Rows, name: &str) -> Vec<f64> {
    rows.iter().map(|row| number(row, name)).collect()
}

/// The number to `decimals` decimals.
fn rounded(x: f64, decimals: i32) -> f64 {
    let unit = 10_f64.powi(decimals);
    (x * unit).round() / unit
}

/// The smallest and the largest of these to one decimal, rounded outwards.
fn range(values: &[f64]) -> [f64; 2] {
    let least = values.iter().copied().fold(f64::INFINITY, f64::min);
    let largest = values.iter().copied().fold(0.0, f64::max);
    [(least * 10.0).floor() / 10.0, (largest * 10.0).ceil() / 10.0]
}

/// The numbers in a text.
fn numbers(text: &str) -> Vec<f64> {
    let pieces = text.split(|c: char| !(c.is_ascii_digit() || c == '.'));
    pieces.filter_map(|piece| piece.trim_matches('.').parse().ok()).collect()
}

/// The numbers in a row of the README's tables, given its first words, but for those of its link.
fn of_row(start: &str) -> Vec<f64> {
    let text = read("README.md");
    let row = text.lines().find(|line| line.starts_with(&format!("| {start}"))).expect(start);
    numbers(row.trim_end_matches(" |").rsplit_once('|').unwrap().0)
}

/// The numbers behind `start` in the sentence of the README.
fn of_sentence(start: &str) -> Vec<f64> {
    let text = read("README.md").replace(['\n', '\r'], " ").replace("  ", " ");
    let (_, rest) = text.split_once(start).expect(start);
    numbers(rest.split(['.', ';']).next().unwrap())
}

#[test]
fn accuracy_is_that_of_the_report() {
    let best = report("denoisers/best.csv");
    let methods = report("denoisers/scores.csv");
    let methods: BTreeSet<&String> = methods.iter().map(|row| &row["method"]).collect();
    // Without the noisy input and the automatic denoiser.
    let published = methods.len() - 2;
    let expected: Vec<f64> = [best.len() as f64]
        .into_iter()
        .chain(range(&column(&best, "automatic [°]")))
        .chain(range(&column(&best, "its normal error [°]")))
        .chain([published as f64])
        .collect();
    assert_eq!(of_row("Denoising"), expected);

    let choice = report("estimators/choice.csv");
    let mut medians = column(&choice, "all [1]");
    medians.sort_by(f64::total_cmp);
    let ordinary = report("estimators/ordinary.csv");
    let meshes = ordinary.len() / choice.len();
    assert_eq!(
        of_row("Curvature"),
        [meshes as f64, rounded(medians[0], 2), rounded(medians[1], 1)]
    );

    let sets = report("denoisers/sets.csv");
    let [cases, lost] = ["cases [count]", "worse than a default [count]"]
        .map(|name| column(&sets, name).iter().sum::<f64>());
    assert_eq!(of_sentence("A published method at its defaults is better on"), [lost, cases]);
}

/// Rows of the speed page: numbers of the task, time and ratio on the armadillo.
#[test]
fn times_are_those_of_the_page_on_speed() {
    let page = read("docs/speed.md");
    let head = page.lines().find(|line| line.contains("| armadillo")).unwrap();
    let column = head.split('|').position(|name| name.contains("armadillo")).unwrap();
    let times = |task: &str, own: &[f64]| {
        let row = page.lines().find(|line| line.starts_with(&format!("| {task}"))).expect(task);
        [own, &numbers(row.split('|').nth(column).unwrap())].concat()
    };
    let implicit = times("implicit, uniform, λ = 5, 10 steps", &[5.0, 10.0]);
    assert_eq!(of_row("Implicit smoothing"), implicit);
    assert_eq!(of_row("15 eigenpairs"), times("15 eigenpairs", &[15.0]));
    assert_eq!(of_row("100 eigenpairs"), times("100 eigenpairs", &[100.0]));
}

#[test]
fn verdicts_on_the_coursework_are_those_of_the_report() {
    let results: Value = serde_json::from_str(&read("docs/report/results.json")).unwrap();
    let experiments = results["experiments"].as_array().unwrap();
    let claims = experiments.iter().flat_map(|e| e["claims"].as_array().into_iter().flatten());
    let theirs: Vec<&str> =
        claims.filter(|c| c["ours"] != true).map(|c| c["verdict"].as_str().unwrap()).collect();
    let count = |verdict: &str| theirs.iter().filter(|v| **v == verdict).count() as f64;
    let counts = ["refuted", "qualified", "confirmed"].map(count);
    let expected: Vec<f64> = [theirs.len() as f64].into_iter().chain(counts).collect();
    assert_eq!(of_sentence("every claim tested:"), expected);
}
