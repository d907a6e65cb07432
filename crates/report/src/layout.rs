//! What of a section is seen at once, and what the folded rest is called.

use fairing_results::results::Record;

use crate::play;

/// The parts of a section that are seen at once, by id; all others are folded.
struct Seen {
    section: &'static str,
    /// Playgrounds (`play-…`), views and figures.
    figures: &'static [&'static str],
    tables: &'static [&'static str],
}

/// One picture to turn, one plot, and a table only where its rows decide.
const SEEN: [Seen; 11] = [
    Seen { section: "q1", figures: &["flower-view", "convergence"], tables: &[] },
    Seen { section: "q2", figures: &["play-ellipsoid"], tables: &["forms"] },
    Seen { section: "q3", figures: &["torus-view", "convergence"], tables: &[] },
    Seen { section: "noise", figures: &["play-noise", "changes"], tables: &[] },
    Seen { section: "estimators", figures: &["torus-view", "largest-mean"], tables: &[] },
    Seen { section: "q4", figures: &["modes-view", "decay"], tables: &[] },
    Seen { section: "q5", figures: &["play-diffusion", "sweep"], tables: &[] },
    Seen { section: "q6", figures: &["machine-part-view", "sweep"], tables: &[] },
    Seen { section: "flows", figures: &["methods-view"], tables: &["spheres"] },
    Seen { section: "q7", figures: &["levels-view", "normals"], tables: &[] },
    Seen { section: "denoisers", figures: &["play-denoising", "averages"], tables: &[] },
];

/// What folded figures and tables are called in the line that is seen of them.
const NAMES: [(&str, &[(&str, &str)]); 11] = [
    (
        "q1",
        &[
            ("plane-view", "the plane"),
            ("flower", "the flower in equalised colours"),
            ("plane", "the plane in equalised colours"),
            ("fields", "spread of the fields"),
            ("analytic", "errors under refinement"),
            ("orders", "orders of convergence"),
        ],
    ),
    (
        "q2",
        &[
            ("directions", "normal curvature in every direction"),
            ("meshes", "curvature of fine meshes at (a, 0, 0)"),
        ],
    ),
    (
        "q3",
        &[
            ("flower-view", "the flower"),
            ("plane-view", "the plane"),
            ("flower", "the flower in equalised colours"),
            ("plane", "the plane in equalised colours"),
            ("fields", "spread of the fields"),
            ("analytic", "errors under refinement"),
            ("orders", "orders of convergence"),
            ("planes", "what is left on planes"),
        ],
    ),
    (
        "noise",
        &[
            ("changes", "changes of H and K under noise"),
            ("totals", "the sum of all angle defects"),
        ],
    ),
    (
        "estimators",
        &[
            ("largest-gaussian", "the largest error of K"),
            ("errors", "errors under refinement"),
            ("orders", "orders of convergence"),
            ("times", "time of each estimator"),
        ],
    ),
    (
        "q4",
        &[
            ("eigenvalues", "eigenvalues under refinement"),
            ("small-creature-view", "the small creature from k modes"),
            ("large-creature-view", "the large creature from k modes"),
            ("bumpy-ball-view", "the bumpy ball from k modes"),
            ("small-creature-modes", "modes of the small creature"),
            ("reconstruction", "error over k"),
            ("weyl", "Weyl's law"),
            ("sphere", "eigenvalues of the sphere"),
            ("torus", "eigenvalues of the torus"),
        ],
    ),
    (
        "q5",
        &[
            ("patch-view", "the patch"),
            ("machine-part-view", "the machine part"),
            ("cube-view", "the cube"),
            ("flows", "scores of the four steps"),
            ("sweep", "errors over λ"),
            ("best", "the best λ of a block"),
            ("spectra", "the smallest eigenvalues and the stable limit"),
        ],
    ),
    (
        "q6",
        &[
            ("patch-view", "the patch"),
            ("cube-view", "the cube"),
            ("patch-iterations", "the patch at equal diffusion time"),
            ("machine-part-iterations", "the machine part at equal diffusion time"),
            ("flows", "scores of the six steps"),
            ("sweep", "errors over λ"),
            ("iterations", "numbers of steps and diffusion time"),
            ("limit", "collapse to a point"),
            ("spheres", "volume of spheres"),
            ("cost", "cost"),
        ],
    ),
    (
        "flows",
        &[
            ("radius", "the radius of a shrinking sphere"),
            ("conformal-view", "a bumpy sphere that becomes round"),
            ("methods", "scores of all methods"),
            ("conformal", "conformalised flow"),
            ("spheres", "mean curvature flow of the sphere"),
        ],
    ),
    (
        "q7",
        &[
            ("scan-view", "the creature"),
            ("distances", "distances over the noise"),
            ("model", "the machine part under the assignment's noise"),
            ("limits", "where each method helps"),
            ("resolution", "one block with faces of five sizes"),
            ("modes", "modes of the spectral method"),
            ("sweep", "three meshes under noise"),
        ],
    ),
    (
        "denoisers",
        &[
            ("block-view", "the block, to turn"),
            ("ratios", "all cases of the test bed"),
            ("block", "the block after every denoiser"),
            ("torus", "the torus after every denoiser"),
            ("creature", "the creature after every denoiser"),
            ("worst-development", "the worst case of the development set"),
            ("worst-unseen", "the worst case of the unseen set"),
            ("worst-fresh", "the worst case of the fresh set"),
            ("best", "the best denoiser on each mesh"),
            ("scores", "each denoiser on each mesh"),
            ("families", "the families of the test bed"),
            ("sets", "the sets of families"),
            ("lost", "the five worst cases of each set"),
        ],
    ),
];

fn seen(record: &Record) -> Option<&'static Seen> {
    let is_own = |seen: &&Seen| seen.section == record.id;
    let has = |id: &str| {
        record.views.iter().any(|v| v.id == id) || record.figures.iter().any(|f| f.id == id)
    };
    // Another experiment under this id, or parts of it, is shown as those that are not listed.
    SEEN.iter().find(is_own).filter(|seen| {
        seen.figures
            .iter()
            .all(|id| has(id) || play::for_section(&record.id).any(|play| play.id() == *id))
    })
}

/// Whether a figure, a view or a playground is seen at once. Of a section that is not listed those are its playgrounds,
/// its first view and its plots; its first figure where it has none of them.
pub(crate) fn shows_figure(record: &Record, id: &str) -> bool {
    match seen(record) {
        Some(seen) => seen.figures.contains(&id),
        None => {
            play::for_section(&record.id).any(|play| play.id() == id)
                || record.views.first().is_some_and(|view| view.id == id)
                || record.figures.iter().any(|f| f.id == id && f.svg.is_some())
                || record.views.is_empty() && record.figures.first().is_some_and(|f| f.id == id)
        }
    }
}

/// Whether a table is seen at once: the first of a section that is not listed.
pub(crate) fn shows_table(record: &Record, id: &str) -> bool {
    match seen(record) {
        Some(seen) => seen.tables.contains(&id),
        None => record.tables.first().is_some_and(|table| table.id == id),
    }
}

/// What a folded figure or table is called: its id, if it has no other name.
pub(crate) fn name(section: &str, id: &str) -> String {
    let own = NAMES.iter().filter(|(known, _)| *known == section).flat_map(|(_, names)| *names);
    let found = own.into_iter().find(|(known, _)| *known == id);
    found.map_or_else(|| id.replace('-', " "), |(_, name)| (*name).into())
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use fairing_results::results::Results;

    use super::*;
    use crate::story;

    #[test]
    fn every_section_of_the_article_is_laid_out() {
        for section in story::ACTS.iter().flat_map(story::Act::ids) {
            assert!(SEEN.iter().any(|seen| seen.section == section), "{section}");
        }
    }

    /// A line of a fold has words, not ids.
    #[test]
    fn what_the_committed_report_folds_has_a_name() {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/report/results.json");
        let results = Results::read(&path).unwrap();
        let named = |section: &str, id: &str| {
            let own = NAMES.iter().find(|(known, _)| *known == section);
            own.is_some_and(|(_, names)| names.iter().any(|(known, _)| *known == id))
        };
        for record in &results.experiments {
            let is_still = |id: &str| record.views.iter().any(|view| view.fallback == id);
            let figures = record.figures.iter().filter(|f| f.svg.is_some() || !is_still(&f.id));
            let figures = figures.map(|f| &f.id).chain(record.views.iter().map(|v| &v.id));
            for id in figures.filter(|id| !shows_figure(record, id)) {
                assert!(named(&record.id, id), "the figure {id} of {} has no name", record.id);
            }
            for table in record.tables.iter().filter(|table| !shows_table(record, &table.id)) {
                assert!(named(&record.id, &table.id), "the table {} of {}", table.id, record.id);
            }
        }
    }

    /// A section that is not listed shows its first view and its plots.
    #[test]
    fn other_sections_have_a_rule() {
        let mut record = Record { id: "other".into(), ..Record::default() };
        record.figures = ["plot", "picture"]
            .map(|id| fairing_results::results::FigureFile {
                id: id.into(),
                caption: String::new(),
                alt: String::new(),
                png: String::new(),
                svg: (id == "plot").then(|| "plot.svg".into()),
                small: None,
                links: vec![],
            })
            .to_vec();
        assert!(shows_figure(&record, "plot") && !shows_figure(&record, "picture"));
        record.figures.remove(0);
        assert!(shows_figure(&record, "picture"));
        assert_eq!(name("other", "far-away"), "far away");
    }
}
