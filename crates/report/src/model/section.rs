//! The place of an experiment in the article, and the words around its results.

use serde::{Deserialize, Serialize};

/// A part of the article.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Act {
    /// Estimates of curvature.
    Curvature,
    /// Eigenvectors of the Laplacian.
    Spectrum,
    /// Flows and denoisers.
    Diffusion,
}

/// The section of an experiment in the article.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Section {
    /// The part of the article; sections follow one another in the order of the experiments.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub act: Option<Act>,
    /// A sentence or two that lead to the section.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub bridge: String,
    /// Command lines of the program that do what the section does; a remark follows `#`.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub commands: Vec<String>,
    /// The mesh whose mean edge length is h; empty where h is not used.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub edge_lengths_of: String,
    /// The symbols of the section, in TeX: those of its formulas, and matrices that its words name.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub notation: Vec<String>,
    /// Views and figures that are not folded, by id.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub figures: Vec<String>,
    /// Tables that are not folded, by id.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub tables: Vec<String>,
    /// Short names of the folded views, figures and tables, by id.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub names: Vec<(String, String)>,
    /// Its sources, by their keys in the bibliography.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub sources: Vec<String>,
    /// The playground of the section, which is always seen.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub playground: Option<Playground>,
}

/// A part of a section that the page computes by itself.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Playground {
    /// The name of its script.
    pub kind: String,
    /// The caption.
    pub caption: String,
    /// A description for readers who cannot see it.
    pub alt: String,
}

fn owned(texts: &[&str]) -> Vec<String> {
    texts.iter().map(|&text| text.into()).collect()
}

impl Section {
    /// A section of an act, after its bridge.
    pub fn new(act: Act, bridge: &str) -> Self {
        Self { act: Some(act), bridge: bridge.into(), ..Self::default() }
    }

    /// The section with these command lines.
    #[must_use]
    pub fn commands(self, commands: &[&str]) -> Self {
        Self { commands: owned(commands), ..self }
    }

    /// The section whose h is the mean edge length of this mesh.
    #[must_use]
    pub fn edge_lengths_of(self, mesh: &str) -> Self {
        Self { edge_lengths_of: mesh.into(), ..self }
    }

    /// The section with these symbols, in TeX.
    #[must_use]
    pub fn notation(self, symbols: &[&str]) -> Self {
        Self { notation: owned(symbols), ..self }
    }

    /// The section that shows these views, figures and tables at once.
    #[must_use]
    pub fn shows(self, figures: &[&str], tables: &[&str]) -> Self {
        Self { figures: owned(figures), tables: owned(tables), ..self }
    }

    /// The section with short names for what is folded, by id.
    #[must_use]
    pub fn names(self, names: &[(&str, &str)]) -> Self {
        let names = names.iter().map(|&(id, name)| (id.into(), name.into())).collect();
        Self { names, ..self }
    }

    /// The section with these sources, by their keys in the bibliography.
    #[must_use]
    pub fn sources(self, keys: &[&str]) -> Self {
        Self { sources: owned(keys), ..self }
    }

    /// The section with a playground.
    #[must_use]
    pub fn playground(self, kind: &str, caption: &str, alt: &str) -> Self {
        let [kind, caption, alt] = [kind, caption, alt].map(String::from);
        Self { playground: Some(Playground { kind, caption, alt }), ..self }
    }
}

impl Playground {
    /// Its id on the page.
    pub fn id(&self) -> String {
        format!("play-{}", self.kind)
    }
}
