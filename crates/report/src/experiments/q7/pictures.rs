//! The pictures, plots and views of question 7.

use std::collections::BTreeMap;

use anyhow::Result;
use fairing_denoising::{
    AutomaticOptions, Denoiser, GuidedNormalOptions, TotalGeneralisedVariationOptions,
};
use fairing_evaluation::{NoiseLevel, drift, feature_edges, normal_error};
use fairing_figure::{Axis, Figure, Panel as FigurePanel, Plot, Series, Shape, Up, Viewpoint};
use fairing_mesh::TriMesh;
use rayon::prelude::*;

use super::methods::{ASSIGNMENT, KEPT, TEXT};
use crate::experiment::Context;
use crate::experiment::outcome::Picture;
use crate::experiment::text::values;
use crate::experiments::gallery::{VIEWPOINTS, plotted};
use crate::experiments::grid::{Grid, Row};
use crate::experiments::models::{CREASES, FEATURE};
use crate::experiments::over_lambda::{EXPLICIT, IMPLICIT};
use crate::experiments::restoring::{Body, Method, Trials};
use crate::experiments::seen;
use crate::model::table::{Cell, Table};
use crate::model::view::{Panel, Slider, View};

/// The columns of the pictures: the input of the others, the steps of the original report, and the
/// best of the other filters and denoisers at most levels.
const SHOWN: [Method; 6] = [
    Method::Nothing,
    Method::ReportExplicit,
    Method::ReportImplicit,
    Method::Spectral,
    Method::Denoiser(Denoiser::GuidedNormal(GuidedNormalOptions::DEFAULT)),
    Method::Denoiser(Denoiser::Automatic(AutomaticOptions::DEFAULT)),
];

/// Results that the sweeps have computed, of the noise that the pictures show.
#[derive(Default)]
pub(super) struct Restored(Vec<(NoiseLevel, Method, TriMesh)>);

impl Restored {
    /// Keeps the results at a level of the methods that are shown.
    pub(super) fn keep(&mut self, level: NoiseLevel, trials: Vec<Trials>) {
        let shown = trials.into_iter().filter(|t| SHOWN.contains(&t.method));
        self.0.extend(shown.map(|t| (level, t.method, t.first)));
    }

    /// The result of a method, if it was run at that level.
    fn find(&self, level: NoiseLevel, method: Method) -> Option<&TriMesh> {
        let found = self.0.iter().find(|(known, own, _)| *known == level && *own == method);
        found.map(|(_, _, mesh)| mesh)
    }
}

/// The lines of the plots: as many as there are colours. The first two have those of the
/// playgrounds.
const CURVES: [Method; 7] = [
    Method::Implicit,
    Method::Explicit,
    Method::Taubin,
    Method::Spectral,
    Method::Denoiser(Denoiser::GuidedNormal(GuidedNormalOptions::DEFAULT)),
    Method::Denoiser(Denoiser::TotalGeneralisedVariation(
        TotalGeneralisedVariationOptions::DEFAULT,
    )),
    Method::Denoiser(Denoiser::Automatic(AutomaticOptions::DEFAULT)),
];

const _: () = assert!(
    matches!(CURVES[IMPLICIT], Method::Implicit) && matches!(CURVES[EXPLICIT], Method::Explicit),
    "a method has one style in all plots"
);

/// The levels of the scan's view, in h, and whether they are drawn too: levels of the sweep, whose
/// results are shown.
const SCAN_LEVELS: [(f64, bool); 4] = [(0.1, true), (0.3, true), (0.7, true), (1.4, false)];

/// The noisy part and the results of the methods, a row for each level of the assignment.
pub(super) fn levels(
    context: &Context<'_>,
    part: &Body,
    known: &Restored,
) -> Result<(Picture, View)> {
    let levels = ASSIGNMENT.map(|sigma| Level {
        name: sigma.to_string(),
        noise: NoiseLevel::Model(sigma),
        drawn: true,
    });
    let restored = Rows::new(context, part, known, &levels, (VIEWPOINTS[0], Up::Z))?;
    Ok((restored.draw("levels")?, restored.view("levels")?))
}

/// The same of the scan, levels in h.
pub(super) fn scan(
    context: &Context<'_>,
    scan: &Body,
    known: &Restored,
) -> Result<(Picture, View)> {
    let levels = SCAN_LEVELS.map(|(sigma, drawn)| Level {
        name: format!("{sigma} h"),
        noise: NoiseLevel::EdgeLengths(sigma),
        drawn,
    });
    let viewpoint = Viewpoint::Angles { azimuth: 30.0, elevation: 10.0 };
    let restored = Rows::new(context, scan, known, &levels, (viewpoint, Up::Y))?;
    Ok((restored.draw("scan")?, restored.view("scan")?))
}

/// A sentence that says which of the bodies are of kinds that training saw; empty if none is.
fn trained(bodies: &[&Body]) -> Result<String> {
    let names = bodies.iter().filter(|body| body.is_trained_on);
    let names: Vec<String> = names.map(|body| format!("the {}", body.name)).collect();
    let like = match names.len() {
        0 => return Ok(String::new()),
        n if n == bodies.len() => TEXT.say("like these", &[])?,
        _ => TEXT.say("like some", values! { names: seen::list(&names) })?,
    };
    TEXT.say("trained", values! { like })
}

/// A level of noise.
struct Level {
    name: String,
    noise: NoiseLevel,
    /// True for a row of the picture.
    drawn: bool,
}

/// A model under each level of noise, after each method.
struct Rows<'a> {
    body: &'a Body,
    levels: &'a [Level],
    /// In the order of the levels, each in the order of [`SHOWN`].
    meshes: Vec<Vec<TriMesh>>,
    viewpoint: Viewpoint,
    up: Up,
}

impl<'a> Rows<'a> {
    fn new(
        context: &Context<'_>,
        body: &'a Body,
        known: &Restored,
        levels: &'a [Level],
        (viewpoint, up): (Viewpoint, Up),
    ) -> Result<Self> {
        let restore = |level: &Level| -> Result<Vec<TriMesh>> {
            let noisy = body.noisy(level.noise, context.seed("noise"))?;
            let one = |&method: &Method| match known.find(level.noise, method) {
                Some(mesh) => Ok(mesh.clone()),
                None => body.restore(method, &noisy),
            };
            SHOWN.par_iter().map(one).collect()
        };
        let meshes = levels.iter().map(restore).collect::<Result<_>>()?;
        Ok(Self { body, levels, meshes, viewpoint, up })
    }

    fn draw(&self, id: &str) -> Result<Picture> {
        let (name, trained) = (self.body.name, trained(&[self.body])?);
        let values = values! { seen: self.to_see()?, name, trained };
        let caption = TEXT.say(&format!("figure {id}"), values)?;
        let alt = TEXT.say(&format!("figure {id} alt"), values)?;
        let drawn = self.levels.iter().zip(&self.meshes).filter(|(level, _)| level.drawn);
        let rows = drawn.map(|(level, meshes)| Row {
            title: format!("σ = {}", level.name),
            frame: &self.body.truth,
            meshes: meshes.iter().collect(),
            titles: SHOWN.map(|m| m.name().into()).to_vec(),
        });
        Grid { rows: rows.collect(), viewpoint: self.viewpoint, up: self.up, aspect: 1.0 }
            .draw(id, &caption, &alt)
    }

    /// The effect visible in the picture: the errors of all results in the first and the last row.
    fn to_see(&self) -> Result<String> {
        let mut rows = vec![];
        for (level, meshes) in self.levels.iter().zip(&self.meshes).filter(|(l, _)| l.drawn) {
            let errors = meshes[1..].iter();
            let errors = errors.map(|mesh| Ok(normal_error(mesh, &self.body.truth)?.mean));
            rows.push((level.name.clone(), errors.collect::<Result<_>>()?));
        }
        let names: Vec<&str> = SHOWN[1..].iter().map(|m| m.name()).collect();
        seen::over_levels(&rows, &names)
    }

    /// The noisy model, the result of a method, and the truth, with sliders for the noise and the
    /// method.
    fn view(&self, figure: &str) -> Result<View> {
        let name = self.body.name;
        let trained = trained(&[self.body])?;
        let viewed = || SHOWN.iter().enumerate().skip(1);
        let (mut noisy, mut results) = (vec![], vec![]);
        for meshes in &self.meshes {
            for (i, _) in viewed() {
                noisy.push(&meshes[0]);
                results.push(&meshes[i]);
            }
        }
        let truth = &self.body.truth;
        let noisy_panel =
            Panel::moving(SHOWN[0].name(), truth, noisy.iter().map(|m| m.positions()));
        let result_panel = Panel::moving("result", truth, results.iter().map(|m| m.positions()));
        Ok(View {
            id: format!("{figure}-view"),
            mesh: name.into(),
            caption: TEXT.say(&format!("view {figure}"), values! { name, trained })?,
            alt: TEXT.say("view alt", values! { name })?,
            fallback: figure.into(),
            color: None,
            z_up: self.up == Up::Z,
            sliders: vec![
                Slider::new("σ", self.levels.iter().map(|level| &level.name)),
                Slider::new("method", viewed().map(|(_, method)| method.name())),
            ],
            start: vec![1, viewed().count() - 2],
            panels: vec![
                self.with_facts(noisy_panel, &noisy)?,
                self.with_facts(result_panel, &results)?,
                Panel::still("truth", &self.body.truth),
            ],
            from: Some(0),
            truth: Some(self.body.truth.positions().to_vec()),
        })
    }

    /// A panel with the errors of what it shows at each of its stops.
    fn with_facts(&self, panel: Panel, meshes: &[&TriMesh]) -> Result<Panel> {
        let truth = &self.body.truth;
        let of = |mesh: &&TriMesh| -> Result<[Option<f64>; 3]> {
            let creases = feature_edges(mesh, truth, FEATURE)?.f_score();
            Ok([
                Some(normal_error(mesh, truth)?.mean),
                drift(mesh, truth).volume.map(|v| 100.0 * v),
                creases.map(|score| 100.0 * score),
            ])
        };
        let facts: Vec<_> = meshes.par_iter().map(of).collect::<Result<_>>()?;
        let named = [("normal error", "°"), ("volume", "%"), (CREASES, "%")];
        Ok(named.into_iter().enumerate().fold(panel, |panel, (k, (name, unit))| {
            panel.with_fact(name, unit, facts.iter().map(|fact| fact[k]).collect())
        }))
    }
}

/// Errors over the noise, a figure for each error with a plot for each mesh of the sweep and for
/// the machine part.
pub(super) fn curves(sweep: &Table, model: &Table, bodies: &[&Body]) -> Result<Vec<Picture>> {
    let trained = trained(bodies)?;
    let errors = [
        ("normals", "normal error", "normal error in degrees"),
        ("distances", "vertex error", "vertex error in h"),
    ];
    let drawn = errors.into_iter().map(|(id, column, label)| {
        let caption = TEXT.say(&format!("figure {id}"), values! { trained: trained.as_str() })?;
        curve([sweep, model], id, column, label, &caption)
    });
    drawn.collect()
}

/// The error in one column.
fn curve(
    tables: [&Table; 2],
    id: &str,
    column: &str,
    label: &str,
    caption: &str,
) -> Result<Picture> {
    let mut figure = Figure { columns: 2, ..Figure::default() };
    let mut meshes = vec![];
    for table in tables {
        meshes.extend(table.labels("mesh")?.into_iter().map(|mesh| (table, mesh)));
    }
    for (table, mesh) in &meshes {
        let mut plot = Plot {
            title: mesh.clone(),
            x: Axis::log("noise σ/h"),
            y: Axis::log(label),
            ..Plot::default()
        };
        let rows = table.only(&[("mesh", mesh.as_str().into())])?;
        let best = best_somewhere(&rows, column)?;
        // A method has one colour in all plots.
        for (style, method) in CURVES.into_iter().enumerate() {
            let rows = rows.only(&[("method", method.name().into())])?;
            let (x, y) = (rows.column("σ/h")?, rows.column(column)?);
            let line =
                Series::marked(method.name(), x.iter().zip(&y).map(|(x, y)| [*x, *y]).collect());
            if !best.iter().any(|name| name == method.name()) {
                plot.series.push(line.quiet());
                continue;
            }
            let spread = rows.index(&format!("± {column}"))?;
            let deviations = rows.rows.iter().map(|r| Cell::number(&r[spread]).unwrap_or(0.0));
            let band = x.iter().zip(&y).zip(deviations);
            let band = band.map(|((x, y), d)| [*x, (y - d).max(0.5 * y), y + d]).collect();
            plot.series.push(Series::band(band, style));
            plot.series.push(Series { style: Some(style), ..line });
        }
        let input = rows.only(&[("method", Method::Nothing.name().into())])?;
        let points = input.column("σ/h")?.into_iter().zip(input.column(column)?);
        let points = points.map(|(x, y)| [x, y]).collect();
        plot.series.push(Series::reference(Method::Nothing.name(), points));
        if column == "normal error" {
            plot.series.push(Series::new(&TEXT.say("kept below", &[])?, Shape::Level(KEPT)));
        }
        figure.panels.push(FigurePanel::drawing(plot.draw(450.0, 180.0)?));
    }
    let picture = plotted(&figure, id, caption, &TEXT.say("figure errors alt", &[])?)?;
    // The last mesh of the sweep is that of the view.
    Ok(match tables[0].labels("mesh")?.last() {
        Some(last) => picture.linked(last, "", "scan-view", "σ"),
        None => picture,
    })
}

/// The methods of the plot that have the least error at some level.
fn best_somewhere(rows: &Table, column: &str) -> Result<Vec<String>> {
    let mut best: BTreeMap<String, (f64, String)> = BTreeMap::new();
    for method in CURVES {
        let own = rows.only(&[("method", method.name().into())])?;
        for (level, error) in own.column("σ/h")?.into_iter().zip(own.column(column)?) {
            let entry = best.entry(level.to_string()).or_insert((f64::INFINITY, String::new()));
            if error < entry.0 {
                *entry = (error, method.name().into());
            }
        }
    }
    Ok(best.into_values().map(|(_, name)| name).collect())
}
