//! The meshes that experiments load: the assignment's where they are found, our
//! generated stand-ins elsewhere.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context as _, Result, bail};
use fairing_mesh::TriMesh;
use fairing_results::results::Source;
use sha2::{Digest, Sha256};

/// A part that a mesh plays in the assignment.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Input {
    /// The open flower of questions 1 and 3.
    Flower,
    /// The flat grid of questions 1 and 3.
    Plane,
    /// The small closed model of question 4: its full spectrum is cheap.
    Armadillo,
    /// The same model with 25 thousand vertices.
    ArmadilloLarge,
    /// The noisy open patch of questions 5 and 6.
    NoisyPlane,
    /// The noisy machine part of questions 5 and 6.
    NoisyFandisk,
    /// The same part without noise, vertex for vertex; question 7.
    Fandisk,
    /// The simple cube of questions 5 to 7.
    Cube,
    /// A scanned animal; question 7.
    Scan,
    /// A noisy mesh of the literature on denoising.
    LiteratureNoisy(Pair),
    /// The same mesh without noise, face for face.
    LiteratureTrue(Pair),
}

/// A mesh on which denoisers are compared in the literature. The number is the
/// standard deviation of its noise in mean edge lengths.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Pair {
    /// A machine part, 0.3.
    FandiskLow,
    /// The same part, 0.7.
    FandiskHigh,
    /// A machine part with holes, 0.4.
    Block,
    /// A polyhedron, impulsive noise of 0.5.
    Twelve,
    /// A scanned bust, 0.2.
    Julius,
}

impl Pair {
    /// All of them.
    pub const ALL: [Self; 5] =
        [Self::FandiskLow, Self::FandiskHigh, Self::Block, Self::Twelve, Self::Julius];

    fn name(self) -> &'static str {
        match self {
            Self::FandiskLow => "fandisk-low",
            Self::FandiskHigh => "fandisk-high",
            Self::Block => "block",
            Self::Twelve => "twelve",
            Self::Julius => "julius",
        }
    }

    /// File, digest and stand-in of the noisy mesh.
    fn noisy(self) -> (&'static str, &'static str, Option<&'static str>) {
        match self {
            Self::FandiskLow => (
                "Fandisk0.3_noisy.obj",
                "acae4757eeb8efdd76f186b4d80318dc109f19302dcb5a7f5ab1d3812a7b2c2f",
                None,
            ),
            Self::FandiskHigh => (
                "Fandisk0.7_noisy.obj",
                "ce83ab470906858d3113044b27cc180f4addcc932f9ab9446b52438c00552faa",
                None,
            ),
            Self::Block => (
                "Block0.4_noisy.obj",
                "3e5ff9342a58517ec99727906d148977d14964045b778c1d1939a10c1b9f868d",
                None,
            ),
            Self::Twelve => (
                "Twelve0.5Impulsive_noisy.obj",
                "ae35fb3dd7ac7c4e2446714aaafec227d8e743cc406aee0e9dc80f273d903200",
                None,
            ),
            Self::Julius => (
                "Julius0.2_noisy.obj",
                "2fdf99e486bdf8e0fb77dd2785103ca9cf4203e8ed2697cf21b6450b79ef9944",
                None,
            ),
        }
    }

    /// File, digest and stand-in of the mesh without noise.
    fn truth(self) -> (&'static str, &'static str, Option<&'static str>) {
        match self {
            Self::FandiskLow | Self::FandiskHigh => (
                "Fandisk0.3_original.obj",
                "d05a56a399db3f8efdff97e95e9db18f055b26d86ef2922dc3f5b64d3e40a0ed",
                None,
            ),
            Self::Block => (
                "Block0.4_original.obj",
                "2d0f1ac29d97d0e4b08bf8827f63e13e97176b70e0303df44a570310ca555205",
                None,
            ),
            Self::Twelve => (
                "Twelve0.5Impulsive_original.obj",
                "4da595a329aa1d3f1ae4fe595e2bf2e289355a8af0e197a1fd1d47754db99cdc",
                None,
            ),
            Self::Julius => (
                "Julius0.2_original.obj",
                "de1b91d99dad06668dc29162e1a745b3d2f31c6ff90476e9ba0592c7c3b12b2b",
                None,
            ),
        }
    }
}

/// Names and digests of one input.
struct Known {
    /// The name of the assignment's file.
    file: &'static str,
    /// Its digest, so that another file of the same name is not taken for it.
    sha256: &'static str,
    /// The name of the stand-in in `data/`; some parts have none.
    stand_in: Option<&'static str>,
}

impl Input {
    /// Those with a stand-in, in the order of the questions.
    pub const WITH_STAND_IN: [Self; 8] = [
        Self::Flower,
        Self::Plane,
        Self::Armadillo,
        Self::ArmadilloLarge,
        Self::NoisyPlane,
        Self::NoisyFandisk,
        Self::Fandisk,
        Self::Cube,
    ];

    /// The name of the part in `results.json`.
    pub fn name(self) -> String {
        match self {
            Self::Flower => "flower".into(),
            Self::Plane => "plane".into(),
            Self::Armadillo => "armadillo".into(),
            Self::ArmadilloLarge => "armadillo-large".into(),
            Self::NoisyPlane => "noisy-plane".into(),
            Self::NoisyFandisk => "noisy-fandisk".into(),
            Self::Fandisk => "fandisk".into(),
            Self::Cube => "cube".into(),
            Self::Scan => "scan".into(),
            Self::LiteratureNoisy(pair) => format!("{}-noisy", pair.name()),
            Self::LiteratureTrue(pair) => format!("{}-true", pair.name()),
        }
    }

    fn known(self) -> Known {
        let (file, sha256, stand_in) = match self {
            Self::Flower => (
                "lilium_s.obj",
                "907a2122f6cc8e4f40c8aa79203f51cc0384aed7d9e5812ff1eb9bfbef848147",
                Some("flower.ply"),
            ),
            Self::Plane => (
                "plane.obj",
                "b26a07b8831e022a99de1a5a9d720537adc405eb00ba2250afcf61afc29ae30e",
                Some("plane.ply"),
            ),
            Self::Armadillo => (
                "armadillo.obj",
                "a79d32581c0c01b219b69026120f2054cbaf26465c8f0c5fae3c7a6d26c20333",
                Some("creature.ply"),
            ),
            Self::ArmadilloLarge => (
                "armadillo_25k.obj",
                "9ece90210ccd5ed58645f44a52dcd4fc4e339581c0e3d16c6b8166bc02725baf",
                Some("creature_25k.ply"),
            ),
            Self::NoisyPlane => (
                "plane_ns.obj",
                "a3046911dfd4fe5c588fb5a344e30910fb3c9780ae34d97efb7228660c231e6c",
                Some("plane_noisy.ply"),
            ),
            Self::NoisyFandisk => (
                "fandisk_ns.obj",
                "ffed02522f353d4314a9adca3386552c30a14578f531480c710fc8b78e350a6c",
                Some("block_noisy.ply"),
            ),
            Self::Fandisk => (
                "fandisk.off",
                "05bd799a78e7feece372b5b19787b7bc56c5f5e46888f998db23eaf30be2e443",
                Some("block.ply"),
            ),
            Self::Cube => (
                "cube.obj",
                "cccfb0498e91aaa1e83db7090a05d81ea9ada249f3175e758e0c6c74eec9491d",
                Some("cube.obj"),
            ),
            Self::Scan => (
                "bunny.obj",
                "12d26e804794001d1330143b7a2e5f3df9fd55f80176bcb40a11ac017241dd41",
                None,
            ),
            Self::LiteratureNoisy(pair) => pair.noisy(),
            Self::LiteratureTrue(pair) => pair.truth(),
        };
        Known { file, sha256, stand_in }
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
    pub fn locate(wanted: &[Input], data: &Path, meshes: Option<&Path>) -> Result<Self> {
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
                input: input.name(),
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
    ///
    /// # Errors
    ///
    /// If the file cannot be read as a mesh.
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
///
/// # Errors
///
/// If the file cannot be read.
pub fn file_sha256(path: &Path) -> Result<String> {
    let bytes = fs::read(path).with_context(|| format!("reading {}", path.display()))?;
    Ok(hex(&Sha256::digest(bytes)))
}

/// Bytes in hexadecimal.
pub fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|b| format!("{b:02x}")).collect()
}
