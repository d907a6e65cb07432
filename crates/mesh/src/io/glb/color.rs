//! Colours, sRGB in memory and linear in files.

/// The linear value of an sRGB byte, of 65535; different bytes have different values.
pub(super) fn to_linear(byte: u8) -> u16 {
    let c = f64::from(byte) / 255.0;
    let linear = if c <= 0.04045 { c / 12.92 } else { libm::pow((c + 0.055) / 1.055, 2.4) };
    (65535.0 * linear).round() as u16
}

/// The sRGB byte of a linear value from 0 to 1.
pub(super) fn to_srgb(linear: f64) -> u8 {
    let c = match linear {
        x if x <= 0.003_130_8 => 12.92 * x,
        x => 1.055 * libm::pow(x, 1.0 / 2.4) - 0.055,
    };
    (255.0 * c).round() as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_survive() {
        for byte in 0..=255 {
            assert_eq!(to_srgb(f64::from(to_linear(byte)) / 65535.0), byte);
        }
        assert_eq!((to_linear(0), to_linear(255), to_linear(188)), (0, 65535, 32957));
    }
}
