//! The `fairing` program: curvature, spectra, smoothing and denoising of
//! triangle meshes from the command line.

mod cli;

fn main() -> std::process::ExitCode {
    cli::main()
}
