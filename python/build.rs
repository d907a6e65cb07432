//! Linking on macOS, where symbols that the interpreter has must be allowed to be missing.

fn main() {
    pyo3_build_config::add_extension_module_link_args();
}
