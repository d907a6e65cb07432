"""The seven questions as commands, for one answer or a folder of them."""

from __future__ import annotations

import csv
import re
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TextIO

from .._core import FairingError, OptionError
from .._mesh import Mesh, read
from . import (
    denoised,
    eigenvalues,
    fundamental_forms,
    gaussian_curvature,
    laplacian,
    mass,
    mean_curvature,
    modes,
    principal_curvatures,
    reconstruction,
    smoothed,
    vertex_normals,
)
from ._inputs import ARRAYS, MESHES
from ._report import Report

COLUMNS = (
    "submission",
    "file",
    "status",
    "verdict",
    "conventions",
    "largest_error",
    "rms_error",
    "tolerance",
    "at",
)


@dataclass(frozen=True)
class Options:
    """Parameters of questions, as in the functions of the same names."""

    k: int = 15
    lam: float | None = None
    time: float | None = None
    iterations: int = 10
    weights: str | None = None
    truth: str | None = None
    mass: str | None = None
    axes: tuple[float, float, float] = (3.0, 2.0, 1.0)


Judge = Callable[[Mesh, Any], Report]


def _curvature(mesh: Mesh, source: Any) -> Report:
    """H of the uniform Laplacian, or K, by the name of the file or of the field."""
    name = str(source)
    gaussian = re.search(r"gauss|(^|[^a-z])k([^a-z]|$)", Path(name).name, re.IGNORECASE)
    return gaussian_curvature(mesh, source) if gaussian else mean_curvature(mesh, source, "uniform")


def judges(options: Options) -> dict[str, Judge]:
    """The judge of each question, by the names of the command."""
    weights: Any = options.weights or "uniform"
    of_matrix: Any = options.weights or "cotangent"
    steps = {"lam": options.lam, "time": options.time, "iterations": options.iterations, "weights": weights}

    def truth(mesh: Mesh, source: Any) -> Report:
        if options.truth is None:
            raise OptionError("q7 needs --truth, the mesh without noise")
        return denoised(mesh, source, read(options.truth))

    def matrix(mesh: Mesh, source: Any) -> Report:
        return laplacian(mesh, source, options.mass, of_matrix)

    def forms(mesh: Mesh, source: Any) -> Report:
        from ._inputs import loaded

        values = loaded(source)
        if values.ndim != 2 or values.shape[1] != 8:
            raise OptionError(
                f"q2 takes rows of u, v, E, F, G, L, M, N, not an array of shape {values.shape}"
            )
        return fundamental_forms(options.axes, values[:, 2:], values[:, 0], values[:, 1])

    return {
        "q1": _curvature,
        "q2": forms,
        "q3": mean_curvature,
        "q4": lambda mesh, source: reconstruction(mesh, source, options.k),
        "q5": lambda mesh, source: smoothed(mesh, source, "explicit", **steps),
        "q6": lambda mesh, source: smoothed(mesh, source, "implicit", **steps),
        "q7": truth,
        "mean": lambda mesh, source: mean_curvature(mesh, source, of_matrix),
        "gaussian": gaussian_curvature,
        "principal": principal_curvatures,
        "normals": vertex_normals,
        "mass": mass,
        "laplacian": matrix,
        "eigenvalues": eigenvalues,
        "modes": modes,
    }


def graded(judge: Judge, mesh: Mesh, source: Any) -> Report:
    """The report; an answer that cannot be read or has another shape gets one, too."""
    try:
        return judge(mesh, source)
    except (FairingError, OSError, ValueError, TypeError, ImportError) as error:
        return Report("", "unreadable", f"not judged: {error}")


def submissions(folder: Path, suffix: str = "") -> dict[str, list[Path]]:
    """The answers of each submission: a folder, or a file that lies in none; hidden ones are left out."""
    found: dict[str, list[Path]] = {}
    for path in sorted(p for p in folder.iterdir() if not p.name.startswith(".")):
        files = sorted(path.rglob("*")) if path.is_dir() else [path]
        found.setdefault(path.name if path.is_dir() else path.stem, []).extend(
            p for p in files
            if p.suffix.lower() in ARRAYS + MESHES and p.name.endswith(suffix)
            and p.is_file() and not p.name.startswith(".")
        )  # fmt: skip
    return found


def table(judge: Judge, mesh: Mesh, folder: Path, suffix: str, out: TextIO) -> int:
    """Grades a folder to a CSV table; returns the number of files.

    A row per file, and one for each submission without a file to judge.
    """
    rows = csv.writer(out)
    rows.writerow(COLUMNS)
    found = submissions(folder, suffix)
    kinds = f"file whose name ends in {suffix}" if suffix else f"{', '.join(ARRAYS + MESHES)} file"
    for who, files in found.items():
        if not files:
            rows.writerow([who, "", "unreadable", f"not judged: no {kinds}", *[""] * 5])
        for path in files:
            report = graded(judge, mesh, path)
            numbers = [report.largest, report.rms, report.tolerance]
            words = ["" if x is None else f"{x:.4g}" for x in numbers]
            at = "" if report.vertex is None else str(report.vertex)
            rows.writerow(
                [who, str(path.relative_to(folder)), report.status, report.verdict,
                 "; ".join(report.names), *words, at]
            )  # fmt: skip
    return sum(map(len, found.values()))
