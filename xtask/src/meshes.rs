//! Where the real meshes are.

use std::path::PathBuf;

/// The folder that `FAIRING_MESHES` names; an empty name is none.
pub(crate) fn meshes_folder() -> Option<PathBuf> {
    std::env::var_os("FAIRING_MESHES").filter(|name| !name.is_empty()).map(PathBuf::from)
}
