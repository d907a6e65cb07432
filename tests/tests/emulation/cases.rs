//! The runs of the program, and the agreement promised for each.

/// A run of the program. `OUT` in its arguments is the output file; without it, standard output is
/// compared.
#[derive(Debug)]
pub(crate) struct Case {
    pub(crate) name: String,
    pub(crate) line: String,
    /// The extension of the output, `json` for standard output.
    pub(crate) output: &'static str,
    pub(crate) promise: Promise,
}

/// The agreement of results on two processors.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Promise {
    /// Equal bits: sums, products, quotients, square roots and functions of the crate `libm` in a
    /// fixed order, in every verb without a factorisation.
    SameBits,
    /// Equal up to this tolerance, relative to the largest value.
    Near(f64),
}

/// The error of a direct solution of a system with condition number κ is ε κ times a modest factor,
/// taken as 100. For I − λL with eigenvalues of L in [−2, 0], κ = 1 + 2λ.
const fn direct(lambda: f64) -> Promise {
    Promise::Near(100.0 * f64::EPSILON * (1.0 + 2.0 * lambda))
}

/// The error of an eigenvalue is at most its residual, which is printed (`near` reads it).
const EIGENVALUES: Promise = Promise::Near(0.0);

/// Kept modes rotate by an angle of residual over gap. Residuals are at most 1e-9 of the largest
/// eigenvalue, and after mode 4 of a sphere there is a gap from 2 to 6.
const PROJECTION: Promise = Promise::Near(1e-8);

use Promise::SameBits;

fn case(name: &str, line: &str, output: &'static str, promise: Promise) -> Case {
    Case { name: name.to_owned(), line: line.to_owned(), output, promise }
}

/// Denoisers, and flows at their defaults, with equal bits.
const DENOISERS: [&str; 8] = [
    "bilateral",
    "non-iterative",
    "fast-effective",
    "bilateral-normal",
    "l0",
    "total-variation",
    "guided-normal",
    "total-generalised-variation",
];
const FLOWS: [&str; 5] = ["taubin", "hc", "scale-dependent", "windowed-sinc", "low-pass"];
const ESTIMATORS: [&str; 9] = [
    "adaptive",
    "cotangent",
    "steiner",
    "normal-cycle",
    "corrected",
    "corrected-ball",
    "face-tensor",
    "quadric",
    "jet3",
];
const NOISES: [&str; 5] = ["uniform", "axes", "direction", "normal", "impulsive"];

/// Every verb, and every method with a code path of its own.
pub(crate) fn cases() -> Vec<Case> {
    let mut all = vec![
        case("info", "info in.ply --json", "json", SameBits),
        case("compare", "compare in.ply truth.ply --json", "json", SameBits),
        case("convert_obj", "convert in.ply OUT", "obj", SameBits),
        case("convert_stl", "convert in.ply OUT", "stl", SameBits),
        case("render", "render in.ply -o OUT --size 96x72", "png", SameBits),
        case("spectrum", "spectrum large-in.ply -k 9 --json", "json", EIGENVALUES),
    ];
    let mut mesh = |name: &str, line: &str, promise| {
        all.push(case(&name.replace('-', "_"), &format!("{line} -o OUT"), "ply", promise));
    };
    for kind in NOISES {
        let line = format!("noise in.ply --sigma 0.3 --kind {kind}");
        mesh(&format!("noise_{kind}"), &line, SameBits);
    }
    // Some numbers in the tail, which have a separate code path.
    mesh("noise_tail", "noise fine.ply --sigma 0.3 --kind axes", SameBits);
    for method in FLOWS {
        mesh(method, &format!("smooth in.ply --method {method}"), SameBits);
    }
    let explicit = "smooth in.ply --method explicit";
    mesh("explicit", &format!("{explicit} --lambda 0.5"), SameBits);
    let cotangent = format!("{explicit} --weights cotangent --time 0.002");
    mesh("explicit_cotangent", &cotangent, SameBits);
    let implicit = "smooth in.ply --method implicit";
    mesh("implicit", &format!("{implicit} --lambda 5 --iterations 10"), SameBits);
    // The largest eigenvalue is about 4e3 here: λ counts as 0.01 × 4e3 / 2.
    let cotangent = format!("{implicit} --weights cotangent --time 0.01 --iterations 1");
    mesh("implicit_cotangent", &cotangent, direct(20.0));
    let large = "smooth large-in.ply --iterations 2 --method";
    mesh("implicit_stiff", &format!("{large} implicit --lambda 1e6"), direct(1e6));
    mesh("mean_curvature", &format!("{large} mean-curvature"), direct(1e3));
    let conformal = "smooth in.ply --method conformal --iterations 2";
    mesh("conformal", conformal, direct(1e3));
    for method in DENOISERS {
        mesh(method, &format!("denoise in.ply --method {method}"), SameBits);
    }
    for method in ["automatic", "bilateral-normal-global"] {
        mesh(method, &format!("denoise large-in.ply --method {method}"), SameBits);
    }
    for estimator in ESTIMATORS {
        let line = format!("curvature in.ply --estimator {estimator} -q");
        mesh(&format!("curvature_{estimator}"), &line, SameBits);
    }
    mesh("reconstruct", "reconstruct large-in.ply -k 4", PROJECTION);
    all
}
