//! `fairing spectrum`.

use std::path::Path;

use clap::{Args, ValueEnum};
use fairing::mesh::TriMesh;
use fairing::operators::{LaplacianKind, MassKind, MassMatrix};
use fairing::sparse::larger;
use fairing::spectral::{self, EigenOptions, SpectrumOptions, Split};
use fairing::task;
use serde_json::Value;

use super::context::{Context, Failure};
use super::files::{Content, OptionalOutput};
use super::inputs::{Inputs, Summary};
use super::operator;
use super::surface::{Reading, Surface};
use super::table::{Table, number};

const EXAMPLES: &str = "\
Examples:
  fairing spectrum bunny.ply -k 20
  fairing spectrum bunny.ply -k 300 -o modes.npz --json
  fairing spectrum patch.obj --boundary dirichlet

Read the modes in Python: numpy.load(\"modes.npz\")[\"modes\"]";

/// Compute the smallest eigenvalues and modes of the Laplace-Beltrami operator
///
/// Solves S φ = ω M φ with the cotangent stiffness S. If a face is too thin for
/// cotangents, uses the intrinsic Delaunay triangulation instead and prints a note.
/// Eigenvalues are in 1/length² of the file. Each pair has a residual in the inverse
/// mass norm: at most 1e-8 of the largest eigenvalue, or the rounding error if masses
/// or weights differ too much for that; a warning names residuals above 1e-8 of their
/// own eigenvalue. A note says that an inertia count has verified that no smaller eigenvalue
/// is missing. If K splits a cluster of equal or nearly equal eigenvalues, a warning
/// suggests values of K that do not. The output is an npz file with values (k), modes
/// (n x k, orthonormal in the mass), residuals (k) and mass. The summary of --json has the
/// eigenvalues and residuals, certified for the inertia count, and the nearest numbers of
/// modes that split no cluster.
#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Spectrum {
    #[command(flatten)]
    inputs: Inputs,
    /// Number of modes
    #[arg(short, value_name = "K", default_value_t = 10, value_parser = at_least_one)]
    k: usize,
    #[command(flatten)]
    reading: Reading,
    #[command(flatten)]
    output: OptionalOutput,
    #[command(flatten)]
    kind: Kind,
    #[command(flatten)]
    summary: Summary,
}

/// Parses a number of modes, at least 1.
pub(crate) fn at_least_one(text: &str) -> Result<usize, String> {
    match text.parse::<usize>() {
        Ok(0) => Err("at least one mode is needed".to_owned()),
        Ok(k) => Ok(k),
        Err(error) => Err(error.to_string()),
    }
}

/// Warns if the first k modes split a cluster of eigenvalues.
///
/// `option` is the name of the option that sets k.
pub(crate) fn warn_of_split(context: &Context, split: Option<Split>, k: usize, option: &str) {
    let Some(split) = split else { return };
    let good = match (split.below, split.above) {
        (0, Some(above)) => format!("{option} {above} does not"),
        (below, Some(above)) => format!("{option} {below} and {option} {above} do not"),
        (0, None) => "a larger number may not".to_owned(),
        (below, None) => format!("{option} {below} does not"),
    };
    context.note(format_args!(
        "warning: {k} modes split a cluster of equal or nearly equal eigenvalues, whose modes are an \
         arbitrary basis; {good}"
    ));
}

/// Warns of residuals above 10⁻⁸ of their eigenvalue, with the bound that they meet.
fn warn_of_residuals(context: &Context, modes: &spectral::Spectrum) {
    let fraction = EigenOptions::default().residual_limit(1.0);
    let Some(&largest) = modes.values.last() else { return };
    let pairs = || modes.values.iter().zip(&modes.residuals).enumerate();
    // Zeros of components are exact. Those of an operator with rounding errors are not, and have
    // no scale.
    let above = pairs()
        .filter(|(_, (value, residual))| **value != 0.0 && **residual > fraction * value.abs());
    let count = above.clone().count();
    let Some((mode, (value, residual))) =
        above.max_by(|(_, (a, r)), (_, (b, s))| (*r / *a).abs().total_cmp(&(*s / *b).abs()))
    else {
        return;
    };
    let worst = modes.residuals.iter().fold(0.0, |m, r| larger(m, *r));
    let bound = if worst <= fraction * largest {
        format!("all are within {fraction:e} of the largest eigenvalue, {}", number(largest))
    } else {
        "smaller ones are out of reach: masses or weights differ so widely that rounding dominates"
            .to_owned()
    };
    context.note(format_args!(
        "warning: {count} of {} residuals exceed {fraction:e} of their eigenvalue (mode {mode}: {} of {}); \
         {bound}",
        modes.len(),
        number(*residual),
        number(*value),
    ));
}

/// Operator, mass and boundary condition.
#[derive(Args)]
struct Kind {
    /// Stiffness matrix
    #[arg(long, value_parser = operator::kinds(), default_value_t = LaplacianKind::Auto)]
    operator: LaplacianKind,
    /// Mass matrix
    #[arg(long, value_parser = operator::masses(), default_value_t = MassKind::Barycentric)]
    mass: MassKind,
    /// Boundary condition: neumann leaves it free, dirichlet sets it to zero
    #[arg(long, value_enum, default_value_t = BoundaryName::Neumann)]
    boundary: BoundaryName,
}

#[derive(Clone, Copy, ValueEnum)]
enum BoundaryName {
    Neumann,
    Dirichlet,
}

impl Kind {
    fn options(&self, mesh: &TriMesh) -> SpectrumOptions {
        match self.boundary {
            BoundaryName::Neumann => SpectrumOptions::default(),
            BoundaryName::Dirichlet => SpectrumOptions::dirichlet(mesh),
        }
    }
}

impl Spectrum {
    pub(crate) fn run(&self, context: &Context) -> Result<(), Failure> {
        self.output.check(&self.inputs.paths)?;
        let columns: Vec<String> = (0..self.k.min(6)).map(|i| format!("eigenvalues.{i}")).collect();
        let mut columns: Vec<&str> = columns.iter().map(String::as_str).collect();
        columns.push("certified");
        self.inputs.each(context, self.summary, &columns, |context, input| self.one(context, input))
    }

    fn one(&self, context: &Context, input: &Path) -> Result<Value, Failure> {
        let output = self.output.if_given(context, input, Content::Npz)?;
        let (surface, _) = self.reading.read(context, input)?;
        let (kind, mesh) = (&self.kind, surface.mesh());
        let laplacian = operator::assemble(context, mesh, kind.operator, kind.mass)?;
        let modes = spectral::spectrum(&laplacian, self.k, &kind.options(mesh))?;
        if let Some(output) = &output {
            on_file(&modes, &surface)?.save(output).map_err(Failure::output)?;
        }
        warn_of_split(context, modes.split(self.k), self.k, "-k");
        warn_of_residuals(context, &modes);
        if self.summary.is_wanted() {
            return Ok(task::spectrum(&modes, self.k, laplacian.kind()));
        }
        let mut table = Table::new();
        table.row(["mode", "eigenvalue", "residual"].map(str::to_owned));
        for (i, (value, residual)) in modes.values.iter().zip(&modes.residuals).enumerate() {
            table.row([i.to_string(), number(*value), number(*residual)]);
        }
        context.print(table)?;
        if modes.certified {
            context.note("verified by an inertia count: no smaller eigenvalue is missing");
        }
        Ok(Value::Null)
    }
}

/// The modes with a row for each vertex of the file: welded vertices have the same values and
/// share their mass, so that modes stay orthonormal.
fn on_file(modes: &spectral::Spectrum, surface: &Surface) -> Result<spectral::Spectrum, Failure> {
    let mut modes = modes.clone();
    if surface.own.vertex_count() == surface.mesh().vertex_count() {
        return Ok(modes);
    }
    let MassMatrix::Lumped(mass) = &modes.mass else {
        return Err(Failure::usage(
            "a consistent mass cannot be split among welded vertices: leave out --weld, --mass or \
             --output",
        ));
    };
    let shares = mass.iter().zip(surface.copies()).map(|(m, n)| m / f64::from(n)).collect();
    modes.mass = MassMatrix::Lumped(surface.spread(shares));
    let rows: Vec<usize> = surface.spread((0..modes.modes.nrows()).collect());
    modes.modes = modes.modes.select(fairing::sparse::ndarray::Axis(0), &rows);
    Ok(modes)
}
