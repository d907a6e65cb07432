//! From errors to exceptions.

use fairing_smoothing::FlowError;
use pyo3::exceptions::PyOSError;
use pyo3::prelude::*;

use crate::error::{
    ComputationError, Error, FlowError_, InternalError, MeshError, OptionError, chain,
};
use crate::mesh::Mesh;

impl From<Error> for PyErr {
    fn from(error: Error) -> Self {
        match error {
            Error::Mesh(text) => MeshError::new_err(text),
            Error::Option(text) => OptionError::new_err(text),
            Error::Computation(text) => ComputationError::new_err(text),
            Error::Internal(text) => InternalError::new_err(text),
            Error::Flow(error) => flow(*error),
            Error::Os { path, error } => match number_of(&error) {
                // With errno and a name Python picks the subclass, such as FileNotFoundError.
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

/// The number of an error of the system, also where another error is about it.
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

/// The exception with the step and the last good mesh.
fn flow(error: FlowError) -> PyErr {
    let exception = FlowError_::new_err(chain(&error));
    Python::attach(|py| {
        let value = exception.value(py);
        let set = || -> PyResult<()> {
            value.setattr("iteration", error.iteration)?;
            value.setattr("last_good", Bound::new(py, Mesh::from(*error.last_good))?)
        };
        match set() {
            Ok(()) => exception,
            Err(other) => other,
        }
    })
}
