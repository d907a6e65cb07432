//! The numbers and the recommendations of the guide and of the pages on denoising and speed are
//! those of the committed tables.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use fairing_operators::curvature::Estimator;
use fairing_smoothing::Method;

/// A table of a CSV file: a value for each column of each row.
pub(crate) type Rows = Vec<BTreeMap<String, String>>;

pub(crate) fn read(path: &str) -> String {
    fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(path)).unwrap()
}

/// The text of a page, with single spaces between words.
pub(crate) fn page(path: &str) -> String {
    read(path).split_whitespace().collect::<Vec<_>>().join(" ")
}

pub(crate) fn choosing() -> String {
    page("docs/guide/src/choosing.md")
}

/// The cells of a line, in which quotes protect commas.
fn cells(line: &str) -> Vec<String> {
    let mut cells = vec![String::new()];
    let mut quoted = false;
    for c in line.chars() {
        match c {
            '"' => quoted = !quoted,
            ',' if !quoted => cells.push(String::new()),
            _ => cells.last_mut().unwrap().push(c),
        }
    }
    cells
}

pub(crate) fn rows(path: &str) -> Rows {
    let text = read(path);
    let mut lines = text.lines().map(cells);
    let head = lines.next().unwrap();
    lines.map(|line| head.iter().cloned().zip(line).collect()).collect()
}

/// A table of the committed report.
pub(crate) fn report(path: &str) -> Rows {
    rows(&format!("docs/report/{path}"))
}

pub(crate) fn number(row: &BTreeMap<String, String>, column: &str) -> f64 {
    row.get(column).unwrap_or_else(|| panic!("no column {column}")).parse().unwrap()
}

/// The rows with these values in these columns.
pub(crate) fn with<'a>(
    rows: &'a Rows,
    values: &[(&str, &str)],
) -> Vec<&'a BTreeMap<String, String>> {
    rows.iter().filter(|row| values.iter().all(|(column, is)| row[*column] == *is)).collect()
}

/// Two digits, or hundredths below one, with a proper minus.
pub(crate) fn shown(x: f64) -> String {
    let text = match x.abs() {
        a if a >= 9.95 => format!("{x:.0}"),
        a if a >= 0.995 => format!("{x:.1}"),
        _ => format!("{x:.2}"),
    };
    text.replace('-', "−")
}

pub(crate) fn least(values: &[f64]) -> f64 {
    values.iter().copied().fold(f64::INFINITY, f64::min)
}

pub(crate) fn largest(values: &[f64]) -> f64 {
    values.iter().copied().fold(f64::NEG_INFINITY, f64::max)
}

/// The middle of a row of a Markdown table that begins with `start`, as cells.
pub(crate) fn row_of(path: &str, start: &str) -> Vec<String> {
    let text = read(path);
    let line = text.lines().find(|line| line.starts_with(&format!("| {start} |")));
    let line = line.unwrap_or_else(|| panic!("{path}: no row {start}"));
    line.trim_matches('|').split('|').map(|cell| cell.trim().to_owned()).collect()
}

#[track_caller]
pub(crate) fn says(page: &str, words: &str) {
    assert!(page.contains(words), "the page does not say: {words}");
}

/// The number at the start of a cell, bold or not.
fn leading(cell: &str) -> f64 {
    let cell = cell.trim_start_matches('*');
    let end = cell.find(|c: char| !(c.is_ascii_digit() || c == '.')).unwrap_or(cell.len());
    cell[..end].parse().unwrap_or_else(|_| panic!("no number in {cell}"))
}

#[test]
fn weights_and_estimators_are_as_the_report_has_them() {
    let page = choosing();
    let analytic = report("q3/analytic.csv");
    let (mut ratios, defaults) = (vec![], "docs/guide/src/defaults.md");
    for (surface, finest) in [("torus", "8192"), ("ellipsoid", "10242")] {
        for sampling in ["regular", "jittered"] {
            let at = [("surface", surface), ("sampling", sampling), ("vertices [count]", finest)];
            let of = |name: &str| {
                let row = with(&analytic, &[&at[..], &[("estimator", name)]].concat())[0];
                number(row, "RMS error [relative]")
            };
            let [mixed, barycentric] =
                ["mixed", "barycentric"].map(|area| of(&format!("cotangent, {area} area")));
            ratios.push(of("uniform, scaled") / mixed);
            assert!(mixed < barycentric, "{surface}, {sampling}");
            let in_percent = [mixed, barycentric].map(|x| shown(100.0 * x));
            assert_eq!(row_of(defaults, &format!("{surface}, {sampling}"))[1..], in_percent);
        }
    }
    let ratio = (least(&ratios) * 10.0).floor() / 10.0;
    says(&page, &format!("was at least {ratio:.1} times smaller"));
    says(&self::page(defaults), &format!("at least {ratio:.1} times the error"));

    let ordinary = report("estimators/ordinary.csv");
    let columns = ["H over the best other [1]", "K over the best other [1]"];
    let of_adaptive: Vec<f64> = with(&ordinary, &[("estimator", "adaptive")])
        .iter()
        .filter(|row| row["surface"] != "sphere")
        .flat_map(|row| columns.map(|column| number(row, column)))
        .collect();
    let above = of_adaptive.iter().filter(|x| **x > 1.0).count();
    says(&page, &format!("In {above} of {} comparisons", of_adaptive.len()));
    says(&page, &format!("it was {} times as large", shown(largest(&of_adaptive))));

    let times = report("estimators/times.csv");
    let time = |name: &str| number(with(&times, &[("estimator", name)])[0], "time per vertex [s]");
    let all: Vec<f64> = Estimator::all().iter().map(|e| time(e.name())).collect();
    let slowest = largest(&all);
    assert!(time("adaptive") == slowest && time("jet4") > 10.0 * time("cotangent"));
    assert!((5.0..20.0).contains(&(slowest / time("corrected-ball"))));

    let orders = report("estimators/orders.csv");
    let values: Vec<f64> = with(&orders, &[("estimator", "cotangent"), ("sampling", "jittered")])
        .iter()
        .filter(|row| row["surface"] != "graph")
        .flat_map(|row| ["max H [order]", "max K [order]"].map(|column| number(row, column)))
        .collect();
    let [low, high] =
        [(least(&values) * 100.0).floor() / 100.0, (largest(&values) * 100.0).ceil() / 100.0];
    says(&page, &format!("with an order of {low:.2} to {high:.2}").replace('-', "−"));

    let changes = report("noise/changes.csv");
    let cotangent = with(&changes, &[("estimator", "cotangent"), ("σ/h [h]", "0.01")]);
    let change = |column: &str| {
        least(&cotangent.iter().map(|row| 100.0 * number(row, column)).collect::<Vec<_>>()).floor()
    };
    let [k, h] = ["change of K [relative]", "change of H [relative]"].map(change);
    says(&page, &format!("by {k} % and more, and their H by {h} % and more"));
}

#[test]
fn flows_are_as_the_report_has_them() {
    let methods = report("flows/methods.csv");
    for row in &methods {
        let name = match row["method"].as_str() {
            "input" => "noisy input".to_owned(),
            name => format!("`{name}`"),
        };
        let angle = format!("{}°", shown(number(row, "normal error [°]")));
        let volume = format!("{} %", shown(number(row, "volume [%]")));
        assert_eq!(row_of("docs/guide/src/choosing.md", &name)[1..], [angle, volume], "{name}");
    }
    // The methods recommended for the same size change it least, and the one called best least.
    let mut order: Vec<(f64, &str)> = methods
        .iter()
        .filter(|row| row["method"] != "input")
        .map(|row| (number(row, "volume [%]").abs(), row["method"].as_str()))
        .collect();
    order.sort_by(|a, b| a.0.total_cmp(&b.0));
    let advised = &row_of("docs/guide/src/choosing.md", "less noise, the same size")[1];
    for (volume, name) in &order[..3] {
        assert!(advised.contains(&format!("`{name}`")) && *volume < 1.0, "{name}: {volume} %");
    }
    assert_eq!(advised.matches('`').count(), 6, "{advised}");
    for method in Method::all() {
        let is_best = method.description().contains("shapes best");
        assert_eq!(is_best, method.name() == order[0].1, "{}", method.name());
    }

    let iterations = report("q6/iterations.csv");
    let long = [("flow", "explicit"), ("lambda [1]", "0.5"), ("iterations [count]", "100")];
    let apart = with(&iterations, &long);
    let apart = apart.iter().map(|row| number(row, "from 10 implicit steps [h]"));
    let most = (largest(&apart.collect::<Vec<_>>()) * 1000.0).ceil() / 1000.0;
    says(&choosing(), &format!("ended at most {most} h apart"));
}

#[test]
fn denoisers_are_as_the_report_has_them() {
    let page = choosing();
    let best = report("denoisers/best.csv");
    for row in &best {
        let numbers = ["noisy [°]", "its normal error [°]", "automatic [°]"];
        let [noisy, published, automatic] = numbers.map(|column| number(row, column));
        assert!(automatic < published, "{}", row["mesh"]);
        let level = row["mesh"].split_once(", ").unwrap().1;
        if level != "0.2 h" {
            let [noisy, published, automatic] = [noisy, published, automatic].map(shown);
            says(&page, &format!("| {level} | {noisy}° | {published}° | {automatic}° |"));
        }
    }
    let scores = report("denoisers/scores.csv");
    let count = scores.iter().filter(|row| row["mesh"] == best[0]["mesh"]).count() - 2;
    assert_eq!(count, 9);
    says(&page, "the best of nine published methods on that mesh");

    let sets = report("denoisers/sets.csv");
    let of = |set: &str| with(&sets, &[("set", set)])[0].clone();
    let (fresh, unseen) = (of("fresh"), of("unseen"));
    let [median, worst] = ["median ratio [1]", "worst ratio [1]"];
    says(&page, &format!("was {} times that of the best of eight", shown(number(&fresh, median))));
    says(&page, &format!("and {} times at worst; ten", shown(number(&fresh, worst))));
    assert_eq!(fresh["above 1.1 [count]"], "10");
    let [median, worst] = [median, worst].map(|column| shown(number(&unseen, column)));
    says(&page, &format!("it was {median} times, and {worst} times at worst"));
}

/// The level in h up to which a method keeps a shape.
fn kept(limits: &Rows, mesh: &str, method: &str) -> f64 {
    number(with(limits, &[("mesh", mesh), ("method", method)])[0], "kept up to [h]")
}

/// The flows of the table of limits, by the names of the program.
const FLOWS: [(&str, &str); 4] = [
    ("explicit", "explicit"),
    ("low-pass", "spectral"),
    ("taubin", "Taubin"),
    ("implicit", "implicit"),
];

/// The flows recommended under strong noise are the last to fail on smooth shapes.
#[test]
fn advice_for_strong_noise_is_that_of_the_table() {
    let limits = report("q7/limits.csv");
    let page = "docs/guide/src/choosing.md";
    let shapes = [
        ("block with creases", "coarse machine part"),
        ("smooth torus", "torus"),
        ("creature", "creature"),
    ];
    let advised = &row_of(page, "smooth, without creases, noise of 0.7 h or more")[1];
    for (words, mesh) in shapes {
        let flows = FLOWS.map(|(_, method)| kept(&limits, mesh, method));
        let denoisers = limits.iter().filter(|row| {
            let method = row["method"].as_str();
            row["mesh"] == mesh
                && method != "automatic"
                && fairing_denoising::Denoiser::all().iter().any(|d| d.name() == method)
        });
        let published =
            largest(&denoisers.map(|r| number(r, "kept up to [h]")).collect::<Vec<_>>());
        let automatic = kept(&limits, mesh, "automatic");
        let expected = flows.iter().chain([&published, &automatic]).map(|x| match x {
            0.0 => "0".to_owned(),
            x => format!("{} h", shown(*x)),
        });
        assert_eq!(row_of(page, words)[1..], expected.collect::<Vec<_>>(), "{words}");
        assert_eq!(kept(&limits, mesh, "implicit, 5 × 10"), 0.0, "the default of implicit");
        if mesh != "coarse machine part" {
            for ((name, _), level) in FLOWS.iter().zip(flows) {
                let is_advised = advised.contains(name);
                assert_eq!(level > automatic.max(published), is_advised, "{mesh}: {name}");
                let method = Method::by_name(name).unwrap();
                assert_eq!(method.description().contains("strong noise"), is_advised, "{name}");
            }
        }
    }
}

#[test]
fn volumes_under_strong_noise_are_as_the_report_has_them() {
    let sweep = report("q7/sweep.csv");
    let value = |mesh: &str, level: &str, method: &str, column: &str| {
        let row = with(&sweep, &[("mesh", mesh), ("σ/h [h]", level), ("method", method)])[0];
        number(row, column)
    };
    let loss = |mesh, method| shown(-value(mesh, "1.4", method, "volume [%]"));
    let text = choosing();
    says(
        &text,
        &format!(
            "the torus lost {} % of its volume and the creature {} %, with `low-pass` {} % and {} %",
            loss("torus", "explicit"),
            loss("creature", "explicit"),
            loss("torus", "spectral"),
            loss("creature", "spectral"),
        ),
    );
    says(&text, &format!("it takes {} % of the volume", loss("torus", "implicit, 5 × 10")));
    let angle = |method| value("torus", "0.1", method, "normal error [°]");
    assert!(angle("explicit").max(angle("spectral")) < angle("automatic"));
}

const DENOISING: &str = "docs/denoising.md";

/// Returns true if a cell shows a number to hundredths; tables have it to thousandths.
fn is_shown(cell: &str, value: f64) -> bool {
    (leading(cell) - value).abs() < 0.0056
}

/// The least of a row is bold, and the row has the errors of the table of pairs.
#[test]
fn pairs_of_the_literature_are_those_of_the_table() {
    let table = rows("study/results/pairs.csv");
    let mut names: Vec<&str> = table.iter().map(|row| row["pair"].as_str()).collect();
    names.dedup();
    let (mut sums, mut known) = ([0.0; 3], vec![]);
    for name in &names {
        let of_pair = with(&table, &[("pair", name)]);
        let of = |is: &dyn Fn(&str) -> bool| -> Vec<f64> {
            let found = of_pair.iter().filter(|row| is(&row["method"]));
            found.map(|row| number(row, "angle")).collect()
        };
        let noisy = of(&|m| m == "noisy")[0];
        let automatic = of(&|m| m == "automatic")[0];
        let authors = of(&|m| m.starts_with("authors"));
        let denoisers = fairing_denoising::Denoiser::all();
        let published =
            of(&|m| m != "automatic" && denoisers.iter().any(|denoiser| denoiser.name() == m));
        assert_eq!(published.len(), 9, "{name}");
        let best = least(&published);
        let cells = row_of(DENOISING, name);
        assert!(is_shown(&cells[2], noisy), "{name}: {noisy}");
        let results = [(3, Some(automatic)), (4, authors.first().copied()), (5, Some(best))];
        let least = least(&[&[automatic, best][..], &authors].concat());
        for (column, value) in results {
            let Some(value) = value else {
                assert!(cells[column].is_empty(), "{name}");
                continue;
            };
            assert!(is_shown(&cells[column], value), "{name}: {value}");
            assert_eq!(cells[column].starts_with("**"), value == least, "{name}");
        }
        for (sum, value) in sums.iter_mut().zip([noisy, automatic, best]) {
            *sum += value / names.len() as f64;
        }
        known.extend(authors.first().map(|authors| [noisy, automatic, *authors, best]));
    }
    let mean = row_of(DENOISING, "mean");
    for (column, value) in [2, 3, 5].into_iter().zip(sums) {
        assert!(is_shown(&mean[column], value), "{mean:?}: {value}");
    }
    let mean = row_of(DENOISING, "mean where authors' results are known");
    for column in 0..4 {
        let value = known.iter().map(|row| row[column]).sum::<f64>() / known.len() as f64;
        assert!(is_shown(&mean[column + 2], value), "{mean:?}: {value}");
    }
    // The advice for laser scans.
    for scan in ["ScanBunny090", "ScanDragon0"] {
        let angle =
            |method| number(with(&table, &[("pair", scan), ("method", method)])[0], "angle");
        let stronger = angle("automatic, strength 2");
        assert!(stronger < angle("automatic"));
        says(&page(DENOISING), &format!("{stronger:.2}°"));
    }
}

/// Arithmetic means over the cases of fresh families, by the kind of noise.
#[test]
fn means_over_fresh_families_are_those_of_the_table() {
    let families = rows("docs/reference/denoising/families.csv");
    let fresh: Vec<&str> =
        with(&families, &[("set", "fresh")]).iter().map(|row| row["family"].as_str()).collect();
    let (ours, published) =
        (rows("study/results/automatic.csv"), rows("study/results/published.csv"));
    let kinds = [
        ("independent, along normals", "normal"),
        ("independent, on all axes", "axes"),
        ("of varying level", "varying"),
        ("impulses on a quarter of the vertices", "impulsive"),
        ("correlated over two edges", "correlated"),
    ];
    for (words, kind) in kinds {
        let cases: Vec<_> = ours
            .iter()
            .filter(|row| {
                let mut parts = row["case"].split(' ');
                fresh.contains(&parts.next().unwrap()) && parts.nth(1) == Some(kind)
            })
            .collect();
        let mean = |column: &str| {
            cases.iter().map(|row| number(row, column)).sum::<f64>() / cases.len() as f64
        };
        let mut defaults: BTreeMap<&str, f64> = BTreeMap::new();
        for row in &published {
            if cases.iter().any(|case| case["case"] == row["case"]) {
                *defaults.entry(&row["method"]).or_default() +=
                    number(row, "default") / cases.len() as f64;
            }
        }
        assert_eq!(defaults.len(), 8, "{words}");
        let best = least(&defaults.values().copied().collect::<Vec<_>>());
        let cells = row_of(DENOISING, words);
        assert_eq!(cells[1], cases.len().to_string(), "{words}");
        let (noisy, automatic) = (mean("noisy"), mean("angle"));
        for (cell, value) in cells[2..].iter().zip([noisy, automatic, best]) {
            assert!((leading(cell) - value).abs() < 0.0501, "{words}: {cell}, {value}");
        }
        assert_eq!(cells[3].starts_with("**"), automatic < best, "{words}");
    }
}

#[test]
fn ratios_and_times_of_denoising_are_those_of_the_tables() {
    let text = page(DENOISING);
    let sets = rows("docs/reference/denoising/sets.csv");
    let of = |column: &str| -> Vec<String> {
        let set = |name| with(&sets, &[("set", name)])[0].clone();
        ["development", "unseen", "fresh"].map(|name| set(name)[column].clone()).to_vec()
    };
    let two = |column: &str| -> Vec<String> {
        of(column).iter().map(|x| shown(x.parse().unwrap())).collect()
    };
    let (median, worst) = (two("median ratio [1]"), two("worst ratio [1]"));
    says(
        &text,
        &format!(
            "{} on the development set, {} on the unseen and {} on the fresh set, and the largest \
             {}, {} and {}",
            median[0], median[1], median[2], worst[0], worst[1], worst[2]
        ),
    );
    let (lost, cases) = (of("worse than a default [count]"), of("cases [count]"));
    let pairs: Vec<String> = (0..3).map(|k| format!("{} of {}", lost[k], cases[k])).collect();
    says(&text, &format!("better on {}, {} and {} meshes", pairs[0], pairs[1], pairs[2]));

    let speed = row_of("docs/speed.md", "denoising");
    for (faces, column) in [("82 thousand", 1), ("328 thousand", 2), ("1.31 million", 3)] {
        assert_eq!(row_of(DENOISING, faces)[1], speed[column], "{faces}");
    }
    assert_eq!(row_of(DENOISING, "1.31 million")[2], *speed.last().unwrap());
}
