"""Judges of values at vertices, and of the operators."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import Any, Literal

import numpy as np

from .._arrays import Floats
from .._mesh import Mesh
from . import _engine, _inputs, _operators, _pointwise
from ._engine import Case, judge
from ._facts import Facts
from ._report import Convention, Report

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
    if values.shape in ((mesh.n_vertices, 3), (3, mesh.n_vertices)):
        values = np.linalg.norm(_inputs.vectors(values, mesh, "H"), axis=1)
        table.append(("vectors", "judged by their length"))
        vector = _pointwise.usual("the vector 2Hn", "Δx = -2Hn in place of H", factor=2.0)
        conventions = (vector, *conventions)
    formula = partial(_pointwise.mean_curvature, weights=weights)
    name = f"mean curvature H ({weights} weights)"
    return judge(
        Case(name, _inputs.scalars(values, mesh, "H"), Facts(mesh), formula, conventions, table=table)
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
        "Gaussian curvature K", values, Facts(mesh), _pointwise.gaussian_curvature, _pointwise.GAUSSIAN
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
        first, second = (np.argsort(np.argsort(np.abs(x[clear]))) for x in (defect, case.given / defect))
        if clear.sum() < 9 or abs(np.corrcoef(first, second)[0, 1]) > 0.5:
            continue
        same_signs = (np.sign(case.given[clear]) == np.sign(defect[clear])).all()
        if same_signs and np.ptp(np.sign(defect[clear])) > 0:
            where = "the signs are right, the area is none of the known ones"
            words = "mistake: wrong area under the right angle defect"
            return joined(report, "mistake", words, (Convention("wrong area", where, {}),))
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
                case.masks[f"where H² < K{words}{', ' + area if area != 'mixed' else ''}"] = H**2 < K
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
    return judge(Case("mass M", values, facts, _pointwise.mass, _pointwise.MASS, per_corner=corners))


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
    masses = masses.diagonal() if masses.shape == (facts.n, facts.n) else _inputs.scalars(masses, mesh, "M")
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
        c = float(np.median(masses) / np.median(facts.area("barycentric")))
        if whole.right and c > 0 and not (report.right and of_mass.right):
            both = _pointwise.usual(f"S and M both times {c:.4g}", "the factors cancel in M⁻¹ S")
            names = (both, *whole.conventions)
            return joined(
                whole, "convention", f"right by another convention: {_engine.naming(names)}", names, rows
            )
    if report.right and of_mass.right:
        conventions = (*report.conventions, *(c for c in of_mass.conventions if c not in report.conventions))
        kind = "convention" if "convention" in (report.status, of_mass.status) else "right"
        words = f"right by another convention: {_engine.naming(conventions)}" if conventions else "right"
        return joined(report, kind, words, conventions, rows)
    wrong = report if not report.right else of_mass
    names = report.conventions + of_mass.conventions
    judged = (("L", report), ("M", of_mass))
    words = f"{wrong.verdict} (in {' and '.join(text for text, part in judged if not part.right)})"
    words += "".join(f"; {text} is {part.verdict}" for text, part in judged if part.status == "convention")
    return joined(wrong, wrong.status, words, names, rows)


def joined(
    report: Report,
    status: Any,
    verdict: str,
    names: tuple[Convention, ...],
    rows: tuple[tuple[str, str], ...] = (),
) -> Report:
    """The report with another verdict and more rows."""
    table = report.table + rows
    return replace(report, status=status, verdict=verdict, conventions=names, table=table)
