#![no_main]

mod check;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    check::check("file.off", bytes, &fairing_mesh::io::ReadOptions::default());
});
