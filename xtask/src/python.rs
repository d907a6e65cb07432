//! The Python package: its wheel, and its tests in a virtual environment.

use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context as _, Result, ensure};

/// Packages that build the wheel; on Linux a linker for old versions of glibc, and audits.
const BUILD: &[&str] = match cfg!(target_os = "linux") {
    true => &["maturin>=1.9,<2", "abi3audit", "auditwheel", "ziglang"],
    false => &["maturin>=1.9,<2", "abi3audit"],
};
/// The oldest systems with glibc on which the wheel runs: RHEL 8, Debian 10, Ubuntu 20.04.
const MANYLINUX: &str = "manylinux_2_28";
/// The interpreter of a second wheel, where it is on the path: one without a global lock has no
/// stable interface.
const FREE_THREADED: &str = "python3.14t";
/// Packages required by the tests.
const TESTS: [&str; 5] = ["numpy", "scipy", "pytest", "pytest-xdist", "hypothesis"];
/// Packages required by single tests, which are skipped without them.
const PEERS: [&str; 8] =
    ["tqdm", "trimesh", "pygltflib", "meshio", "libigl", "robust_laplacian", "potpourri3d", "lapy"];
/// Packages for slow tests and tests of data sets, notebooks and types, likewise.
const MORE: [&str; 10] = [
    "mypy",
    // With its Node.js from the package index.
    "pyright[nodejs]",
    "matplotlib",
    "nbclient",
    "ipykernel",
    "dask[dataframe]",
    "distributed",
    "pandas",
    "pyarrow",
    "fsspec",
];

/// The tests of the package to run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Extent {
    /// The quick tests, on the library built in the workspace.
    Quick,
    /// All tests, on the wheel that users install.
    Whole,
}

/// The result of the tests.
#[derive(Debug)]
pub(crate) struct Tested {
    pub(crate) passed: bool,
    /// Skipped tests, each with the reason.
    pub(crate) skipped: Vec<(String, String)>,
}

/// A virtual environment.
struct Environment {
    folder: PathBuf,
}

impl Environment {
    /// The environment, created if there is none; or the reason for which it cannot be created.
    fn new(folder: PathBuf) -> Result<std::result::Result<Self, String>> {
        let environment = Self { folder };
        if environment.program("python").is_file() {
            return Ok(Ok(environment));
        }
        let version = "import sys; sys.exit(sys.version_info < (3, 10))";
        match Command::new("python3").args(["-c", version]).status() {
            Ok(status) if status.success() => {}
            Ok(_) => return Ok(Err("python3 is older than 3.10".to_owned())),
            Err(_) => return Ok(Err("there is no python3 on the path".to_owned())),
        }
        let venv = Command::new("python3").args(["-m", "venv"]).arg(&environment.folder).output();
        if !venv.context("running python3")?.status.success() {
            let _ = std::fs::remove_dir_all(&environment.folder);
            return Ok(Err("python3 has no venv with pip".to_owned()));
        }
        Ok(Ok(environment))
    }

    fn program(&self, name: &str) -> PathBuf {
        match cfg!(windows) {
            true => self.folder.join("Scripts").join(name).with_extension("exe"),
            false => self.folder.join("bin").join(name),
        }
    }

    /// Installs packages; returns `true` on success.
    fn install(&self, packages: &[&str]) -> Result<bool> {
        let note = self.folder.join("installed.txt");
        let installed = std::fs::read_to_string(&note).unwrap_or_default();
        let wanted: Vec<&str> =
            packages.iter().copied().filter(|p| installed.lines().all(|l| l != *p)).collect();
        if wanted.is_empty() {
            return Ok(true);
        }
        let pip = ["-m", "pip", "install", "--quiet", "--disable-pip-version-check"];
        let mut command = Command::new(self.program("python"));
        let output = command.args(pip).args(["--timeout=20", "--retries=1"]).args(&wanted).output();
        let succeeded = output.context("running pip")?.status.success();
        if succeeded {
            std::fs::write(&note, installed + &wanted.join("\n") + "\n")?;
        }
        Ok(succeeded)
    }
}

/// The environment that builds the wheel, or the reason for its absence.
fn builder(root: &Path) -> Result<std::result::Result<Environment, String>> {
    let environment = match Environment::new(root.join("target/python/build"))? {
        Ok(environment) => environment,
        Err(reason) => return Ok(Err(reason)),
    };
    Ok(match environment.install(BUILD)? {
        true => Ok(environment),
        false => {
            Err("pip cannot install maturin and its audits: there is no package index".to_owned())
        }
    })
}

/// Builds the wheel for all versions of Python, and beside it one for [`FREE_THREADED`]; returns
/// the first.
fn build(environment: &Environment, root: &Path) -> Result<Option<PathBuf>> {
    let folder = root.join("target/wheels");
    if folder.is_dir() {
        for entry in std::fs::read_dir(&folder)? {
            std::fs::remove_file(entry?.path())?;
        }
    }
    let mut maturin = Command::new(environment.program("maturin"));
    maturin.args(["build", "--release", "--locked", "--out"]).arg(&folder);
    if cfg!(target_os = "linux") {
        maturin.args(["--zig", "--compatibility", MANYLINUX]);
        // Finds the linker as a module of the environment.
        maturin.env("CARGO_ZIGBUILD_PYTHON_PATH", environment.program("python"));
    }
    maturin.arg("--interpreter").arg(environment.program("python"));
    if Command::new(FREE_THREADED).arg("--version").output().is_ok() {
        maturin.arg(FREE_THREADED);
    }
    if !maturin.current_dir(root.join("python")).status().context("running maturin")?.success() {
        return Ok(None);
    }
    let wheels = std::fs::read_dir(&folder)?.filter_map(|entry| Some(entry.ok()?.path()));
    let is_abi3 = |path: &PathBuf| {
        path.to_string_lossy().ends_with(".whl") && name_of(path).contains("-abi3-")
    };
    let mut found = wheels.filter(is_abi3);
    Ok(found.next())
}

/// The name of a file.
fn name_of(path: &Path) -> &str {
    path.file_name().and_then(|name| name.to_str()).unwrap_or_default()
}

/// Checks that the wheel uses no more of Python and of the C library than its name says.
fn audit(environment: &Environment, wheel: &Path) -> Result<()> {
    let run = |program: &str, arguments: &[&str]| -> Result<String> {
        let mut command = Command::new(environment.program(program));
        let output = command.args(arguments).arg(wheel).output();
        let output = output.with_context(|| format!("running {program}"))?;
        let [said, errors] = [output.stdout, output.stderr];
        let text = String::from_utf8_lossy(&[said, errors].concat()).into_owned();
        ensure!(output.status.success(), "{program}: {text}");
        Ok(text)
    };
    run("abi3audit", &["--strict"])?;
    if cfg!(target_os = "linux") {
        let tag = format!("{MANYLINUX}_{}", std::env::consts::ARCH);
        ensure!(name_of(wheel).contains(&tag), "{} is not for {tag}", name_of(wheel));
        // In words that are broken into lines.
        let said = run("auditwheel", &["show"])?;
        let consistent = said.split_whitespace().any(|word| word.contains(&tag));
        ensure!(consistent, "auditwheel: {said}");
    }
    Ok(())
}

/// Builds the wheel into `target/wheels` and audits it; returns its path, or the reason for which
/// there is no maturin.
pub(crate) fn wheel(root: &Path) -> Result<std::result::Result<PathBuf, String>> {
    let environment = match builder(root)? {
        Ok(environment) => environment,
        Err(reason) => return Ok(Err(reason)),
    };
    let wheel = build(&environment, root)?.context("maturin has not built a wheel")?;
    audit(&environment, &wheel)?;
    let size = std::fs::metadata(&wheel)?.len();
    println!("{} ({:.1} MB)", wheel.display(), size as f64 / 1e6);
    Ok(Ok(wheel))
}

/// Writes the source distribution into `target/sdist`; returns as [`wheel`] does.
pub(crate) fn sdist(root: &Path) -> Result<std::result::Result<PathBuf, String>> {
    let environment = match builder(root)? {
        Ok(environment) => environment,
        Err(reason) => return Ok(Err(reason)),
    };
    let folder = root.join("target/sdist");
    let mut maturin = Command::new(environment.program("maturin"));
    maturin.args(["sdist", "--out"]).arg(&folder).current_dir(root.join("python"));
    let status = maturin.status().context("running maturin")?;
    ensure!(status.success(), "maturin has not written a source distribution");
    let newest = std::fs::read_dir(&folder)?.filter_map(|entry| Some(entry.ok()?.path()));
    let newest = newest.max_by_key(|path| path.metadata().and_then(|about| about.modified()).ok());
    Ok(Ok(newest.context("there is no source distribution")?))
}

/// Puts the package together from its sources and the library that the workspace has built.
fn assemble(root: &Path) -> Result<PathBuf> {
    let folder = root.join("target/python/package");
    let package = folder.join("pyfairing");
    if package.is_dir() {
        std::fs::remove_dir_all(&package)?;
    }
    std::fs::create_dir_all(&package)?;
    for entry in std::fs::read_dir(root.join("python/pyfairing"))? {
        let path = entry?.path();
        if let Some(name) = path.file_name().filter(|_| path.is_file()) {
            std::fs::copy(&path, package.join(name))?;
        }
    }
    let built = format!("{}_core{}", std::env::consts::DLL_PREFIX, std::env::consts::DLL_SUFFIX);
    let built = root.join("target/debug").join(built);
    let name = if cfg!(windows) { "_core.pyd" } else { "_core.abi3.so" };
    std::fs::copy(&built, package.join(name))
        .with_context(|| format!("copying {}", built.display()))?;
    Ok(folder)
}

/// Builds the wheel and installs it; returns `true` if it was built.
fn install_wheel(root: &Path, maker: &Environment, environment: &Environment) -> Result<bool> {
    let Some(wheel) = build(maker, root)? else { return Ok(false) };
    let install = ["-m", "pip", "install", "--quiet", "--force-reinstall", "--no-deps"];
    let mut pip = Command::new(environment.program("python"));
    let status = pip.args(install).arg(&wheel).status().context("running pip")?;
    ensure!(status.success(), "pip cannot install {}", wheel.display());
    Ok(true)
}

/// Runs the tests of the package in a virtual environment, which is made where there is none.
pub(crate) fn test(root: &Path, extent: Extent) -> Result<Tested> {
    let nothing = |reason: String| Tested {
        passed: true,
        skipped: vec![("the Python package: every test".to_owned(), reason)],
    };
    let environment = match Environment::new(root.join("target/python/test"))? {
        Ok(environment) => environment,
        Err(reason) => return Ok(nothing(reason)),
    };
    if !environment.install(&TESTS)? {
        return Ok(nothing("pip cannot install pytest: there is no package index".to_owned()));
    }
    let mut skipped = vec![];
    let mut wanted = PEERS.to_vec();
    match extent {
        Extent::Quick => skipped.push((
            "the Python package: its wheel, slow tests, data sets, notebooks, types".to_owned(),
            "cargo xtask test --python runs them".to_owned(),
        )),
        Extent::Whole => wanted.extend(MORE),
    }
    // All at once where that works; a package that is not there must not take the others along.
    if !environment.install(&wanted)? {
        for package in wanted {
            if !environment.install(&[package])? {
                skipped
                    .push((format!("Python tests with {package}"), "pip cannot install it".into()));
            }
        }
    }
    // The program, not the module, which would put the sources before what is installed.
    let mut pytest = Command::new(environment.program("pytest"));
    pytest.args(["-p", "no:cacheprovider", "-rs"]).current_dir(root.join("python"));
    // Most tests keep one processor busy; those of a file share a cluster.
    pytest.args(["-n", "auto", "--dist", "loadfile"]);
    pytest.env("PYTHONDONTWRITEBYTECODE", "1");
    match extent {
        Extent::Quick => {
            let package = assemble(root)?;
            pytest.args(["-m", "not slow and not cluster"]).env("PYTHONPATH", package);
        }
        Extent::Whole => {
            let maker = match builder(root)? {
                Ok(maker) => maker,
                Err(reason) => return Ok(nothing(reason)),
            };
            if !install_wheel(root, &maker, &environment)? {
                return Ok(Tested { passed: false, skipped });
            }
            pytest.arg("--durations=10").env_remove("PYTHONPATH");
        }
    }
    let status = pytest.status().context("running pytest")?;
    Ok(Tested { passed: status.success(), skipped })
}
