//! The Python package: its wheel, and its tests in a virtual environment.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context as _, Result, ensure};

use crate::programs::{UNOPTIMISED, cargo, on_path, skip, succeeds};

/// The folder of the environment of the tests.
const ENVIRONMENT: &str = "target/python/test";
/// Packages that build the wheel: for Linux with a linker for old versions of glibc.
const BUILD: &str = "maturin>=1.9,<2 ziglang";
/// The oldest systems with glibc on which the wheel runs: RHEL 8, Debian 10, Ubuntu 20.04. Maturin
/// refuses a wheel that needs more.
const MANYLINUX: &str = "manylinux_2_28";
/// The interpreter of a second wheel, where it is on the path: one without a global lock has no
/// stable interface.
const FREE_THREADED: &str = "python3.14t";
/// Packages required by the tests.
const TESTS: &str = "numpy scipy pytest pytest-xdist hypothesis";
/// Packages required by single tests, which are skipped without them; pyright with its Node.js from
/// the package index.
const PEERS: &str = "tqdm trimesh pygltflib meshio libigl robust_laplacian potpourri3d lapy mypy \
                     pyright[nodejs] matplotlib nbclient ipykernel dask[dataframe] distributed \
                     pandas pyarrow fsspec pyvista vedo";

/// A virtual environment.
struct Environment {
    folder: PathBuf,
}

impl Environment {
    /// The environment in a folder, created if there is none, with packages.
    fn new(folder: PathBuf, packages: &str) -> Result<Self> {
        let environment = Self { folder };
        if !environment.program("python").is_file() {
            let version = "import sys; sys.exit(sys.version_info < (3, 10))";
            let python = || Command::new("python3");
            let is_new = succeeds(python().args(["-c", version]))?;
            ensure!(is_new, "python3 is older than 3.10");
            let venv = python().args(["-m", "venv"]).arg(&environment.folder).output()?;
            if !venv.status.success() {
                let _ = fs::remove_dir_all(&environment.folder);
            }
            ensure!(venv.status.success(), "python3 has no venv with pip");
        }
        ensure!(environment.install(packages)?, "pip cannot install {packages}: no package index?");
        Ok(environment)
    }

    fn program(&self, name: &str) -> PathBuf {
        let folder = self.folder.join(if cfg!(windows) { "Scripts" } else { "bin" });
        folder.join(format!("{name}{}", std::env::consts::EXE_SUFFIX))
    }

    /// Installs packages that are not there; returns `true` on success.
    fn install(&self, packages: &str) -> Result<bool> {
        let mut pip = self.pip();
        let output =
            pip.args(["--timeout=20", "--retries=1"]).args(packages.split_whitespace()).output();
        Ok(output.context("running pip")?.status.success())
    }

    fn pip(&self) -> Command {
        let mut pip = Command::new(self.program("python"));
        pip.args(["-m", "pip", "install", "--quiet", "--disable-pip-version-check"]);
        pip
    }
}

/// Builds the wheel for all versions of Python into `target/wheels` with a profile, and beside it
/// one for [`FREE_THREADED`]; prints and returns the path of the first.
pub(crate) fn wheel(root: &Path, profile: &str) -> Result<PathBuf> {
    let environment = Environment::new(root.join("target/python/build"), BUILD)?;
    let folder = root.join("target/wheels");
    if folder.is_dir() {
        fs::remove_dir_all(&folder)?;
    }
    let mut maturin = Command::new(environment.program("maturin"));
    maturin.args(["build", "--profile", profile, "--locked", "--out"]).arg(&folder);
    if cfg!(target_os = "linux") {
        maturin.args(["--zig", "--compatibility", MANYLINUX]);
        // Finds the linker as a module of the environment.
        maturin.env("CARGO_ZIGBUILD_PYTHON_PATH", environment.program("python"));
    }
    maturin.arg("--interpreter").arg(environment.program("python"));
    if on_path(FREE_THREADED) {
        maturin.arg(FREE_THREADED);
    }
    let built = succeeds(maturin.current_dir(root.join("python")))?;
    ensure!(built, "maturin has not built a wheel");
    let mut wheels = fs::read_dir(&folder)?.filter_map(|entry| Some(entry.ok()?.path()));
    let wheel = wheels.find(|path| path.to_string_lossy().contains("-cp310-abi3-"));
    let wheel = wheel.context("maturin has not built a wheel for Python 3.10 and later")?;
    println!("{} ({:.1} MB)", wheel.display(), fs::metadata(&wheel)?.len() as f64 / 1e6);
    Ok(wheel)
}

/// Puts the package, its sources and the library that the workspace has built, into the
/// environment.
fn assemble(root: &Path, environment: &Environment) -> Result<()> {
    let place = "import sysconfig; print(sysconfig.get_path('platlib'), end='')";
    let output = Command::new(environment.program("python")).args(["-c", place]).output()?;
    let package = Path::new(&String::from_utf8(output.stdout)?).join("pyfairing");
    if package.is_dir() {
        fs::remove_dir_all(&package)?;
    }
    for folder in ["", "grade"] {
        fs::create_dir_all(package.join(folder))?;
        for entry in fs::read_dir(root.join("python/pyfairing").join(folder))? {
            let path = entry?.path();
            if let Some(name) = path.file_name().filter(|_| path.is_file()) {
                fs::copy(&path, package.join(folder).join(name))?;
            }
        }
    }
    let built = format!("{}_core{}", std::env::consts::DLL_PREFIX, std::env::consts::DLL_SUFFIX);
    let built = root.join("target/debug").join(built);
    let name = if cfg!(windows) { "_core.pyd" } else { "_core.abi3.so" };
    let copied = fs::copy(&built, package.join(name));
    copied.with_context(|| format!("copying {}", built.display()))?;
    Ok(())
}

/// Runs the tests of the package in a virtual environment, on the library in the profile of the
/// other tests; names what is skipped.
pub(crate) fn test(root: &Path) -> Result<()> {
    let environment = match Environment::new(root.join(ENVIRONMENT), TESTS) {
        Ok(environment) => environment,
        Err(error) => {
            skip("the Python package", &format!("{error:#}"));
            return Ok(());
        }
    };
    // All at once if possible; otherwise one by one, so that a package that is missing does not
    // prevent the others.
    if !environment.install(PEERS)? {
        for package in PEERS.split_whitespace() {
            if !environment.install(package)? {
                skip(&format!("Python tests with {package}"), "pip cannot install it");
            }
        }
    }
    // With the features that its dependencies have in the other tests.
    let built = succeeds(cargo(root).args(["build", "--workspace", "--lib", "--locked"]))?;
    ensure!(built, "the library for Python does not compile");
    assemble(root, &environment)?;
    pytest(root, &environment, &["-n", "auto", "--dist", "loadfile", "--durations=10"])
}

/// Builds the wheel, without optimisation, installs it as a user would, and compares its metadata.
pub(crate) fn install(root: &Path) -> Result<()> {
    let wheel = wheel(root, UNOPTIMISED)?;
    let environment = Environment::new(root.join(ENVIRONMENT), TESTS)?;
    let mut install = environment.pip();
    install.args(["--force-reinstall", "--no-deps"]).arg(&wheel);
    ensure!(succeeds(&mut install)?, "pip cannot install {}", wheel.display());
    pytest(root, &environment, &["tests/test_documentation.py", "-k", "metadata or laboratory"])
}

/// Runs pytest on the installed package.
fn pytest(root: &Path, environment: &Environment, arguments: &[&str]) -> Result<()> {
    // The program, not the module, which would put the sources before what is installed.
    let mut pytest = Command::new(environment.program("pytest"));
    pytest.args(["-p", "no:cacheprovider", "-rs"]).args(arguments);
    pytest.current_dir(root.join("python")).env_remove("PYTHONPATH");
    pytest.env("PYTHONDONTWRITEBYTECODE", "1");
    ensure!(succeeds(&mut pytest)?, "pytest has found failures");
    Ok(())
}
