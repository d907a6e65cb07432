"""Tests of a student's function: the same mesh, numbered and turned otherwise."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from .._arrays import Bools, Floats
from .._mesh import Mesh
from ._engine import RELATIVE, row_norm
from ._report import Convention, Report, Status

_TURN = np.array([[0.36, 0.48, -0.8], [-0.8, 0.6, 0.0], [0.48, 0.64, 0.6]])

#: Change, and the reason if the answer changes with it.
REASONS = {
    "repeated": ("the answer changes from call to call", "memory never set to 0, or random"),
    "faces in another order": ("depends on the order of faces", "the last face to be visited wins"),
    "corners of faces rotated": ("depends on the first corner of faces", "half-edges of one side"),
    "vertices renumbered": ("depends on the numbers of vertices", "indices as values, or in place"),
    "moved": ("depends on the place", "positions in place of differences, or a centre"),
    "turned": ("depends on the axes", "components in place of a length or a scalar product"),
    "scaled": ("depends on the unit", "an absolute threshold, or terms of other units"),
}  # fmt: skip


def check(
    function: Callable[..., Any], mesh: Mesh, judge: Callable[[Mesh, Any], Report] | None = None
) -> Report:
    """Calls a student's function on changed copies of a mesh, then judges its answer.

    Parameters
    ----------
    function : callable
        Takes vertices (n, 3) and faces (m, 3), or a `Mesh` if it has one parameter. Returns numbers
        (n,), vectors (n, 3) or a matrix (n, n), for each vertex, or a few numbers for the mesh.
    mesh : Mesh
        The mesh.
    judge : callable, optional
        A function of this module, such as `grade.mean_curvature`, for the answer.

    Returns
    -------
    Report
        The changes of faces, numbers, place, axes and unit that change the answer.

    Examples
    --------
    >>> import pyfairing as pf
    >>> def first_coordinate(vertices, faces):
    ...     return vertices[:, 0]
    >>> print(pf.grade.check(first_coordinate, pf.shapes.torus()).verdict)
    mistake: depends on the place and depends on the axes
    """
    call = _caller(function)
    v, f = mesh.vertices, mesh.faces.copy()
    rng = np.random.default_rng(1)
    order, faces = rng.permutation(len(v)), rng.permutation(len(f))
    new = np.empty(len(v), dtype=np.int64)
    new[order] = np.arange(len(v))
    plain = call(v, f)
    changes: dict[str, Any] = {
        "repeated": (v, f),
        "faces in another order": (v, f[faces]),
        "corners of faces rotated": (v, np.roll(f, 1, axis=1)),
        "vertices renumbered": (v[order], new[f]),
        "moved": (v + mesh.diagonal * np.array([0.5, -0.75, 1.0]), f),
        "turned": (v @ _TURN.T, f),
        "scaled": (v * 1e-3, f),
    }
    found: list[Convention] = []
    rows: list[tuple[str, str]] = []
    for name, (points, corners) in changes.items():
        try:
            answer = call(points, corners)
        except Exception as error:  # noqa: BLE001
            found.append(Convention(f"fails if {name}", f"{type(error).__name__}: {error}", {}))
            continue
        difference = _difference(name, plain, answer, new, mesh.boundary_vertices)
        rows.append(
            (name, "same" if difference <= 1.0 else f"differs, by {difference * 1e-4:.2g} of its size")
        )
        if difference > 1.0:
            found.append(Convention(*REASONS[name], {}))
            if name == "repeated":
                break
    verdict = "mistake: " + " and ".join(c.name for c in found)
    own = None if judge is None else judge(mesh, plain)
    if own is not None:
        found += own.conventions
        rows += [("answer on the mesh", own.verdict), *own.table]
    if not any(c.name.startswith(("depends", "fails", "the answer")) for c in found):
        if own is not None:
            return replace(own, conventions=tuple(found), table=tuple(rows))
        verdict = "right: the answer does not depend on order, numbers, place, axes or unit"
    status: Status = "mistake" if verdict.startswith("mistake") else "right"
    return Report("a function", status, verdict, tuple(found), table=tuple(rows))


def _caller(function: Callable[..., Any]) -> Callable[[Floats, Any], Any]:
    try:
        needed = [
            p for p in inspect.signature(function).parameters.values()
            if p.default is p.empty and p.kind in (p.POSITIONAL_ONLY, p.POSITIONAL_OR_KEYWORD)
        ]  # fmt: skip
        one = len(needed) == 1
    except (TypeError, ValueError):
        one = False

    def call(points: Floats, faces: Any) -> Any:
        answer = function(Mesh(points, faces)) if one else function(points.copy(), faces.copy())
        if isinstance(answer, Mesh):
            return answer.vertices
        return answer.tocsr() if hasattr(answer, "tocsr") else np.asarray(answer, dtype=float)

    return call


def _difference(name: str, plain: Any, answer: Any, new: Any, border: Bools) -> float:
    """The largest difference in units of the tolerance, 10⁻⁴ of the largest value.

    Signs at the border are free: where one face meets the border, that of H is rounding.
    """
    n = len(border)
    if plain.shape != answer.shape:
        return float("inf")
    matrix = hasattr(plain, "tocsr")
    expected = plain
    if name == "vertices renumbered" and plain.shape[:1] == (n,):
        order = np.argsort(new)
        square = plain.shape == (n, n)
        expected = plain[order][:, order] if square else plain[order]
    candidates = [expected]
    if not matrix and plain.shape == (n, 3):
        # Normals turn; positions move, too.
        if name == "turned":
            candidates.append(expected @ _TURN.T)
        elif name == "moved":
            candidates.append(expected + np.median(answer - expected, axis=0))
    if name == "scaled":
        candidates = [expected * 1e-3**p for p in (-2, -1, 0, 1, 2, 3)]
    best = float("inf")
    for candidate in candidates:
        if not matrix:
            one, other = np.isfinite(candidate), np.isfinite(answer)
            if (one != other).any():
                continue
            candidate, answer_ = np.where(one, candidate, 0.0), np.where(other, answer, 0.0)
            if answer_.shape == (n,):
                at_border = border[np.argsort(new)] if name == "vertices renumbered" else border
                turned = at_border & (np.abs(candidate + answer_) <= RELATIVE * np.abs(candidate))
                answer_ = np.where(turned, candidate, answer_)
        else:
            answer_ = answer
        size = float(np.atleast_1d(row_norm(_rows(candidate))).max(initial=0.0))
        error = float(np.atleast_1d(row_norm(_rows(answer_ - candidate))).max(initial=0.0))
        if size == 0.0:
            best = min(best, 0.0 if error == 0.0 else float("inf"))
        else:
            best = min(best, error / (10 * RELATIVE * size))
    return best


def _rows(values: Any) -> Any:
    return values if hasattr(values, "tocsr") or values.ndim in (1, 2) else values.reshape(-1)
