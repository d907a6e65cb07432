//! One error for all crates, and the exceptions of Python.

use fairing_denoising::DenoiseError;
use fairing_evaluation::EvaluationError;
use fairing_figure::FigureError;
use fairing_mesh::io::{ReadError, ReadProblem, WriteError, WriteProblem};
use fairing_mesh::{BuildError, RepairError};
use fairing_operators::OperatorError;
use fairing_spectral::SpectralError;
use pyo3::create_exception;
use pyo3::exceptions::{PyOSError, PyRuntimeError, PyValueError};
use pyo3::prelude::*;

create_exception!(
    pyfairing,
    FairingError,
    PyValueError,
    "Base class of the errors of pyfairing, except errors of the system."
);
create_exception!(
    pyfairing,
    MeshError,
    FairingError,
    "Invalid arrays or an invalid file. The message names the element and the value."
);
create_exception!(
    pyfairing,
    OptionError,
    FairingError,
    "An argument that is out of range or belongs to another mesh. The message names the argument and its value."
);
create_exception!(
    pyfairing,
    ComputationError,
    FairingError,
    "The computation is not defined on this mesh, or failed. The message names the element and the value."
);
create_exception!(
    pyfairing,
    FlowError_,
    ComputationError,
    "A step of a flow failed: `iteration` is its number, `last_good` the mesh before it."
);
create_exception!(
    pyfairing,
    InternalError,
    PyRuntimeError,
    "A defect of pyfairing: please report it."
);

/// Error of a call.
#[derive(Debug)]
pub(crate) enum Error {
    Mesh(String),
    Option(String),
    Computation(String),
    Os { path: String, error: std::io::Error },
    Internal(String),
}

pub(crate) type Result<T> = std::result::Result<T, Error>;

impl Error {
    pub(crate) fn option(text: impl std::fmt::Display) -> Self {
        Self::Option(text.to_string())
    }
}

impl From<Error> for PyErr {
    fn from(error: Error) -> Self {
        match error {
            Error::Mesh(text) => MeshError::new_err(text),
            Error::Option(text) => OptionError::new_err(text),
            Error::Computation(text) => ComputationError::new_err(text),
            Error::Internal(text) => InternalError::new_err(text),
            Error::Os { path, error } => match number_of(&error) {
                // From errno and a name Python picks the subclass, such as FileNotFoundError.
                Some(number) => {
                    let text = error.to_string();
                    let text = text.split(" (os error").next().unwrap_or_default().to_owned();
                    PyOSError::new_err((number, text, path))
                }
                None => PyOSError::new_err(format!("{path}: {error}")),
            },
        }
    }
}

/// The error number of the system, also if wrapped in another error.
fn number_of(error: &std::io::Error) -> Option<i32> {
    let mut inner: Option<&(dyn std::error::Error + 'static)> = Some(error);
    while let Some(one) = inner {
        let number = one.downcast_ref().and_then(std::io::Error::raw_os_error);
        if number.is_some() {
            return number;
        }
        inner = one.source().or_else(|| {
            let outer: Option<&std::io::Error> = one.downcast_ref();
            outer?.get_ref().map(|e| e as &(dyn std::error::Error + 'static))
        });
    }
    (error.kind() == std::io::ErrorKind::NotFound).then_some(2)
}

/// The message followed by those of its sources.
pub(crate) fn chain(error: &dyn std::error::Error) -> String {
    let mut text = error.to_string();
    let mut source = error.source();
    while let Some(inner) = source {
        let more = inner.to_string();
        if !text.contains(&more) {
            text += ": ";
            text += &more;
        }
        source = inner.source();
    }
    text
}

impl From<BuildError> for Error {
    fn from(error: BuildError) -> Self {
        Self::Mesh(chain(&error))
    }
}

impl From<RepairError> for Error {
    fn from(error: RepairError) -> Self {
        match error {
            RepairError::Option(error) => Self::option(error),
            error => Self::Computation(chain(&error)),
        }
    }
}

impl From<ReadError> for Error {
    fn from(error: ReadError) -> Self {
        let path = error.file.display().to_string();
        match error.problem {
            ReadProblem::Io(error) => Self::Os { path, error },
            _ => Self::Mesh(error.to_string()),
        }
    }
}

impl From<WriteError> for Error {
    fn from(error: WriteError) -> Self {
        let path = error.file.display().to_string();
        match error.problem {
            WriteProblem::Io(error) => Self::Os { path, error },
            _ => Self::Option(error.to_string()),
        }
    }
}

impl From<OperatorError> for Error {
    fn from(error: OperatorError) -> Self {
        let text = chain(&error);
        match error {
            OperatorError::Option(_)
            | OperatorError::Length { .. }
            | OperatorError::NoSuchVertex { .. }
            | OperatorError::NoSuchMass { .. } => Self::Option(text),
            _ => Self::Computation(text),
        }
    }
}

impl From<SpectralError> for Error {
    fn from(error: SpectralError) -> Self {
        let text = chain(&error);
        match error {
            SpectralError::Operator(error) => error.into(),
            SpectralError::Kind { .. }
            | SpectralError::Repeated { .. }
            | SpectralError::TooManyModes { .. }
            | SpectralError::Rows { .. }
            | SpectralError::Option(_)
            | SpectralError::NoSuchFace { .. }
            | SpectralError::NoSuchVertex { .. } => Self::Option(text),
            _ => Self::Computation(text),
        }
    }
}

impl From<DenoiseError> for Error {
    fn from(error: DenoiseError) -> Self {
        match error {
            DenoiseError::Option(_) => Self::Option(chain(&error)),
            _ => Self::Computation(chain(&error)),
        }
    }
}

impl From<EvaluationError> for Error {
    fn from(error: EvaluationError) -> Self {
        match error {
            EvaluationError::Option(_) => Self::Option(chain(&error)),
            _ => Self::Computation(chain(&error)),
        }
    }
}

impl From<FigureError> for Error {
    fn from(error: FigureError) -> Self {
        match error {
            FigureError::NoFaces { .. }
            | FigureError::NoExtent { .. }
            | FigureError::TooFar { .. }
            | FigureError::Png(_) => Self::Computation(chain(&error)),
            _ => Self::Option(chain(&error)),
        }
    }
}

pub(crate) fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    let py = module.py();
    module.add("FairingError", py.get_type::<FairingError>())?;
    module.add("MeshError", py.get_type::<MeshError>())?;
    module.add("OptionError", py.get_type::<OptionError>())?;
    module.add("ComputationError", py.get_type::<ComputationError>())?;
    let flow = py.get_type::<FlowError_>();
    flow.setattr("__name__", "FlowError")?;
    flow.setattr("__qualname__", "FlowError")?;
    module.add("FlowError", flow)?;
    module.add("InternalError", py.get_type::<InternalError>())
}
