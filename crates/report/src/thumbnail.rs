//! Small pictures of the meshes, one for each name.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use anyhow::{Context as _, Result, ensure};
use fairing_figure::{Camera, Colors, RenderOptions, Up, Viewpoint, render};
use fairing_mesh::TriMesh;
use fairing_results::results::{MeshCard, Results};
use fairing_results::view::View;

/// Width and height in pixels: twice what the page shows.
const SIZE: [u32; 2] = [240, 180];

/// Draws the mesh of a view that names it: the first panel that does not move.
pub(crate) fn mesh_card(view: &View, path: &str, folder: &Path) -> Result<Option<MeshCard>> {
    let still = view.panels.iter().find(|panel| panel.positions.len() == 1);
    let Some(panel) = still.filter(|_| !view.mesh.is_empty()) else { return Ok(None) };
    let mesh = TriMesh::new(panel.positions[0].clone(), panel.faces.clone())?;
    let [width, height] = SIZE;
    let options = RenderOptions { width, height, ..RenderOptions::default() };
    let up = if view.z_up { Up::Z } else { Up::Y };
    let camera = Camera::fit(&[&mesh], Viewpoint::ThreeQuarter, up, options.aspect())?;
    let image = render(&mesh, Colors::CLAY, None, &camera, &options)?;
    let file = folder.join(path);
    fs::create_dir_all(file.parent().context("a picture without a folder")?)?;
    fs::write(&file, image.to_png()?).with_context(|| format!("writing {path}"))?;
    Ok(Some(MeshCard {
        name: view.mesh.clone(),
        vertices: mesh.vertex_count(),
        faces: mesh.face_count(),
        picture: path.into(),
    }))
}

/// The meshes by name, in the order of the report, each with the sections that show it.
pub(crate) fn all(results: &Results) -> Vec<(&MeshCard, Vec<&str>)> {
    let mut all: Vec<(&MeshCard, Vec<&str>)> = vec![];
    for record in crate::story::in_order(results) {
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

/// Makes sure that a name is that of one mesh.
///
/// # Errors
///
/// If two meshes of different sizes share a name.
pub(crate) fn check(results: &Results) -> Result<()> {
    let mut known: BTreeMap<&str, [usize; 2]> = BTreeMap::new();
    for card in results.experiments.iter().flat_map(|r| &r.views).filter_map(|v| v.mesh.as_ref()) {
        let size = [card.vertices, card.faces];
        let first = *known.entry(&card.name).or_insert(size);
        ensure!(
            first == size,
            "two meshes are called {}: one has {} vertices, one {}",
            card.name,
            first[0],
            size[0]
        );
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use fairing_results::results::{Record, ViewFile};

    use super::*;

    #[test]
    fn a_name_is_of_one_mesh() {
        let view = |vertices| {
            let (name, picture) = ("torus".into(), String::new());
            let mesh = Some(MeshCard { name, vertices, faces: 2 * vertices, picture });
            let [id, caption, alt, fallback, data] = [(); 5].map(|()| String::new());
            ViewFile { id, caption, alt, fallback, data, mesh }
        };
        let results = |second| {
            let views = vec![view(8), view(second)];
            let experiments = vec![Record { views, ..Record::default() }];
            Results { provenance: Default::default(), form: Default::default(), experiments }
        };
        assert!(check(&results(8)).is_ok());
        let error = check(&results(9)).unwrap_err().to_string();
        assert_eq!(error, "two meshes are called torus: one has 8 vertices, one 9");
    }
}
