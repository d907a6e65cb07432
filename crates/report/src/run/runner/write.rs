//! Writes what an experiment returned.

use std::fs;
use std::path::Path;

use anyhow::{Context as _, Result};
use fairing_figure::{Camera, Colors, RenderOptions, Up, Viewpoint, render};
use fairing_mesh::TriMesh;
use fairing_mesh::io::{self, FloatWidth, VertexFields, WriteOptions};
use rayon::prelude::*;

use crate::experiment::outcome::{Attachment, Content, MeshOutput, Outcome};
use crate::model::results::{FigureFile, File, MeshCard, Record, ViewFile};
use crate::model::view::View;

/// Pictures of a small report have at most this width, in pixels: about what a code host shows.
const SMALL: u32 = 690;

/// Width and height in pixels of small pictures of meshes: twice what the page shows.
const THUMBNAIL: [u32; 2] = [240, 180];

/// Writes tables, figures and meshes into `work/id`, and enters them into the
/// record with paths relative to `work`.
pub(super) fn outcome(outcome: Outcome, work: &Path, record: &mut Record) -> Result<()> {
    let id = record.id.clone();
    fs::create_dir_all(work.join(&id))?;
    let keep = |name: String, bytes: &[u8], about: &str| -> Result<File> {
        let path = format!("{id}/{name}");
        fs::write(work.join(&path), bytes).with_context(|| format!("writing {path}"))?;
        Ok(File { path, about: about.into(), bytes: bytes.len() as u64 })
    };
    for table in &outcome.tables {
        let csv = table.to_csv()?;
        record.files.push(keep(format!("{}.csv", table.id), csv.as_bytes(), &table.caption)?);
    }
    let encoded: Vec<[Vec<u8>; 2]> = outcome
        .figures
        .par_iter()
        .map(|p| Ok([p.image.to_palette_png(None)?, p.image.to_palette_png(Some(SMALL))?]))
        .collect::<Result<_>>()?;
    for (picture, [png, small]) in outcome.figures.into_iter().zip(encoded) {
        let png = keep(format!("{}.png", picture.id), &png, &picture.caption)?.path;
        let small = keep(format!("{}-small.png", picture.id), &small, &picture.caption)?.path;
        let svg = picture.svg.map(|svg| {
            anyhow::Ok(keep(format!("{}.svg", picture.id), svg.as_bytes(), &picture.caption)?.path)
        });
        record.figures.push(FigureFile {
            id: picture.id,
            caption: picture.caption,
            alt: picture.alt,
            png,
            svg: svg.transpose()?,
            small: Some(small),
            links: picture.links,
        });
    }
    for output in outcome.meshes {
        record.files.push(mesh(output, work, &id)?);
    }
    for attachment in outcome.attachments {
        record.files.push(attached(attachment, work, &id)?);
    }
    record.tables = outcome.tables;
    record.notes = outcome.notes;
    let view = |view: &View| view_file(view, work, &id);
    record.views = outcome.views.par_iter().map(view).collect::<Result<_>>()?;
    Ok(())
}

/// Writes a view, and the picture of its mesh.
fn view_file(view: &View, work: &Path, id: &str) -> Result<ViewFile> {
    let data = format!("{id}/{}.view.json", view.id);
    fs::write(work.join(&data), view.to_json()?).with_context(|| format!("writing {data}"))?;
    Ok(ViewFile {
        id: view.id.clone(),
        caption: view.caption.clone(),
        alt: view.alt.clone(),
        fallback: view.fallback.clone(),
        data,
        mesh: mesh_card(view, &format!("{id}/{}-mesh.png", view.id), work)?,
    })
}

/// Draws the mesh of a view that names it: the first panel that does not move.
fn mesh_card(view: &View, path: &str, work: &Path) -> Result<Option<MeshCard>> {
    let still = view.panels.iter().find(|panel| panel.positions.len() == 1);
    let Some(panel) = still.filter(|_| !view.mesh.is_empty()) else { return Ok(None) };
    let mesh = TriMesh::new(panel.positions[0].clone(), panel.faces.clone())?;
    let [width, height] = THUMBNAIL;
    let options = RenderOptions { width, height, ..RenderOptions::default() };
    let up = if view.z_up { Up::Z } else { Up::Y };
    let camera = Camera::fit(&[&mesh], Viewpoint::ThreeQuarter, up, options.aspect())?;
    let image = render(&mesh, Colors::CLAY, None, &camera, &options)?;
    fs::write(work.join(path), image.to_png()?).with_context(|| format!("writing {path}"))?;
    Ok(Some(MeshCard {
        name: view.mesh.clone(),
        vertices: mesh.vertex_count(),
        faces: mesh.face_count(),
        picture: path.into(),
    }))
}

/// Writes a mesh and its fields.
fn mesh(output: MeshOutput, work: &Path, id: &str) -> Result<File> {
    let fields = output.fields.into_iter();
    let fields =
        fields.fold(VertexFields::default(), |f, (name, values)| f.with_scalar(name, values));
    let path = format!("{id}/{}.ply", output.id);
    let options = WriteOptions::default().with_float_width(FloatWidth::Single);
    io::write_with_fields(work.join(&path), &output.mesh, &fields, &options)
        .with_context(|| format!("writing {path}"))?;
    let bytes = fs::metadata(work.join(&path))?.len();
    Ok(File { path, about: output.caption, bytes })
}

/// Writes a file that is neither table, picture nor view.
fn attached(attachment: Attachment, work: &Path, id: &str) -> Result<File> {
    let path = format!("{id}/{}", attachment.name);
    match &attachment.content {
        Content::Text(content) => text(&work.join(&path), content)?,
        Content::Mesh(mesh) => {
            io::write(work.join(&path), mesh).with_context(|| format!("writing {path}"))?;
        }
    }
    let bytes = fs::metadata(work.join(&path))?.len();
    Ok(File { path, about: attachment.about, bytes })
}

/// Writes a text file.
fn text(path: &Path, text: &str) -> Result<()> {
    fs::write(path, text).with_context(|| format!("writing {}", path.display()))
}
