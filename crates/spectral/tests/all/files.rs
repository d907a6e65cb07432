//! Spectra in files.

use fairing_operators::{Laplacian, LaplacianKind, MassKind};
use fairing_shapes as shapes;
use fairing_spectral::{Spectrum, SpectrumOptions, spectrum};

/// A damaged file is refused, or is read as if it were not damaged: dates and the like may change.
#[test]
fn damaged_files_are_refused() {
    let sphere = shapes::icosphere(1);
    let spectra = [MassKind::Barycentric, MassKind::Consistent].map(|mass| {
        let laplacian = Laplacian::new(&sphere, LaplacianKind::Cotangent, mass).unwrap();
        spectrum(&laplacian, 6, &SpectrumOptions::default()).unwrap()
    });
    // A generator of numbers by Knuth.
    let mut state = 1u64;
    let mut random = |below: usize| {
        state =
            state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % below
    };
    for found in spectra {
        let bytes = found.to_bytes().unwrap();
        assert_eq!(Spectrum::from_bytes(&bytes).unwrap(), found);
        let mut refused = 0;
        for _ in 0..5000 {
            let mut damaged = bytes.clone();
            for _ in 0..1 + random(3) {
                let at = random(bytes.len());
                damaged[at] ^= 1 + random(255) as u8;
            }
            match Spectrum::from_bytes(&damaged) {
                Ok(read) => assert_eq!(read, found),
                Err(_) => refused += 1,
            }
        }
        assert!(refused > 4000, "{refused}");
        // Every byte of the directory, in which names are.
        for at in bytes.len() - 600..bytes.len() {
            let mut damaged = bytes.clone();
            damaged[at] ^= 0x10;
            assert!(Spectrum::from_bytes(&damaged).map_or(true, |read| read == found), "{at}");
        }
        let followed = [&bytes[..], b"and more"].concat();
        let preceded = [b"before", &bytes[..]].concat();
        for other in [&followed, &preceded, &bytes[..bytes.len() - 1]] {
            assert!(Spectrum::from_bytes(other).is_err());
        }
    }
}
