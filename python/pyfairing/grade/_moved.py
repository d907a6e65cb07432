"""Scores of denoised meshes, and the noise that was added."""

from __future__ import annotations

from typing import Any, Literal

import numpy as np

from .._arrays import Floats
from .._mesh import Mesh
from . import _inputs
from ._facts import Facts
from ._flows import volume
from ._report import Convention, Report, Status


def _normal_error(one: Mesh, other: Mesh) -> float:
    """Mean angle between face normals, in degrees."""
    cosines = (Facts(one).cross * Facts(other).cross).sum(axis=1)
    lengths = 4 * Facts(one).face_areas * Facts(other).face_areas
    return float(np.rad2deg(np.arccos(np.clip(cosines / np.maximum(lengths, 1e-300), -1, 1))).mean())


def _distance(one: Floats, other: Floats) -> float:
    return float(np.sqrt(((one - other) ** 2).sum(axis=1).mean()))


def denoised(mesh: Mesh, vertices: Any, truth: Mesh) -> Report:
    """Judges a denoised mesh against the one without noise.

    Parameters
    ----------
    mesh : Mesh
        The noisy mesh.
    vertices : array_like, mesh or path, shape (n, 3)
        Positions after denoising, in the order of the mesh.
    truth : Mesh
        The mesh without noise, with the same faces.

    Returns
    -------
    Report
        `right` if both the mean angle between face normals and the distance of the vertices fall;
        `mistake` if both rise, or for a known slip; otherwise `unexplained`, with the figures.
    """
    given = _inputs.vectors(vertices, mesh, "vertices")
    x, y = mesh.vertices, truth.vertices
    name, size, facts = "denoised mesh", mesh.diagonal, Facts(mesh)
    if not np.isfinite(given).all():
        found = Convention("NaN", "positions that are no numbers", {})
        return Report(name, "mistake", "mistake: NaN among the positions", (found,))
    after = mesh.with_vertices(given)
    before_angle, after_angle = _normal_error(mesh, truth), _normal_error(after, truth)
    before, now = _distance(x, y), _distance(given, y)
    centred, own = given - given.mean(axis=0), y - y.mean(axis=0)
    scale = float((centred * own).sum() / (own * own).sum())
    table = (
        ("normal error", f"{before_angle:.2f}° before, {after_angle:.2f}° after (mean over faces)"),
        ("distance", f"{before:.3g} before, {now:.3g} after (RMS over vertices, mesh units)"),
        ("size", f"{100 * scale:.1f} % of the truth"),
        ("volume", f"{100 * volume(facts, given) / (volume(facts, y) or 1.0):.1f} % of the truth"),
    )
    slips = {
        "nothing was moved": (_distance(given, x) < 1e-9 * size, "the noisy mesh is returned"),
        "the truth itself": (now < 1e-9 * size, "the mesh without noise is returned"),
        "vertices in another order": (
            now > 10 * before and _distance(np.sort(given, axis=0), np.sort(y, axis=0)) < 2 * before,
            "the file was written in another order, or vertices were merged",
        ),
        "shifted": (
            float(np.linalg.norm((given - y).mean(axis=0))) > 5 * before,
            "the mesh was centred, or moved, and not moved back",
        ),
        "shrunk": (scale < 0.8, "too many steps, or too large ones"),
        "grown": (scale > 1.25, "a step of the wrong sign, or an unstable one"),
    }
    found_all = tuple(Convention(word, why, {}) for word, (holds, why) in slips.items() if holds)
    text = f"normal error {before_angle:.1f}° to {after_angle:.1f}°, "
    text += f"distance {before:.2g} to {now:.2g}"
    status: Status = "unexplained"
    if found_all:
        status, text = "mistake", f"mistake: {' and '.join(c.name for c in found_all)} ({text})"
    elif after_angle < before_angle and now < before:
        status, text = "right", f"right: both errors fall ({text})"
    elif after_angle >= before_angle and now >= before:
        status, text = "mistake", f"mistake: both errors rise ({text})"
    else:
        text = f"one error falls, the other rises ({text})"
    worst = int(np.linalg.norm(given - y, axis=1).argmax())
    largest = float(np.linalg.norm(given[worst] - y[worst]))
    return Report(name, status, text, found_all, largest, now, None, worst, table)


def noise(
    mesh: Mesh, vertices: Any, sigma: float, unit: Literal["edge", "model", "diagonal"] = "model"
) -> Report:
    """Judges Gaussian noise that was added to positions, along each axis or along normals.

    Parameters
    ----------
    mesh : Mesh
        The mesh without noise.
    vertices : array_like, mesh or path, shape (n, 3)
        The noisy positions.
    sigma : float
        The standard deviation that was asked for.
    unit : {'model', 'edge', 'diagonal'}
        The unit of `sigma`: mesh units, mean edge lengths, or diagonals of the bounding box.

    Returns
    -------
    Report
        Statistical: within five standard errors of the estimate.
    """
    moved = _inputs.vectors(vertices, mesh, "vertices") - mesh.vertices
    n, name = len(moved), f"noise of σ = {sigma:g} ({unit})"
    wanted = sigma * {"model": 1.0, "edge": mesh.mean_edge_length, "diagonal": mesh.diagonal}[unit]
    normals = np.nan_to_num(mesh.vertex_normals("angle"))
    along = (moved * normals).sum(axis=1)
    rest = float(np.linalg.norm(moved - along[:, None] * normals, axis=1).max())
    by_normals = rest < 1e-6 * max(float(np.abs(along).max()), 1e-300)
    values = along[:, None] if by_normals else moved
    mean, spread = values.mean(axis=0), values.std(axis=0)
    table = (
        ("direction", "along normals" if by_normals else "along the axes"),
        ("standard deviation", ", ".join(f"{s:.4g}" for s in spread) + f" of {wanted:.4g}"),
        ("mean", ", ".join(f"{m:.3g}" for m in mean)),
    )
    if not spread.any():
        none = Convention("no noise", "the positions are those of the mesh", {})
        return Report(name, "mistake", f"mistake: {none.name}", (none,), table=table)
    found: list[Convention] = []
    if (np.abs(mean) > 5 * spread / np.sqrt(n)).any():
        found.append(Convention("biased", "its mean is not 0, as for numbers in [0, 1)", {}))
    if ((values - mean) ** 4).mean() < 2.2 * ((values - mean) ** 2).mean() ** 2:
        found.append(Convention("uniform, not Gaussian", "the distribution", {}))
    level = _level(mesh, spread / wanted, wanted, 5 / np.sqrt(2 * n))
    found += [level] if level is not None else []
    names = " and ".join(c.name for c in found)
    if not found:
        return Report(name, "right", "right", table=table)
    if any(c.fault for c in found):
        return Report(name, "mistake", f"mistake: {names}", tuple(found), table=table)
    text = f"right by another convention: {names}"
    return Report(name, "convention", text, tuple(found), table=table)


def _level(mesh: Mesh, ratio: Floats, wanted: float, margin: float) -> Convention | None:
    """The factor of the standard deviation, None if it is 1."""
    extent, one = np.ptp(mesh.vertices, axis=0), np.ones(3)
    candidates = (
        ("", one, False),
        ("σ times the diagonal", mesh.diagonal * one, False),
        ("σ times the mean edge length", mesh.mean_edge_length * one, False),
        ("σ times the extent of each axis", extent, False),
        ("σ in hundredths of the extent of each axis", extent / 100, False),
        ("σ times the extents of other axes", np.roll(extent, 1), True),
        ("σ times the extents of other axes", np.roll(extent, 2), True),
        ("σ² for σ", wanted * one, True),
        ("2σ", 2 * one, True),
        ("σ/2", one / 2, True),
        ("σ/√3, as for numbers in [-σ, σ]", 3**-0.5 * one, True),
        ("σ/√12, as for numbers in an interval of σ", 12**-0.5 * one, True),
    )
    for text, factor, fault in candidates:
        if (np.abs(ratio / factor[: len(ratio)] - 1) < margin).all():
            return Convention(text, "the level", {}, fault) if text else None
    return Convention(f"σ times {ratio.mean():.3g}", "the level", {})
