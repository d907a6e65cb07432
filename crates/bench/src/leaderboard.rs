//! The leaderboard of `sparse-solver-benchmark` for this machine: every system by our factor, and
//! by CHOLMOD and Eigen where a compiler finds them.

use std::fs::{self, File};
use std::io::{BufWriter, Write as _};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use anyhow::{Context as _, Result, ensure};
use fairing_mesh::{TriMesh, io};
use serde_json::Value;

use crate::fresh::Fresh;
use crate::harmonic::{Equations, SYSTEMS, Stored};
use crate::page::machine;
use crate::task::Stopwatch;

/// The source of the other solvers' program.
const SOURCE: &str = include_str!("../peers/direct.cpp");

/// The methods of that program, with their names in the table. CHOLMOD tries METIS itself where the
/// fill of AMD is large.
const PEERS: [(&str, &str); 4] = [
    ("cholmod", "CHOLMOD, its own choice"),
    ("cholmod-amd", "CHOLMOD, AMD"),
    ("cholmod-metis", "CHOLMOD, METIS"),
    ("eigen-ldlt", "Eigen::SimplicialLDLT"),
];

/// Seconds after which a solver is stopped.
const LIMIT: u64 = 60;

/// A row of the table: seconds and the error, or the reason for their absence.
type Row = (String, Result<[f64; 3]>);

/// Measures all systems on a mesh and prints a table for each.
pub(crate) fn run(input: &Path, repeat: usize) -> Result<()> {
    let mesh = io::read(input)?.mesh;
    let folder = std::env::temp_dir().join(format!("fairing-leaderboard-{}", std::process::id()));
    fs::create_dir_all(&folder)?;
    let done = tables(input, &mesh, &folder, repeat);
    fs::remove_dir_all(&folder)?;
    done
}

fn tables(input: &Path, mesh: &TriMesh, folder: &Path, repeat: usize) -> Result<()> {
    let peers = compiled(folder);
    if let Err(reason) = &peers {
        println!("CHOLMOD and Eigen are left out: {reason:#}\n");
    }
    let name = input.file_name().unwrap_or_default().display();
    println!("{name}, {} vertices, {}", mesh.vertex_count(), machine());
    let mut versions = None;
    for (k, (name, system)) in SYSTEMS.into_iter().enumerate() {
        let ours = || ours(input, k + 1);
        let mut rows = vec![("Fairing".to_owned(), best(repeat, ours))];
        if let Ok(program) = &peers {
            let equations = Equations::new(mesh, system, &mut Stopwatch::default())?.stored()?;
            let path = folder.join("system");
            write(&equations, &path)?;
            for (method, words) in PEERS {
                let found =
                    best(repeat, || peer(program, method, &path, &equations, &mut versions));
                rows.push((words.to_owned(), found));
            }
        }
        print(name, rows);
    }
    if let Some(versions) = versions {
        println!("\n{versions}");
    }
    Ok(())
}

/// The run with the least time.
fn best(repeat: usize, mut run: impl FnMut() -> Result<[f64; 3]>) -> Result<[f64; 3]> {
    let mut best = run()?;
    for _ in 1..repeat {
        let next = run()?;
        if next[0] + next[1] < best[0] + best[1] {
            best = next;
        }
    }
    Ok(best)
}

/// A table in the form of the benchmark's README, the fastest first.
fn print(name: &str, mut rows: Vec<Row>) {
    let time =
        |row: &Row| row.1.as_ref().map_or(f64::INFINITY, |[factor, solve, _]| factor + solve);
    rows.sort_by(|a, b| time(a).total_cmp(&time(b)));
    println!("\n# {name}\n");
    println!(
        "| {:>30} | {:>11} | {:>11} | {:>14} |",
        "Method", "Factor", "Solve", "Backward error"
    );
    println!("|{:->31}:|{:->12}:|{:->12}:|{:->15}:|", "", "", "", "");
    for (method, found) in rows {
        match found {
            Ok([factor, solve, error]) => {
                println!(
                    "| {method:>30} | {factor:>6.2} secs | {solve:>6.2} secs | {error:>14.1e} |"
                );
            }
            Err(reason) => println!("| {method:>30} | {:>11} | {:>11} | {reason:>14} |", "–", "–"),
        }
    }
}

/// Our own time, in a process of its own.
fn ours(input: &Path, k: usize) -> Result<[f64; 3]> {
    let result = Fresh::new("harmonic", input, &[&format!("--k={k}")]).result()?;
    let number = |value: &Value| value.as_f64().context("the process printed no number");
    let run = &result["runs"][0];
    Ok([number(&run["factor"])?, number(&run["solve"])?, number(&result["fingerprint"]["error"])?])
}

/// Compiles the program of the other solvers.
fn compiled(folder: &Path) -> Result<PathBuf> {
    let (source, program) = (folder.join("direct.cpp"), folder.join("direct"));
    fs::write(&source, SOURCE)?;
    let mut compiler = Command::new(std::env::var_os("CXX").unwrap_or_else(|| "c++".into()));
    compiler.args(["-O3", "-march=native", "-DNDEBUG", "-I/usr/include/eigen3"]);
    compiler.args(["-I/usr/include/suitesparse", "-o"]).arg(&program).arg(&source);
    let output = compiler.args(["-lcholmod", "-lopenblas"]).output();
    let output = output.context("there is no compiler of C++ (CXX, or c++)")?;
    let text = String::from_utf8_lossy(&output.stderr);
    let line = text.lines().find(|line| line.contains("error")).unwrap_or("no reason").to_owned();
    ensure!(output.status.success(), "the compiler says: {line}");
    Ok(program)
}

/// Writes the matrix and the right-hand sides as the program reads them.
fn write(equations: &Stored, path: &Path) -> Result<()> {
    let matrix = &equations.matrix;
    let mut file = BufWriter::new(File::create(path)?);
    file.write_all(&(matrix.rows() as u64).to_ne_bytes())?;
    file.write_all(&(matrix.nnz() as u64).to_ne_bytes())?;
    for start in matrix.indptr().raw_storage() {
        file.write_all(&start.to_ne_bytes())?;
    }
    for row in matrix.indices() {
        file.write_all(&row.to_ne_bytes())?;
    }
    for value in matrix.data() {
        file.write_all(&value.to_ne_bytes())?;
    }
    for k in 0..3 {
        for b in &equations.right {
            file.write_all(&b[k].to_ne_bytes())?;
        }
    }
    file.flush()?;
    Ok(())
}

/// One solution by another solver; its error is computed here.
fn peer(
    program: &Path,
    method: &str,
    path: &Path,
    equations: &Stored,
    versions: &mut Option<String>,
) -> Result<[f64; 3]> {
    let mut command = Command::new(program);
    command.arg(method).arg(path).stdout(Stdio::piped()).stderr(Stdio::piped());
    let (start, mut process) = (Instant::now(), command.spawn()?);
    while process.try_wait()?.is_none() {
        if start.elapsed() > Duration::from_secs(LIMIT) {
            process.kill()?;
            process.wait()?;
            anyhow::bail!("over {LIMIT} secs");
        }
        std::thread::sleep(Duration::from_millis(50));
    }
    let output = process.wait_with_output()?;
    ensure!(output.status.success(), "{}", last_line(&output.stderr));
    let printed: Value = serde_json::from_str(&last_line(&output.stdout))?;
    let of = |key: &str| printed[key].as_str().unwrap_or_default().to_owned();
    versions.get_or_insert_with(|| {
        format!("Eigen {}, CHOLMOD {}, BLAS: {}", of("eigen"), of("cholmod"), of("blas"))
    });
    let bytes = fs::read(path.with_extension("out"))?;
    let numbers: Vec<f64> =
        bytes.as_chunks().0.iter().map(|bytes| f64::from_ne_bytes(*bytes)).collect();
    let n = equations.right.len();
    ensure!(numbers.len() == 3 * n, "no solution of the right length");
    let x: Vec<[f64; 3]> = (0..n).map(|i| [0, 1, 2].map(|k| numbers[k * n + i])).collect();
    let seconds = |key: &str| printed[key].as_f64().context("no time was printed");
    Ok([seconds("factor")?, seconds("solve")?, equations.rest(&x).1])
}

fn last_line(bytes: &[u8]) -> String {
    let text = String::from_utf8_lossy(bytes);
    text.lines().last().unwrap_or("it ended without a word").to_owned()
}
