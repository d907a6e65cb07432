//! One error for all crates, and the exceptions of Python.

use fairing::ErrorKind;
use fairing_mesh::io::{ReadError, ReadProblem, WriteError, WriteProblem};
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

impl<E: Into<fairing::Error>> From<E> for Error {
    fn from(error: E) -> Self {
        let error = error.into();
        let text = chain(&error);
        match (error.kind(), error) {
            (_, fairing::Error::Read(ReadError { file, problem: ReadProblem::Io(error), .. }))
            | (
                _,
                fairing::Error::Write(WriteError {
                    file, problem: WriteProblem::Io(error), ..
                }),
            ) => Self::Os { path: file.display().to_string(), error },
            (ErrorKind::Input, _) => Self::Mesh(text),
            (ErrorKind::Option, _) => Self::Option(text),
            _ => Self::Computation(text),
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
