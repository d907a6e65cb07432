"""Judges of spectra, flows and surfaces."""

from __future__ import annotations

from functools import partial
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from .. import _arrays
from .._core import OptionError
from .._mesh import Mesh
from ..surfaces import Ellipsoid, Surface
from . import _engine, _flows, _forms, _inputs, _pointwise, _spectra
from ._engine import Case, judge
from ._facts import Facts
from ._local import Weights, joined
from ._report import Report


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
        raise OptionError(f"{k} modes are given; a mesh of {mesh.n_vertices} vertices has that many at most")


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
        raise OptionError(f"the modes have the shape {given.shape}; columns of {n} numbers are needed")
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
    if (np.abs(turned).max(axis=1) == 0).any() or np.linalg.matrix_rank(turned, tol=1e-6) < len(turned):
        twin = _pointwise.slip("dependent modes", "a mode appears twice, or is 0")
        return joined(report, "mistake", "mistake: dependent modes", (*report.conventions, twin))
    scale, convention = _spectra.lengths(facts, turned)
    if convention is None or report.status == "mistake":
        return joined(report, report.status, report.verdict, report.conventions, (("scale", scale),))
    names = (*report.conventions, convention)
    status = "mistake" if convention.fault else report.status
    verdict = f"mistake: {_engine.naming(names)}" if convention.fault else f"{report.verdict} ({scale})"
    return joined(report, status, verdict, names, (("scale", scale),))


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
        text = f"not determined: {k} modes split equal eigenvalues (take k = {good})"
        return joined(report, "unexplained", f"{text}; {report.verdict}", report.conventions)
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
    source = answer if callable(answer) or isinstance(answer, (tuple, list, dict)) else _inputs.loaded(answer)
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
