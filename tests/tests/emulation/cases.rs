//! What is run, and what is promised of it.

/// A run of the program. `OUT` in its line is the file that it writes; without
/// it, its standard output counts.
#[derive(Debug)]
pub(crate) struct Case {
    pub(crate) name: &'static str,
    pub(crate) line: &'static str,
    /// The extension of the output, `json` for standard output.
    pub(crate) output: &'static str,
    pub(crate) promise: Promise,
}

/// How results on two processors compare.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Promise {
    /// The same bits: sums, products, quotients, square roots and functions of
    /// the crate `libm` in a fixed order, whatever does not factorise.
    SameBits,
    /// Near by this much, relative to the largest value.
    Near(f64),
}

/// A direct solution of a system of condition κ is off by ε κ times a modest
/// number, taken as 100. Of I − λL with eigenvalues of L in [−2, 0]: κ = 1 + 2λ.
const fn direct(lambda: f64) -> Promise {
    Promise::Near(100.0 * f64::EPSILON * (1.0 + 2.0 * lambda))
}

/// An eigenvalue is within its residual, which is printed (`near` reads it).
const EIGENVALUES: Promise = Promise::Near(0.0);

/// Kept modes turn by an angle of residual over gap. Residuals are at most 1e-9
/// of the largest eigenvalue, and behind mode 4 of a sphere there is a gap from
/// 2 to 6.
const PROJECTION: Promise = Promise::Near(1e-8);

const fn mesh(name: &'static str, line: &'static str, promise: Promise) -> Case {
    Case { name, line, output: "ply", promise }
}

const fn text(name: &'static str, line: &'static str, promise: Promise) -> Case {
    Case { name, line, output: "json", promise }
}

use Promise::SameBits;

pub(crate) const CASES: &[Case] = &[
    text("info", "info in.ply --json", SameBits),
    text("compare", "compare in.ply truth.ply --json", SameBits),
    Case { name: "convert_obj", line: "convert in.ply OUT", output: "obj", promise: SameBits },
    Case { name: "convert_stl", line: "convert in.ply OUT", output: "stl", promise: SameBits },
    Case {
        name: "render",
        line: "render in.ply -o OUT --size 96x72",
        output: "png",
        promise: SameBits,
    },
    mesh("noise_uniform", "noise in.ply --sigma 0.3 --kind uniform -o OUT", SameBits),
    mesh("noise_axes", "noise in.ply --sigma 0.3 --kind axes -o OUT", SameBits),
    // Some numbers in the tail, which take a way of their own.
    mesh("noise_tail", "noise fine.ply --sigma 0.3 --kind axes -o OUT", SameBits),
    mesh("noise_direction", "noise in.ply --sigma 0.3 --kind direction -o OUT", SameBits),
    mesh("noise_normal", "noise in.ply --sigma 0.3 --kind normal -o OUT", SameBits),
    mesh("noise_impulsive", "noise in.ply --sigma 0.3 --kind impulsive -o OUT", SameBits),
    mesh("explicit", "smooth in.ply --method explicit --lambda 0.5 -o OUT", SameBits),
    mesh(
        "explicit_cotangent",
        "smooth in.ply --method explicit --weights cotangent --time 0.002 -o OUT",
        SameBits,
    ),
    mesh("taubin", "smooth in.ply --method taubin -o OUT", SameBits),
    mesh("hc", "smooth in.ply --method hc -o OUT", SameBits),
    mesh("scale_dependent", "smooth in.ply --method scale-dependent -o OUT", SameBits),
    mesh("windowed_sinc", "smooth in.ply --method windowed-sinc -o OUT", SameBits),
    mesh("low_pass", "smooth in.ply --method low-pass -o OUT", SameBits),
    mesh("implicit", "smooth in.ply --method implicit --lambda 5 --iterations 10 -o OUT", SameBits),
    mesh(
        "implicit_stiff",
        "smooth large-in.ply --method implicit --lambda 1e6 --iterations 2 -o OUT",
        direct(1e6),
    ),
    mesh(
        "implicit_cotangent",
        "smooth in.ply --method implicit --weights cotangent --time 0.01 --iterations 1 -o OUT",
        // The largest eigenvalue is about 4e3 here: λ counts as 0.01 × 4e3 / 2.
        direct(20.0),
    ),
    mesh(
        "mean_curvature",
        "smooth large-in.ply --method mean-curvature --iterations 2 -o OUT",
        direct(1e3),
    ),
    mesh("conformal", "smooth in.ply --method conformal --iterations 2 -o OUT", direct(1e3)),
    mesh("automatic", "denoise large-in.ply --method automatic -o OUT", SameBits),
    mesh("bilateral", "denoise in.ply --method bilateral -o OUT", SameBits),
    mesh("non_iterative", "denoise in.ply --method non-iterative -o OUT", SameBits),
    mesh("fast_effective", "denoise in.ply --method fast-effective -o OUT", SameBits),
    mesh("bilateral_normal", "denoise in.ply --method bilateral-normal -o OUT", SameBits),
    mesh(
        "bilateral_normal_global",
        "denoise large-in.ply --method bilateral-normal-global -o OUT",
        SameBits,
    ),
    mesh("l0", "denoise in.ply --method l0 -o OUT", SameBits),
    mesh("total_variation", "denoise in.ply --method total-variation -o OUT", SameBits),
    mesh("guided_normal", "denoise in.ply --method guided-normal -o OUT", SameBits),
    mesh("curvature_cotangent", "curvature in.ply --estimator cotangent -o OUT -q", SameBits),
    mesh("curvature_steiner", "curvature in.ply --estimator steiner -o OUT -q", SameBits),
    mesh("curvature_normal_cycle", "curvature in.ply --estimator normal-cycle -o OUT -q", SameBits),
    mesh("curvature_corrected", "curvature in.ply --estimator corrected -o OUT -q", SameBits),
    mesh("curvature_ball", "curvature in.ply --estimator corrected-ball -o OUT -q", SameBits),
    mesh("curvature_face_tensor", "curvature in.ply --estimator face-tensor -o OUT -q", SameBits),
    mesh("curvature_quadric", "curvature in.ply --estimator quadric -o OUT -q", SameBits),
    mesh("curvature_jet3", "curvature in.ply --estimator jet3 -o OUT -q", SameBits),
    text("spectrum", "spectrum large-in.ply -k 9 --json", EIGENVALUES),
    mesh("reconstruct", "reconstruct large-in.ply -k 4 -o OUT", PROJECTION),
];
