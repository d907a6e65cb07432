//! The scripts of the pages.

use anyhow::Result;
use fairing_figure::VIEWER;
use fairing_figure::bundle::{Module, bundle};

/// The modules of the report, of the laboratory and of their worker.
const OWN: [Module<'static>; 27] = {
    macro_rules! modules {
        ($($path:literal),*) => {
            [$(($path, include_str!(concat!("../../../../", $path)))),*]
        };
    }
    modules![
        "report/assets/computing.mjs",
        "report/assets/data.mjs",
        "report/assets/denoising.mjs",
        "report/assets/derived.mjs",
        "report/assets/diffusion.mjs",
        "report/assets/ellipsoid.mjs",
        "report/assets/factors.mjs",
        "report/assets/fitted.mjs",
        "report/assets/laboratory/form.mjs",
        "report/assets/laboratory/lab.mjs",
        "report/assets/laboratory/programs.mjs",
        "report/assets/laboratory/words.mjs",
        "report/assets/live.mjs",
        "report/assets/modes.mjs",
        "report/assets/noise.mjs",
        "report/assets/page.mjs",
        "report/assets/playground.mjs",
        "report/assets/plots.mjs",
        "report/assets/points.mjs",
        "report/assets/stack.mjs",
        "report/assets/surfaces.mjs",
        "report/assets/theme.mjs",
        "report/assets/view.mjs",
        "web/assets/client.mjs",
        "web/assets/engine.mjs",
        "web/assets/page.mjs",
        "web/assets/worker.mjs"
    ]
};

/// The module at `entry` with all that it imports, as one script.
pub(super) fn script(entry: &str) -> Result<String> {
    Ok(bundle(entry, &[&VIEWER[..], &OWN].concat())?)
}
