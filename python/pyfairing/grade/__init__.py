"""A judge for exercises on the Laplacian: answers against ours, and what explains a difference.

>>> import pyfairing as pf
>>> mesh = pf.shapes.torus()
>>> H = mesh.curvature("cotangent").mean
>>> print(pf.grade.mean_curvature(mesh, H).verdict)
right
>>> print(pf.grade.mean_curvature(mesh, -2 * H).verdict)
mistake: 2H instead of H (the last ½); by convention: the other sign, negative on spheres

Every function takes the mesh and the answer: an array, or the path of a .npy, .npz, .csv, .txt,
.mat or .mtx file, or of a mesh with a field, as in `out.ply:quality`. It returns a `Report`, whose
text begins with the verdict. Conventions are tried alone and in pairs; the first that bring the
difference to rounding are named, with their place in the formula. `right` and `right by another
convention` are no mistakes. Tolerance: 10⁻⁵ of the value plus 2 · 10⁻⁷ of the terms that it sums.
Errors in the shape of an answer raise an `OptionError`.

`python -m pyfairing.grade q3 mesh.obj H.npy` is the same as a command; with a folder in place of
the file it grades every submission and writes a table.
"""

from __future__ import annotations

from functools import partial
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from .. import _arrays
from .._arrays import Floats
from .._core import OptionError
from .._mesh import Mesh
from ..surfaces import Ellipsoid, Surface
from . import _engine, _flows, _forms, _inputs, _operators, _pointwise, _spectra
from ._engine import Case, judge
from ._facts import Facts
from ._invariance import check
from ._moved import denoised, noise
from ._report import Convention, Report

__all__ = [
    "Convention",
    "Report",
    "check",
    "denoised",
    "eigenvalues",
    "fundamental_forms",
    "gaussian_curvature",
    "heat",
    "laplacian",
    "mass",
    "mean_curvature",
    "modes",
    "noise",
    "poisson",
    "principal_curvatures",
    "reconstruction",
    "smoothed",
    "vertex_normals",
]

Weights = Literal["cotangent", "uniform"]


def mean_curvature(mesh: Mesh, H: Any, weights: Weights = "cotangent") -> Report:
    """Judges H at the vertices, positive on a sphere.

    The length of ½ M⁻¹ S x with the sign of its part along the normal, and that part, are right.

    Parameters
    ----------
    mesh : Mesh
        The mesh.
    H : array_like or path, shape (n,)
        Mean curvature in 1 / mesh units; a vector ½ M⁻¹ S x, shape (n, 3), is judged by its length.
    weights : {'cotangent', 'uniform'}
        The Laplacian that was asked for: cotangents over mixed areas, or the mean of the neighbours
        minus the vertex.
    """
    values = _inputs.loaded(H, "H")
    table, conventions = [], _pointwise.MEAN
    if values.shape == (mesh.n_vertices, 3):
        values = np.linalg.norm(values, axis=1)
        table.append(("vectors", "judged by their length"))
        vector = _pointwise.usual("the vector 2Hn", "Δx = -2Hn in place of H", factor=2.0)
        conventions = (vector, *conventions)
    formula = partial(_pointwise.mean_curvature, weights=weights)
    name = f"mean curvature H ({weights} weights)"
    return judge(
        Case(
            name,
            _inputs.scalars(values, mesh, "H"),
            Facts(mesh),
            formula,
            conventions,
            table=table,
        )
    )


def gaussian_curvature(mesh: Mesh, K: Any) -> Report:
    """Judges K: (2π, or π at the border, minus the sum of angles) over the mixed area.

    Parameters
    ----------
    mesh : Mesh
        The mesh.
    K : array_like or path, shape (n,)
        Gaussian curvature in 1 / squared mesh units; integrated values are recognised.
    """
    values = _inputs.scalars(K, mesh, "K")
    case = Case(
        "Gaussian curvature K",
        values,
        Facts(mesh),
        _pointwise.gaussian_curvature,
        _pointwise.GAUSSIAN,
    )
    report = judge(case)
    if report.status != "unexplained":
        return report
    return _quotient(case, report)


def _quotient(case: Case, report: Report) -> Report:
    """K of the right angle defect over an unknown area."""
    assert case.facts is not None
    for edge in (np.pi, 2 * np.pi):
        defect, size = _pointwise.gaussian_curvature(case.facts, edge=edge, measure="integrated")
        clear = case.rows & (np.abs(defect) > 1e-5 * size)
        first, second = (
            np.argsort(np.argsort(np.abs(x[clear]))) for x in (defect, case.given / defect)
        )
        if clear.sum() < 9 or abs(np.corrcoef(first, second)[0, 1]) > 0.5:
            continue
        same_signs = (np.sign(case.given[clear]) == np.sign(defect[clear])).all()
        if same_signs and np.ptp(np.sign(defect[clear])) > 0:
            found = Convention(
                "wrong area", "the signs are right, the area is none of the known ones", {}
            )
            return Report(
                case.quantity,
                "mistake",
                "mistake: wrong area under the right angle defect",
                (found,),
                report.largest,
                report.rms,
                report.tolerance,
                report.vertex,
                report.table,
            )
    return report


def principal_curvatures(mesh: Mesh, kappa: Any) -> Report:
    """Judges H ± √(H² - K) of the cotangent Laplacian and the angle defect.

    Parameters
    ----------
    mesh : Mesh
        The mesh.
    kappa : array_like or path, shape (n, 2)
        Principal curvatures, the larger one first, in 1 / mesh units.
    """
    facts = Facts(mesh)
    case = Case(
        "principal curvatures",
        _inputs.vectors(kappa, mesh, "kappa", 2),
        facts,
        _pointwise.principal_curvatures,
        _pointwise.PRINCIPAL,
    )
    if not case.rows.all():
        for words, change in (
            ("", {}),
            (" (H the length)", {"read": "length"}),
            (" (H of dihedral angles)", {"weights": "dihedral", "factor": 2.0}),
        ):
            for area in ("mixed", "voronoi", "barycentric"):
                H = _pointwise.mean_curvature(facts, area=area, **change)[0]
                K = _pointwise.gaussian_curvature(facts, area=area)[0]
                case.masks[f"where H² < K{words}{', ' + area if area != 'mixed' else ''}"] = (
                    H**2 < K
                )
    return judge(case)


def vertex_normals(mesh: Mesh, normals: Any) -> Report:
    """Judges outward unit normals; weights by area, by angle, and exact on spheres are right.

    Parameters
    ----------
    mesh : Mesh
        The mesh.
    normals : array_like or path, shape (n, 3)
        Normals.
    """

    def corners(facts: Facts) -> Floats:
        return np.repeat(facts.face_normals[:, None], 3, axis=1)

    values = _inputs.vectors(normals, mesh, "normals")
    return judge(
        Case(
            "vertex normals",
            values,
            Facts(mesh),
            _pointwise.vertex_normals,
            _pointwise.NORMALS,
            per_corner=corners,
        )
    )


def mass(mesh: Mesh, M: Any) -> Report:
    """Judges vertex areas: barycentric, a third of the faces at each vertex.

    Parameters
    ----------
    mesh : Mesh
        The mesh.
    M : array_like, sparse matrix or path, shape (n,) or (n, n)
        Areas in squared mesh units, as numbers, on the diagonal of a matrix, or a consistent mass.
    """
    return _mass(Facts(mesh), M)


def _mass(facts: Facts, M: Any) -> Report:
    values, n = _inputs.loaded(M, "M"), facts.n

    def corners(facts: Facts) -> Floats:
        return np.repeat(facts.face_areas[:, None, None] / 3, 3, axis=1)

    if values.shape == (n, n) and n > 1:
        matrix = _operators.sparse(values)
        diagonal = matrix.diagonal()
        if abs(matrix - facts.diagonal(diagonal)).sum() > 1e-12 * abs(diagonal).sum():
            return judge(Case("mass matrix M", matrix, facts, _consistent, CONSISTENT))
        values = diagonal
    values = _inputs.scalars(values, facts.mesh, "M")
    return judge(
        Case("mass M", values, facts, _pointwise.mass, _pointwise.MASS, per_corner=corners)
    )


def _consistent(facts: Facts, *, factor: float = 1.0) -> _engine.Answer:
    matrix = factor * facts.mesh.laplacian("uniform", "consistent").mass
    return matrix, _engine.row_norm(matrix)


CONSISTENT = (
    _pointwise.usual("times 2", "two thirds in place of a third", factor=2.0),
    _pointwise.slip("half", "an area is halved twice", factor=0.5),
)


def laplacian(mesh: Mesh, L: Any, M: Any = None, weights: Weights = "cotangent") -> Report:
    """Judges a Laplacian matrix, and the mass beside it.

    For cotangents S (with halves of cotangents), -S, M⁻¹ S and -M⁻¹ S are right; for uniform
    weights D⁻¹A - I, D - A and their negatives. With M the quotient M⁻¹ L is judged first: factors
    of both that cancel are a convention.

    Parameters
    ----------
    mesh : Mesh
        The mesh.
    L : array_like, sparse matrix or path, shape (n, n)
        The Laplacian.
    M : array_like, sparse matrix or path, shape (n,) or (n, n), optional
        The mass, if L is a stiffness.
    weights : {'cotangent', 'uniform'}
        The weights that were asked for.
    """
    facts = Facts(mesh)
    matrix = _inputs.square(L, mesh, "L")
    scaled, sign = ("own", -1.0) if weights == "uniform" else ("no", 1.0)
    formula = partial(_operators.laplacian, weights=weights, scaled=scaled, sign=sign)
    name = f"Laplacian ({weights} weights)"
    case = Case(name, matrix, facts, formula, _operators.OPERATOR)
    if M is None:
        return judge(case)
    of_mass = _mass(facts, M)
    masses = _inputs.loaded(M, "M")
    masses = (
        masses.diagonal()
        if masses.shape == (facts.n, facts.n)
        else _inputs.scalars(masses, mesh, "M")
    )
    report = judge(case)
    rows: tuple[tuple[str, str], ...] = (("L", report.verdict), ("M", of_mass.verdict))
    if of_mass.quantity == "mass M" and np.isfinite(masses).all() and (masses != 0).all():
        quotient = Case(
            name,
            facts.diagonal(1 / masses) @ matrix,
            facts,
            partial(formula, scaled="left", area="barycentric"),
            _operators.OPERATOR,
        )
        whole = judge(quotient)
        rows = (("quotient M⁻¹ L", whole.verdict), *rows)
        if whole.right and not (report.right and of_mass.right):
            c = float(np.median(masses) / np.median(facts.area("barycentric")))
            both = _pointwise.usual(f"S and M both times {c:.4g}", "the factors cancel in M⁻¹ S")
            names = (both, *whole.conventions)
            return _joined(
                whole,
                "convention",
                f"right by another convention: {_engine.naming(names)}",
                names,
                rows,
            )
    if report.right and of_mass.right:
        conventions = (
            *report.conventions,
            *(c for c in of_mass.conventions if c not in report.conventions),
        )
        kind = "convention" if "convention" in (report.status, of_mass.status) else "right"
        words = (
            f"right by another convention: {_engine.naming(conventions)}"
            if conventions
            else "right"
        )
        return _joined(report, kind, words, conventions, rows)
    wrong = report if not report.right else of_mass
    names = report.conventions + of_mass.conventions
    parts = " and ".join(text for text, part in (("L", report), ("M", of_mass)) if not part.right)
    return _joined(wrong, wrong.status, f"{wrong.verdict} (in {parts})", names, rows)


def _joined(
    report: Report,
    status: Any,
    verdict: str,
    names: tuple[Convention, ...],
    rows: tuple[tuple[str, str], ...],
) -> Report:
    return Report(
        report.quantity,
        status,
        verdict,
        names,
        report.largest,
        report.rms,
        report.tolerance,
        report.vertex,
        report.table + rows,
    )


def eigenvalues(mesh: Mesh, values: Any) -> Report:
    """Judges the smallest eigenvalues of S φ = ω M φ, the 0 included.

    Parameters
    ----------
    mesh : Mesh
        The mesh.
    values : array_like or path, shape (k,)
        Eigenvalues in 1 / squared mesh units, ascending; M is barycentric.
    """
    given = np.ravel(_inputs.loaded(values, "the eigenvalues"))
    _count(len(given), mesh)
    return judge(
        Case(
            "eigenvalues",
            given,
            Facts(mesh),
            lambda facts, **c: _spectra.eigenvalues(facts, given, **c),
            _spectra.EIGENVALUES,
            "value",
        )
    )


def _count(k: int, mesh: Mesh) -> None:
    if not 0 < k <= mesh.n_vertices:
        raise OptionError(
            f"{k} modes are given; a mesh of {mesh.n_vertices} vertices has that many at most"
        )


def modes(mesh: Mesh, phi: Any) -> Report:
    """Judges the smoothest modes, S φ = ω M φ, the constant one included.

    Signs, scale, and the basis of equal eigenvalues are free; the report states the scale.

    Parameters
    ----------
    mesh : Mesh
        The mesh.
    phi : array_like or path, shape (n, k)
        A mode in each column; a transposed array is turned.
    """
    given = _inputs.loaded(phi, "the modes")
    n = mesh.n_vertices
    rows: list[tuple[str, str]] = []
    if given.ndim == 1:
        given = given[:, None]
    if given.shape[0] != n and given.shape[-1] == n:
        given = given.T
        rows.append(("turned", "the modes were in the rows"))
    if given.ndim != 2 or given.shape[0] != n:
        raise OptionError(
            f"the modes have the shape {given.shape}; columns of {n} numbers are needed"
        )
    _count(given.shape[1], mesh)
    facts, turned = Facts(mesh), np.ascontiguousarray(given.T)
    case = Case(
        "modes",
        turned,
        facts,
        lambda facts, **c: _spectra.modes(facts, turned, **c),
        _spectra.MODES,
        "mode",
        rows,
    )
    report = judge(case)
    if report.status == "unexplained" or not case.rows.all():
        return report
    if (np.abs(turned).max(axis=1) == 0).any() or np.linalg.matrix_rank(turned, tol=1e-6) < len(
        turned
    ):
        twin = _pointwise.slip("dependent modes", "a mode appears twice, or is 0")
        return _joined(
            report, "mistake", "mistake: dependent modes", (*report.conventions, twin), ()
        )
    scale, convention = _spectra.lengths(facts, turned)
    if convention is None or report.status == "mistake":
        return _joined(
            report, report.status, report.verdict, report.conventions, (("scale", scale),)
        )
    names = (*report.conventions, convention)
    status = "mistake" if convention.fault else report.status
    verdict = (
        f"mistake: {_engine.naming(names)}" if convention.fault else f"{report.verdict} ({scale})"
    )
    return _joined(report, status, verdict, names, (("scale", scale),))


def reconstruction(mesh: Mesh, vertices: Any, k: int) -> Report:
    """Judges positions projected on the first k modes: Σ φᵢ φᵢᵀ M x.

    Parameters
    ----------
    mesh : Mesh
        The mesh.
    vertices : array_like, mesh or path, shape (n, 3)
        Positions, in mesh units.
    k : int
        The number of modes, the constant one included.

    Returns
    -------
    Report
        If k splits equal eigenvalues, positions depend on their basis; the report says so.
    """
    given = _inputs.vectors(vertices, mesh, "vertices")
    _count(k, mesh)
    facts = Facts(mesh)
    case = Case(
        f"reconstruction from {k} modes",
        given,
        facts,
        lambda facts, **c: _spectra.reconstruction(facts, k, **c),
        _spectra.RECONSTRUCTION,
    )
    cut = [c for c in _spectra.pairs(facts, k)[2] if c.start < k < c.stop]
    if cut:
        good = " or ".join(str(b) for b in (cut[0].start, cut[0].stop) if b)
        case.table.append(
            ("k", f"splits equal eigenvalues, so positions depend on their basis: take k = {good}")
        )
    report = judge(case)
    if cut and report.status != "right":
        return _joined(
            report,
            "unexplained",
            f"not determined: {k} modes split equal eigenvalues "
            f"(take k = {good}); {report.verdict}",
            report.conventions,
            (),
        )
    return report


def smoothed(
    mesh: Mesh,
    vertices: Any,
    method: Literal["explicit", "implicit"] = "implicit",
    *,
    lam: float | None = None,
    time: float | None = None,
    iterations: int = 10,
    weights: Weights = "uniform",
    boundary: Literal["free", "pinned"] = "free",
) -> Report:
    """Judges positions after smoothing by x + λ L x, or by (I - λ L) x' = x.

    Parameters
    ----------
    mesh : Mesh
        The mesh before.
    vertices : array_like, mesh or path, shape (n, 3)
        The positions after.
    method : {'explicit', 'implicit'}
        The steps.
    lam : float, optional
        λ as in `Mesh.smooth`: for cotangent weights in squared mean edge lengths. By default 0.5
        for explicit steps, 5 for implicit ones.
    time : float, optional
        For cotangent weights the step in squared mesh units, in place of `lam`.
    iterations : int
        The number of steps.
    weights : {'uniform', 'cotangent'}
        Weights of L; for cotangents -M⁻¹ S of the mesh before, with barycentric areas.
    boundary : {'free', 'pinned'}
        The treatment of the border.

    Returns
    -------
    Report
        For large meshes and many steps (vertices times steps above 250 000) conventions are tried
        alone, not in pairs.
    """
    given = _inputs.vectors(vertices, mesh, "vertices")
    facts = Facts(mesh)
    length = (0.5 if method == "explicit" else 5.0) if lam is None else float(lam)
    if weights == "cotangent":
        length = length * mesh.mean_edge_length**2 if time is None else float(time)
    elif time is not None:
        raise OptionError("time is for cotangent weights; uniform weights have lam")
    count = _arrays.whole(iterations, "iterations")
    border = "pinned" if boundary == "pinned" else "free"
    formula = partial(
        _flows.smoothed, lam=length, method=method, weights=weights, iterations=count, border=border
    )
    name = f"{method} smoothing, {count} steps, {weights} weights"
    case = Case(
        name,
        given,
        facts,
        formula,
        _flows.SMOOTHED,
        pairs=facts.n * count <= 250_000,
        hook=lambda case: _flows.other_step(case, method),
    )
    if not case.pairs:
        case.table.append(("pairs", "not tried: the mesh is large"))
    return judge(case)


def heat(mesh: Mesh, temperatures: Any, start: npt.ArrayLike, time: float) -> Report:
    """Judges an implicit step of heat: (M + tS) u = M u₀.

    Parameters
    ----------
    mesh : Mesh
        The mesh.
    temperatures : array_like or path, shape (n,)
        u.
    start : array_like, shape (n,)
        u₀.
    time : float
        t, in squared mesh units.
    """
    given = _inputs.scalars(temperatures, mesh, "temperatures")
    u = _inputs.scalars(start, mesh, "start")
    dirac = _pointwise.usual("a Dirac of unit heat", "(M + tS) u = u₀", right="none")
    conventions = ((dirac,) if np.count_nonzero(u) == 1 else ()) + _flows.HEAT
    return judge(
        Case(
            "heat",
            given,
            Facts(mesh),
            lambda facts, **c: _flows.heat(facts, u, float(time), **c),
            conventions,
        )
    )


def poisson(mesh: Mesh, u: Any, f: npt.ArrayLike) -> Report:
    """Judges the solution of -Δu = f minus its mean, u of mean 0, on a connected mesh.

    Parameters
    ----------
    mesh : Mesh
        The mesh.
    u : array_like or path, shape (n,)
        The solution.
    f : array_like, shape (n,)
        Pointwise values.
    """
    given, right = _inputs.scalars(u, mesh, "u"), _inputs.scalars(f, mesh, "f")
    return judge(
        Case(
            "Poisson problem",
            given,
            Facts(mesh),
            lambda facts, **c: _flows.poisson(facts, right, **c),
            _flows.POISSON,
        )
    )


def fundamental_forms(
    surface: Surface | tuple[float, float, float],
    answer: Any,
    u: npt.ArrayLike | None = None,
    v: npt.ArrayLike | None = None,
) -> Report:
    """Judges E, F, G and L, M, N of a surface.

    Parameters
    ----------
    surface : pyfairing.surfaces.Surface or (a, b, c)
        The surface, or the half-axes of the ellipsoid (a cos u sin v, b sin u sin v, c cos v).
    answer : callable or array_like
        A function of u and v, which returns E, F, G, L, M, N, or two triples or 2 x 2 matrices; or
        its values at u and v, shape (p, 6).
    u, v : array_like, shape (p,), optional
        The parameters of an array; functions are called at 48 points of ours by default.

    Returns
    -------
    Report
        Ours are with the inward normal; L, M, N of the other sign are right, too.
    """
    own = surface if isinstance(surface, Surface) else Ellipsoid(*(float(x) for x in surface))
    if u is None or v is None:
        if not callable(answer):
            raise OptionError("values of the forms need u and v, the points where they were taken")
        us, vs = _forms.points()
    else:
        us, vs = (np.ravel(x).astype(np.float64) for x in np.broadcast_arrays(u, v))
    source = (
        answer
        if callable(answer) or isinstance(answer, (tuple, list, dict))
        else _inputs.loaded(answer)
    )
    given = _forms.values_of(source, us, vs)
    return judge(
        Case(
            f"fundamental forms of {own!r}",
            given,
            None,
            lambda facts, **c: _forms.forms(facts, own, us, vs, **c),
            _forms.FORMS,
            "point",
        )
    )
