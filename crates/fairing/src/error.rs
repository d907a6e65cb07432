//! One error for programs that call several crates.

use std::error::Error as _;
use std::fmt;

use fairing_denoising::DenoiseError;
use fairing_evaluation::EvaluationError;
#[cfg(feature = "figure")]
use fairing_figure::FigureError;
use fairing_mesh::io::{ReadError, ReadProblem, WriteError, WriteProblem};
use fairing_mesh::{BuildError, RepairError};
use fairing_operators::OperatorError;
use fairing_parameters::ParameterError;
use fairing_smoothing::{FlowError, FlowFailure};
use fairing_sparse::SparseError;
use fairing_spectral::SpectralError;
use fairing_watch::Cancelled;

/// Category of an [`Error`], enough to choose an exit code or an exception.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum ErrorKind {
    /// Arrays or a file do not make a mesh or a matrix.
    Input,
    /// An argument is out of its range, unknown, or for another mesh.
    Option,
    /// The system cannot read or write a file.
    Io,
    /// The computation is not defined on this mesh, or did not succeed.
    Numeric,
    /// The work was cancelled.
    Cancelled,
}

/// Any error of any crate; `?` converts to it.
///
/// `Debug` writes the message and its causes, as `Display` of a chain: a `main` that returns this
/// error prints them.
///
/// # Examples
///
/// ```
/// use fairing::{Error, ErrorKind};
/// use fairing::mesh::TriMesh;
/// use fairing::spectral::HeatGeodesics;
///
/// fn farthest(positions: &[f64], faces: &[u32]) -> Result<f64, Error> {
///     let mesh = TriMesh::from_flat(positions, faces)?;
///     let distance = HeatGeodesics::new(&mesh)?.distance(&[0])?;
///     Ok(distance.into_iter().flatten().fold(0.0, f64::max))
/// }
/// assert_eq!(farthest(&[0.0, 0.0], &[]).unwrap_err().kind(), ErrorKind::Input);
/// ```
#[derive(thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// Positions and faces do not make a mesh.
    #[error(transparent)]
    Build(#[from] BuildError),
    /// A mesh cannot be repaired.
    #[error(transparent)]
    Repair(#[from] RepairError),
    /// A file cannot be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// A file cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// A name is unknown, or a value does not fit a parameter.
    #[error(transparent)]
    Option(#[from] ParameterError),
    /// Arrays do not make a matrix, or a linear system or an eigenproblem cannot be solved.
    #[error(transparent)]
    Sparse(#[from] SparseError),
    /// An operator or a curvature is not defined.
    #[error(transparent)]
    Operator(#[from] OperatorError),
    /// A spectrum, or a result computed from one, is not available.
    #[error(transparent)]
    Spectral(#[from] SpectralError),
    /// A flow has failed.
    #[error(transparent)]
    Flow(#[from] FlowError),
    /// A mesh cannot be denoised.
    #[error(transparent)]
    Denoise(#[from] DenoiseError),
    /// Noise, a distance or a score is not defined.
    #[error(transparent)]
    Evaluation(#[from] EvaluationError),
    /// A picture or a plot cannot be drawn or written.
    #[cfg(feature = "figure")]
    #[error(transparent)]
    Figure(#[from] FigureError),
    /// The work was cancelled.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

impl fmt::Debug for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{self}")?;
        let mut causes = std::iter::successors(self.source(), |&cause| cause.source());
        causes.try_for_each(|cause| write!(f, ": {cause}"))
    }
}

impl Error {
    /// The category of the failure.
    pub fn kind(&self) -> ErrorKind {
        match self {
            Self::Cancelled(_) => ErrorKind::Cancelled,
            Self::Build(_) => ErrorKind::Input,
            Self::Sparse(
                SparseError::Offsets { .. }
                | SparseError::Columns { .. }
                | SparseError::Outside { .. }
                | SparseError::Order { .. }
                | SparseError::NotFinite { .. }
                | SparseError::TooManyEntries { .. },
            ) => ErrorKind::Input,
            Self::Option(_) => ErrorKind::Option,
            Self::Read(error) => match error.problem {
                ReadProblem::Io(_) => ErrorKind::Io,
                _ => ErrorKind::Input,
            },
            Self::Write(error) => match error.problem {
                WriteProblem::Io(_) => ErrorKind::Io,
                _ => ErrorKind::Option,
            },
            Self::Operator(error) => operator_kind(error),
            Self::Spectral(error) => spectral_kind(error),
            Self::Flow(error) => flow_kind(&error.failure),
            Self::Denoise(DenoiseError::Option(_)) | Self::Repair(RepairError::Option(_)) => {
                ErrorKind::Option
            }
            Self::Evaluation(error) => evaluation_kind(error),
            #[cfg(feature = "figure")]
            Self::Figure(error) => figure_kind(error),
            _ => ErrorKind::Numeric,
        }
    }
}

#[cfg(feature = "figure")]
fn figure_kind(error: &FigureError) -> ErrorKind {
    match error {
        FigureError::NoFaces { .. }
        | FigureError::NoExtent { .. }
        | FigureError::TooFar { .. }
        | FigureError::Png(_) => ErrorKind::Numeric,
        _ => ErrorKind::Option,
    }
}

fn operator_kind(error: &OperatorError) -> ErrorKind {
    match error {
        OperatorError::Option(_)
        | OperatorError::Length { .. }
        | OperatorError::NoSuchVertex { .. }
        | OperatorError::NoSuchMass { .. } => ErrorKind::Option,
        _ => ErrorKind::Numeric,
    }
}

fn spectral_kind(error: &SpectralError) -> ErrorKind {
    match error {
        SpectralError::Operator(error) => operator_kind(error),
        SpectralError::Kind { .. }
        | SpectralError::Repeated { .. }
        | SpectralError::TooManyModes { .. }
        | SpectralError::Rows { .. }
        | SpectralError::Option(_)
        | SpectralError::NoSuchFace { .. }
        | SpectralError::NoSuchVertex { .. } => ErrorKind::Option,
        _ => ErrorKind::Numeric,
    }
}

fn flow_kind(failure: &FlowFailure) -> ErrorKind {
    match failure {
        FlowFailure::Option(_)
        | FlowFailure::Unsupported { .. }
        | FlowFailure::Unstable { .. }
        | FlowFailure::Amplified { .. }
        | FlowFailure::NoSuchVertex { .. } => ErrorKind::Option,
        FlowFailure::Operator(error) => operator_kind(error),
        FlowFailure::Modes(error) => spectral_kind(error),
        _ => ErrorKind::Numeric,
    }
}

fn evaluation_kind(error: &EvaluationError) -> ErrorKind {
    match error {
        EvaluationError::Option(_) => ErrorKind::Option,
        EvaluationError::Operator(error) => operator_kind(error),
        _ => ErrorKind::Numeric,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{TriMesh, io};
    use crate::smoothing::{Diffusion, Explicit, explicit};
    use crate::{evaluation, operators, shapes, spectral};

    #[test]
    fn each_sort_of_failure_has_its_kind() {
        let kind = |error: Error| error.kind();
        let mesh = shapes::icosphere(1);
        let built = TriMesh::new(vec![[f64::NAN; 3]], vec![]).unwrap_err();
        assert_eq!(kind(built.into()), ErrorKind::Input);
        assert_eq!(kind(io::read("no/such/file.ply").unwrap_err().into()), ErrorKind::Io);
        let written = io::write("no/such/folder/a.ply", &mesh).unwrap_err();
        assert_eq!(kind(written.into()), ErrorKind::Io);
        let named = "cotan".parse::<operators::LaplacianKind>().unwrap_err();
        assert_eq!(kind(named.into()), ErrorKind::Option);
        let laplacian = operators::Laplacian::auto(&mesh).unwrap();
        let options = spectral::SpectrumOptions { fixed: vec![99], ..Default::default() };
        let modes = spectral::spectrum(&laplacian, 2, &options).unwrap_err();
        assert_eq!(kind(modes.into()), ErrorKind::Option);
        let flow = explicit(&mesh, &Explicit::new(Diffusion::uniform(9.0)), None).unwrap_err();
        assert_eq!(kind(flow.into()), ErrorKind::Option);
        let flat = TriMesh::new(vec![[0.0; 3], [1.0; 3], [2.0; 3]], vec![[0, 1, 2]]).unwrap();
        let thin = operators::Laplacian::cotangent(&flat).unwrap_err();
        assert_eq!(kind(thin.into()), ErrorKind::Numeric);
        let few = evaluation::normal_error(&mesh, &flat).unwrap_err();
        assert_eq!(kind(few.into()), ErrorKind::Numeric);
        assert_eq!(kind(Cancelled.into()), ErrorKind::Cancelled);
    }

    /// Message and source are those of the inner error. `main` prints `Debug`.
    #[test]
    fn nothing_of_an_error_is_lost() {
        let read = || io::read("no/such/file.ply").unwrap_err();
        let error = Error::from(read());
        assert_eq!(error.to_string(), read().to_string());
        assert_eq!(error.source().is_some(), read().source().is_some());
        let printed = format!("{error:?}");
        assert!(printed.starts_with("no/such/file.ply: ") && !printed.contains('{'), "{printed}");
    }
}
