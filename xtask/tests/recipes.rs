//! Recipes under "How to add" in `docs/architecture.md`, carried out in a copy of the workspace.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// A line to insert into a file before another.
struct Edit {
    path: &'static str,
    before: &'static str,
    line: &'static str,
}

/// A file to add and the edits that go with it.
struct Addition {
    /// The heading of the recipe.
    recipe: &'static str,
    /// The module of the table, whose tests the addition must pass.
    table: &'static str,
    file: (&'static str, &'static str),
    edits: &'static [Edit],
}

const FORMAT: Addition = Addition {
    recipe: "A file format",
    table: "io::format::",
    file: ("crates/mesh/src/io/dummy.rs", include_str!("recipes/format.rs")),
    edits: &[
        Edit { path: "crates/mesh/src/io/mod.rs", before: "mod error;", line: "mod dummy;" },
        Edit {
            path: "crates/mesh/src/io/format.rs",
            before: "}\n\n/// The format of a file by its name.",
            line: "    /// Three coordinates per corner.\n    Dummy = crate::io::dummy::FORMAT,",
        },
    ],
};

const ESTIMATOR: Addition = Addition {
    recipe: "An estimator of curvature",
    table: "curvature::estimator::",
    file: ("crates/operators/src/curvature/dummy.rs", include_str!("recipes/estimator.rs")),
    edits: &[
        Edit {
            path: "crates/operators/src/curvature/mod.rs",
            before: "mod estimator;",
            line: "mod dummy;",
        },
        Edit {
            path: "crates/operators/src/curvature/mod.rs",
            before: "pub use estimator::Estimator;",
            line: "pub use dummy::{DummyOptions, dummy_curvature};",
        },
        Edit {
            path: "crates/operators/src/curvature/estimator.rs",
            before: "use super::face_tensor",
            line: "use super::dummy::{DummyOptions, dummy_curvature};",
        },
        Edit {
            path: "crates/operators/src/curvature/estimator.rs",
            before: "        /// [`quadric_curvature`]",
            line: "        /// [`dummy_curvature`]\n        \
                   Dummy(DummyOptions) => |mesh, options| Ok(dummy_curvature(mesh, options)),",
        },
    ],
};

const FLOW: Addition = Addition {
    recipe: "A flow",
    table: "method::",
    file: ("crates/smoothing/src/flows/dummy.rs", include_str!("recipes/flow.rs")),
    edits: &[
        Edit {
            path: "crates/smoothing/src/flows/mod.rs",
            before: "pub(crate) mod explicit;",
            line: "pub(crate) mod dummy;",
        },
        Edit {
            path: "crates/smoothing/src/lib.rs",
            before: "pub use flows::hc::{Hc, hc};",
            line: "pub use flows::dummy::{Dummy, dummy};",
        },
        Edit {
            path: "crates/smoothing/src/method.rs",
            before: "use crate::flows::explicit::{Explicit, explicit};",
            line: "use crate::flows::dummy::{Dummy, dummy};",
        },
        Edit {
            path: "crates/smoothing/src/method.rs",
            before: "        /// [`hc`]",
            line: "        /// [`dummy`]\n        Dummy(Dummy) => dummy,",
        },
    ],
};

const DENOISER: Addition = Addition {
    recipe: "A denoiser",
    table: "denoiser::",
    file: ("crates/denoising/src/dummy.rs", include_str!("recipes/denoiser.rs")),
    edits: &[
        Edit { path: "crates/denoising/src/lib.rs", before: "mod error;", line: "mod dummy;" },
        Edit {
            path: "crates/denoising/src/lib.rs",
            before: "pub use error::DenoiseError;",
            line: "pub use dummy::{DummyOptions, dummy};",
        },
        Edit {
            path: "crates/denoising/src/denoiser.rs",
            before: "        /// [`l0`]",
            line: "        /// [`dummy`](crate::dummy)\n        \
                   Dummy(crate::DummyOptions) => crate::dummy,",
        },
    ],
};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// The numbered steps of a recipe.
fn steps(heading: &str) -> String {
    let map = fs::read_to_string(root().join("docs/architecture.md")).unwrap();
    let section = map.split("\n### ").find(|section| section.starts_with(heading));
    let section = section.unwrap_or_else(|| panic!("no recipe {heading:?}"));
    let steps = section.lines().filter(|line| line.starts_with(|c: char| c.is_ascii_digit()));
    steps.collect::<Vec<_>>().join("\n")
}

/// Copies what is under version control; files that are the same stay, so that only what has
/// changed since the last run compiles again.
fn copy_to(folder: &Path) {
    let output = Command::new("git").args(["ls-files", "-z"]).current_dir(root()).output().unwrap();
    let paths = String::from_utf8(output.stdout).unwrap();
    for path in paths.split('\0').filter(|path| root().join(path).is_file()) {
        write_changed(&folder.join(path), &fs::read(root().join(path)).unwrap());
    }
}

/// Writes a file unless it has this content.
fn write_changed(path: &Path, content: &[u8]) {
    if fs::read(path).is_ok_and(|found| found == content) {
        return;
    }
    fs::create_dir_all(path.parent().unwrap()).unwrap();
    fs::write(path, content).unwrap();
}

/// Adds the file and the lines, all of which the recipe names.
fn add(addition: &Addition, folder: &Path) {
    let Addition { recipe, file: (path, text), edits, .. } = addition;
    let steps = steps(recipe);
    let home = Path::new(path).parent().unwrap().to_str().unwrap();
    assert!(steps.contains(&format!("`{home}`")), "{recipe} does not name {home}");
    write_changed(&folder.join(path), text.as_bytes());
    for Edit { path, before, line } in *edits {
        assert!(steps.contains(&format!("`{path}`")), "{recipe} does not name {path}");
        let file = folder.join(path);
        let text = fs::read_to_string(&file).unwrap();
        assert_eq!(text.matches(before).count(), 1, "{before:?} in {path}");
        fs::write(&file, text.replace(before, &format!("{line}\n{before}"))).unwrap();
    }
}

/// The packages of the workspace.
fn packages() -> Vec<String> {
    let folders = fs::read_dir(root().join("crates")).unwrap();
    let names = folders.map(|entry| entry.unwrap().file_name().into_string().unwrap());
    names.map(|name| if name == "fairing" { name } else { format!("fairing-{name}") }).collect()
}

/// Carries out the recipes in one copy: the packages compile without a warning and pass the tests
/// of their tables.
#[test]
fn each_is_one_file_and_a_few_lines() {
    let additions = [FORMAT, ESTIMATOR, FLOW, DENOISER];
    let folder = root().join("target/recipes");
    copy_to(&folder);
    let mut cargo = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    // All default members, in the folder of the workspace: what is not ours is compiled there, with
    // the same features.
    cargo.args(["test", "--lib", "--offline", "--target-dir"]).arg(root().join("target"));
    cargo.current_dir(&folder);
    additions.iter().for_each(|addition| add(addition, &folder));
    // Of ours little is computed, so nothing is optimised.
    for name in packages() {
        cargo.args(["--config", &format!("profile.dev.package.{name}.opt-level=0")]);
    }
    let output = cargo.arg("--").args(additions.iter().map(|a| a.table)).output().unwrap();
    let text = [output.stdout, output.stderr].concat();
    let text = String::from_utf8_lossy(&text);
    assert!(output.status.success() && !text.contains("warning:"), "{text}");
    // No test at all would be a wrong name of a table.
    assert!(additions.iter().all(|a| text.contains(&format!("test {}", a.table))), "{text}");
}
