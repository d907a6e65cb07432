#![no_main]

mod check;

use fairing_mesh::io::ReadOptions;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let mut options = ReadOptions::default();
    options.max_unpacked_bytes = 1 << 20;
    // Damaged streams, and sound ones that hold a damaged mesh.
    for prefix in [&b""[..], &[0x1f, 0x8b, 8, 0, 0, 0, 0, 0, 0, 0xff]] {
        check::check("file.ply.gz", &[prefix, bytes].concat(), &options);
        check::check("", &[prefix, bytes].concat(), &options);
    }
});
