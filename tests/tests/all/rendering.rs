//! The page and the Markdown, rendered again from the files of a report alone.

use std::path::Path;

use fairing_figure::{Camera, Colors, RenderOptions, Up, Viewpoint, render};
use fairing_report::experiment::outcome::{Outcome, Picture};
use fairing_report::experiment::{Card, Context, Experiment};
use fairing_report::experiments;
use fairing_report::model::results::{Form, Results};
use fairing_report::model::table::{Table, Tables, Unit};
use fairing_report::model::verdict::{Judgement, Verdict};
use fairing_report::model::view::{Panel, Slider, View};
use fairing_report::page::mathml;
use fairing_report::row;
use fairing_report::run::{Plan, reproduce};
use fairing_shapes as shapes;

/// A record with every kind of content that a report can show.
struct Shown;

impl Experiment for Shown {
    fn card(&self) -> Card {
        Card {
            id: "shown",
            title: "A sphere",
            question: "What is there to see?".into(),
            method: "By looking.\n\nAt `both` sides.".into(),
            formulas: vec![r"H = \frac{1}{r}".into()],
            section: fairing_report::model::section::Section::default(),
            inputs: &[],
            parameters: vec![("radius", "1".into())],
        }
    }

    fn run(&self, _: &Context<'_>) -> anyhow::Result<Outcome> {
        let mesh = shapes::icosphere(1);
        let camera = Camera::fit(&[&mesh], Viewpoint::ThreeQuarter, Up::Y, 4.0 / 3.0)?;
        let options = RenderOptions { width: 80, height: 60, ..RenderOptions::default() };
        let mut table = Table::new("radii", "The radius.", &[("r", Unit::Length)]);
        table.push(row![1.0]);
        let values: Vec<f64> = mesh.positions().iter().map(|p| p[0]).collect();
        let half: Vec<[f64; 3]> = mesh.positions().iter().map(|p| p.map(|x| 0.5 * x)).collect();
        let panel = Panel::moving("sphere", &mesh, [mesh.positions(), &half])
            .with_field("x", "m", true, &values)
            .with_live_smoothing();
        Ok(Outcome {
            tables: vec![table],
            figures: vec![Picture {
                id: "sphere".into(),
                caption: "A sphere.".into(),
                alt: "A ball.".into(),
                image: render(&mesh, Colors::CLAY, None, &camera, &options)?,
                svg: None,
                links: vec![],
            }],
            views: vec![View {
                id: "turning".into(),
                caption: "The sphere, to turn.".into(),
                alt: "A ball.".into(),
                fallback: "sphere".into(),
                z_up: false,
                sliders: vec![Slider::new("size", [1.0, 0.5])],
                panels: vec![panel],
                ..View::default()
            }],
            notes: vec!["A note.".into()],
            ..Outcome::default()
        })
    }

    fn judge(&self, tables: Tables<'_>) -> anyhow::Result<Vec<Judgement>> {
        let radius = tables.get("radii")?.column("r")?[0];
        let claim = Judgement::new("0a", "It is round.", Verdict::Confirmed, "It is.");
        Ok(vec![claim.number("radius", radius, Unit::Length)])
    }
}

fn report(out: &Path, form: Form) -> Results {
    let plan = Plan {
        root: Path::new(env!("CARGO_MANIFEST_DIR")).join(".."),
        only: vec![],
        meshes: None,
        out: out.to_path_buf(),
        cache: out.with_extension("cache"),
        quick: true,
        fresh: true,
        form,
    };
    reproduce(&[&Shown], &plan).unwrap()
}

/// The pages of a report of this form.
fn pages(form: Form) -> &'static [&'static str] {
    if form == Form::Whole { &["report.html", "report.md"] } else { &["report.md"] }
}

/// All content of the pages comes from the folder of the report.
#[test]
fn a_report_is_made_again_from_its_files() {
    let folder = tempfile::tempdir().unwrap();
    for form in [Form::Whole, Form::Small] {
        let out = folder.path().join(format!("{form:?}"));
        let results = report(&out, form);
        assert_eq!(results.experiments[0].error, None);
        assert_eq!(Results::read(&out.join("results.json")).unwrap(), results);
        let read = |folder: &Path| -> Vec<String> {
            let text = |name: &&str| std::fs::read_to_string(folder.join(name)).unwrap();
            pages(form).iter().map(text).collect()
        };
        let before = read(&out);
        for name in pages(form) {
            std::fs::remove_file(out.join(name)).unwrap();
        }
        let elsewhere = folder.path().join(format!("{form:?} moved"));
        std::fs::rename(&out, &elsewhere).unwrap();
        fairing_report::page::render(&elsewhere).unwrap();
        let again = read(&elsewhere);
        assert!(before == again, "{form:?}");
        assert!(again.iter().all(|text| text.contains("By looking.")));
        assert!(again.last().is_some_and(|markdown| markdown.contains(r"\frac{1}{r}")));
        assert_eq!(again[0].contains("<mfrac>"), form == Form::Whole);
        assert_eq!(again[0].contains("At <code>both</code> sides."), form == Form::Whole);
    }
}

/// Temporary files are gone once the report is written.
#[test]
fn a_report_holds_what_it_names() {
    let folder = tempfile::tempdir().unwrap();
    for form in [Form::Whole, Form::Small] {
        let out = folder.path().join(format!("{form:?}"));
        report(&out, form);
        let mut names: Vec<String> = std::fs::read_dir(out.join("shown"))
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        // The page of a whole report has views, and a small picture in place of each one in print.
        let expected: &[&str] = match form {
            Form::Whole => &["radii.csv", "sphere-small.png", "sphere.png", "turning.view.json"],
            Form::Small => &["radii.csv", "sphere.png"],
        };
        assert_eq!(names, expected, "{form:?}");
    }
}

/// Reference values are results without prose or pages.
#[test]
fn numbers_alone_are_no_report() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("report");
    let results = report(&out, Form::Whole);
    fairing_report::run::reference::accept(folder.path(), &results).unwrap();
    let bare = fairing_report::run::reference::path(folder.path(), true);
    std::fs::copy(bare, out.join("results.json")).unwrap();
    let page = std::fs::read(out.join("report.html")).unwrap();
    let error = fairing_report::page::render(&out).unwrap_err().to_string();
    assert!(error.contains("how shown was answered"), "{error}");
    assert_eq!(std::fs::read(out.join("report.html")).unwrap(), page);
}

/// A page that cannot be rendered leaves the earlier one unchanged.
#[test]
fn a_view_without_data_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("report");
    report(&out, Form::Whole);
    let page = std::fs::read(out.join("report.html")).unwrap();
    for contents in [None, Some("{}\n")] {
        let data = out.join("shown/turning.view.json");
        match contents {
            None => std::fs::remove_file(&data).unwrap(),
            Some(text) => std::fs::write(&data, text).unwrap(),
        }
        let error = format!("{:#}", fairing_report::page::render(&out).unwrap_err());
        assert!(error.contains("shown/turning.view.json"), "{error}");
        assert_eq!(std::fs::read(out.join("report.html")).unwrap(), page);
    }
}

/// The text that TeX shows, with commands replaced by their symbols.
fn written(tex: &str) -> String {
    let mut text = String::new();
    let mut rest = tex;
    while let Some(at) = rest.find('\\') {
        text += &rest[..at];
        let command = &rest[at + 1..];
        let letters = command.find(|c: char| !c.is_ascii_alphabetic()).unwrap_or(command.len());
        let (name, after) = command.split_at(letters.max(1));
        rest = after;
        text += match name {
            "Delta" => "Δ",
            "alpha" => "α",
            "beta" => "β",
            "delta" => "δ",
            "kappa" => "κ",
            "lambda" => "λ",
            "mu" => "μ",
            "omega" => "ω",
            "partial" => "∂",
            "pi" => "π",
            "theta" => "θ",
            "varepsilon" => "ε",
            "varphi" => "φ",
            "sum" => "∑",
            "in" => "∈",
            "sim" => "∼",
            "ge" => "≥",
            "le" => "≤",
            "top" => "⊤",
            "arccos" | "cos" | "cot" | "log" | "sin" => name,
            "frac" | "tfrac" | "sqrt" | "hat" | "text" | "cdot" => "",
            "big" | "Big" | "left" | "right" | "quad" | "qquad" | "," | "|" => "",
            other => panic!("what does {other} show?"),
        };
    }
    text + rest
}

/// The text of a `<math>` element.
fn shown(mathml: &str) -> String {
    let outside = mathml.split('<').filter_map(|part| part.split_once('>'));
    let text: String = outside.map(|(_, text)| text).collect();
    text.replace("&lt;", "<").replace("&nbsp;", " ")
}

/// Letters, digits, and the signs that are written as themselves in every formula, sorted. Minus
/// and spaces have several forms.
fn symbols(text: &str) -> Vec<char> {
    let kept = |c: &char| c.is_alphanumeric() || "∑∈≤≥∂<=+(),".contains(*c);
    let mut symbols: Vec<char> = text.chars().filter(kept).collect();
    symbols.sort_unstable();
    symbols
}

/// Every formula is converted completely: no command is unknown, and each number and letter of the
/// TeX occurs in the MathML as often as in the source.
#[test]
fn formulas_lose_nothing() {
    let cards = experiments::ALL.iter().map(|e| e.card());
    let formulas: Vec<String> = cards.flat_map(|card| card.formulas).collect();
    assert!(formulas.len() >= 9, "{formulas:?}");
    for tex in formulas {
        let mathml = mathml::displayed(&tex).unwrap();
        assert_eq!(symbols(&shown(&mathml)), symbols(&written(&tex)), "{tex}\n{mathml}");
    }
    assert!(mathml::displayed(r"\frac{1}{\unknowncommand}").is_err());
    assert!(mathml::displayed(r"\frac{1}{2").is_err());
}
