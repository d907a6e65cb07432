//! A compiler for WebAssembly: that of rustup, or Debian's packages in a folder of their own.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Result, ensure};

use crate::programs::succeeds;

pub(super) const TARGET: &str = "wasm32-unknown-unknown";

/// Unpacks Debian's compiler and the linker of its version of LLVM into the current folder.
const FETCH: &str = r#"
dependency() { apt-cache depends "$1" | sed -n "s/^ *Depends: \($2[0-9.]*\)$/\1/p" | head -n 1; }
library=$(dependency libstd-rust-web-dev libstd-rust-web-)
llvm=$(dependency "$library" libllvm)
version=${llvm#libllvm}
apt-get download rustc-web libstd-rust-web-dev rust-web-src "$library" "$llvm" "lld-$version"
for package in *.deb; do dpkg -x "$package" .; rm "$package"; done
mv "usr/bin/wasm-ld-$version" usr/bin/wasm-ld
"#;

/// A compiler with the target.
pub(super) enum Toolchain {
    /// The compiler that started this program.
    Installed,
    /// Debian's, unpacked below this folder; the standard library is compiled with it.
    Unpacked(PathBuf),
}

/// Returns true if the compiler that started this program has the target.
fn is_installed() -> bool {
    let rustc = std::env::var_os("RUSTC").unwrap_or_else(|| "rustc".into());
    let output =
        Command::new(rustc).args(["--print", "target-libdir", "--target", TARGET]).output();
    output.is_ok_and(|output| {
        output.status.success()
            && Path::new(String::from_utf8_lossy(&output.stdout).trim()).is_dir()
    })
}

/// Returns true if there is a compiler with the target, or packages with one.
pub(crate) fn is_available() -> bool {
    let package = Command::new("apt-cache").args(["show", "rustc-web"]).output();
    is_installed() || package.is_ok_and(|output| output.status.success())
}

impl Toolchain {
    /// The installed one, or else Debian's in this folder, fetched if it is not there.
    pub(super) fn find(folder: &Path) -> Result<Self> {
        if is_installed() {
            return Ok(Self::Installed);
        }
        let linker = folder.join("usr/bin/wasm-ld");
        if !linker.exists() {
            println!("fetching Debian's compiler for {TARGET} into {}", folder.display());
            let _ = fs::remove_dir_all(folder);
            fs::create_dir_all(folder)?;
            let fetched = succeeds(Command::new("sh").args(["-ec", FETCH]).current_dir(folder));
            ensure!(
                fetched.is_ok_and(|fetched| fetched) && linker.exists(),
                "the target {TARGET} is not installed (rustup target add {TARGET}), and Debian's \
                 packages, which would do as well, cannot be fetched"
            );
        }
        Ok(Self::Unpacked(folder.join("usr")))
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
