//! Small pictures of the meshes, one for each name.

use std::collections::{BTreeMap, BTreeSet};

use crate::model::results::{MeshCard, Results};

/// The meshes by name, in the order of the report, each with the sections that show it.
pub(crate) fn all(results: &Results) -> Vec<(&MeshCard, Vec<&str>)> {
    let mut all: Vec<(&MeshCard, Vec<&str>)> = vec![];
    for record in crate::page::story::in_order(results) {
        for card in record.views.iter().filter_map(|view| view.mesh.as_ref()) {
            match all.iter_mut().find(|(known, _)| known.name == card.name) {
                Some((_, sections)) if sections.contains(&record.id.as_str()) => {}
                Some((_, sections)) => sections.push(&record.id),
                None => all.push((card, vec![&record.id])),
            }
        }
    }
    all
}

/// Adds the number of vertices, or of faces where that is the same, to the names of meshes that
/// share one: sizes of quick runs and meshes of the reader's own can give one part two meshes.
pub(crate) fn tell_apart(results: &mut Results) {
    let mut sizes: BTreeMap<String, BTreeSet<[usize; 2]>> = BTreeMap::new();
    for card in cards(results) {
        sizes.entry(card.name.clone()).or_default().insert([card.vertices, card.faces]);
    }
    for card in cards(results) {
        let Some(shared) = sizes.get(&card.name).filter(|sizes| sizes.len() > 1) else { continue };
        let alike = shared.iter().filter(|[vertices, _]| *vertices == card.vertices).count();
        card.name += &match alike {
            1 => format!(" of {} vertices", card.vertices),
            _ => format!(" of {} faces", card.faces),
        };
    }
}

fn cards(results: &mut Results) -> impl Iterator<Item = &mut MeshCard> {
    results.experiments.iter_mut().flat_map(|r| &mut r.views).filter_map(|v| v.mesh.as_mut())
}

#[cfg(test)]
mod tests {
    use crate::model::results::{Record, ViewFile};

    use super::*;

    /// A quick run has two machine parts; a name remains that of one mesh, and of all its views.
    #[test]
    fn meshes_that_share_a_name_are_told_apart() {
        let view = |name: &str, vertices, faces| {
            let (name, picture) = (name.into(), String::new());
            let mesh = Some(MeshCard { name, vertices, faces, picture });
            let [id, caption, alt, fallback, data] = [(); 5].map(|()| String::new());
            ViewFile { id, caption, alt, fallback, data, mesh }
        };
        let record = |views| Record { views, ..Record::default() };
        let experiments = vec![
            record(vec![view("torus", 8, 16), view("part", 7054, 14108), view("bump", 9, 14)]),
            record(vec![view("torus", 8, 16), view("part", 575, 1146), view("bump", 9, 12)]),
            record(vec![view("part", 575, 1146)]),
        ];
        let mut results =
            Results { provenance: Default::default(), form: Default::default(), experiments };
        tell_apart(&mut results);
        let names: Vec<&str> = cards(&mut results).map(|card| card.name.as_str()).collect();
        assert_eq!(
            names,
            [
                "torus",
                "part of 7054 vertices",
                "bump of 14 faces",
                "torus",
                "part of 575 vertices",
                "bump of 12 faces",
                "part of 575 vertices"
            ]
        );
    }
}
