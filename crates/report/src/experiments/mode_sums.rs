//! A mesh whose modes the page sums itself.

use anyhow::{Result, ensure};
use fairing_operators::Laplacian;
use fairing_shapes as shapes;
use fairing_spectral::{SpectrumOptions, spectrum};
use ndarray::ArrayView2;

use crate::experiment::Context;
use crate::experiment::text::{Text, values};
use crate::model::view::{Modes, Panel, View};

/// The words of question 4.
pub(super) static TEXT: Text = Text::new("q4", include_str!("../../text/q4.md"));

/// The view on the page.
pub(super) const VIEW: &str = "modes-view";

/// Its modes: enough for limbs, and few enough for a page.
const COUNT: [usize; 2] = [80, 24];

/// The creature with its smoothest modes, of which the page sums as many as the reader likes.
pub(super) fn view(context: &Context<'_>) -> Result<View> {
    let mesh = shapes::creature(48);
    let count = context.choose(COUNT[0], COUNT[1]);
    let laplacian = Laplacian::cotangent(&mesh)?;
    let modes = spectrum(&laplacian, count, &SpectrumOptions::default())?;
    ensure!(modes.len() == count, "{} modes of {count}", modes.len());
    let c = modes.transform(ArrayView2::from(mesh.positions()))?;
    let coefficients = (0..count).map(|i| [0, 1, 2].map(|d| c[[i, d]])).collect();
    let vectors = (0..count).map(|i| modes.modes.column(i).to_vec()).collect();
    let summed = Modes { values: modes.values.clone(), coefficients, vectors };
    Ok(View {
        id: VIEW.into(),
        mesh: "creature".into(),
        caption: TEXT.say("view modes", values! { count, all: mesh.vertex_count() })?,
        alt: TEXT.say("view modes alt", &[])?,
        fallback: "decay".into(),
        z_up: false,
        sliders: vec![],
        panels: vec![
            Panel::still("k modes", &mesh).with_modes(summed),
            Panel::still("original", &mesh),
        ],
        from: Some(1),
        truth: Some(mesh.positions().to_vec()),
        ..View::default()
    })
}
