//! Spectra in files that numpy reads: `numpy.load("modes.npz")["modes"]`.

use std::fmt::Display;
use std::fs::File;
use std::io::{self, Cursor, Read, Seek, SeekFrom, Write};
use std::path::Path;

use fairing_mesh::io::{ReadError, ReadProblem, WriteError, WriteProblem, write_whole};
use fairing_operators::MassMatrix;
use fairing_sparse::{Beyond, SparseMatrix};
use ndarray::Array2;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipArchive, ZipWriter};

use crate::npy::{Kind, Npy};
use crate::spectrum::Spectrum;

impl Spectrum {
    /// Writes `values` (k), `modes` (n × k), `residuals` (k), `certified` (1 or 0), `beyond` and
    /// `clear_below` as in [`Beyond`], and the mass: `mass` (n) if lumped, or `mass_indptr`,
    /// `mass_indices`, `mass_data` (CSR) if consistent. The file is written whole or not at all.
    ///
    /// # Errors
    ///
    /// [`WriteProblem::Io`].
    pub fn save(&self, path: impl AsRef<Path>) -> Result<(), WriteError> {
        let path = path.as_ref();
        write_whole(path, |file| self.write(file)).map_err(|error| unwritable(path, error))
    }

    /// The bytes of the file that [`Spectrum::save`] writes.
    ///
    /// # Errors
    ///
    /// [`WriteProblem::Io`] for arrays that the format cannot hold.
    pub fn to_bytes(&self) -> Result<Vec<u8>, WriteError> {
        let mut bytes = Cursor::new(vec![]);
        self.write(&mut bytes).map_err(|error| unwritable(Path::new(MEMORY), error))?;
        Ok(bytes.into_inner())
    }

    fn write(&self, file: impl Write + Seek) -> io::Result<()> {
        let mut zip = ZipWriter::new(UntilError { file, failed: false });
        let mut add = |name: &str, array: Npy| -> io::Result<()> {
            // Not compressed, as by numpy.savez. Arrays may exceed 4 GiB.
            let stored = SimpleFileOptions::default().compression_method(CompressionMethod::Stored);
            zip.start_file(format!("{name}.npy"), stored.large_file(true))
                .map_err(io::Error::other)?;
            array.write(&mut zip)
        };
        add("values", Npy::floats(&self.values))?;
        add("residuals", Npy::floats(&self.residuals))?;
        add("certified", Npy::floats(&[f64::from(u8::from(self.certified))]))?;
        add("beyond", Npy::floats(&self.beyond.values))?;
        add("clear_below", Npy::floats(&[self.beyond.clear_below]))?;
        match &self.mass {
            MassMatrix::Lumped(diagonal) => add("mass", Npy::floats(diagonal))?,
            MassMatrix::Consistent(matrix) => {
                add("mass_data", Npy::floats(matrix.data()))?;
                add("mass_indptr", Npy::indices(matrix.indptr().raw_storage()))?;
                add("mass_indices", Npy::indices(matrix.indices()))?;
            }
        }
        add("modes", Npy::matrix(&self.modes))?;
        zip.finish().map_err(io::Error::other)?;
        Ok(())
    }

    /// Reads a file of [`Spectrum::save`]. Without the arrays `beyond` and `clear_below`, nothing
    /// is known after the last eigenvalue.
    ///
    /// # Errors
    ///
    /// [`ReadProblem::Io`] if the system cannot open the file; [`ReadProblem::Unexpected`] for an
    /// array that is missing, has another type or does not match its checksum, for inconsistent
    /// shapes, unknown arrays, and bytes before or after the archive.
    pub fn load(path: impl AsRef<Path>) -> Result<Self, ReadError> {
        let path = path.as_ref();
        let file = File::open(path).map_err(|error| unreadable(path, ReadProblem::Io(error)))?;
        Self::read(path, file)
    }

    /// Reads the bytes of [`Spectrum::to_bytes`].
    ///
    /// # Errors
    ///
    /// [`ReadProblem::Unexpected`], as [`Spectrum::load`].
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, ReadError> {
        Self::read(Path::new(MEMORY), Cursor::new(bytes))
    }

    fn read(path: &Path, mut file: impl Read + Seek) -> Result<Self, ReadError> {
        let whole = ends_as_archive(&mut file).map_err(|e| in_part(path, ARCHIVE, e))?;
        let mut zip = ZipArchive::new(file).map_err(|e| in_part(path, ARCHIVE, e))?;
        if !whole || zip.offset() != 0 {
            return Err(problem(path, "bytes before or after the archive"));
        }
        let names: Vec<String> = zip.file_names().map(str::to_string).collect();
        let has = |name: &str| names.iter().any(|n| n.strip_suffix(".npy") == Some(name));
        // A damaged name must not pass for a missing optional array.
        if !names.iter().all(|n| n.strip_suffix(".npy").is_some_and(|n| ARRAYS.contains(&n))) {
            return Err(problem(path, "an array of an unknown name"));
        }
        let mut array = |name: &str, kind: Kind| -> Result<Npy, ReadError> {
            let member = format!("{name}.npy");
            let mut file = zip.by_name(&member).map_err(|e| in_part(path, name, e))?;
            let size = file.size();
            let array = Npy::read(&mut file, size, kind).map_err(|e| in_part(path, name, e))?;
            // The checksum is verified at the end of a member.
            match io::copy(&mut file, &mut io::sink()) {
                Ok(0) => Ok(array),
                Ok(_) => Err(problem(path, "an array followed by other bytes")),
                Err(e) => Err(in_part(path, name, e)),
            }
        };
        let mut vector = |name: &str| array(name, Kind::Float).map(Npy::into_floats);
        let (values, residuals) = (vector("values")?, vector("residuals")?);
        let certified = vector("certified")? == [1.0];
        let beyond = if has("beyond") || has("clear_below") {
            let clear_below = vector("clear_below")?.first().copied();
            let clear_below =
                clear_below.ok_or_else(|| problem(path, "an empty array clear_below"))?;
            Beyond::new(vector("beyond")?, clear_below)
        } else {
            Beyond::new(vec![], values.last().copied().unwrap_or(0.0))
        };
        let modes = array("modes", Kind::Float)?.into_matrix();
        let modes: Array2<f64> =
            modes.ok_or_else(|| problem(path, "an array modes that is no matrix"))?;
        let n = modes.nrows();
        let mass = if has("mass") {
            MassMatrix::Lumped(array("mass", Kind::Float)?.into_floats())
        } else {
            let data = array("mass_data", Kind::Float)?.into_floats();
            let starts = array("mass_indptr", Kind::Index)?.into_indices();
            let columns = array("mass_indices", Kind::Index)?.into_indices();
            let matrix = SparseMatrix::try_new((n, n), starts, columns, data);
            MassMatrix::Consistent(matrix.map_err(|(.., e)| in_part(path, "mass", e))?)
        };
        let k = values.len();
        let finite = values.iter().chain(&modes).chain(&residuals).all(|x| x.is_finite())
            && beyond.values.iter().all(|x| x.is_finite())
            && !beyond.clear_below.is_nan();
        if modes.ncols() != k || residuals.len() != k || mass.as_mass().len() != n || !finite {
            return Err(problem(path, "arrays that do not fit together"));
        }
        Ok(Self { values, modes, residuals, mass, certified, beyond })
    }
}

/// A file that fails once and then swallows what is written: when an archive is dropped, it writes
/// its directory, and would print a second error.
struct UntilError<F> {
    file: F,
    failed: bool,
}

impl<F> UntilError<F> {
    /// The result of an operation, or `otherwise` after an error.
    fn attempt<T>(
        &mut self,
        otherwise: T,
        operation: impl FnOnce(&mut F) -> io::Result<T>,
    ) -> io::Result<T> {
        if self.failed {
            return Ok(otherwise);
        }
        let result = operation(&mut self.file);
        // An interrupted write is tried again.
        self.failed = result.as_ref().is_err_and(|e| e.kind() != io::ErrorKind::Interrupted);
        result
    }
}

impl<F: Write> Write for UntilError<F> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.attempt(bytes.len(), |file| file.write(bytes))
    }

    fn flush(&mut self) -> io::Result<()> {
        self.attempt((), F::flush)
    }
}

impl<F: Seek> Seek for UntilError<F> {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.attempt(0, |file| file.seek(to))
    }
}

/// Name of bytes in memory, in messages.
const MEMORY: &str = "spectrum in memory";

/// The names of all arrays.
const ARRAYS: [&str; 10] = [
    "values",
    "residuals",
    "certified",
    "beyond",
    "clear_below",
    "mass",
    "mass_data",
    "mass_indptr",
    "mass_indices",
    "modes",
];

/// Returns true if the file ends with the end record of a zip directory without comment, as
/// archives of numpy do.
fn ends_as_archive(file: &mut (impl Read + Seek)) -> io::Result<bool> {
    const END: &[u8] = b"PK\x05\x06";
    const LENGTH: i64 = 22;
    let mut start = [0; END.len()];
    file.seek(SeekFrom::End(-LENGTH))?;
    file.read_exact(&mut start)?;
    file.rewind()?;
    Ok(start == END)
}

/// Name of the whole archive among its parts.
const ARCHIVE: &str = "archive";

fn unwritable(path: &Path, error: io::Error) -> WriteError {
    WriteError::new(path, WriteProblem::Io(error))
}

fn unreadable(path: &Path, problem: ReadProblem) -> ReadError {
    ReadError::new(path, problem)
}

fn in_part(path: &Path, part: &str, error: impl Display) -> ReadError {
    problem(path, &format!("{part} cannot be read: {error}"))
}

fn problem(path: &Path, found: &str) -> ReadError {
    let expected = "a spectrum written by Fairing".into();
    unreadable(path, ReadProblem::Unexpected { expected, found: found.into() })
}
