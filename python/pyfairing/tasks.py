"""Tasks for `pyfairing.dataset`.

A task is a function of a mesh that returns a mapping from the names of columns to numbers,
strings, or arrays of one or two dimensions. Any function of this form can be used; one with a
parameter `path` gets the address of the file of the mesh. Set the attribute `bytes_per_vertex` of a
task that needs more memory than most.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, TypeAlias

import numpy as np

from ._mesh import Mesh
from ._names import Estimator, Kind

__all__ = ["Task", "curvature", "diagnosis", "shape_dna"]

Task: TypeAlias = Callable[..., Mapping[str, Any]]


def diagnosis(mesh: Mesh) -> dict[str, Any]:
    """Counts, topology, defects and measures of `Mesh.info`, with the bounding box as two rows."""
    info = mesh.info()
    if info["bounding_box"] is not None:
        info["bounding_box"] = np.asarray(info["bounding_box"], dtype=np.float64)
    del info["vertices"], info["faces"], info["hints"]
    return info


def curvature(mesh: Mesh, estimator: Estimator = "adaptive") -> dict[str, Any]:
    """The 5th, 50th and 95th percentile of interior curvature, its area-weighted mean, and the number of
    vertices without a value."""
    found = mesh.curvature(estimator)
    inside = found.interior
    weights = mesh.laplacian("uniform", "barycentric").mass.diagonal()[inside]
    row: dict[str, Any] = {"undefined": int((~found.defined).sum())}
    for name in ("mean", "gaussian", "kappa1", "kappa2"):
        values = getattr(found, name)[inside]
        total = float(weights.sum())
        row[f"{name}_average"] = float(values @ weights) / total if total > 0 else None
        for share in (5, 50, 95):
            row[f"{name}_p{share:02d}"] = float(np.percentile(values, share)) if values.size else None
    return row


def shape_dna(mesh: Mesh, k: int = 20, kind: Kind = "auto") -> dict[str, Any]:
    """The first k eigenvalues and their products with the area; fewer if there are fewer vertices."""
    used = mesh.n_vertices - mesh.info()["isolated_vertices"]
    spectrum = mesh.spectrum(min(k, used), kind)
    return {
        "eigenvalues": spectrum.values,
        "shape_dna": spectrum.shape_dna(),
        "certified": spectrum.certified,
        "area": spectrum.area,
    }


#: Measured at 160 thousand vertices, rounded up.
diagnosis.bytes_per_vertex = 700  # type: ignore[attr-defined]
curvature.bytes_per_vertex = 1_200  # type: ignore[attr-defined]
shape_dna.bytes_per_vertex = 6_000  # type: ignore[attr-defined]
