//! `results.json`: all measurements, for programs.

use std::fs;
use std::path::Path;

use anyhow::{Context as _, Result};
use serde::{Deserialize, Serialize};

use crate::model::provenance::Provenance;
use crate::model::section::Section;
use crate::model::table::Table;
use crate::model::verdict::{Judgement, Verdict};

/// The contents of `results.json`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Results {
    /// The provenance of the numbers.
    pub provenance: Provenance,
    /// The extent of the report.
    #[serde(default)]
    pub form: Form,
    /// The experiments, in the order of the report.
    pub experiments: Vec<Record>,
}

/// The extent of a report.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Form {
    /// Everything; the page is one file.
    #[default]
    Whole,
    /// The part that is small enough to be committed and shown by a code host: no page, no meshes,
    /// smaller pictures.
    Small,
}

/// One experiment that has been run.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Record {
    /// The id of the experiment.
    pub id: String,
    /// The title.
    pub title: String,
    /// The question.
    pub question: String,
    /// The method. Paragraphs are separated by an empty line.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub method: String,
    /// The formulas behind the method, in TeX, without dollars.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub formulas: Vec<String>,
    /// Its place in the article and the words around it.
    #[serde(default)]
    pub section: Section,
    /// The error, if it failed and has no results.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub error: Option<String>,
    /// The sources of the meshes.
    pub inputs: Vec<Source>,
    /// The parameters.
    pub parameters: Vec<Parameter>,
    /// The tables.
    pub tables: Vec<Table>,
    /// The verdicts.
    pub claims: Vec<Judgement>,
    /// The figures.
    pub figures: Vec<FigureFile>,
    /// The other files: tables as CSV, meshes with fields as PLY.
    pub files: Vec<File>,
    /// Remarks for the reader.
    pub notes: Vec<String>,
    /// The interactive views of the page.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub views: Vec<ViewFile>,
    /// The run time, in seconds.
    pub seconds: f64,
}

/// The source of the mesh of an input.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Source {
    /// The role of the mesh.
    pub input: String,
    /// The file's name, without its folder.
    pub file: String,
    /// The digest of the file.
    pub sha256: String,
    /// True if a generated mesh replaces the assignment's.
    pub stand_in: bool,
    /// The replaced file of the assignment.
    pub stands_for: String,
}

/// A named parameter.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Parameter {
    /// The name.
    pub name: String,
    /// The value, as text.
    pub value: String,
}

/// A figure and its files, relative to the folder of the report.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FigureFile {
    /// Unique within the experiment.
    pub id: String,
    /// The caption.
    pub caption: String,
    /// The description for readers who cannot see the picture.
    pub alt: String,
    /// The PNG file.
    pub png: String,
    /// The SVG file, if there is one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub svg: Option<String>,
    /// The same picture in the size for a small report: until the form of the
    /// report is chosen, and for what a whole page prints in the place of a view.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub small: Option<String>,
    /// Links from points of a plot to views.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub links: Vec<PlotLink>,
}

/// A view that shows what the points of a plot stand for: the page moves its
/// sliders to a point that the reader points at.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct PlotLink {
    /// The title of the plot, or empty for any.
    pub plot: String,
    /// The name of the series, or empty for any; a slider that has this name
    /// as a stop goes there.
    pub series: String,
    /// The view (by id, within the experiment).
    pub view: String,
    /// The slider over the horizontal axis.
    pub slider: String,
}

/// An interactive view and the file with its data, relative to the folder of
/// the report.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ViewFile {
    /// Unique within the experiment.
    pub id: String,
    /// The caption.
    pub caption: String,
    /// The description for readers who cannot see the view.
    pub alt: String,
    /// The figure (by id) that takes its place where there is no WebGL.
    pub fallback: String,
    /// The file; empty in a small report.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub data: String,
    /// The mesh, if it has a name.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mesh: Option<MeshCard>,
}

/// A mesh in the list of meshes.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct MeshCard {
    /// Its name in all sections.
    pub name: String,
    /// Its vertices.
    pub vertices: usize,
    /// Its faces.
    pub faces: usize,
    /// A small picture: the path of a PNG file, relative to the folder of the
    /// report.
    pub picture: String,
}

/// Another file of the report.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct File {
    /// The path, relative to the folder of the report.
    pub path: String,
    /// The content.
    pub about: String,
    /// Its size.
    pub bytes: u64,
}

impl Record {
    /// The paths of all its files, relative to the folder of the report.
    pub fn paths(&self) -> impl Iterator<Item = &str> {
        let figures = self.figures.iter();
        let pictures = figures.flat_map(|f| [Some(&f.png), f.svg.as_ref(), f.small.as_ref()]);
        let views =
            self.views.iter().flat_map(|v| [Some(&v.data), v.mesh.as_ref().map(|m| &m.picture)]);
        let files = self.files.iter().map(|file| Some(&file.path));
        pictures
            .chain(views)
            .chain(files)
            .flatten()
            .map(String::as_str)
            .filter(|path| !path.is_empty())
    }

    /// The files that are not the CSV of a table.
    pub fn other_files(&self) -> impl Iterator<Item = &File> {
        let tables: Vec<String> =
            self.tables.iter().map(|t| format!("{}/{}.csv", self.id, t.id)).collect();
        self.files.iter().filter(move |file| !tables.contains(&file.path))
    }
}

impl Results {
    /// All judgements with their records: those on claims of the original report
    /// by id, then those on our own.
    pub fn claims(&self) -> Vec<(&Record, &Judgement)> {
        let of = |r| -> Vec<(&Record, &Judgement)> {
            let record: &Record = r;
            record.claims.iter().map(|c| (record, c)).collect()
        };
        let mut all: Vec<_> = self.experiments.iter().flat_map(of).collect();
        all.sort_by(|(_, a), (_, b)| (a.ours, &a.id).cmp(&(b.ours, &b.id)));
        all
    }

    /// The claims of the original report on which the verdict is this one.
    pub fn judged(&self, verdict: Verdict) -> Vec<&Judgement> {
        let claims = self.claims().into_iter().map(|(_, c)| c);
        claims.filter(|c| !c.ours && c.verdict == verdict).collect()
    }

    /// Reads a `results.json`; the rows that it leaves to the tables beside it, from there.
    pub fn read(path: &Path) -> Result<Self> {
        let text =
            fs::read_to_string(path).with_context(|| format!("reading {}", path.display()))?;
        let mut results: Self = serde_json::from_str(&text)
            .with_context(|| format!("{} is no results.json", path.display()))?;
        for record in &mut results.experiments {
            for table in &mut record.tables {
                let csv = path.with_file_name(&record.id).join(&table.id).with_extension("csv");
                if table.rows.is_empty() && csv.is_file() {
                    let rows = fs::read_to_string(&csv)?;
                    *table = std::mem::take(table).filled(&rows)?;
                }
            }
        }
        Ok(results)
    }
}
