//! The comparison of curvature with other packages in the guide is that of its table.

use std::collections::BTreeMap;

use crate::advice::{choosing, largest, least, number, page, row_of, rows, says, shown, with};

/// A row of the table: its values by their columns.
type Row<'a> = &'a BTreeMap<String, String>;

/// The functions of the comparison with other packages: the row of the guide, package, function.
const FUNCTIONS: [[&str; 3]; 13] = [
    ["Fairing: `adaptive`", "pyfairing", "adaptive"],
    ["Fairing: `corrected-ball`", "pyfairing", "corrected-ball"],
    ["trimesh: discrete measures", "trimesh", "discrete curvature measures"],
    ["libigl: `principal_curvature`", "libigl", "principal_curvature"],
    ["CGAL: `Monge_via_jet_fitting`, two rings", "CGAL", "Monge_via_jet_fitting, two rings"],
    ["CGAL: `interpolated_corrected_curvatures`", "CGAL", "interpolated_corrected_curvatures"],
    ["Fairing: `quadric`", "pyfairing", "quadric"],
    ["PyMeshLab: principal directions", "pymeshlab", "curvature_principal_directions"],
    ["CGAL: `Monge_via_jet_fitting`, fewest rings", "CGAL", "Monge_via_jet_fitting, fewest rings"],
    ["Fairing: `cotangent`", "pyfairing", "cotangent"],
    ["PyMeshLab: discrete curvature", "pymeshlab", "scalar_by_discrete_curvature"],
    ["libigl: `cotmatrix`, `gaussian_curvature`", "libigl", "cotmatrix, gaussian_curvature"],
    ["VTK: `vtkCurvatures`", "vtk", "vtkCurvatures"],
];

/// The condition with correlated noise, for `adaptive` only.
const WAVES: &str = "waves of 0.1 h";

/// The errors of the comparison with other packages.
const ERRORS: [&str; 2] = ["RMS H [relative]", "RMS K [relative]"];

/// The median of a column over the meshes of a condition.
fn median_over(rows: &[Row<'_>], condition: &str, column: &str, factor: f64) -> f64 {
    let here = rows.iter().filter(|row| row["condition"] == condition);
    let mut values: Vec<f64> = here.map(|row| factor * number(row, column)).collect();
    assert_eq!(values.len(), 18, "{condition}");
    values.sort_by(f64::total_cmp);
    fairing::sparse::median(&values).unwrap()
}

/// The medians of a column in the order of the guide.
fn medians(rows: &[Row<'_>], column: &str, factor: f64) -> [f64; 4] {
    ["clean", "jittered", "0.03 h", "0.12 h"]
        .map(|condition| median_over(rows, condition, column, factor))
}

/// Medians of errors, versions, and how often errors are within the standard errors.
#[test]
fn curvature_of_other_packages_is_that_of_the_table() {
    let table = rows("docs/reference/curvature.csv");
    let page = choosing();
    let mut before = 0.0;
    for [cell, package, function] in FUNCTIONS {
        let mine = with(&table, &[("package", package), ("function", function)]);
        assert!(mine.iter().all(|row| row["undefined [count]"] == "0"), "{cell}");
        let [h, k] = ERRORS.map(|error| medians(&mine, error, 100.0));
        let expected: Vec<String> = h.iter().chain(&k).map(|x| shown(*x)).collect();
        assert_eq!(row_of("docs/guide/src/choosing.md", cell)[1..], expected, "{cell}");
        assert!(h[2] >= before, "{cell} is not in the order of its errors at 0.03 h");
        before = h[2];
        let name = cell.split(':').next().unwrap().replace("Fairing", "pyfairing");
        says(&page, &format!("{name} {}", mine[0]["version"]));
    }
    let on_waves = with(&table, &[("condition", WAVES)]).len();
    assert_eq!(table.len(), FUNCTIONS.len() * 72 + on_waves);

    let adaptive = with(&table, &[("function", "adaptive")]);
    let columns = ["within H [%]", "within K [%]"];
    let [h, k] = columns.map(|column| medians(&adaptive, column, 1.0).map(shown));
    let words = |q: &[String; 4]| format!("{} %, {} %, {} % and {} % for", q[0], q[1], q[2], q[3]);
    says(&page, &format!("The medians are {} H", words(&h)));
    says(&page, &format!("in the order of the columns, and {} K", words(&k)));
    let within = adaptive.iter().flat_map(|row| columns.map(|column| number(row, column)));
    let within: Vec<f64> = within.collect();
    let [low, high] = [least(&within), largest(&within)].map(shown);
    says(&page, &format!("it was {low} % to {high} % of the vertices"));
}

/// The meshes on which a function of another package is better than `adaptive`.
#[test]
fn losses_to_other_packages_are_those_of_the_table() {
    let table = rows("docs/reference/curvature.csv");
    let page = choosing();
    let mut ratios = vec![];
    for mine in with(&table, &[("function", "adaptive")]) {
        let of_mesh = ["surface", "vertices [count]", "condition"].map(|c| (c, mine[c].as_str()));
        let mut others = with(&table, &of_mesh);
        others.retain(|row| row["package"] != "pyfairing");
        for error in ERRORS {
            let best = others.iter().min_by(|a, b| number(a, error).total_cmp(&number(b, error)));
            let best = *best.unwrap();
            ratios.push((number(mine, error) / number(best, error), mine, best, error));
        }
    }
    let lost: Vec<_> = ratios.iter().filter(|r| r.0 > 1.0).collect();
    let on_tori = lost.iter().filter(|r| r.1["surface"].starts_with("torus")).count();
    says(
        &page,
        &format!(
            "In {} of {} comparisons (H and K of {} meshes) a function of another package had a \
             smaller error, {on_tori} times on a torus",
            lost.len(),
            ratios.len(),
            ratios.len() / 2
        ),
    );
    let is_clean_torus =
        |row: Row<'_>| row["surface"].starts_with("torus") && row["condition"] == "clean";
    let of_clean_tori = ratios.iter().filter(|r| is_clean_torus(r.1)).count();
    let lost_there: Vec<_> = lost.iter().filter(|r| is_clean_torus(r.1)).collect();
    let one_ring = ["cotmatrix, gaussian_curvature", "vtkCurvatures"];
    assert!(lost_there.iter().all(|r| one_ring.contains(&r.2["function"].as_str())));
    let words = format!("one ring was better in {} of {of_clean_tori} comp", lost_there.len());
    says(&page, &words);

    let worst = lost.iter().max_by(|a, b| a.0.total_cmp(&b.0)).unwrap();
    let (ratio, mine, best, error) = **worst;
    assert!(is_clean_torus(mine) && best["package"] == "vtk" && error == ERRORS[1]);
    let vertices = &mine["vertices [count]"];
    let [ours, theirs] = [mine, best].map(|row| shown(100.0 * number(row, error)));
    let ratio = shown(ratio);
    says(
        &page,
        &format!(
            "At worst, on such a torus with {vertices} vertices, the error of K was {ratio} times \
             that of VTK, {ours} % against {theirs} %"
        ),
    );
}

/// The noisy mesh on which other packages are better.
#[test]
fn a_coarse_noisy_torus_is_that_of_the_table() {
    let table = rows("docs/reference/curvature.csv");
    let mesh = [("surface", "torus 1 0.25"), ("vertices [count]", "624"), ("condition", "0.12 h")];
    let noisy = with(&table, &mesh);
    let of = |function: &str, error: &str| {
        let row = noisy.iter().find(|row| row["function"] == function).unwrap();
        shown(100.0 * number(row, error))
    };
    let [ours_h, ours_k] = ERRORS.map(|error| of("adaptive", error));
    let trimesh = of("discrete curvature measures", ERRORS[0]);
    let libigl = of("principal_curvature", ERRORS[1]);
    says(
        &choosing(),
        &format!(
            "was {ours_h} % in H and {ours_k} % in K; trimesh had {trimesh} % in H, and libigl's \
             `principal_curvature` {libigl} % in K"
        ),
    );
}

#[test]
fn curvature_on_waves_is_that_of_the_table() {
    let table = rows("docs/reference/curvature.csv");
    let page = page("docs/guide/src/curvature.md");
    let [without, with_option] = ["adaptive, independent", "adaptive, correlated"]
        .map(|function| with(&table, &[("condition", WAVES), ("function", function)]));
    let [h, k] = ERRORS.map(|error| {
        let of = |rows: &[Row<'_>]| shown(median_over(rows, WAVES, error, 100.0));
        format!("from {} % to {} %", of(&without), of(&with_option))
    });
    says(
        &page,
        &format!(
            "On 18 irregular meshes with waves of a tenth of an edge it took the \
             error of H {h} and that of K {k}"
        ),
    );
    let change = without.iter().zip(&with_option).map(|(&without, &with_option)| {
        let mesh = |row: Row<'_>| [row["surface"].clone(), row["vertices [count]"].clone()];
        assert_eq!(mesh(without), mesh(with_option));
        number(with_option, ERRORS[1]) / number(without, ERRORS[1])
    });
    let change: Vec<f64> = change.collect();
    assert_eq!(change.iter().filter(|x| **x > 1.0).count(), 1);
    says(
        &page,
        &format!(
            "on a coarse one the error of K became {} times as large",
            shown(largest(&change))
        ),
    );
    let [low, high] = [&with_option, &without].map(|rows| {
        let within: Vec<f64> = rows.iter().map(|row| number(row, "within H [%]")).collect();
        format!("{} % to {} %", shown(least(&within)), shown(largest(&within)))
    });
    says(&page, &format!("at {low} of the vertices, without the option at {high}"));
}
