//! Types of numbers in files that are written.

use rayon::prelude::*;

use crate::io::error::WriteProblem;
use crate::io::{FloatWidth, NumberType};

/// The type of the numbers of a property group: the kept one if it holds them all, otherwise
/// one of floating-point numbers.
pub(crate) fn width_of(
    format: &'static str,
    name: &str,
    values: &[f64],
    kept: Option<NumberType>,
    width: FloatWidth,
) -> Result<NumberType, WriteProblem> {
    let holds =
        |number: NumberType| values.par_iter().with_min_len(1 << 14).all(|&x| number.holds(x));
    if let Some(kept) = kept
        && (kept.is_integer() || width == FloatWidth::Lossless)
        && holds(kept)
    {
        return Ok(kept);
    }
    match width {
        FloatWidth::Double => Ok(NumberType::F64),
        FloatWidth::Lossless if holds(NumberType::F32) => Ok(NumberType::F32),
        FloatWidth::Lossless => Ok(NumberType::F64),
        FloatWidth::Single => match values.iter().find(|x| (**x as f32).is_infinite()) {
            None => Ok(NumberType::F32),
            Some(x) => Err(WriteProblem::UnsupportedMesh {
                format,
                what: format!("{x:e} in {name} as a 32-bit number"),
            }),
        },
    }
}
