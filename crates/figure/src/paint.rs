//! Drawings as pixels.

use tiny_skia::{
    FillRule, FilterQuality, LineJoin, Mask, Paint, PathBuilder, Pixmap, PixmapPaint, StrokeDash,
    Transform,
};

use crate::drawing::{Anchor, Color, Drawing, Element, Path, Text};
use crate::error::FigureError;
use crate::image::Image;
use crate::outline::{Outline, Step};
use crate::text;

impl Drawing {
    /// The drawing on white, `zoom` pixels for each CSS pixel. Text uses the
    /// embedded fonts only, and nothing is loaded from files.
    ///
    /// # Errors
    ///
    /// [`FigureError::Size`] if the picture would be empty or larger than
    /// [`MAX_SIDE`](crate::MAX_SIDE).
    pub fn to_image(&self, zoom: f64) -> Result<Image, FigureError> {
        let pixels = |side: f64| (side * zoom).round().clamp(0.0, f64::from(u32::MAX)) as u32;
        let (width, height) = (pixels(self.width), pixels(self.height));
        let largest = crate::MAX_SIDE;
        if width == 0 || height == 0 || width > largest || height > largest {
            return Err(FigureError::Size { width, height, samples: 1 });
        }
        let map =
            Pixmap::new(width, height).ok_or(FigureError::Size { width, height, samples: 1 })?;
        let mut canvas = Canvas { map, mask: None };
        canvas.map.fill(tiny_skia::Color::WHITE);
        canvas.draw(&self.elements, Transform::from_scale(zoom as f32, zoom as f32));
        let straight = |p: &tiny_skia::PremultipliedColorU8| {
            let c = p.demultiply();
            [c.red(), c.green(), c.blue(), c.alpha()]
        };
        let pixels = canvas.map.pixels().iter().map(straight).collect();
        Ok(Image::new(width, height, pixels))
    }
}

struct Canvas {
    map: Pixmap,
    /// The visible part; everything if there is none.
    mask: Option<Mask>,
}

impl Canvas {
    fn draw(&mut self, elements: &[Element], to: Transform) {
        for element in elements {
            match element {
                Element::Path(path) => self.path(path, to),
                Element::Text(words) => self.text(words, to),
                Element::Data(_) => {}
                Element::Image { at, size, image } => self.image(*at, *size, image, to),
                Element::Group { at, elements } => self.draw(elements, moved(to, *at)),
                Element::Clip { at, size, elements } => {
                    let outer = self.mask.take();
                    let box_ = skia(&Outline::rectangle(*at, *size));
                    let mut mask = match &outer {
                        Some(mask) => Some(mask.clone()),
                        None => Mask::new(self.map.width(), self.map.height()).map(|mut mask| {
                            mask.invert();
                            mask
                        }),
                    };
                    if let (Some(mask), Some(box_)) = (&mut mask, &box_) {
                        mask.intersect_path(box_, FillRule::Winding, true, to);
                    }
                    self.mask = mask;
                    self.draw(elements, to);
                    self.mask = outer;
                }
            }
        }
    }

    fn path(&mut self, path: &Path, to: Transform) {
        let Some(outline) = skia(&path.outline) else { return };
        let to = moved(to, path.at);
        if let Some(fill) = path.fill {
            let paint = paint(fill.color, fill.opacity);
            self.map.fill_path(&outline, &paint, FillRule::Winding, to, self.mask.as_ref());
        }
        if let Some(stroke) = path.stroke {
            let dash = StrokeDash::new(stroke.dashes.iter().map(|&d| d as f32).collect(), 0.0);
            let line = tiny_skia::Stroke {
                width: stroke.width as f32,
                line_join: if stroke.round { LineJoin::Round } else { LineJoin::Miter },
                dash: if stroke.dashes.is_empty() { None } else { dash },
                ..Default::default()
            };
            let paint = paint(stroke.color, 1.0);
            self.map.stroke_path(&outline, &paint, &line, to, self.mask.as_ref());
        }
    }

    fn text(&mut self, words: &Text, to: Transform) {
        let paint = paint(words.color, 1.0);
        let back = match words.anchor {
            Anchor::Start => 0.0,
            Anchor::Middle => 0.5,
            Anchor::End => 1.0,
        };
        let start = -back * text::width(&words.words, words.size, words.style);
        let to = moved(to, words.at);
        let to = if words.upward { to.pre_rotate(-90.0) } else { to };
        let glyph = |x: f64, scale: f64| Glyph {
            path: PathBuilder::new(),
            x: (start + x) as f32,
            scale: scale as f32,
        };
        text::glyphs(&words.words, words.size, words.style, glyph, |glyph| {
            if let Some(path) = glyph.path.finish() {
                self.map.fill_path(&path, &paint, FillRule::Winding, to, self.mask.as_ref());
            }
        });
    }

    fn image(&mut self, [x, y]: [f64; 2], [width, height]: [f64; 2], image: &Image, to: Transform) {
        let Some(mut map) = Pixmap::new(image.width(), image.height()) else { return };
        for (p, &[r, g, b, a]) in map.pixels_mut().iter_mut().zip(image.pixels()) {
            *p = tiny_skia::ColorU8::from_rgba(r, g, b, a).premultiply();
        }
        let scale = [width / f64::from(image.width()), height / f64::from(image.height())];
        let to = moved(to, [x, y]).pre_scale(scale[0] as f32, scale[1] as f32);
        let paint = PixmapPaint { quality: FilterQuality::Bicubic, ..Default::default() };
        self.map.draw_pixmap(0, 0, map.as_ref(), &paint, to, self.mask.as_ref());
    }
}

fn moved(to: Transform, [x, y]: [f64; 2]) -> Transform {
    to.pre_translate(x as f32, y as f32)
}

fn paint(color: Color, opacity: f64) -> Paint<'static> {
    let [r, g, b] = color;
    let mut paint = Paint { anti_alias: true, ..Default::default() };
    paint.set_color_rgba8(r, g, b, (opacity * 255.0).round() as u8);
    paint
}

/// `None` for an outline without extent.
fn skia(outline: &Outline) -> Option<tiny_skia::Path> {
    let mut path = PathBuilder::new();
    let f = |p: [f64; 2]| (p[0] as f32, p[1] as f32);
    for step in &outline.0 {
        match *step {
            Step::Move(p) => path.move_to(f(p).0, f(p).1),
            Step::Line(p) => path.line_to(f(p).0, f(p).1),
            Step::Cubic(a, b, c) => {
                path.cubic_to(f(a).0, f(a).1, f(b).0, f(b).1, f(c).0, f(c).1);
            }
            Step::Close => path.close(),
        }
    }
    path.finish()
}

/// Converts the outline of a glyph from font units, y upward, to CSS pixels, y downward.
struct Glyph {
    path: PathBuilder,
    x: f32,
    scale: f32,
}

impl Glyph {
    fn at(&self, x: f32, y: f32) -> (f32, f32) {
        (self.x + self.scale * x, -self.scale * y)
    }
}

impl ttf_parser::OutlineBuilder for Glyph {
    fn move_to(&mut self, x: f32, y: f32) {
        let (x, y) = self.at(x, y);
        self.path.move_to(x, y);
    }

    fn line_to(&mut self, x: f32, y: f32) {
        let (x, y) = self.at(x, y);
        self.path.line_to(x, y);
    }

    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        let ((x1, y1), (x, y)) = (self.at(x1, y1), self.at(x, y));
        self.path.quad_to(x1, y1, x, y);
    }

    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        let ((x1, y1), (x2, y2), (x, y)) = (self.at(x1, y1), self.at(x2, y2), self.at(x, y));
        self.path.cubic_to(x1, y1, x2, y2, x, y);
    }

    fn close(&mut self) {
        self.path.close();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drawing::Stroke;
    use crate::text::Style;

    fn dark(image: &Image) -> impl Iterator<Item = (u32, u32)> + '_ {
        let all = (0..image.height()).flat_map(|y| (0..image.width()).map(move |x| (x, y)));
        all.filter(|&(x, y)| image.pixel(x, y)[0] < 100)
    }

    /// Text covers its computed width, from the side of its anchor, also where it runs upward.
    #[test]
    fn words_fill_their_width() {
        let width = text::width("mnmn", 20.0, Style::Regular);
        for (anchor, from) in [
            (Anchor::Start, 100.0),
            (Anchor::Middle, 100.0 - width / 2.0),
            (Anchor::End, 100.0 - width),
        ] {
            let mut drawing = Drawing::new(200.0, 50.0);
            drawing.text([100.0, 30.0], 20.0, anchor, Style::Regular, [0; 3], "mnmn");
            let image = drawing.to_image(1.0).unwrap();
            let left = dark(&image).map(|p| p.0).min().unwrap();
            let right = dark(&image).map(|p| p.0).max().unwrap();
            let lowest = dark(&image).map(|p| p.1).max().unwrap();
            // The side bearings of an m at this size are under 3 pixels.
            assert!((f64::from(left) - from).abs() < 4.0, "{anchor:?} {left}");
            assert!((f64::from(right) - from - width).abs() < 4.0, "{anchor:?} {right}");
            assert!((28..=30).contains(&lowest), "{lowest}");
        }
        let mut drawing = Drawing::new(50.0, 200.0);
        drawing.text_upward([30.0, 100.0], 20.0, Style::Regular, "mnmn");
        let image = drawing.to_image(1.0).unwrap();
        let top = dark(&image).map(|p| p.1).min().unwrap();
        assert!((f64::from(top) - (100.0 - width / 2.0)).abs() < 4.0, "{top}");
        assert!(dark(&image).all(|p| p.0 <= 30));
    }

    #[test]
    fn groups_move_clips_hide_and_zoom_enlarges() {
        let mut inner = Drawing::new(20.0, 20.0);
        let bar = Outline::polyline([[-50.0, 5.0], [50.0, 5.0]]);
        let stroke = Stroke { width: 4.0, ..Stroke::thin([0; 3]) };
        inner.stroke(bar, stroke);
        let clip = Element::Clip { at: [0.0; 2], size: [20.0; 2], elements: inner.elements };
        let mut drawing = Drawing::new(60.0, 40.0);
        drawing.place([10.0, 10.0], Drawing { elements: vec![clip], ..Drawing::new(20.0, 20.0) });
        let image = drawing.to_image(2.0).unwrap();
        assert_eq!((image.width(), image.height()), (120, 80));
        let all: Vec<_> = dark(&image).collect();
        assert_eq!(all.iter().map(|p| p.0).min(), Some(20));
        assert_eq!(all.iter().map(|p| p.0).max(), Some(59));
        assert_eq!(all.iter().map(|p| p.1).min(), Some(26));
        assert_eq!(all.iter().map(|p| p.1).max(), Some(33));
    }

    #[test]
    fn pictures_that_are_too_large_are_refused() {
        let drawing = Drawing::new(90.0, 30.0);
        assert!(matches!(drawing.to_image(1e6), Err(FigureError::Size { .. })));
        assert!(matches!(drawing.to_image(0.0), Err(FigureError::Size { .. })));
    }
}
