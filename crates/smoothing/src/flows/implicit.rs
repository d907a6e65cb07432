//! Implicit diffusion, backward Euler, and mean curvature flow.

use fairing_mesh::TriMesh;
use fairing_operators::ThinFaces;
use fairing_parameters::{Algorithm, OptionError, Parameter, ParameterError, Values};
use fairing_sparse::GraphLaplacian;
use fairing_sparse::passes::update;

use crate::engine::assemble::{Assembler, mass};
use crate::engine::collapse::Collapse;
use crate::engine::conjugate::{ImplicitSolver, Room, Solved};
use crate::engine::constraints::{BOUNDARY, Constraints, Freedom, PIN, SOFT};
use crate::engine::diffusion::{AREA, Diffusion, LAMBDA, OPERATOR, Operator, TIME, WEIGHTS};
use crate::engine::direct::{self, Direct};
use crate::engine::error::{FlowError, FlowFailure};
use crate::engine::flow::{Flow, FlowFn};
use crate::engine::outcome::{Approach, Smoothed};
use crate::engine::parts::Parts;
use crate::engine::response::Response;
use crate::engine::run::{Frame, Run, StepNote};
use crate::engine::series::expand;
use crate::engine::step::{ITERATIONS, Observer};
use crate::engine::unit_scale::{at_unit_scale, diffuses_in_mesh_units};
use crate::engine::volume::{VOLUME, Volume};

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

fairing_parameters::choices!(Update, "update of the operator",
    Never: "never", "The operator of the input";
    Mass: "mass", "Areas of the current mesh, stiffness of the input";
    Both: "both", "All of the current mesh";
);
#[cfg(feature = "serde")]
fairing_parameters::serde_by_name!(Update);

/// The update.
const UPDATE: Parameter =
    Parameter::choice("update", Update::CHOICES, "never", "When the operator is assembled again");

/// The accuracy of the linear systems.
pub(crate) const TOLERANCE: Parameter =
    Parameter::number("tolerance", "", "The relative residual of the linear systems");

/// Options of [`implicit`].
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct Implicit {
    /// The Laplacian and the length of a step.
    pub diffusion: Diffusion,
    /// The number of steps; 10 unless set.
    pub iterations: usize,
    /// When the operator is assembled again; cotangents only, since uniform weights do not depend on positions.
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

    /// Mean curvature flow: the operator is assembled again in each step of `lambda` h².
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
/// weighted by degree or area). Each step solves the symmetric system `(M + λS) x' = M x`: with uniform weights
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
/// [`FlowFailure::Collapsed`] where an updated flow has shrunk the mesh to almost nothing, and for a system not solved
/// to the tolerance.
///
/// Faces that become degenerate while the operator is assembled again in each step do not end the flow: their cotangents and
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

    const RUN: FlowFn<Self> = implicit;

    fn with(values: &Values<'_>, positions: &[[f64; 3]]) -> Result<Self, ParameterError> {
        let mut options = match values.algorithm().name {
            "mean-curvature" => {
                Self { update: Update::Both, ..Self::new(Diffusion::cotangents(values, 1.0)?) }
            }
            _ => Self::new(Diffusion::from_values(values, 5.0, 5.0)?),
        };
        options.constraints = Constraints::from_values(values, positions)?;
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
}

diffuses_in_mesh_units!(Implicit);

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
    let start = run.arrangement.mesh();
    let assembled =
        Assembler::new(start, options.diffusion, &run.freedom.fixed).and_then(|mut all| {
            let laplacian = all.assemble(start, &run.freedom.fixed)?;
            Ok((laplacian, all))
        });
    let (laplacian, assembler) = assembled.map_err(|failure| run.refuse(failure))?;
    let k = options.iterations;
    if run.is_linear() && options.update == Update::Never && k > 0 {
        let power = Response::Implicit { step, steps: k };
        if let Some(series) = expand(laplacian.spectral_bound(), power) {
            run.report.approach = Approach::Series { degree: series.degree() };
            run.report.iterations = k;
            let x = series.apply(&laplacian, run.arrangement.mesh().positions());
            return run.finish(x);
        }
    }
    let mut stepper = Stepper::new(options, step, start, &run.freedom, (laplacian, assembler));
    let smoothed =
        run.iterate(|iteration, mesh, freedom, next| stepper.step(iteration, mesh, freedom, next));
    smoothed.map(|mut smoothed| {
        smoothed.report.degenerate_faces = stepper.flattened.iter().filter(|&&f| f).count();
        smoothed.report.approach = match stepper.direct {
            Some(Direct { factorisations, .. }) => Approach::Cholesky { factorisations },
            None => Approach::ConjugateGradients { iterations: stepper.iterations },
        };
        smoothed
    })
}

/// Takes one implicit step after another.
struct Stepper<'a> {
    options: &'a Implicit,
    /// The factor of `L`.
    step: f64,
    laplacian: GraphLaplacian,
    /// For operators that are assembled again in each step.
    assembler: Option<Assembler>,
    parts: Parts,
    /// Sliding vertices couple the coordinates, which a factor of the scalar system does not know.
    may_factor: bool,
    /// Where all systems are factored.
    direct: Option<Direct>,
    /// For systems that conjugate gradients do not solve.
    rescue: Direct,
    collapse: Option<Collapse>,
    /// Of the step before: conjugate gradients begin with it.
    displacement: Vec<[f64; 3]>,
    room: Room,
    /// Of all systems.
    iterations: usize,
    /// Whether a face has been too thin in some step.
    flattened: Vec<bool>,
}

impl<'a> Stepper<'a> {
    fn new(
        options: &'a Implicit,
        step: f64,
        mesh: &TriMesh,
        freedom: &Freedom,
        (laplacian, assembler): (GraphLaplacian, Assembler),
    ) -> Self {
        let frozen = options.update == Update::Never;
        // A factor serves as many solves as steps share their operator.
        let solves = if frozen { options.iterations } else { 1 };
        let may_factor = freedom.sliding.is_none();
        let pays = || direct::pays(&laplacian, step, options.tolerance, solves);
        // A pattern that nobody will fill again only takes memory.
        let assembler = (options.update == Update::Both).then_some(assembler);
        Self {
            options,
            step,
            direct: (may_factor && pays()).then(Direct::default),
            parts: Parts::new(&laplacian, freedom),
            laplacian,
            may_factor,
            rescue: Direct::default(),
            collapse: (!frozen).then(|| Collapse::new(mesh)),
            displacement: vec![[0.0; 3]; mesh.vertex_count()],
            room: Room::default(),
            iterations: 0,
            flattened: vec![false; if assembler.is_some() { mesh.face_count() } else { 0 }],
            assembler,
        }
    }

    fn step(
        &mut self,
        iteration: usize,
        mesh: &TriMesh,
        freedom: &Freedom,
        next: &mut [[f64; 3]],
    ) -> Result<StepNote, FlowFailure> {
        use FlowFailure::{NotConverged, NotFactored};
        let mut taken = self.attempt(iteration, mesh, freedom, next, ThinFaces::Widen);
        // A system that thin faces spoil is solved with those that are nearly flat made a little wider.
        if let Err(NotConverged { .. } | NotFactored(_)) = taken
            && iteration > 0
            && self.assembler.is_some()
        {
            self.displacement.fill([0.0; 3]);
            taken = self.attempt(iteration, mesh, freedom, next, ThinFaces::WidenNearly);
        }
        taken.map_err(|failure| match &self.collapse {
            Some(collapse) => collapse.explain(mesh, failure),
            None => failure,
        })
    }

    fn attempt(
        &mut self,
        iteration: usize,
        mesh: &TriMesh,
        freedom: &Freedom,
        next: &mut [[f64; 3]],
        thin: ThinFaces,
    ) -> Result<StepNote, FlowFailure> {
        let hard = iteration > 0 && self.reassemble(mesh, freedom, thin)?;
        let solved = self.solve(mesh.positions(), freedom, hard)?;
        self.iterations += solved.iterations;
        let (x, d) = (mesh.positions(), &self.displacement);
        update(next, |i, _| ([x[i][0] + d[i][0], x[i][1] + d[i][1], x[i][2] + d[i][2]], ()));
        if let Some(collapse) = &self.collapse {
            collapse.check(mesh.faces(), next)?;
        }
        Ok(StepNote { step_size: self.step, residual: Some(solved.residual) })
    }

    /// Takes the operator at the positions of `mesh`, as far as it is updated. Whether faces are too thin for
    /// cotangents, which makes a system ill conditioned within an otherwise easy run.
    fn reassemble(
        &mut self,
        mesh: &TriMesh,
        freedom: &Freedom,
        thin: ThinFaces,
    ) -> Result<bool, FlowFailure> {
        if self.options.update == Update::Mass {
            self.laplacian.replace_mass(mass(mesh, operator(self.options))?);
        }
        let Some(assembler) = &mut self.assembler else { return Ok(false) };
        let faces = assembler.reassemble(mesh, &freedom.fixed, &mut self.laplacian, thin)?;
        for &f in &faces {
            self.flattened[f as usize] = true;
        }
        Ok(!faces.is_empty())
    }

    /// The displacement of the step from `x`.
    fn solve(
        &mut self,
        x: &[[f64; 3]],
        freedom: &Freedom,
        hard: bool,
    ) -> Result<Solved, FlowFailure> {
        let solver = ImplicitSolver {
            laplacian: &self.laplacian,
            parts: &self.parts,
            step: self.step,
            tolerance: self.options.tolerance,
            most_iterations: if self.may_factor { SOME_ITERATIONS } else { MOST_ITERATIONS },
        };
        let displacement = &mut self.displacement;
        if let Some(direct) = &mut self.direct {
            if self.options.update != Update::Never {
                direct.forget_factor();
            }
            return direct.solve(solver, x, freedom, displacement);
        }
        if !(hard && self.may_factor) {
            let solved = solver.solve(x, freedom, displacement, &mut self.room);
            if solved.is_ok() || !self.may_factor {
                return solved;
            }
        }
        self.rescue.forget_factor();
        self.rescue.solve(solver, x, freedom, displacement)
    }
}

fn check(options: &Implicit) -> Result<(), FlowFailure> {
    OptionError::require_not_negative("step", options.diffusion.value())?;
    let tolerance = options.tolerance;
    let between = tolerance > 0.0 && tolerance < 1.0;
    OptionError::require(between, "tolerance", tolerance, "above 0 and below 1")?;
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
