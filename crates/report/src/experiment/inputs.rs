//! The meshes that experiments load: the assignment's where they are found, our
//! generated stand-ins elsewhere.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use crate::model::results::Source;
use anyhow::{Context as _, Result, bail};
use fairing_mesh::TriMesh;
use sha2::{Digest, Sha256};

/// Names and digest of one input.
struct Known {
    /// The name of the part in `results.json`.
    name: &'static str,
    /// The name of the assignment's file.
    file: &'static str,
    /// The name of the stand-in in `data/`; some parts have none.
    stand_in: Option<&'static str>,
    /// The digest of the assignment's file, so that another file of the same name is not taken for
    /// it.
    sha256: &'static str,
}

/// Makes the enum of inputs from their names, files, stand-ins and digests.
macro_rules! inputs {
    ($($(#[$doc:meta])* $input:ident $name:literal, $file:literal, $stand_in:expr, $sha256:literal;)*) => {
        /// A part that a mesh plays in the assignment, or a mesh on which denoisers are compared in
        /// the literature; levels of noise are standard deviations in mean edge lengths.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
        pub enum Input {
            $($(#[$doc])* $input,)*
        }

        impl Input {
            const ALL: &'static [Self] = &[$(Self::$input),*];

            fn known(self) -> Known {
                match self {
                    $(Self::$input => {
                        Known { name: $name, file: $file, stand_in: $stand_in, sha256: $sha256 }
                    })*
                }
            }
        }
    };
}

inputs! {
    /// The open flower of questions 1 and 3.
    Flower "flower", "lilium_s.obj", Some("flower.ply"),
        "907a2122f6cc8e4f40c8aa79203f51cc0384aed7d9e5812ff1eb9bfbef848147";
    /// The flat grid of questions 1 and 3.
    Plane "plane", "plane.obj", Some("plane.ply"),
        "b26a07b8831e022a99de1a5a9d720537adc405eb00ba2250afcf61afc29ae30e";
    /// The small closed model of question 4: its full spectrum is cheap.
    Armadillo "armadillo", "armadillo.obj", Some("creature.ply"),
        "a79d32581c0c01b219b69026120f2054cbaf26465c8f0c5fae3c7a6d26c20333";
    /// The same model with 25 thousand vertices.
    ArmadilloLarge "armadillo-large", "armadillo_25k.obj", Some("creature_25k.ply"),
        "9ece90210ccd5ed58645f44a52dcd4fc4e339581c0e3d16c6b8166bc02725baf";
    /// The noisy open patch of questions 5 and 6.
    NoisyPlane "noisy-plane", "plane_ns.obj", Some("plane_noisy.ply"),
        "a3046911dfd4fe5c588fb5a344e30910fb3c9780ae34d97efb7228660c231e6c";
    /// The noisy machine part of questions 5 and 6.
    NoisyFandisk "noisy-fandisk", "fandisk_ns.obj", Some("block_noisy.ply"),
        "ffed02522f353d4314a9adca3386552c30a14578f531480c710fc8b78e350a6c";
    /// The same part without noise, vertex for vertex; question 7.
    Fandisk "fandisk", "fandisk.off", Some("block.ply"),
        "05bd799a78e7feece372b5b19787b7bc56c5f5e46888f998db23eaf30be2e443";
    /// The simple cube of questions 5 to 7.
    Cube "cube", "cube.obj", Some("cube.obj"),
        "cccfb0498e91aaa1e83db7090a05d81ea9ada249f3175e758e0c6c74eec9491d";
    /// A scanned animal; question 7.
    Scan "scan", "bunny.obj", None,
        "12d26e804794001d1330143b7a2e5f3df9fd55f80176bcb40a11ac017241dd41";
    /// A machine part with noise of 0.3.
    FandiskLowNoisy "fandisk-low-noisy", "Fandisk0.3_noisy.obj", None,
        "acae4757eeb8efdd76f186b4d80318dc109f19302dcb5a7f5ab1d3812a7b2c2f";
    /// The same part with noise of 0.7.
    FandiskHighNoisy "fandisk-high-noisy", "Fandisk0.7_noisy.obj", None,
        "ce83ab470906858d3113044b27cc180f4addcc932f9ab9446b52438c00552faa";
    /// A machine part with holes, with noise of 0.4.
    BlockNoisy "block-noisy", "Block0.4_noisy.obj", None,
        "3e5ff9342a58517ec99727906d148977d14964045b778c1d1939a10c1b9f868d";
    /// A polyhedron with impulsive noise of 0.5.
    TwelveNoisy "twelve-noisy", "Twelve0.5Impulsive_noisy.obj", None,
        "ae35fb3dd7ac7c4e2446714aaafec227d8e743cc406aee0e9dc80f273d903200";
    /// A scanned bust with noise of 0.2.
    JuliusNoisy "julius-noisy", "Julius0.2_noisy.obj", None,
        "2fdf99e486bdf8e0fb77dd2785103ca9cf4203e8ed2697cf21b6450b79ef9944";
    /// The mesh of [`FandiskLowNoisy`](Self::FandiskLowNoisy) without noise, face for face.
    FandiskLowTrue "fandisk-low-true", "Fandisk0.3_original.obj", None,
        "d05a56a399db3f8efdff97e95e9db18f055b26d86ef2922dc3f5b64d3e40a0ed";
    /// The mesh of [`FandiskHighNoisy`](Self::FandiskHighNoisy) without noise, face for face.
    FandiskHighTrue "fandisk-high-true", "Fandisk0.3_original.obj", None,
        "d05a56a399db3f8efdff97e95e9db18f055b26d86ef2922dc3f5b64d3e40a0ed";
    /// The mesh of [`BlockNoisy`](Self::BlockNoisy) without noise, face for face.
    BlockTrue "block-true", "Block0.4_original.obj", None,
        "2d0f1ac29d97d0e4b08bf8827f63e13e97176b70e0303df44a570310ca555205";
    /// The mesh of [`TwelveNoisy`](Self::TwelveNoisy) without noise, face for face.
    TwelveTrue "twelve-true", "Twelve0.5Impulsive_original.obj", None,
        "4da595a329aa1d3f1ae4fe595e2bf2e289355a8af0e197a1fd1d47754db99cdc";
    /// The mesh of [`JuliusNoisy`](Self::JuliusNoisy) without noise, face for face.
    JuliusTrue "julius-true", "Julius0.2_original.obj", None,
        "de1b91d99dad06668dc29162e1a745b3d2f31c6ff90476e9ba0592c7c3b12b2b";
}

impl Input {
    /// The inputs with a stand-in, in the order of the questions.
    pub fn with_stand_in() -> impl Iterator<Item = Self> {
        Self::ALL.iter().copied().filter(|input| input.stand_in().is_some())
    }

    /// The mesh with the same vertices: where that one has a stand-in, so has this one.
    fn partner(self) -> Option<Self> {
        match self {
            Self::NoisyFandisk => Some(Self::Fandisk),
            Self::Fandisk => Some(Self::NoisyFandisk),
            _ => None,
        }
    }

    /// The name of the assignment's file.
    pub fn file(self) -> &'static str {
        self.known().file
    }

    /// The name of the stand-in in `data/`, if there is one.
    pub fn stand_in(self) -> Option<&'static str> {
        self.known().stand_in
    }
}

/// All inputs, located and identified.
#[derive(Debug)]
pub struct Inputs {
    sources: BTreeMap<Input, (Source, PathBuf)>,
}

impl Inputs {
    /// Looks for the wanted meshes by the names of the assignment below
    /// `meshes`, and takes the stand-ins of the folder `data` for those that
    /// are not there. Parts that have no stand-in are absent then. The noisy machine part and
    /// the one without noise go together: both are the assignment's, or both stand-ins.
    ///
    /// # Errors
    ///
    /// If a folder cannot be read, a file has the right name and other
    /// contents, or a stand-in is missing.
    pub(crate) fn locate(wanted: &[Input], data: &Path, meshes: Option<&Path>) -> Result<Self> {
        let mut found: BTreeMap<String, Vec<PathBuf>> = BTreeMap::new();
        if let Some(folder) = meshes {
            collect(folder, &mut found)?;
        }
        let mut sources = BTreeMap::new();
        for &input in wanted {
            let known = input.known();
            let mut candidates = found.get(known.file).map_or(&[][..], Vec::as_slice);
            // Half of a pair has nothing to be compared with: vertices of one are not those of
            // the other's stand-in.
            if input.partner().is_some_and(|other| !found.contains_key(other.known().file)) {
                candidates = &[];
            }
            let (file, path, stand_in) = match (candidates, known.stand_in) {
                ([], Some(name)) => (name, data.join(name), true),
                ([], None) => continue,
                (paths, _) => (known.file, matching(paths, &known)?, false),
            };
            let (file, sha256) = (file.to_string(), file_sha256(&path)?);
            let source = Source {
                input: known.name.into(),
                file,
                sha256,
                stand_in,
                stands_for: known.file.into(),
            };
            sources.insert(input, (source, path));
        }
        Ok(Self { sources })
    }

    /// The names of the assignment's files whose parts stand-ins play.
    pub fn replaced(&self) -> Vec<&str> {
        let sources = self.sources.values().map(|(source, _)| source);
        sources.filter(|source| source.stand_in).map(|source| &source.stands_for[..]).collect()
    }

    /// Where this input came from; `None` if it is absent.
    pub fn source(&self, input: Input) -> Option<&Source> {
        self.sources.get(&input).map(|(source, _)| source)
    }

    fn entry(&self, input: Input) -> Result<&(Source, PathBuf)> {
        let missing = || {
            format!("{input:?} is absent, or not among the inputs on the card of the experiment")
        };
        self.sources.get(&input).with_context(missing)
    }

    /// Reads the mesh that plays this part.
    pub fn mesh(&self, input: Input) -> Result<TriMesh> {
        let (source, path) = self.entry(input)?;
        let read = fairing_mesh::io::read(path);
        Ok(read.with_context(|| format!("reading {}", source.file))?.mesh)
    }
}

/// The candidate with the expected contents.
fn matching(paths: &[PathBuf], known: &Known) -> Result<PathBuf> {
    let mut seen = vec![];
    for path in paths {
        let digest = file_sha256(path)?;
        if digest == known.sha256 {
            return Ok(path.clone());
        }
        seen.push(format!("{} has sha256 {digest}", path.display()));
    }
    bail!(
        "none of the files named {} is the assignment's (sha256 {}): {}",
        known.file,
        known.sha256,
        seen.join("; ")
    )
}

/// All files below a folder, by name.
fn collect(folder: &Path, found: &mut BTreeMap<String, Vec<PathBuf>>) -> Result<()> {
    let entries =
        fs::read_dir(folder).with_context(|| format!("reading folder {}", folder.display()))?;
    let mut paths = entries.map(|e| Ok(e?.path())).collect::<Result<Vec<_>>>()?;
    paths.sort();
    for path in paths {
        if path.is_dir() {
            collect(&path, found)?;
        } else if let Some(name) = path.file_name().and_then(|n| n.to_str()) {
            found.entry(name.to_string()).or_default().push(path);
        }
    }
    Ok(())
}

/// The SHA-256 digest of a file, in hexadecimal.
pub fn file_sha256(path: &Path) -> Result<String> {
    let bytes = fs::read(path).with_context(|| format!("reading {}", path.display()))?;
    Ok(hex(&Sha256::digest(bytes)))
}

/// Bytes in hexadecimal.
pub fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|b| format!("{b:02x}")).collect()
}
