//! The `fairing` program: curvature, spectra, smoothing and denoising of
//! triangle meshes from the command line.

mod cli;

#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

fn main() -> std::process::ExitCode {
    cli::main()
}
