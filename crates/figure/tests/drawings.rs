//! Content of figures and plots, measured in their pixels.

use fairing_figure::{
    Axis, ColorBar, ColorMap, Field, Figure, FigureError, Image, Legend, Limits, Panel, Plot,
    Scale, ScaleOptions, Series, Shape,
};

fn pixels(plot: &Plot) -> Image {
    plot.draw(400.0, 300.0).unwrap().to_image(1.0).unwrap()
}

/// The middle of all pixels of nearly that colour.
fn center(image: &Image, color: [u8; 3]) -> Option<[f64; 2]> {
    let (mut sum, mut count) = ([0.0; 2], 0.0);
    for y in 0..image.height() {
        for x in 0..image.width() {
            let p = image.pixel(x, y);
            if (0..3).all(|k| p[k].abs_diff(color[k]) < 12) {
                sum = [sum[0] + f64::from(x), sum[1] + f64::from(y)];
                count += 1.0;
            }
        }
    }
    (count > 0.0).then(|| sum.map(|s| s / count))
}

const FIRST: [u8; 3] = [0, 0x72, 0xb2];
const SECOND: [u8; 3] = [0xd5, 0x5e, 0];
const THIRD: [u8; 3] = [0, 0x9e, 0x73];

/// Values that are equally far apart in the logarithm stand equally far apart
/// on a logarithmic axis.
#[test]
fn logarithmic_axes_place_powers_evenly() {
    let point = |e: i32| vec![[10f64.powi(e), 10f64.powi(-e)]];
    let series = [-3, -2, -1].map(|e| Series::points("", point(e))).to_vec();
    let (x, y) = (Axis::log("x"), Axis::log("y"));
    let image = pixels(&Plot { x, y, series, ..Plot::default() });
    let [a, b, c] = [FIRST, SECOND, THIRD].map(|color| center(&image, color).unwrap());
    assert!((b[0] - a[0] - (c[0] - b[0])).abs() < 2.0, "{a:?} {b:?} {c:?}");
    assert!((b[1] - a[1] - (c[1] - b[1])).abs() < 2.0, "{a:?} {b:?} {c:?}");
    assert!(a[0] + 50.0 < b[0] && a[1] + 40.0 < b[1], "x grows to the right, y upward");
}

#[test]
fn bars_stand_on_zero_in_proportion() {
    let categories = vec!["one".into()];
    let series = vec![Series::bars("", vec![1.0]), Series::bars("", vec![4.0])];
    let image = pixels(&Plot { categories, series, ..Plot::default() });
    let height = |color: [u8; 3]| {
        let x = center(&image, color).unwrap()[0] as u32;
        (0..image.height()).filter(|&y| image.pixel(x, y)[..3] == color).count() as f64
    };
    let ratio = height(SECOND) / height(FIRST);
    assert!((ratio - 4.0).abs() < 0.15, "{ratio}");
}

#[test]
fn given_limits_cut_off_what_lies_beyond() {
    let line = Series::line("", vec![[0.0, -100.0], [1.0, 100.0]]);
    let y = Axis::linear("").from_to(-1.0, 1.0);
    let image = pixels(&Plot { y, series: vec![line], ..Plot::default() });
    // The frame ends 8 pixels below the top.
    for y in 0..7 {
        for x in 0..image.width() {
            assert_ne!(image.pixel(x, y)[..3], FIRST, "{x} {y}");
        }
    }
    assert!(center(&image, FIRST).is_some());
}

/// The name of a line stands to the right of the frame, in the colour of the line.
#[test]
fn names_stand_beside_the_lines() {
    let rightmost = |name: &str| {
        let line = Series::line(name, vec![[0.0, 0.0], [1.0, 1.0]]);
        let image = pixels(&Plot { series: vec![line], ..Plot::default() });
        let columns = (0..image.width()).rev();
        let has = |x: &u32| (0..image.height()).any(|y| image.pixel(*x, y)[..3] == FIRST);
        (columns.clone().find(has).unwrap(), image.width())
    };
    let ((bare, width), (named, _)) = (rightmost(""), rightmost("name"));
    assert!(bare > width - 35 && named > width - 35, "{bare} {named}");
    let none = Plot {
        series: vec![Series::line("name", vec![[0.0, 0.0], [1.0, 1.0]])],
        legend: Legend::None,
        ..Plot::default()
    };
    let bare =
        Plot { series: vec![Series::line("", vec![[0.0, 0.0], [1.0, 1.0]])], ..none.clone() };
    assert_eq!(pixels(&none).pixels(), pixels(&bare).pixels());
}

#[test]
fn what_cannot_be_plotted_is_refused() {
    let error = |plot: Plot| plot.draw(300.0, 200.0).unwrap_err();
    assert_eq!(error(Plot::default()), FigureError::NoPoints);
    let series = vec![Series::line("flow", vec![[0.0, 1.0], [1.0, f64::NAN]])];
    assert!(matches!(
        error(Plot { series, ..Plot::default() }),
        FigureError::Point { index: 1, series, .. } if series == "flow"
    ));
    let series = vec![Series::line("flow", vec![[1.0, 1.0], [2.0, 0.0]])];
    assert!(matches!(
        error(Plot { y: Axis::log(""), series, ..Plot::default() }),
        FigureError::Point { index: 1, .. }
    ));
    let series = vec![Series::bars("b", vec![1.0, 2.0])];
    assert_eq!(
        error(Plot { series, ..Plot::default() }),
        FigureError::Bars { series: "b".into(), expected: 0, found: 2 }
    );
    let series = vec![Series::new("", Shape::Level(1.0)), Series::line("", vec![[1.0, 1.0]])];
    let y = Axis::log("").from_to(0.0, 1.0);
    assert_eq!(
        error(Plot { y, series, ..Plot::default() }),
        FigureError::Limits { what: "an axis", low: 0.0, high: 1.0 }
    );
}

/// Every colour of the bar stands where the value that has it is marked.
#[test]
fn the_bar_shows_the_colours_of_its_values() {
    let values: Vec<f64> = (0..1000).map(|i| (f64::from(i) / 999.0).powi(3)).collect();
    for options in [ScaleOptions::EQUALIZED_HUE, ScaleOptions::MAGNITUDE] {
        let options = ScaleOptions { limits: Limits::Full, ..options };
        let scale = Scale::new(&[&Field::new(&values)], &options).unwrap();
        let bar = ColorBar { scale: scale.clone(), quantity: "x".into(), unit: String::new() };
        let image = bar.draw(446.0).to_image(1.0).unwrap();
        // The bar runs from 23 to 423.
        for t in [0.1, 0.35, 0.6, 0.9] {
            let found = image.pixel((23.0 + 400.0 * t) as u32, 6);
            let expected = scale.color(scale.value(t));
            let off = (0..3).map(|k| found[k].abs_diff(expected[k])).max().unwrap();
            assert!(off < 14, "{t}: {found:?} {expected:?}");
        }
    }
}

#[test]
fn arrows_say_that_values_lie_beyond() {
    let values = [0.0, 1.0, 2.0, 3.0, 10.0];
    let draw = |high: f64| {
        let limits = Limits::Fixed { low: 0.0, high };
        let options = ScaleOptions { limits, ..ScaleOptions::MAGNITUDE };
        let scale = Scale::new(&[&Field::new(&values)], &options).unwrap();
        let bar = ColorBar { scale, quantity: String::new(), unit: String::new() };
        bar.draw(446.0).to_image(1.0).unwrap().pixel(426, 6)
    };
    let [r, g, b] = ColorMap::Viridis.at(1.0);
    assert_eq!(draw(5.0), [r, g, b, 255]);
    assert_eq!(draw(10.0), [255; 4]);
}

#[test]
fn panels_are_lettered_and_laid_out_in_rows() {
    let bar = |value: f64| {
        let series = vec![Series::bars("", vec![value])];
        Plot { categories: vec!["c".into()], series, ..Plot::default() }
    };
    let panels = (0..3).map(|i| {
        let drawing = bar(1.0 + f64::from(i)).draw(200.0, 150.0).unwrap();
        Panel::drawing(drawing).caption("a caption that is too long for one line of this panel")
    });
    let figure = Figure {
        panels: panels.collect(),
        columns: 2,
        number: "Figure 1.".into(),
        caption: "Words & <signs>.".into(),
        ..Figure::default()
    };
    let svg = figure.to_svg().unwrap();
    for letter in ["(a) a caption", "(b) a caption", "(c) a caption"] {
        assert_eq!(svg.matches(letter).count(), 1, "{letter}");
    }
    let drawing = figure.draw();
    assert!(drawing.width() > 400.0 && drawing.width() < 470.0);
    assert!(drawing.height() > 2.0 * 150.0 + 2.0 * 38.0);
    let png = figure.to_png(2.0).unwrap();
    assert_eq!(png, figure.to_png(2.0).unwrap());
    assert_eq!(&png[1..4], b"PNG");
}
