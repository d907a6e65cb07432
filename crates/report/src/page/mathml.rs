//! Formulas in TeX as MathML.

use anyhow::{Result, anyhow};
use math_core::{LatexToMathML, MathCoreConfig, MathDisplay};

/// A displayed formula as a `<math>` element.
///
/// # Errors
///
/// If the formula is not valid TeX, or uses unknown commands.
pub fn displayed(tex: &str) -> Result<String> {
    let converter = LatexToMathML::new(MathCoreConfig::default());
    let converter = converter.map_err(|_| anyhow!("the formulas use macros that are not TeX"))?;
    let mathml = converter.convert_with_local_counter(tex, MathDisplay::Block);
    let mathml = mathml.map_err(|error| anyhow!("the formula {tex}: {error}"))?;
    // A combining accent hangs over what is before it, which is nothing.
    Ok(mathml.replace(">\u{302}</mo>", ">^</mo>"))
}
