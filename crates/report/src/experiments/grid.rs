//! Pictures of meshes in a grid with labelled rows, such as levels or meshes.

use anyhow::Result;
use fairing_figure::{
    Background, Camera, Colors, Figure, Panel, RenderOptions, Shading, Up, Viewpoint, render,
};
use fairing_mesh::TriMesh;

use super::gallery::{WIDTH, ZOOM, picture};
use crate::experiment::outcome::Picture;

/// Rows of plain meshes, all of the same length.
pub(super) struct Grid<'a> {
    /// The rows.
    pub(super) rows: Vec<Row<'a>>,
    /// The viewpoint of all pictures.
    pub(super) viewpoint: Viewpoint,
    /// The axis that points upward.
    pub(super) up: Up,
    /// Width over height of each picture.
    pub(super) aspect: f64,
}

/// Pictures with one camera.
pub(super) struct Row<'a> {
    /// The heading on its left; may be empty.
    pub(super) title: String,
    /// The mesh to which the camera is fitted; larger ones are cut off.
    pub(super) frame: &'a TriMesh,
    /// The meshes.
    pub(super) meshes: Vec<&'a TriMesh>,
    /// Text below each of them; above the columns if it is the same in
    /// all rows.
    pub(super) titles: Vec<String>,
}

impl Grid<'_> {
    /// Draws the grid, flat shaded, so that every face shows its normal.
    pub(super) fn draw(&self, id: &str, caption: &str, alt: &str) -> Result<Picture> {
        let columns = self.rows.iter().map(|row| row.meshes.len()).max().unwrap_or(1);
        let width = WIDTH / columns as f64;
        let options = RenderOptions {
            width: (ZOOM * width) as u32,
            height: (ZOOM * width / self.aspect) as u32,
            shading: Shading::Flat,
            background: Background::WHITE,
            ..RenderOptions::default()
        };
        let shared = self.rows.windows(2).all(|w| w[0].titles == w[1].titles);
        let headings = self.rows.first().filter(|_| shared).map(|row| row.titles.clone());
        let titled = self.rows.iter().any(|row| !row.title.is_empty());
        let mut figure = Figure {
            columns,
            column_titles: headings.unwrap_or_default(),
            row_titles: if titled {
                self.rows.iter().map(|row| row.title.clone()).collect()
            } else {
                vec![]
            },
            ..Figure::default()
        };
        for row in &self.rows {
            let camera = Camera::fit(&[row.frame], self.viewpoint, self.up, options.aspect())?;
            for (mesh, title) in row.meshes.iter().zip(&row.titles) {
                let image = render(mesh, Colors::CLAY, None, &camera, &options)?;
                let panel = Panel::image(image, width);
                figure.panels.push(if shared { panel } else { panel.caption(title.clone()) });
            }
        }
        picture(&figure, id, caption, alt)
    }
}
