//! A report with views of every kind, small enough to be drawn quickly.

use std::path::Path;

use anyhow::Result;
use fairing_figure::{Axis, Figure, Plot, Series};
use fairing_mesh::TriMesh;
use fairing_report::model::provenance::Provenance;
use fairing_report::model::results::{FigureFile, Form, PlotLink, Record, Results, ViewFile};
use fairing_report::model::section::Section;
use fairing_report::model::table::{Table, Unit};
use fairing_report::model::verdict::{Judgement, Shown, Verdict, ViewState};
use fairing_report::model::view::{Modes, Panel, Slider, View};
use fairing_report::row;
use fairing_shapes as shapes;
use fairing_spectral::SpectrumOptions;

/// The noisy mesh that the page smooths.
pub(crate) fn noisy() -> TriMesh {
    use rand::{RngExt as _, SeedableRng as _};
    let mesh = shapes::bumpy_sphere(4, 0.15, 3.0);
    let mut random = rand_chacha::ChaCha8Rng::seed_from_u64(7);
    let step = 0.25 * mesh.mean_edge_length();
    let positions =
        mesh.positions().iter().map(|p| p.map(|x| x + step * random.random_range(-1.0..1.0)));
    mesh.with_positions(positions.collect()).expect("finite positions")
}

/// The same mesh without noise.
pub(crate) fn truth() -> TriMesh {
    shapes::bumpy_sphere(4, 0.15, 3.0)
}

/// A formula wider than a telephone.
const FORMULA: &str = concat!(
    r"\kappa_n = \frac{L\,du^2 + 2M\,du\,dv + N\,dv^2}{E\,du^2 + 2F\,du\,dv + G\,dv^2} ",
    r"= a\left(\frac{\cos^2\theta}{b^2} + \frac{\sin^2\theta}{c^2}\right), ",
    r"\qquad \varphi_i^T M \varphi_j = \delta_{ij}, \qquad \varphi_i^T S \varphi_j = \lambda_i \delta_{ij}",
);

/// Half way to the mean of the neighbours.
fn smoothed(mesh: &TriMesh) -> TriMesh {
    let topology = mesh.topology();
    let old = mesh.positions();
    let new = (0..mesh.vertex_count()).map(|v| {
        let around = topology.neighbors(v as u32);
        [0, 1, 2].map(|k| {
            let sum: f64 = around.iter().map(|&w| old[w as usize][k]).sum();
            0.5 * old[v][k] + 0.5 * sum / around.len() as f64
        })
    });
    mesh.with_positions(new.collect()).expect("finite positions")
}

fn flow() -> View {
    let input = noisy();
    let truth = truth();
    let mut stops = vec![input.clone()];
    for _ in 1..6 {
        stops.push(smoothed(&stops[stops.len() - 1]));
    }
    let heights: Vec<f64> = input.positions().iter().map(|p| p[1]).collect();
    let moved: Vec<Vec<f64>> = stops
        .iter()
        .map(|mesh| {
            let pairs = mesh.positions().iter().zip(input.positions());
            pairs.map(|(p, q)| glam::DVec3::from(*p).distance((*q).into())).collect()
        })
        .collect();
    let still = Panel::still("noisy", &input).with_field("height", "m", true, &heights);
    let moving = Panel::moving("smoothed", &input, stops.iter().map(TriMesh::positions))
        .with_field("height", "m", true, &heights)
        .with_moving_field("displacement", "m", false, moved.iter().map(|m| &m[..]))
        .with_live_smoothing();
    View {
        id: "flow".into(),
        mesh: "noisy ball".into(),
        caption: "Explicit smoothing of a noisy sphere.".into(),
        alt: "Two bumpy spheres, one noisy, one smooth.".into(),
        fallback: "picture".into(),
        color: None,
        z_up: false,
        sliders: vec![Slider::new("iterations", 0..stops.len())],
        start: vec![],
        panels: vec![still, moving],
        from: Some(0),
        truth: Some(truth.positions().to_vec()),
    }
}

/// An open surface with undefined values at its boundary, far from the origin.
fn open() -> View {
    let flower = shapes::flower(0.12, 1);
    let topology = flower.topology();
    let border: Vec<u32> =
        (0..flower.vertex_count() as u32).filter(|&v| topology.is_boundary_vertex(v)).collect();
    let values: Vec<f64> = flower.positions().iter().map(|p| p[0] * p[2]).collect();
    let panel = Panel::still("flower", &flower)
        .with_field("xz", "", true, &values)
        .undefined_at(border.iter().copied());
    View {
        id: "open".into(),
        caption: "An open surface.".into(),
        alt: "A flower of four petals.".into(),
        fallback: "picture".into(),
        z_up: false,
        sliders: vec![],
        panels: vec![panel],
        ..View::default()
    }
}

/// Widths and heights of the ellipsoids of the view with two sliders.
pub(crate) const WIDTHS: [f64; 2] = [1.0, 1.5];
pub(crate) const HEIGHTS: [f64; 3] = [0.5, 1.0, 2.0];

/// The captions of these ellipsoids.
pub(crate) const FACTS: [Option<f64>; 6] =
    [Some(1.5), Some(2.0), None, Some(0.25), Some(12.0), Some(3.0)];

fn grid() -> View {
    let sphere = shapes::icosphere(2);
    let stretched = |width: f64, height: f64| -> Vec<[f64; 3]> {
        sphere.positions().iter().map(|p| [width * p[0], height * p[1], p[2]]).collect()
    };
    let all: Vec<_> = WIDTHS.iter().flat_map(|&w| HEIGHTS.map(|h| stretched(w, h))).collect();
    View {
        id: "grid".into(),
        caption: "Ellipsoids.".into(),
        alt: "An ellipsoid.".into(),
        fallback: "picture".into(),
        z_up: false,
        color: Some("mean curvature".into()),
        sliders: vec![Slider::new("width", WIDTHS), Slider::new("height", HEIGHTS)],
        panels: vec![Panel::moving("ellipsoid", &sphere, all.iter().map(|p| &p[..])).with_fact(
            "E_a",
            "°",
            FACTS.to_vec(),
        )],
        ..View::default()
    }
}

/// The error of the estimates in the view of modes.
pub(crate) const SLOPE: f64 = 0.25;

/// A ball and its smoothest modes.
pub(crate) fn modes() -> Result<(TriMesh, Modes)> {
    let ball = shapes::bumpy_sphere(2, 0.15, 3.0);
    let laplacian = fairing_operators::Laplacian::cotangent(&ball)?;
    let spectrum = fairing_spectral::spectrum(&laplacian, 16, &SpectrumOptions::default())?;
    let c = spectrum.transform(ndarray::ArrayView2::from(ball.positions()))?;
    let modes = Modes {
        values: spectrum.values.clone(),
        coefficients: (0..16).map(|i| [0, 1, 2].map(|d| c[[i, d]])).collect(),
        vectors: (0..16).map(|i| spectrum.modes.column(i).to_vec()).collect(),
    };
    Ok((ball, modes))
}

/// A sum of modes, beside the mesh with a field whose exact values are known.
fn sum() -> Result<View> {
    let (ball, modes) = modes()?;
    let heights: Vec<f64> = ball.positions().iter().map(|p| p[1]).collect();
    let off: Vec<f64> = heights.iter().map(|y| y + SLOPE).collect();
    Ok(View {
        id: "sum".into(),
        caption: "Modes.".into(),
        alt: "A ball twice.".into(),
        fallback: "picture".into(),
        z_up: false,
        sliders: vec![],
        panels: vec![
            Panel::still("k modes", &ball).with_modes(modes),
            Panel::still("ball", &ball).with_field("height", "m", true, &off).exactly(heights),
        ],
        ..View::default()
    })
}

/// A plot whose points are the stops of the view of flows.
fn curve(folder: &Path) -> Result<FigureFile> {
    let points = (1..6).map(|k| [f64::from(k), 1.0 / f64::from(k + 1)]).collect();
    let plot = Plot {
        x: Axis::linear("iterations"),
        y: Axis::linear("error"),
        series: vec![Series::marked("sphere", points)],
        ..Plot::default()
    };
    let mut figure = Figure { columns: 2, ..Figure::default() };
    figure.panels.push(fairing_figure::Panel::drawing(plot.draw(420.0, 300.0)?));
    figure.panels.push(fairing_figure::Panel::drawing(plot.draw(420.0, 300.0)?));
    std::fs::write(folder.join("q5/curve.svg"), figure.to_svg()?)?;
    std::fs::write(folder.join("q5/curve.png"), figure.draw().to_image(1.0)?.to_png()?)?;
    let (series, slider) = ("sphere".into(), "iterations".into());
    Ok(FigureFile {
        id: "curve".into(),
        caption: "Errors.".into(),
        alt: "A falling line.".into(),
        png: "q5/curve.png".into(),
        svg: Some("q5/curve.svg".into()),
        small: None,
        links: vec![PlotLink { plot: String::new(), series, view: "flow".into(), slider }],
    })
}

/// The section of an experiment.
fn section(id: &str) -> Section {
    let mut cards = fairing_report::experiments::ALL.iter().map(|e| e.card());
    cards.find(|card| card.id == id).map(|card| card.section).unwrap_or_default()
}

/// A record with playgrounds only.
fn playful(id: &str) -> Record {
    Record {
        id: id.into(),
        section: section(id),
        title: "To play with".into(),
        question: "What happens?".into(),
        method: "By hand.".into(),
        seconds: 1.0,
        ..Record::default()
    }
}

/// The record with views of every kind.
fn flows(folder: &Path) -> Result<Record> {
    Ok(Record {
        id: "q5".into(),
        section: section("q5"),
        title: "Explicit smoothing".into(),
        question: "What does λ do?".into(),
        method: "By steps.".into(),
        formulas: vec![FORMULA.into()],
        claims: vec![
            Judgement::new("5a", "λ = 0.05 is best.", Verdict::Qualified, "It depends.")
                .shown(Shown::view("q5", "flow", &ViewState::at(&[4]).field("displacement")))
                .number("normal error", 3.25, Unit::Degrees),
        ],
        figures: vec![
            FigureFile {
                id: "picture".into(),
                caption: "The input.".into(),
                alt: "A noisy sphere.".into(),
                png: "picture.png".into(),
                svg: None,
                links: vec![],
                small: None,
            },
            curve(folder)?,
        ],
        notes: vec!["A note with <angle> brackets & signs.".into()],
        views: [flow(), open(), grid(), sum()?]
            .iter()
            .map(|view| keep(view, folder))
            .collect::<Result<_>>()?,
        tables: vec![wide()],
        seconds: 1.0,
        ..Record::default()
    })
}

/// A table wider than a telephone.
fn wide() -> Table {
    let names = ["normal error", "surface error", "displacement", "largest displacement", "volume"];
    let columns = names.map(|name| (name, Unit::EdgeLengths));
    let caption =
        "What the steps do to a sphere, in a sentence that is longer than a line of a telephone.";
    let mut table = Table::new("wide", caption, &columns);
    table.push(row![0.1234, 0.2345, 0.3456, 0.4567, 0.5678]);
    table
}

/// Writes the report into this folder.
pub(crate) fn publish(folder: &Path) -> Result<()> {
    let mesh = noisy();
    let camera = fairing_figure::Camera::fit(
        &[&mesh],
        fairing_figure::Viewpoint::ThreeQuarter,
        fairing_figure::Up::Y,
        4.0 / 3.0,
    )?;
    let options = fairing_figure::RenderOptions { width: 320, height: 240, ..Default::default() };
    let clay = fairing_figure::Colors::CLAY;
    let image = fairing_figure::render(&mesh, clay, None, &camera, &options)?;
    std::fs::create_dir_all(folder.join("q5"))?;
    std::fs::write(folder.join("picture.png"), image.to_png()?)?;
    std::fs::write(folder.join("q5/wide.csv"), wide().to_csv()?)?;
    let provenance = Provenance {
        program: "fairing".into(),
        commit: "0123456789abcdef".into(),
        dirty: false,
        compiler: "rustc".into(),
        libraries: vec![],
        system: "linux".into(),
        processor: "some".into(),
        threads: 2,
        seed: 1,
        quick: true,
        date: "2000-01-01".into(),
    };
    let results = Results {
        provenance,
        form: Form::Whole,
        experiments: vec![flows(folder)?, playful("q2"), playful("noise"), playful("denoisers")],
    };
    fairing_report::page::publish(results, folder, Form::Whole)?;
    Ok(())
}

/// Writes the data of a view as the runner does.
fn keep(view: &View, folder: &Path) -> Result<ViewFile> {
    let data = format!("{}.view.json", view.id);
    std::fs::write(folder.join(&data), view.to_json()?)?;
    Ok(ViewFile {
        id: view.id.clone(),
        caption: view.caption.clone(),
        alt: view.alt.clone(),
        fallback: view.fallback.clone(),
        data,
        mesh: None,
    })
}
