//! A compiler for WebAssembly: that of rustup, or Debian's packages in a folder of their own.

use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context as _, Result, bail, ensure};

pub(crate) const TARGET: &str = "wasm32-unknown-unknown";

/// A compiler with the target.
pub(super) enum Toolchain {
    /// The one that runs us.
    Installed,
    /// Debian's, unpacked below this folder; the standard library is compiled with it.
    Unpacked(PathBuf),
}

/// Returns true if the compiler that runs us has the target.
pub(crate) fn is_installed() -> bool {
    let rustc = std::env::var_os("RUSTC").unwrap_or_else(|| "rustc".into());
    let output =
        Command::new(rustc).args(["--print", "target-libdir", "--target", TARGET]).output();
    output.is_ok_and(|output| {
        output.status.success()
            && Path::new(String::from_utf8_lossy(&output.stdout).trim()).is_dir()
    })
}

impl Toolchain {
    /// The installed one, or else Debian's in this folder, fetched if it is not there.
    pub(super) fn find(folder: &Path) -> Result<Self> {
        if is_installed() {
            return Ok(Self::Installed);
        }
        let root = folder.join("usr");
        if !folder.join("complete").is_file() {
            fetch(folder).with_context(|| {
                format!(
                    "the target {TARGET} is not installed (rustup target add {TARGET}), and \
                     Debian's packages, which would do as well, cannot be fetched"
                )
            })?;
        }
        Ok(Self::Unpacked(root))
    }

    /// Makes cargo use this compiler.
    pub(super) fn prepare(&self, cargo: &mut Command) {
        let Self::Unpacked(root) = self else { return };
        let libraries = fs::read_dir(root.join("lib")).into_iter().flatten().flatten();
        let libraries = libraries.map(|entry| entry.path()).filter(|path| path.is_dir());
        let paths = libraries.flat_map(|path| [path.join("lib"), path]);
        if let Ok(paths) = std::env::join_paths(paths) {
            cargo.env("LD_LIBRARY_PATH", paths);
        }
        cargo.env("RUSTC", root.join("bin/rustc"));
        cargo.env("CARGO_TARGET_WASM32_UNKNOWN_UNKNOWN_LINKER", root.join("bin/wasm-ld"));
        // The packages have the source of the standard library only.
        cargo.env("RUSTC_BOOTSTRAP", "1").arg("-Zbuild-std=std,panic_abort");
    }
}

/// Unpacks Debian's compiler for browsers, and its linker.
fn fetch(folder: &Path) -> Result<()> {
    let _ = fs::remove_dir_all(folder);
    fs::create_dir_all(folder)?;
    let library = dependency("libstd-rust-web-dev", "libstd-rust-web-")?;
    let llvm = dependency(&library, "libllvm")?;
    let version = llvm.trim_start_matches("libllvm").to_owned();
    let linker = format!("lld-{version}");
    let packages = ["rustc-web", "libstd-rust-web-dev", "rust-web-src", &library, &llvm, &linker];
    println!("fetching {}", packages.join(", "));
    run(Command::new("apt-get").arg("download").args(packages).current_dir(folder))?;
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        if path.extension().is_some_and(|extension| extension == "deb") {
            run(Command::new("dpkg").arg("-x").arg(&path).arg(folder))?;
            fs::remove_file(&path)?;
        }
    }
    let versioned = folder.join(format!("usr/bin/wasm-ld-{version}"));
    ensure!(versioned.exists(), "{linker} has no {}", versioned.display());
    fs::rename(versioned, folder.join("usr/bin/wasm-ld"))?;
    Ok(fs::write(folder.join("complete"), "")?)
}

/// The package with this prefix on which a package depends.
fn dependency(package: &str, prefix: &str) -> Result<String> {
    let mut command = Command::new("apt-cache");
    let output = command.args(["depends", package]).output().context("running apt-cache")?;
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    let names = text.lines().filter_map(|line| line.trim().strip_prefix("Depends: "));
    match names.map(str::to_owned).find(|name| name.starts_with(prefix)) {
        Some(name) => Ok(name),
        None => bail!("apt knows no package {package} that depends on {prefix}…: apt-get update"),
    }
}

fn run(command: &mut Command) -> Result<()> {
    let name: OsString = command.get_program().to_owned();
    let output = command.output().with_context(|| format!("running {}", name.display()))?;
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    ensure!(output.status.success(), "{}: {}", name.display(), said.trim());
    Ok(())
}
