//! sRGB and linear light.
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
}
