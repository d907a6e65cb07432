//! The section of the article about reconstruction.

use crate::model::section::{Act, Section};

/// The section of the article.
pub(super) fn section() -> Section {
    Section::new(
        Act::Spectrum,
        "The same matrix that gave curvature has eigenvectors, and they form a basis for every \
            function on the mesh, its positions included. How many does a shape need?",
    )
    .commands(&[
        "fairing spectrum mesh.ply -k 50 -o modes.npz",
        "fairing reconstruct mesh.ply -k 15 -o rebuilt.ply",
    ])
    .edge_lengths_of("each mesh")
    .sources(&["vallet2008", "karni2000", "reuter2006"])
    .notation(&["x", "X", "i", "j", "S", "M", "\\varphi", "\\omega", "\\delta", "k"])
    .shows(&["modes-view", "decay", "rebuilt"], &[])
    .names(&[
        ("eigenvalues", "eigenvalues under refinement"),
        ("armadillo-view", "the armadillo from k modes"),
        ("large-armadillo-view", "the large armadillo from k modes"),
        ("armadillo-modes", "modes of the armadillo"),
        ("small-creature-view", "the small creature from k modes"),
        ("large-creature-view", "the large creature from k modes"),
        ("bumpy-ball-view", "the bumpy ball from k modes"),
        ("small-creature-modes", "modes of the small creature"),
        ("reconstruction", "error over k"),
        ("weyl", "Weyl's law"),
        ("sphere", "eigenvalues of the sphere"),
        ("torus", "eigenvalues of the torus"),
    ])
}
