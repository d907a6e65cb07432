//! The page about speed, `docs/speed.md`: a comparison with other libraries, measured elsewhere,
//! and times over the number of vertices, measured here.

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context as _, Result, ensure};
use fairing_evaluation::{NoiseKind, NoiseLevel, add_noise};
use fairing_figure::{Axis, Figure, Panel, Plot, Series};
use fairing_mesh::io;
use fairing_shapes::icosphere;
use fairing_sparse::{larger, upper_median};
use serde_json::Value;

use crate::fresh::{Fresh, Times};

/// A task over the number of vertices.
struct Scaled {
    /// The words of the table.
    words: &'static str,
    task: &'static str,
    arguments: &'static [&'static str],
    /// The finest sphere.
    last: u32,
}

/// The spheres, by the number of times that the icosahedron is subdivided: 10 · 4ᵏ + 2 vertices.
const LEVELS: std::ops::RangeInclusive<u32> = 6..=10;

/// The finest sphere for the rates of products, with 2.6 million vertices.
const FINEST: u32 = 9;

const SCALED: [Scaled; 16] = [
    Scaled { words: "read PLY", task: "load_ply", arguments: &[], last: 10 },
    Scaled { words: "S and M", task: "laplacian", arguments: &[], last: 10 },
    Scaled { words: "H and K", task: "curvature", arguments: &[], last: 10 },
    Scaled { words: "principal curvatures", task: "principal", arguments: &[], last: 10 },
    Scaled { words: "curvature, default", task: "principal", arguments: ADAPTIVE, last: 10 },
    Scaled { words: "explicit, 50 steps", task: "explicit_uniform", arguments: FIFTY, last: 10 },
    Scaled { words: "Taubin, 50 pairs", task: "taubin", arguments: FIFTY, last: 10 },
    Scaled { words: "implicit, uniform", task: "implicit_uniform", arguments: FIVE, last: 10 },
    Scaled { words: "implicit, cotangents", task: "implicit_cotan", arguments: FIVE, last: 10 },
    Scaled { words: "implicit, 100 h²", task: "implicit_cotan_stiff", arguments: STIFF, last: 10 },
    Scaled { words: "mean curvature flow", task: "implicit_mcf", arguments: FIVE, last: 10 },
    Scaled { words: "harmonic system", task: "harmonic", arguments: &["--k=1"], last: 9 },
    Scaled { words: "biharmonic system", task: "harmonic", arguments: &["--k=2"], last: 9 },
    Scaled { words: "triharmonic system", task: "harmonic", arguments: &["--k=3"], last: 8 },
    Scaled { words: "15 eigenpairs", task: "eigs", arguments: &["--k=15"], last: 9 },
    Scaled { words: "denoising", task: "denoise", arguments: &[], last: 8 },
];

const ADAPTIVE: &[&str] = &["--estimator=adaptive"];
const FIFTY: &[&str] = &["--iters=50"];
const FIVE: &[&str] = &["--lambda=5"];
const STIFF: &[&str] = &["--lambda=100"];

/// Noise of the spheres in mean edge lengths.
const NOISE: f64 = 0.1;

/// A task with its times at each size.
struct Row {
    words: &'static str,
    /// Vertices and times.
    times: Vec<(f64, Times)>,
}

/// Rates in GB/s, where they were measured.
struct Rate {
    vertices: f64,
    triad: Option<f64>,
    product: Option<f64>,
}

impl Row {
    /// The slope of log t over log n, by least squares.
    fn exponent(&self) -> Option<f64> {
        let points: Vec<[f64; 2]> =
            self.times.iter().map(|(n, t)| [libm::log(*n), libm::log(t.first)]).collect();
        let count = points.len() as f64;
        let mean = [0, 1].map(|k| points.iter().map(|p| p[k]).sum::<f64>() / count);
        let product = |a: usize, b: usize| {
            points.iter().map(|p| (p[a] - mean[a]) * (p[b] - mean[b])).sum::<f64>()
        };
        (points.len() > 1).then(|| product(0, 1) / product(0, 0))
    }
}

/// Writes the page below `docs`. With a `finest` sphere it measures and draws times over the number
/// of vertices; without, those of the page stay, with their date and machine.
pub(crate) fn write(
    comparison: Option<&Path>,
    leaderboard: Option<&Path>,
    finest: Option<u32>,
) -> Result<()> {
    let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs");
    let page = docs.join("speed.md");
    let sizes = match finest {
        Some(finest) => {
            let folder = std::env::temp_dir().join(format!("fairing-speed-{}", std::process::id()));
            fs::create_dir_all(&folder)?;
            let measured = measured(&folder, finest);
            fs::remove_dir_all(&folder)?;
            let (rows, rates) = measured?;
            fs::write(docs.join("pictures/scale.svg"), picture(&rows)?)?;
            over_size(&rows) + &bandwidth(&rates)
        }
        None => {
            let old = fs::read_to_string(&page)?;
            let start = old.find(OVER_SIZE).context("the page has no times over the vertices")?;
            old[start..].to_owned()
        }
    };
    let mut text = String::from(HEAD);
    let read = |path: &Path| {
        fs::read_to_string(path).with_context(|| format!("reading {}", path.display()))
    };
    if let Some(path) = comparison {
        text.push_str(&compared(&serde_json::from_str(&read(path)?)?)?);
    }
    if let Some(path) = leaderboard {
        text.push_str(&harmonic(&read(path)?));
    }
    Ok(fs::write(page, text + &sizes)?)
}

/// The heading of times over the number of vertices.
const OVER_SIZE: &str = "\n## Over the number of vertices\n";

const HEAD: &str = "# Speed

`cargo xtask bench page` writes this page. `cargo xtask bench TASK --in FILE` measures one task on your mesh.

Three kinds of times have the same names on all pages. *Best of many* is the least time of a task that one process
repeats, with warm caches and with memory already allocated. *First of a process* is the time of the first run in a new
process. Neither includes the start of the program, or the reading of a file unless this is the task. *Whole program* is
the time of a command from start to end, with its files. Tables from different days differ, so compare times within one
table only.
";

/// Published times of another solver of eigenproblems beside ours, `{ours}`, of the machine
/// `{cpu}`.
const PUBLISHED: &str = "
### Published times

The authors of HSIM (Nasikun and Hildebrandt 2021) measured it faster than Lanczos iterations; we have not run it. The
table has 100 eigenpairs: HSIM from table 1 of its [supplement](https://arxiv.org/abs/2111.09244), with distances by
Dijkstra's method, on a machine that the table does not name; and Fairing from the table above, best of many, on {cpu}.
Meshes, machines and tolerances differ, so these times give no ratio.

| Mesh | Vertices | Solver | Tolerance | Seconds |
|---|--:|---|---|--:|
| Gargoyle | 85k | HSIM | 10⁻² | 10.5 |
| Gargoyle | 85k | HSIM | 10⁻⁴ | 18.0 |
| sphere | 164k | Fairing | default | {ours} |
| Fertility | 270k | HSIM | 10⁻² | 35.8 |
| Fertility | 270k | HSIM | 10⁻⁴ | 68.9 |
| Oil-pump | 570k | HSIM | 10⁻² | 93.9 |
| Oil-pump | 570k | HSIM | 10⁻⁴ | 142.8 |
";

/// Runs every task on every sphere, each in a process of its own.
fn measured(folder: &Path, finest: u32) -> Result<(Vec<Row>, Vec<Rate>)> {
    let mut rows: Vec<Row> =
        SCALED.iter().map(|scaled| Row { words: scaled.words, times: vec![] }).collect();
    let mut rates = vec![];
    for level in LEVELS.filter(|level| *level <= finest) {
        let path = sphere(folder, level)?;
        let vertices = 10.0 * libm::pow(4.0, f64::from(level)) + 2.0;
        for (row, scaled) in rows.iter_mut().zip(&SCALED) {
            if level > scaled.last {
                continue;
            }
            let process = Fresh::new(scaled.task, &path, scaled.arguments);
            let count = if level < 8 { 3 } else { 1 };
            let runs: Vec<Times> = (0..count).map(|_| process.run()).collect::<Result<_>>()?;
            let first = runs.iter().map(|times| times.first).collect();
            let first = upper_median(first).context("no runs")?;
            let times = Times { first, ..runs[0] };
            eprintln!("{vertices:>9} vertices, {}: {:.3} s", scaled.words, times.first);
            row.times.push((vertices, times));
        }
        if level <= FINEST {
            let result = Fresh::new("bandwidth", &path, &[]).result()?;
            let [triad, product] =
                ["triad", "product"].map(|key| result["fingerprint"][key].as_f64());
            rates.push(Rate { vertices, triad, product });
        }
        fs::remove_file(path)?;
    }
    Ok((rows, rates))
}

/// Writes a sphere with noise.
fn sphere(folder: &Path, level: u32) -> Result<PathBuf> {
    let noise = NoiseLevel::EdgeLengths(NOISE);
    let mesh = add_noise(&icosphere(level), NoiseKind::GaussianAlongNormals, noise, 1)?;
    let path = folder.join(format!("sphere{level}.ply"));
    io::write(&path, &mesh)?;
    Ok(path)
}

/// The words of the comparison's tasks.
const COMPARED: [(&str, &str); 16] = [
    ("load_obj", "read OBJ"),
    ("load_ply", "read binary PLY"),
    ("save_ply", "write binary PLY"),
    ("laplacian", "S and M by cotangents"),
    ("curvature", "H and K"),
    ("explicit_uniform", "explicit, uniform, 50 steps"),
    ("taubin", "Taubin, 50 pairs of steps"),
    ("implicit_uniform", "implicit, uniform, λ = 5, 10 steps"),
    ("implicit_cotan", "implicit, cotangents, 5 h², 10 steps"),
    ("implicit_cotan_stiff", "implicit, cotangents, 100 h², 10 steps"),
    ("implicit_mcf", "mean curvature flow, 5 h², 10 steps"),
    ("metrics", "distances and normals both ways"),
    ("end_to_end", "read OBJ, implicit, uniform, 10 steps, write PLY"),
    ("eigs15", "15 eigenpairs"),
    ("eigs100", "100 eigenpairs"),
    ("eigs300", "300 eigenpairs"),
];

/// A text of a JSON object; empty if there is none.
fn text(value: &Value, key: &str) -> String {
    value[key].as_str().unwrap_or_default().to_owned()
}

/// The versions of other programs and libraries that a comparison recorded.
fn versions(results: &Value) -> String {
    let recorded = results["versions"].as_object().into_iter().flatten();
    let names =
        recorded.filter_map(|(name, version)| Some(format!("{name} {}", version.as_str()?)));
    let names: Vec<String> = names.collect();
    if names.is_empty() {
        return "The versions of the other programs and of their BLAS were not recorded."
            .to_owned();
    }
    format!("Versions: {}.", names.join(", "))
}

/// Ratios to the fastest of the others, the largest first, from the results of a comparison: a list
/// `results` of tasks and meshes with `rows`, each with name, threads, `min` and `cold_median` in
/// seconds, and `ours`; and a `note` on how it was made and `versions`, if there are any.
fn compared(results: &Value) -> Result<String> {
    let mut page = format!(
        "\n## Against other libraries\n\nSeconds, the name of the fastest other program, and the ratio to its \
         time in brackets, measured on {}, {}. {} Runs alternate between programs. A program is included if \
         its result agrees, even if it checks no errors: `from_chars` is a bare reader of OBJ, and numpy writes \
         its arrays unchanged. A ratio above 1 is a loss, in bold; the largest ratios come first.\n",
        text(results, "cpu"),
        text(results, "when"),
        versions(results),
    );
    let all = results["results"].as_array().context("the comparison has no results")?;
    for task in all.iter().map(|result| text(result, "task")) {
        let is_known = COMPARED.iter().any(|(name, _)| *name == task);
        ensure!(is_known, "no words for the task {task}");
    }
    let mut meshes: Vec<String> = vec![];
    for mesh in all.iter().map(|result| text(result, "mesh")) {
        if !meshes.contains(&mesh) {
            meshes.push(mesh);
        }
    }
    for (key, heading) in
        [("min", "Best of many"), ("cold_median", "First of a process, median over processes")]
    {
        let heads: Vec<String> = meshes.iter().map(|mesh| mesh.replace('_', " ")).collect();
        let _ = write!(page, "\n### {heading}\n\n| Task | {} |\n|---|", heads.join(" | "));
        let _ = writeln!(page, "{}", "---|".repeat(meshes.len()));
        let mut lines = vec![];
        for (task, words) in COMPARED {
            let of = |mesh: &String| {
                all.iter().find(|r| text(r, "task") == task && text(r, "mesh") == *mesh)
            };
            let cells: Vec<Option<(f64, String)>> = meshes
                .iter()
                .map(|mesh| of(mesh).map_or(Ok(None), |result| beside(result, key)))
                .collect::<Result<_>>()?;
            let largest = cells.iter().flatten().map(|cell| cell.0).fold(0.0, larger);
            let cells = cells.into_iter().map(|cell| cell.map_or("–".into(), |cell| cell.1));
            lines.push((
                largest,
                format!("| {words} | {} |\n", cells.collect::<Vec<_>>().join(" | ")),
            ));
        }
        lines.sort_by(|a, b| b.0.total_cmp(&a.0));
        // A task that was not compared has no ratio.
        page.extend(lines.into_iter().filter(|line| line.0 > 0.0).map(|line| line.1));
    }
    if let Some(note) = results["note"].as_str() {
        let _ = writeln!(page, "\n{note}");
    }
    let sphere =
        all.iter().find(|r| text(r, "task") == "eigs100" && text(r, "mesh") == "sphere_160k");
    let rows = sphere.and_then(|result| result["rows"].as_array()).into_iter().flatten();
    if let Some(ours) = rows.into_iter().find(|row| row["ours"] == true) {
        let ours = rounded(ours["min"].as_f64().context("a row has no times")?);
        page += &PUBLISHED.replace("{ours}", &ours).replace("{cpu}", &text(results, "cpu"));
    }
    Ok(page)
}

/// The ratio to the fastest other program that agrees, and the cell of the table; `None` without
/// both.
fn beside(result: &Value, key: &str) -> Result<Option<(f64, String)>> {
    let rows = result["rows"].as_array().context("a task has no rows")?;
    let agrees = |r: &&Value| !text(r, "agrees").starts_with("differs");
    let ours = rows.iter().find(|r| r["ours"] == true).filter(agrees).and_then(|r| r[key].as_f64());
    let others = rows.iter().filter(|r| r["ours"] != true && r["same"] == true).filter(agrees);
    let best = others
        .filter_map(|r| Some((r[key].as_f64()?, text(r, "name"))))
        .min_by(|a, b| a.0.total_cmp(&b.0));
    let (Some(ours), Some((seconds, name))) = (ours, best) else { return Ok(None) };
    let ratio = ours / seconds;
    let mark = if ratio > 1.0 { "**" } else { "" };
    Ok(Some((ratio, format!("{} ({mark}{ratio:.2}{mark} {name})", rounded(ours)))))
}

/// The tables of the leaderboard.
fn harmonic(printed: &str) -> String {
    format!(
        "\n## k-harmonic systems\n\nThe systems of [sparse-solver-benchmark](https://github.com/alecjacobson/\
         sparse-solver-benchmark), printed by `cargo xtask bench leaderboard --in FILE`: (Wᵏ + M) u = M x with \
         W = S, mixed areas in M and three columns, for k = 1, 2 and 3, and the mixed systems, which have an \
         unknown for each power of M⁻¹S and are indefinite. *Factor* includes the ordering, *Solve* our \
         corrections; each ran once. The error is the componentwise relative backward error. It says nothing \
         of the digits of u: on an armadillo of 173 thousand vertices in a unit box, the two triharmonic systems \
         had errors of 10⁻¹⁵ and different solutions.\n\n{}\n",
        printed.trim().replace("\n# ", "\n### ")
    )
}

/// The table of times over the number of vertices.
fn over_size(rows: &[Row]) -> String {
    let mut page = format!(
        "{OVER_SIZE}\nSeconds, *first of a process*, measured on {}, {}. The value is the \
         median of three processes up to 170 thousand vertices, and a single process above. The meshes are \
         spheres with noise of {NOISE} h, with twice as many faces as vertices. Flows take ten steps unless \
         the row has another number. Systems are assembled, factorised, solved for three columns and \
         refined. The exponent is the slope of the least-squares line through the logarithms; memory is the \
         peak of the process at the largest size. A dash is a size that was not run: by extrapolation \
         eigenpairs and the biharmonic system would need more than 24 GB, the other systems most of it, and \
         denoising more than five minutes.\n\n\
         ![Time over the number of vertices](pictures/scale.svg)\n\n",
        machine(),
        today(),
    );
    let most = rows.iter().max_by_key(|row| row.times.len());
    let sizes: Vec<f64> = most.map_or(vec![], |row| row.times.iter().map(|(n, _)| *n).collect());
    let heads: Vec<String> = sizes.iter().map(|n| thousands(*n)).collect();
    let _ = writeln!(page, "| Task | {} | Exponent | Memory |", heads.join(" | "));
    let _ = writeln!(page, "|---|{}--:|--:|", "--:|".repeat(sizes.len()));
    for row in rows {
        let mut cells = vec![row.words.to_owned()];
        cells.extend((0..sizes.len()).map(|k| match row.times.get(k) {
            Some((_, times)) => rounded(times.first),
            None => "–".into(),
        }));
        cells.push(row.exponent().map_or("–".into(), |p| format!("{p:.2}")));
        let memory = row.times.last().and_then(|(_, times)| times.megabytes);
        cells.push(memory.map_or("–".into(), |mb| format!("{:.2} GB", mb / 1024.0)));
        let _ = writeln!(page, "| {} |", cells.join(" | "));
    }
    page
}

/// The table of the rates of a product with S and of a triad.
fn bandwidth(rates: &[Rate]) -> String {
    let mut page = String::from(
        "\n## Fraction of the memory bandwidth\n\nThe product of S with three columns reads each entry once. Its \
         rate counts the values, columns and row starts of S, and each position once as input and once as \
         output. The triad a = b + s c is that of STREAM, on arrays of 64 MB, in the same process. A rate \
         above that of the triad means that a cache held part of the matrix. Machine and date are those of \
         the last table.\n\n\
         | Vertices | S times three columns, GB/s | Triad, GB/s | Fraction |\n|--:|--:|--:|--:|\n",
    );
    for Rate { vertices, triad, product } in rates {
        if let (Some(triad), Some(product)) = (triad, product) {
            let (vertices, share) = (thousands(*vertices), 100.0 * product / triad);
            let _ = writeln!(page, "| {vertices} | {product:.1} | {triad:.1} | {share:.0} % |");
        }
    }
    page
}

/// Log–log lines of all tasks.
fn picture(rows: &[Row]) -> Result<String> {
    let mut plot = Plot { x: Axis::log("vertices"), y: Axis::log("seconds"), ..Plot::default() };
    for row in rows {
        let points = row.times.iter().map(|(n, times)| [*n, times.first]).collect();
        plot.series.push(Series::marked(row.words, points));
    }
    let panels = vec![Panel::drawing(plot.draw(760.0, 460.0)?)];
    Ok(Figure { panels, columns: 1, ..Figure::default() }.to_svg()?)
}

/// Processors and threads, in the words of the system.
pub(crate) fn machine() -> String {
    let text = fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let name = text.lines().find_map(|l| l.strip_prefix("model name")?.split_once(':'));
    let name = name.map_or("a processor that the system does not name", |(_, name)| name.trim());
    format!("{name}, {} threads", rayon::current_num_threads())
}

/// The date of the measurement; empty without the program `date`.
fn today() -> String {
    let output = Command::new("date").arg("+%F").output();
    output.map_or_else(|_| String::new(), |o| String::from_utf8_lossy(&o.stdout).trim().to_owned())
}

/// Three digits.
fn rounded(seconds: f64) -> String {
    match seconds {
        s if s < 0.1 => format!("{s:.4}"),
        s if s < 1.0 => format!("{s:.3}"),
        s if s < 10.0 => format!("{s:.2}"),
        s => format!("{s:.1}"),
    }
}

/// `164 000` as `164k`, and `2 621 442` as `2.6M`.
fn thousands(count: f64) -> String {
    match count {
        n if n < 1e6 => format!("{:.0}k", n / 1e3),
        n => format!("{:.1}M", n / 1e6),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_exponent_of_a_power_is_found() {
        let time = |n: f64| Times { first: libm::pow(n, 1.2), megabytes: None };
        let times = [10.0, 40.0, 160.0].map(|n| (n, time(n))).to_vec();
        let row = Row { words: "", times };
        assert!((row.exponent().unwrap() - 1.2).abs() < 1e-12);
        assert!(over_size(&[row]).contains("| 1.20 | – |"));
    }

    #[test]
    fn tables_of_the_leaderboard_are_sections() {
        let page = harmonic("a.ply, 12 vertices\n\n# harmonic\n\n| Fairing |\n");
        assert!(page.ends_with("12 vertices\n\n### harmonic\n\n| Fairing |\n"), "{page}");
    }

    #[test]
    fn a_task_without_words_is_an_error() {
        let results = serde_json::json!({"results": [{"task": "x", "mesh": "m", "rows": []}]});
        assert_eq!(compared(&results).unwrap_err().to_string(), "no words for the task x");
    }

    #[test]
    fn a_comparison_names_the_fastest_that_agrees() {
        let results = serde_json::json!({"cpu": "P", "when": "today", "note": "Alone.", "results": [{
        "task": "curvature", "mesh": "sphere_160k", "rows": [
            {"name": "ours", "ours": true, "min": 0.5, "cold_median": 3.0},
            {"name": "wrong", "min": 0.1, "cold_median": 0.1, "same": true, "agrees": "differs 1e-1"},
            {"name": "a", "min": 2.0, "cold_median": 2.0, "same": true, "agrees": "yes"},
            {"name": "b", "min": 1.0, "cold_median": 4.0, "same": true, "floor": false, "agrees": "yes"},
        ]}, {"task": "laplacian", "mesh": "rock_142k", "rows": [{"name": "ours", "ours": true}]}]});
        let page = compared(&results).unwrap();
        assert!(page.contains("| Task | sphere 160k | rock 142k |"), "{page}");
        assert!(page.contains("| H and K | 0.500 (0.50 b) | – |"), "{page}");
        assert!(page.contains("| H and K | 3.00 (**1.50** a) | – |"), "{page}");
        assert!(!page.contains("S and M"), "{page}");
        assert!(page.ends_with("\n\nAlone.\n"), "{page}");
    }
}
