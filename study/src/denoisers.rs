//! Measuring, tuning and training of denoisers.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

use anyhow::{Context as _, Result};
use fairing_mesh::TriMesh;
use fairing_mesh::io::{self, FloatWidth, VertexFields, WriteOptions};
use fairing_study::{
    Case, Found, MODELS, Method, Pair, Published, Set, Summary, TrainingOptions, cases,
    correlated_pairs, denoiser, fitted, found, is_pair, model, pairs, read, scans, sightings,
    summary, tables, train_normals, training_pairs, tuned, volumes, written,
};
use rayon::prelude::*;

use crate::cli::{Choice, Measure, Train, Tune};

/// The results of the published methods, from the root.
const PUBLISHED: &str = "study/results/published.csv";

/// The results of the automatic denoiser, from the root.
const AUTOMATIC: &str = "study/results/automatic.csv";

/// The folder of the tables that the report shows, from the root.
const TABLES: &str = "docs/reference/denoising";

/// The weights of the automatic denoiser, from the root: for all meshes, and for correlated noise.
const WEIGHTS: [&str; 2] =
    ["crates/denoising/data/normals.bin", "crates/denoising/data/normals-correlated.bin"];

/// The bits of their weights. Eight for both would make the page with the module for browsers a
/// quarter of a megabyte smaller. But on single cases of the benchmark the rounding would raise the
/// error by up to 17 %; with ten it is up to 5 %.
const BITS: [u32; 2] = [10, 8];

/// A path of the repository, whose place was known when this program was built.
fn in_repository(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(path)
}

/// The folder that `FAIRING_MESHES` names; an empty name is none.
fn meshes_folder() -> Option<PathBuf> {
    std::env::var_os("FAIRING_MESHES").filter(|name| !name.is_empty()).map(PathBuf::from)
}

/// Writes the tables of the report, from these results or from the stored ones.
pub(crate) fn write_tables(found: Option<Vec<Found>>) -> Result<()> {
    let published = Published::read(&fs::read_to_string(in_repository(PUBLISHED))?)?;
    let found = match found {
        Some(found) => found,
        None => read(&fs::read_to_string(in_repository(AUTOMATIC))?, &published)?,
    };
    let folder = in_repository(TABLES);
    fs::create_dir_all(&folder)?;
    for (name, text) in tables(&found, &published)? {
        fs::write(folder.join(name).with_extension("csv"), text)?;
    }
    Ok(())
}

/// Writes the models of the experiment.
pub(crate) fn models() -> Result<()> {
    for family in MODELS {
        let path = in_repository("data").join(format!("{family}.ply"));
        let options = WriteOptions::default().with_float_width(FloatWidth::Single);
        io::write_with_fields(&path, &model(family)?, &VertexFields::default(), &options)?;
        println!("{}", path.display());
    }
    Ok(())
}

/// Prints the set and the name of each case.
pub(crate) fn list(choice: &Choice) -> Result<()> {
    for case in choice.cases() {
        println!("{:<12} {}", case.set().to_string(), case.name());
    }
    Ok(())
}

/// Counts where the noise of a depth camera is found, or fits the test.
pub(crate) fn correlation(fit: bool) -> Result<()> {
    if fit {
        for weight in fitted(&sightings(Set::Development)?)? {
            println!("    {weight:.4},");
        }
        return Ok(());
    }
    let mut table: BTreeMap<String, [[usize; 2]; Set::ALL.len()]> = BTreeMap::new();
    for (k, set) in Set::ALL.into_iter().enumerate() {
        for seen in sightings(set)? {
            let [found, all] = &mut table.entry(seen.kind.clone()).or_default()[k];
            *found += usize::from(seen.is_found());
            *all += 1;
        }
    }
    println!("{:<24} {}", "found in", Set::ALL.map(|set| format!("{:>12}", set.name())).concat());
    for (kind, counts) in table {
        let counts = counts.map(|[found, all]| format!("{:>12}", format!("{found}/{all}")));
        println!("{kind:<24} {}", counts.concat());
    }
    Ok(())
}

/// Trains the networks and writes their weights.
pub(crate) fn train(options: &Train) -> Result<()> {
    let start = Instant::now();
    let path = options
        .out
        .clone()
        .unwrap_or_else(|| in_repository(WEIGHTS[usize::from(options.correlated)]));
    // Training takes long: a place that cannot be written is an error before it.
    io::check_writable(&path).with_context(|| format!("writing {}", path.display()))?;
    let pairs = if options.correlated {
        correlated_pairs(options.models)?
    } else {
        training_pairs(options.models)?
    };
    let faces: usize = pairs.iter().map(|p| p.truth.face_count()).sum();
    println!("{} pairs, {faces} faces, {:.0} s", pairs.len(), start.elapsed().as_secs_f64());
    let training = TrainingOptions {
        stages: options.stages,
        members: options.members,
        faces_per_pair: options.faces,
        epochs: options.epochs,
        bits: BITS[usize::from(options.correlated)],
        seed: options.seed,
    };
    let say = |line: String| println!("{:7.1} s  {line}", start.elapsed().as_secs_f64());
    let bytes = train_normals(&pairs, &training, say)?;
    fs::write(&path, bytes).with_context(|| format!("writing {}", path.display()))
}

/// Runs a denoiser on the chosen cases, prints how it compares, and keeps the results.
pub(crate) fn measure(options: Measure) -> Result<()> {
    let Measure { choice, denoiser, csv, accept, keep, meshes } = options;
    let csv = if accept { Some(in_repository(AUTOMATIC)) } else { csv };
    let table = Published::read(&fs::read_to_string(in_repository(PUBLISHED))?)?;
    let mut measurement = Measurement { table, name: denoiser, keep, found: vec![] };
    measurement.run(&choice, meshes)?;
    if let Some(csv) = csv {
        let mut all = measurement.found;
        // Only what everybody can make.
        all.retain(|(set, _)| !accept || set.is_some());
        let all: Vec<Found> = all.into_iter().map(|f| f.1).collect();
        fs::write(&csv, written(&all)).with_context(|| format!("{}", csv.display()))?;
        if accept {
            write_tables(Some(all))?;
        }
    }
    Ok(())
}

impl Choice {
    fn has(&self, name: &str) -> bool {
        self.filter.is_empty() || self.filter.iter().any(|f| name.contains(f.as_str()))
    }

    fn cases(&self) -> Vec<Case> {
        let mut all = match (self.scans, self.volumes) {
            (true, _) => scans(),
            (_, true) => volumes(),
            _ => cases(),
        };
        all.retain(|c| self.set.is_none_or(|s| c.set() == s) && self.has(&c.name()));
        all
    }

    /// The pairs of the literature, which belong to no set.
    fn pairs(&self, folder: Option<PathBuf>) -> Result<Vec<Pair>> {
        let Some(folder) = folder
            .or_else(meshes_folder)
            .filter(|_| self.set.is_none() && !self.scans && !self.volumes)
        else {
            return Ok(vec![]);
        };
        let (mut found, absent) = pairs(&folder)?;
        found.retain(|p| self.has(p.name));
        for name in absent.iter().filter(|n| self.has(n)) {
            println!("{name}: not in {}", folder.display());
        }
        Ok(found)
    }
}

/// The source of a noisy mesh and its truth.
enum Source {
    Case(Case),
    Pair(Box<Pair>),
}

impl Source {
    fn meshes(self) -> Result<(TriMesh, TriMesh)> {
        match self {
            Self::Case(case) => case.meshes(),
            Self::Pair(pair) => Ok((pair.truth, pair.noisy)),
        }
    }
}

/// Searches the best parameters of the published methods, and keeps what they reach.
pub(crate) fn tune(options: Tune) -> Result<()> {
    let Tune { choice, methods, meshes } = options;
    let path = &in_repository(PUBLISHED);
    let text = fs::read_to_string(path).with_context(|| format!("reading {}", path.display()))?;
    let mut table = Published::read(&text)?;
    // Cases that are no longer there.
    let known: Vec<String> = cases().iter().map(Case::name).collect();
    table.retain_cases(|c| known.iter().any(|k| k == c) || is_pair(c));
    let mut sources: Vec<(String, Source)> = choice
        .cases()
        .into_iter()
        .map(|c| (c.name(), Source::Case(c)))
        .chain(
            choice
                .pairs(meshes)?
                .into_iter()
                .map(|p| (p.name.to_string(), Source::Pair(Box::new(p)))),
        )
        .collect();
    let wanted = |m: &Method| methods.is_empty() || methods.iter().any(|n| n == m.denoiser.name());
    let missing: Vec<Vec<&Method>> = sources
        .iter()
        .map(|(name, _)| {
            let is_missing =
                |m: &&Method| wanted(m) && table.get(name, m.denoiser.name()).is_none();
            Method::ALL.iter().filter(is_missing).collect()
        })
        .collect();
    let total: usize = missing.iter().map(Vec::len).sum();
    println!("{total} searches");
    let state = Mutex::new((table, 0));
    // One case of each family after another, so that a part of the table has all of them.
    let mut jobs: Vec<_> = sources.drain(..).zip(missing).enumerate().collect();
    jobs.sort_by_key(|(k, _)| k % 7);
    jobs.into_par_iter().with_max_len(1).try_for_each(|(_, ((name, source), missing))| {
        if missing.is_empty() {
            return Ok(());
        }
        let (truth, noisy) = source.meshes()?;
        missing.into_iter().try_for_each(|method| {
            let entry = tuned(&name, method, &noisy, &truth)?;
            let mut state = state.lock().unwrap_or_else(PoisonError::into_inner);
            state.1 += 1;
            println!(
                "{}/{total} {name}, {}: {:.2}° to {:.2}° ({})",
                state.1, entry.method, entry.default, entry.tuned, entry.parameters
            );
            state.0.insert(entry);
            // Whole or not at all, so that a search that is interrupted can be resumed.
            let partial = path.with_extension("partial");
            fs::write(&partial, state.0.written())?;
            fs::rename(&partial, path).context("replacing the table")
        })
    })
}

/// A run over the cases.
struct Measurement {
    table: Published,
    name: String,
    keep: Option<PathBuf>,
    /// The set, none for the pairs of the literature.
    found: Vec<(Option<Set>, Found)>,
}

impl Measurement {
    fn run(&mut self, choice: &Choice, meshes: Option<PathBuf>) -> Result<()> {
        if let Some(folder) = &self.keep {
            fs::create_dir_all(folder)?;
        }
        println!(
            "{:<44} {:>6} {:>6} {:>6} {:>5}  {:<18} {:>5} {:>9} {:>9} {:>7} {:>6}",
            "case",
            "noisy",
            "E_a",
            "best",
            "ratio",
            "by",
            "E_v",
            "flips",
            "crossings",
            "volume",
            "time"
        );
        for case in choice.cases() {
            let (truth, noisy) = case.meshes()?;
            self.one(Some(case.set()), &case.name(), &truth, &noisy)?;
        }
        for pair in choice.pairs(meshes)? {
            self.one(None, pair.name, &pair.truth, &pair.noisy)?;
        }
        for set in Set::ALL.into_iter().map(Some).chain([None]) {
            let mine: Vec<Found> =
                self.found.iter().filter(|f| f.0 == set).map(|f| f.1.clone()).collect();
            if !mine.is_empty() {
                report(set.map_or("pairs", Set::name), &mine, &summary(&mine));
            }
        }
        Ok(())
    }

    fn one(
        &mut self,
        set: Option<Set>,
        name: &str,
        truth: &TriMesh,
        noisy: &TriMesh,
    ) -> Result<()> {
        let denoise = denoiser(&self.name)?;
        let run = |mesh: &TriMesh| denoise(mesh).with_context(|| format!("denoising {name}"));
        let (one, restored) = found(name, truth, noisy, &self.table, run)?;
        println!("{}", line(&one));
        if let Some(folder) = &self.keep {
            let base = name.replace(' ', "_");
            for (part, mesh) in [("truth", truth), ("noisy", noisy), ("denoised", &restored)] {
                io::write(folder.join(format!("{base}_{part}.ply")), mesh)?;
            }
        }
        self.found.push((set, one));
        Ok(())
    }
}

/// One line of the terminal for a case.
fn line(f: &Found) -> String {
    let (best, by) = f.best.as_ref().map_or((String::new(), ""), |b| (format!("{:.2}", b.0), &b.1));
    let ratio = f.ratio().map(|r| format!("{r:.2}")).unwrap_or_default();
    let volume = f.volume.map(|[_, v]| format!("{:+.2}%", 100.0 * v)).unwrap_or_default();
    let change = |[before, after]: [usize; 2]| format!("{before}→{after}");
    format!(
        "{:<44} {:>6.2} {:>6.2} {best:>6} {ratio:>5}  {by:<18} {:>5.2} {:>9} {:>9} {volume:>7} {:>5.2}s",
        f.case,
        f.noisy,
        f.angle,
        f.distance,
        change(f.flipped),
        change(f.intersections),
        f.seconds
    )
}

/// Prints the summary of a set.
fn report(title: &str, found: &[Found], s: &Summary) {
    let number = |x: Option<f64>| x.map_or("?".to_string(), |x| format!("{x:.3}"));
    println!("\n{title}: {} cases, {:.1} s", s.cases, s.seconds);
    println!(
        "  E_a over the best published, tuned: median {}, worst {}, above 1.1 in {} cases",
        number(s.median),
        number(s.worst),
        s.beyond_bar
    );
    println!(
        "  worse than a published method at its defaults: {}; than the noisy mesh in normals: {}, in positions: {}",
        s.worse_than_default, s.worse_normals, s.worse_positions
    );
    println!(
        "  flipped faces {} → {}, more than a tenth in {} cases; more self-intersections in {}; volume \
         {:.2} % from the truth at most, {:.2} % from the noisy mesh",
        s.flipped[0],
        s.flipped[1],
        s.too_many_flipped,
        s.more_intersections,
        100.0 * s.volume[0],
        100.0 * s.volume[1]
    );
    let mut worst: Vec<&Found> = found.iter().filter(|f| f.ratio().is_some()).collect();
    worst.sort_by(|a, b| b.ratio().unwrap_or(0.0).total_cmp(&a.ratio().unwrap_or(0.0)));
    for f in worst.into_iter().take(5) {
        println!("  worst: {}", line(f));
    }
}
