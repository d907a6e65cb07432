//! From values to colours, and back for the colour bar.

use crate::color::ColorMap;
use crate::error::FigureError;
use crate::field::Field;

/// The colour of vertices without a value.
pub const UNDEFINED: [u8; 3] = [150, 150, 150];

/// The values at the two ends of a colour map.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum Limits {
    /// The least and the greatest value.
    Full,
    /// Percentiles, so that a few outliers do not determine the colours.
    Percentiles {
        /// Percentage of values below the lower end.
        low: f64,
        /// Percentage of values below the upper end.
        high: f64,
    },
    /// Given values.
    Fixed {
        /// The value at the lower end.
        low: f64,
        /// The value at the upper end.
        high: f64,
    },
}

/// The choice of the middle of the range.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum Center {
    /// The range does not change.
    #[default]
    Free,
    /// The range is widened to lie symmetrically about zero: for signed
    /// fields and diverging maps.
    Zero,
}

/// The distribution of values over the map.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum Spread {
    /// In proportion.
    #[default]
    Linear,
    /// Every colour covers as many values as any other: the histogram of the
    /// normalised values, over 1024 bins, is equalised.
    Equalized,
}

/// Options for finding a [`Scale`].
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct ScaleOptions {
    /// The colours.
    pub map: ColorMap,
    /// The values at the two ends.
    pub limits: Limits,
    /// The choice of the middle of the range.
    pub center: Center,
    /// The distribution of values over the map.
    pub spread: Spread,
    /// The range is never narrower than this, in units of the values: keeps
    /// rounding errors of a constant field from being blown up into colours.
    pub resolution: f64,
}

impl ScaleOptions {
    /// The full range, histogram equalised, mapped to the hue of HSV ([`ColorMap::Hue`]).
    pub const EQUALIZED_HUE: Self = Self {
        map: ColorMap::Hue,
        limits: Limits::Full,
        center: Center::Free,
        spread: Spread::Equalized,
        resolution: 0.0,
    };

    /// For signed fields: [`ColorMap::CoolWarm`] from the 2nd to the 98th
    /// percentile, widened to be centred on zero.
    pub const SIGNED: Self = Self {
        map: ColorMap::CoolWarm,
        limits: Limits::Percentiles { low: 2.0, high: 98.0 },
        center: Center::Zero,
        spread: Spread::Linear,
        resolution: 0.0,
    };

    /// For magnitudes: [`ColorMap::Viridis`] from the 2nd to the 98th
    /// percentile.
    pub const MAGNITUDE: Self =
        Self { map: ColorMap::Viridis, center: Center::Free, ..Self::SIGNED };
}

/// The mapping from values to colours.
#[derive(Debug, Clone, PartialEq)]
pub struct Scale {
    map: ColorMap,
    low: f64,
    high: f64,
    /// Shares of the values below the borders of equal bins, for an equalised
    /// scale; ascending from 0 to 1.
    shares: Option<Vec<f64>>,
    /// The values of an equalised scale, ascending, if there are only a few.
    few: Vec<f64>,
    below: bool,
    above: bool,
}

const BINS: usize = 1024;

/// A colour bar shows up to this many different values one by one.
const FEW: usize = 6;

impl Scale {
    /// One scale for all of `fields`, so that they can be compared.
    ///
    /// # Errors
    ///
    /// [`FigureError::NonFinite`] for a defined value that is not finite,
    /// [`FigureError::NoValues`] if none counts, [`FigureError::Limits`] for
    /// percentiles or fixed values that are not ascending.
    pub fn new(fields: &[&Field<'_>], options: &ScaleOptions) -> Result<Self, FigureError> {
        for field in fields {
            field.check()?;
        }
        let mut sorted: Vec<f64> = fields.iter().flat_map(|f| f.counted()).collect();
        sorted.sort_unstable_by(f64::total_cmp);
        let (mut low, mut high) = ends(&sorted, options.limits)?;
        if options.center == Center::Zero {
            high = high.abs().max(low.abs());
            low = -high;
        }
        if high - low < options.resolution {
            let middle = 0.5 * (low + high);
            (low, high) = (middle - 0.5 * options.resolution, middle + 0.5 * options.resolution);
        }
        let shares = match options.spread {
            Spread::Linear => None,
            Spread::Equalized => Some(equalize(&sorted, low, high)),
        };
        let few = match options.spread {
            Spread::Linear => vec![],
            Spread::Equalized => distinct(&sorted, low, high),
        };
        let shown = || fields.iter().flat_map(|f| f.values()).flatten();
        let slack = 1e-9 * (high - low);
        Ok(Self {
            map: options.map,
            low,
            high,
            shares,
            few,
            below: shown().any(|x| x < low - slack),
            above: shown().any(|x| x > high + slack),
        })
    }

    /// The value at the lower end.
    pub fn low(&self) -> f64 {
        self.low
    }

    /// The value at the upper end.
    pub fn high(&self) -> f64 {
        self.high
    }

    /// The colours.
    pub fn map(&self) -> ColorMap {
        self.map
    }

    /// The distribution of values over the map.
    pub fn spread(&self) -> Spread {
        if self.shares.is_some() { Spread::Equalized } else { Spread::Linear }
    }

    /// The distinct values, ascending, if an equalised scale has only a few; otherwise empty.
    pub fn few(&self) -> &[f64] {
        &self.few
    }

    /// Returns true if a value is below the range.
    pub(crate) fn has_below(&self) -> bool {
        self.below
    }

    /// Returns true if a value is above the range.
    pub(crate) fn has_above(&self) -> bool {
        self.above
    }

    /// Where `value` lies on the colour bar: 0 at the lower end, 1 at the
    /// upper, limited to [0, 1]. The middle if the range has no width.
    pub fn position(&self, value: f64) -> f64 {
        let width = self.high - self.low;
        if width <= 0.0 {
            return 0.5;
        }
        // Halved first: the difference of huge values may overflow.
        let t = ((0.5 * value - 0.5 * self.low) / (0.5 * width)).clamp(0.0, 1.0);
        match &self.shares {
            None => t,
            Some(shares) => {
                let x = t * BINS as f64;
                let bin = (x as usize).min(BINS - 1);
                let within = x - bin as f64;
                shares[bin] + (shares[bin + 1] - shares[bin]) * within
            }
        }
    }

    /// The value at position `t` of the colour bar, the inverse of
    /// [`Self::position`]; where a whole interval has one position, its
    /// middle.
    pub fn value(&self, t: f64) -> f64 {
        let t = t.clamp(0.0, 1.0);
        let fraction = match &self.shares {
            None => t,
            Some(shares) => {
                let first = shares.partition_point(|&s| s < t).clamp(1, BINS);
                let last = shares.partition_point(|&s| s <= t).clamp(1, BINS);
                let inside = |bin: usize| {
                    let (a, b) = (shares[bin - 1], shares[bin]);
                    let part = if b > a { (t - a) / (b - a) } else { 0.5 };
                    (bin - 1) as f64 + part.clamp(0.0, 1.0)
                };
                0.5 * (inside(first) + inside(last)) / BINS as f64
            }
        };
        self.low + (self.high - self.low) * fraction
    }

    /// The colour of a value.
    pub fn color(&self, value: f64) -> [u8; 3] {
        self.map.at(self.position(value))
    }

    /// The colours of a field, [`UNDEFINED`] where it has no value.
    pub fn colors(&self, field: &Field<'_>) -> Vec<[u8; 3]> {
        field.values().map(|x| x.map_or(UNDEFINED, |x| self.color(x))).collect()
    }
}

fn ends(sorted: &[f64], limits: Limits) -> Result<(f64, f64), FigureError> {
    let bad = |low, high| Err(FigureError::Limits { what: "a colour range", low, high });
    match limits {
        Limits::Fixed { low, high } if low < high && (high - low).is_finite() => Ok((low, high)),
        Limits::Fixed { low, high } => bad(low, high),
        Limits::Percentiles { low, high } if !(0.0 <= low && low < high && high <= 100.0) => {
            bad(low, high)
        }
        _ if sorted.is_empty() => Err(FigureError::NoValues),
        Limits::Full => Ok((sorted[0], sorted[sorted.len() - 1])),
        Limits::Percentiles { low, high } => {
            Ok((percentile(sorted, low), percentile(sorted, high)))
        }
    }
}

/// Linear between the two nearest ranks.
fn percentile(sorted: &[f64], percent: f64) -> f64 {
    let rank = percent / 100.0 * (sorted.len() - 1) as f64;
    let (below, above) = (sorted[rank.floor() as usize], sorted[rank.ceil() as usize]);
    below + (above - below) * rank.fract()
}

/// The values in range that differ by more than rounding, if there are at least two and at most
/// [`FEW`]; otherwise empty. Meshes from files may have single precision.
fn distinct(sorted: &[f64], low: f64, high: f64) -> Vec<f64> {
    let slack = 1e-6 * (high - low);
    let mut found: Vec<f64> = vec![];
    for &x in sorted.iter().filter(|x| (low..=high).contains(x)) {
        if found.last().is_none_or(|last| x - last > slack) {
            found.push(x);
        }
        if found.len() > FEW {
            return vec![];
        }
    }
    if found.len() < 2 { vec![] } else { found }
}

fn equalize(sorted: &[f64], low: f64, high: f64) -> Vec<f64> {
    let first = sorted.partition_point(|&x| x < low);
    let last = sorted.partition_point(|&x| x <= high).max(first);
    let count = last - first;
    let border = |i: usize| low + (high - low) * (i as f64 / BINS as f64);
    (0..=BINS)
        .map(|i| match i {
            0 => 0.0,
            BINS => 1.0,
            _ if count == 0 => i as f64 / BINS as f64,
            _ => {
                let below = sorted.partition_point(|&x| x < border(i)).clamp(first, last);
                (below - first) as f64 / count as f64
            }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn scale(values: &[f64], options: ScaleOptions) -> Scale {
        Scale::new(&[&Field::new(values)], &options).unwrap()
    }

    #[test]
    fn percentiles_leave_outliers_outside() {
        let mut values: Vec<f64> = (0..=100).map(f64::from).collect();
        values[100] = 1e6;
        let s = scale(&values, ScaleOptions::MAGNITUDE);
        assert_eq!((s.low(), s.high()), (2.0, 98.0));
        assert!(s.has_below() && s.has_above());
        assert_eq!(s.color(1e6), ColorMap::Viridis.at(1.0));
    }

    #[test]
    fn a_signed_field_is_centred_on_zero() {
        let s =
            scale(&[-1.0, 0.0, 3.0], ScaleOptions { limits: Limits::Full, ..ScaleOptions::SIGNED });
        assert_eq!((s.low(), s.high()), (-3.0, 3.0));
        assert_eq!(s.position(0.0), 0.5);
        assert!(!s.has_below() && !s.has_above());
    }

    #[test]
    fn undefined_and_excluded_values_do_not_rule() {
        let values = [0.0, 1.0, 2.0, 50.0, f64::NAN];
        let field = Field::new(&values)
            .range_without(&[false, false, false, true, false])
            .unwrap()
            .undefined_where(&[false, false, false, false, true])
            .unwrap();
        let options = ScaleOptions { limits: Limits::Full, ..ScaleOptions::MAGNITUDE };
        let s = Scale::new(&[&field], &options).unwrap();
        assert_eq!((s.low(), s.high()), (0.0, 2.0));
        assert!(s.has_above());
        let colors = s.colors(&field);
        assert_eq!(colors[3], ColorMap::Viridis.at(1.0));
        assert_eq!(colors[4], UNDEFINED);
    }

    #[test]
    fn rounding_errors_stay_invisible() {
        let values = [1.0, 1.0 + 1e-15, 1.0 - 1e-15];
        let s = scale(&values, ScaleOptions { resolution: 1e-6, ..ScaleOptions::EQUALIZED_HUE });
        let colors = s.colors(&Field::new(&values));
        assert!((s.high() - s.low() - 1e-6).abs() < 1e-15);
        // All three share one bin.
        assert!(colors.iter().all(|c| c == &colors[0]), "{colors:?}");
    }

    #[test]
    fn a_constant_field_is_in_the_middle() {
        let s = scale(&[4.0; 9], ScaleOptions::EQUALIZED_HUE);
        assert_eq!(s.position(4.0), 0.5);
    }

    #[test]
    fn what_has_no_range_is_refused() {
        let of = |values: &[f64], options: &ScaleOptions| {
            Scale::new(&[&Field::new(values)], options).unwrap_err()
        };
        assert_eq!(of(&[], &ScaleOptions::SIGNED), FigureError::NoValues);
        assert!(matches!(
            of(&[1.0, f64::NAN], &ScaleOptions::SIGNED),
            FigureError::NonFinite { index: 1, .. }
        ));
        let limits = Limits::Fixed { low: 2.0, high: 1.0 };
        assert_eq!(
            of(&[1.0], &ScaleOptions { limits, ..ScaleOptions::SIGNED }),
            FigureError::Limits { what: "a colour range", low: 2.0, high: 1.0 }
        );
        assert_eq!(
            Field::new(&[1.0]).undefined_where(&[]).unwrap_err(),
            FigureError::Count { what: "flags", expected: 1, found: 0 }
        );
    }

    proptest! {
        /// An equalised field is spread evenly: the share of values below a
        /// position is that position, up to the values in one bin.
        #[test]
        fn equalised_positions_are_even(
            values in prop::collection::vec(-1.0f64..1.0, 50..300),
            power in 0.5f64..3.0,
        ) {
            let values: Vec<f64> = values.iter().map(|x| x.signum() * x.abs().powf(power)).collect();
            let s = scale(&values, ScaleOptions::EQUALIZED_HUE);
            let width = (s.high() - s.low()) / BINS as f64;
            for t in [0.1, 0.25, 0.5, 0.75, 0.9] {
                let below = values.iter().filter(|&&x| s.position(x) < t).count() as f64;
                let at = s.value(t);
                let crowd = values.iter().filter(|&&x| (x - at).abs() <= width).count() as f64;
                let n = values.len() as f64;
                prop_assert!((below / n - t).abs() <= (crowd + 1.0) / n, "{below} of {n} below {t}");
            }
        }

        /// Position and value are inverse, and larger values never lie lower.
        #[test]
        fn positions_lead_back(
            values in prop::collection::vec(-1e3f64..1e3, 2..100),
            equalized: bool,
        ) {
            let spread = if equalized { Spread::Equalized } else { Spread::Linear };
            let s = scale(&values, ScaleOptions { spread, ..ScaleOptions::EQUALIZED_HUE });
            let mut sorted = values.clone();
            sorted.sort_unstable_by(f64::total_cmp);
            prop_assert!(sorted.is_sorted_by_key(|&x| s.position(x)));
            for x in values {
                let t = s.position(x);
                prop_assert!((s.position(s.value(t)) - t).abs() < 1e-9);
            }
        }
    }
}
