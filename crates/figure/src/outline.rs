//! Outlines, which drawings fill and stroke.

/// The handle of a cubic Bézier curve that follows a quarter of a circle, in
/// radii; the curve leaves the circle by less than 0.03 %.
const QUARTER: f64 = 0.552_284_749_8;

/// A piece of an outline.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Step {
    Move([f64; 2]),
    Line([f64; 2]),
    Cubic([f64; 2], [f64; 2], [f64; 2]),
    Close,
}

/// Lines and curves, in CSS pixels.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Outline(pub(crate) Vec<Step>);

impl Outline {
    /// Straight lines through the points.
    pub(crate) fn polyline(points: impl IntoIterator<Item = [f64; 2]>) -> Self {
        let step = |(i, p)| if i == 0 { Step::Move(p) } else { Step::Line(p) };
        Self(points.into_iter().enumerate().map(step).collect())
    }

    /// The area inside straight lines through the points.
    pub(crate) fn polygon(points: impl IntoIterator<Item = [f64; 2]>) -> Self {
        Self::polyline(points).closed()
    }

    pub(crate) fn rectangle([x, y]: [f64; 2], [width, height]: [f64; 2]) -> Self {
        Self::polygon([[x, y], [x + width, y], [x + width, y + height], [x, y + height]])
    }

    /// A rectangle whose corners are quarters of a circle.
    pub(crate) fn rounded([x, y]: [f64; 2], [width, height]: [f64; 2], radius: f64) -> Self {
        let mut steps = vec![Step::Move([x + radius, y])];
        // Each side ends where its corner begins; the corner turns to the right.
        let corners = [
            ([x + width, y], [1.0, 0.0]),
            ([x + width, y + height], [0.0, 1.0]),
            ([x, y + height], [-1.0, 0.0]),
            ([x, y], [0.0, -1.0]),
        ];
        for (corner, [dx, dy]) in corners {
            let before = |r: f64| [corner[0] - r * dx, corner[1] - r * dy];
            let after = |r: f64| [corner[0] - r * dy, corner[1] + r * dx];
            let handle = radius * (1.0 - QUARTER);
            steps.push(Step::Line(before(radius)));
            steps.push(Step::Cubic(before(handle), after(handle), after(radius)));
        }
        Self(steps).closed()
    }

    /// A circle about the origin.
    pub(crate) fn circle(radius: f64) -> Self {
        Self::rounded([-radius; 2], [2.0 * radius; 2], radius)
    }

    fn closed(mut self) -> Self {
        self.0.push(Step::Close);
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The middle of a cubic curve.
    fn middle([a, b, c, d]: [[f64; 2]; 4]) -> [f64; 2] {
        [0, 1].map(|k| (a[k] + 3.0 * b[k] + 3.0 * c[k] + d[k]) / 8.0)
    }

    #[test]
    fn a_circle_is_round() {
        let Outline(steps) = Outline::circle(2.0);
        let mut last = [0.0; 2];
        let mut curves = 0;
        for step in steps {
            match step {
                Step::Move(p) | Step::Line(p) => last = p,
                Step::Cubic(b, c, d) => {
                    let [x, y] = middle([last, b, c, d]);
                    assert!((x.hypot(y) - 2.0).abs() < 1e-3, "{x} {y}");
                    last = d;
                    curves += 1;
                }
                Step::Close => {}
            }
            assert!((last[0].hypot(last[1]) - 2.0).abs() < 1e-12, "{last:?}");
        }
        assert_eq!(curves, 4);
    }
}
