//! sRGB and linear light, and colour maps.
//!
//! Colours are stored as 8-bit sRGB; light is added up in linear components,
//! where twice the number is twice the light.

/// The linear components, in [0, 1], of an sRGB colour (IEC 61966-2-1).
pub(crate) fn linear_from_srgb(color: [u8; 3]) -> [f32; 3] {
    color.map(|c| {
        let x = f32::from(c) / 255.0;
        if x <= 0.040_45 { x / 12.92 } else { libm::powf((x + 0.055) / 1.055, 2.4) }
    })
}

/// The sRGB colour nearest to linear components; components outside [0, 1] are clamped first, as in
/// an overexposed photograph.
pub(crate) fn srgb_from_linear(linear: [f32; 3]) -> [u8; 3] {
    linear.map(|c| {
        let c = c.clamp(0.0, 1.0);
        let y = if c <= 0.003_130_8 { 12.92 * c } else { 1.055 * libm::powf(c, 1.0 / 2.4) - 0.055 };
        (y * 255.0 + 0.5) as u8
    })
}

/// The fully saturated colour of a hue in degrees: 0 is red, 120 green, 240
/// blue; other angles are taken modulo 360.
pub(crate) fn from_hue(degrees: f64) -> [u8; 3] {
    let sector = degrees.rem_euclid(360.0) / 60.0;
    let channel = |offset: f64| {
        let k = (offset + sector) % 6.0;
        let level = 1.0 - k.min(4.0 - k).clamp(0.0, 1.0);
        (level * 255.0 + 0.5) as u8
    };
    [channel(5.0), channel(3.0), channel(1.0)]
}

/// A map from numbers in [0, 1] to colours.
///
/// Written as its name (`Display`), and read from it (`FromStr`).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum ColorMap {
    /// Perceptually uniform, dark blue to yellow; right for magnitudes.
    #[default]
    Viridis,
    /// Perceptually uniform and nearly the same for colour-blind people.
    Cividis,
    /// Perceptually uniform, black over red to light yellow.
    Magma,
    /// A rainbow with even steps, for reading off values, not for print.
    Turbo,
    /// Blue over light grey to red, for signed fields with zero in the middle.
    /// Its lightness stays high, so that shading shows. Source: [moreland2009].
    ///
    /// [moreland2009]: https://doi.org/10.1007/978-3-642-10520-3_9
    CoolWarm,
    /// The hues of HSV at full saturation from blue (low) over green to red
    /// (high). Neither uniform nor safe for colour-blind people.
    Hue,
}

fairing_parameters::named!(ColorMap, "colour map",
    Viridis: "viridis",
    Cividis: "cividis",
    Magma: "magma",
    Turbo: "turbo",
    CoolWarm: "coolwarm",
    Hue: "hue",
);

impl ColorMap {
    /// The colour at `t`; values outside of [0, 1] get the colour of the
    /// nearer end.
    pub fn at(self, t: f64) -> [u8; 3] {
        let t = t.clamp(0.0, 1.0);
        let gradient = match self {
            Self::Viridis => colorous::VIRIDIS,
            Self::Cividis => colorous::CIVIDIS,
            Self::Magma => colorous::MAGMA,
            Self::Turbo => colorous::TURBO,
            Self::CoolWarm => return cool_warm(t),
            Self::Hue => return from_hue(240.0 * (1.0 - t)),
        };
        let c = gradient.eval_continuous(t);
        [c.r, c.g, c.b]
    }
}

#[cfg(feature = "serde")]
fairing_parameters::serde_by_name!(ColorMap);

/// Polar CIELAB (Msh) from blue (80, 1.08, −1.1) over the unsaturated point
/// of magnitude 88 to red (80, 1.08, 0.5).
///
/// Magnitude and saturation go straight to the middle. The hue there leans
/// away from grey, to ±1.061, which keeps the steps perceptually even.
fn cool_warm(t: f64) -> [u8; 3] {
    // Distance from the middle, 0 to 1.
    let far = (2.0 * t - 1.0).abs();
    let magnitude = 88.0 - 8.0 * far;
    let saturation = 1.08 * far;
    let hue = if t < 0.5 { -1.661 + 0.561 * far } else { 1.061 - 0.561 * far };
    let lightness = magnitude * libm::cos(saturation);
    let a = magnitude * libm::sin(saturation) * libm::cos(hue);
    let b = magnitude * libm::sin(saturation) * libm::sin(hue);
    // CIELAB to XYZ under D65, then to linear sRGB.
    let f = |x: f64| {
        let delta: f64 = 6.0 / 29.0;
        if x > delta { x.powi(3) } else { 3.0 * delta * delta * (x - 4.0 / 29.0) }
    };
    let base = (lightness + 16.0) / 116.0;
    let x = 0.950_47 * f(base + a / 500.0);
    let y = f(base);
    let z = 1.088_83 * f(base - b / 200.0);
    srgb_from_linear(
        [
            3.240_6 * x - 1.537_2 * y - 0.498_6 * z,
            -0.968_9 * x + 1.875_8 * y + 0.041_5 * z,
            0.055_7 * x - 0.204_0 * y + 1.057_0 * z,
        ]
        .map(|c| c as f32),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn srgb_survives_the_way_through_linear_light() {
        for c in 0..=255u8 {
            let color = [c, 255 - c, c / 2];
            assert_eq!(srgb_from_linear(linear_from_srgb(color)), color);
        }
    }

    #[test]
    fn half_the_light_is_188() {
        assert_eq!(srgb_from_linear([0.5; 3]), [188; 3]);
    }

    #[test]
    fn primaries_and_secondaries_stand_at_their_angles() {
        let expected = [
            (0.0, [255, 0, 0]),
            (60.0, [255, 255, 0]),
            (120.0, [0, 255, 0]),
            (180.0, [0, 255, 255]),
            (240.0, [0, 0, 255]),
            (300.0, [255, 0, 255]),
            (-120.0, [0, 0, 255]),
        ];
        for (hue, color) in expected {
            assert_eq!(from_hue(hue), color, "{hue}");
        }
    }

    /// The table published with the map: ends (59, 76, 192) and (180, 4, 38),
    /// middle (221, 221, 221), quarter points (141, 176, 254) and
    /// (244, 152, 122).
    #[test]
    fn cool_warm_is_the_published_one() {
        let expected = [
            (0.0, [59, 76, 192]),
            (0.25, [141, 176, 254]),
            (0.5, [221, 221, 221]),
            (0.75, [244, 152, 122]),
            (1.0, [180, 4, 38]),
        ];
        for (t, color) in expected {
            let found = ColorMap::CoolWarm.at(t);
            let off = (0..3).map(|k| found[k].abs_diff(color[k])).max();
            assert!(off <= Some(2), "{t}: {found:?} instead of {color:?}");
        }
    }

    #[test]
    fn low_is_cold_and_high_is_warm() {
        assert_eq!(ColorMap::Hue.at(0.0), [0, 0, 255]);
        assert_eq!(ColorMap::Hue.at(0.5), [0, 255, 0]);
        assert_eq!(ColorMap::Hue.at(1.0), [255, 0, 0]);
        assert_eq!(ColorMap::Hue.at(7.0), [255, 0, 0]);
    }

    #[test]
    fn names_lead_back() {
        for map in ColorMap::ALL {
            assert_eq!(map.to_string().parse(), Ok(map));
        }
        let error = "jet".parse::<ColorMap>().unwrap_err().to_string();
        assert!(error.contains("colour map \"jet\"") && error.contains("viridis, "), "{error}");
    }
}
