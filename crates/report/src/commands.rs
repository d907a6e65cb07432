//! The commands of the program that do what a section does.

/// Those of each section, one a line; what follows `#` is a remark.
const COMMANDS: [(&str, &[&str]); 11] = [
    (
        "q1",
        &[
            "fairing smooth mesh.ply -o moved.ply --method explicit --lambda 1 --iterations 1  # each vertex moves by Δx",
            "fairing curvature mesh.ply -o curved.ply --estimator cotangent --area barycentric  # angle defect over area",
            "fairing render curved.ply -o gaussian.png --field gaussian --map coolwarm",
        ],
    ),
    (
        "q2",
        &[
            "fairing curvature ellipsoid.ply -o curved.ply --estimator jet3  # κ₁, κ₂ and directions of a mesh",
            "fairing curvature ellipsoid.ply --estimator cotangent --area mixed",
        ],
    ),
    (
        "q3",
        &[
            "fairing curvature mesh.ply -o curved.ply --estimator cotangent --area mixed",
            "fairing render curved.ply -o mean.png --field mean --map coolwarm",
        ],
    ),
    (
        "noise",
        &[
            "fairing noise mesh.ply -o noisy.ply --sigma 0.1 --kind axes --seed 2021  # σ in mean edge lengths",
            "fairing curvature noisy.ply -o curved.ply --estimator cotangent --area mixed",
        ],
    ),
    (
        "estimators",
        &[
            "fairing curvature --list  # all of them, with their parameters",
            "fairing curvature mesh.ply -o curved.ply --estimator jet3",
        ],
    ),
    (
        "q4",
        &[
            "fairing spectrum mesh.ply -k 50 -o modes.npz",
            "fairing reconstruct mesh.ply -k 15 -o rebuilt.ply",
        ],
    ),
    (
        "q5",
        &[
            "fairing smooth noisy.ply -o smooth.ply --method explicit --lambda 0.05 --iterations 50",
            "fairing compare smooth.ply truth.ply",
        ],
    ),
    (
        "q6",
        &[
            "fairing smooth noisy.ply -o smooth.ply --method implicit --lambda 5 --iterations 10",
            "fairing compare smooth.ply truth.ply",
        ],
    ),
    (
        "flows",
        &[
            "fairing smooth noisy.ply -o shrunk.ply --method implicit --weights cotangent --lambda 1",
            "fairing smooth noisy.ply -o kept.ply --method taubin  # keeps the volume",
            "fairing compare kept.ply truth.ply",
        ],
    ),
    (
        "q7",
        &[
            "fairing noise truth.ply -o noisy.ply --sigma 0.3 --kind axes",
            "fairing smooth noisy.ply -o smooth.ply --method explicit --lambda 0.5 --iterations 10",
            "fairing compare smooth.ply truth.ply",
        ],
    ),
    (
        "denoisers",
        &[
            "fairing denoise noisy.ply -o restored.ply  # no parameters",
            "fairing denoise noisy.ply -o guided.ply --method guided-normal",
            "fairing compare restored.ply truth.ply",
        ],
    ),
];

/// The commands of a section; `None` if it has none.
pub fn for_section(section: &str) -> Option<&'static [&'static str]> {
    COMMANDS.iter().find(|(id, _)| *id == section).map(|(_, commands)| *commands)
}

/// The sections that have commands.
pub fn sections() -> impl Iterator<Item = &'static str> {
    COMMANDS.iter().map(|(id, _)| *id)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::story;

    #[test]
    fn every_section_has_commands() {
        for section in story::ACTS.iter().flat_map(story::Act::ids) {
            assert!(for_section(section).is_some_and(|commands| !commands.is_empty()), "{section}");
        }
        assert_eq!(for_section("nothing"), None);
    }
}
