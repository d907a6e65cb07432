"""Eigenvalues, modes and reconstructions: formulas and conventions."""

from __future__ import annotations

import warnings
from itertools import pairwise
from typing import Any

import numpy as np

from .._arrays import Floats
from .._solvers import eigsh
from ._engine import Answer
from ._facts import Facts
from ._pointwise import common, same, slip, usual
from ._report import Convention

#: Largest number of vertices for dense eigenvalue problems of variants.
DENSE = 1500


def pairs(
    facts: Facts, k: int, weights: str = "cotangent", mass: str = "barycentric"
) -> tuple[Floats, Floats, list[range]]:
    """The k smallest eigenvalues, modes and clusters; up to eight more complete the last."""
    key = ("pairs", weights, mass, min(k + 8, facts.n))
    found: tuple[Floats, Floats, list[range]] = facts.remember(
        key, lambda: _pairs(facts, min(k + 8, facts.n), weights, mass)
    )
    return found


def _pairs(facts: Facts, k: int, weights: str, mass: str) -> tuple[Floats, Floats, list[range]]:
    if weights in ("cotangent", "uniform"):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            s = facts.mesh.spectrum(k, weights, mass)  # type: ignore[arg-type]
        return s.values, s.modes, s.clusters()
    m: Any = facts.mesh.laplacian("uniform", mass).mass  # type: ignore[arg-type]
    stiffness = facts.stiffness(weights)
    values, modes = eigsh((stiffness + stiffness.T) / 2, k, m, which="SA")
    gap = np.diff(values) > 1e-6 * (np.abs(values[1:]) + 1e-3 * np.abs(values).max())
    starts = [0, *(np.flatnonzero(gap) + 1), len(values)]
    return values, modes, [range(a, b) for a, b in pairwise(starts)]


def mass_of(facts: Facts, mass: str) -> Any:
    kind: Any = mass
    return facts.remember(("mass", mass), lambda: facts.mesh.laplacian("cotangent", kind).mass)


def eigenvalues(
    facts: Facts,
    given: Floats,
    *,
    weights: str = "cotangent",
    mass: str = "barycentric",
    order: str = "ascending",
    first: int = 0,
    end: str = "smallest",
    power: float = 1.0,
    total: bool = False,
    factor: float = 1.0,
) -> Answer:
    """The k smallest eigenvalues of S φ = ω M φ, and variants; (k,)."""
    k = len(given)
    if end == "largest":
        if facts.n > DENSE:
            raise ValueError("too many vertices")
        values = pairs(facts, facts.n, weights, mass)[0][facts.n - k :]
    else:
        if first + k > facts.n:
            raise ValueError("too few vertices")
        values = pairs(facts, first + k, weights, mass)[0][first : first + k]
    zero = values <= 1e-9 * np.abs(values).max()
    powers = np.where(zero, 0.0, np.where(zero, 1.0, values) ** power)
    values = factor * powers * (facts.mesh.area if total else 1.0)
    if order == "descending":
        values = values[::-1]
    elif order == "as given":
        values = np.sort(values)[np.argsort(np.argsort(given))]
    return values, np.full(k, 5 * np.abs(values).max())


PROBLEM = (
    usual("mixed areas", "the mass M", mass="mixed"),
    usual("circumcentric (Voronoi) areas", "the mass M", mass="voronoi"),
    usual("consistent mass", "M of finite elements, not lumped", mass="consistent"),
    slip("no mass: the standard problem", "S φ = ω φ in place of S φ = ω M φ", mass="unit"),
    usual("graph Laplacian, no mass", "D - W with equal weights", weights="uniform", mass="unit"),
    usual("random walk Laplacian", "D⁻¹ (D - W) with equal weights", weights="uniform",
          mass="degree"),
    slip("absolute cotangents", "cotangents of obtuse angles lose their sign", weights="absolute"),
    slip("tangent in place of cotangent", "the weight of an edge", weights="tangent"),
    slip("one of the two angles of an edge", "only one of the two faces adds", weights="one side"),
    slip("cotangent of another corner", "the angle at the edge", weights="swapped"),
    slip("outer half-edge of the border taken for a triangle", "the cotangents at the border",
         weights="outer triangles"),
)  # fmt: skip

EIGENVALUES = (
    common("the other sign, eigenvalues of Δ", "the sign of the operator", factor=-1.0),
    usual("descending", "the order", order="descending"),
    usual("not sorted", "the order", order="as given"),
    usual("without the eigenvalue 0", "the list begins with the second", first=1),
    slip("½ missing in the cotangents: times 2", "S, or an area of two thirds", factor=2.0),
    slip("½ twice: half of the values", "S, or the area", factor=0.5),
    slip("mass three times too large", "a third is missing in the area", factor=1 / 3),
    slip("times 3", "an area of a ninth", factor=3.0),
    usual("frequencies √ω", "the root of the eigenvalues", power=0.5),
    slip("inverse values", "the operator was inverted: 1 / ω", power=-1.0),
    slip("squared", "singular values, or L twice", power=2.0),
    usual("times the area of the mesh", "ShapeDNA's normalisation", total=True),
    slip("the largest eigenvalues", "the end of the spectrum that the solver returned",
         end="largest"),
    *PROBLEM,
)  # fmt: skip


def modes(
    facts: Facts,
    given: Floats,
    *,
    weights: str = "cotangent",
    mass: str = "barycentric",
    order: str = "ascending",
    first: int = 0,
    scale: float = 0.0,
) -> Answer:
    """Projections of given modes, (k, n), on the eigenspaces at their places.

    Each is equal to the given mode if that lies in the eigenspace: signs, scale and bases are free.
    """
    k = len(given)
    if first + k > facts.n:
        raise ValueError("too few vertices")
    _, phi, clusters = pairs(facts, first + k, weights, mass)
    m = mass_of(facts, mass)
    weight = facts.area("barycentric" if mass in ("unit", "degree") else mass.replace("consistent", "mixed"))
    column = given[::-1].T if order == "descending" else given.T
    # Modes that were not mapped back are M^scale φ.
    own = column * weight[:, None] ** -scale if scale else column
    result = np.zeros_like(own)
    for cluster in clusters:
        here = [j for j in cluster if first <= j < first + k]
        if here:
            basis = phi[:, list(cluster)]
            places = [j - first for j in here]
            result[:, places] = basis @ (basis.T @ (m @ own[:, places]))
    result = result * weight[:, None] ** scale if scale else result
    values = result.T[::-1] if order == "descending" else result.T
    # Iterative solvers give modes to about four digits.
    return values, 500 * np.abs(given).max(axis=1)


MODES = (
    usual("descending", "the order", order="descending"),
    usual("without the constant mode", "the list begins with the second", first=1),
    slip("modes of M^-½ S M^-½, not mapped back", "multiply by M^-½", scale=0.5),
    slip("modes of the transposed S M⁻¹", "the inverse mass stands on the wrong side", scale=1.0),
    slip("mapped back twice", "multiplied by M^-½ once too often", scale=-0.5),
    *PROBLEM,
)  # fmt: skip


def lengths(facts: Facts, given: Floats) -> tuple[str, Convention | None]:
    """The normalisation of modes, (k, n), in words."""
    m = mass_of(facts, "barycentric")
    plain = np.linalg.norm(given, axis=1)
    weighted = np.sqrt(np.maximum((given * (m @ given.T).T).sum(axis=1), 0))
    ratio = plain / weighted
    for name, wanted, convention in (
        ("orthonormal in the mass", np.ones(len(given)), None),
        ("unit vectors, not orthonormal in the mass", 1 / ratio,
         same("unit vectors", "‖φ‖ = 1 in place of φᵀ M φ = 1")),
        ("divided by the squared norm", 1 / ratio**2,
         slip("divided by the squared norm, not the norm", "the normalisation of each mode")),
        ("the largest entry is 1", weighted / np.abs(given).max(axis=1),
         same("largest entry 1", "the scale of each mode")),
    ):  # fmt: skip
        if (np.abs(weighted - wanted) < 1e-3 * wanted).all():
            return name, convention
    return "of no common length (the scale of a mode is free)", same("scaled", "the scale of each mode")


def reconstruction(
    facts: Facts,
    k: int,
    *,
    weights: str = "cotangent",
    mass: str = "barycentric",
    project: str = "mass",
    more: int = 0,
    first: int = 0,
    end: str = "smallest",
    factor: float = 1.0,
) -> Answer:
    """Σ φᵢ φᵢᵀ M x over the first k modes, and variants; (n, 3)."""
    count = k + more
    if not 0 < count <= facts.n:
        raise ValueError("no such mode")
    if end == "largest":
        if facts.n > DENSE:
            raise ValueError("too many vertices")
        phi, x = pairs(facts, facts.n, weights, mass)[1][:, facts.n - k :], facts.points
    else:
        phi, x = pairs(facts, count, weights, mass)[1][:, first:count], facts.points
    size = np.full(facts.n, 20 * facts.mesh.diagonal)
    if project == "mass":
        found = phi @ (phi.T @ (mass_of(facts, mass) @ x))
    elif project == "none":
        found = phi @ (phi.T @ x)
    elif project == "least squares":
        found = phi @ np.linalg.lstsq(phi, x, rcond=None)[0]
    else:
        norms = np.linalg.norm(phi, axis=0)
        unit = phi / (norms**2 if project == "squared norm" else norms)
        found = unit @ (unit.T @ (x if project == "unit" else mass_of(facts, mass) @ x))
    return factor * found, size


RECONSTRUCTION = (
    slip("no mass in the projection", "φᵀ x in place of φᵀ M x", project="none"),
    slip("unit modes, no mass in the projection", "modes of M⁻¹S taken for orthonormal",
         project="unit"),
    slip("unit modes, projected with the mass", "the modes are not orthonormal in M",
         project="unit mass"),
    slip("modes divided by the squared norm, not the norm", "the normalisation of each mode",
         project="squared norm"),
    usual("least squares in place of the projection with the mass",
          "the pseudo-inverse of the modes", project="least squares"),
    slip("one mode too many", "k + 1 modes", more=1),
    slip("one mode too few", "k - 1 modes", more=-1),
    slip("the constant mode is missing", "centred at the origin", first=1),
    slip("k modes without the constant one", "the modes 1 ... k in place of 0 ... k - 1", first=1,
         more=1),
    slip("the k largest modes", "the end of the spectrum that the solver returned", end="largest"),
    slip("times 2", "a factor of the modes", factor=2.0),
    slip("half the size", "a factor of the modes", factor=0.5),
    *PROBLEM,
)  # fmt: skip
