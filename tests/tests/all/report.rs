//! The report: its schema, its reuse of finished experiments, its failures.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};

use fairing_mesh::TriMesh;
use fairing_report::experiment::outcome::Outcome;
use fairing_report::experiment::{Card, Context, Experiment};
use fairing_report::experiments;
use fairing_report::model::compare::differences;
use fairing_report::model::results::{Form, Results};
use fairing_report::model::table::{Table, Tables, Unit};
use fairing_report::model::verdict::{Judgement, Verdict};
use fairing_report::model::view::{Panel, View};
use fairing_report::row;
use fairing_report::run::{Plan, reproduce};
use fairing_shapes as shapes;
use serde_json::Value;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// A plan with its own folders for the report and for finished experiments.
fn plan(out: &Path, only: &[&str]) -> Plan {
    Plan {
        cache: out.with_extension("cache"),
        root: root(),
        only: only.iter().map(|s| (*s).to_string()).collect(),
        meshes: None,
        out: out.to_path_buf(),
        quick: true,
        fresh: true,
        form: Form::Whole,
    }
}

fn text<'a>(value: &'a Value, key: &str) -> &'a str {
    value[key].as_str().unwrap_or_else(|| panic!("{key} of {value}"))
}

/// `results.json` has the published schema, and every file it names exists.
#[test]
fn results_follow_the_schema() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("report");
    reproduce(experiments::ALL, &plan(&out, &["q2"])).unwrap();
    let json: Value =
        serde_json::from_str(&std::fs::read_to_string(out.join("results.json")).unwrap()).unwrap();

    let provenance = &json["provenance"];
    for key in ["commit", "compiler", "processor", "date", "system"] {
        assert!(!text(provenance, key).is_empty(), "{key}");
    }
    assert!(provenance["dirty"].is_boolean() && provenance["seed"].is_u64());

    let experiments = json["experiments"].as_array().unwrap();
    assert_eq!(experiments.len(), 1);
    for e in experiments {
        assert_eq!(text(e, "id"), "q2");
        assert!(!text(e, "title").is_empty());
        assert!(e["inputs"].is_array());
        for table in e["tables"].as_array().unwrap() {
            let columns = table["columns"].as_array().unwrap();
            assert!(columns.iter().all(|c| c["name"].is_string() && c["unit"].is_string()));
            let rows = table["rows"].as_array().unwrap();
            assert!(!rows.is_empty());
            assert!(rows.iter().all(|r| r.as_array().unwrap().len() == columns.len()));
            let csv = out.join(format!("q2/{}.csv", text(table, "id")));
            assert_eq!(std::fs::read_to_string(csv).unwrap().lines().count(), rows.len() + 1);
        }
        let claims = e["claims"].as_array().unwrap();
        assert_eq!(text(&claims[0], "id"), "2a");
        assert!(
            ["confirmed", "refuted", "qualified", "undecided"]
                .contains(&text(&claims[0], "verdict"))
        );
        assert!(claims[0]["numbers"].as_array().unwrap().iter().all(|n| n["value"].is_number()));
        for figure in e["figures"].as_array().unwrap() {
            assert!(out.join(text(figure, "png")).is_file(), "{figure}");
        }
        for file in e["files"].as_array().unwrap() {
            assert!(out.join(text(file, "path")).is_file(), "{file}");
        }
    }
    for name in ["report.md", "report.html"] {
        assert!(std::fs::read_to_string(out.join(name)).unwrap().contains("ellipsoid"), "{name}");
    }
}

/// A small report, as committed, has the same numbers, narrower pictures, no meshes and no page.
#[test]
fn a_small_report_says_the_same() {
    let folder = tempfile::tempdir().unwrap();
    let [whole, small] = [Form::Whole, Form::Small].map(|form| {
        let out = folder.path().join(format!("{form:?}"));
        let plan = Plan { form, ..plan(&out, &["q1"]) };
        (reproduce(experiments::ALL, &plan).unwrap(), out)
    });
    assert!(differences(&whole.0, &small.0, false).is_empty());
    let meshes =
        |r: &Results| r.experiments[0].files.iter().filter(|f| f.path.ends_with(".ply")).count();
    assert!(meshes(&whole.0) > 0 && meshes(&small.0) == 0);
    for figure in &small.0.experiments[0].figures {
        let file = std::fs::File::open(small.1.join(&figure.png)).unwrap();
        let picture = png::Decoder::new(std::io::BufReader::new(file)).read_info().unwrap();
        assert!(picture.info().width <= 960, "{}", figure.png);
    }
    assert!(!small.1.join("report.html").exists());
    let text = std::fs::read_to_string(small.1.join("report.md")).unwrap();
    for figure in &small.0.experiments[0].figures {
        assert!(text.contains(&figure.png), "{}", figure.id);
    }
}

/// Two runs agree to the last digit, and reading back loses nothing.
#[test]
fn a_second_run_returns_the_same() {
    let folder = tempfile::tempdir().unwrap();
    let [first, second] = ["a", "b"].map(|name| {
        let out = folder.path().join(name);
        let results = reproduce(experiments::ALL, &plan(&out, &["q2"])).unwrap();
        assert_eq!(
            Results::read(&out.join("results.json")).unwrap().experiments[0].tables,
            results.experiments[0].tables
        );
        results
    });
    assert_eq!(first.experiments[0].tables, second.experiments[0].tables);
    assert!(differences(&first, &second, false).is_empty());
}

/// An experiment for these tests: fails, panics, cannot decide, or succeeds.
struct Sample(&'static str);

impl Experiment for Sample {
    fn card(&self) -> Card {
        Card {
            id: self.0,
            title: "A sample",
            question: "Does it run?".into(),
            method: "By running.".into(),
            formulas: vec![],
            section: fairing_report::model::section::Section::default(),
            inputs: &[],
            parameters: vec![],
        }
    }

    fn run(&self, context: &Context<'_>) -> anyhow::Result<Outcome> {
        match self.0 {
            "fails" => anyhow::bail!("vertex 7 is missing"),
            "panics" => panic!("broken promise"),
            _ => {}
        }
        let mut table = Table::new("draws", "Random numbers.", &[("seed", Unit::One)]);
        table.push(row![(context.seed("draw") >> 12) as f64]);
        Ok(Outcome { tables: vec![table], ..Outcome::default() })
    }

    fn judge(&self, tables: Tables<'_>) -> anyhow::Result<Vec<Judgement>> {
        let drawn = tables.get("draws")?.column("seed")?[0];
        let verdict = if self.0 == "wavers" { Verdict::Undecided } else { Verdict::Confirmed };
        Ok(vec![Judgement::new("0a", "It draws.", verdict, "It does.").number(
            "seed",
            drawn,
            Unit::One,
        )])
    }
}

#[test]
fn a_failing_experiment_is_reported_and_the_others_run() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("report");
    let all: [&dyn Experiment; 3] = [&Sample("fails"), &Sample("panics"), &Sample("works")];
    let results = reproduce(&all, &plan(&out, &[])).unwrap();
    let errors: Vec<_> = results.experiments.iter().map(|r| r.error.as_deref()).collect();
    assert!(errors[0].unwrap().contains("vertex 7 is missing"));
    assert!(errors[1].unwrap().contains("broken promise"));
    assert_eq!(errors[2], None);
    assert_eq!(results.experiments[2].claims.len(), 1);
    let report = std::fs::read_to_string(out.join("report.md")).unwrap();
    assert!(report.contains("vertex 7 is missing") && report.contains("It draws."));
}

/// Claims that the numbers do not decide are called undecided, in both reports and in
/// `results.json`.
#[test]
fn an_undecided_claim_is_shown_as_such() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("report");
    let results = reproduce(&[&Sample("wavers")], &plan(&out, &[])).unwrap();
    assert_eq!(results.judged(Verdict::Undecided).len(), 1);
    assert_eq!(
        Results::read(&out.join("results.json")).unwrap().judged(Verdict::Undecided).len(),
        1
    );
    let [report, page] =
        ["report.md", "report.html"].map(|name| std::fs::read_to_string(out.join(name)).unwrap());
    assert!(report.contains("0a, undecided:** It draws.") && report.contains("**undecided**"));
    assert!(page.contains("<span class=\"verdict undecided\">undecided</span>"));
    assert!(page.contains(".verdict.undecided {"));
}

#[test]
fn a_folder_that_holds_something_else_is_left_alone() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("precious.txt"), "mine").unwrap();
    let all: [&dyn Experiment; 1] = [&Sample("works")];
    let error = reproduce(&all, &plan(folder.path(), &[])).unwrap_err();
    assert!(error.to_string().contains("something other than a report"), "{error}");
    assert_eq!(std::fs::read_to_string(folder.path().join("precious.txt")).unwrap(), "mine");
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
}

/// An experiment that counts its runs and reads the clock, so a second run would show.
struct Counted(AtomicUsize);

impl Experiment for Counted {
    fn card(&self) -> Card {
        Card { id: "counted", ..Sample("works").card() }
    }

    fn run(&self, _: &Context<'_>) -> anyhow::Result<Outcome> {
        let run = self.0.fetch_add(1, Ordering::Relaxed);
        let mut table = Table::new("runs", "How often it has run.", &[("run", Unit::Count)]);
        table.push(row![run]);
        let notes = vec!["A note.".into()];
        Ok(Outcome { tables: vec![table], notes, ..Outcome::default() })
    }
}

#[test]
fn finished_experiments_are_reused_until_asked_for_afresh() {
    let folder = tempfile::tempdir().unwrap();
    let counted = Counted(AtomicUsize::new(0));
    let run = |fresh: bool, quick: bool| {
        let plan = Plan { fresh, quick, ..plan(&folder.path().join("report"), &[]) };
        let record = reproduce(&[&counted], &plan).unwrap().experiments.remove(0);
        assert_eq!(record.notes, ["A note."]);
        assert!(plan.out.join("counted/runs.csv").is_file());
        record.tables[0].column("run").unwrap()[0]
    };
    assert_eq!(run(false, true), 0.0);
    assert_eq!(run(false, true), 0.0, "reused");
    assert_eq!(run(false, false), 1.0, "quick results are no full ones");
    assert_eq!(run(false, true), 0.0, "both are kept");
    assert_eq!(run(true, true), 2.0, "forgotten");
    assert_eq!(run(false, true), 2.0, "and kept again");
}

/// An experiment that shows a mesh called a part, with another size in each instance.
struct Shown(&'static str, TriMesh);

impl Experiment for Shown {
    fn card(&self) -> Card {
        Card { id: self.0, ..Sample("works").card() }
    }

    fn run(&self, _: &Context<'_>) -> anyhow::Result<Outcome> {
        let panels = vec![Panel::still("input", &self.1)];
        let view = View { id: "part-view".into(), mesh: "part".into(), panels, ..View::default() };
        Ok(Outcome { views: vec![view], ..Outcome::default() })
    }
}

/// Sizes of quick runs differ between experiments, as those of `--meshes` can.
#[test]
fn meshes_that_share_a_name_are_both_in_the_report() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("report");
    let [fine, coarse] = [2, 1].map(shapes::icosphere);
    let results = reproduce(&[&Shown("a", fine), &Shown("b", coarse)], &plan(&out, &[])).unwrap();
    assert!(results.experiments.iter().all(|r| r.error.is_none()));
    for name in ["report.md", "report.html"] {
        let page = std::fs::read_to_string(out.join(name)).unwrap();
        for mesh in ["part of 162 vertices", "part of 42 vertices"] {
            assert!(page.contains(mesh), "{name}: {mesh}");
        }
    }
}

/// The forms of the command, one after another, into one folder and over one folder of kept
/// experiments: ten seconds, because each form reads what those before have left. Whole runs, with
/// every experiment, are a step of `cargo xtask ci`.
#[test]
fn every_form_runs_to_its_end() {
    let folder = tempfile::tempdir().unwrap();
    let place = |name: &str| folder.path().join(name);
    for name in ["none", "half"] {
        std::fs::create_dir(place(name)).unwrap();
        std::fs::write(place(name).join("readme.txt"), "no mesh").unwrap();
    }
    std::fs::write(place("half").join("fandisk.off"), "without the noisy one").unwrap();
    let out = place("report");
    let all = |only: &[&str]| Plan { fresh: false, ..plan(&out, only) };
    let ended = |plan: &Plan| {
        let results = reproduce(experiments::ALL, plan).unwrap();
        for record in &results.experiments {
            assert_eq!(record.error, None, "{}", record.id);
            assert!(record.paths().all(|path| plan.out.join(path).is_file()), "{}", record.id);
        }
        let read = Results::read(&plan.out.join("results.json")).unwrap();
        assert!(differences(&read, &results, false).is_empty());
        let page = std::fs::read(plan.out.join("report.md")).unwrap();
        fairing_report::page::render(&plan.out).unwrap();
        assert_eq!(page, std::fs::read(plan.out.join("report.md")).unwrap());
        results
    };
    let first = ended(&all(&["q2"]));
    assert_eq!(ended(&all(&["q2"])).experiments, first.experiments, "kept");
    assert_eq!(ended(&all(&["q1", "q2"])).experiments.len(), 2);
    assert_eq!(ended(&Plan { quick: false, ..all(&["q2"]) }).experiments[0].id, "q2");
    assert_eq!(
        ended(&Plan { fresh: true, ..all(&["q2"]) }).experiments[0].tables,
        first.experiments[0].tables
    );
    ended(&Plan { form: Form::Small, ..all(&["q1"]) });
    let deep = Plan { out: place("new/folder"), ..all(&["q2"]) };
    ended(&deep);
    for meshes in ["none", "half"].map(place) {
        let run = ended(&Plan { meshes: Some(meshes), ..all(&["q1", "q5"]) });
        assert!(run.experiments.iter().flat_map(|r| &r.inputs).all(|source| source.stand_in));
    }
    let absent = Plan { meshes: Some(place("absent")), ..all(&["q2"]) };
    assert!(reproduce(experiments::ALL, &absent).unwrap_err().to_string().contains("absent"));
    // A kept experiment that has lost a file runs again.
    let lost = all(&["q1"]).cache.join("q1-quick/files");
    let view = std::fs::read_dir(&lost).unwrap().map(|entry| entry.unwrap().path());
    let is_view = |path: &std::path::PathBuf| path.to_string_lossy().ends_with(".view.json");
    std::fs::remove_file(view.into_iter().find(is_view).unwrap()).unwrap();
    ended(&all(&["q1"]));
}

/// A link to the folder of a report stays a link, and its target gets the new report.
#[cfg(unix)]
#[test]
fn a_link_to_a_report_stays() {
    let folder = tempfile::tempdir().unwrap();
    let [real, link] = ["real", "link"].map(|name| folder.path().join(name));
    reproduce(&[&Sample("first")], &plan(&real, &[])).unwrap();
    std::os::unix::fs::symlink(&real, &link).unwrap();
    reproduce(&[&Sample("second")], &plan(&link, &[])).unwrap();
    assert!(link.is_symlink() && real.join("second").is_dir() && !real.join("first").exists());
}

/// The earlier report is replaced as a whole, and no other folder remains beside it.
#[test]
fn an_earlier_report_is_replaced() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("report");
    reproduce(&[&Sample("first")], &plan(&out, &[])).unwrap();
    reproduce(&[&Sample("second")], &plan(&out, &[])).unwrap();
    assert!(!out.join("first").exists() && out.join("second").is_dir());
    let names: Vec<_> =
        std::fs::read_dir(folder.path()).unwrap().map(|e| e.unwrap().file_name()).collect();
    assert!(names.iter().all(|n| n == "report" || n == "report.cache"), "{names:?}");
}

/// Folders of runs that were killed long ago are removed; one that may still be written stays.
#[test]
fn what_killed_runs_left_is_removed() {
    let folder = tempfile::tempdir().unwrap();
    let [old, new] = [".report-old", ".report-new"].map(|name| folder.path().join(name));
    for place in [&old, &new] {
        std::fs::create_dir(place).unwrap();
        std::fs::write(place.join("results.json"), "{}").unwrap();
    }
    let day = std::time::Duration::from_secs(24 * 3600);
    let before = std::time::SystemTime::now() - day;
    std::fs::File::open(&old).unwrap().set_modified(before).unwrap();
    reproduce(&[&Sample("works")], &plan(&folder.path().join("report"), &[])).unwrap();
    assert!(!old.exists() && new.exists());
}

#[test]
fn an_unknown_experiment_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let error = reproduce(experiments::ALL, &plan(folder.path(), &["q99"])).unwrap_err();
    assert!(error.to_string().contains("q99"), "{error}");
}
