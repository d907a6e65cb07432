//! Dependencies allowed between crates.

use std::path::Path;

use anyhow::Result;

use crate::packages::{self, Dependency, Package};

/// For each library crate, the crates of the workspace on which it may depend. The façade, the
/// programs and the tests may depend on all.
const ARROWS: [(&str, &[&str]); 17] = [
    ("fairing-watch", &[]),
    ("fairing-parameters", &[]),
    ("fairing-mesh", &["fairing-watch", "fairing-parameters"]),
    ("fairing-shapes", &["fairing-mesh"]),
    ("fairing-sparse", &["fairing-watch"]),
    (
        "fairing-operators",
        &["fairing-watch", "fairing-parameters", "fairing-mesh", "fairing-sparse"],
    ),
    (
        "fairing-spectral",
        &["fairing-parameters", "fairing-mesh", "fairing-sparse", "fairing-operators"],
    ),
    (
        "fairing-smoothing",
        &[
            "fairing-watch",
            "fairing-parameters",
            "fairing-mesh",
            "fairing-sparse",
            "fairing-operators",
            "fairing-spectral",
        ],
    ),
    (
        "fairing-denoising",
        &[
            "fairing-watch",
            "fairing-parameters",
            "fairing-mesh",
            "fairing-sparse",
            "fairing-operators",
        ],
    ),
    (
        "fairing-evaluation",
        &["fairing-watch", "fairing-parameters", "fairing-mesh", "fairing-operators"],
    ),
    ("fairing-figure", &["fairing-watch", "fairing-parameters", "fairing-mesh"]),
    ("fairing-results", &["fairing-mesh"]),
    (
        "fairing-benchmark",
        &[
            "fairing-parameters",
            "fairing-mesh",
            "fairing-sparse",
            "fairing-operators",
            "fairing-shapes",
            "fairing-smoothing",
            "fairing-denoising",
            "fairing-evaluation",
            "fairing-figure",
        ],
    ),
    (
        "fairing-experiments",
        &[
            "fairing-benchmark",
            "fairing-mesh",
            "fairing-sparse",
            "fairing-operators",
            "fairing-spectral",
            "fairing-shapes",
            "fairing-smoothing",
            "fairing-denoising",
            "fairing-evaluation",
            "fairing-figure",
            "fairing-results",
        ],
    ),
    ("fairing-report", &["fairing-mesh", "fairing-figure", "fairing-results"]),
    (
        "fairing-reproduce",
        &[
            "fairing-mesh",
            "fairing-shapes",
            "fairing-results",
            "fairing-experiments",
            "fairing-report",
        ],
    ),
    (
        "fairing-web",
        &[
            "fairing",
            "fairing-watch",
            "fairing-parameters",
            "fairing-mesh",
            "fairing-shapes",
            "fairing-operators",
            "fairing-spectral",
            "fairing-smoothing",
            "fairing-denoising",
            "fairing-evaluation",
        ],
    ),
];

/// Crates that may depend on all others.
const FREE: [&str; 4] = ["fairing", "pyfairing", "xtask", "fairing-tests"];

/// Finds dependencies without an arrow. Those of tests only are free.
pub(super) fn check(root: &Path) -> Result<Vec<String>> {
    let packages = packages::read(root)?;
    let ours: Vec<&str> = packages.iter().map(|p| p.name.as_str()).collect();
    let mut broken = vec![];
    for Package { name, dependencies, .. } in &packages {
        if FREE.contains(&name.as_str()) {
            continue;
        }
        let Some((_, allowed)) = ARROWS.iter().find(|(n, _)| n == name) else {
            broken.push(format!("{name} has no place among the arrows"));
            continue;
        };
        for Dependency { name: used, kind, .. } in dependencies {
            let used = used.as_str();
            if kind.as_deref() != Some("dev") && ours.contains(&used) && !allowed.contains(&used) {
                broken.push(format!("{name} uses {used}"));
            }
        }
    }
    Ok(broken)
}
