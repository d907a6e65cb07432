//! Small pictures of the meshes, one for each name.

use std::fs;
use std::path::Path;

use anyhow::{Context as _, Result};
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
