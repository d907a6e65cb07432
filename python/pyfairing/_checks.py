"""Warnings and refusals that several methods of `Mesh` share."""

from __future__ import annotations

from . import _core
from ._calls import call, warn


def warn_of_orientation(mesh: _core.Mesh) -> None:
    """Warns if faces are oriented inconsistently and the result depends on it."""
    turned, one_sided = mesh.disagreeing_faces(call())
    if turned:
        warn(
            f"{turned} of {mesh.face_count} faces turn against the rest of their part " "and count as flipped"
        )
    if one_sided:
        warn(
            f"{one_sided} of {mesh.face_count} faces are on one-sided parts, which have no "
            "outside: signs and volumes are not defined there"
        )


def warn_of_split(split: tuple[int, int | None] | None, k: int, name: str) -> None:
    """Warns if the first k modes split a cluster of eigenvalues."""
    if split is None:
        return
    good = [f"{name}={n}" for n in split if n]
    better = f"{' and '.join(good)} {'does' if len(good) == 1 else 'do'} not" if good else "more may not"
    warn(
        f"{k} modes split a cluster of equal or nearly equal eigenvalues, whose modes are an"
        f" arbitrary basis; {better}"
    )


def require_welded(mesh: _core.Mesh) -> None:
    """Refuses meshes whose faces share no corners."""
    if mesh.is_unwelded(call()):
        raise _core.ComputationError(
            "most vertices coincide with another vertex: the faces do not share their "
            "corners, so that none has neighbours; use the mesh that Mesh.weld returns"
        )
