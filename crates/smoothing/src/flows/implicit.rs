//! Implicit diffusion, backward Euler, and mean curvature flow.

use fairing_mesh::{Algorithm, Parameter, ParameterError, TriMesh, Values};
use fairing_operators::ThinFaces;

use crate::engine::assemble::{Renewal, mass};
use crate::engine::collapse::Collapse;
use crate::engine::conjugate::{ImplicitSolver, Room};
use crate::engine::constraints::{BOUNDARY, Constraints, PIN, SOFT};
use crate::engine::diffusion::{AREA, Diffusion, LAMBDA, OPERATOR, Operator, TIME, WEIGHTS};
use crate::engine::direct::{self, Direct};
use crate::engine::error::{FlowError, FlowFailure, at_least};
use crate::engine::laplacian::{Laplacian, by_chunk};
use crate::engine::outcome::{Approach, Smoothed};
use crate::engine::parts::Parts;
use crate::engine::response::Response;
use crate::engine::run::{Frame, Run, StepNote};
use crate::engine::series::Series;
use crate::engine::spectrum::upper_bound;
use crate::engine::step::{ITERATIONS, Observer};
use crate::engine::unit_scale::{InMeshUnits, at_unit_scale};
use crate::engine::volume::{VOLUME, Volume};
use crate::method::Flow;

/// When the operator is taken at the current positions.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Update {
    /// Never: the operator of the input for all steps. The flow is linear.
    #[default]
    Never,
    /// The mass in each step, the stiffness never: conformalised mean curvature flow without its normalisation.
    /// Source: \[kazhdan2012\].
    Mass,
    /// Mass and stiffness in each step: mean curvature flow.
    Both,
}

fairing_mesh::choices!(Update, "update of the operator",
    Never: "never", "The operator of the input";
    Mass: "mass", "Areas of the current mesh, stiffness of the input";
    Both: "both", "All of the current mesh";
);

/// The update.
const UPDATE: Parameter =
    Parameter::choice("update", Update::CHOICES, "never", "When the operator is assembled again");

/// The accuracy of the linear systems.
pub(crate) const TOLERANCE: Parameter =
    Parameter::number("tolerance", "", "The relative residual of the linear systems");

/// Options of [`implicit`].
#[derive(Debug, Clone, PartialEq)]
pub struct Implicit {
    /// The Laplacian and the length of a step.
    pub diffusion: Diffusion,
    /// The number of steps; 10 unless set.
    pub iterations: usize,
    /// When the operator is taken anew; cotangents only, since uniform weights do not see positions.
    pub update: Update,
    /// The relative residual of the linear systems; 1e-8 unless set.
    pub tolerance: f64,
    /// Vertices that may not move freely.
    pub constraints: Constraints,
    /// What happens to the volume.
    pub volume: Volume,
}

impl Implicit {
    /// Ten free steps with the operator of the input.
    pub fn new(diffusion: Diffusion) -> Self {
        Self {
            diffusion,
            iterations: 10,
            update: Update::default(),
            tolerance: 1e-8,
            constraints: Constraints::default(),
            volume: Volume::default(),
        }
    }

    /// Mean curvature flow: the operator taken anew in each step of `lambda` h².
    pub fn mean_curvature_flow(lambda: f64) -> Self {
        Self { update: Update::Both, ..Self::new(Diffusion::cotangent(lambda)) }
    }
}

/// Conjugate gradient iterations after which a step is given up.
const MOST_ITERATIONS: usize = 20_000;

/// Those after which it is factored, where vertices do not slide.
const SOME_ITERATIONS: usize = 2000;

/// Smooths by implicit diffusion steps `(I − λL) x' = x`.
///
/// A mode of eigenvalue μ ≤ 0 of `L` is multiplied by `1/(1 − λμ)`: no λ is unstable, and none converges to the
/// shape, since all modes but the constant shrink in every step (λ → ∞ collapses each component to its centroid,
/// weighted by degree or area). Solved is the symmetric system `(M + λS) x' = M x`: with uniform weights
/// `D − λ(A − D)`, with cotangents `M + tS`, positive definite as long as the areas are positive.
///
/// Unobserved free or pinned runs of a frozen operator are computed at once by a Chebyshev series; other runs step by
/// step, by conjugate gradients or, where the system is ill conditioned and steps are many, by a Cholesky
/// factorisation. The report says which.
///
/// Boundaries are natural: a free border moves inward, by what its neighbours on one side pull. A soft constraint
/// of weight w and target c adds `M w` on the left and `M w c` on the right; sliding vertices are moved along the
/// tangents of their curves within the system, then put back on the curve.
///
/// # Errors
///
/// [`FlowError`] with the last good mesh: for options out of range, for faces of the input too thin for cotangents,
/// [`FlowFailure::Collapsed`] where an updated flow has shrunk the mesh to next to nothing, and for a system not solved
/// to the tolerance.
///
/// Faces that become degenerate while the operator is taken again in each step do not end the flow: their cotangents and
/// areas are those of a triangle whose sides are longer by a hundred-thousandth of the longest. The report says how
/// many there were.
///
/// # Examples
///
/// ```
/// use fairing_shapes as shapes;
/// use fairing_smoothing::{Diffusion, Implicit, implicit};
///
/// let sphere = shapes::icosphere(3);
/// let options = Implicit { iterations: 3, ..Implicit::new(Diffusion::uniform(100.0)) };
/// let smoothed = implicit(&sphere, &options, None)?;
/// assert_eq!(smoothed.report.iterations, 3);
/// # Ok::<(), fairing_smoothing::FlowError>(())
/// ```
///
/// Source: \[desbrun1999\].
pub fn implicit(
    mesh: &TriMesh,
    options: &Implicit,
    observer: Option<&mut Observer<'_>>,
) -> Result<Smoothed, FlowError> {
    at_unit_scale(mesh, options, observer, |mesh, options, observer| {
        implicit_with(mesh, options, false, observer)
    })
}

impl Flow for Implicit {
    const ALGORITHMS: &'static [Algorithm] = &[
        Algorithm::new(
            "implicit",
            "steps of any length (I − λL)x' = x; never unstable, always shrinks",
            &["desbrun1999"],
            &[
                WEIGHTS,
                LAMBDA.default("5"),
                TIME,
                ITERATIONS,
                AREA,
                OPERATOR,
                BOUNDARY,
                PIN,
                SOFT,
                VOLUME,
                UPDATE,
                TOLERANCE.default("1e-8"),
            ],
        ),
        Algorithm::new(
            "mean-curvature",
            "implicit steps, operator assembled again each time: motion by curvature",
            &["desbrun1999"],
            &[
                LAMBDA.default("1"),
                TIME,
                ITERATIONS,
                AREA,
                OPERATOR,
                BOUNDARY,
                PIN,
                SOFT,
                VOLUME,
                TOLERANCE.default("1e-8"),
            ],
        ),
    ];

    fn with(values: &Values<'_>, positions: &[[f64; 3]]) -> Result<Self, ParameterError> {
        let mut options = match values.algorithm().name {
            "mean-curvature" => {
                Self { update: Update::Both, ..Self::new(Diffusion::cotangents(values, 1.0)?) }
            }
            _ => Self::new(Diffusion::of_values(values, 5.0, 5.0)?),
        };
        options.constraints = Constraints::of_values(values, positions)?;
        values.read(ITERATIONS.name, &mut options.iterations)?;
        values.read(VOLUME.name, &mut options.volume)?;
        values.read(UPDATE.name, &mut options.update)?;
        values.read(TOLERANCE.name, &mut options.tolerance)?;
        Ok(options)
    }

    /// Mean curvature flow if the operator is updated.
    fn algorithm(&self) -> &'static Algorithm {
        &Self::ALGORITHMS[usize::from(self.update == Update::Both)]
    }

    fn run(
        &self,
        mesh: &TriMesh,
        observer: Option<&mut Observer<'_>>,
    ) -> Result<Smoothed, FlowError> {
        implicit(mesh, self, observer)
    }
}

impl InMeshUnits for Implicit {
    fn divided_by(&self, unit: f64) -> Result<Self, FlowFailure> {
        Ok(Self {
            diffusion: self.diffusion.divided_by(unit)?,
            constraints: self.constraints.divided_by(unit)?,
            ..*self
        })
    }

    fn is_timed(&self) -> bool {
        self.diffusion.is_timed()
    }
}

/// [`implicit`], and each step ends with scaling to the area of the input if `keep_area`.
pub(crate) fn implicit_with(
    mesh: &TriMesh,
    options: &Implicit,
    keep_area: bool,
    observer: Option<&mut Observer<'_>>,
) -> Result<Smoothed, FlowError> {
    check(options).map_err(|failure| failure.before(mesh))?;
    let step = options.diffusion.factor(mesh);
    let frame = Frame {
        volume: options.volume,
        keep_area,
        ..Frame::new(&options.constraints, options.iterations)
    };
    let mut run = Run::new(mesh, &frame, observer)?;
    let frozen = options.update == Update::Never;
    let start = run.arrangement.mesh();
    let mut renewal = Renewal::new(start, options.diffusion, &run.freedom.held)
        .map_err(|failure| run.refuse(failure))?;
    let mut laplacian =
        renewal.assemble(start, &run.freedom.held).map_err(|failure| run.refuse(failure))?;
    // A pattern that nobody will fill again only takes memory.
    let mut renewal = (options.update == Update::Both).then_some(renewal);
    let k = options.iterations;
    if run.is_linear() && frozen && k > 0 {
        let power = Response::Implicit { step, steps: k };
        if let Some(series) = Series::expand(upper_bound(&laplacian), power) {
            run.report.approach = Approach::Series { degree: series.degree() };
            run.report.iterations = k;
            let x = series.apply(&laplacian, run.arrangement.mesh().positions());
            return run.finish(x);
        }
    }
    // A factor serves as many solves as steps share their operator. Sliding vertices couple the coordinates, which a
    // factor of the scalar system does not know.
    let may_factor = run.freedom.sliding.is_none();
    let mut rescue = Direct::default();
    let mut direct = (may_factor
        && direct::pays(&laplacian, step, options.tolerance, if frozen { k } else { 1 }))
    .then(Direct::default);
    let parts = Parts::of(&laplacian, &run.freedom);
    let collapse = (!frozen).then(|| Collapse::new(run.arrangement.mesh()));
    // Conjugate gradients begin with the displacement of the step before.
    let mut displacement = vec![[0.0; 3]; mesh.vertex_count()];
    let mut room = Room::default();
    let mut total = 0;
    let renews = renewal.is_some();
    let mut flattened = vec![false; if renews { mesh.face_count() } else { 0 }];
    let smoothed = run.iterate(|iteration, mesh, freedom, next| {
        let mut step_from =
            |laplacian: &mut Laplacian, thin: ThinFaces| -> Result<StepNote, FlowFailure> {
                let mut hard = false;
                if thin == ThinFaces::WidenNearly {
                    displacement.fill([0.0; 3]);
                }
                if iteration > 0 {
                    match (options.update, &mut renewal) {
                        (Update::Both, Some(renewal)) => {
                            let faces = renewal.renew(mesh, &freedom.held, laplacian, thin)?;
                            hard = !faces.is_empty();
                            for f in faces {
                                flattened[f as usize] = true;
                            }
                        }
                        (Update::Mass, _) => laplacian.replace_mass(mass(mesh, operator(options))?),
                        _ => {}
                    }
                }
                let solver = ImplicitSolver {
                    laplacian,
                    parts: &parts,
                    step,
                    tolerance: options.tolerance,
                    most_iterations: if may_factor { SOME_ITERATIONS } else { MOST_ITERATIONS },
                };
                let x = mesh.positions();
                let solved = match &mut direct {
                    Some(direct) => {
                        if !frozen {
                            direct.renew();
                        }
                        direct.solve(solver, x, freedom, &mut displacement)?
                    }
                    // Thin faces make a system ill conditioned within an otherwise easy run.
                    None => {
                        let solved = match hard && may_factor {
                            true => None,
                            false => Some(solver.solve(x, freedom, &mut displacement, &mut room)),
                        };
                        match solved {
                            Some(Err(failure)) if !may_factor => return Err(failure),
                            Some(Ok(solved)) => solved,
                            _ => {
                                rescue.renew();
                                rescue.solve(solver, x, freedom, &mut displacement)?
                            }
                        }
                    }
                };
                total += solved.iterations;
                by_chunk(next, |i, _| {
                    let (x, d) = (&x[i], &displacement[i]);
                    ([x[0] + d[0], x[1] + d[1], x[2] + d[2]], [])
                });
                if let Some(collapse) = &collapse {
                    collapse.check(mesh.faces(), next)?;
                }
                Ok(StepNote { step_size: step, residual: Some(solved.residual) })
            };
        let taken = step_from(&mut laplacian, ThinFaces::Widen);
        // A system that thin faces spoil is solved with those that are nearly flat made a little wider.
        let spoilt = |failure: &FlowFailure| {
            use FlowFailure::{NotConverged, NotFactored};
            iteration > 0 && matches!(failure, NotConverged { .. } | NotFactored { .. })
        };
        let taken = match taken {
            Err(failure) if renews && spoilt(&failure) => {
                step_from(&mut laplacian, ThinFaces::WidenNearly)
            }
            other => other,
        };
        taken.map_err(|failure| match &collapse {
            Some(collapse) => collapse.explain(mesh, failure),
            None => failure,
        })
    });
    smoothed.map(|mut smoothed| {
        smoothed.report.degenerate_faces = flattened.iter().filter(|&&f| f).count();
        smoothed.report.approach = match direct {
            Some(Direct { factorisations, .. }) => Approach::Cholesky { factorisations },
            None => Approach::ConjugateGradients { iterations: total },
        };
        smoothed
    })
}

fn check(options: &Implicit) -> Result<(), FlowFailure> {
    at_least("the step", options.diffusion.value(), 0.0)?;
    if !(options.tolerance > 0.0 && options.tolerance < 1.0) {
        return Err(FlowFailure::InvalidOption {
            option: "the tolerance",
            value: options.tolerance,
            expected: "it must lie between 0 and 1",
        });
    }
    let uniform = matches!(options.diffusion, Diffusion::Uniform { .. });
    if uniform && options.update != Update::Never {
        return Err(FlowFailure::Unsupported {
            reason: "uniform weights do not depend on positions: there is nothing to update",
        });
    }
    Ok(())
}

fn operator(options: &Implicit) -> Operator {
    match options.diffusion {
        Diffusion::Cotangent { operator, .. } => operator,
        Diffusion::Uniform { .. } => Operator::default(),
    }
}
