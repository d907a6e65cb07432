"""Smoothing, heat and Poisson problems: formulas and conventions."""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np

from .._arrays import Csr, Floats
from ._engine import Answer, Case, Trial, compared, measured
from ._facts import Facts
from ._operators import laplacian
from ._pointwise import slip, usual
from ._report import Report


def smoothed(
    facts: Facts,
    lam: float,
    *,
    method: str = "implicit",
    weights: str = "uniform",
    step: float = 1.0,
    unit: str = "",
    iterations: int = 10,
    more: int = 0,
    area: str = "barycentric",
    area_factor: float = 1.0,
    scaled: str = "left",
    update: str = "never",
    order: str = "at once",
    border: str = "free",
    mean: str = "row sums",
    after: str = "",
) -> Answer:
    """Positions after steps x + λ L x or (I - λ L) x' = x, and variants; (n, 3).

    `lam` is λ for uniform weights, and for cotangents a time in squared mesh units.
    """
    count = iterations + more
    h2 = facts.mesh.mean_edge_length**2
    length = lam * step * {"": 1.0, "h²": h2, "1/h²": 1 / h2}[unit] if unit != "one" else 1.0
    here, operator = facts, None
    x: Floats = facts.points
    for _ in range(max(count, 0)):
        if operator is None or update != "never":
            moved = here if operator is None else Facts(facts.mesh.with_vertices(x))
            base = here if update == "mass" else moved
            operator = _operator(base, moved, weights, area, area_factor, scaled, mean)
            solve = _step(operator, method, length, order, border, facts)
        x = solve(x)
        x = _adjusted(facts, x, after)
        if not np.isfinite(x).all():
            raise ArithmeticError("the flow diverges")
    return x, np.full(facts.n, 20 * facts.mesh.diagonal)


def _operator(
    base: Facts, moved: Facts, weights: str, area: str, area_factor: float, scaled: str, mean: str
) -> Csr:
    """-L, positive semi-definite."""
    if weights in ("uniform", "faces", "lengths") and scaled in ("left", "right"):
        matrix = laplacian(base, weights=weights, scaled="own", diagonal=mean)[0]
        return matrix if scaled == "left" else matrix.T.tocsr()
    if base is moved or scaled != "left":
        return laplacian(base, weights=weights, scaled=scaled, area=area, area_factor=area_factor)[0]
    return base.diagonal(1 / (area_factor * moved.area(area))) @ base.stiffness(weights)


def _step(operator: Csr, method: str, length: float, order: str, border: str, facts: Facts) -> Any:
    from scipy.sparse import identity, tril, triu
    from scipy.sparse.linalg import splu

    one = identity(facts.n, format="csr")
    if border in ("pinned", "identity"):
        operator = facts.diagonal((~facts.border).astype(float)) @ operator
    if border == "identity":
        # L has rows of the identity: -L those of -1.
        operator = operator - facts.diagonal(facts.border.astype(float))
    if order == "in place":
        lower, upper = tril(operator, -1), triu(operator)
        factor = splu((one + length * lower).tocsc(), permc_spec="NATURAL")
        return lambda x: factor.solve(x - length * (upper @ x))
    if method == "explicit":
        return lambda x: x - length * (operator @ x)
    factor = splu((one + length * operator).tocsc())
    return lambda x: factor.solve(np.ascontiguousarray(x))


def _adjusted(facts: Facts, x: Floats, after: str) -> Floats:
    """The positions after a step, centred or scaled."""
    if after == "centred at the mean":
        return np.asarray(x - x.mean(axis=0))
    if after == "mean kept":
        return np.asarray(x - x.mean(axis=0) + facts.points.mean(axis=0))
    if after in ("volume about the origin", "volume about the mean"):
        ratio = abs(volume(facts, facts.points) / volume(facts, x)) ** (1 / 3)
        middle = x.mean(axis=0) if after.endswith("mean") else np.zeros(3)
        scaled: Floats = middle + ratio * (x - middle)
        return scaled
    return x


def volume(facts: Facts, x: Floats) -> float:
    a, b, c = (x[facts.faces[:, k]] for k in range(3))
    return float((a * np.cross(b, c)).sum() / 6)


SMOOTHED = (
    slip("explicit instead of implicit", "x + λLx in place of (I - λL) x' = x", method="explicit"),
    slip("implicit instead of explicit", "(I - λL) x' = x in place of x + λLx", method="implicit"),
    slip("one step too many", "the loop", more=1),
    slip("one step too few", "the loop", more=-1),
    slip("nothing was moved", "the positions of the mesh are returned", more=-(2**31)),
    usual("cotangent weights", "the operator", weights="cotangent"),
    usual("uniform weights", "the operator", weights="uniform"),
    slip("λ doubled (½ missing in the cotangents)", "the step, or a factor of the operator",
         step=2.0),
    usual("λ halved (moved by Hn in place of 2Hn)", "the step, or a factor of the operator",
          step=0.5),
    slip("-λ", "the sign of the operator: it roughens", step=-1.0),
    usual("λ = 1", "the step is fixed", unit="one"),
    usual("λ times h²", "the step is in squared mean edge lengths", unit="h²"),
    usual("λ over h²", "the step is in mesh units", unit="1/h²"),
    usual("area kept up to date", "M follows the moving mesh, S does not", update="mass"),
    usual("operator kept up to date", "S and M follow the moving mesh", update="both"),
    usual("border fixed", "border vertices do not move", border="pinned"),
    slip("border rows of the identity", "each step scales the border by 1 / (1 - λ)",
         border="identity"),
    slip("in place: later vertices see moved ones", "write into a second array", order="in place"),
    slip("the mean includes the vertex itself", "degree + 1 in place of the degree",
         mean="with itself"),
    slip("neighbours counted once for each face", "inner neighbours twice, border ones once",
         weights="faces"),
    slip("mass missing: I - λS", "S is not divided by the area", scaled="no"),
    slip("transposed: S M⁻¹", "the inverse mass, or degree, stands on the wrong side",
         scaled="right"),
    slip("divided by the sum of the weights", "M⁻¹ S in place of rows over the diagonal",
         scaled="own"),
    usual("mixed areas", "the mass M", area="mixed"),
    usual("circumcentric (Voronoi) areas", "the mass M", area="voronoi"),
    slip("absolute cotangents", "cotangents of obtuse angles lose their sign", weights="absolute"),
    slip("outer half-edge of the border taken for a triangle", "the cotangents at the border",
         weights="outer triangles"),
    usual("scaled to the old volume about the origin", "after each step",
          after="volume about the origin"),
    usual("scaled to the old volume about the mean", "after each step",
          after="volume about the mean"),
    usual("centred at the mean of the vertices", "after each step", after="centred at the mean"),
    usual("mean of the vertices kept", "after each step", after="mean kept"),
)  # fmt: skip


def reference(facts: Facts, **options: Any) -> Floats:
    """The positions that `Mesh.smooth` gives."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        if options["method"] == "explicit":
            options["unstable"] = "allow"
        return facts.mesh.smooth(**options).vertices


# Heat and Poisson problems.


def heat(
    facts: Facts,
    start: Floats,
    time: float,
    *,
    step: float = 1.0,
    method: str = "implicit",
    right: str = "mass",
    area: str = "barycentric",
    weights: str = "cotangent",
    factor: float = 1.0,
) -> Answer:
    """(M + tS) u = M u₀, and variants; (n,)."""
    from scipy.sparse.linalg import spsolve

    m, s, step = facts.area(area), facts.stiffness(weights), step * time
    if method == "explicit":
        values = start - step * (s @ start) / m
    else:
        b = start if right == "none" else m * start
        values = spsolve((facts.diagonal(m) + step * s).tocsc(), b)
    values = factor * values
    return values, np.full(facts.n, 10 * np.abs(values).max())


HEAT = (
    slip("mass missing on the right", "(M + tS) u = u₀ in place of M u₀", right="none"),
    slip("explicit instead of implicit", "u₀ + tΔu₀", method="explicit"),
    slip("t doubled (½ missing in the cotangents)", "the step, or a factor of S", step=2.0),
    slip("t halved", "the step, or a factor of S", step=0.5),
    slip("-t", "the sign of S", step=-1.0),
    usual("mixed areas", "the mass M", area="mixed"),
    usual("circumcentric (Voronoi) areas", "the mass M", area="voronoi"),
    usual("uniform weights", "the operator", weights="uniform"),
    slip("absolute cotangents", "cotangents of obtuse angles lose their sign", weights="absolute"),
)  # fmt: skip


def poisson(
    facts: Facts,
    f: Floats,
    *,
    mean: str = "area",
    right: str = "mass",
    shift: str = "mean",
    area: str = "barycentric",
    weights: str = "cotangent",
    factor: float = 1.0,
) -> Answer:
    """-Δu = f minus its mean, u of mean 0, and variants; (n,)."""
    from scipy.sparse import bmat
    from scipy.sparse.linalg import spsolve

    m, s = facts.area(area), facts.stiffness(weights)
    average = float((m * f).sum() / m.sum()) if mean == "area" else float(f.mean())
    b = (f - average) * (m if right == "mass" else 1.0)
    # A constant right-hand side has no solution: its mean is dropped.
    column = np.ones((facts.n, 1))
    values = spsolve(bmat([[s, column], [column.T, None]]).tocsc(), np.append(b, 0.0))[: facts.n]
    values = values - {"mean": (m * values).sum() / m.sum(), "count": values.mean(),
                       "least": values.min(), "first": values[0]}[shift]  # fmt: skip
    values = factor * values
    return values, np.full(facts.n, 10 * np.abs(values).max())


POISSON = (
    slip("mean by count, not by area", "the mean of f that is subtracted", mean="count",
         right="mass"),
    slip("mass missing on the right", "S u = f in place of M f", right="none", mean="count"),
    usual("the other sign", "Δu = f in place of -Δu = f", factor=-1.0),
    slip("½ missing in the cotangents: half of u", "S", factor=0.5),
    slip("times 2", "S is halved twice", factor=2.0),
    usual("mean by count 0", "the constant of u", shift="count"),
    usual("smallest value 0", "the constant of u", shift="least"),
    usual("first value 0", "the constant of u", shift="first"),
    usual("mixed areas", "the mass M", area="mixed"),
    usual("uniform weights", "the operator", weights="uniform"),
    slip("absolute cotangents", "cotangents of obtuse angles lose their sign", weights="absolute"),
)  # fmt: skip


def other_step(case: Case, asked: str) -> Report | None:
    """The report on an answer that another λ explains."""

    def trial(log: float, method: str) -> Trial | None:
        try:
            with np.errstate(all="ignore"):
                values, size, *_ = case.formula(case.facts, step=float(np.exp(log)), method=method)
        except (ArithmeticError, RuntimeError, ValueError):
            return None
        return compared(case, (), values, size)

    def distance(log: float, method: str) -> float:
        found = trial(log, method)
        return float("inf") if found is None else float((found.error[case.rows] ** 2).mean())

    for method in sorted(("explicit", "implicit"), key=lambda m: m != asked):
        grid = np.linspace(-5, 5, 41)
        at = int(np.argmin([distance(x, method) for x in grid]))
        low, high = grid[max(at - 1, 0)], grid[min(at + 1, 40)]
        golden = (5**0.5 - 1) / 2
        for _ in range(60):
            a, b = high - golden * (high - low), low + golden * (high - low)
            low, high = (low, b) if distance(a, method) < distance(b, method) else (a, high)
        best = trial((low + high) / 2, method)
        if best is not None and (best.error <= 30 * best.tolerance)[case.rows].all():
            c = float(np.exp((low + high) / 2))
            found = usual(f"λ times {c:.5g}", "another step, or a factor of the operator")
            if method == asked:
                text = f"right by another step: {found.name}"
                return measured(case, best, "convention", text, case.table, (found,))
            other = next(x for x in SMOOTHED if x.change == {"method": method})
            text = f"mistake: {other.name}, with {found.name}"
            return measured(case, best, "mistake", text, case.table, (other, found))
    return None
